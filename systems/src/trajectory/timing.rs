//! From smooth paths to segments over time: the fastest motion that keeps the limits of velocity and acceleration, with the robot at rest
//! at every stop, and standing still while a hand takes or lets go of something.

use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::Model;
use crate::trajectory::held_speed::HeldSpeed;
use crate::trajectory::rows::Rows;
use crate::trajectory::smoothing::SmoothPath;
use crate::trajectory::stretch::Stretch;
use foliate_components::path::Segment;
use foliate_components::robot::configuration::Group;
use foliate_kernels::trajectory::{
    Ceiling, JerkError, JerkScratch, Limits, Spline, TimedPath, TimingError, TimingScratch, TimingSettings, limit_jerk,
    peak_rates, time_optimal_below,
};

/// How long a motion takes that is as short as rounding, seconds.
const HARDLY_MOVING: f64 = 1e-3;

/// Knots that are closer than this are one, seconds.
const APART: f64 = 1e-5;

/// Buffers of one thread.
#[derive(Debug, Default)]
pub(crate) struct TimingBuffers {
    timing: TimingScratch,
    jerk: JerkScratch,
    smoothed: Spline,
}

/// Why a stretch gets no times.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StretchError {
    /// Limits of velocity and acceleration allow no motion.
    #[error(transparent)]
    Timing(#[from] TimingError),
    /// Limits of jerk allow none.
    #[error(transparent)]
    Jerk(#[from] JerkError),
    /// The root of a robot turns, and there are limits of jerk.
    #[error("limits of jerk cannot be kept by a root that turns freely; leave jerk_ramp out")]
    TurningRoot,
}

/// The segments of a stretch, from time 0, and how long it takes.
///
/// # Errors
/// Limits that allow no motion.
pub(crate) fn segments(
    model: &Model,
    motions: &[LeafMotion],
    (stretch, paths): (&Stretch, &[SmoothPath]),
    buffers: &mut TimingBuffers,
) -> Result<(Vec<Segment>, f64), StretchError> {
    let size = model.problem.robot.space.size();
    let held = HeldSpeed::of(model, motions, stretch);
    let motions = &motions[stretch.motions.clone()];
    let mut now = 0.0;
    let mut rows = Rows::beginning_at(model, motions, stretch, motions[0].start(size));
    if stretch.begins_with_grasp_change && model.problem.timing.dwell > 0.0 {
        now += model.problem.timing.dwell;
        rows.stand_still_until(now);
    }
    // Motions that stand still where the stretch begins.
    stretch.joints.iter().filter(|joint| **joint == 0).for_each(|_| rows.next_motion());
    let limits = Limits { velocity: &stretch.velocity, acceleration: &stretch.acceleration, jerk: &stretch.jerk };
    let mut timed = TimedPath::default();
    for path in paths {
        let ceiling = |ends| held.ceiling(&path.path, ends);
        let ceiling: Option<Ceiling<'_>> = if held.is_empty() { None } else { Some(&ceiling) };
        let settings = TimingSettings::default();
        time_optimal_below(&path.path, limits, ceiling, settings, &mut buffers.timing, &mut timed)?;
        let mut joints: Vec<usize> = path.joints.iter().map(|&joint| cut_at(&mut timed, joint)).collect();
        if limits.jerk.iter().any(|limit| limit.is_finite()) {
            bound_jerk(model, stretch, limits, (&mut timed.curve, &mut joints), buffers)?;
        }
        let curve = &mut timed.curve;
        normalise(model, &stretch.carried, curve);
        let slower = slow_down(curve, limits, held.share(curve));
        for knot in 1..curve.len() {
            rows.push(now + slower * curve.parameters()[knot], curve.knot(knot), curve.velocity(knot));
            joints.iter().filter(|joint| **joint == knot).for_each(|_| rows.next_motion());
        }
        now += slower * curve.extent();
    }
    if paths.is_empty() && stretch.knots.len() > size {
        now += HARDLY_MOVING;
        rows.push(now, &stretch.knots[size..], &vec![0.0; size]);
    }
    Ok((rows.segments(motions[motions.len() - 1].end(size)), now))
}

/// Makes the acceleration continuous and bounds the jerk. The joints are the knots at which the curve passes them as late as the whole
/// curve is.
fn bound_jerk(
    model: &Model,
    stretch: &Stretch,
    limits: Limits<'_>,
    (curve, joints): (&mut Spline, &mut [usize]),
    buffers: &mut TimingBuffers,
) -> Result<(), StretchError> {
    let factors = &model.problem.robot.space.factors;
    if factors.iter().any(|factor| factor.group == Group::FreeFlyer && !stretch.carried[factor.q]) {
        return Err(StretchError::TurningRoot);
    }
    let times: Vec<f64> = joints.iter().map(|&joint| curve.parameters()[joint]).collect();
    let report = limit_jerk(curve, limits, &mut buffers.jerk, &mut buffers.smoothed)?;
    std::mem::swap(curve, &mut buffers.smoothed);
    for (joint, time) in joints.iter_mut().zip(times) {
        let time = if time < curve.extent() - 2.0 * report.delay { time + report.delay } else { curve.extent() };
        let near = curve.parameters().iter().position(|knot| (knot - time).abs() < APART);
        *joint = near.unwrap_or_else(|| curve.cut(time));
    }
    Ok(())
}

/// Cuts a curve where it passes a parameter of its path, and returns the knot there. A knot that is close is taken.
fn cut_at(timed: &mut TimedPath, parameter: f64) -> usize {
    let piece = timed.parameters.partition_point(|p| *p <= parameter).saturating_sub(1);
    let last = timed.curve.pieces();
    if piece >= last {
        return last;
    }
    // On a straight piece the share of the way is that of the coordinate that moves most.
    let share = (parameter - timed.parameters[piece]) / (timed.parameters[piece + 1] - timed.parameters[piece]);
    let (from, to) = (timed.curve.knot(piece), timed.curve.knot(piece + 1));
    let way = |i: usize| (to[i] - from[i]).abs();
    let coordinate = (0..from.len()).max_by(|&a, &b| way(a).total_cmp(&way(b))).unwrap_or(0);
    let cubic = timed.curve.cubic(piece, coordinate);
    let target = from[coordinate] + share * (to[coordinate] - from[coordinate]);
    let rises = to[coordinate] > from[coordinate];
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for _ in 0..60 {
        let middle = low.midpoint(high);
        if (cubic.position(middle) < target) == rises { low = middle } else { high = middle }
    }
    let after = low * timed.curve.width(piece);
    if after < APART {
        return piece;
    }
    if timed.curve.width(piece) - after < APART {
        return piece + 1;
    }
    let knot = timed.curve.cut(timed.curve.parameters()[piece] + after);
    timed.parameters.insert(knot, parameter);
    knot
}

/// Makes the quaternions at knots of length 1, of everything that does not follow a carrier. Velocities are those of the scaled curve.
fn normalise(model: &Model, carried: &[bool], curve: &mut Spline) {
    let factors = &model.problem.robot.space.factors;
    for factor in factors.iter().filter(|factor| factor.group == Group::FreeFlyer && !carried[factor.q]) {
        let numbers = factor.q + 3..factor.q + 7;
        for knot in 0..curve.len() {
            let length = curve.knot(knot)[numbers.clone()].iter().map(|x| x * x).sum::<f64>().sqrt();
            curve.knot_mut(knot)[numbers.clone()].iter_mut().for_each(|x| *x /= length);
            let unit: Vec<f64> = curve.knot(knot)[numbers.clone()].to_vec();
            let velocity = &mut curve.velocity_mut(knot)[numbers.clone()];
            let along: f64 = velocity.iter().zip(&unit).map(|(v, x)| v * x).sum();
            velocity.iter_mut().zip(&unit).for_each(|(v, x)| *v = (*v - along * x) / length);
        }
    }
}

/// By how much the curve has to be slower to keep its limits: a scaled quaternion turns a little faster than its numbers did, and an object
/// that is held uses the share `held` of its speed. The velocities are those of the slower curve.
fn slow_down(curve: &mut Spline, limits: Limits<'_>, held: f64) -> f64 {
    let peaks = peak_rates(curve, limits);
    let share = peaks.velocity.share.max(peaks.acceleration.share.sqrt()).max(held);
    if share <= 1.0 {
        return 1.0;
    }
    let slower = share * (1.0 + 1e-12);
    (0..curve.len()).for_each(|knot| curve.velocity_mut(knot).iter_mut().for_each(|v| *v /= slower));
    slower
}
