//! How one joint moves along a straight motion or along a curve.
//!
//! Curves are cubics by coordinate ([`Cubic`]). What counts for the distance of bodies is how far a joint gets from where it is
//! at the sample, not how long its way is: moved straight from the one place to the other it leads to the same poses.

use crate::curve::cubic::Cubic;
use crate::curve::turning::Turning;
use crate::kinematics::joint_table::{JointCoordinates, JointEntry};
use foliate_components::robot::JointType;
use glam::DVec3;

/// The motion of one joint within an interval, for half of its width as the unit of time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JointRate {
    /// At most this far is its rotation from the one at the sample, radians.
    pub turn: f64,
    /// At most this far is its translation from the one at the sample, metres.
    pub slide: f64,
    /// Velocity of its rotation at the sample, in its own frame.
    pub spin: DVec3,
    /// Velocity of its translation at the sample, in its frame at zero.
    pub drift: DVec3,
    /// At least its largest angular speed, and its largest angular acceleration.
    pub turning: (f64, f64),
    /// At least its largest speed, and its largest acceleration.
    pub sliding: (f64, f64),
}

impl JointRate {
    /// A motion that turns and slides evenly by so much.
    fn even((turn, spin): (f64, DVec3), (slide, drift): (f64, DVec3)) -> Self {
        Self { turn, slide, spin, drift, turning: (turn, 0.0), sliding: (slide, 0.0) }
    }

    /// Along a straight motion from `q` by `delta`, for all of it as the unit of time; also how far its translation is from zero
    /// at most, metres.
    pub(crate) fn straight(joint: &JointEntry, q: &[f64], delta: &[f64]) -> (Self, f64) {
        const STILL: (f64, DVec3) = (0.0, DVec3::ZERO);
        let vector = |values: &[f64], i: usize, n: usize| {
            DVec3::new(values[i], values[i + 1], if n > 2 { values[i + 2] } else { 0.0 })
        };
        let farthest = |start: DVec3, by: DVec3| start.length().max((start + by).length());
        let JointCoordinates { q: i, v: j, multiplier, offset } = joint.coordinates;
        match joint.motion {
            JointType::Revolute { axis } => {
                let turn = multiplier * delta[j];
                (Self::even((turn.abs(), axis * turn), STILL), 0.0)
            }
            JointType::Prismatic { axis } => {
                let slide = multiplier * delta[j];
                let value = |x: f64| (multiplier * x + offset).abs();
                let travel = value(q[i]).max(value(q[i] + delta[j]));
                (Self::even(STILL, (slide.abs(), axis * slide)), travel)
            }
            JointType::Planar => {
                let (start, by) = (vector(q, i, 2), vector(delta, j, 2));
                let turn = delta[j + 2];
                (Self::even((turn.abs(), DVec3::Z * turn), (by.length(), by)), farthest(start, by))
            }
            JointType::FreeFlyer => {
                let (start, by, spin) = (vector(q, i, 3), vector(delta, j, 3), vector(delta, j + 3, 3));
                (Self::even((spin.length(), spin), (by.length(), by)), farthest(start, by))
            }
        }
    }

    /// An even motion over an interval that is `half_width` of it to either side.
    pub(crate) fn over(&self, half_width: f64) -> Self {
        let (turn, slide) = (half_width * self.turn, half_width * self.slide);
        Self::even((turn, self.spin * half_width), (slide, self.drift * half_width))
    }

    /// Within `h` to either side of `t` on a piece of a curve, whose coordinates are `cubics`.
    pub(crate) fn on_curve(joint: &JointEntry, cubics: &[Cubic], t: f64, h: f64) -> Self {
        let JointCoordinates { q: i, multiplier, .. } = joint.coordinates;
        let number = |i: usize, factor: f64| {
            let here = cubics[i].about(t);
            let [velocity, away] = [here.0[1] * h, here.farthest(h)].map(|x| factor * x);
            (velocity, away.abs(), factor.abs() * here.fastest(h) * h, factor.abs() * here.most_bent(h) * h * h)
        };
        let vector = |n: usize| {
            let parts: [_; 3] = std::array::from_fn(|k| if k < n { number(i + k, 1.0) } else { (0.0, 0.0, 0.0, 0.0) });
            let norm = |of: [f64; 3]| DVec3::from_array(of).length();
            let drift = DVec3::from_array(parts.map(|p| p.0));
            (norm(parts.map(|p| p.1)), drift, (norm(parts.map(|p| p.2)), norm(parts.map(|p| p.3))))
        };
        match joint.motion {
            JointType::Revolute { axis } => {
                let (velocity, turn, rate, bend) = number(i, multiplier);
                Self { turn, spin: axis * velocity, turning: (rate, bend), ..Self::default() }
            }
            JointType::Prismatic { axis } => {
                let (velocity, slide, rate, bend) = number(i, multiplier);
                Self { slide, drift: axis * velocity, sliding: (rate, bend), ..Self::default() }
            }
            JointType::Planar => {
                let (velocity, turn, rate, bend) = number(i + 2, 1.0);
                let (slide, drift, sliding) = vector(2);
                Self { turn, slide, spin: DVec3::Z * velocity, drift, turning: (rate, bend), sliding }
            }
            JointType::FreeFlyer => {
                let Turning { angle, spin, rate, bend } = Turning::of(&quaternion_of(cubics, i), t, h);
                let (slide, drift, sliding) = vector(3);
                Self { turn: angle, slide, spin, drift, turning: (rate, bend), sliding }
            }
        }
    }
}

fn quaternion_of(cubics: &[Cubic], i: usize) -> [Cubic; 4] {
    [cubics[i + 3], cubics[i + 4], cubics[i + 5], cubics[i + 6]]
}

impl JointEntry {
    /// How far it can turn and slide from where it is at `t` within `h` to either side, on a piece of a curve.
    pub(crate) fn moves_within(&self, cubics: &[Cubic], t: f64, h: f64) -> (f64, f64) {
        let JointCoordinates { q: i, multiplier, .. } = self.coordinates;
        let number = |i: usize| cubics[i].about(t).farthest(h);
        match self.motion {
            JointType::Revolute { .. } => ((multiplier * number(i)).abs(), 0.0),
            JointType::Prismatic { .. } => (0.0, (multiplier * number(i)).abs()),
            JointType::Planar => (number(i + 2), number(i).hypot(number(i + 1))),
            JointType::FreeFlyer => {
                let slide = DVec3::new(number(i), number(i + 1), number(i + 2)).length();
                (Turning::of(&quaternion_of(cubics, i), t, h).angle, slide)
            }
        }
    }

    /// How far it can turn and slide from where it is at the ends of a piece of a curve, anywhere on the piece, and how far from
    /// zero its translation is at most.
    pub(crate) fn moves_along(&self, cubics: &[Cubic]) -> (f64, f64, f64) {
        let JointCoordinates { q: i, multiplier, offset, .. } = self.coordinates;
        let width = |(low, high): (f64, f64)| high - low;
        let farthest = |(low, high): (f64, f64)| low.abs().max(high.abs());
        let vector = |n: usize| {
            let ranges: [_; 3] = std::array::from_fn(|k| if k < n { cubics[i + k].range() } else { (0.0, 0.0) });
            let norm = |of: [f64; 3]| DVec3::from_array(of).length();
            (norm(ranges.map(width)), norm(ranges.map(farthest)))
        };
        match self.motion {
            JointType::Revolute { .. } => (multiplier.abs() * width(cubics[i].range()), 0.0, 0.0),
            JointType::Prismatic { .. } => {
                let range = cubics[i].scaled(multiplier, offset).range();
                (0.0, width(range), farthest(range))
            }
            JointType::Planar => {
                let (slide, travel) = vector(2);
                (width(cubics[i + 2].range()), slide, travel)
            }
            JointType::FreeFlyer => {
                let (slide, travel) = vector(3);
                (Turning::over(&quaternion_of(cubics, i)), slide, travel)
            }
        }
    }
}
