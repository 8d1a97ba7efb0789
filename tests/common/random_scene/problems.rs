//! What each kind of problem is made of.

use super::draw::{Draw, rounded};
use super::model::{Motion, Place};
use super::objects::{Block, block, furniture, table};
use super::robot::{Robot, Root};
use super::scene::{Draft, coordinates_of};
use foliate::components::Pose;
use foliate::components::pose::pose_to_array;
use glam::DVec3;
use std::collections::BTreeMap;

/// The height of tables, metres.
const HEIGHT: f64 = 0.5;

/// Where a root that moves stands: its text, and its coordinates.
fn root(place: &mut Draw, root: Root) -> Option<(String, Vec<(String, f64)>)> {
    let (x, y, z) = (place.range(-0.5, 0.5), place.range(-0.5, 0.5), place.range(-0.1, 0.3));
    match root {
        Root::Fixed => None,
        Root::Planar => {
            let theta = place.range(-1.5, 1.5);
            let list = [("x", x), ("y", y), ("theta", theta)].map(|(axis, value)| (format!("robot/{axis}"), value));
            Some((format!("[{x:?}, {y:?}, {theta:?}]"), list.to_vec()))
        }
        Root::FreeFlyer => {
            let rpy = [place.range(-1.0, 1.0), place.range(-1.0, 1.0), place.range(-3.0, 3.0)];
            let pose = Place { xyz: [x, y, z], rpy }.pose();
            Some((format!("{:?}", pose_to_array(&pose)), coordinates_of("robot", &pose)))
        }
    }
}

pub(super) fn motion(draft: &mut Draft, what: &mut Draw, place: &mut Draw) {
    let robot = Robot::any(what);
    draft.robot(what, &robot);
    draft.obstacles(what, place, 5, DVec3::new(0.0, 0.0, 0.6), 0.8);
    let start = robot.model.random_values(place);
    let mut goal = robot.model.random_values(place);
    draft.joints(what, &start, &mut goal, (0.08, 0.1));
    let mut entries: Vec<String> = Vec::new();
    if let Some((text, list)) = root(place, robot.root) {
        draft.poses.push(("robot".into(), text));
        draft.start.extend(list);
    }
    if what.chance(0.15) {
        twin(draft, what, place, &robot);
    }
    if what.chance(0.2) {
        let opening = what.range(0.05, 0.1);
        let thing = block(what, "thing", opening, false);
        let pose = Place { xyz: [place.range(-0.7, 0.7), place.range(-0.7, 0.7), 0.4], rpy: [0.3, 0.0, 0.2] }.pose();
        draft.object(&thing.model, [[-1.0, 1.0], [-1.0, 1.0], [0.0, 1.0]], &pose);
    }
    let whole = what.chance(0.6);
    if let (true, Some((text, list))) = (whole, root(place, robot.root)) {
        entries.push(format!("robot = {text}"));
        draft.goal.extend(list);
    }
    let few = what.index(3) + 1;
    for (joint, value) in goal.iter().take(if whole { usize::MAX } else { few }) {
        entries.push(format!("\"robot/{joint}\" = {value:?}"));
        draft.goal.insert(format!("robot/{joint}"), *value);
    }
    let word = if whole { "configuration" } else { "coordinates" };
    draft.goal_text = format!("{word} = {{ {} }}", entries.join(", "));
}

/// A second robot of the same files, which the goal does not name.
fn twin(draft: &mut Draft, what: &mut Draw, place: &mut Draw, robot: &Robot) {
    let srdf = if robot.model.srdf.is_some() { "srdf = \"robot.srdf\"\n" } else { "" };
    draft.parts += &format!(
        "[[part]]\nname = \"twin\"\nkind = \"robot\"\nurdf = \"robot.urdf\"\n{srdf}ignore = \"adjacent\"\n\
         pose = {{ xyz = [{}, {}, 0.0] }}\n",
        place.range(0.5, 0.9),
        place.range(-0.5, 0.5)
    );
    draft.names.push("twin".into());
    let locked = what.chance(0.3);
    for (joint, value) in robot.model.random_values(place) {
        if locked {
            draft.locked.insert(format!("twin/{joint}"), "\"start\"".into());
        }
        draft.start.insert(format!("twin/{joint}"), value);
    }
}

/// Poses of all grippers at joint values, and where the leaders of fingers are.
fn hold(robot: &Robot, hand: usize, values: &BTreeMap<String, f64>) -> Pose {
    let hand = &robot.hands[hand];
    robot.model.poses(values)[hand.link] * hand.place.pose()
}

fn open_hands(robot: &Robot, draft: &mut Draft, what: &mut Draw, values: &mut BTreeMap<String, f64>) {
    for (leader, value) in robot.hands.iter().filter_map(|hand| hand.leader.clone()) {
        values.insert(leader.clone(), value);
        if what.chance(0.8) {
            draft.locked.insert(format!("robot/{leader}"), format!("{value:?}"));
        }
    }
}

pub(super) fn carry(draft: &mut Draft, what: &mut Draw, place: &mut Draw) {
    let robot = Robot::with_hands(what);
    draft.robot(what, &robot);
    draft.obstacles(what, place, 2, DVec3::new(0.0, 0.0, 0.7), 0.8);
    let mut start = robot.model.random_values(place);
    open_hands(&robot, draft, what, &mut start);
    for (joint, value) in &start {
        draft.start.insert(format!("robot/{joint}"), *value);
    }
    let mut goals = Vec::new();
    for number in 0..1 + what.index(2).min(what.index(2)) {
        let hand = what.index(robot.hands.len());
        let name = format!("block{number}");
        let object = block(what, &name, robot.hands[hand].opening, false);
        let mut anywhere = || {
            let mut values = robot.model.random_values(place);
            for (leader, value) in robot.hands.iter().filter_map(|hand| hand.leader.clone()) {
                values.insert(leader, value);
            }
            hold(&robot, hand, &values)
        };
        let (from, to) = (anywhere(), anywhere());
        draft.object(&object.model, [[-2.0, 2.0], [-2.0, 2.0], [-1.0, 2.5]], &from);
        goals.push((name, to));
    }
    want_poses(draft, what, &goals);
}

/// The objects there, as a whole configuration or as far as they go.
fn want_poses(draft: &mut Draft, what: &mut Draw, goals: &[(String, Pose)]) {
    let entries: Vec<String> = goals.iter().map(|(name, to)| format!("{name} = {:?}", pose_to_array(to))).collect();
    let entries = entries.join(", ");
    draft.goal.extend(goals.iter().flat_map(|(name, to)| coordinates_of(name, to)));
    if what.chance(0.4) {
        draft.goal_text = format!("configuration = {{ {entries} }}");
        let rest: Vec<_> = draft.start.iter().filter(|(c, _)| c.starts_with("robot/")).collect();
        draft.goal.extend(rest.into_iter().map(|(c, v)| (c.clone(), *v)));
    } else {
        draft.goal_text = format!("objects = {{ {entries} }}");
    }
}

/// A gantry's joints somewhere high above things.
fn high_above(robot: &Robot, place: &mut Draw) -> BTreeMap<String, f64> {
    let mut values = robot.model.random_values(place);
    for joint in robot.model.leaders().filter(|j| j.motion == Motion::Prismatic && j.name == "slide_z") {
        values.insert(joint.name.clone(), place.range(0.0, 0.1));
    }
    values
}

pub(super) fn on_table(draft: &mut Draft, what: &mut Draw, place: &mut Draw) {
    let robot = Robot::from_above(what);
    draft.robot(what, &robot);
    draft.model(&table(what, HEIGHT));
    draft.parts += "[[part]]\nname = \"table\"\nkind = \"environment\"\nurdf = \"table.urdf\"\nsrdf = \"table.srdf\"\n";
    draft.obstacles(what, place, 2, DVec3::new(0.0, 0.0, HEIGHT + 0.2), 0.35);
    let mut start = high_above(&robot, place);
    open_hands(&robot, draft, what, &mut start);
    draft.joints(what, &start, &mut BTreeMap::new(), (0.02, 0.6));
    let margin = what.of(&[0.001, 0.001, 0.0005, 0.004]);
    let lift = what.of(&[0.05, 0.05, 0.0, 0.02]);
    draft.graph = format!("placement_margin = {margin}\npreplacement_distance = {lift}\n");
    if what.chance(0.3) {
        draft.graph += "supports = [\"table/plate\"]\n";
    }
    let turns = robot.model.leaders().any(|joint| joint.name == "yaw");
    let mut goals = Vec::new();
    for number in 0..1 + what.index(2) {
        let object = block(what, &format!("block{number}"), robot.hands[0].opening, true);
        let mut somewhere = || lying(place, &object, number, turns, margin);
        let (from, to) = (somewhere(), somewhere());
        draft.object(&object.model, [[-0.6, 0.6], [-0.6, 0.6], [0.3, 1.2]], &from);
        goals.push((object.model.name.clone(), to));
    }
    want_poses(draft, what, &goals);
}

/// A block on the table, on the half that is its own.
fn lying(place: &mut Draw, object: &Block, number: usize, turns: bool, margin: f64) -> Pose {
    let side = if number == 0 { 1.0 } else { -1.0 };
    let (x, y) = (place.range(-0.28, 0.28), side * place.range(0.06, 0.28));
    let yaw = if turns || object.turns { place.range(-0.7, 0.7) } else { 0.0 };
    let z = HEIGHT + margin + object.height / 2.0;
    Place { xyz: [x, y, z], rpy: [0.0, 0.0, yaw] }.pose()
}

pub(super) fn opens(draft: &mut Draft, what: &mut Draw, place: &mut Draw) {
    let robot = Robot::from_above(what);
    draft.robot(what, &robot);
    let (cabinet, range) = furniture(what, HEIGHT);
    draft.model(&cabinet);
    let joint = cabinet.last_joint_name();
    let neighbours = if what.chance(0.5) { "ignore = \"adjacent\"\n" } else { "ignore = [[\"shell\", \"LINK\"]]\n" };
    draft.parts += "[[part]]\nname = \"cabinet\"\nkind = \"object\"\nroot = \"fixed\"\nurdf = \"cabinet.urdf\"\n\
                    srdf = \"cabinet.srdf\"\npose = { xyz = [0.05, 0.0, 0.0] }\n";
    draft.parts += &neighbours.replace("LINK", &format!("{joint}_link"));
    draft.obstacles(what, place, 2, DVec3::new(-0.1, 0.0, HEIGHT + 0.2), 0.4);
    let mut start = high_above(&robot, place);
    open_hands(&robot, draft, what, &mut start);
    draft.joints(what, &start, &mut BTreeMap::new(), (0.02, 0.6));
    let (from, to) = (rounded(place.unit() * range), rounded(place.unit() * range));
    let joint = format!("cabinet/{joint}");
    draft.graph = format!("resting_joints = {{ \"{joint}\" = \"stays\" }}\n");
    draft.start.insert(joint.clone(), from);
    draft.goal.insert(joint.clone(), to);
    draft.goal_text = format!("coordinates = {{ \"{joint}\" = {to:?} }}");
}
