//! TODO(page): what lies in cli/console.

pub(crate) mod interrupt;
pub(crate) mod loading;
pub(crate) mod print;
pub(crate) mod processor_time;
pub(crate) mod watchdog;
