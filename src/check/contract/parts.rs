//! The file's parts are the scene's, and the models that it names are as the scene has them: joints, links, shapes, masses.

use crate::check::contract::scene_contract::{Contract, differs};
use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::kind::Kind;
use crate::check::world::models::{Body, Part as FilePart, Value, World};
use crate::path_file::document::{PartEntry, PathFile};
use foliate_components::Pose;
use foliate_components::pose::pose_from_array;
use foliate_components::robot::shape::Geometry;
use foliate_components::robot::{JointIndex, Part, PartKind, RootJoint, Source};
use glam::DVec3;
use std::collections::HashSet;
use std::sync::Arc;

/// How far poses may differ that are read from the same numbers, metres and quaternion entries.
const SAME: f64 = 1e-9;

pub(super) fn same_pose(a: &Pose, b: &Pose) -> bool {
    let sign = if a.rotation.dot(b.rotation) < 0.0 { -1.0 } else { 1.0 };
    let turned = (a.rotation - b.rotation * sign).length();
    (a.translation - b.translation).abs().max_element() <= SAME && turned <= SAME
}

fn same_vector(a: DVec3, b: DVec3) -> bool {
    (a - b).abs().max_element() <= SAME
}

impl Contract<'_> {
    pub(super) fn parts(&self, file: &PathFile, world: &World, report: &mut CheckReport) {
        let robot = &self.problem.robot;
        for entry in &file.parts {
            if robot.part(&entry.name).is_none() {
                differs(report, format!("the scene has no part `{}`", shown(&entry.name)));
            }
        }
        for (number, part) in robot.parts.iter().enumerate() {
            let found = file.parts.iter().position(|entry| entry.name == part.name);
            let Some(index) = found else {
                differs(report, format!("part `{}` of the scene is not in the file", part.name));
                continue;
            };
            self.entry(number, part, &file.parts[index], report);
            self.model(part, &world.parts[index], file, world, report);
        }
        let pair = |a: &str, b: &str| crate::check::world::models::ordered(a, b);
        let name = |link: foliate_components::robot::LinkIndex| robot.links[link.at()].name.as_str();
        let disabled: HashSet<_> = robot.disabled_pairs.iter().map(|p| pair(name(p.first), name(p.second))).collect();
        if disabled != world.disabled {
            differs(report, "the SRDFs of the file disable other pairs than the scene's");
        }
    }

    fn entry(&self, number: usize, part: &Part, entry: &PartEntry, report: &mut CheckReport) {
        let name = &part.name;
        let mut same = |key: &str, found: &str, wanted: &str| {
            if found != wanted {
                differs(report, format!("part `{name}`: {key} is `{}`, in the scene `{wanted}`", shown(found)));
            }
        };
        let kind = match part.kind {
            PartKind::Robot => "robot",
            PartKind::Object => "object",
            PartKind::Environment => "environment",
        };
        let root = match part.root {
            RootJoint::Fixed => "fixed",
            RootJoint::FreeFlyer => "freeflyer",
            RootJoint::Planar => "planar",
        };
        same("kind", &entry.kind, kind);
        same("root", &entry.root, root);
        same("mimic", &entry.mimic, if part.mimic_follows { "follow" } else { "free" });
        if let Some(source) = self.scene.and_then(|scene| scene.parts.get(number)) {
            let as_written = crate::scene::mesh::formats::triangles::UpAxis::AsWritten.word();
            same("mesh_up_axis", entry.mesh_up_axis.as_deref().unwrap_or(as_written), source.mesh_up_axis.word());
        }
        let pose = pose_from_array(entry.world_from_root);
        if !pose.is_some_and(|pose| same_pose(&pose, &part.world_from_root)) {
            differs(report, format!("part `{name}`: world_from_root is not the scene's"));
        }
        let Some(source) = self.scene.and_then(|scene| scene.parts.get(number)) else { return };
        if entry.srdf.as_deref().is_some_and(|name| !name.is_empty()) != source.srdf.is_some() {
            let (said, wanted) = (entry.srdf.is_some(), source.srdf.is_some());
            differs(report, format!("part `{name}`: an SRDF is named: {said}, in the scene: {wanted}"));
        }
        for (what, sum) in &source.sha256 {
            if entry.sha256.get(what).is_some_and(|said| !said.eq_ignore_ascii_case(sum)) {
                let subject =
                    format!("part `{name}`: the scene's `{what}` is not the one that the path was planned with");
                report.violate(Place::FILE, Kind::Model, subject, None, None);
            }
        }
    }

    fn model(&self, part: &Part, read: &FilePart, file: &PathFile, world: &World, report: &mut CheckReport) {
        let mut wrong = Vec::new();
        self.links(part, read, &mut wrong);
        if part.kind != PartKind::Environment {
            self.joints(part, read, world, &mut wrong);
        }
        self.shapes(part, file, world, &mut wrong);
        for what in wrong.into_iter().take(20) {
            let subject = format!("the models of part `{}` are not the scene's: {what}", part.name);
            report.violate(Place::FILE, Kind::Model, subject, None, None);
        }
    }

    fn links(&self, part: &Part, read: &FilePart, wrong: &mut Vec<String>) {
        let links = &self.problem.robot.links[part.links.clone()];
        let known: Vec<&str> = read.model.links.iter().map(|link| link.name.as_str()).collect();
        for link in links {
            let local = link.name.split_once('/').map_or("", |(_, local)| local);
            let Some(index) = known.iter().position(|name| *name == local) else {
                wrong.push(format!("link `{local}` is missing"));
                continue;
            };
            let same = match (&read.model.links[index].inertial, &link.inertial) {
                (None, None) => true,
                (Some(a), Some(b)) => (a.mass - b.mass).abs() <= SAME && same_vector(a.center, b.center),
                _ => false,
            };
            if !same {
                wrong.push(format!("link `{local}` has another mass"));
            }
        }
        if links.len() != known.len() {
            wrong.push(format!("there are {} links, in the scene {}", known.len(), links.len()));
        }
    }

    fn joints(&self, part: &Part, read: &FilePart, world: &World, wrong: &mut Vec<String>) {
        let robot = &self.problem.robot;
        let bodies = &world.bodies[read.bodies.clone()];
        let joints = &robot.joints[part.joints.clone()];
        if bodies.len() != joints.len() {
            wrong.push(format!("{} joints move, in the scene {}", bodies.len(), joints.len()));
        }
        let named = |joint: Option<JointIndex>| joint.map(|j| robot.joints[j.at()].name.as_str());
        for joint in joints {
            let Some(body) = bodies.iter().find(|body| body.name == joint.name) else {
                wrong.push(format!("joint `{}` is missing", joint.name));
                continue;
            };
            let parent = body.parent.map(|b| world.bodies[b].name.as_str());
            let same = parent == named(joint.parent)
                && same_pose(&body.parent_from_joint, &joint.parent_from_joint)
                && body.motion == joint.motion
                && same_source(body, world, &joint.source, &named);
            if !same {
                wrong.push(format!("joint `{}` is another one", joint.name));
            }
        }
    }

    fn shapes(&self, part: &Part, file: &PathFile, world: &World, wrong: &mut Vec<String>) {
        let robot = &self.problem.robot;
        let scenes = robot.shapes.iter().filter(|shape| part.links.contains(&shape.link.at()));
        let mine = world.shapes.iter().filter(|shape| shape.link.split_once('/').is_some_and(|(p, _)| p == part.name));
        // An environment's joints are no joints of the problem: its shapes are compared where they stand.
        let still = part.kind == PartKind::Environment;
        let stands = |body: Option<usize>| {
            if still { standing(world, body, &file.segments[0].knots[0]) } else { Pose::identity() }
        };
        let (scenes, mine): (Vec<_>, Vec<_>) = (scenes.collect(), mine.collect());
        if scenes.len() != mine.len() {
            wrong.push(format!("there are {} collision shapes, in the scene {}", mine.len(), scenes.len()));
            return;
        }
        for (theirs, ours) in scenes.into_iter().zip(mine) {
            let link = &robot.links[theirs.link.at()].name;
            let same = *link == ours.link
                && same_pose(&(stands(ours.rigid.1) * ours.body_from_shape), &theirs.joint_from_shape)
                && same_geometry(&ours.geometry, &theirs.geometry);
            if !same {
                wrong.push(format!("a collision shape of `{}` is another one, or elsewhere", shown(&ours.link)));
            }
        }
    }
}

fn same_source<'n>(
    body: &Body,
    world: &World,
    source: &Source,
    named: &impl Fn(Option<JointIndex>) -> Option<&'n str>,
) -> bool {
    match (&body.value, source) {
        (Value::Columns(_), Source::Coordinates { .. }) => true,
        (
            Value::Follows { leader, multiplier, offset },
            Source::Follows { leader: theirs, multiplier: m, offset: o },
        ) => Some(world.bodies[*leader].name.as_str()) == named(Some(*theirs)) && multiplier == m && offset == o,
        _ => false,
    }
}

/// The pose in the world of a body of an environment where the knot has its joints.
fn standing(world: &World, body: Option<usize>, knot: &[f64]) -> Pose {
    let mut pose = Pose::identity();
    let mut next = body;
    while let Some(at) = next {
        let body = &world.bodies[at];
        pose = body.parent_from_joint * body.moved_at(world, at, knot) * pose;
        next = body.parent;
    }
    pose
}

fn same_geometry(a: &Geometry, b: &Geometry) -> bool {
    match (a, b) {
        (Geometry::Sphere { radius: a }, Geometry::Sphere { radius: b }) => a == b,
        (Geometry::Box { half_extents: a }, Geometry::Box { half_extents: b }) => a == b,
        (Geometry::Cylinder { radius: a, half_length: c }, Geometry::Cylinder { radius: b, half_length: d })
        | (Geometry::Capsule { radius: a, half_length: c }, Geometry::Capsule { radius: b, half_length: d }) => {
            a == b && c == d
        }
        (Geometry::Mesh(a), Geometry::Mesh(b)) => {
            let same = || a.vertices == b.vertices && a.triangles == b.triangles && a.closed == b.closed;
            Arc::ptr_eq(a, b) || same()
        }
        _ => false,
    }
}
