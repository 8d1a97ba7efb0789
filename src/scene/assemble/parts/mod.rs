//! `[[part]]`: a part with its files (`part`), the grippers, handles and surfaces that a scene adds (`documents`), solids that stand in the
//! scene itself (`shape`), and what it leaves open: bounds of roots (`root_bounds`), and grippers, handles and surfaces that are found (`auto`, by keys that `auto_keys` reads).

pub(crate) mod auto;
pub(crate) mod auto_keys;
pub(crate) mod documents;
pub(crate) mod part;
pub(crate) mod root_bounds;
pub(crate) mod shape;
