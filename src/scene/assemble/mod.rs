//! TODO(page): what lies in scene/assemble.

pub(crate) mod constraints;
pub(crate) mod documents;
pub(crate) mod goal;
pub(crate) mod graph;
pub(crate) mod load;
pub(crate) mod names;
pub(crate) mod pairs;
pub(crate) mod part;
pub(crate) mod scene;
pub(crate) mod written;
