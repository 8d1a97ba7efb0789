//! Planning: `solve` makes a `solution` and a `report`.

pub(crate) mod report;
pub(crate) mod solution;
pub(crate) mod solve;
