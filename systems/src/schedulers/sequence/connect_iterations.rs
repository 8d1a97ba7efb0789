//! Rounds of joining in one step: a motion that fails may leave another sequence whose motions are all untried.

use crate::runtime::system_sequence::SystemSequence;
use crate::schedule::StepCounter;
use crate::schedulers::sequence::joining;
use crate::step::commit;
use crate::step::connection::connect;
use bevy_ecs::error::Result;
use bevy_ecs::prelude::{Mut, Resource, World};

/// Rounds in a step at most.
const MOST_ITERATIONS: usize = 6;

/// The systems of a round.
#[derive(Resource)]
pub struct ConnectIterations(SystemSequence);

impl Default for ConnectIterations {
    fn default() -> Self {
        Self(SystemSequence::of((
            joining::propose_joins,
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
pub fn join_iteratively(world: &mut World) -> Result {
    world.resource_scope(|world, mut connect_iterations: Mut<'_, ConnectIterations>| {
        for _ in 0..MOST_ITERATIONS {
            let before = world.resource::<StepCounter>().connections;
            connect_iterations.0.run(world)?;
            if world.resource::<StepCounter>().connections == before {
                break;
            }
        }
        Ok(())
    })
}
