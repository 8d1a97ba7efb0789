//! Looking at what is planned with: the geometry of models, and the constraint graph as a picture.

pub mod diagram;
pub(crate) mod geometry;

pub use crate::inspection::geometry::{Inspection, apart, inspect_pairs};
