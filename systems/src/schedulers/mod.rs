//! Search schedulers: compositions of systems over one schedule. One file each; a host's own is written the same way.

pub mod mrrt;
pub mod portfolio;
pub mod sequence;

use bevy_ecs::prelude::{Schedule, World};
use std::sync::Arc;

/// A search scheduler: it fills the sets of a step with systems.
///
/// Ours have no private doors: `examples/own_scheduler.rs` composes one from the same public systems.
pub trait Scheduler: Send + Sync {
    /// Its name on the command line and in results.
    fn name(&self) -> &'static str;

    /// The systems of one step, in their sets. `world` is the one in which they will run, with all resources in place: a
    /// scheduler may add its own there. One that leaves out [`crate::goals::draw_more_goals`] has only those
    /// configurations of partial goals that were found before the first step. One whose systems step searches of their own
    /// hands over the world that answers as [`crate::search::AnswerIn`].
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

/// Name of the shipped scheduler that is used where none is asked for: the best over all shipped scenes (ARCHITECTURE.md,
/// Evidence).
pub const DEFAULT: &str = "sequence";

/// The scheduler called [`DEFAULT`].
#[must_use]
pub fn default_scheduler() -> Box<dyn Scheduler> {
    named(DEFAULT).unwrap_or_else(|| Box::new(sequence::Sequence))
}

/// The schedulers that Foliate ships.
#[must_use]
pub fn shipped() -> Vec<Box<dyn Scheduler>> {
    vec![Box::new(sequence::Sequence), Box::new(mrrt::Mrrt), Box::new(portfolio::Portfolio::default())]
}

/// The shipped scheduler of that name.
#[must_use]
pub fn named(name: &str) -> Option<Box<dyn Scheduler>> {
    shipped().into_iter().find(|s| s.name() == name)
}

#[cfg(test)]
mod tests {
    use super::{DEFAULT, default_scheduler, named, shipped};

    #[test]
    fn schedulers_are_found_by_their_names() {
        assert!(shipped().iter().all(|s| named(s.name()).is_some_and(|found| found.name() == s.name())));
        assert!(named("nothing").is_none());
        assert_eq!(default_scheduler().name(), DEFAULT);
    }
}
