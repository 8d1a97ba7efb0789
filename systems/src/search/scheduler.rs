//! The trait of search schedulers.
//!
//! It is apart from the schedulers that ship, so that `session` depends on none of them.

use bevy_ecs::prelude::{Schedule, World};
use std::sync::Arc;

/// A search scheduler: it fills the sets of a step with systems.
///
/// Ours have no private doors: `examples/own_scheduler.rs` composes one from the same public systems.
pub trait Scheduler: Send + Sync {
    /// Its name on the command line and in results.
    fn name(&self) -> &'static str;

    /// The systems of one step, in their sets. `world` is the one in which they will run, with all resources in place: a
    /// scheduler may add its own there. One that leaves out [`crate::goals::systems::draw_more_goals`] has only those
    /// configurations of partial goals that were found before the first step. One whose systems step searches of their own
    /// hands over the world that answers as [`crate::search::session::AnswerIn`].
    fn schedule(&self, world: &mut World) -> Schedule;
}

impl<S: Scheduler + ?Sized> Scheduler for Arc<S> {
    fn name(&self) -> &'static str {
        self.as_ref().name()
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        self.as_ref().schedule(world)
    }
}
