//! A scene from a robot and objects: `made` makes it of what `request` asks for; `read_objects` and `holding` find what objects are and how they
//! are held, `own_roots` bounds what a model drives by, `setting` lays them out and plans, `draft` collects what is written.

mod draft;
mod holding;
mod made;
mod own_roots;
mod read_objects;
mod request;
mod setting;

pub use crate::setup::new_scene::made::new_scene;
pub use crate::setup::new_scene::request::{DRIVES, NewScene, WrittenScene};
