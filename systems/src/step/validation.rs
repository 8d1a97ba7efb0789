//! Set Validate: certifies the legs over the continuum and keeps the valid prefix (P1 Alg. 2 line 10).

use crate::events::StopSignal;
use crate::exploration::search_log::SearchLog;
use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::each;
use crate::runtime::scratch_pool::ScratchPool;
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use crate::step::waypoints::waypoints_are_free;
use bevy_ecs::prelude::{Local, Query, Res, ResMut};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena, PlannedLeg};
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::graph::{StateId, TransitionId, TransitionKind};
use foliate_components::outcome::Rejection;
use foliate_components::robot::ShapeIndex;
use foliate_kernels::collision::{
    CertificateSettings, CollisionScratch, Contact, PairSet, PolylineVerdict, certify_polyline,
};
use foliate_kernels::kinematics::RigidAttachment;
use foliate_kernels::lanes::Level;
use std::cmp::Reverse;

/// Buffers of one thread.
#[derive(Debug, Default)]
pub struct ValidationScratch {
    collision: CollisionScratch,
    X_WJ: Vec<Pose>,
}

impl ValidationScratch {
    fn fit(&mut self, model: &PlanningModel, level: Level) {
        self.collision.set_level(level);
        self.X_WJ.resize(model.kinematics.bodies(), Pose::identity());
    }
}

/// Certifies every candidate's legs in order; after the first that is only free in part, nothing more is kept. A lazy extension
/// becomes an unvalidated edge, whose motions are certified when they are needed.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn certify_legs(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    leaves: Res<'_, LeafIndex>,
    log: Option<Res<'_, SearchLog>>,
    mut counter: ResMut<'_, StepCounter>,
    mut arena: ResMut<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
    buffers: Local<'_, ScratchPool<ValidationScratch>>,
) {
    let mut pool: Vec<_> = candidates.iter_mut().collect();
    let buffers = &*buffers;
    let projected = |c: &Candidate| c.is_alive() || matches!(c.rejected, Some(Rejection::WaypointBlocked(_)));
    counter.validated += pool.iter().filter(|c| projected(c)).count() as u64;
    let CandidateArena { legs, complete, .. } = &mut *arena;
    let mut slots: Vec<_> = pool.iter_mut().zip(legs.iter_mut().zip(complete)).collect();
    // The longest motions first, so that none is left alone at the end.
    let length = |legs: &[PlannedLeg]| legs.iter().map(|leg| model.length(&leg.knots)).sum::<f64>();
    slots.sort_by_cached_key(|(_, (legs, _))| Reverse(length(legs).to_bits()));
    each(
        &mut slots,
        || buffers.borrow(),
        |scratch, (candidate, (legs, complete))| {
            scratch.fit(&model, settings.level);
            if stop.is_raised() {
                candidate.reject(Rejection::Stopped);
            }
            if candidate.is_alive() || candidate.is_cut_short() {
                **complete = certify_candidate(&model, &settings, (&leaves, log.as_deref()), candidate, legs, scratch);
            } else {
                legs.clear();
            }
        },
    );
}

/// Returns whether all legs are certified; cuts `legs` to what is.
fn certify_candidate(
    model: &PlanningModel,
    settings: &SearchSettings,
    (leaves, log): (&LeafIndex, Option<&SearchLog>),
    candidate: &mut Candidate,
    legs: &mut Vec<PlannedLeg>,
    scratch: &mut ValidationScratch,
) -> bool {
    let Some(transition) = candidate.transition else { return false };
    // A scheduler may leave out the check in front of Steer, never the verdict itself.
    if !candidate.waypoints_are_free && !waypoints_are_free(model, settings, candidate, legs, &mut scratch.collision) {
        legs.clear();
        return false;
    }
    let whole = candidate.is_alive();
    if whole && !candidate.commit_as.needs_certificate() {
        return true;
    }
    for index in 0..legs.len() {
        let leg = &mut legs[index];
        let rigid_attachments = model.attachments_of_leg(leg, leaves);
        let free =
            certify_leg(model, settings, (transition, log), &rigid_attachments, leg, candidate, &mut scratch.collision);
        if !free {
            let kept = if moves(model, leg) { index + 1 } else { index };
            legs.truncate(kept);
            end_in_a_state(model, legs);
            keep_margins(model, settings, leaves, transition, legs, scratch);
            return false;
        }
    }
    if !whole {
        end_in_a_state(model, legs);
        keep_margins(model, settings, leaves, transition, legs, scratch);
    }
    whole
}

fn moves(model: &PlanningModel, leg: &PlannedLeg) -> bool {
    leg.knots.len() > model.problem.robot.space.size()
}

/// Drops legs from the end that lie in states which are only passed through: no node lies there.
fn end_in_a_state(model: &PlanningModel, legs: &mut Vec<PlannedLeg>) {
    while legs.last().is_some_and(|leg| model.graph.state(leg.state).is_passed_through()) {
        legs.pop();
    }
}

/// Cuts what is kept of a transition that is not travelled to its end to what keeps the margins of pairs that have not
/// touched by then: whatever goes on from there may never make them touch. The end keeps those of its own state, for other
/// transitions start there.
fn keep_margins(
    model: &PlanningModel,
    settings: &SearchSettings,
    leaves: &LeafIndex,
    transition: TransitionId,
    legs: &mut Vec<PlannedLeg>,
    scratch: &mut ValidationScratch,
) {
    if model.problem.margins.is_empty() || model.graph.transition(transition).kind == TransitionKind::Loop {
        return;
    }
    let size = model.problem.robot.space.size();
    while let Some(last) = legs.len().checked_sub(1) {
        let states: Vec<StateId> = legs.iter().map(|leg| leg.state).collect();
        let blocked = legs.iter_mut().position(|leg| {
            let rigid_attachments = model.attachments_of_leg(leg, leaves);
            let pairs = model.pairs_on_the_way(transition, &states, &rigid_attachments);
            certified_prefix(model, settings, &pairs, &rigid_attachments, leg, &mut scratch.collision).is_some()
        });
        if let Some(index) = blocked {
            let kept = if moves(model, &legs[index]) { index + 1 } else { index };
            legs.truncate(kept);
            end_in_a_state(model, legs);
            if legs.len() <= last {
                continue;
            }
        }
        let leg = &legs[last];
        let end = &leg.knots[leg.knots.len() - size..];
        model.kinematics.forward(end, &mut scratch.X_WJ);
        let guard = settings.clearance_guard;
        if model.first_collision(leg.state, &scratch.X_WJ, guard, &mut scratch.collision).is_none() {
            return;
        }
        legs.truncate(last);
        end_in_a_state(model, legs);
    }
}

/// Certifies one leg; cuts its knots to the certified prefix (to nothing but the start, where nothing is free).
fn certify_leg(
    model: &PlanningModel,
    settings: &SearchSettings,
    (transition, log): (TransitionId, Option<&SearchLog>),
    rigid_attachments: &[RigidAttachment],
    leg: &mut PlannedLeg,
    candidate: &mut Candidate,
    scratch: &mut CollisionScratch,
) -> bool {
    let pairs = model.pairs(transition, leg.state, rigid_attachments);
    let Some(blocked) = certified_prefix(model, settings, pairs, rigid_attachments, leg, scratch) else {
        return true;
    };
    candidate.rejected = Some(Rejection::MotionBlocked(leg.leg as u8));
    candidate.blocked_by = blocked.contact.map(|c| model.pair_shapes(c.pair));
    // Of a pair that has its place in the log already none is looked for.
    let wanted = candidate.blocked_by.zip(log).is_some_and(|(pair, log)| log.wants((transition, pair)));
    candidate.blocked_at = blocked.at.filter(|_| wanted).map(|q| carried(model, rigid_attachments, q));
    false
}

/// What ends the certified part of a motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Blocked {
    /// The pair that was found too close, if one was.
    pub contact: Option<Contact>,
    /// The configuration at which it was found, where the search keeps a log; what is carried is not yet where its carriers have it.
    pub at: Option<Box<[f64]>>,
}

impl Blocked {
    /// What was found at a place of a polyline, in pieces from its start.
    fn new(
        model: &PlanningModel,
        settings: &SearchSettings,
        knots: &[f64],
        (contact, at): (Option<Contact>, f64),
    ) -> Self {
        let is_kept = settings.log && contact.is_some();
        Self { contact, at: is_kept.then(|| configuration_at(model, knots, at)) }
    }
}

/// The configuration at a place of a polyline, in pieces from its start.
fn configuration_at(model: &PlanningModel, knots: &[f64], at: f64) -> Box<[f64]> {
    let space = &model.problem.robot.space;
    let size = space.size();
    let last_piece = (knots.len() / size).saturating_sub(2);
    let piece = (at as usize).min(last_piece);
    let start = piece * size;
    let mut q = vec![0.0; size];
    let t = (at - piece as f64).clamp(0.0, 1.0);
    space.interpolate(&knots[start..start + size], &knots[start + size..start + 2 * size], t, &mut q);
    q.into()
}

/// A configuration with what is carried where its carriers have it.
pub(crate) fn carried(model: &PlanningModel, rigid_attachments: &[RigidAttachment], mut q: Box<[f64]>) -> Box<[f64]> {
    carry(model, rigid_attachments, &mut q);
    q
}

/// Writes carried objects where their carriers have them.
fn carry(model: &PlanningModel, rigid_attachments: &[RigidAttachment], q: &mut [f64]) {
    let mut X_WJ = model.kinematics.poses(q);
    model.kinematics.carry(q, rigid_attachments, &mut X_WJ);
    model.kinematics.write_back(rigid_attachments, &X_WJ, q);
}

/// Cuts a leg's knots to the certified prefix; where that is not all of it, what is in the way.
pub(crate) fn certified_prefix(
    model: &PlanningModel,
    settings: &SearchSettings,
    pairs: &PairSet,
    rigid_attachments: &[RigidAttachment],
    leg: &mut PlannedLeg,
    scratch: &mut CollisionScratch,
) -> Option<Blocked> {
    let size = model.problem.robot.space.size();
    let certificate = certificate_settings(settings, false);
    let knots = &leg.knots;
    match certify_polyline(&model.collision, &model.kinematics, rigid_attachments, knots, pairs, &certificate, scratch)
    {
        PolylineVerdict::Free { min_clearance_lower_bound } => {
            leg.clearance = min_clearance_lower_bound;
            None
        }
        PolylineVerdict::FreeUntil { piece, t, blocked_by, blocked_at } => {
            let blocked = Blocked::new(model, settings, knots, (blocked_by, blocked_at));
            // The proof holds for the prefix; how much more clearance it has is not known of a motion that ends in front of
            // something.
            leg.clearance = settings.clearance_guard;
            cut(model, rigid_attachments, leg, piece * size, t);
            Some(blocked)
        }
    }
}

/// Cuts a leg's knots at parameter `t` of the piece that starts at `start`.
fn cut(model: &PlanningModel, rigid_attachments: &[RigidAttachment], leg: &mut PlannedLeg, start: usize, t: f64) {
    let space = &model.problem.robot.space;
    let size = space.size();
    if model.interior_program(leg.state).is_ok_and(|interior| interior.program.rows() > 0) {
        // Between the knots of implicit rows a configuration is on the leaf only to within the path tolerance; a node has
        // to be on it exactly.
        leg.knots.truncate(start + size);
        return;
    }
    let mut end = vec![0.0; size];
    space.interpolate(&leg.knots[start..start + size], &leg.knots[start + size..start + 2 * size], t, &mut end);
    let moved = space.distance(&leg.knots[start..start + size], &end, &model.weights);
    leg.knots.truncate(start + size);
    if moved < LEAST_PROGRESS {
        return;
    }
    carry(model, rigid_attachments, &mut end);
    leg.knots.extend_from_slice(&end);
}

/// A prefix shorter than this (weighted metres) is no progress.
const LEAST_PROGRESS: f64 = 0.01;

/// Certifies a polyline of a transition in one of its states, whole or not at all; returns the proven clearance.
///
/// # Errors
/// Where it is not certified: the pair of shapes that stopped it, where one did.
pub fn certify_whole(
    model: &PlanningModel,
    settings: &SearchSettings,
    (transition, state): (TransitionId, StateId),
    rigid_attachments: &[RigidAttachment],
    knots: &[f64],
    scratch: &mut CollisionScratch,
) -> Result<f64, Option<(ShapeIndex, ShapeIndex)>> {
    certify_or_find(model, settings, (transition, state), rigid_attachments, knots, scratch)
        .map_err(|blocked| blocked.contact.map(|c| model.pair_shapes(c.pair)))
}

/// As [`certify_whole`]; where it is not certified, also where on the way that was found.
pub(crate) fn certify_or_find(
    model: &PlanningModel,
    settings: &SearchSettings,
    (transition, state): (TransitionId, StateId),
    rigid_attachments: &[RigidAttachment],
    knots: &[f64],
    scratch: &mut CollisionScratch,
) -> Result<f64, Blocked> {
    let pairs = model.pairs(transition, state, rigid_attachments);
    let certificate = certificate_settings(settings, true);
    match certify_polyline(&model.collision, &model.kinematics, rigid_attachments, knots, pairs, &certificate, scratch)
    {
        PolylineVerdict::Free { min_clearance_lower_bound } => Ok(min_clearance_lower_bound),
        PolylineVerdict::FreeUntil { blocked_by, blocked_at, .. } => {
            Err(Blocked::new(model, settings, knots, (blocked_by, blocked_at)))
        }
    }
}

/// How motions are certified.
pub(crate) fn certificate_settings(settings: &SearchSettings, all_or_nothing: bool) -> CertificateSettings {
    // Motions start at nodes and waypoints that are known to be free: pairs that do not move need not be tested.
    CertificateSettings {
        clearance_guard: settings.clearance_guard,
        all_or_nothing,
        start_is_free: true,
        prefix_resolution: settings.prefix_resolution,
        // Steer keeps rows within the path tolerance all along, and the start holds to within twice that of projections,
        // each of three rows of a vector.
        rigid_within: settings.path_tolerance + 4.0 * settings.projection_tolerance,
        ..CertificateSettings::default()
    }
}
