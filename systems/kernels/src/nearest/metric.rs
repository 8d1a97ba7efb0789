//! The distance of the configuration space, as rows of rounded numbers that lanes can subtract.

use foliate_components::robot::configuration::{ConfigurationSpace, Group, wrap};
use std::f64::consts::{PI, TAU};

/// Which rows stand for a configuration: √Σ(wᵢ(b ⊖ a)ᵢ)² of [`ConfigurationSpace::distance`] falls into numbers whose
/// difference counts, angles that come round, and rotations.
#[derive(Clone, Debug, Default)]
pub struct Metric {
    /// Configuration number and weight.
    straight: Vec<(usize, f64)>,
    /// The same of angles.
    angles: Vec<(usize, f64)>,
    /// First of a quaternion's four numbers, and the smallest weight of the rotation.
    rotations: Vec<(usize, f64)>,
    shape: Shape,
}

/// How rows are to be compared.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Shape {
    /// Rows of plain differences, the first of all.
    pub straight: usize,
    /// Full turns of the angles that follow, one row each.
    pub turns: Vec<f32>,
    /// Squared weights of the rotations that follow, four rows each.
    pub rotations: Vec<f32>,
}

impl Shape {
    /// How many rows a configuration takes.
    #[inline(always)]
    pub fn rows(&self) -> usize {
        self.straight + self.turns.len() + 4 * self.rotations.len()
    }
}

impl Metric {
    /// The metric of a space with one weight per velocity coordinate; what weighs nothing is left out.
    ///
    /// # Panics
    /// If there are fewer weights than dimensions.
    #[must_use]
    pub fn new(space: &ConfigurationSpace, weights: &[f64]) -> Self {
        let mut metric = Self::default();
        for f in &space.factors {
            let w = &weights[f.v..];
            match f.group {
                Group::Real => metric.straight.push((f.q, w[0])),
                Group::Circle => metric.angles.push((f.q, w[0])),
                Group::Plane => {
                    metric.straight.extend([(f.q, w[0]), (f.q + 1, w[1])]);
                    metric.angles.push((f.q + 2, w[2]));
                }
                Group::FreeFlyer => {
                    metric.straight.extend([0, 1, 2].map(|k| (f.q + k, w[k])));
                    metric.rotations.push((f.q + 3, w[3].abs().min(w[4].abs()).min(w[5].abs())));
                }
            }
        }
        let weighs = |&(_, weight): &(usize, f64)| weight != 0.0;
        metric.straight.retain(weighs);
        metric.angles.retain(weighs);
        metric.rotations.retain(weighs);
        metric.shape = Shape {
            straight: metric.straight.len(),
            turns: metric.angles.iter().map(|(_, w)| (TAU * w.abs()) as f32).collect(),
            rotations: metric.rotations.iter().map(|(_, w)| (w * w) as f32).collect(),
        };
        metric
    }

    /// How many rows a configuration takes.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.shape.rows()
    }

    pub(super) fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The sum of the numbers' sizes, as far as how exactly they are rounded depends on it.
    pub(super) fn reach(&self, numbers: &[f64]) -> f64 {
        numbers.iter().take(self.straight.len()).map(|x| x.abs()).sum()
    }

    /// Writes the numbers of a configuration, weighted, angles in [−π, π], quaternions of unit length.
    pub(super) fn write(&self, q: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.straight.iter().map(|&(i, w)| w * q[i]));
        out.extend(self.angles.iter().map(|&(i, w)| w.abs() * wrap(q[i])));
        for &(i, _) in &self.rotations {
            let length = q[i..i + 4].iter().map(|x| x * x).sum::<f64>().sqrt();
            out.extend(q[i..i + 4].iter().map(|x| x / length));
        }
    }

    /// By how much rounding may change a distance between configurations whose `reach` together is at most this.
    pub(super) fn rounding(&self, reach: f64) -> f64 {
        // Each of two numbers is off by half a unit, and so is a full turn; twice that is more than enough.
        const UNIT: f64 = 2.0 * f32::EPSILON as f64;
        /// How much the angle of a rotation may be off where the quaternions' numbers are off by a unit: less than
        /// 2√2 times the chord's error.
        const TURN: f64 = 16.0;
        let angles: f64 = self.angles.iter().map(|(_, w)| 2.0 * PI * w.abs()).sum();
        let rotations: f64 = self.rotations.iter().map(|(_, w)| TURN * w).sum();
        UNIT * (reach + angles + rotations)
    }
}
