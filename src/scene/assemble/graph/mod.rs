//! `[graph]`: `options` reads what the constraint graph is built from, `hands` which grippers have fingers, `rests` how objects must lie,
//! `faces` joins the pieces of faces that documents cut, `written` states and transitions of the scene's own.

pub(crate) mod faces;
pub(crate) mod hands;
pub(crate) mod options;
pub(crate) mod rests;
pub(crate) mod written;
