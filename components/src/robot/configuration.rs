//! The configuration space: integrate, difference, interpolate, distance and random, all in one place.
//!
//! A configuration is a slice of `size()` numbers, a velocity a slice of `dimension()` numbers. The space is a product of
//! Lie groups: R for joints, R² × SO(2) for planar roots and R³ × SO(3) for free-flyers (a product, *not* the screw
//! motions of SE(3)). Angles of unlimited joints and of planar roots are unwrapped numbers: any real number is valid, and
//! two of them that differ by 2π are the same place.

use crate::pose::{exp_so3, log_so3};
use crate::robot::joint::{Joint, JointType, Source};
use glam::{DQuat, DVec3};
use rand::{Rng, RngExt};
use std::f64::consts::{PI, TAU};

/// One factor of the product.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor {
    /// Which group.
    pub group: Group,
    /// First index in a configuration.
    pub q: usize,
    /// First index in a velocity.
    pub v: usize,
}

/// The Lie groups that joints move in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// A bounded angle or a length.
    Real,
    /// An unlimited angle.
    Circle,
    /// x, y and an unlimited angle.
    Plane,
    /// Position and unit quaternion.
    FreeFlyer,
}

/// The product of the joints' groups, with bounds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConfigurationSpace {
    /// Factors in order of coordinates.
    pub factors: Vec<Factor>,
    /// Lower bounds, one per configuration number; −∞ where there is none (always so for quaternions that may turn).
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
    dimension: usize,
}

impl ConfigurationSpace {
    /// The space of all joints that have coordinates.
    #[must_use]
    pub fn of_joints(joints: &[Joint]) -> Self {
        let mut space = Self::default();
        for joint in joints {
            let Source::Coordinates { q, v } = joint.source else { continue };
            let group = match joint.motion {
                JointType::Planar => Group::Plane,
                JointType::FreeFlyer => Group::FreeFlyer,
                JointType::Revolute { .. }
                    if joint.lower[0] == f64::NEG_INFINITY && joint.upper[0] == f64::INFINITY =>
                {
                    Group::Circle
                }
                JointType::Revolute { .. } | JointType::Prismatic { .. } => Group::Real,
            };
            space.factors.push(Factor { group, q, v });
            space.lower.extend_from_slice(&joint.lower);
            space.upper.extend_from_slice(&joint.upper);
            space.dimension += joint.motion.velocity_size();
        }
        space
    }

    /// nq: how many numbers a configuration has.
    #[must_use]
    pub fn size(&self) -> usize {
        self.lower.len()
    }

    /// nv: the dimension of a velocity.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// All zeros, with identity quaternions; bounds are ignored.
    #[must_use]
    pub fn neutral(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.size()];
        for f in self.factors.iter().filter(|f| f.group == Group::FreeFlyer) {
            q[f.q + 6] = 1.0;
        }
        q
    }

    /// q ⊕ v, written to `out`.
    ///
    /// # Panics
    /// If a slice is shorter than its dimension.
    pub fn integrate(&self, q: &[f64], v: &[f64], out: &mut [f64]) {
        for f in &self.factors {
            let (i, j) = (f.q, f.v);
            match f.group {
                Group::Real | Group::Circle => out[i] = q[i] + v[j],
                Group::Plane => (0..3).for_each(|k| out[i + k] = q[i + k] + v[j + k]),
                Group::FreeFlyer => {
                    (0..3).for_each(|k| out[i + k] = q[i + k] + v[j + k]);
                    let turned = quaternion(q, i) * exp_so3(DVec3::new(v[j + 3], v[j + 4], v[j + 5]));
                    set_quaternion(out, i, turned.normalize());
                }
            }
        }
    }

    /// b ⊖ a: the velocity that takes a to b in unit time along the shortest way (angles of circles in (−π, π]).
    ///
    /// # Panics
    /// If a slice is shorter than its dimension.
    pub fn difference(&self, a: &[f64], b: &[f64], out: &mut [f64]) {
        for f in &self.factors {
            let (i, j) = (f.q, f.v);
            match f.group {
                Group::Real => out[j] = b[i] - a[i],
                Group::Circle => out[j] = wrap(b[i] - a[i]),
                Group::Plane => {
                    (out[j], out[j + 1]) = (b[i] - a[i], b[i + 1] - a[i + 1]);
                    out[j + 2] = wrap(b[i + 2] - a[i + 2]);
                }
                Group::FreeFlyer => {
                    (0..3).for_each(|k| out[j + k] = b[i + k] - a[i + k]);
                    let turn = log_so3(quaternion(a, i).conjugate() * quaternion(b, i));
                    (out[j + 3], out[j + 4], out[j + 5]) = (turn.x, turn.y, turn.z);
                }
            }
        }
    }

    /// The point at `t` ∈ [0, 1] on the shortest way from a to b. At 0 it is `a` bit for bit; at 1 it is `b` bit for bit
    /// where no angle had to be unwrapped, up to the signs of quaternions.
    ///
    /// # Panics
    /// If a slice is shorter than its dimension.
    pub fn interpolate(&self, a: &[f64], b: &[f64], t: f64, out: &mut [f64]) {
        if t <= 0.0 {
            out.copy_from_slice(a);
            return;
        }
        for f in &self.factors {
            let i = f.q;
            match f.group {
                Group::Real => out[i] = linear(a[i], b[i], t),
                Group::Circle => out[i] = linear(a[i], a[i] + wrap(b[i] - a[i]), t),
                Group::Plane => {
                    (out[i], out[i + 1]) = (linear(a[i], b[i], t), linear(a[i + 1], b[i + 1], t));
                    out[i + 2] = linear(a[i + 2], a[i + 2] + wrap(b[i + 2] - a[i + 2]), t);
                }
                Group::FreeFlyer => {
                    (0..3).for_each(|k| out[i + k] = linear(a[i + k], b[i + k], t));
                    let (start, end) = (quaternion(a, i), quaternion(b, i));
                    let turned = if t >= 1.0 {
                        // A product would round; the other sign is the same rotation.
                        if start.dot(end) >= 0.0 { end } else { -end }
                    } else {
                        let turn = log_so3(start.conjugate() * end);
                        (start * exp_so3(turn * t)).normalize()
                    };
                    set_quaternion(out, i, turned);
                }
            }
        }
    }

    /// √Σ (wᵢ · (b ⊖ a)ᵢ)², with one weight per velocity coordinate (metres per radian or per metre, say).
    ///
    /// # Panics
    /// If a slice is shorter than its dimension.
    #[must_use]
    pub fn distance(&self, a: &[f64], b: &[f64], weights: &[f64]) -> f64 {
        let mut sum = 0.0;
        let mut add = |d: f64, v: usize| sum += (d * weights[v]) * (d * weights[v]);
        for f in &self.factors {
            let (i, j) = (f.q, f.v);
            match f.group {
                Group::Real => add(b[i] - a[i], j),
                Group::Circle => add(wrap(b[i] - a[i]), j),
                Group::Plane => {
                    add(b[i] - a[i], j);
                    add(b[i + 1] - a[i + 1], j + 1);
                    add(wrap(b[i + 2] - a[i + 2]), j + 2);
                }
                Group::FreeFlyer => {
                    (0..3).for_each(|k| add(b[i + k] - a[i + k], j + k));
                    // What does not count need not be turned back by an arc sine.
                    if weights[j + 3..j + 6] != [0.0; 3] {
                        let turn = log_so3(quaternion(a, i).conjugate() * quaternion(b, i));
                        (0..3).for_each(|k| add(turn[k], j + 3 + k));
                    }
                }
            }
        }
        sum.sqrt()
    }

    /// A configuration drawn uniformly: within bounds where they are finite, angles over a full turn, rotations uniformly
    /// over SO(3) (Shoemake). A length without a finite bound is drawn within one metre of zero, an angle
    /// within half a turn.
    pub fn random(&self, rng: &mut impl Rng, out: &mut [f64]) {
        for f in &self.factors {
            let i = f.q;
            match f.group {
                Group::Real => out[i] = self.uniform(rng, i, 1.0),
                Group::Circle => out[i] = rng.random_range(-PI..=PI),
                Group::Plane => {
                    (out[i], out[i + 1]) = (self.uniform(rng, i, 1.0), self.uniform(rng, i + 1, 1.0));
                    out[i + 2] = self.uniform(rng, i + 2, PI);
                }
                Group::FreeFlyer => {
                    (0..3).for_each(|k| out[i + k] = self.uniform(rng, i + k, 1.0));
                    let turned = match self.is_immovable(i + 3..i + 7) {
                        true => quaternion(&self.lower, i),
                        false => random_rotation(rng),
                    };
                    set_quaternion(out, i, turned);
                }
            }
        }
    }

    fn uniform(&self, rng: &mut impl Rng, i: usize, reach: f64) -> f64 {
        let low = if self.lower[i].is_finite() { self.lower[i] } else { self.upper[i].min(reach) - 2.0 * reach };
        let high = if self.upper[i].is_finite() { self.upper[i] } else { low + 2.0 * reach };
        if low < high { rng.random_range(low..=high) } else { low }
    }

    /// Whether these configuration numbers lie between equal bounds.
    #[must_use]
    pub fn is_immovable(&self, mut numbers: std::ops::Range<usize>) -> bool {
        numbers.all(|i| self.lower[i] >= self.upper[i])
    }

    /// The first configuration number outside its bounds by more than `tolerance`, if any.
    #[must_use]
    pub fn first_out_of_bounds(&self, q: &[f64], tolerance: f64) -> Option<usize> {
        (0..self.size()).find(|&i| !(q[i] >= self.lower[i] - tolerance && q[i] <= self.upper[i] + tolerance))
    }

    /// Moves every number of `q` into its bounds.
    pub fn clamp(&self, q: &mut [f64]) {
        for (x, (&low, &high)) in q.iter_mut().zip(self.lower.iter().zip(&self.upper)) {
            *x = x.max(low).min(high);
        }
    }
}

/// The quaternion of a free-flyer whose seven numbers start at `i`.
#[must_use]
pub fn quaternion(q: &[f64], i: usize) -> DQuat {
    DQuat::from_xyzw(q[i + 3], q[i + 4], q[i + 5], q[i + 6])
}

fn set_quaternion(q: &mut [f64], i: usize, r: DQuat) {
    (q[i + 3], q[i + 4], q[i + 5], q[i + 6]) = (r.x, r.y, r.z, r.w);
}

/// The angle that differs by a multiple of 2π, in [−π, π].
#[must_use]
pub fn wrap(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// a at 0, b at 1, both exactly.
fn linear(a: f64, b: f64, t: f64) -> f64 {
    if t >= 1.0 { b } else { a + t * (b - a) }
}

fn random_rotation(rng: &mut impl Rng) -> DQuat {
    let (u, a, b): (f64, f64, f64) = (rng.random(), rng.random_range(0.0..TAU), rng.random_range(0.0..TAU));
    let (r, s) = ((1.0 - u).sqrt(), u.sqrt());
    DQuat::from_xyzw(r * a.sin(), r * a.cos(), s * b.sin(), s * b.cos()).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    /// One factor of each group.
    fn space() -> ConfigurationSpace {
        let groups = [Group::Real, Group::Circle, Group::Plane, Group::FreeFlyer];
        let mut space = ConfigurationSpace::default();
        for group in groups {
            let (nq, nv) = match group {
                Group::Real | Group::Circle => (1, 1),
                Group::Plane => (3, 3),
                Group::FreeFlyer => (7, 6),
            };
            space.factors.push(Factor { group, q: space.lower.len(), v: space.dimension });
            let bound = if group == Group::Circle { f64::INFINITY } else { 2.0 };
            space.lower.extend(std::iter::repeat_n(-bound, nq));
            space.upper.extend(std::iter::repeat_n(bound, nq));
            space.dimension += nv;
        }
        space
    }

    fn same_place(space: &ConfigurationSpace, a: &[f64], b: &[f64]) -> bool {
        space.distance(a, b, &vec![1.0; space.dimension()]) < 1e-12
    }

    #[test]
    fn integrating_the_difference_arrives() {
        let space = space();
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let (mut a, mut b, mut c) = (space.neutral(), space.neutral(), space.neutral());
        let mut v = vec![0.0; space.dimension()];
        for _ in 0..1000 {
            space.random(&mut rng, &mut a);
            space.random(&mut rng, &mut b);
            space.difference(&a, &b, &mut v);
            space.integrate(&a, &v, &mut c);
            assert!(same_place(&space, &b, &c));
        }
    }

    #[test]
    fn what_lies_between_equal_bounds_never_moves() {
        let mut space = space();
        let stands = [0.5, -1.0, 0.25, -0.5, 2.0, 0.0, 0.1, 0.2, 1.0, 0.0, 0.0, 0.0];
        (space.lower, space.upper) = (stands.to_vec(), stands.to_vec());
        space.factors[1].group = Group::Real;
        let (mut rng, mut q) = (rand_chacha::ChaCha8Rng::seed_from_u64(9), space.neutral());
        space.random(&mut rng, &mut q);
        assert_eq!(q, stands);
    }

    #[test]
    fn interpolation_ends_bit_for_bit_whatever_the_quaternions_sign() {
        let mut space = space();
        space.factors.retain(|f| matches!(f.group, Group::Real | Group::FreeFlyer));
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(10);
        let (mut a, mut b, mut c) = (space.neutral(), space.neutral(), space.neutral());
        for _ in 0..100 {
            space.random(&mut rng, &mut a);
            space.random(&mut rng, &mut b);
            space.interpolate(&a, &b, 1.0, &mut c);
            for f in &space.factors {
                let (end, reached) = (quaternion(&b, 5), quaternion(&c, 5));
                let same = if f.group == Group::Real { c[f.q] == b[f.q] } else { reached == end || reached == -end };
                assert!(same, "{end} became {reached}");
            }
        }
    }

    #[test]
    fn interpolation_starts_ends_and_advances_evenly() {
        let space = space();
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(8);
        let weights = vec![1.0; space.dimension()];
        let (mut a, mut b, mut c) = (space.neutral(), space.neutral(), space.neutral());
        for _ in 0..200 {
            space.random(&mut rng, &mut a);
            space.random(&mut rng, &mut b);
            let whole = space.distance(&a, &b, &weights);
            space.interpolate(&a, &b, 0.0, &mut c);
            assert_eq!(a, c);
            space.interpolate(&a, &b, 1.0, &mut c);
            assert!(same_place(&space, &b, &c));
            space.interpolate(&a, &b, 0.25, &mut c);
            assert!((space.distance(&a, &c, &weights) - 0.25 * whole).abs() < 1e-9);
        }
    }
}
