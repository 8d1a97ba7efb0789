//! Where everything is: poses of bodies from configurations.

mod forward;
mod jacobian;

pub use forward::{Carriage, Kinematics, Placement};
pub use jacobian::{AttachmentTree, Column, geometric_jacobian};
