//! TODO(page): what lies in cli/commands.

pub(crate) mod bench;
pub(crate) mod certify;
pub(crate) mod check;
pub(crate) mod demo;
pub(crate) mod graph;
pub(crate) mod inspect;
pub(crate) mod models;
pub(crate) mod scenes;
pub(crate) mod solve;
