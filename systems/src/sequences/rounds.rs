//! Rounds of joining in one step: a motion that fails may leave another sequence whose motions are all untried.

use super::joining;
use crate::schedule::StepCounter;
use crate::{commit, connection};
use bevy_ecs::prelude::{IntoScheduleConfigs, Mut, Resource, Schedule, World};
use bevy_ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};

/// Rounds in a step at most.
const ROUNDS: usize = 6;

/// The systems of a round. A schedule of their own: what bevy does once to order the systems of a schedule takes a time that
/// grows faster than their number, and six times these systems were most of it.
#[derive(Resource)]
pub struct Rounds(Schedule);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ScheduleLabel)]
struct Round;

impl Default for Rounds {
    fn default() -> Self {
        let mut schedule = Schedule::new(Round);
        schedule.set_executor(SingleThreadedExecutor::new());
        schedule.add_systems(
            (
                joining::propose_joins,
                joining::foresee_joins,
                connection::certify_connections,
                joining::learn_from_joins,
                commit::commit_connections,
            )
                .chain(),
        );
        Self(schedule)
    }
}

/// Proposes, certifies and commits joins, round after round until nothing is left to propose.
pub fn join_in_rounds(world: &mut World) {
    world.resource_scope(|world, mut rounds: Mut<'_, Rounds>| {
        for _ in 0..ROUNDS {
            let before = world.resource::<StepCounter>().connections;
            rounds.0.run(world);
            if world.resource::<StepCounter>().connections == before {
                return;
            }
        }
    });
}
