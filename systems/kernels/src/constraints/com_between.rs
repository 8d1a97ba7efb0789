//! The centre of mass over the line between two feet (P0 §IV-A d; HPP's `ComBetweenFeet`).

use super::centre_of_mass::{MassColumns, centre};
use crate::constraints::rows_out::{RowsOut, is_silent, placement_of, silence};
use crate::kinematics::Column;
use foliate_components::Pose;
use foliate_components::constraint::{CentreOfMassBetween, Row};
use glam::{DVec2, DVec3};

/// Feet that are nearer to each other than this, seen from above, have no line between them; metres.
pub(crate) const CLOSEST: f64 = 1e-9;

/// What the rows are made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stance {
    /// The centre of mass in the world.
    pub center: DVec3,
    /// The feet in the world.
    pub feet: [DVec3; 2],
    /// Horizontal unit vector from the first foot to the second.
    pub along: DVec3,
    /// How far apart they are, seen from above, metres; infinite where that is too near for a direction, which then stays.
    pub apart: f64,
}

impl Stance {
    fn new(balance: &CentreOfMassBetween, center: DVec3, X_WJ: &[Pose]) -> Self {
        let foot = |frame| placement_of(frame).in_world(X_WJ).translation;
        let feet = [foot(&balance.first), foot(&balance.second)];
        let across: DVec2 = (feet[1] - feet[0]).truncate();
        let apart = across.length();
        if apart < CLOSEST {
            return Self { center, feet, along: DVec3::X, apart: f64::INFINITY };
        }
        Self { center, feet, along: (across / apart).extend(0.0), apart }
    }

    /// Horizontal, to the left of the line.
    pub(super) fn sideways(&self) -> DVec3 {
        DVec3::Z.cross(self.along)
    }

    /// The gradients of the rows with respect to the motions of the centre of mass, the first and the second foot. Where
    /// the feet turn the line between them, its direction changes by `turning` radians per metre.
    fn gradients(&self) -> [[DVec3; 3]; 4] {
        let (along, sideways) = (self.along, self.sideways());
        let [first, second] = self.feet;
        let turning = sideways / self.apart;
        let [from_first, to_second] = [self.center - first, second - self.center];
        let row = |direction: DVec3, signs: [f64; 3], lever: f64| {
            let [center, near, far] = signs.map(|sign| sign * direction);
            [center, near - lever * turning, far + lever * turning]
        };
        [
            [DVec3::Z, -0.5 * DVec3::Z, -0.5 * DVec3::Z],
            row(sideways, [1.0, -1.0, 0.0], -along.dot(from_first)),
            row(along, [1.0, -1.0, 0.0], sideways.dot(from_first)),
            row(along, [-1.0, 0.0, 1.0], sideways.dot(to_second)),
        ]
    }

    /// `[height above the middle, sideways, beyond the first foot, before the second]`.
    pub(super) fn rows(&self) -> [f64; 4] {
        let [first, second] = self.feet;
        let above = self.center.z - 0.5 * (first.z + second.z);
        let from_first = self.center - first;
        let beyond = self.along.dot(from_first);
        [above, self.sideways().dot(from_first), beyond, self.along.dot(second - self.center)]
    }
}

/// Number of rows: three, and one for the height where it is given.
#[must_use]
pub fn dimension(balance: &CentreOfMassBetween) -> usize {
    3 + usize::from(balance.height.is_some())
}

/// The rows `[c_z − mid_z − height, sideways, c·u − first·u, second·u − c·u]`, without the first where the height is free;
/// metres. The last two are inequalities.
///
/// # Panics
/// If a slice is too short.
pub fn value(balance: &CentreOfMassBetween, X_WJ: &[Pose], values: &mut [f64]) {
    write(balance, &Stance::new(balance, centre(&balance.masses, X_WJ), X_WJ), values);
}

fn write(balance: &CentreOfMassBetween, stance: &Stance, values: &mut [f64]) {
    let rows = stance.rows();
    let all = balance.height.map(|height| rows[0] - height).into_iter().chain(rows[1..].iter().copied());
    values.iter_mut().zip(all).for_each(|(value, row)| *value = row);
}

/// How free coordinates move what the rows depend on, all of it against the world.
#[derive(Clone, Debug)]
pub struct StanceColumns {
    /// The centre of mass.
    pub masses: MassColumns,
    /// The first foot and the second.
    pub feet: [Vec<Column>; 2],
}

/// Writes the rows and their Jacobian; `moments` is working memory. A satisfied inequality has value and Jacobian zero.
///
/// # Panics
/// If a slice is too short.
pub fn linearise(
    balance: &CentreOfMassBetween,
    columns: &StanceColumns,
    X_WJ: &[Pose],
    moments: &mut [DVec3],
    out: RowsOut<'_>,
) {
    let RowsOut { values, jacobian, stride } = out;
    let stance = Stance::new(balance, columns.masses.tree.moments(X_WJ, moments), X_WJ);
    write(balance, &stance, values);
    let count = dimension(balance);
    if jacobian.is_empty() {
        return silence(values, (0..count).map(|row| kind(balance, row)));
    }
    let mut gradients = stance.gradients();
    gradients.rotate_left(4 - count);
    for (row, gradient) in gradients.iter_mut().enumerate().take(count) {
        if is_silent(kind(balance, row), values[row]) {
            *gradient = [DVec3::ZERO; 3];
        }
    }
    let mut add = |variable: usize, moved: usize, velocity: DVec3| {
        let numbers = &mut jacobian[variable * stride..][..count];
        for (number, gradient) in numbers.iter_mut().zip(&gradients) {
            *number += gradient[moved].dot(velocity);
        }
    };
    for column in &columns.masses.columns {
        add(column.column.variable(), 0, column.velocity(X_WJ, moments));
    }
    for (foot, columns) in columns.feet.iter().enumerate() {
        for column in columns {
            add(column.variable(), foot + 1, column.twist(X_WJ, stance.feet[foot]).0);
        }
    }
    silence(values, (0..count).map(|row| kind(balance, row)));
}

/// What is asked of a row: the last two are inequalities.
#[must_use]
pub fn kind(balance: &CentreOfMassBetween, row: usize) -> Row {
    if row + 2 < dimension(balance) { Row::Zero } else { Row::Inequality }
}
