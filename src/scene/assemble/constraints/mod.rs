//! The constraints that a scene file writes down. `constraint` reads every kind; `mass` reads those on the centre of mass.
//! `rests` reads how objects must lie on their supports.

pub(crate) mod constraint;
pub(crate) mod mass;
pub(crate) mod rests;
