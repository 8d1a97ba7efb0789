//! `[[part]]`: a part with its files (`part`), the grippers, handles and surfaces that a scene adds (`documents`), solids that stand in the
//! scene itself (`shape`), and bounds of roots that the scene leaves open (`root_bounds`).

pub(crate) mod documents;
pub(crate) mod part;
pub(crate) mod root_bounds;
pub(crate) mod shape;
