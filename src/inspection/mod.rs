//! Looking at what is planned with: the geometry of models, the constraint graph as a picture, and both in plain words.

pub mod diagram;
pub(crate) mod geometry;
pub mod words;

pub use crate::inspection::geometry::{Inspection, apart, inspect_pairs};
