//! How a path file calls what is held.

use foliate_components::robot::{HandleIndex, Robot};

/// The part that a handle is on, with the link where that is not rigidly the part's root.
pub(super) fn held(robot: &Robot, handle: HandleIndex) -> String {
    let link = &robot.links[robot.handles[handle.at()].link.at()];
    let part = &robot.parts[link.part.at()];
    if link.joint == robot.links[part.root_link.at()].joint { part.name.clone() } else { link.name.clone() }
}
