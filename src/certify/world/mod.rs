//! TODO(page): what lies in certify/world.

pub(crate) mod levers;
pub(crate) mod limits;
pub(crate) mod phases;
pub(crate) mod report;
