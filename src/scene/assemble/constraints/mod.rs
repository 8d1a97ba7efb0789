//! TODO(page): what lies in scene/assemble/constraints.

pub(crate) mod constraint;
pub(crate) mod mass;
