//! The proof of a whole path with times: limits, leaves, carried objects and clearance, of the curves themselves.
//!
//! It asks of each segment what a checker of the path file asks. Its curve is sound and goes on where the one before ends; joints
//! keep their limits; implicit rows stay within the path tolerance; objects are written where their carriers take them; nothing
//! collides at the start, and nothing comes closer than the guard along the way.

use crate::planning_model::attachments::CarrierGap;
use crate::planning_model::model::Model;
use crate::search::path_clearance::{pair_counts, path_clearance};
use crate::search::segment_leaf::{arguments_as_written, attachments_as_written};
use crate::search::timed_rows::TimedRows;
use crate::settings::SearchSettings;
use crate::step::validation::certificate_settings;
use foliate_components::graph::{ConstraintKind, StateId};
use foliate_components::path::{Certificate, ManipulationPath, Segment};
use foliate_components::robot::{ShapeIndex, Source};
use foliate_kernels::collision::{CollisionScratch, CurveVerdict, certify_curve};
use foliate_kernels::constrained_motion::{CurveScratch, OffLeaf, curve_residual};
use foliate_kernels::curve::HermiteCurve;
use foliate_kernels::kinematics::RigidAttachment;
use std::ops::Range;

/// How far beyond its limits a coordinate may be, radians and metres: rounding.
const SLACK: f64 = 1e-9;
/// How far a carried object may be written from where its carrier takes it, metres and radians: as the check of path files asks.
const OFF_CARRIER: f64 = 1e-5;

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub struct TimedScratch {
    /// Of proofs of clearance.
    pub collision: CollisionScratch,
    /// Of proofs of residuals.
    pub curve: CurveScratch,
}

/// The first thing found that keeps a path with times from being proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedFault {
    /// Number of the segment, from 0.
    pub segment: usize,
    /// Number of the piece in it, from 0.
    pub piece: usize,
    /// How far along the piece, in [0, 1].
    pub u: f64,
    /// What it is.
    pub kind: TimedFaultKind,
}

/// See [`TimedFault`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TimedFaultKind {
    /// The segment has no times, its rows do not fit, or its curve is none.
    Unsound,
    /// It does not begin with the knot, velocity and time with which the one before ends.
    Gap,
    /// A coordinate exceeds its bounds.
    Limit {
        /// Index in a configuration.
        coordinate: usize,
        /// Its extreme, radians or metres.
        value: f64,
    },
    /// Rows, or what carries objects, are not proved to stay within the path tolerance.
    OffLeaf,
    /// An object is written elsewhere than its carrier takes it, by this much, metres or radians.
    OffCarrier(f64),
    /// It is not proved free: two shapes, where two are too close.
    Collision(Option<(ShapeIndex, ShapeIndex)>),
}

/// Proves a path with times over the continuum, every segment of it, and returns its certificate with `max_residual`,
/// `min_clearance` and `pairs` as they are proved of the curves; what else `path.certificate` says is kept, but for the tolerance,
/// which is that of `settings`. Limits of velocity and acceleration are not looked at.
///
/// # Errors
/// The first fault that is found.
///
/// # Panics
/// If the path is not one of the model's: its ids and its knots' lengths.
pub fn certify_timed_path(
    model: &Model,
    settings: &SearchSettings,
    path: &ManipulationPath,
    scratch: &mut TimedScratch,
) -> Result<Certificate, TimedFault> {
    scratch.collision.set_level(settings.level);
    let mut proved = SegmentProof::default();
    for (number, segment) in path.segments.iter().enumerate() {
        let before = number.checked_sub(1).map(|last| &path.segments[last]);
        if !before.is_none_or(|before| goes_on(model, before, segment)) {
            return Err(TimedFault { segment: number, piece: 0, u: 0.0, kind: TimedFaultKind::Gap });
        }
        let found = certify_timed_segment(model, settings, segment, scratch)
            .map_err(|fault| TimedFault { segment: number, ..fault })?;
        proved.residual = proved.residual.max(found.residual);
        proved.moved = proved.moved.max(found.moved);
    }
    let mut certificate = path.certificate;
    certificate.path_tolerance = settings.path_tolerance;
    certificate.max_residual = proved.residual;
    certificate.pairs = pair_counts(model, path);
    // What keeps the guard keeps this as the path is written. [`path_clearance`] says how close pairs come.
    let kept = settings.clearance_guard - 2.0 * proved.moved;
    certificate.min_clearance = match model.collision.counts().looked_at() {
        0 => None,
        _ if kept > 0.0 => Some(kept),
        _ => path_clearance(model, path).map(|found| found.lower),
    };
    Ok(certificate)
}

/// What is proved of a segment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SegmentProof {
    /// At least the largest residual, metres and radians.
    pub residual: f64,
    /// At most this far is any point of an object from where its carrier takes it, metres.
    pub moved: f64,
}

/// Proves one segment with times, as [`certify_timed_path`] does each; faults name segment 0.
///
/// # Errors
/// The first fault that is found.
///
/// # Panics
/// As [`certify_timed_path`].
pub fn certify_timed_segment(
    model: &Model,
    settings: &SearchSettings,
    segment: &Segment,
    scratch: &mut TimedScratch,
) -> Result<SegmentProof, TimedFault> {
    let fault = |piece, u, kind| TimedFault { segment: 0, piece, u, kind };
    let unsound = fault(0, 0.0, TimedFaultKind::Unsound);
    let rows = TimedRows::of(segment).ok_or(unsound)?;
    let (curve, space) = (rows.curve(), &model.problem.robot.space);
    if curve.pieces() == 0 || !curve.is_sound(space) {
        return Err(unsound);
    }
    if let Some(fault) = limit_exceeded(model, segment, &curve) {
        return Err(fault);
    }
    let interior = model.interior_program(segment.state).map_err(|_| unsound)?;
    let arguments = arguments_as_written(model, segment, interior);
    // As much less than allowed as a projection leaves at knots.
    let tolerance = settings.path_tolerance - 2.0 * settings.projection_tolerance;
    let residual = curve_residual(&interior.program, space, &curve, &arguments, tolerance, &mut scratch.curve)
        .map_err(|OffLeaf { piece, u }| fault(piece, u, TimedFaultKind::OffLeaf))?;
    let rigid_attachments = attachments_as_written(model, segment);
    let gap = model.gap_along(segment.state, &rigid_attachments, &segment.knots);
    // Compared so that NaN is off.
    let is_carried = gap.written <= OFF_CARRIER;
    if !is_carried {
        return Err(fault(0, 0.0, TimedFaultKind::OffCarrier(gap.written)));
    }
    let holds = gap.residual <= settings.path_tolerance;
    if !holds {
        return Err(fault(0, 0.0, TimedFaultKind::OffLeaf));
    }
    let clearance = certify_clearance(model, settings, segment, &curve, &rigid_attachments, scratch);
    clearance.map_or(Ok(proof(residual, gap)), Err)
}

fn proof(residual: f64, gap: CarrierGap) -> SegmentProof {
    SegmentProof { residual: residual.max(gap.residual), moved: gap.moved }
}

/// Whether a segment begins where, when and as fast as the one before ends. Velocities of objects with a carrier mean nothing.
fn goes_on(model: &Model, before: &Segment, segment: &Segment) -> bool {
    let (Some(ended), Some(begun)) = (&before.timing, &segment.timing) else { return true };
    let objects = object_numbers(model);
    let is_robot = |i: usize| !objects.iter().any(|numbers| numbers.contains(&i));
    let same_velocity =
        |a: &Vec<f64>, b: &Vec<f64>| (0..a.len().max(b.len())).all(|i| !is_robot(i) || a.get(i) == b.get(i));
    before.knots.last() == segment.knots.first()
        && ended.times.last() == begun.times.first()
        && match (ended.velocities.last(), begun.velocities.first()) {
            (Some(a), Some(b)) => same_velocity(a, b),
            _ => false,
        }
}

/// The numbers of movable objects' roots.
pub(crate) fn object_numbers(model: &Model) -> Vec<Range<usize>> {
    let roots = model.objects().iter().filter_map(|object| object.root);
    let numbers = |root: foliate_components::robot::JointIndex| match model.problem.robot.joints[root.at()].source {
        Source::Coordinates { q, .. } => q..q + 7,
        Source::Follows { .. } => 0..0,
    };
    roots.map(numbers).collect()
}

/// Robots keep their limits all along; objects keep their bounds where they rest.
fn limit_exceeded(model: &Model, segment: &Segment, curve: &HermiteCurve<'_>) -> Option<TimedFault> {
    let space = &model.problem.robot.space;
    let objects = object_numbers(model);
    let of_robots = |i: usize| !objects.iter().any(|numbers| numbers.contains(&i));
    let fault = |piece, u, coordinate, value| TimedFault {
        segment: 0,
        piece,
        u,
        kind: TimedFaultKind::Limit { coordinate, value },
    };
    if let Some(limit) = curve.first_out_of_bounds(space, SLACK, of_robots) {
        return Some(fault(limit.piece, 0.0, limit.coordinate, limit.value));
    }
    let last = segment.knots.len() - 1;
    [0, last].into_iter().find_map(|knot| {
        let i = resting_out_of_bounds(model, segment.state, &segment.knots[knot], SLACK)?;
        let piece = knot.saturating_sub(1);
        Some(fault(piece, (knot - piece) as f64, i, segment.knots[knot][i]))
    })
}

/// The first coordinate of an object that no hand holds in a state which is outside its bounds by more than `tolerance`, radians and metres.
pub(crate) fn resting_out_of_bounds(model: &Model, state: StateId, q: &[f64], tolerance: f64) -> Option<usize> {
    let space = &model.problem.robot.space;
    let carriers = model.carriers(state);
    let is_held = |object: usize| {
        let carried_by = carriers.of[object];
        carried_by.is_some_and(|c| matches!(model.graph.constraint(c).kind, ConstraintKind::Grasp { .. }))
    };
    let rests = |(object, _): &(usize, _)| !is_held(*object);
    let mut roots = model.objects().iter().enumerate().filter(rests).filter_map(|(_, object)| object.root);
    roots.find_map(|root| {
        let Source::Coordinates { q: first, .. } = model.problem.robot.joints[root.at()].source else { return None };
        (first..first + 3).find(|&i| !(q[i] >= space.lower[i] - tolerance && q[i] <= space.upper[i] + tolerance))
    })
}

/// Nothing collides where the segment begins, and nothing comes too close along it.
fn certify_clearance(
    model: &Model,
    settings: &SearchSettings,
    segment: &Segment,
    curve: &HermiteCurve<'_>,
    rigid_attachments: &[RigidAttachment],
    scratch: &mut TimedScratch,
) -> Option<TimedFault> {
    let fault = |piece, u, pair| TimedFault { segment: 0, piece, u, kind: TimedFaultKind::Collision(pair) };
    let start = &segment.knots[0];
    let mut X_WJ = model.kinematics.poses(start);
    model.kinematics.carry(start, rigid_attachments, &mut X_WJ);
    let guard = settings.clearance_guard;
    if let Some(contact) = model.first_collision_along(segment.transition, &X_WJ, guard, &mut scratch.collision) {
        return Some(fault(0, 0.0, Some(model.pair_shapes(contact.pair))));
    }
    let pairs = model.pairs(segment.transition, segment.state, rigid_attachments);
    let certificate = certificate_settings(settings, true);
    let (scene, kinematics) = (&model.collision, &model.kinematics);
    match certify_curve(scene, kinematics, rigid_attachments, curve, pairs, &certificate, &mut scratch.collision) {
        CurveVerdict::Free { .. } => None,
        CurveVerdict::Blocked { piece, u, blocked_by } => {
            Some(fault(piece, u, blocked_by.map(|contact| model.pair_shapes(contact.pair))))
        }
    }
}
