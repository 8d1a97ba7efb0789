//! The rows of a program in lanes: one problem per lane.
//!
//! `form` defines the data of a program for lanes. `building` makes it from the blocks of the folder `rows`. `linearise` computes
//! values and Jacobian of a form; it uses `balance` for centres of mass, and both use `slots` to load and store. `memory` holds
//! the rows that a solve works in.
//!
//! Everything depends on `form`, and nothing here solves: the Newton iteration is in the folder `newton`.

pub(crate) mod balance;
pub(crate) mod building;
pub(crate) mod form;
pub(crate) mod linearise;
pub(crate) mod memory;
pub(crate) mod slots;
