//! Limits of positions, velocities and accelerations, over the continuum: of polynomials, not of samples.

use crate::certify::motion::piecewise::{Curve, Motion};
use crate::certify::motion::polynomial::Polynomial;
use crate::certify::world::phases::Phase;
use crate::certify::world::report::{LimitKind, LimitViolation, LimitsReport, Peak};
use foliate_components::robot::{Joint, JointIndex, JointType as JointMotion, PartKind, Robot, Source};

/// Values outside of a limit by less than this are on it: radians, metres, and per second.
const TOLERANCE: f64 = 1e-9;
/// Velocities at a point that differ by less than this share are the same.
const SMOOTH: f64 = 1e-6;

/// What velocities and accelerations may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Rates {
    /// Velocity limits of the models times this.
    pub velocity_scale: f64,
    /// Velocity limits in their place, by `part/joint`.
    pub velocity: Vec<(String, f64)>,
    /// An acceleration limit of all joints; none for no limit.
    pub acceleration: Option<f64>,
    /// Acceleration limits in its place, by `part/joint`.
    pub accelerations: Vec<(String, f64)>,
}

impl Default for Rates {
    fn default() -> Self {
        Self { velocity_scale: 1.0, velocity: Vec::new(), acceleration: None, accelerations: Vec::new() }
    }
}

impl Rates {
    fn velocity_of(&self, joint: &Joint) -> Option<f64> {
        let own = self.velocity.iter().rev().find(|(name, _)| *name == joint.name).map(|(_, limit)| *limit);
        own.or_else(|| joint.velocity_limit.filter(|l| *l > 0.0).map(|limit| limit * self.velocity_scale))
    }

    fn acceleration_of(&self, joint: &Joint) -> Option<f64> {
        let own = self.accelerations.iter().rev().find(|(name, _)| *name == joint.name).map(|(_, limit)| *limit);
        own.or(self.acceleration)
    }
}

/// One number of a joint, driven by a column of the motion.
struct Axis<'a> {
    name: String,
    column: usize,
    multiplier: f64,
    offset: f64,
    bounds: (f64, f64),
    joint: &'a Joint,
    /// Whether it is the joint's only number, so that limits of joints apply.
    alone: bool,
}

/// Checks all joints that a motion moves.
pub(crate) fn look(robot: &Robot, motion: &Motion, rates: &Rates) -> LimitsReport {
    let mut report = LimitsReport::default();
    for axis in axes(robot, motion) {
        report.positions += 1;
        report.violations.extend(position(motion, &axis));
        if !motion.timed || !axis.alone {
            continue;
        }
        if let Some(limit) = rates.velocity_of(axis.joint) {
            report.velocities += 1;
            let found = derivative(motion, &axis, 1, (LimitKind::Velocity, limit));
            report.violations.extend(found.1);
            keep_peak(&mut report.velocity_peak, found.0);
        }
        if let Some(limit) = rates.acceleration_of(axis.joint) {
            report.accelerations += 1;
            let found = derivative(motion, &axis, 2, (LimitKind::Acceleration, limit));
            report.violations.extend(found.1);
            keep_peak(&mut report.acceleration_peak, found.0);
            report.violations.extend(jump(motion, &axis));
        }
    }
    report.violations.sort_by(|a, b| a.first_at.total_cmp(&b.first_at));
    report
}

/// Names the objects that move and whose root bounds are not checked.
pub(crate) fn not_looked_at(robot: &Robot, motion: &Motion, phases: &[Phase]) -> Option<String> {
    let moves = |root: JointIndex| {
        let joint = &robot.joints[root.at()];
        let driven = match joint.source {
            Source::Coordinates { q, .. } => q..q + joint.motion.configuration_size(),
            Source::Follows { .. } => 0..0,
        };
        motion.coordinates.iter().any(|c| driven.contains(c))
            || phases.iter().any(|phase| phase.rigid_attachments.iter().any(|c| c.object == root))
    };
    let objects = robot.parts.iter().filter(|part| part.kind == PartKind::Object && part.root_joint.is_some_and(moves));
    let names: Vec<&str> = objects.map(|part| part.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        let names = names.join(", ");
        format!("bounds of the roots of objects are not checked, neither on the way nor where they are put: {names}")
    })
}

fn axes<'a>(robot: &'a Robot, motion: &Motion) -> Vec<Axis<'a>> {
    let mut axes = Vec::new();
    for (index, joint) in robot.joints.iter().enumerate() {
        // Bounds of an object's root say where it may be put, not where it may be carried: `not_looked_at` tells.
        let part = &robot.parts[joint.part.at()];
        if part.kind == PartKind::Object && part.root_joint.is_some_and(|root| root.at() == index) {
            continue;
        }
        let (q, multiplier, offset) = match joint.source {
            Source::Coordinates { q, .. } => (q, 1.0, 0.0),
            Source::Follows { leader, multiplier, offset } => match robot.joints[leader.at()].source {
                Source::Coordinates { q, .. } => (q, multiplier, offset),
                Source::Follows { .. } => continue,
            },
        };
        let names: &[&str] = match joint.motion {
            JointMotion::Revolute { .. } | JointMotion::Prismatic { .. } => &[""],
            JointMotion::Planar => &["/x", "/y", "/theta"],
            JointMotion::FreeFlyer => &["/x", "/y", "/z"],
        };
        for (i, suffix) in names.iter().enumerate() {
            let Some(column) = motion.coordinates.iter().position(|&c| c == q + i) else { continue };
            let bounds = (joint.lower[i], joint.upper[i]);
            let name = format!("{}{suffix}", joint.name);
            axes.push(Axis { name, column, multiplier, offset, bounds, joint, alone: names.len() == 1 });
        }
    }
    axes
}

impl Axis<'_> {
    fn curves<'m>(&'m self, motion: &'m Motion) -> impl Iterator<Item = (f64, f64, Polynomial)> + 'm {
        motion.segments.iter().filter_map(move |s| match s.curves[self.column] {
            Curve::Number(p) => Some((s.start, s.duration, p.scaled(self.multiplier, self.offset))),
            Curve::Quaternion => None,
        })
    }
}

fn position(motion: &Motion, axis: &Axis<'_>) -> Option<LimitViolation> {
    let sides = [(axis.bounds.1, 1.0), (axis.bounds.0, -1.0)];
    let found = sides.into_iter().filter(|(limit, _)| limit.is_finite());
    let broken = found.filter_map(|(limit, sign)| {
        let curves = axis.curves(motion).map(|(start, duration, p)| (start, duration, p.scaled(sign, 0.0)));
        let (first_at, worst, worst_at) = exceeds(curves, sign * limit)?;
        let (kind, joint) = (LimitKind::Position, axis.name.clone());
        Some(LimitViolation { joint, kind, limit, first_at, worst: sign * worst, worst_at })
    });
    broken.max_by(|a, b| (a.worst - a.limit).abs().total_cmp(&(b.worst - b.limit).abs()))
}

/// The largest share of a limit, and how it is broken.
fn derivative(
    motion: &Motion,
    axis: &Axis<'_>,
    order: i32,
    (kind, limit): (LimitKind, f64),
) -> (Option<Peak>, Option<LimitViolation>) {
    let slope = |p: Polynomial| if order == 1 { p.derivative() } else { p.derivative().derivative() };
    let signed = |sign: f64| {
        axis.curves(motion)
            .map(move |(start, duration, p)| (start, duration, slope(p).scaled(sign / duration.powi(order), 0.0)))
    };
    let mut peak: Option<Peak> = None;
    let mut broken: Option<LimitViolation> = None;
    for sign in [1.0, -1.0] {
        for (start, duration, p) in signed(sign) {
            for u in p.turning_points(0.0, 1.0) {
                let (value, at) = (p.at(u), start + u * duration);
                if peak.as_ref().is_none_or(|best| value > best.value) {
                    peak = Some(Peak { joint: axis.name.clone(), value, limit, at });
                }
            }
        }
        let Some((first_at, worst, worst_at)) = exceeds(signed(sign), limit) else { continue };
        let (joint, worst) = (axis.name.clone(), sign * worst);
        let new = LimitViolation { joint, kind, limit, first_at, worst, worst_at };
        broken = Some(match broken {
            None => new,
            Some(old) => {
                let first_at = old.first_at.min(new.first_at);
                let worse = if old.worst.abs() >= new.worst.abs() { old } else { new };
                LimitViolation { first_at, ..worse }
            }
        });
    }
    (peak, broken)
}

/// Where curves are first above a limit, and where most.
fn exceeds(curves: impl Iterator<Item = (f64, f64, Polynomial)>, limit: f64) -> Option<(f64, f64, f64)> {
    let tolerated = limit + TOLERANCE * limit.abs().max(1.0);
    let mut found: Option<(f64, f64, f64)> = None;
    for (start, duration, p) in curves {
        let time = |u: f64| start + u * duration;
        for u in p.turning_points(0.0, 1.0) {
            let value = p.at(u);
            // Compared so that NaN is outside.
            let inside = value <= tolerated;
            if inside {
                continue;
            }
            let first = || {
                let crossings = p.scaled(1.0, -limit).roots(0.0, u);
                if p.at(0.0) > tolerated { 0.0 } else { crossings.first().copied().unwrap_or(u) }
            };
            found = Some(match found {
                None => (time(first()), value, time(u)),
                Some((first, worst, _)) if value > worst => (first, value, time(u)),
                Some(known) => known,
            });
        }
    }
    found
}

/// The first point at which the velocity jumps, with the largest jump.
fn jump(motion: &Motion, axis: &Axis<'_>) -> Option<LimitViolation> {
    let curves: Vec<_> = axis.curves(motion).map(|(start, duration, p)| (start, duration, p.derivative())).collect();
    let mut found: Option<LimitViolation> = None;
    for ends in curves.windows(2) {
        let (before, after) = (ends[0].2.at(1.0) / ends[0].1, ends[1].2.at(0.0) / ends[1].1);
        let by = after - before;
        if by.abs() <= SMOOTH * (1.0 + before.abs()) {
            continue;
        }
        let (joint, kind, at) = (axis.name.clone(), LimitKind::VelocityJump, ends[1].0);
        let new = LimitViolation { joint, kind, limit: 0.0, first_at: at, worst: by, worst_at: at };
        found = Some(match found {
            None => new,
            Some(old) if by.abs() > old.worst.abs() => LimitViolation { first_at: old.first_at, ..new },
            Some(old) => old,
        });
    }
    found
}

fn keep_peak(best: &mut Option<Peak>, new: Option<Peak>) {
    let share = |peak: &Peak| peak.value / peak.limit;
    if let Some(new) = new
        && best.as_ref().is_none_or(|best| share(&new) > share(best))
    {
        *best = Some(new);
    }
}
