//! The numbers of Foliate: kinematics, constraints, projection, collision.
//!
//! Nothing here knows an ECS, opens a file or keeps global state: every function takes its tables and slices as arguments
//! and writes into slices that the caller owns.
#![forbid(unsafe_code)]
// Frames stand in names as the field writes them: `X_WG` is the pose of G in W, so that `X_WG * X_GH` reads right.
#![allow(non_snake_case, reason = "pose names carry their frames")]

pub mod collision;
pub mod constrained_motion;
pub mod constraints;
pub mod curve;
pub mod kinematics;
pub mod lanes;
pub mod linear;
pub mod nearest;
pub mod trajectory;
