//! `[[goal]]`: whole configurations, or requirements on any.
//!
//! `read` takes the goals in turn and combines what `any` lists; `coordinates` reads numbers by name, `demands` what hands hold, what
//! lies where, and regions.

pub(crate) mod coordinates;
pub(crate) mod demands;
pub(crate) mod read;
