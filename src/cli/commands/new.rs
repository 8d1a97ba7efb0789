//! `foliate new`: a scene from a robot and objects.

use crate::cli::console::loading;
use crate::cli::console::print::{Ending, Refusal, print, print_json, say};
use crate::output;
use crate::scene::PackagePath;
use crate::setup::grasps_file::GraspAxes;
use crate::setup::request::{ObjectRequest, TableRequest};
use crate::setup::{NewScene, SetupError, WrittenScene, new_scene};
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// Writes a scene: looks at a robot and objects, finds grippers, handles, resting faces and links that touch by design, lays the
/// objects on a table within reach, and plans to see that the first one can be moved
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene file to write
    #[arg(value_name = "SCENE.toml")]
    scene: PathBuf,
    /// URDF of the robot: a file, or a package:// URL
    #[arg(long, value_name = "ROBOT.urdf")]
    robot: String,
    /// SRDF of the robot
    #[arg(long, value_name = "FILE")]
    srdf: Option<String>,
    /// An object: "box X Y Z", "cylinder RADIUS LENGTH", "sphere RADIUS" (metres), a mesh as "FILE [SCALE]", or a URDF; may be given
    /// several times. The first one is to be moved
    #[arg(long, value_name = "OBJECT", required = true)]
    object: Vec<String>,
    /// The table: "LENGTH WIDTH HEIGHT", metres; and, where its place is not to be found, "X Y" or "X Y YAW" of the middle of its top
    /// and of its longer side, seen from the root of the robot (metres, radians)
    #[arg(long, value_name = "TABLE", default_value = "1.2 0.8 0.75")]
    table: String,
    /// The robot drives: its root is planar, within 2 m of the origin
    #[arg(long)]
    drives: bool,
    /// A link of the hand to use, or a tool frame that holds what its tip touches: LINK, or LINK:AXIS (x, -x, y, ...) where the tool
    /// does not approach along z; may be given several times. Default: all hands with two jaws
    #[arg(long, value_name = "LINK")]
    gripper: Vec<String>,
    /// Grasps of the first object, in place of those that are found: lines of x y z qx qy qz qw [score], poses of the gripper in the
    /// object
    #[arg(long, value_name = "FILE")]
    grasps: Option<PathBuf>,
    /// Which axes of the frames in --grasps approach and close
    #[arg(long, value_name = "AXES", default_value = "xy")]
    grasp_axes: String,
    /// Seed of everything that is sampled
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Replace the scene file if it is there
    #[arg(long)]
    force: bool,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl From<SetupError> for Refusal {
    fn from(error: SetupError) -> Self {
        Self(error.to_string())
    }
}

/// A value of the command line.
fn parsed<T: FromStr<Err = SetupError>>(text: &str) -> Result<T, Refusal> {
    text.parse::<T>().map_err(Refusal::from)
}

impl Arguments {
    fn request(&self) -> Result<NewScene, Refusal> {
        Ok(NewScene {
            robot: self.robot.clone(),
            srdf: self.srdf.clone(),
            objects: self.object.iter().map(|text| parsed::<ObjectRequest>(text)).collect::<Result<_, _>>()?,
            table: parsed::<TableRequest>(&self.table)?,
            drives: self.drives,
            grippers: self.gripper.clone(),
            grasps: self.grasps.clone(),
            grasp_axes: parsed::<GraspAxes>(&self.grasp_axes)?,
            seed: self.seed,
            place: self.scene.clone(),
            command: self.command(),
        })
    }

    /// The command that made the scene, on one line.
    fn command(&self) -> String {
        let mut line = format!("foliate new {} --robot {}", shown(&self.scene.to_string_lossy()), shown(&self.robot));
        let mut option = |name: &str, value: &str| {
            let _ = write!(line, " --{name} {}", shown(value));
        };
        self.srdf.iter().for_each(|srdf| option("srdf", srdf));
        self.object.iter().for_each(|object| option("object", object));
        option("table", &self.table);
        if self.drives {
            line.push_str(" --drives");
        }
        let mut option = |name: &str, value: &str| {
            let _ = write!(line, " --{name} {}", shown(value));
        };
        self.gripper.iter().for_each(|link| option("gripper", link));
        if let Some(grasps) = &self.grasps {
            option("grasps", &grasps.to_string_lossy());
            option("grasp-axes", &self.grasp_axes);
        }
        option("seed", &self.seed.to_string());
        line
    }
}

/// A word of the command line, in quotation marks where it has blanks; on one line.
fn shown(word: &str) -> String {
    let word: String =
        word.chars().flat_map(|c| if c.is_control() { c.escape_debug().collect() } else { vec![c] }).collect();
    if word.contains(' ') { format!("\"{word}\"") } else { word }
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let request = arguments.request()?;
    let file = arguments.scene.display();
    if arguments.scene.exists() && !arguments.force {
        return Err(Refusal(format!("{file} is there already; give another name, or --force to replace it")));
    }
    output::check(&arguments.scene).map_err(|error| Refusal(format!("{file}: {error}")))?;
    let mine = packages.clone();
    let Ok(written) = loading::beside(Duration::MAX, Duration::ZERO, move |stop| {
        new_scene(&request, &loading::until(&mine, stop)).map_err(|error| match error {
            SetupError::Read(error) => loading::Failure::from(error),
            other => loading::Failure::Refused(other.into()),
        })
    })?
    else {
        return Ok(Ending::Interrupted);
    };
    output::write(&arguments.scene, written.text.as_bytes()).map_err(|error| Refusal(format!("{file}: {error}")))?;
    written.warnings.iter().for_each(|warning| say(&format!("warning: {warning}\n")));
    match arguments.json {
        true => print_json(&in_json(arguments, &written))?,
        false => print(&in_words(arguments, &written)),
    }
    Ok(if written.solved.is_some() { Ending::Done } else { Ending::Failed })
}

fn in_words(arguments: &Arguments, written: &WrittenScene) -> String {
    let mut text = String::new();
    for gripper in &written.grippers {
        let _ = writeln!(text, "gripper {}: {}; {}", gripper.name, gripper.reason, gripper.kind);
    }
    let (left_out, pairs) = written.pairs;
    let _ = writeln!(text, "links: {left_out} of {pairs} pairs touch by design and are left out");
    for (name, handles, faces) in &written.objects {
        let _ = writeln!(text, "{name}: {handles} handles, rests on {faces} faces");
    }
    let file = shown(&arguments.scene.to_string_lossy());
    let _ = match written.solved {
        Some(steps) => writeln!(text, "wrote {file}: solved in {steps} steps\nnext: foliate solve {file} --view"),
        None => writeln!(
            text,
            "wrote {file}: not solved within the limit of the trial; foliate solve {file} says what is in the way"
        ),
    };
    text
}

fn in_json(arguments: &Arguments, written: &WrittenScene) -> serde_json::Value {
    let objects = written.objects.iter();
    let objects: Vec<_> = objects.map(|(name, h, f)| json!({ "name": name, "handles": h, "faces": f })).collect();
    let grippers = written.grippers.iter();
    let grippers: Vec<_> =
        grippers.map(|g| json!({ "name": g.name, "reason": g.reason, "size": g.kind.to_string() })).collect();
    json!({
        "scene": arguments.scene.display().to_string(),
        "grippers": grippers,
        "objects": objects,
        "pairs_left_out": written.pairs.0,
        "pairs": written.pairs.1,
        "solved": written.solved.is_some(),
        "steps": written.solved,
        "warnings": written.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}
