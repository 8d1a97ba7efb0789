//! Rounds of joining in one step: a motion that fails may leave another sequence whose motions are all untried.

use crate::runtime::system_sequence::InOrder;
use crate::schedule::StepCounter;
use crate::schedulers::sequence::joining;
use crate::step::commit;
use crate::step::connection::connect;
use bevy_ecs::error::Result;
use bevy_ecs::prelude::{Mut, Resource, World};

/// Rounds in a step at most.
const ROUNDS: usize = 6;

/// The systems of a round.
#[derive(Resource)]
pub struct Rounds(InOrder);

impl Default for Rounds {
    fn default() -> Self {
        Self(InOrder::of((
            joining::propose_joins,
            joining::foresee_joins,
            connect::certify_connections,
            joining::learn_from_joins,
            commit::commit_connections,
        )))
    }
}

/// Proposes, certifies and commits joins, round after round until nothing is left to propose.
///
/// # Errors
/// Where a system finds something missing in the world that it asks for.
pub fn join_in_rounds(world: &mut World) -> Result {
    world.resource_scope(|world, mut rounds: Mut<'_, Rounds>| {
        for _ in 0..ROUNDS {
            let before = world.resource::<StepCounter>().connections;
            rounds.0.run(world)?;
            if world.resource::<StepCounter>().connections == before {
                break;
            }
        }
        Ok(())
    })
}
