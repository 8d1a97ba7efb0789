//! Ways to make a good path wrong, each with the proof that it is.
#![allow(non_snake_case, reason = "pose names carry their frames")]

mod knots;

use crate::every_answer::dense::{Places, in_world};
use crate::every_answer::posts;
use crate::every_answer::solve::Answer;
use crate::random_scene::draw::Draw;
use crate::random_scene::{Kind as Problem, RandomScene};
use foliate::check::Kind;
use foliate::components::Pose;
use foliate::components::pose::pose_to_array;
use foliate::kernels::collision::{DistanceQuery, Solid, clearance};
use foliate::kernels::kinematics::Kinematics;
use foliate::path_file::{PartEntry, PathFile};
use glam::DVec3;
use knots::{collides, columns, inserted, joints, shift, through};
use std::path::Path;

pub use knots::without_times;

/// A wrong path, what was done to it, and what a check has to find.
pub struct Spoiled {
    pub file: PathFile,
    pub how: String,
    pub kinds: &'static [Kind],
    /// Whether it is compared with its models alone: the scene would refuse it for other reasons.
    pub alone: bool,
}

type Spoiler = fn(&mut Draw, &RandomScene, &Answer, &Path) -> Option<Spoiled>;

/// All ways, by name. One that has nothing to spoil, or cannot show that it did, gives nothing.
pub const SPOILERS: [(&str, Spoiler); 7] = [
    ("a joint a micrometre beyond its limit", beyond),
    ("a detour through something", detour),
    ("an object that no gripper holds moves", adrift),
    ("an object slips in the hand", slipped),
    ("a claim above what there is", claimed),
    ("a thin post where something passes", post),
    ("a constraint is left between its ends", left),
];

const COLLIDES: &[Kind] = &[Kind::Collision, Kind::Margin, Kind::Enclosed];

fn beyond(draw: &mut Draw, _: &RandomScene, answer: &Answer, _: &Path) -> Option<Spoiled> {
    let joints = joints(answer);
    let (column, [low, high]) = *joints.get(draw.index(joints.len()))?;
    let mut file = answer.file.clone();
    let segment = draw.index(file.segments.len());
    let value = if draw.chance(0.5) { high + 1e-6 } else { low - 1e-6 };
    let mut knot = knots::middle(answer, segment, draw);
    knot[column] = value;
    let how = format!("{} is {value} in segment {segment}", file.coordinates[column]);
    inserted(&mut file, segment, knot);
    Some(Spoiled { file, how, kinds: &[Kind::Limit], alone: false })
}

/// Joints go somewhere and come back, where nothing is held.
fn detour(draw: &mut Draw, scene: &RandomScene, answer: &Answer, _: &Path) -> Option<Spoiled> {
    if scene.kind == Problem::Kept {
        return None;
    }
    let segment = draw.index(answer.file.segments.len());
    if answer.file.segments[segment].attachments.iter().any(|a| a.gripper.is_some()) {
        return None;
    }
    for _ in 0..20 {
        let mut knot = knots::middle(answer, segment, draw);
        for (column, [low, high]) in joints(answer) {
            knot[column] = low + (high - low) * draw.unit();
        }
        if let Some(pair) = collides(answer, segment, &knot) {
            let mut file = answer.file.clone();
            inserted(&mut file, segment, knot);
            let how = format!("{pair} meet on a detour in segment {segment}");
            return Some(Spoiled { file, how, kinds: COLLIDES, alone: false });
        }
    }
    None
}

fn adrift(draw: &mut Draw, scene: &RandomScene, answer: &Answer, _: &Path) -> Option<Spoiled> {
    let names = scene.start.keys().filter_map(|name| name.strip_suffix("/qw")).filter(|part| *part != "robot");
    let part = names.into_iter().next()?;
    let segment = draw.index(answer.file.segments.len());
    let holds = |a: &foliate::path_file::AttachmentEntry| a.object == part && a.gripper.is_some();
    if answer.file.segments[segment].attachments.iter().any(holds) {
        return None;
    }
    let mut file = answer.file.clone();
    let column = columns(&file, &format!("{part}/{}", draw.of(&["x", "y", "z"])))?;
    let by = draw.sign() * draw.range(3e-5, 1e-3);
    shift(&mut file, segment, 1, column, by);
    let kinds = &[Kind::PlacedObjectMoved, Kind::UnattachedObjectMoved, Kind::ObjectOffCarrier, Kind::Drift];
    Some(Spoiled { file, how: format!("{part} moves by {by} in segment {segment}"), kinds, alone: false })
}

fn slipped(draw: &mut Draw, _: &RandomScene, answer: &Answer, _: &Path) -> Option<Spoiled> {
    let carried = |segment: &foliate::path_file::SegmentEntry| {
        let grasp = segment.attachments.iter().find(|a| a.gripper.is_some() && a.carrier);
        grasp.map(|a| a.object.clone())
    };
    let all: Vec<(usize, String)> =
        answer.file.segments.iter().enumerate().filter_map(|(i, s)| Some((i, carried(s)?))).collect();
    let (segment, part) = all.get(draw.index(all.len()))?.clone();
    let mut file = answer.file.clone();
    let column = columns(&file, &format!("{part}/{}", draw.of(&["x", "y", "z"])))?;
    let by = draw.sign() * draw.range(3e-4, 1e-3);
    shift(&mut file, segment, 1, column, by);
    let how = format!("{part} slips by {by} in segment {segment}");
    Some(Spoiled { file, how, kinds: &[Kind::ObjectOffCarrier], alone: false })
}

fn claimed(_: &mut Draw, _: &RandomScene, answer: &Answer, _: &Path) -> Option<Spoiled> {
    let least = through(answer)?;
    let mut file = answer.file.clone();
    // A check proves a claim to within a tenth, or a tenth of a millimetre.
    let claim = (least + 2e-4).max(1.12 * least);
    file.certificate.min_clearance = Some(claim);
    let how = format!("{claim} is claimed where {least} is seen");
    Some(Spoiled { file, how, kinds: &[Kind::Certificate], alone: false })
}

fn post(draw: &mut Draw, _: &RandomScene, answer: &Answer, folder: &Path) -> Option<Spoiled> {
    let post = posts::beside(draw, answer, 1, -0.004).into_iter().next()?;
    let how = format!("{} passes a post at {:?}", meets(answer, &post)?, post.pose.translation);
    std::fs::write(folder.join("post.urdf"), post.urdf()).expect("a post");
    let mut file = answer.file.clone();
    file.parts.push(PartEntry {
        name: "post".into(),
        kind: "environment".into(),
        urdf: "post.urdf".into(),
        srdf: None,
        mimic: "follow".into(),
        root: "fixed".into(),
        world_from_root: pose_to_array(&post.pose),
        mesh_up_axis: None,
        sha256: std::collections::BTreeMap::new(),
    });
    Some(Spoiled { file, how, kinds: COLLIDES, alone: true })
}

/// What of the bodies meets a post somewhere between the knots.
fn meets(answer: &Answer, post: &posts::Post) -> Option<String> {
    let robot = &answer.model.problem.robot;
    let kinematics = Kinematics::new(robot);
    let solids: Vec<Solid> = robot.shapes.iter().map(|shape| Solid::of(&shape.geometry)).collect();
    let ask = DistanceQuery { needed: 1e-4, floor: 1e-4, ground: 1e-4, absolute: 1e-9, relative: 0.0 };
    for segment in &answer.path.segments {
        let places = Places::new(robot, &kinematics, segment);
        for ends in segment.knots.windows(2) {
            for step in 0..=200 {
                let X_WJ: Vec<Pose> = places.at(&ends[0], &ends[1], f64::from(step) / 200.0);
                let hit = (0..solids.len()).find(|&shape| {
                    let place = in_world(robot, shape, &X_WJ);
                    clearance(&post.solid(), &post.pose, &solids[shape], &place, ask, &mut DVec3::ZERO.clone()) <= 0.0
                });
                if let Some(shape) = hit {
                    return Some(robot.shapes[shape].name.clone());
                }
            }
        }
    }
    None
}

/// A joint goes aside where the tip has to keep its height, or its distance from the base.
fn left(draw: &mut Draw, scene: &RandomScene, answer: &Answer, _: &Path) -> Option<Spoiled> {
    let (_, text) = scene.files.iter().find(|(name, _)| name == "scene.toml")?;
    let text = String::from_utf8_lossy(text);
    let always = text.split("name = \"always\"").nth(1)?;
    let frame = always.split('"').nth(1)?;
    let height = always.lines().take(5).any(|line| line == "mask = [0, 0, 1, 0, 0, 0]");
    if !height && !always.lines().take(5).any(|line| line == "length = \"start\"") {
        return None;
    }
    let robot = &answer.model.problem.robot;
    let kinematics = Kinematics::new(robot);
    let measured = |q: &[f64]| {
        let mut X_WJ = vec![Pose::IDENTITY; kinematics.bodies()];
        kinematics.forward(q, &mut X_WJ);
        let place = |link: &str| {
            let link = &robot.links[robot.link(link).expect("a link").at()];
            link.joint.map_or(link.joint_from_link, |joint| X_WJ[joint.at()] * link.joint_from_link).translation
        };
        let tip = place(frame);
        if height { tip.z } else { (tip - place("robot/base")).length() }
    };
    let segment = draw.index(answer.file.segments.len());
    let mut knot = knots::middle(answer, segment, draw);
    let before = measured(&knots::configuration(answer, &knot));
    let all = joints(answer);
    let (column, _) = *all.get(draw.index(all.len()))?;
    knot[column] += draw.sign() * draw.range(0.01, 0.1);
    let off = measured(&knots::configuration(answer, &knot)) - before;
    if off.abs() < 2e-3 {
        return None;
    }
    let mut file = answer.file.clone();
    inserted(&mut file, segment, knot);
    let how = format!("{frame} is {off} m off in segment {segment}");
    Some(Spoiled { file, how, kinds: &[Kind::Constraint], alone: false })
}
