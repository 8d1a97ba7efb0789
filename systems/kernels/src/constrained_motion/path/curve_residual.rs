//! How far rows leave zero along a curve over time.
//!
//! The curve is walked in steps. Within a step the rows are at most the larger of their lengths at its two ends, plus ⅛ sup‖f″‖,
//! which the largest speeds and accelerations of the step's cubics bound (`bounds`). A step is as long as the tolerance lets it be.

use crate::constrained_motion::bounds::joint_links::Pace;
use crate::constrained_motion::bounds::point_rates::BoundMemory;
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::constrained_motion::program::scratch::Scratch;
use crate::constrained_motion::rows::blocks::locked_value;
use crate::curve::cubic::Cubic;
use crate::curve::hermite::{HermiteCurve, normalise_quaternions};
use crate::curve::turning::Turning;
use foliate_components::Pose;
use foliate_components::robot::configuration::{ConfigurationSpace, Group};

/// Steps are not shorter than this, as a share of a piece.
const SHORTEST: f64 = 1e-6;
/// Places of a curve that are evaluated at most.
const MOST_PLACES: usize = 200_000;
/// The share of what a bound promises that is tried next.
const SAFETY: f64 = 0.9;
/// A coordinate that is locked moves by no more than this where there are implicit rows, radians and metres: bounds between places
/// count on it. Without rows its error alone counts.
const STILL: f64 = 1e-12;

/// Working memory of one thread.
#[derive(Clone, Debug, Default)]
pub struct CurveScratch {
    solve: Scratch,
    bound: BoundMemory,
    /// Where bodies are at the start of a step.
    start: Vec<Pose>,
    q: Vec<f64>,
    delta: Vec<f64>,
    bend: Vec<f64>,
    /// Of the current piece.
    cubics: Vec<Cubic>,
}

/// A place of a curve around which its residual is not proved to be within the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffLeaf {
    /// The piece, from 0.
    pub piece: usize,
    /// How far along it, in [0, 1].
    pub u: f64,
}

/// At least the largest residual of a program's implicit rows, checks and locked joints anywhere along a curve, metres and
/// radians, with eliminated objects where their carriers take them; proved over the continuum. What is one vector (a
/// translation, a rotation, what a balance asks) counts with its length.
///
/// # Errors
/// Where that is not proved to be within `tolerance`: the curve leaves the leaf, is not sound
/// ([`HermiteCurve::is_sound`]), moves a locked joint, or would take too many places; the arguments do not fit; or another pair of
/// polygons may be in contact elsewhere (a placement that is not given by an argument).
pub fn curve_residual(
    program: &ConstraintProgram,
    space: &ConfigurationSpace,
    curve: &HermiteCurve<'_>,
    arguments: &[Pose],
    tolerance: f64,
    scratch: &mut CurveScratch,
) -> Result<f64, OffLeaf> {
    let size = space.size();
    let off = |piece, u| OffLeaf { piece, u };
    if size != program.configuration_size() || !curve.is_sound(space) || !program.is_smooth() {
        return Err(off(0, 0.0));
    }
    let mut walk = Walk { program, space, arguments, tolerance, scratch, places: 0, width: 1.0 };
    let Some(first) = curve.knots.get(..size) else { return Ok(0.0) };
    walk.scratch.q.clear();
    walk.scratch.q.extend_from_slice(first);
    let mut error = walk.error().ok_or(off(0, 0.0))?;
    walk.take();
    let mut worst = error;
    for piece in 0..curve.pieces() {
        walk.scratch.cubics.clear();
        walk.scratch.cubics.extend((0..size).map(|coordinate| curve.cubic(size, piece, coordinate)));
        worst = worst.max(walk.locked().ok_or(off(piece, 0.0))?);
        if program.rows() > 0 {
            let most = walk.piece(&mut error).map_err(|u| off(piece, u))?;
            worst = worst.max(most);
        }
        // Compared so that NaN is off.
        let is_within = worst <= tolerance;
        if !is_within {
            return Err(off(piece, 0.0));
        }
    }
    if worst <= tolerance { Ok(worst) } else { Err(off(0, 0.0)) }
}

/// A curve on the way.
struct Walk<'a> {
    program: &'a ConstraintProgram,
    space: &'a ConfigurationSpace,
    arguments: &'a [Pose],
    tolerance: f64,
    scratch: &'a mut CurveScratch,
    places: usize,
    /// The next step, as a share of a piece.
    width: f64,
}

impl Walk<'_> {
    /// The error at `scratch.q`.
    fn error(&mut self) -> Option<f64> {
        self.places += 1;
        let CurveScratch { solve, q, .. } = self.scratch;
        (self.places <= MOST_PLACES).then(|| self.program.longest_error(q, self.arguments, solve)).flatten()
    }

    /// Steps start from where the error was asked last.
    fn take(&mut self) {
        let CurveScratch { solve, start, .. } = self.scratch;
        start.clear();
        start.extend_from_slice(solve.poses());
    }

    /// How far locked joints are from their values on the current piece.
    fn locked(&self) -> Option<f64> {
        let mut worst = 0.0_f64;
        for locked in &self.program.locked {
            let (low, high) = self.scratch.cubics[locked.coordinate].range();
            if high - low > STILL && self.program.rows() > 0 {
                return None;
            }
            let value = locked_value(locked.value, self.arguments);
            worst = worst.max((low - value).abs()).max((high - value).abs());
        }
        Some(worst)
    }

    /// Walks over the current piece, from the error at its start to that at its end: the largest error on it, or how far it goes.
    fn piece(&mut self, error: &mut f64) -> Result<f64, f64> {
        let (mut from, mut worst) = (0.0, *error);
        while from < 1.0 {
            let to = (from + self.width).min(1.0);
            let width = to - from;
            let room = self.tolerance - *error;
            let bound = self.bound(from, to);
            // How long a step the bound has room for, as a share of this one.
            let promised = if bound > 0.0 { (room / bound).sqrt() } else { f64::INFINITY };
            let fits = bound <= room;
            if fits {
                self.go_to(to);
                let next = self.error().ok_or(from)?;
                let most = error.max(next) + bound;
                if most <= self.tolerance {
                    self.take();
                    (from, *error, worst) = (to, next, worst.max(most));
                    // The last step of a piece is cut short, and promises more.
                    self.width = (SAFETY * promised * width).clamp(width, 1.0);
                    continue;
                }
                if next > self.tolerance {
                    return Err(to);
                }
            }
            if width <= SHORTEST {
                return Err(from);
            }
            let shorter = if promised > 0.0 { (SAFETY * promised).clamp(0.1, 0.7) } else { 0.5 };
            self.width = shorter * width;
        }
        Ok(worst)
    }

    fn go_to(&mut self, u: f64) {
        let CurveScratch { q, cubics, .. } = self.scratch;
        q.iter_mut().zip(cubics.iter()).for_each(|(x, cubic)| *x = cubic.at(u));
        normalise_quaternions(self.space, q);
    }

    /// How far rows can be from the straight line between their values at two places of the current piece.
    fn bound(&mut self, from: f64, to: f64) -> f64 {
        let CurveScratch { cubics, delta, bend, start, bound, .. } = self.scratch;
        set_pace(self.space, cubics, (from, to), delta, bend);
        if !delta.iter().chain(bend.iter()).all(|x| x.is_finite()) {
            return f64::INFINITY;
        }
        // Bounds of rotations take the nearer end for exact; here it is off by the tolerance at most.
        (1.0 + self.tolerance) * self.program.residual_bound().over(&Pace { delta, bend }, start, bound)
    }
}

/// The largest speeds and accelerations between two places of a piece, for the way from the one to the other as unit of time.
pub(crate) fn set_pace(
    space: &ConfigurationSpace,
    cubics: &[Cubic],
    (from, to): (f64, f64),
    delta: &mut Vec<f64>,
    bend: &mut Vec<f64>,
) {
    let (middle, half, width) = (from.midpoint(to), 0.5 * (to - from), to - from);
    for buffer in [&mut *delta, &mut *bend] {
        buffer.clear();
        buffer.resize(space.dimension(), 0.0);
    }
    for factor in &space.factors {
        let (q, v) = (factor.q, factor.v);
        let mut number = |k: usize| {
            let here = cubics[q + k].about(middle);
            (delta[v + k], bend[v + k]) = (here.fastest(half) * width, here.most_bent(half) * width * width);
        };
        match factor.group {
            Group::Real | Group::Circle => number(0),
            Group::Plane => (0..3).for_each(number),
            Group::FreeFlyer => {
                (0..3).for_each(number);
                // Per half of the width.
                let turning = Turning::of(&[3, 4, 5, 6].map(|k| cubics[q + k]), middle, half);
                (delta[v + 3], bend[v + 3]) = (2.0 * turning.rate, 4.0 * turning.bend);
            }
        }
    }
}
