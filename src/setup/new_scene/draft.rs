//! What a layout writes.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::scene::assemble::parts::root_bounds;
use crate::scene::assemble::parts::shape;
use crate::setup::error::SetupError;
use crate::setup::grippers::{FoundGripper, coordinate, is_beyond};
use crate::setup::handles::distinct;
use crate::setup::new_scene::holding::Ways;
use crate::setup::new_scene::own_roots::of_kind;
use crate::setup::new_scene::read_objects::{Object, seen_from};
use crate::setup::new_scene::request::DRIVES;
use crate::setup::new_scene::setting::Setting;
use crate::setup::objects::RigidObject;
use crate::setup::places::layout::Layout;
use crate::setup::places::table::{Standing, TOP, TableSize, table_pose, table_solid};
use crate::setup::surfaces::level_faces;
use crate::setup::writing::numbers::number;
use crate::setup::writing::scene_text::{Draft, ObjectText, TableText};
use foliate_components::problem::PROJECTION_TOLERANCE;
use foliate_components::robot::model::JointKind;
use foliate_components::robot::{JointIndex, RootJoint, Source};
use glam::DVec3;

/// Largest residual of a grasp that searches reach as they are, metres and radians.
const EXACT: f64 = 0.5 * PROJECTION_TOLERANCE;

impl Setting<'_> {
    // Long: one field after the other.
    pub fn draft<'d>(
        &'d self,
        objects: &'d [Object],
        ways: &Ways,
        (standing, size): (&Standing, &TableSize),
        layout: &Layout,
        q: &[f64],
    ) -> Result<Draft<'d>, SetupError> {
        let drive = if self.drives() { DRIVES } else { 0.0 };
        let reach = root_bounds::reach(self.model) + 0.25 + drive;
        let root = DVec3::Z * standing.robot_height;
        let bound = |axis: usize| {
            let (low, high) = (root[axis] - reach, root[axis] + reach);
            ((low * 100.0).floor() / 100.0, (high * 100.0).ceil() / 100.0)
        };
        let table = RigidObject::of("table", &shape::model("table", &table_solid(size), self.packages)?)?;
        let X_WT = table_pose(standing);
        let object = |(at, object): (usize, &'d Object)| ObjectText {
            name: object.name.clone(),
            source: object.source.clone(),
            link: object.rigid.link.clone(),
            handles: distinct(&object.handles).into_iter().cloned().collect(),
            handles_from: match (&self.request.grasps, at) {
                (Some(file), 0) => format!("given by {}", file.display()),
                _ => format!("{} found", distinct(&object.handles).len()),
            },
            faces: &object.faces,
            ball: object.rigid.is_ball().then(|| -object.rigid.bounds.0.z),
            start: layout.starts[at].X_WO,
            root_bounds: [bound(0), bound(1), bound(2)],
        };
        let (gripper, handle) = &layout.grasp;
        Ok(Draft {
            name: self.request.place.file_stem().map_or("new".into(), |stem| stem.to_string_lossy().into_owned()),
            command: self.request.command.clone(),
            robot: self.robot,
            urdf: seen_from(&self.request.robot, &self.request.place),
            srdf: self.request.srdf.as_ref().map(|srdf| seen_from(srdf, &self.request.place)),
            robot_height: standing.robot_height,
            matrix: self.matrix,
            grippers: self.grippers,
            table: TableText {
                source: format!(
                    "shape = {{ box = [{}, {}, {}] }}",
                    number(size.sides.0),
                    number(size.sides.1),
                    number(TOP)
                ),
                pose: X_WT,
                faces: level_faces(&table, &X_WT),
                height: size.height,
                why: match self.request.table.place {
                    Some(_) => "as wanted",
                    None => "chosen: the hand gets above it most often here",
                },
            },
            objects: objects.iter().enumerate().map(object).collect(),
            grasps: ways.clone(),
            locked: self.locked(),
            q: q[self.root_size()..self.root_size() + self.robot.space.size()].to_vec(),
            drives: (self.root() == RootJoint::Planar).then_some(DRIVES),
            driving: of_kind(self.model, JointKind::Planar).map(str::to_owned).collect(),
            floating: of_kind(self.model, JointKind::Floating).map(str::to_owned).collect(),
            goal: layout.goal,
            inexact: Some(layout.residual).filter(|residual| *residual > EXACT),
            grasp: format!("`{}` by `{}`", handle, self.grippers[*gripper].name),
        })
    }

    /// Joints that move neither a gripper nor a finger.
    fn locked(&self) -> Vec<JointIndex> {
        let robot = self.robot;
        let body = |gripper: &FoundGripper| robot.links[gripper.link.at()].joint;
        let arms = self.arms(robot);
        let is_used = |joint: JointIndex| {
            arms.iter().any(|arm| arm.is_moved_by(joint))
                || self.grippers.iter().any(|gripper| {
                    body(gripper).is_some() && is_beyond(robot, Some(joint), body(gripper))
                        || gripper.fingers.iter().any(|finger| finger.joint == joint)
                })
        };
        let own = (0..robot.joints.len() as u32).map(JointIndex).filter(|&joint| coordinate(robot, joint).is_some());
        // A leader whose followers are used is used too.
        let follows = |joint: JointIndex| {
            (0..robot.joints.len() as u32).map(JointIndex).any(|other| {
                matches!(robot.joints[other.at()].source,
                    Source::Follows { leader, .. } if leader == joint)
                    && is_used(other)
            })
        };
        own.filter(|&joint| {
            !is_used(joint) && !follows(joint) && robot.joints[joint.at()].motion.configuration_size() == 1
        })
        .collect()
    }
}
