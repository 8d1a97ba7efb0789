//! Set Steer: the motion between two waypoints, kept on its leaf (P1 Alg. 2 lines 7-9).
//!
//! Where every object is eliminated the straight motion in the free coordinates is on the leaf already and two knots are
//! enough. Where implicit rows remain (two hands on one object) the motion is projected to knots so close that the
//! residual between them stays below the path tolerance.

use crate::events::StopSignal;
use crate::planning_model::leg_program::LegProgram;
use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::each;
use crate::runtime::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Local, Query, Res, ResMut};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena, LegParameter, PlannedLeg};
use foliate_components::graph::StateId;
use foliate_components::graph::leaf::{Leaf, LeafIndex};
use foliate_components::outcome::Rejection;
use foliate_kernels::constrained_motion::{
    MotionEnd, MotionJob, MotionScratch, MotionSettings, Settings, project_motion, project_motions,
};

/// A motion on a leaf.
#[derive(Clone, Debug, PartialEq)]
pub struct Steered {
    /// Whole configurations, end to end.
    pub knots: Vec<f64>,
    /// Proven bound of the residual of implicit rows.
    pub residual: f64,
    /// Whether it arrives; if not, its last knot is on the leaf all the same.
    pub is_whole: bool,
}

/// Steers every planned leg of every candidate. A leg that leaves its leaf ends the candidate there: what it has of the leg
/// is kept where that is progress, the legs behind it are not.
///
/// The first legs of all candidates come first, then their second ones: what is steered in one state is steered side by side.
pub fn steer_legs(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    leaves: Res<'_, LeafIndex>,
    mut arena: ResMut<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
    buffers: Local<'_, ScratchPool<MotionScratch>>,
) {
    let mut pool: Vec<_> = candidates.iter_mut().collect();
    let mut plans: Vec<_> = pool.iter_mut().zip(&mut arena.legs).map(|(c, legs)| Plan { candidate: c, legs }).collect();
    let most = plans.iter().map(|plan| plan.legs.len()).max().unwrap_or(0);
    let buffers = &*buffers;
    for number in 0..most {
        let is_bound = |plan: &&mut Plan<'_>| {
            plan.candidate.is_alive() && plan.legs.get(number).is_some_and(|leg| is_bound(&model, leg))
        };
        let mut bound: Vec<_> = plans.iter_mut().filter(is_bound).collect();
        if bound.is_empty() {
            continue;
        }
        each(
            &mut shares(&mut bound, number),
            || buffers.borrow(),
            |scratch, share| {
                // A leg with implicit rows of a humanoid may take long.
                if stop.is_raised() {
                    share.plans.iter_mut().for_each(|plan| plan.stop());
                } else {
                    share.steer(&model, &settings, &leaves, number, scratch);
                }
            },
        );
    }
}

/// Whether rows are left on a leg's leaf, and it leads anywhere. (What does not compile is found out when it is steered.)
fn is_bound(model: &PlanningModel, leg: &PlannedLeg) -> bool {
    let is_free = model.interior_program(leg.state).is_ok_and(|interior| interior.program.rows() == 0);
    !is_free && leg.knots.len() > model.problem.robot.space.size()
}

/// A candidate with its legs.
struct Plan<'a> {
    candidate: &'a mut Candidate,
    legs: &'a mut Vec<PlannedLeg>,
}

impl Plan<'_> {
    fn stop(&mut self) {
        self.candidate.reject(Rejection::Stopped);
        self.legs.clear();
    }

    /// Replaces a leg's two ends by what was steered; a leg that does not arrive ends the candidate.
    fn keep(&mut self, model: &PlanningModel, number: usize, steered: Option<Steered>) {
        let (space, leg) = (&model.problem.robot.space, &mut self.legs[number]);
        let size = space.size();
        let (is_progress, is_whole) = match &steered {
            Some(Steered { knots, is_whole, .. }) if knots.len() > size => {
                let (start, end) = (&knots[..size], &knots[knots.len() - size..]);
                (*is_whole || space.distance(start, end, &model.weights) >= LEAST_PROGRESS, *is_whole)
            }
            _ => (false, false),
        };
        let failed = Rejection::SteeringFailed(leg.leg as u8);
        if let Some(steered) = steered.filter(|_| is_progress) {
            leg.residual = steered.residual;
            leg.knots = steered.knots;
        }
        if !is_whole {
            self.candidate.reject(failed);
            self.legs.truncate(number + usize::from(is_progress));
        }
    }
}

/// A part of a leg that is shorter than this (weighted metres) is no progress.
const LEAST_PROGRESS: f64 = 0.01;

/// Motions of one state from which on lanes pay.
const CROWD: usize = 3;

/// Legs of one state that a thread steers at once.
struct Share<'s, 'b, 'a> {
    plans: &'s mut [&'b mut Plan<'a>],
    /// Whether they are among so many that they are steered side by side.
    is_crowd: bool,
}

/// Divides the plans' legs of a number among threads. Whether legs are steered side by side depends on the plans alone, and who
/// is beside whom is no part of an answer: threads change nothing.
fn shares<'s, 'b, 'a>(plans: &'s mut [&'b mut Plan<'a>], number: usize) -> Vec<Share<'s, 'b, 'a>> {
    let state = |plan: &&mut Plan<'_>| plan.legs[number].state;
    plans.sort_by_key(state);
    let mut shares = Vec::new();
    for of_state in plans.chunk_by_mut(|a, b| state(a) == state(b)) {
        let is_crowd = of_state.len() >= CROWD;
        let size = if is_crowd { of_state.len().div_ceil(rayon::current_num_threads()) } else { 1 };
        shares.extend(of_state.chunks_mut(size).map(|plans| Share { plans, is_crowd }));
    }
    shares
}

impl Share<'_, '_, '_> {
    /// Replaces each leg's two ends by a polyline on its leaf, as far as that goes.
    fn steer(
        &mut self,
        model: &PlanningModel,
        settings: &SearchSettings,
        leaves: &LeafIndex,
        number: usize,
        scratch: &mut MotionScratch,
    ) {
        let Some(Ok(interior)) = self.plans.first().map(|plan| model.interior_program(plan.legs[number].state)) else {
            return self.plans.iter_mut().for_each(|plan| plan.keep(model, number, None));
        };
        let legs = self.plans.iter().map(|plan| &plan.legs[number]);
        let arguments = |leg: &PlannedLeg| interior.arguments(model, leaves, leg.state, &leg.parameters, None);
        let ways: Vec<_> = legs.map(|leg| Way { ends: ends_of(model, leg), arguments: arguments(leg) }).collect();
        let steered = if self.is_crowd {
            project_side_by_side(model, settings, interior, &ways, scratch)
        } else {
            let alone = |way: &Way<'_>| project_between(model, settings, interior, way, scratch);
            ways.iter().map(alone).collect()
        };
        for (plan, steered) in self.plans.iter_mut().zip(steered) {
            plan.keep(model, number, Some(steered));
        }
    }
}

/// What is to be projected: the straight motion between two configurations, with right-hand sides.
struct Way<'l, A = Vec<Pose>> {
    ends: (&'l [f64], &'l [f64]),
    arguments: A,
}

/// The two ends of a leg.
fn ends_of<'l>(model: &PlanningModel, leg: &'l PlannedLeg) -> (&'l [f64], &'l [f64]) {
    let size = model.problem.robot.space.size();
    (&leg.knots[..size], &leg.knots[leg.knots.len() - size..])
}

/// Right-hand sides of the rows that keep a motion on a leaf; empty where none are left, `None` where they do not compile.
#[must_use]
pub fn arguments_on(model: &PlanningModel, leaf: &Leaf, leaves: &LeafIndex) -> Option<Vec<Pose>> {
    let interior = model.interior_program(leaf.state).ok()?;
    if interior.program.rows() == 0 {
        return Some(Vec::new());
    }
    let parameters: Vec<_> = leaf.parameters.iter().map(|&p| LegParameter::Known(p)).collect();
    Some(interior.arguments(model, leaves, leaf.state, &parameters, None))
}

/// A motion between two configurations of a leaf of `state`, given the leaf's [`arguments_on`] it; `None` where it does not
/// arrive.
#[must_use]
pub fn steer_whole(
    model: &PlanningModel,
    settings: &SearchSettings,
    state: StateId,
    arguments: &[Pose],
    ends: (&[f64], &[f64]),
    scratch: &mut MotionScratch,
) -> Option<Steered> {
    steer(model, settings, state, arguments, ends, scratch).filter(|steered| steered.is_whole)
}

/// The same as far as it goes; `None` where the constraints of the state do not compile.
#[must_use]
pub fn steer(
    model: &PlanningModel,
    settings: &SearchSettings,
    state: StateId,
    arguments: &[Pose],
    (a, b): (&[f64], &[f64]),
    scratch: &mut MotionScratch,
) -> Option<Steered> {
    let interior = model.interior_program(state).ok()?;
    if interior.program.rows() == 0 {
        return Some(Steered { knots: [a, b].concat(), residual: 0.0, is_whole: true });
    }
    let way = Way { ends: (a, b), arguments };
    Some(project_between(model, settings, interior, &way, scratch))
}

/// Projects the straight motion from one configuration to another onto implicit rows, as far as that goes.
fn project_between(
    model: &PlanningModel,
    settings: &SearchSettings,
    interior: &LegProgram,
    way: &Way<'_, impl AsRef<[Pose]>>,
    scratch: &mut MotionScratch,
) -> Steered {
    let (mut knots, arguments) = (Vec::new(), way.arguments.as_ref());
    let (space, motion) = (&model.problem.robot.space, motion_settings(settings));
    let program = &interior.program;
    let end = project_motion(program, space, way.ends, arguments, &motion, scratch, &mut knots);
    steered(settings, end, knots)
}

/// The same of several motions.
fn project_side_by_side(
    model: &PlanningModel,
    settings: &SearchSettings,
    interior: &LegProgram,
    ways: &[Way<'_>],
    scratch: &mut MotionScratch,
) -> Vec<Steered> {
    let mut knots = vec![Vec::new(); ways.len()];
    let jobs = ways.iter().zip(&mut knots);
    let mut jobs: Vec<_> = jobs.map(|(way, knots)| MotionJob::new(way.ends, &way.arguments, knots)).collect();
    let space = &model.problem.robot.space;
    project_motions(&interior.program, space, &mut jobs, &motion_settings(settings), scratch);
    let ends: Vec<_> = jobs.iter().map(|job| job.end).collect();
    ends.into_iter().zip(knots).map(|(end, knots)| steered(settings, end, knots)).collect()
}

fn motion_settings(settings: &SearchSettings) -> MotionSettings {
    let solve = Settings { tolerance: settings.projection_tolerance, level: settings.level, ..Settings::default() };
    MotionSettings { path_tolerance: settings.path_tolerance, solve, ..MotionSettings::default() }
}

fn steered(settings: &SearchSettings, end: MotionEnd, knots: Vec<f64>) -> Steered {
    Steered { knots, residual: settings.path_tolerance, is_whole: end == MotionEnd::Reached }
}
