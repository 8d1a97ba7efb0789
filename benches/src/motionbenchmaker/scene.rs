//! A problem as a scene: the robot with its published meshes, and all obstacles as one link of one part that never moves.

use crate::motionbenchmaker::file::{Obstacle, ProblemRecord, Shape};
use foliate::scene::{PackagePath, SceneError, UpAxis, coordinate_names, read_model};
use foliate_components::robot::Robot;
use glam::{DQuat, EulerRot};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Name of the part that the robot is.
pub const PART: &str = "robot";

/// How far a planned joint may be beyond its bounds so that it is moved onto them, radians or metres: files and descriptions round bounds
/// in different ways.
pub const ROUNDED: f64 = 5e-3;

/// A robot's description.
#[derive(Clone, Debug)]
pub struct RobotFiles {
    /// Path or `package://` URL of the URDF.
    pub urdf: String,
    /// Of the SRDF, for the pairs of links that are not tested.
    pub srdf: Option<String>,
}

impl RobotFiles {
    /// Those that are used where nothing else is said: the Panda's of `example-robot-data`.
    #[must_use]
    pub fn known(robot: &str) -> Option<Self> {
        let panda = "package://example-robot-data/robots/panda_description";
        (robot == "panda")
            .then(|| Self { urdf: format!("{panda}/urdf/panda.urdf"), srdf: Some(format!("{panda}/srdf/panda.srdf")) })
    }
}

/// Makes scenes of problems of one robot.
#[derive(Debug)]
pub struct SceneWriter {
    files: RobotFiles,
    /// Names and bounds of the robot's coordinates.
    coordinates: Vec<(String, f64, f64)>,
}

/// A scene that was written.
#[derive(Clone, Debug)]
pub struct WrittenScene {
    /// The scene file.
    pub path: PathBuf,
    /// Joints of `start` that are no coordinates of the robot: they are fixed in its description, or follow another joint.
    pub left_out: Vec<String>,
    /// Joints whose value was moved onto a bound, with the value of the file.
    pub moved: Vec<(String, f64)>,
}

impl SceneWriter {
    /// Reads the robot.
    ///
    /// # Errors
    /// The model cannot be read.
    pub fn new(files: RobotFiles, packages: &PackagePath) -> Result<Self, SceneError> {
        let mut model = read_model(&files.urdf, files.srdf.as_deref(), UpAxis::default(), packages)?;
        let robot = model.compose_as(PART)?;
        Ok(Self { files, coordinates: coordinates(&robot) })
    }

    /// Writes the scene of a problem, `NAME.toml` and `NAME.urdf`.
    ///
    /// Joints of the goal are planned. All others are locked at the start's value, or at the bound that is nearest to it: MotionBenchMaker
    /// opens the Panda's fingers wider than its description allows.
    ///
    /// # Errors
    /// The goal has a joint that the robot has not, or a file cannot be written.
    pub fn write(&self, problem: &ProblemRecord, name: &str, folder: &Path) -> Result<WrittenScene, String> {
        let known = |joint: &str| self.coordinates.iter().any(|(name, ..)| name == joint);
        if let Some(joint) = problem.goal.keys().find(|joint| !known(joint)) {
            let names: Vec<&str> = self.coordinates.iter().map(|(name, ..)| name.as_str()).collect();
            let joint = joint.escape_debug();
            return Err(format!("{name}: the robot has no joint `{joint}`; it has {}", names.join(", ")));
        }
        let left_out = problem.start.keys().filter(|joint| !known(joint)).cloned().collect();
        let mut moved = Vec::new();
        let mut text = format!(
            "format = \"foliate.scene/1\"\nname = {}\n\n[[part]]\nname = \"{PART}\"\nkind = \"robot\"\nurdf = {}\n",
            quoted(name),
            quoted(&self.files.urdf)
        );
        if let Some(srdf) = &self.files.srdf {
            text += &format!("srdf = {}\n", quoted(srdf));
        }
        if !problem.obstacles.is_empty() {
            text += &format!(
                "\n[[part]]\nname = \"obstacles\"\nkind = \"environment\"\nurdf = {}\n",
                quoted(&format!("{name}.urdf"))
            );
        }
        let locked = self.coordinates.iter().filter(|(name, ..)| !problem.goal.contains_key(name));
        text += "\n[locked]\n";
        for coordinate in locked {
            match problem.start.get(&coordinate.0) {
                Some(&value) => text += &line(coordinate, within(coordinate, value, f64::INFINITY, &mut moved)),
                None => text += &format!("{} = \"start\"\n", quoted(&format!("{PART}/{}", coordinate.0))),
            }
        }
        for (title, values) in [("\n[start]\n", &problem.start), ("\n[[goal]]\n[goal.configuration]\n", &problem.goal)]
        {
            text += title;
            text += &self.planned(problem, values, &mut moved);
        }
        let path = folder.join(format!("{name}.toml"));
        let write = |path: &Path, text: String| {
            std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
        };
        write(&path, text)?;
        if !problem.obstacles.is_empty() {
            write(&folder.join(format!("{name}.urdf")), urdf(&problem.obstacles))?;
        }
        Ok(WrittenScene { path, left_out, moved })
    }

    /// Lines of the joints that are planned.
    fn planned(
        &self,
        problem: &ProblemRecord,
        values: &BTreeMap<String, f64>,
        moved: &mut Vec<(String, f64)>,
    ) -> String {
        let planned = self.coordinates.iter().filter(|(name, ..)| problem.goal.contains_key(name));
        let lines = planned.filter_map(|coordinate| {
            let value = *values.get(&coordinate.0)?;
            Some(line(coordinate, within(coordinate, value, ROUNDED, moved)))
        });
        lines.collect()
    }
}

fn coordinates(robot: &Robot) -> Vec<(String, f64, f64)> {
    let prefix = format!("{PART}/");
    let names = coordinate_names(robot).into_iter();
    let names = names.map(|name| name.strip_prefix(&prefix).map_or_else(|| name.clone(), str::to_owned));
    names.zip(robot.space.lower.iter().zip(&robot.space.upper)).map(|(name, (&low, &high))| (name, low, high)).collect()
}

/// A value, or the bound that is nearest to it where it is beyond by no more than `most`.
fn within((name, low, high): &(String, f64, f64), value: f64, most: f64, moved: &mut Vec<(String, f64)>) -> f64 {
    let nearest = value.max(*low).min(*high);
    if nearest == value || (nearest - value).abs() > most {
        return value;
    }
    moved.push((name.clone(), value));
    nearest
}

fn line((name, ..): &(String, f64, f64), value: f64) -> String {
    format!("{} = {value:?}\n", quoted(&format!("{PART}/{name}")))
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// All obstacles as the collision elements of one link.
fn urdf(obstacles: &[Obstacle]) -> String {
    let mut text = "<?xml version=\"1.0\"?>\n<robot name=\"obstacles\">\n  <link name=\"obstacles\">\n".to_owned();
    for obstacle in obstacles {
        let (yaw, pitch, roll) = DQuat::from_array(obstacle.quaternion).normalize().to_euler(EulerRot::ZYX);
        let [x, y, z] = obstacle.xyz;
        let shape = match obstacle.shape {
            Shape::Box { size: [a, b, c] } => format!("<box size=\"{a:?} {b:?} {c:?}\"/>"),
            Shape::Cylinder { length, radius } => format!("<cylinder length=\"{length:?}\" radius=\"{radius:?}\"/>"),
            Shape::Sphere { radius } => format!("<sphere radius=\"{radius:?}\"/>"),
        };
        let _ = writeln!(
            text,
            "    <collision name=\"{}\">\n      <origin xyz=\"{x:?} {y:?} {z:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/>\n      \
             <geometry>{shape}</geometry>\n    </collision>",
            escaped(&obstacle.name)
        );
    }
    text + "  </link>\n</robot>\n"
}

/// A name in an attribute; what XML does not take in one becomes `_`.
fn escaped(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || " -_.".contains(c) { c } else { '_' }).collect()
}
