//! Tools: frames that a person names.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::hand::{FoundGripper, GripperKind};
use crate::setup::solids::surface_points::{on_grid, triangles};
use foliate_components::Pose;
use foliate_components::robot::{LinkIndex, Robot};
use glam::{DMat3, DQuat, DVec3};

/// How far from the axis the tip of a tool is looked for, metres.
const TIP_RADIUS: f64 = 0.02;

/// `LINK` or `LINK:AXIS`: the link's name, and the approach in it.
pub(super) fn axis_of(name: &str) -> (&str, Option<DVec3>) {
    let axes =
        [("x", DVec3::X), ("-x", -DVec3::X), ("y", DVec3::Y), ("-y", -DVec3::Y), ("z", DVec3::Z), ("-z", -DVec3::Z)];
    let Some((link, word)) = name.rsplit_once(':') else { return (name, None) };
    match axes.iter().find(|(known, _)| *known == word) {
        Some(&(_, axis)) => (link, Some(axis)),
        None => (name, None),
    }
}

/// A tool on a link. Its approach is z of the link unless another axis is given; its origin is the foremost point of the link's body
/// near that axis, or the link's origin where nothing is ahead of it.
pub(super) fn tool(robot: &Robot, link: LinkIndex, axis: Option<DVec3>) -> FoundGripper {
    let record = &robot.links[link.at()];
    let approach = axis.unwrap_or(DVec3::Z);
    let own = record.name.split_once('/').map_or(record.name.as_str(), |(_, own)| own);
    let shapes = robot.shapes.iter().filter(|shape| robot.links[shape.link.at()].joint == record.joint);
    let points = shapes.flat_map(|shape| {
        let X_LS = record.joint_from_link.inverse() * shape.joint_from_shape;
        on_grid(&triangles(&shape.geometry, &X_LS), 0.004)
    });
    let near = points.filter(|p| p.reject_from_normalized(approach).length() < TIP_RADIUS);
    let ahead = near.map(|p| p.dot(approach)).fold(0.0, f64::max);
    let closing = approach.any_orthonormal_vector();
    let link_from_gripper = Pose::from_parts(approach * ahead, frame(approach, closing));
    let word = axis.map_or("z, the convention of tool frames", |_| "as given");
    let reason = format!("a tool on `{own}`; its approach is {word}, its tip {:.1} mm ahead", ahead * 1e3);
    let (kind, fingers, solids) = (GripperKind::Tool, Vec::new(), Vec::new());
    FoundGripper { name: String::new(), link, link_from_gripper, kind, fingers, reason, solids }
}

/// The rotation whose x axis approaches and whose y axis closes.
pub(super) fn frame(approach: DVec3, closing: DVec3) -> DQuat {
    DQuat::from_mat3(&DMat3::from_cols(approach, closing, approach.cross(closing))).normalize()
}
