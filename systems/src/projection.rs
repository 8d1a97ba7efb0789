//! Set Project: the waypoints of each candidate, leg by leg (P1 Alg. 2 lines 2-6, with P0's waypoints).
//!
//! Candidates that try the same transition share its constraint programs, so they are projected side by side, one per lane.
//! Right-hand sides (where the near node's leaf has the objects, which leaf was drawn) are arguments of the solve.

use crate::constraint_programs::{LegProgram, parameter_in};
use crate::events::StopSignal;
use crate::graph::building::led_to;
use crate::membership::{parameter_of, residual};
use crate::model::PlanningModel;
use crate::parallel::{LEAST_SHARED, each};
use crate::random::{Purpose, stream};
use crate::schedule::StepCounter;
use crate::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Local, Mut, Query, Res, ResMut};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena, LegParameter, PlannedLeg};
use foliate_components::graph::leaf::{LeafIndex, Parameter, ParameterId};
use foliate_components::graph::{ConstraintId, ConstraintKind, Leg, StateId, Transition, TransitionId, TransitionKind};
use foliate_components::outcome::Rejection;
use foliate_components::roadmap::Roadmap;
use foliate_kernels::constrained_motion::{Job, Scratch as NewtonScratch, Settings as NewtonSettings, project_batch};
use foliate_kernels::kinematics::Carriage;
use rand::RngExt;
use std::cmp::Reverse;

/// Random starts are far away: more damping than the solver's own default leaves a few percent fewer candidates in vain
/// (benches/README.md).
const DAMPING: f64 = 1e-2;

/// Seeds among which one is drawn, of the sixteen that are found near a grasp.
const NEAR_SEEDS: usize = 8;

/// What a system reads of the world.
struct Context<'a> {
    model: &'a PlanningModel,
    settings: &'a SearchSettings,
    stop: &'a StopSignal,
    roadmap: &'a Roadmap,
    leaves: &'a LeafIndex,
    step: u64,
}

/// One candidate on its way along a transition's legs.
struct Lane<'a> {
    candidate: Mut<'a, Candidate>,
    legs: &'a mut Vec<PlannedLeg>,
    random: &'a [f64],
    /// Where the next leg starts.
    q: Vec<f64>,
    /// Values of the foliating constraints of the next leg's state.
    parameters: Vec<LegParameter>,
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
    roadmap: Res<'_, Roadmap>,
    leaves: Res<'_, LeafIndex>,
    mut arena: ResMut<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
    buffers: Local<'_, ScratchPool<ProjectionScratch>>,
) {
    let context = Context {
        model: &model,
        settings: &settings,
        stop: &stop,
        roadmap: &roadmap,
        leaves: &leaves,
        step: step.step,
    };
    let size = arena.configuration_size();
    let CandidateArena { legs, random, .. } = &mut *arena;
    let mut pool: Vec<_> = candidates.iter_mut().collect();
    pool.sort_unstable_by_key(|c| c.index);
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
            single_until: self.settings.projection_single_until,
            level: self.settings.level,
            ..NewtonSettings::default()
        };
        let mut solves: Vec<(Vec<f64>, Vec<Pose>)> = Vec::new();
        let mut lanes: Vec<_> = lanes.iter_mut().filter(|lane| lane.candidate.is_alive()).collect();
        for lane in &lanes {
            let drawn = lane.candidate.drawn;
            let arguments = program.arguments(self.model, self.leaves, leg.state, &lane.parameters, drawn);
            let mut start = self.start(program, leg, lane);
            if !leg.short {
                self.start_near(program, &arguments, lane, number, &mut start, &mut scratch.newton);
            }
            solves.push((start, arguments));
        }
        let mut jobs: Vec<_> = solves.iter_mut().map(|(q, arguments)| Job::new(q, arguments)).collect();
        project_batch(&program.program, &mut jobs, &settings, &mut scratch.newton);
        let converged: Vec<bool> = jobs.iter().map(|job| job.outcome.is_converged()).collect();
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
        let mut rng = stream(self.settings.seed, Purpose::Still, self.step, lane.candidate.index);
        if rng.random::<f64>() < self.settings.still_probability {
            for &index in &program.idle {
                seed[index] = lane.q[index];
            }
        }
        self.model.lock(&mut seed);
        seed
    }

    /// For some candidates, moves the joints of the arm that a leg brings to a grasp to where its hand is near it: to one of
    /// the nearest configurations of a table, drawn at random so that candidates differ.
    fn start_near(
        &self,
        program: &LegProgram,
        arguments: &[Pose],
        lane: &Lane<'_>,
        leg: usize,
        start: &mut [f64],
        scratch: &mut NewtonScratch,
    ) {
        if self.settings.seeded_probability <= 0.0 {
            return;
        }
        let Some(table) = program.program.hand().and_then(|tip| self.model.seeds(tip)) else { return };
        let mut rng = stream(self.settings.seed, Purpose::Seed, self.step, lane.candidate.index);
        // Legs draw one after another.
        let mut numbers = [0.0; 2];
        (0..=leg).for_each(|_| numbers = rng.random());
        let [chance, which] = numbers;
        if chance >= self.settings.seeded_probability {
            return;
        }
        let Some(target) = program.program.seed_target(start, arguments, scratch) else { return };
        let nearest = table.nearest(self.settings.level, &target);
        let drawn = nearest[((which * NEAR_SEEDS as f64) as usize).min(NEAR_SEEDS - 1)];
        for (&coordinate, &x) in table.coordinates().iter().zip(table.seed(drawn as usize)) {
            start[coordinate] = x;
        }
    }

    /// Whether a lane's configuration, which lies in `state`, lies in `next` too: what `next` demands beyond `state` holds
    /// to within the tolerance of a projection.
    fn lies_in(&self, next: StateId, state: StateId, lane: &Lane<'_>, X_WJ: &mut [Pose]) -> bool {
        let here = &self.model.graph.state(state).manifold;
        let more = self.model.graph.state(next).manifold.iter().filter(|&c| !here.contains(c));
        let more: Vec<ConstraintId> = more.copied().collect();
        if more.is_empty() {
            return true;
        }
        self.model.kinematics.forward(&lane.q, X_WJ);
        // A projection's tolerance bounds what it measured; measured again it may round differently.
        let tolerance = 2.0 * self.settings.projection_tolerance;
        more.iter().all(|&c| residual(self.model, c, &lane.q, X_WJ) <= tolerance)
    }

    /// The values of the foliating constraints of `next` at the end of a leg in `state`. Where they are new, a released
    /// object is put exactly where its new leaf has it; one that is picked up stays where it was.
    fn arrive(
        &self,
        state: StateId,
        next: StateId,
        lane: &Lane<'_>,
        end: &mut [f64],
        X_WJ: &mut [Pose],
    ) -> Vec<LegParameter> {
        if state == next {
            return lane.parameters.clone();
        }
        let here = &self.model.graph.state(state).foliation;
        let there = &self.model.graph.state(next).foliation;
        let mut set_down = Vec::new();
        self.model.kinematics.forward(end, X_WJ);
        let mut value = |constraint: &ConstraintId| {
            if let Some(position) = here.iter().position(|c| c == constraint) {
                return lane.parameters[position];
            }
            set_down.extend(self.resting_object(*constraint));
            match self.drawn_parameter(lane, *constraint) {
                Some(id) => LegParameter::Known(id),
                None => LegParameter::Fresh(self.exact_parameter(*constraint, end, X_WJ)),
            }
        };
        let parameters: Vec<_> = there.iter().map(&mut value).collect();
        if !set_down.is_empty() {
            self.put_down(next, &parameters, &set_down, end, X_WJ);
        }
        parameters
    }

    /// The drawn value of a constraint that the lane's transition adds.
    fn drawn_parameter(&self, lane: &Lane<'_>, constraint: ConstraintId) -> Option<ParameterId> {
        let leaf = self.leaves.leaf(lane.candidate.drawn?);
        let aims = |leg: &Leg| {
            let leads = |&c: &ConstraintId| {
                led_to(self.model.graph.constraint(c).kind) == self.model.graph.constraint(constraint).kind
            };
            leg.drawn.iter().any(leads)
        };
        let transition = self.model.graph.transition(lane.candidate.transition?);
        let position = self.model.graph.state(leaf.state).foliation.iter().position(|&c| c == constraint)?;
        transition.legs.iter().any(aims).then(|| leaf.parameters[position])
    }

    /// Moves objects exactly to where their leaf has them, and with them what they carry.
    fn put_down(
        &self,
        state: StateId,
        parameters: &[LegParameter],
        objects: &[usize],
        end: &mut [f64],
        X_WJ: &mut [Pose],
    ) {
        let kinematics = &self.model.kinematics;
        let all = self.model.carriages(state, |c| parameter_in(self.model, self.leaves, state, parameters, c));
        let mut moved: Vec<Carriage> = Vec::new();
        let joints = &self.model.problem.robot.joints;
        for carriage in all {
            let own = self.model.objects().iter().position(|o| o.root == Some(carriage.object));
            let rides = |m: &Carriage| {
                carriage.carrier.is_some_and(|body| joints[body.at()].part == joints[m.object.at()].part)
            };
            if own.is_some_and(|own| objects.contains(&own)) || moved.iter().any(rides) {
                moved.push(carriage);
            }
        }
        kinematics.forward(end, X_WJ);
        kinematics.carry(end, &moved, X_WJ);
        kinematics.write_back(&moved, X_WJ, end);
    }

    fn resting_object(&self, constraint: ConstraintId) -> Option<usize> {
        match self.model.graph.constraint(constraint).kind {
            ConstraintKind::Placement { object, .. } | ConstraintKind::Rest { object } => Some(object as usize),
            _ => None,
        }
    }

    /// The parameter of a constraint that a projection has just satisfied to within its tolerance, made exact: a placed
    /// object lies flat on its support, the margin above it.
    fn exact_parameter(&self, constraint: ConstraintId, q: &[f64], X_WJ: &[Pose]) -> Parameter {
        let mut found = parameter_of(self.model, constraint, q, X_WJ);
        if let ConstraintKind::Placement { object, on } = self.model.graph.constraint(constraint).kind
            && let object = &self.model.objects()[object as usize]
            && let (Some(root), Some(place)) = (object.root, object.resting_on(on))
            && let Some(exact) = place.resting.exact(root, X_WJ)
        {
            (found.carrier, found.value) = exact;
        }
        found
    }

    fn stands_still(&self, lane: &Lane<'_>) -> bool {
        lane.legs.iter().all(|leg| self.model.length(&leg.knots) < 1e-3)
    }
}
