//! TODO(page): what lies in check/contract.

pub(crate) mod claims;
pub(crate) mod demands;
pub(crate) mod ends;
pub(crate) mod holding;
pub(crate) mod parts;
pub(crate) mod scene_contract;
pub(crate) mod states;
