//! The schedulers that ship, by name, and which of them is the default.

use crate::mrrt;
use crate::sequence::scheduler;
use foliate_systems::search::scheduler::Scheduler;

/// Name of the shipped scheduler that is used where none is asked for: the best over all shipped scenes
/// (docs/decisions/0005).
pub const DEFAULT: &str = "sequence";

/// The scheduler called [`DEFAULT`].
#[must_use]
pub fn default_scheduler() -> Box<dyn Scheduler> {
    named(DEFAULT).unwrap_or_else(|| Box::new(scheduler::Sequence))
}

/// The schedulers that Foliate ships.
#[must_use]
pub fn shipped() -> Vec<Box<dyn Scheduler>> {
    vec![
        Box::new(scheduler::Sequence),
        Box::new(mrrt::Mrrt),
        Box::new(crate::portfolio::scheduler::Portfolio::default()),
    ]
}

/// The shipped scheduler of that name.
#[must_use]
pub fn named(name: &str) -> Option<Box<dyn Scheduler>> {
    shipped().into_iter().find(|s| s.name() == name)
}

#[cfg(test)]
mod tests {
    use crate::shipped::{DEFAULT, default_scheduler, named, shipped};

    #[test]
    fn schedulers_are_found_by_their_names() {
        assert!(shipped().iter().all(|s| named(s.name()).is_some_and(|found| found.name() == s.name())));
        assert!(named("nothing").is_none());
        assert_eq!(default_scheduler().name(), DEFAULT);
    }
}
