//! The constraints that a scene file writes down. `constraint` reads every kind; `mass` reads those on the centre of mass.

pub(crate) mod constraint;
pub(crate) mod mass;
