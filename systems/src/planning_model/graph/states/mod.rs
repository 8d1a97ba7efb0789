//! States of the graph: `state_keys` distinguishes them by what they require (`own_constraints`: of the problem's own), `state_names` says what they
//! are called.

mod own_constraints;
pub(crate) mod state_keys;
mod state_names;
