//! Grippers of a robot that no document describes: jaws are found by their joints and measured by their shapes (`jaws`, `measure`), tools
//! are named (`tools`). `find` does both, `declared` finds the hand of a frame in a document; `hand` is the result, with what grasps are tested against.

mod bodies;
mod declared;
mod find;
mod hand;
mod jaws;
mod measure;
mod tools;

pub(crate) use crate::setup::grippers::bodies::{coordinate, is_beyond, leader};
pub(crate) use crate::setup::grippers::declared::declared;
pub use crate::setup::grippers::find::{grippers, hands};
pub use crate::setup::grippers::hand::{FingerRange, FoundGripper, GripperKind};
