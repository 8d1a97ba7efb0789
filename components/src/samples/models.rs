//! Small models built in code, for tests, examples and documentation: no file is read.

use crate::Pose;
use crate::pose::rotation_from_rpy;
use crate::robot::joint::{PartKind, PartPlacement, RootJoint};
use crate::robot::model::{GripperModel, HandleModel, Inertial, JointKind, JointModel, LinkModel, Model, SurfaceModel};
use crate::robot::shape::geometry::Geometry;
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// A robot fixed in the world.
#[must_use]
pub fn fixed_robot(name: &str, world_from_root: Pose) -> PartPlacement {
    part(name, PartKind::Robot, RootJoint::Fixed, world_from_root)
}

/// An object that can be carried anywhere within two metres of the world's origin.
#[must_use]
pub fn movable_object(name: &str) -> PartPlacement {
    let root_bounds = vec![(-2.0, 2.0); 3];
    PartPlacement { root_bounds, ..part(name, PartKind::Object, RootJoint::FreeFlyer, Pose::identity()) }
}

/// Something that never moves.
#[must_use]
pub fn environment(name: &str, world_from_root: Pose) -> PartPlacement {
    part(name, PartKind::Environment, RootJoint::Fixed, world_from_root)
}

/// A part without bounds of its own; mimic joints follow.
#[must_use]
pub fn part(name: &str, kind: PartKind, root: RootJoint, world_from_root: Pose) -> PartPlacement {
    PartPlacement::new(name, kind, root, world_from_root)
}

/// Two revolute joints about z, links of one metre along x, limits ±π; gripper `tip` at the end, x along the last link.
#[must_use]
pub fn two_joint_arm() -> Model {
    let bar = (Pose::from_parts(DVec3::X * 0.5, DQuat::from_rotation_y(FRAC_PI_2)), capsule(0.03, 0.45));
    let mut model = Model { name: "two_joint_arm".into(), ..Model::default() };
    model.links = vec![link("base", vec![]), link("upper", vec![bar.clone()]), link("lower", vec![bar])];
    model.joints = vec![
        revolute("shoulder", 0, 1, Pose::identity(), (-PI, PI)),
        revolute("elbow", 1, 2, Pose::from_translation(DVec3::X), (-PI, PI)),
    ];
    model.grippers = vec![gripper("tip", "lower", Pose::from_translation(DVec3::X), 0.02)];
    model
}

/// A seven-axis arm with the joint offsets and limits that Baxter's left arm publishes (`baxter_common`, left_s0 …
/// left_w2), from its mount on. Gripper `hand` is 14 cm beyond the last joint, x along the approach.
#[must_use]
pub fn seven_axis_arm() -> Model {
    let quarter = FRAC_PI_2;
    // Name, origin, roll-pitch-yaw, limits.
    let joints = [
        ("s0", DVec3::new(0.055_695, 0.0, 0.011_038), [0.0, 0.0, 0.0], (-1.701_679_938_78, 1.701_679_938_78)),
        ("s1", DVec3::new(0.069, 0.0, 0.270_35), [-quarter, 0.0, 0.0], (-2.147, 1.047)),
        ("e0", DVec3::new(0.102, 0.0, 0.0), [quarter, 0.0, quarter], (-3.054_179_938_78, 3.054_179_938_78)),
        ("e1", DVec3::new(0.069, 0.0, 0.262_42), [-quarter, -quarter, 0.0], (-0.05, 2.618)),
        ("w0", DVec3::new(0.103_59, 0.0, 0.0), [quarter, 0.0, quarter], (-3.059, 3.059)),
        ("w1", DVec3::new(0.01, 0.0, 0.2707), [-quarter, -quarter, 0.0], (-quarter, 2.094)),
        ("w2", DVec3::new(0.115_975, 0.0, 0.0), [quarter, 0.0, quarter], (-3.059, 3.059)),
    ];
    let half_lengths = [0.12, 0.06, 0.12, 0.06, 0.12, 0.06, 0.04];
    let mut model = Model { name: "seven_axis_arm".into(), ..Model::default() };
    model.links.push(link("mount", vec![]));
    for (number, (name, origin, [roll, pitch, yaw], limits)) in joints.into_iter().enumerate() {
        let shape = (Pose::identity(), capsule(0.05, half_lengths[number]));
        model.links.push(link(&format!("{name}_link"), vec![shape]));
        let pose = Pose::from_parts(origin, rotation_from_rpy(roll, pitch, yaw));
        model.joints.push(revolute(name, number, number + 1, pose, limits));
    }
    let hand = Pose::from_parts(DVec3::Z * 0.14, DQuat::from_rotation_y(-FRAC_PI_2));
    model.grippers = vec![gripper("hand", "w2_link", hand, 0.025)];
    model
}

/// A hand with two fingers: `left_finger` slides along y from 0 to 4 cm, `right_finger` mimics it with multiplier −1.
#[must_use]
pub fn two_finger_hand() -> Model {
    let finger = (Pose::from_translation(DVec3::X * 0.04), solid_box(DVec3::new(0.04, 0.005, 0.01)));
    let mut model = Model { name: "two_finger_hand".into(), ..Model::default() };
    model.links = vec![
        link("palm", vec![(Pose::identity(), solid_box(DVec3::new(0.03, 0.05, 0.02)))]),
        link("left", vec![finger.clone()]),
        link("right", vec![finger]),
    ];
    let slide = |name: &str, child, mimic| JointModel {
        name: name.into(),
        kind: JointKind::Prismatic,
        parent: 0,
        child,
        parent_from_joint: Pose::from_translation(DVec3::X * 0.03),
        axis: DVec3::Y,
        limits: if child == 1 { (0.0, 0.04) } else { (-0.04, 0.0) },
        velocity_limit: None,
        mimic,
    };
    model.joints =
        vec![slide("left_finger", 1, None), slide("right_finger", 2, Some(("left_finger".into(), -1.0, 0.0)))];
    model
}

/// A humanoid of 58 kg for a free-flyer root: two legs of six joints, a waist, two arms of seven, all revolute, every link
/// with a mass. Standing upright the pelvis is 0.9 m above the ankles' frames. Names are `l_` or `r_` and `hip_yaw`,
/// `hip_roll`, `hip_pitch`, `knee`, `ankle_pitch`, `ankle_roll`, `shoulder_pitch`, `shoulder_roll`, `shoulder_yaw`,
/// `elbow`, `wrist_yaw`, `wrist_pitch`, `wrist_roll`; grippers `l_hand` and `r_hand`, x along the fingers.
#[must_use]
pub fn humanoid() -> Model {
    let heavy = |name: &str, mass: f64, center: DVec3| LinkModel {
        inertial: Some(Inertial { mass, center }),
        ..link(name, vec![(Pose::from_translation(center), Geometry::Sphere { radius: 0.06 })])
    };
    let mut model = Model { name: "humanoid".into(), ..Model::default() };
    model.links.push(heavy("pelvis", 9.0, DVec3::new(0.0, 0.0, 0.05)));
    let mut chain = |parent: usize, prefix: &str, joints: &[LimbJoint]| {
        let mut parent = parent;
        for &(name, origin, axis, limits, mass, center) in joints {
            let (name, child) = (format!("{prefix}{name}"), model.links.len());
            model.links.push(heavy(&format!("{name}_link"), mass, center));
            let pose = Pose::from_translation(origin);
            model.joints.push(JointModel { axis, ..revolute(&name, parent, child, pose, limits) });
            parent = child;
        }
        parent
    };
    let waist = [("waist", DVec3::Z * 0.1, DVec3::Z, (-1.0, 1.0), 16.0, DVec3::new(0.01, 0.0, 0.2))];
    let torso = chain(0, "", &waist);
    for (prefix, side) in [("l_", 1.0), ("r_", -1.0)] {
        chain(0, prefix, &leg(side));
        chain(torso, prefix, &arm(side));
        let palm = Pose::from_parts(DVec3::Z * -0.12, DQuat::from_rotation_y(FRAC_PI_2));
        model.grippers.push(gripper(&format!("{prefix}hand"), &format!("{prefix}wrist_roll_link"), palm, 0.03));
    }
    model
}

/// Name, origin in the parent, axis, limits, mass of the link beyond, its centre.
type LimbJoint = (&'static str, DVec3, DVec3, (f64, f64), f64, DVec3);

fn leg(side: f64) -> [LimbJoint; 6] {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    [
        ("hip_yaw", DVec3::new(0.0, 0.09 * side, -0.04), z, (-0.6, 0.6), 1.2, z * -0.01),
        ("hip_roll", z * -0.02, x, (-0.5, 0.5), 1.5, DVec3::new(0.01, 0.0, -0.02)),
        ("hip_pitch", DVec3::ZERO, y, (-1.9, 0.7), 4.5, DVec3::new(0.0, 0.01 * side, -0.18)),
        ("knee", z * -0.42, y, (-0.02, 2.4), 2.8, DVec3::new(0.01, 0.0, -0.17)),
        ("ankle_pitch", z * -0.42, y, (-1.3, 0.7), 0.4, DVec3::ZERO),
        ("ankle_roll", DVec3::ZERO, x, (-0.5, 0.5), 0.9, DVec3::new(0.03, 0.0, -0.06)),
    ]
}

fn arm(side: f64) -> [LimbJoint; 7] {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let outwards = if side > 0.0 { (-0.3, 2.6) } else { (-2.6, 0.3) };
    [
        ("shoulder_pitch", DVec3::new(0.0, 0.2 * side, 0.35), y, (-2.8, 1.5), 1.0, DVec3::Y * 0.02 * side),
        ("shoulder_roll", DVec3::ZERO, x, outwards, 0.8, z * -0.03),
        ("shoulder_yaw", z * -0.1, z, (-2.0, 2.0), 1.5, z * -0.08),
        ("elbow", z * -0.18, y, (-2.3, 0.0), 0.8, z * -0.05),
        ("wrist_yaw", z * -0.12, z, (-2.0, 2.0), 0.6, z * -0.06),
        ("wrist_pitch", z * -0.13, y, (-1.2, 1.2), 0.2, DVec3::ZERO),
        ("wrist_roll", DVec3::ZERO, x, (-0.8, 0.8), 0.3, z * -0.07),
    ]
}

/// A box with its origin in the middle; `size` is its whole extent, metres.
///
/// Handles are in the middle: `top` (x down, all six rows) and `side` (x forward, free about z). Surfaces are `bottom`
/// and `top`.
#[must_use]
pub fn block(size: DVec3) -> Model {
    let half = size / 2.0;
    let mut model = Model { name: "block".into(), ..Model::default() };
    model.links = vec![link("base_link", vec![(Pose::identity(), solid_box(half))])];
    let down = Pose::from_rotation(DQuat::from_rotation_y(FRAC_PI_2));
    model.handles = vec![
        handle("top", "base_link", down, [true; 6]),
        handle("side", "base_link", Pose::identity(), [true, true, true, true, true, false]),
    ];
    model.surfaces = vec![
        rectangle("bottom", "base_link", -half.z, (half.x, half.y), false),
        rectangle("top", "base_link", half.z, (half.x, half.y), true),
    ];
    model
}

/// A box with a lid that turns about the x axis on its rear edge (0 to 2 rad): an articulated object. Handle `knob` is on
/// the lid, handle `side` on the box.
#[must_use]
pub fn box_with_lid(size: DVec3) -> Model {
    let half = size / 2.0;
    let mut model = Model { name: "box_with_lid".into(), ..block(size) };
    model.handles.retain(|h| h.name == "side");
    let plate = solid_box(DVec3::new(half.x, half.y, 0.005));
    model.links.push(link("lid", vec![(Pose::from_translation(DVec3::Y * half.y), plate)]));
    let hinge = Pose::from_translation(DVec3::new(0.0, -half.y, half.z + 0.006));
    let axis = DVec3::X;
    model.joints.push(JointModel { axis, ..revolute("hinge", 0, 1, hinge, (0.0, 2.0)) });
    let down = Pose::from_parts(DVec3::Y * size.y, DQuat::from_rotation_y(FRAC_PI_2));
    model.handles.push(handle("knob", "lid", down, [true; 6]));
    model
}

/// A cabinet with one drawer, which slides along −x from 0 to 0.3 m. Handle `knob` stands in front of it, x forward (all
/// six rows); surface `inside` is the drawer's floor.
#[must_use]
pub fn drawer() -> Model {
    let mut model = Model { name: "drawer".into(), ..Model::default() };
    let housing = (Pose::from_translation(DVec3::X * 0.35), solid_box(DVec3::new(0.02, 0.15, 0.1)));
    let floor = (Pose::from_translation(DVec3::Z * -0.06), solid_box(DVec3::new(0.15, 0.12, 0.005)));
    let front = (Pose::from_translation(DVec3::X * -0.15), solid_box(DVec3::new(0.005, 0.12, 0.06)));
    model.links = vec![link("base_link", vec![housing]), link("tray", vec![floor, front])];
    model.joints = vec![JointModel {
        kind: JointKind::Prismatic,
        axis: DVec3::NEG_X,
        limits: (0.0, 0.3),
        ..revolute("slide", 0, 1, Pose::identity(), (0.0, 0.0))
    }];
    let knob = Pose::from_translation(DVec3::X * -0.2);
    model.handles = vec![handle("knob", "tray", knob, [true; 6])];
    model.surfaces = vec![rectangle("inside", "tray", -0.055, (0.13, 0.1), true)];
    model
}

/// A table with its origin in the middle of its upper face; `size` is its whole extent, metres. Surface `top`.
#[must_use]
pub fn table(size: DVec3) -> Model {
    let half = size / 2.0;
    let mut model = Model { name: "table".into(), ..Model::default() };
    let slab = (Pose::from_translation(DVec3::Z * -half.z), solid_box(half));
    model.links = vec![link("base_link", vec![slab])];
    model.surfaces = vec![rectangle("top", "base_link", 0.0, (half.x, half.y), true)];
    model
}

fn link(name: &str, shapes: Vec<(Pose, Geometry)>) -> LinkModel {
    LinkModel { name: name.into(), shapes, inertial: None }
}

fn revolute(name: &str, parent: usize, child: usize, parent_from_joint: Pose, limits: (f64, f64)) -> JointModel {
    JointModel {
        name: name.into(),
        kind: JointKind::Revolute,
        parent,
        child,
        parent_from_joint,
        axis: DVec3::Z,
        limits,
        velocity_limit: Some(1.5),
        mimic: None,
    }
}

fn gripper(name: &str, link: &str, link_from_gripper: Pose, clearance: f64) -> GripperModel {
    GripperModel { name: name.into(), link: link.into(), link_from_gripper, clearance }
}

fn handle(name: &str, link: &str, link_from_handle: Pose, mask: [bool; 6]) -> HandleModel {
    HandleModel {
        name: name.into(),
        link: link.into(),
        link_from_handle,
        clearance: 0.03,
        mask,
        mask_complement: mask.map(|b| !b),
        approaching_direction: DVec3::X,
    }
}

/// A rectangle at height `z`, counter-clockwise seen from above where `up`, from below otherwise.
fn rectangle(name: &str, link: &str, z: f64, (x, y): (f64, f64), up: bool) -> SurfaceModel {
    let points = [(x, y), (-x, y), (-x, -y), (x, -y)].map(|(x, y)| DVec3::new(x, y, z)).to_vec();
    let polygon = if up { vec![0, 1, 2, 3] } else { vec![3, 2, 1, 0] };
    SurfaceModel { name: name.into(), link: link.into(), points, polygons: vec![polygon] }
}

fn capsule(radius: f64, half_length: f64) -> Geometry {
    Geometry::Capsule { radius, half_length }
}

fn solid_box(half_extents: DVec3) -> Geometry {
    Geometry::Box { half_extents }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::hybrid_robot::Robot;

    #[test]
    fn every_model_composes() {
        let size = DVec3::new(0.06, 0.08, 0.1);
        let (arm, two, hand) = (seven_axis_arm(), two_joint_arm(), two_finger_hand());
        let (block, lid, table) = (block(size), box_with_lid(size), table(DVec3::ONE));
        let robot = Robot::compose(&[
            (&arm, fixed_robot("arm", Pose::identity())),
            (&two, fixed_robot("two", Pose::identity())),
            (&hand, fixed_robot("hand", Pose::identity())),
            (&block, movable_object("block")),
            (&lid, movable_object("lid")),
            (&table, environment("table", Pose::identity())),
        ])
        .unwrap();
        assert_eq!((robot.space.size(), robot.space.dimension()), (7 + 2 + 1 + 7 + 8, 7 + 2 + 1 + 6 + 7));
        assert_eq!(robot.handles.len(), 4);
        assert_eq!(robot.surfaces.len(), 5);
    }
}
