//! Scenes from models: what MoveIt's Setup Assistant does, as a library.
//!
//! [`new_scene()`] looks at a robot and some objects and gives the text of a scene that solves. It finds which links touch by design
//! ([`collision_matrix`]), the grippers ([`grippers`]), where each object can be held ([`handles`]), the faces on which it rests and that
//! carry it ([`surfaces`]), and places within reach (`places`). All of it is written as plain entries (`writing`); nothing is decided
//! again when the scene is solved. The same models and seed give the same text.

pub mod collision_matrix;
mod error;
pub mod grasps_file;
pub mod grippers;
pub mod handles;
pub mod new_scene;
pub mod objects;
pub(crate) mod places;
pub mod request;
pub(crate) mod solids;
pub mod surfaces;
pub(crate) mod writing;

pub use crate::setup::error::SetupError;
pub use crate::setup::new_scene::{NewScene, WrittenScene, new_scene};
