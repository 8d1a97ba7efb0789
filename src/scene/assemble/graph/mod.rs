//! `[graph]`: `options` reads what the constraint graph is built from, `hands` which grippers have fingers, `written` states and
//! transitions of the scene's own.

pub(crate) mod hands;
pub(crate) mod options;
pub(crate) mod written;
