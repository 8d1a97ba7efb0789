//! A random problem: parts, where everything starts, what is wanted, and what is to be kept.

use super::draw::{Draw, rounded};
use super::environment::Obstacle;
use super::model::{Model, Motion};
use super::objects::{Block, block, furniture, table};
use super::robot::{Robot, Root};
use foliate::components::Pose;
use foliate::components::pose::pose_to_array;
use glam::DVec3;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What a problem is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A robot moves among obstacles.
    Motion,
    /// The same while something about its tip holds all along.
    Kept,
    /// An arm, or two, carries what floats from one place to another.
    Carry,
    /// A hand from above sets blocks elsewhere on a table.
    Table,
    /// A hand from above opens or shuts a drawer or a door.
    Furniture,
}

/// A problem as files.
#[derive(Clone, Debug)]
pub struct RandomScene {
    pub kind: Kind,
    pub seed: u64,
    /// Which try of this seed: where things start and stand is drawn anew in each.
    pub attempt: u64,
    /// Name and content; `scene.toml` is the problem.
    pub files: Vec<(String, Vec<u8>)>,
    /// Coordinates of the start that the scene gives.
    pub start: BTreeMap<String, f64>,
    /// Coordinates of which the goal gives the value.
    pub goal: BTreeMap<String, f64>,
}

/// The height of tables, metres.
const HEIGHT: f64 = 0.5;

/// What is gathered of a scene while it is drawn.
#[derive(Default)]
pub(super) struct Draft {
    pub files: Vec<(String, Vec<u8>)>,
    pub parts: String,
    pub constraints: String,
    pub graph: String,
    pub locked: Vec<(String, String)>,
    pub start: BTreeMap<String, f64>,
    pub goal: BTreeMap<String, f64>,
    /// Lines of `[start]` besides single coordinates.
    pub poses: Vec<(String, String)>,
    pub goal_text: String,
    pub names: Vec<String>,
}

impl RandomScene {
    /// The problem of a seed. What exists is drawn from the seed alone, where it is from the attempt too.
    pub fn new(seed: u64, attempt: u64) -> Self {
        let mut what = Draw::new(seed, 1);
        let mut place = Draw::new(seed, 2 + attempt);
        let kind = match what.index(10) {
            0..=3 => Kind::Motion,
            4 => Kind::Kept,
            5 | 6 => Kind::Carry,
            7 | 8 => Kind::Table,
            _ => Kind::Furniture,
        };
        let mut draft = Draft::default();
        match kind {
            Kind::Motion => motion(&mut draft, &mut what, &mut place),
            Kind::Kept => super::kept::kept(&mut draft, &mut what, &mut place),
            Kind::Carry => carry(&mut draft, &mut what, &mut place),
            Kind::Table => on_table(&mut draft, &mut what, &mut place),
            Kind::Furniture => opens(&mut draft, &mut what, &mut place),
        }
        let text = draft.text(&format!("random-{seed}"), &mut what);
        let mut files = draft.files;
        files.push(("scene.toml".into(), text.into_bytes()));
        Self { kind, seed, attempt, files, start: draft.start, goal: draft.goal }
    }

    /// Writes all files into a folder; returns the scene's.
    pub fn write(&self, folder: &Path) -> std::io::Result<PathBuf> {
        std::fs::create_dir_all(folder)?;
        for (name, content) in &self.files {
            std::fs::write(folder.join(name), content)?;
        }
        Ok(folder.join("scene.toml"))
    }
}

impl Draft {
    pub fn model(&mut self, model: &Model) {
        let name = &model.name;
        self.files.push((format!("{name}.urdf"), model.urdf().into_bytes()));
        if let Some(text) = model.srdf_text() {
            self.files.push((format!("{name}.srdf"), text.into_bytes()));
        }
        self.files.extend(model.meshes.iter().cloned());
        self.names.push(name.clone());
    }

    /// The robot's part, with limits of the scene's own and pairs that it leaves out.
    pub fn robot(&mut self, what: &mut Draw, robot: &Robot) {
        self.model(&robot.model);
        let mut text = String::from("[[part]]\nname = \"robot\"\nkind = \"robot\"\nurdf = \"robot.urdf\"\n");
        if robot.model.srdf.is_some() {
            text += "srdf = \"robot.srdf\"\n";
        }
        match robot.root {
            Root::Fixed if what.chance(0.15) => text += "pose = { xyz = [0.02, -0.01, 0.03] }\n",
            Root::Fixed => {}
            Root::Planar => {
                text += "root = \"planar\"\nroot_bounds = [[-0.6, 0.6], [-0.6, 0.6]]\n";
            }
            Root::FreeFlyer => {
                text += "root = \"freeflyer\"\nroot_bounds = [[-0.6, 0.6], [-0.6, 0.6], [-0.2, 0.4]]\n";
            }
        }
        let pair = |draw: &mut Draw| {
            let mut name = || draw.of(&robot.model.links).name;
            (name(), name())
        };
        match what.index(10) {
            0 => text += "ignore = \"adjacent\"\n",
            1 if robot.disables() => text += "ignore = \"none\"\n",
            2 => {
                let (one, other) = pair(what);
                let word = if one == other { String::new() } else { format!(", [\"{one}\", \"{other}\"]") };
                text += &format!("ignore = [\"adjacent\"{word}]\n");
            }
            _ if robot.model.srdf.is_some() && !robot.disables() => text += "ignore = [\"adjacent\"]\n",
            _ => {}
        }
        if what.chance(0.1) {
            text += "mimic = \"free\"\n";
        }
        self.parts += &text;
    }

    pub fn obstacles(&mut self, what: &mut Draw, place: &mut Draw, most: usize, centre: DVec3, spread: f64) {
        for number in 0..what.index(most + 1) {
            let obstacle = Obstacle::near(place, &format!("wall{number}"), centre, spread);
            self.model(&obstacle.model);
            self.parts += &obstacle.toml();
        }
    }

    pub fn object(&mut self, model: &Model, bounds: [[f64; 2]; 3], place: &Pose) {
        let name = &model.name;
        self.model(model);
        self.parts += &format!(
            "[[part]]\nname = \"{name}\"\nkind = \"object\"\nurdf = \"{name}.urdf\"\nsrdf = \"{name}.srdf\"\n\
             root_bounds = {bounds:?}\n"
        );
        self.poses.push((name.clone(), format!("{:?}", pose_to_array(place))));
        self.start.extend(coordinates_of(name, place));
    }

    /// Everything about what is kept clear of what, and the whole text.
    fn text(&self, name: &str, what: &mut Draw) -> String {
        let mut text = format!("format = \"foliate.scene/1\"\nname = \"{name}\"\n");
        if what.chance(0.4) {
            text += &format!("default_margin = {}\n", what.of(&[0.002, 0.005, 0.01, 0.03]));
        }
        let mut margins = Vec::new();
        while what.chance(0.25) && margins.len() < 4 {
            let (one, other) = (what.of(&self.names), what.of(&self.names));
            if one != other {
                let distance = what.of(&[0.0, 0.004, 0.02]);
                margins.push(format!("{{ pair = [\"{one}\", \"{other}\"], distance = {distance} }}"));
            }
        }
        if !margins.is_empty() {
            let _infallible = writeln!(text, "margins = [{}]", margins.join(", "));
        }
        if what.chance(0.1) && self.names.len() > 2 {
            text += &format!("ignore = [[\"robot/base\", \"{}\"]]\n", self.names[1]);
        }
        text += &self.parts;
        text += &self.constraints;
        text += &format!("[graph]\n{}", self.graph);
        if !self.locked.is_empty() {
            text += "[locked]\n";
            for (joint, value) in &self.locked {
                let _infallible = writeln!(text, "\"{joint}\" = {value}");
            }
        }
        text += "[start]\n";
        for (joint, value) in self.start.iter().filter(|(joint, _)| !self.poses.iter().any(|(p, _)| of(joint, p))) {
            let _infallible = writeln!(text, "\"{joint}\" = {value:?}");
        }
        for (part, pose) in &self.poses {
            let _infallible = writeln!(text, "{part} = {pose}");
        }
        text + &format!("[[goal]]\n{}\n", self.goal_text)
    }

    /// Start and goal of the robot's joints; some are locked where they start, some have narrower limits.
    pub fn joints(&mut self, what: &mut Draw, start: &BTreeMap<String, f64>, goal: &mut BTreeMap<String, f64>) {
        for (joint, value) in start {
            let name = format!("robot/{joint}");
            if what.chance(0.08) && start.len() > 2 {
                let word = if what.chance(0.5) { "\"start\"".into() } else { format!("{value:?}") };
                self.locked.push((name.clone(), word));
                goal.insert(joint.clone(), *value);
            }
            self.start.insert(name, *value);
        }
    }
}

/// Whether a coordinate is one of a root that is written as a whole.
fn of(coordinate: &str, part: &str) -> bool {
    let axes = ["x", "y", "z", "qx", "qy", "qz", "qw", "theta"];
    coordinate.strip_prefix(part).and_then(|rest| rest.strip_prefix('/')).is_some_and(|axis| axes.contains(&axis))
}

pub(super) fn coordinates_of(part: &str, pose: &Pose) -> Vec<(String, f64)> {
    let names = ["x", "y", "z", "qx", "qy", "qz", "qw"];
    names.iter().zip(pose_to_array(pose)).map(|(axis, value)| (format!("{part}/{axis}"), value)).collect()
}

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
            let pose = super::model::Place { xyz: [x, y, z], rpy }.pose();
            Some((format!("{:?}", pose_to_array(&pose)), coordinates_of("robot", &pose)))
        }
    }
}

fn motion(draft: &mut Draft, what: &mut Draw, place: &mut Draw) {
    let robot = Robot::any(what);
    draft.robot(what, &robot);
    draft.obstacles(what, place, 5, DVec3::new(0.0, 0.0, 0.6), 0.8);
    let start = robot.model.random_values(place);
    let mut goal = robot.model.random_values(place);
    draft.joints(what, &start, &mut goal);
    let mut entries: Vec<String> = Vec::new();
    if let Some((text, list)) = root(place, robot.root) {
        draft.poses.push(("robot".into(), text));
        draft.start.extend(list);
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

/// Poses of all grippers at joint values, and where the leaders of fingers are.
fn hold(robot: &Robot, hand: usize, values: &BTreeMap<String, f64>) -> Pose {
    let hand = &robot.hands[hand];
    robot.model.poses(values)[hand.link] * hand.place.pose()
}

fn open_hands(robot: &Robot, draft: &mut Draft, what: &mut Draw, values: &mut BTreeMap<String, f64>) {
    for (leader, value) in robot.hands.iter().filter_map(|hand| hand.leader.clone()) {
        values.insert(leader.clone(), value);
        if what.chance(0.8) {
            draft.locked.push((format!("robot/{leader}"), format!("{value:?}")));
        }
    }
}

fn carry(draft: &mut Draft, what: &mut Draw, place: &mut Draw) {
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

fn on_table(draft: &mut Draft, what: &mut Draw, place: &mut Draw) {
    let robot = Robot::from_above(what);
    draft.robot(what, &robot);
    draft.model(&table(what, HEIGHT));
    draft.parts += "[[part]]\nname = \"table\"\nkind = \"environment\"\nurdf = \"table.urdf\"\nsrdf = \"table.srdf\"\n";
    draft.obstacles(what, place, 2, DVec3::new(0.0, 0.0, HEIGHT + 0.2), 0.35);
    let mut start = high_above(&robot, place);
    open_hands(&robot, draft, what, &mut start);
    draft.joints(what, &start, &mut BTreeMap::new());
    let margin = what.of(&[0.001, 0.001, 0.0005, 0.004]);
    let lift = what.of(&[0.05, 0.05, 0.0, 0.02]);
    draft.graph = format!("placement_margin = {margin}\npreplacement_distance = {lift}\n");
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
    super::model::Place { xyz: [x, y, z], rpy: [0.0, 0.0, yaw] }.pose()
}

fn opens(draft: &mut Draft, what: &mut Draw, place: &mut Draw) {
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
    draft.joints(what, &start, &mut BTreeMap::new());
    let (from, to) = (rounded(place.unit() * range), rounded(place.unit() * range));
    let joint = format!("cabinet/{joint}");
    draft.graph = format!("resting_joints = {{ \"{joint}\" = \"stays\" }}\n");
    draft.start.insert(joint.clone(), from);
    draft.goal.insert(joint.clone(), to);
    draft.goal_text = format!("coordinates = {{ \"{joint}\" = {to:?} }}");
}
