//! A random problem: parts, where everything starts, what is wanted, and what is to be kept.

use super::draw::Draw;
use super::environment::Obstacle;
use super::model::Model;
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

/// Leader, multiplier, offset.
type Mimic = (String, f64, f64);

/// What is gathered of a scene while it is drawn.
#[derive(Default)]
pub(super) struct Draft {
    pub files: Vec<(String, Vec<u8>)>,
    /// The robot's table, as far as it is known, and those of what comes after it.
    pub robot: String,
    pub parts: String,
    pub constraints: String,
    pub graph: String,
    pub locked: BTreeMap<String, String>,
    pub start: BTreeMap<String, f64>,
    pub goal: BTreeMap<String, f64>,
    /// Lines of `[start]` besides single coordinates.
    pub poses: Vec<(String, String)>,
    pub goal_text: String,
    pub names: Vec<String>,
    /// Limits of the scene's own: joint of the robot, lower, upper.
    pub bounds: Vec<(String, f64, f64)>,
    /// Joints of the robot that would follow, but are free: they start where they would be.
    pub free: Vec<(String, Mimic)>,
    /// Tables of parts that come before the robot's.
    pub before: String,
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
            Kind::Motion => super::problems::motion(&mut draft, &mut what, &mut place),
            Kind::Kept => super::kept::kept(&mut draft, &mut what, &mut place),
            Kind::Carry => super::problems::carry(&mut draft, &mut what, &mut place),
            Kind::Table => super::problems::on_table(&mut draft, &mut what, &mut place),
            Kind::Furniture => super::problems::opens(&mut draft, &mut what, &mut place),
        }
        for (joint, (leader, factor, offset)) in std::mem::take(&mut draft.free) {
            let value = draft.start.get(&format!("robot/{leader}")).copied().unwrap_or_default();
            draft.start.insert(format!("robot/{joint}"), factor * value + offset);
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
            let follower = |joint: &super::model::Joint| Some((joint.name.clone(), joint.mimic.clone()?));
            self.free = robot.model.joints.iter().filter_map(follower).collect();
        }
        self.robot = text;
    }

    pub fn obstacles(&mut self, what: &mut Draw, place: &mut Draw, most: usize, centre: DVec3, spread: f64) {
        for number in 0..what.index(most + 1) {
            let obstacle = Obstacle::near(place, &format!("wall{number}"), centre, spread);
            self.model(&obstacle.model);
            // Numbers of parts, links and joints depend on who comes first.
            let tables = if what.chance(0.3) { &mut self.before } else { &mut self.parts };
            *tables += &obstacle.toml();
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
        text += &self.before;
        text += &self.robot;
        if !self.bounds.is_empty() {
            let entry = |(joint, low, high): &(String, f64, f64)| format!("{joint} = [{low:?}, {high:?}]");
            let entries: Vec<String> = self.bounds.iter().map(entry).collect();
            let _infallible = writeln!(text, "joint_bounds = {{ {} }}", entries.join(", "));
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

    /// Start and goal of the robot's joints; some are locked where they start, some have limits
    /// of the scene's own with that much room.
    pub fn joints(
        &mut self,
        what: &mut Draw,
        start: &BTreeMap<String, f64>,
        goal: &mut BTreeMap<String, f64>,
        (chance, room): (f64, f64),
    ) {
        for (joint, value) in start {
            let name = format!("robot/{joint}");
            if what.chance(chance) && start.len() > 2 {
                let word = if what.chance(0.5) { "\"start\"".into() } else { format!("{value:?}") };
                self.locked.insert(name.clone(), word);
                goal.insert(joint.clone(), *value);
            }
            let other = goal.get(joint).copied().unwrap_or(*value);
            if what.chance(0.08) {
                self.bounds.push((joint.clone(), value.min(other) - room, value.max(other) + 2.0 * room));
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
