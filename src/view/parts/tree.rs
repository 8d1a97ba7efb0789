//! The kinematic tree and the shapes of its links.

use crate::scene::visuals::{Visual, Visuals};
use crate::view::document::PoseRow;
use crate::view::document::model::{JointEntry, LinkEntry, PartEntry, PlacedShapeEntry, ShapeEntry};
use crate::view::geometry::mesh_store::MeshStore;
use foliate_components::Pose;
use foliate_components::pose::pose_to_array;
use foliate_components::robot::shape::Geometry;
use foliate_components::robot::{Joint, JointType, PartKind, Robot, Source};

/// A pose as documents have it, its quaternion of length 1.
pub(crate) fn row(pose: &Pose) -> PoseRow {
    pose_to_array(&Pose::from_parts(pose.translation, pose.rotation.normalize()))
}

pub(crate) fn parts(robot: &Robot) -> Vec<PartEntry> {
    let kind = |kind| match kind {
        PartKind::Robot => "robot",
        PartKind::Object => "object",
        PartKind::Environment => "environment",
    };
    robot.parts.iter().map(|part| PartEntry { name: part.name.clone(), kind: kind(part.kind) }).collect()
}

pub(crate) fn joints(robot: &Robot) -> Vec<JointEntry> {
    robot.joints.iter().map(joint).collect()
}

fn joint(joint: &Joint) -> JointEntry {
    let (kind, axis) = match joint.motion {
        JointType::Revolute { axis } => ("revolute", Some(axis)),
        JointType::Prismatic { axis } => ("prismatic", Some(axis)),
        JointType::Planar => ("planar", None),
        JointType::FreeFlyer => ("freeflyer", None),
    };
    let (own, follows) = match joint.source {
        Source::Coordinates { q, v } => (Some((q, v)), None),
        Source::Follows { leader, multiplier, offset } => (None, Some((leader.at(), multiplier, offset))),
    };
    let bounds = |bounds: &[f64]| bounds.iter().map(|&x| Some(x).filter(|x| x.is_finite())).collect();
    JointEntry {
        name: joint.name.clone(),
        part: joint.part.at(),
        parent: joint.parent.map(|parent| parent.at()),
        parent_from_joint: row(&joint.parent_from_joint),
        kind,
        axis: axis.map(|axis| axis.to_array()),
        q: own.map(|(q, _)| q),
        v: own.map(|(_, v)| v),
        leader: follows.map(|(leader, ..)| leader),
        multiplier: follows.map(|(_, multiplier, _)| multiplier),
        offset: follows.map(|(.., offset)| offset),
        lower: bounds(&joint.lower),
        upper: bounds(&joint.upper),
        velocity: joint.velocity_limit,
    }
}

/// Links with what they look like and what is tested. Meshes go to the store.
pub(crate) fn links(robot: &Robot, visuals: &Visuals, store: &mut MeshStore) -> Vec<LinkEntry> {
    let tested = Visuals::of_shapes(robot);
    let mut placed = |shown: &[Visual]| shown.iter().map(|visual| shape(visual, store)).collect::<Vec<_>>();
    let entry = |(index, link): (usize, &foliate_components::robot::Link)| LinkEntry {
        name: link.name.clone(),
        part: link.part.at(),
        joint: link.joint.map(|joint| joint.at()),
        joint_from_link: row(&link.joint_from_link),
        visual: placed(&visuals.links[index]),
        collision: placed(&tested.links[index]),
    };
    robot.links.iter().enumerate().map(entry).collect()
}

fn shape(visual: &Visual, store: &mut MeshStore) -> PlacedShapeEntry {
    let shape = match &visual.geometry {
        Geometry::Mesh(mesh) => ShapeEntry::Mesh(store.number(mesh)),
        Geometry::Box { half_extents } => ShapeEntry::Box((*half_extents * 2.0).to_array()),
        Geometry::Sphere { radius } => ShapeEntry::Sphere(*radius),
        Geometry::Cylinder { radius, half_length } => ShapeEntry::Cylinder([*radius, 2.0 * half_length]),
        Geometry::Capsule { radius, half_length } => ShapeEntry::Capsule([*radius, 2.0 * half_length]),
    };
    let missing = visual.missing.clone();
    PlacedShapeEntry { shape, pose: row(&visual.link_from_visual), color: visual.color, missing }
}
