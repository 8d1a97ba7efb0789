//! Set Steer: the motion between two waypoints, kept on its leaf (P1 Alg. 2 lines 7-9).
//!
//! Where every object is eliminated the straight motion in the free coordinates is on the leaf already and two knots are
//! enough. Where implicit rows remain (two hands on one object) the motion is projected to knots so close that the
//! residual between them stays below the path tolerance (DESIGN §5.4).

use crate::constraint_programs::LegProgram;
use crate::events::StopSignal;
use crate::model::PlanningModel;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Query, Res, ResMut};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena, LegParameter, PlannedLeg};
use foliate_components::leaf::{Leaf, LeafIndex};
use foliate_components::outcome::Rejection;
use foliate_kernels::projection::{MotionEnd, MotionScratch, MotionSettings, Settings, project_motion};
use rayon::prelude::*;

/// A motion on a leaf.
#[derive(Clone, Debug, PartialEq)]
pub struct Steered {
    /// Whole configurations, end to end.
    pub knots: Vec<f64>,
    /// Proven bound of the residual of implicit rows.
    pub residual: f64,
}

/// Steers every planned leg of every candidate. A leg that leaves its leaf ends the candidate.
pub fn steer_legs(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    leaves: Res<'_, LeafIndex>,
    mut arena: ResMut<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let mut pool: Vec<_> = candidates.iter_mut().collect();
    pool.sort_unstable_by_key(|c| c.index);
    pool.par_iter_mut().zip(arena.legs.par_iter_mut()).filter(|(c, _)| c.is_alive()).for_each(|(candidate, legs)| {
        for index in 0..legs.len() {
            // A leg with implicit rows of a humanoid may take long.
            if stop.is_raised() {
                candidate.reject(Rejection::Stopped);
                legs.clear();
                return;
            }
            if !steer_leg(&model, &settings, &leaves, &mut legs[index]) {
                candidate.reject(Rejection::SteeringFailed(legs[index].leg as u8));
                legs.clear();
                return;
            }
        }
    });
}

/// Replaces a leg's two ends by a polyline on its leaf; false where it does not arrive.
fn steer_leg(model: &PlanningModel, settings: &SearchSettings, leaves: &LeafIndex, leg: &mut PlannedLeg) -> bool {
    let Ok(interior) = model.interior_program(leg.state) else { return false };
    if interior.program.rows() == 0 {
        return true;
    }
    let size = model.problem.robot.space.size();
    let arguments = interior.arguments(model, leaves, leg.state, &leg.parameters, None);
    if leg.knots.len() <= size {
        return true;
    }
    let (a, b) = leg.knots.split_at(size);
    let steered = project_between(model, settings, interior, &arguments, a, &b[b.len() - size..]);
    steered.is_some_and(|steered| {
        leg.knots = steered.knots;
        leg.residual = steered.residual;
        true
    })
}

/// A motion on a leaf between two of its configurations; `None` where it does not arrive.
#[must_use]
pub fn steer_whole(
    model: &PlanningModel,
    settings: &SearchSettings,
    leaf: &Leaf,
    leaves: &LeafIndex,
    a: &[f64],
    b: &[f64],
) -> Option<Steered> {
    let interior = model.interior_program(leaf.state).ok()?;
    if interior.program.rows() == 0 {
        return Some(Steered { knots: [a, b].concat(), residual: 0.0 });
    }
    let parameters: Vec<_> = leaf.parameters.iter().map(|&p| LegParameter::Known(p)).collect();
    let arguments = interior.arguments(model, leaves, leaf.state, &parameters, None);
    project_between(model, settings, interior, &arguments, a, b)
}

/// Projects the straight motion from `a` to `b` onto implicit rows; `None` where it does not arrive.
fn project_between(
    model: &PlanningModel,
    settings: &SearchSettings,
    interior: &LegProgram,
    arguments: &[Pose],
    a: &[f64],
    b: &[f64],
) -> Option<Steered> {
    let motion = MotionSettings {
        path_tolerance: settings.path_tolerance,
        solve: Settings { tolerance: settings.projection_tolerance, ..Settings::default() },
        ..MotionSettings::default()
    };
    let mut knots = Vec::new();
    let mut scratch = MotionScratch::default();
    let space = &model.problem.robot.space;
    let end = project_motion(&interior.program, space, (a, b), arguments, &motion, &mut scratch, &mut knots);
    (end == MotionEnd::Reached).then_some(Steered { knots, residual: settings.path_tolerance })
}
