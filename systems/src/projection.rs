//! Set Project: the waypoints of each candidate, leg by leg (P1 Alg. 2 lines 2-6, with P0's waypoints).
//!
//! Candidates that try the same transition share its constraint programs, so they are projected side by side in blocks of
//! lanes. Right-hand sides (where the near node's leaf has the objects, which leaf was drawn) are arguments of the solve.

use crate::constraint_programs::LegProgram;
use crate::events::StopSignal;
use crate::membership::parameter_of;
use crate::model::{ObjectModel, PlanningModel};
use crate::random::{Purpose, stream};
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Mut, Query, Res, ResMut};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena, LegParameter, PlannedLeg};
use foliate_components::graph::{ConstraintId, ConstraintKind, Leg, StateId, TransitionId, TransitionKind};
use foliate_components::leaf::{LeafIndex, Parameter};
use foliate_components::outcome::Rejection;
use foliate_components::roadmap::Roadmap;
use foliate_kernels::kinematics::Carriage;
use foliate_kernels::projection::{
    ArgumentBlock, LANES, LaneBlock, LaneMask, Outcome, Scratch as NewtonScratch, Settings as NewtonSettings,
    project_batch,
};
use rand::RngExt;
use rayon::prelude::*;

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
struct Scratch {
    newton: NewtonScratch,
    block: LaneBlock,
    arguments: ArgumentBlock,
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
    // Stable: within a transition the order stays that of the candidates, so blocks do not depend on anything else.
    lanes.sort_by_key(|lane| lane.candidate.transition);
    let mut blocks: Vec<&mut [Lane<'_>]> = Vec::new();
    for same in lanes.chunk_by_mut(|a, b| a.candidate.transition == b.candidate.transition) {
        blocks.extend(same.chunks_mut(LANES));
    }
    blocks
        .into_par_iter()
        .for_each_init(|| Scratch::new(&model), |scratch, block| context.project_block(block, scratch));
}

impl Scratch {
    fn new(model: &PlanningModel) -> Self {
        Self {
            newton: NewtonScratch::default(),
            block: LaneBlock::new(model.problem.robot.space.size()),
            arguments: ArgumentBlock::default(),
            X_WJ: vec![Pose::identity(); model.kinematics.bodies()],
        }
    }
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
}

impl Context<'_> {
    /// Projects up to eight candidates of one transition, all legs.
    fn project_block(&self, lanes: &mut [Lane<'_>], scratch: &mut Scratch) {
        let Some(id) = lanes.first().and_then(|lane| lane.candidate.transition) else { return };
        let transition = self.model.graph.transition(id);
        if self.stop.is_raised() {
            lanes.iter_mut().for_each(|lane| lane.candidate.reject(Rejection::Stopped));
            return;
        }
        for (number, leg) in transition.legs.iter().enumerate() {
            self.project_leg(id, number, leg, lanes, scratch);
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

    fn project_leg(&self, id: TransitionId, number: usize, leg: &Leg, lanes: &mut [Lane<'_>], scratch: &mut Scratch) {
        let Ok(program) = self.model.leg_program(id, number) else {
            let lost = Rejection::ProjectionFailed(number as u8);
            return lanes.iter_mut().for_each(|lane| lane.candidate.reject(lost));
        };
        let next_state = self.state_after(id, number);
        let mut active = LaneMask::default();
        scratch.arguments = ArgumentBlock::new(program.program.arguments());
        for (slot, lane) in lanes.iter().enumerate().filter(|(_, lane)| lane.candidate.is_alive()) {
            active.0 |= 1 << slot;
            scratch.block.set(slot, &self.seed(program, leg, lane));
            let drawn = lane.candidate.drawn;
            let arguments = program.arguments(self.model, self.leaves, leg.state, &lane.parameters, drawn);
            for (number, argument) in arguments.iter().enumerate().take(scratch.arguments.slots()) {
                scratch.arguments.set(number, slot, argument);
            }
        }
        let settings = NewtonSettings {
            tolerance: self.settings.projection_tolerance,
            iterations: self.settings.projection_iterations,
            ..NewtonSettings::default()
        };
        let mut outcomes = [Outcome::Idle; LANES];
        project_batch(
            &program.program,
            &mut scratch.block,
            &scratch.arguments,
            active,
            &settings,
            &mut outcomes,
            &mut scratch.newton,
        );
        for (slot, lane) in lanes.iter_mut().enumerate().filter(|&(slot, _)| active.contains(slot)) {
            if !outcomes[slot].is_converged() {
                lane.candidate.reject(Rejection::ProjectionFailed(number as u8));
                continue;
            }
            let mut end = lane.q.clone();
            scratch.block.get(slot, &mut end);
            let parameters = self.arrive(leg.state, next_state, lane, &mut end, &mut scratch.X_WJ);
            let mut knots = std::mem::take(&mut lane.q);
            knots.extend_from_slice(&end);
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
    fn seed(&self, program: &LegProgram, leg: &Leg, lane: &Lane<'_>) -> Vec<f64> {
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

    /// The values of the foliating constraints of `next` at the end of a leg in `state`. Where they are new, the released
    /// object is put exactly where its new leaf has it.
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
        let value = |constraint: &ConstraintId| match here.iter().position(|c| c == constraint) {
            Some(position) => lane.parameters[position],
            None => self.new_value(*constraint, lane, end, X_WJ),
        };
        there.iter().map(value).collect()
    }

    fn new_value(&self, constraint: ConstraintId, lane: &Lane<'_>, end: &mut [f64], X_WJ: &mut [Pose]) -> LegParameter {
        let (value, exact) = match lane.candidate.drawn {
            Some(id) if self.leaves.parameter(id).constraint == constraint => {
                (LegParameter::Known(id), *self.leaves.parameter(id))
            }
            _ => {
                self.model.kinematics.forward(end, X_WJ);
                let found = self.exact_parameter(constraint, X_WJ);
                (LegParameter::Fresh(found), found)
            }
        };
        // An object that is set down adopts the pose of its leaf; one that is picked up stays where it was.
        if let Some(object) = self.resting_object(constraint) {
            let root = self.model.objects()[object].root;
            let carriage = Carriage { object: root, carrier: exact.carrier, X_CO: exact.carrier_from_object };
            self.model.kinematics.forward(end, X_WJ);
            self.model.kinematics.carry(end, &[carriage], X_WJ);
            self.model.kinematics.write_back(&[carriage], X_WJ, end);
        }
        value
    }

    fn resting_object(&self, constraint: ConstraintId) -> Option<usize> {
        match self.model.graph.constraint(constraint).kind {
            ConstraintKind::Placement { object } | ConstraintKind::Rest { object } => Some(object as usize),
            _ => None,
        }
    }

    /// The parameter of a constraint that a projection has just satisfied to within its tolerance, made exact: a placed
    /// object lies flat on its support, the margin above it.
    fn exact_parameter(&self, constraint: ConstraintId, X_WJ: &[Pose]) -> Parameter {
        let mut found = parameter_of(self.model, constraint, X_WJ);
        if let ConstraintKind::Placement { object } = self.model.graph.constraint(constraint).kind
            && let ObjectModel { root, resting: Some(resting) } = &self.model.objects()[object as usize]
            && let Some(exact) = resting.exact(*root, X_WJ)
        {
            (found.carrier, found.carrier_from_object) = exact;
        }
        found
    }

    fn stands_still(&self, lane: &Lane<'_>) -> bool {
        lane.legs.iter().all(|leg| self.model.length(&leg.knots) < 1e-3)
    }
}
