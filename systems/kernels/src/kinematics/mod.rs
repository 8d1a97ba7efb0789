//! Where everything is: poses of bodies from configurations.

mod forward;

pub use forward::{Carriage, Kinematics, Placement};
