//! Planning: a `request` says how, `solve` makes a `solution` and a `report`; `batch` plans many problems side by side.

pub(crate) mod batch;
pub(crate) mod report;
pub(crate) mod request;
pub(crate) mod solution;
pub(crate) mod solve;
