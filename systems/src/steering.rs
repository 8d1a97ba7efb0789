//! Set Steer: the motion between two waypoints, kept on its leaf (P1 Alg. 2 lines 7-9).
//!
//! Where every object is eliminated the straight motion in the free coordinates is on the leaf already and two knots are
//! enough. Where implicit rows remain (two hands on one object) the motion is projected to knots so close that the
//! residual between them stays below the path tolerance (DESIGN §5.4).

use crate::constraint_programs::LegProgram;
use crate::events::StopSignal;
use crate::model::PlanningModel;
use crate::parallel::each;
use crate::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Local, Query, Res, ResMut};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena, LegParameter, PlannedLeg};
use foliate_components::graph::StateId;
use foliate_components::leaf::{Leaf, LeafIndex};
use foliate_components::outcome::Rejection;
use foliate_kernels::projection::{MotionEnd, MotionScratch, MotionSettings, Settings, project_motion};

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
    pool.sort_unstable_by_key(|c| c.index);
    let buffers = &*buffers;
    let mut alive: Vec<_> = pool.iter_mut().zip(&mut arena.legs).filter(|(c, _)| c.is_alive()).collect();
    each(
        &mut alive,
        || buffers.borrow(),
        |scratch, (candidate, legs)| {
            for index in 0..legs.len() {
                // A leg with implicit rows of a humanoid may take long.
                if stop.is_raised() {
                    candidate.reject(Rejection::Stopped);
                    legs.clear();
                    return;
                }
                let kept = steer_leg(&model, &settings, &leaves, &mut legs[index], scratch);
                if kept != Kept::Whole {
                    candidate.reject(Rejection::SteeringFailed(legs[index].leg as u8));
                    legs.truncate(index + usize::from(kept == Kept::Part));
                    return;
                }
            }
        },
    );
}

/// What is left of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kept {
    Whole,
    Part,
    Nothing,
}

/// A part of a leg that is shorter than this (weighted metres) is no progress.
const LEAST_PROGRESS: f64 = 0.01;

/// Replaces a leg's two ends by a polyline on its leaf, as far as that goes.
fn steer_leg(
    model: &PlanningModel,
    settings: &SearchSettings,
    leaves: &LeafIndex,
    leg: &mut PlannedLeg,
    scratch: &mut MotionScratch,
) -> Kept {
    let Ok(interior) = model.interior_program(leg.state) else { return Kept::Nothing };
    let space = &model.problem.robot.space;
    let size = space.size();
    if interior.program.rows() == 0 || leg.knots.len() <= size {
        return Kept::Whole;
    }
    let arguments = interior.arguments(model, leaves, leg.state, &leg.parameters, None);
    let (a, b) = leg.knots.split_at(size);
    let steered = project_between(model, settings, interior, &arguments, (a, &b[b.len() - size..]), scratch);
    if steered.knots.len() <= size {
        return Kept::Nothing;
    }
    let end = &steered.knots[steered.knots.len() - size..];
    if !steered.is_whole && space.distance(a, end, &model.weights) < LEAST_PROGRESS {
        return Kept::Nothing;
    }
    leg.residual = steered.residual;
    leg.knots = steered.knots;
    if steered.is_whole { Kept::Whole } else { Kept::Part }
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
    (a, b): (&[f64], &[f64]),
    scratch: &mut MotionScratch,
) -> Option<Steered> {
    let interior = model.interior_program(state).ok()?;
    if interior.program.rows() == 0 {
        return Some(Steered { knots: [a, b].concat(), residual: 0.0, is_whole: true });
    }
    Some(project_between(model, settings, interior, arguments, (a, b), scratch)).filter(|steered| steered.is_whole)
}

/// Projects the straight motion from one configuration to another onto implicit rows, as far as that goes.
fn project_between(
    model: &PlanningModel,
    settings: &SearchSettings,
    interior: &LegProgram,
    arguments: &[Pose],
    ends: (&[f64], &[f64]),
    scratch: &mut MotionScratch,
) -> Steered {
    let motion = MotionSettings {
        path_tolerance: settings.path_tolerance,
        solve: Settings { tolerance: settings.projection_tolerance, ..Settings::default() },
        ..MotionSettings::default()
    };
    let mut knots = Vec::new();
    let space = &model.problem.robot.space;
    let end = project_motion(&interior.program, space, ends, arguments, &motion, scratch, &mut knots);
    Steered { knots, residual: settings.path_tolerance, is_whole: end == MotionEnd::Reached }
}
