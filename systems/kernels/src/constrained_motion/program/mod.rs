//! TODO(page): what lies in constrained_motion/program.

pub(crate) mod assembly;
pub(crate) mod checking;
pub(crate) mod compile;
pub(crate) mod constraint_program;
pub(crate) mod elimination;
pub(crate) mod error;
pub(crate) mod numbering;
pub(crate) mod scratch;
