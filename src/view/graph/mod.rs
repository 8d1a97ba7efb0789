//! Constraint graphs as pictures.
//!
//! `picture` chooses what is shown and names it, `bundles` lets transitions share lines, `layout` says where boxes and lines go (crate `dagre`, the
//! layered method of Sugiyama), `lines` draws single transitions along them, `svg` writes a picture. `grown` makes the graph of a scene, or of a path alone.

pub(crate) mod bundles;
pub(crate) mod grown;
pub(crate) mod layout;
pub(crate) mod lines;
pub(crate) mod picture;
pub(crate) mod svg;
