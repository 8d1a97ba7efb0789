//! Grippers, handles and contact surfaces.

use crate::view::document::model::{DocumentsEntry, FrameEntry, HandleEntry, SurfaceEntry};
use crate::view::parts::tree::row;
use foliate_components::robot::{PartKind, Robot, SurfaceIndex};

/// All that the robot has. `supports` are the surfaces that carry objects, where a problem says which; otherwise those of what is no object.
pub(crate) fn documents(robot: &Robot, supports: Option<&[SurfaceIndex]>) -> DocumentsEntry {
    let grippers = robot.grippers.iter().map(|gripper| FrameEntry {
        name: gripper.name.clone(),
        link: gripper.link.at(),
        pose: row(&gripper.link_from_gripper),
    });
    let handles = robot.handles.iter().map(|handle| HandleEntry {
        name: handle.name.clone(),
        link: handle.link.at(),
        pose: row(&handle.link_from_handle),
        approach: Some(handle.approaching_direction.to_array()),
        mask: handle.mask,
    });
    let surfaces = robot.surfaces.iter().enumerate().flat_map(|(index, surface)| {
        let index = SurfaceIndex(index as u32);
        let of_object = robot.parts[robot.links[surface.link.at()].part.at()].kind == PartKind::Object;
        let carries = supports.map_or(!of_object, |supports| supports.contains(&index));
        let kind = if carries { "support" } else { "contact" };
        surface.polygons.iter().map(move |polygon| SurfaceEntry {
            name: surface.name.clone(),
            link: surface.link.at(),
            kind,
            polygon: polygon.iter().map(|&corner| surface.points[corner as usize].to_array()).collect(),
        })
    });
    DocumentsEntry { grippers: grippers.collect(), handles: handles.collect(), surfaces: surfaces.collect() }
}
