//! Foliate: a manipulation-planning kernel. It takes robots, objects and an environment, knows which gripper may hold
//! which handle and which surface may carry which object, and finds a certified motion of everything at once.
#![forbid(unsafe_code)]

pub mod scene;

pub use foliate_components as components;
pub use foliate_kernels as kernels;
