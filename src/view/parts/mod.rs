//! What stands in a page whatever it is about: `tree` writes parts, joints and links, `documents` grippers, handles and surfaces.

pub(crate) mod documents;
pub(crate) mod tree;
