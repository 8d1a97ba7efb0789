//! TODO(page): what lies in check/leaf.

pub(crate) mod articulation;
pub(crate) mod balance;
pub(crate) mod carriers;
pub(crate) mod case;
pub(crate) mod check;
pub(crate) mod constraint;
pub(crate) mod drift;
pub(crate) mod on_leaf;
