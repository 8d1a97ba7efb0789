//! The system of set Project: groups candidates by transition and projects the end of each leg in lanes.

use crate::events::StopSignal;
use crate::exploration::roadmap_query::RoadmapQuery;
use crate::planning_model::leg_program::LegProgram;
use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::{LEAST_SHARED, each};
use crate::runtime::random::{Purpose, stream};
use crate::runtime::scratch_pool::ScratchPool;
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Local, Mut, Query, Res, ResMut};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena, LegParameter, PlannedLeg};
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::graph::{Fingers, Leg, StateId, Transition, TransitionId, TransitionKind};
use foliate_components::outcome::Rejection;
use foliate_components::roadmap::Roadmap;
use foliate_kernels::constrained_motion::{Job, Scratch as NewtonScratch, Settings as NewtonSettings, project_batch};
use rand::RngExt;
use std::cmp::Reverse;

/// Random starts are far away: more damping than the solver's own default needs a few percent fewer candidates
/// (docs/decisions/0017).
const DAMPING: f64 = 1e-2;

/// Probability that joints which nothing depends on stay where they are. They move at times, because they may be in the way.
pub(crate) const UNINVOLVED_STILL: f64 = 0.984_375;

/// What a system reads of the world.
pub(crate) struct Context<'a> {
    pub(crate) model: &'a PlanningModel,
    pub(crate) settings: &'a SearchSettings,
    stop: &'a StopSignal,
    roadmap: Roadmap<'a>,
    pub(crate) leaves: &'a LeafIndex,
    step: u64,
}

/// One candidate on its way along a transition's legs.
pub(crate) struct Lane<'a> {
    pub(crate) candidate: Mut<'a, Candidate>,
    legs: &'a mut Vec<PlannedLeg>,
    random: &'a [f64],
    /// Where the next leg starts.
    pub(crate) q: Vec<f64>,
    /// Values of the foliating constraints of the next leg's state.
    pub(crate) parameters: Vec<LegParameter>,
}

/// Buffers of one thread.
#[derive(Debug, Default)]
pub struct ProjectionScratch {
    newton: NewtonScratch,
    X_WJ: Vec<Pose>,
}

/// Projects every candidate onto the waypoints of its transition.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn project_waypoints(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    step: Res<'_, StepCounter>,
    roadmap: RoadmapQuery<'_, '_>,
    leaves: Res<'_, LeafIndex>,
    mut arena: ResMut<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
    buffers: Local<'_, ScratchPool<ProjectionScratch>>,
) {
    let roadmap = roadmap.view();
    let context =
        Context { model: &model, settings: &settings, stop: &stop, roadmap, leaves: &leaves, step: step.step };
    let size = arena.configuration_size();
    let CandidateArena { legs, random, .. } = &mut *arena;
    let pool: Vec<_> = candidates.iter_mut().collect();
    let mut lanes: Vec<Lane<'_>> = pool
        .into_iter()
        .zip(legs.iter_mut())
        .zip(random.chunks_exact(size))
        .filter_map(|((candidate, legs), random)| Lane::start(&context, candidate, legs, random))
        .collect();
    // What becomes of a candidate does not depend on who shares its queue, so queues may be as long as threads allow.
    lanes.sort_by_key(|lane| lane.candidate.transition);
    let longest = lanes.len().div_ceil(rayon::current_num_threads()).max(LEAST_SHARED);
    let mut blocks: Vec<&mut [Lane<'_>]> = Vec::new();
    for same in lanes.chunk_by_mut(|a, b| a.candidate.transition == b.candidate.transition) {
        blocks.extend(same.chunks_mut(longest));
    }
    // The longest first, so that none is left alone at the end.
    let legs = |id: Option<TransitionId>| id.map_or(0, |id| model.graph.transition(id).legs.len());
    blocks.sort_by_key(|block| Reverse(block.len() * legs(block.first().and_then(|lane| lane.candidate.transition))));
    let buffers = &*buffers;
    each(
        &mut blocks,
        || buffers.borrow(),
        |scratch, block| {
            scratch.X_WJ.resize(model.kinematics.bodies(), Pose::identity());
            context.project_block(block, scratch);
        },
    );
}

impl<'a> Lane<'a> {
    fn start(
        context: &Context<'_>,
        candidate: Mut<'a, Candidate>,
        legs: &'a mut Vec<PlannedLeg>,
        random: &'a [f64],
    ) -> Option<Self> {
        let near = candidate.near.filter(|_| candidate.is_alive() && candidate.transition.is_some())?;
        let q = context.roadmap.configuration(near).to_vec();
        let leaf = context.leaves.leaf(context.roadmap.node(near).leaf);
        let parameters = leaf.parameters.iter().map(|&p| LegParameter::Known(p)).collect();
        Some(Self { candidate, legs, random, q, parameters })
    }

    /// Where the last leg ends on the border of the target, adds a leg of one knot that lies in it.
    fn enter(&mut self, transition: &Transition) {
        self.legs.push(PlannedLeg {
            leg: transition.legs.len() as u32,
            state: transition.to,
            parameters: self.parameters.clone(),
            knots: self.q.clone(),
            clearance: 0.0,
            residual: 0.0,
        });
    }
}

impl Context<'_> {
    /// Projects candidates of one transition, all legs.
    fn project_block(&self, lanes: &mut [Lane<'_>], scratch: &mut ProjectionScratch) {
        let Some(id) = lanes.first().and_then(|lane| lane.candidate.transition) else { return };
        let transition = self.model.graph.transition(id);
        if self.stop.is_raised() {
            lanes.iter_mut().for_each(|lane| lane.candidate.reject(Rejection::Stopped));
            return;
        }
        if let Some(first) = transition.legs.first().filter(|first| first.state != transition.from) {
            // Another hand keeps the object: what is released is left at once. Or the target holds at the start already.
            for lane in lanes.iter_mut() {
                if !self.lies_in(first.state, transition.from, lane, &mut scratch.X_WJ) {
                    lane.candidate.reject(Rejection::ProjectionFailed(0));
                    continue;
                }
                let mut q = lane.q.clone();
                lane.parameters = self.arrive(transition.from, first.state, lane, &mut q, &mut scratch.X_WJ);
            }
        }
        for (number, leg) in transition.legs.iter().enumerate() {
            if self.stop.is_raised() {
                lanes.iter_mut().for_each(|lane| lane.candidate.reject(Rejection::Stopped));
            }
            self.project_leg(id, number, leg, lanes, scratch);
        }
        if transition.legs.last().is_some_and(|last| last.state != transition.to) {
            lanes.iter_mut().filter(|lane| lane.candidate.is_alive()).for_each(|lane| lane.enter(transition));
        }
        for lane in lanes.iter_mut() {
            if lane.candidate.is_alive() && transition.kind == TransitionKind::Loop && self.stands_still(lane) {
                lane.candidate.reject(Rejection::NoProgress);
            }
            if !lane.candidate.is_alive() {
                lane.legs.clear();
            }
        }
    }

    fn project_leg(
        &self,
        id: TransitionId,
        number: usize,
        leg: &Leg,
        lanes: &mut [Lane<'_>],
        scratch: &mut ProjectionScratch,
    ) {
        let Ok(program) = self.model.leg_program(id, number) else {
            let lost = Rejection::ProjectionFailed(number as u8);
            return lanes.iter_mut().for_each(|lane| lane.candidate.reject(lost));
        };
        let next_state = self.state_after(id, number);
        let settings = NewtonSettings {
            tolerance: self.settings.projection_tolerance,
            iterations: self.settings.projection_iterations,
            damping: DAMPING,
            level: self.settings.level,
            ..NewtonSettings::default()
        };
        let mut solves: Vec<(Vec<f64>, Vec<Pose>)> = Vec::new();
        let mut lanes: Vec<_> = lanes.iter_mut().filter(|lane| lane.candidate.is_alive()).collect();
        for lane in &lanes {
            let drawn = lane.candidate.drawn;
            let arguments = program.arguments(self.model, self.leaves, leg.state, &lane.parameters, drawn);
            solves.push((self.start(program, leg, lane), arguments));
        }
        let converged: Vec<bool> = if let Fingers::Moving(hand) = self.model.graph.state(leg.state).fingers {
            // Only fingers move: what else is asked of the end holds at the start.
            solves.iter_mut().for_each(|(q, _)| self.model.put_fingers(hand, &leg.target, q));
            vec![true; solves.len()]
        } else {
            let mut jobs: Vec<_> = solves.iter_mut().map(|(q, arguments)| Job::new(q, arguments)).collect();
            project_batch(&program.program, &mut jobs, &settings, &mut scratch.newton);
            jobs.iter().map(|job| job.outcome.is_converged()).collect()
        };
        for ((lane, (mut end, _)), converged) in lanes.iter_mut().zip(solves).zip(converged) {
            if !converged {
                lane.candidate.reject(Rejection::ProjectionFailed(number as u8));
                continue;
            }
            let parameters = self.arrive(leg.state, next_state, lane, &mut end, &mut scratch.X_WJ);
            // New memory: what another thread has allocated makes both wait when it grows.
            let knots = [&*lane.q, &end].concat();
            lane.q = end;
            if self.model.object_out_of_bounds(&lane.q) {
                lane.candidate.reject(Rejection::OutOfBounds(number as u8));
            }
            let before = std::mem::replace(&mut lane.parameters, parameters);
            lane.legs.push(PlannedLeg {
                leg: number as u32,
                state: leg.state,
                parameters: before,
                knots,
                clearance: 0.0,
                residual: 0.0,
            });
        }
    }

    /// The state of the leg after this one, or the transition's target.
    fn state_after(&self, id: TransitionId, number: usize) -> StateId {
        let transition = self.model.graph.transition(id);
        transition.legs.get(number + 1).map_or(transition.to, |next| next.state)
    }

    /// Where the solve starts: at the leg's own start for short legs, else at q_rand, with idle coordinates keeping still
    /// for some candidates.
    fn start(&self, program: &LegProgram, leg: &Leg, lane: &Lane<'_>) -> Vec<f64> {
        if leg.short {
            return lane.q.clone();
        }
        let mut seed = lane.random.to_vec();
        let mut rng = stream(self.settings.seed, Purpose::STILL, self.step, lane.candidate.index);
        if rng.random::<f64>() < self.settings.still_probability {
            for &index in &program.idle {
                seed[index] = lane.q[index];
            }
        }
        let uninvolved = &self.model.uninvolved;
        if !uninvolved.is_empty() && rng.random::<f64>() < UNINVOLVED_STILL {
            uninvolved.iter().for_each(|&index| seed[index] = lane.q[index]);
        }
        self.model.lock(&mut seed);
        seed
    }

    fn stands_still(&self, lane: &Lane<'_>) -> bool {
        lane.legs.iter().all(|leg| self.model.length(&leg.knots) < 1e-3)
    }
}
