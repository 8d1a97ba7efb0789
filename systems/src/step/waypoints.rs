//! The exact verdict of waypoints, in front of Steer: a waypoint in collision is refused before motions lead to it.
//!
//! All pairs are asked, also those that a leg keeps in constant relative pose: the one test that holds for the leaf. A
//! motion on implicit rows costs many projections, the verdict less than a few of them.
//!
//! Waypoints are whole configurations, objects included, so those of all candidates are judged side by side, sixteen at a time, wherever
//! the same pairs count: everywhere, unless there are margins, which each transition lifts from something else. Which waypoints share
//! a batch follows from the candidates alone, so that threads may take the batches as they like.

use crate::events::StopSignal;
use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::each;
use crate::runtime::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Local, Query, Res, ResMut};
use foliate_components::candidate::{Candidate, CandidateArena, PlannedLeg};
use foliate_components::graph::{TransitionId, TransitionKind};
use foliate_components::outcome::Rejection;
use foliate_kernels::collision::{CollisionScratch, Contact, Verdicts};

/// Waypoints of a batch: as many as there are lanes, unless one candidate has more.
const BATCH: usize = 16;

/// Waypoints of some candidates, to be judged together.
#[derive(Debug, Default)]
struct Batch {
    /// The transition of one of them, and of all of them where there are margins.
    transition: Option<TransitionId>,
    /// The candidates, by place among those of the step; their waypoints stand end to end.
    candidates: Vec<usize>,
    /// By candidate: how many waypoints there are up to its last.
    ends: Vec<usize>,
    /// Whole configurations, end to end.
    waypoints: Vec<f64>,
    /// By candidate: number of the waypoint in collision, and what collides.
    blocked: Vec<Option<(usize, Contact)>>,
}

impl Batch {
    fn count(&self) -> usize {
        self.ends.last().copied().unwrap_or(0)
    }
}

/// Batches, which keep their memory from step to step.
#[derive(Debug, Default)]
pub struct Batches {
    batches: Vec<Batch>,
    used: usize,
}

impl Batches {
    fn clear(&mut self) {
        self.used = 0;
    }

    /// Adds a candidate to the batch that was begun last for the same pairs, where there is room.
    fn add(&mut self, model: &PlanningModel, place: usize, transition: TransitionId, legs: &[PlannedLeg]) {
        let same = |batch: &Batch| model.problem.margins.is_empty() || batch.transition == Some(transition);
        let begun = self.batches[..self.used].iter().rposition(same);
        let room = begun.filter(|&number| self.batches[number].count() + legs.len() <= BATCH);
        let number = room.unwrap_or_else(|| self.begin(transition));
        let batch = &mut self.batches[number];
        batch.candidates.push(place);
        batch.ends.push(batch.count() + legs.len());
        write_waypoints(model, true, legs, &mut batch.waypoints);
    }

    fn begin(&mut self, transition: TransitionId) -> usize {
        if self.used == self.batches.len() {
            self.batches.push(Batch::default());
        }
        let batch = &mut self.batches[self.used];
        batch.transition = Some(transition);
        batch.candidates.clear();
        batch.ends.clear();
        batch.waypoints.clear();
        batch.blocked.clear();
        self.used += 1;
        self.used - 1
    }
}

/// Refuses candidates that have a waypoint in collision; marks the others.
pub fn check_waypoints(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    mut arena: ResMut<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
    buffers: Local<'_, ScratchPool<CollisionScratch>>,
    mut batches: Local<'_, Batches>,
) {
    let mut pool: Vec<_> = candidates.iter_mut().collect();
    let mut alive: Vec<_> = pool.iter_mut().zip(&mut arena.legs).filter(|(c, _)| c.is_alive()).collect();
    let (buffers, batches) = (&*buffers, &mut *batches);
    batches.clear();
    for (place, (candidate, legs)) in alive.iter_mut().enumerate() {
        candidate.waypoints_are_free = candidate.transition.is_some();
        let Some(transition) = asked_along(&model, candidate) else { continue };
        batches.add(&model, place, transition, legs);
    }
    each(
        &mut batches.batches[..batches.used],
        || buffers.borrow(),
        |collision, batch| {
            // Who is in time depends on the clock; a step in which the signal is raised has no answer.
            if !stop.is_raised() {
                collision.set_level(settings.level);
                judge(&model, &settings, batch, collision);
            }
        },
    );
    for batch in &batches.batches[..batches.used] {
        for (&place, blocked) in batch.candidates.iter().zip(&batch.blocked) {
            let (candidate, legs) = &mut alive[place];
            refuse(&model, &settings, candidate, legs, *blocked);
        }
    }
    let is_stopped = stop.is_raised();
    for (candidate, legs) in alive {
        if is_stopped {
            candidate.reject(Rejection::Stopped);
        }
        candidate.waypoints_are_free &= candidate.is_alive();
        if !candidate.waypoints_are_free {
            legs.clear();
        }
    }
}

/// The transition along which a candidate's waypoints are asked. The end of a loop is none: of a motion towards it what comes
/// before a collision is kept.
fn asked_along(model: &PlanningModel, candidate: &Candidate) -> Option<TransitionId> {
    candidate.transition.filter(|&t| model.graph.transition(t).kind != TransitionKind::Loop)
}

/// Appends where the legs end.
fn write_waypoints(model: &PlanningModel, whole: bool, legs: &[PlannedLeg], waypoints: &mut Vec<f64>) {
    (0..legs.len()).for_each(|leg| waypoints.extend_from_slice(waypoint(model, whole, legs, leg)));
}

/// Where a leg ends. One that steering cut short ends at no waypoint; where it starts says as much about its leaf.
fn waypoint<'a>(model: &PlanningModel, whole: bool, legs: &'a [PlannedLeg], leg: usize) -> &'a [f64] {
    let (size, knots) = (model.problem.robot.space.size(), &legs[leg].knots);
    let at = if whole || leg + 1 < legs.len() { knots.len() - size } else { 0 };
    &knots[at..at + size]
}

/// Asks the verdicts of a batch.
fn judge(model: &PlanningModel, settings: &SearchSettings, batch: &mut Batch, collision: &mut CollisionScratch) {
    let Some(transition) = batch.transition else { return };
    let verdicts = Verdicts {
        scene: &model.collision,
        kinematics: &model.kinematics,
        // Objects are where the waypoints have them.
        rigid_attachments: &[],
        pairs: model.waypoint_pairs(transition),
        guard: settings.clearance_guard,
    };
    verdicts.first_in_rows(&batch.waypoints, &batch.ends, collision, &mut batch.blocked);
}

/// Rejects a candidate that has a waypoint in collision.
fn refuse(
    model: &PlanningModel,
    settings: &SearchSettings,
    candidate: &mut Candidate,
    legs: &[PlannedLeg],
    blocked: Option<(usize, Contact)>,
) -> bool {
    let Some((leg, contact)) = blocked else { return false };
    candidate.blocked_at = settings.log.then(|| waypoint(model, candidate.is_alive(), legs, leg).into());
    candidate.reject(Rejection::WaypointBlocked(legs[leg].leg as u8));
    candidate.blocked_by = Some(model.pair_shapes(contact.pair));
    true
}

/// Whether no waypoint of a candidate is in collision; rejects it if one is.
pub(crate) fn waypoints_are_free(
    model: &PlanningModel,
    settings: &SearchSettings,
    candidate: &mut Candidate,
    legs: &[PlannedLeg],
    collision: &mut CollisionScratch,
) -> bool {
    let Some(transition) = asked_along(model, candidate) else { return candidate.transition.is_some() };
    let mut batch = Batch { transition: Some(transition), ends: vec![legs.len()], ..Batch::default() };
    write_waypoints(model, candidate.is_alive(), legs, &mut batch.waypoints);
    judge(model, settings, &mut batch, collision);
    let blocked = batch.blocked.first().copied().flatten();
    !refuse(model, settings, candidate, legs, blocked)
}
