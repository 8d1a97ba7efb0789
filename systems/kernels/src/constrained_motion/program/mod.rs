//! Constraint programs: a set of constraints, compiled for one robot.
//!
//! `compile` is the entry point. It checks the constraints (`checking`, with the errors of `error`) and hands them to the
//! `Compiler` of `elimination`, which eliminates the objects and joints that they determine. `assembly` makes the program of
//! what remains: blocks of rows, columns, moves and bounds, with the numbers that `numbering` gives to variables and rows.
//! `constraint_program` defines the result, which is immutable; it reads arguments and checks configurations with the buffers of
//! `scratch`. The folder `newton` solves programs.

pub(crate) mod assembly;
pub(crate) mod checking;
pub(crate) mod compile;
pub(crate) mod constraint_program;
pub(crate) mod elimination;
pub(crate) mod error;
pub(crate) mod numbering;
pub(crate) mod scratch;
