//! Where a gripper can hold an object: families of grasps on boxes, cylinders and spheres (`primitives`), antipodal grasps sampled on any
//! other surface (`antipodal`), places for tools (`tool_places`). `find` chooses among them; `handle` is the result and the test against the
//! hand's own shapes. `kinds` says which grippers share handles, `refusal` why an object has none.

mod antipodal;
mod find;
mod handle;
mod kinds;
mod primitives;
mod refusal;
mod tool_places;

pub use crate::setup::handles::find::handles;
pub(crate) use crate::setup::handles::handle::can_take_turned;
pub use crate::setup::handles::handle::{FoundHandle, HandleSettings};
pub(crate) use crate::setup::handles::kinds::{Kinds, distinct};
pub(crate) use crate::setup::handles::refusal::no_grasp;
