//! Rounds of joining in one step: a motion that fails may leave another sequence whose motions are all untried.

use crate::sequence::leaf_graph::LeafGraph;
use crate::sequence::local_plans::LocalPlans;
use crate::sequence::{foundations, joining};
use bevy_ecs::error::Result;
use bevy_ecs::prelude::{Mut, Res, ResMut, Resource, World};
use foliate_systems::exploration::memory::SchedulerBytes;
use foliate_systems::runtime::system_sequence::SystemSequence;
use foliate_systems::schedule::StepCounter;
use foliate_systems::step::commit;
use foliate_systems::step::connection::connect;

/// Rounds in a step at most.
const MOST_ITERATIONS: usize = 6;

/// The systems of a round.
#[derive(Resource)]
pub struct ConnectIterations(SystemSequence);

impl Default for ConnectIterations {
    fn default() -> Self {
        Self(SystemSequence::of((
            joining::propose_joins,
            foundations::propose_foundations,
            connect::certify_connections,
            joining::learn_from_joins,
            commit::commit_connections,
            foundations::forget_lost,
        )))
    }
}

/// Tells how much memory the leaf graph and the trees of blocked joins take.
pub fn count_memory(graph: Res<'_, LeafGraph>, plans: Res<'_, LocalPlans>, mut bytes: ResMut<'_, SchedulerBytes>) {
    bytes.0 = graph.bytes() + plans.bytes();
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
