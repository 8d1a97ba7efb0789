//! TODO(page): what lies in check/clearance.

pub(crate) mod adjacent;
pub(crate) mod along;
pub(crate) mod certificate;
pub(crate) mod enclosure;
pub(crate) mod pairs;
