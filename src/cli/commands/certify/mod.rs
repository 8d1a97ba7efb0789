//! `foliate certify`: is anyone's motion free, everywhere, and within its limits?
//!
//! `run` reads its options by `arguments`, certifies the motion, and prints the report as JSON or by `text`.

pub(crate) mod arguments;
pub(crate) mod run;
pub(crate) mod text;
