//! How a call of Python runs: on `workers`, ended by Ctrl-C (`interruption`), its errors as exceptions (`errors`).

pub(crate) mod errors;
pub(crate) mod interruption;
pub(crate) mod workers;
