//! TODO(page): what lies in collision/continuous.

pub(crate) mod adaptive_certifier;
pub mod minimum;
pub mod minimum_settings;
pub mod polyline;
pub mod straight;
pub(crate) mod subdivision;
