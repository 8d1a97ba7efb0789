//! TODO(page): what lies in step.

pub mod commit;
pub mod conclusion;
pub mod connection;
pub mod projection;
pub mod rendezvous;
pub mod sampling;
pub mod selection;
pub mod steering;
pub mod validation;
pub mod waypoints;
