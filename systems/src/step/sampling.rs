//! Set Sample: shoots q_rand for each candidate from its own stream (P1 §III-A step 1).

use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::LEAST_SHARED;
use crate::runtime::random::{Purpose, stream};
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Query, Res, ResMut};
use foliate_components::candidate::{Candidate, CandidateArena};
use rayon::prelude::*;

/// Makes every candidate ready for a new step.
///
/// # Panics
/// If the candidates are not in the order of their indices, by which systems pair them with their numbers: then the entity of
/// one has changed its archetype.
pub fn reset_candidates(mut candidates: Query<'_, '_, &mut Candidate>, mut arena: ResMut<'_, CandidateArena>) {
    for (place, mut candidate) in candidates.iter_mut().enumerate() {
        assert_eq!(candidate.index as usize, place, "the entities of candidates keep their archetype");
        candidate.reset();
    }
    arena.legs.iter_mut().for_each(Vec::clear);
    arena.complete.fill(false);
}

/// Draws a random configuration for every candidate, uniformly within bounds; locked joints keep their values.
pub fn sample_configurations(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    mut arena: ResMut<'_, CandidateArena>,
) {
    let size = arena.configuration_size();
    arena.random.par_chunks_mut(size).enumerate().with_min_len(2 * LEAST_SHARED).for_each(|(candidate, q)| {
        let mut rng = stream(settings.seed, Purpose::SAMPLE, step.step, candidate as u32);
        model.problem.robot.space.random(&mut rng, q);
        model.lock(q);
    });
}
