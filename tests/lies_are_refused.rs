//! Promise: a path answers its scene, and a file that says otherwise is refused. Honest files of several scenes are lied to in
//! every way that an author may try; with the scene every lie is refused, without it none is proved.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test that cannot go on says so"
)]

mod common;
#[path = "common/lies.rs"]
mod lies;
#[path = "common/lies_about_times.rs"]
mod lies_about_times;

#[path = "common/written.rs"]
mod written;

use foliate::Planner;
use foliate::check::{CheckOptions, SceneChoice, Verdict, check};
use foliate::path_file::save;
use foliate::scene::{PackagePath, Scene, sha256};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use written::written;

/// A temporary folder; gone when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-lies-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

/// What is said of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Said {
    Proved,
    Relative,
    Refused,
    Undecided,
    Unreadable,
}

fn say(folder: &Path, path: &Value, scene: SceneChoice) -> (Said, String) {
    let place = folder.join("lie.json");
    std::fs::write(&place, path.to_string()).unwrap();
    let file = match save::read(&place) {
        Ok(file) => file,
        Err(error) => return (Said::Unreadable, error.to_string()),
    };
    let options = CheckOptions { work_limit: 200_000, scene, ..CheckOptions::default() };
    match check(&file, folder, &PackagePath::only(&[]), &options) {
        Err(error) => (Said::Unreadable, error.to_string()),
        Ok(report) => {
            let said = match report.verdict() {
                Verdict::Proved => Said::Proved,
                Verdict::Relative(_) => Said::Relative,
                Verdict::Refused => Said::Refused,
                Verdict::Undecided => Said::Undecided,
            };
            (said, report.violations.first().map(ToString::to_string).unwrap_or_default())
        }
    }
}

/// What path is lied about.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Times {
    /// The first one, which has none.
    Without,
    /// The first one, from rest to rest between all its knots.
    RestToRest,
    /// The one that is improved, smoothed and timed.
    Planned,
}

/// Plans, lies, and asks. Returns how many lies were told, and of how many kinds.
fn lie_about(scene_name: &str, folder: &Folder, times: Times) -> (usize, usize) {
    let scene = Scene::load(scene_name, &PackagePath::only(&[])).unwrap();
    let planner = Planner::new(scene.problem.clone()).unwrap();
    let planner = if times == Times::Planned { planner } else { planner.first_path() };
    let mut solution = planner.solve().unwrap();
    if times == Times::RestToRest {
        common::timed::stand_still_at_events(&mut solution.path);
        common::timed::rest_to_rest(&scene.problem, &mut solution.path);
    }
    let out = folder.0.join("honest.json");
    let path = serde_json::to_value(written(&scene, &solution.model.graph, &solution.path, &out)).unwrap();
    let honest = say(&folder.0, &path, SceneChoice::Named);
    assert_eq!(honest.0, Said::Proved, "{scene_name}: {}", honest.1);
    assert_eq!(say(&folder.0, &path, SceneChoice::Nothing).0, Said::Relative);

    let spoiled: Vec<_> = path["parts"].as_array().unwrap().iter().map(|part| spoil(folder, part)).collect();
    let robot = &scene.problem.robot;
    let links: Vec<String> = robot.shapes.iter().map(|s| robot.links[s.link.at()].name.clone()).collect();
    let told = match times {
        Times::Without => lies::all(&lies::Honest { path: &path, links: &links, spoiled: &spoiled }),
        Times::RestToRest | Times::Planned => lies_about_times::all(&path),
    };
    let mut table: BTreeMap<(&str, Said), usize> = BTreeMap::new();
    let mut believed = Vec::new();
    for (kind, lie) in &told {
        let (with, why) = say(&folder.0, lie, SceneChoice::Named);
        *table.entry((kind, with)).or_default() += 1;
        let without = if with == Said::Unreadable { with } else { say(&folder.0, lie, SceneChoice::Nothing).0 };
        let refused = matches!(with, Said::Refused | Said::Unreadable);
        if !refused || why.is_empty() || without == Said::Proved {
            believed.push(format!("{kind}: {with:?}, without the scene {without:?}"));
        }
    }
    let rows: String = table.iter().map(|((kind, said), count)| format!("  {kind:<34} {said:?} {count}\n")).collect();
    assert!(
        believed.is_empty(),
        "{scene_name}: {} of {} lies believed:\n{}\n{rows}",
        believed.len(),
        told.len(),
        believed.join("\n")
    );
    let kinds: BTreeSet<&str> = told.iter().map(|(kind, _)| *kind).collect();
    (told.len(), kinds.len())
}

/// URDFs of a part without collision shapes, and with all of them smaller.
fn spoil(folder: &Folder, part: &Value) -> [(String, String); 2] {
    let urdf = folder.0.join(part["urdf"].as_str().unwrap());
    let text = std::fs::read_to_string(&urdf).unwrap();
    let name = part["name"].as_str().unwrap();
    let without = text.replace("<collision", "<visual").replace("</collision", "</visual");
    let smaller =
        text.replace("<box size=\"0.", "<box size=\"0.00").replace("<sphere radius=\"0.", "<sphere radius=\"0.00");
    [("empty", without), ("smaller", smaller)].map(|(what, text)| {
        let file = format!("{name}-{what}.urdf");
        folder.write(&file, &text);
        (file, sha256(text.as_bytes()))
    })
}

#[test]
fn lies_about_the_demo_are_refused() {
    let (told, _) = lie_about("demo", &Folder::new("demo"), Times::Without);
    assert!(told > 400, "{told}");
}

#[test]
fn lies_about_the_drawer_are_refused() {
    let (told, _) = lie_about("drawer", &Folder::new("drawer"), Times::Without);
    assert!(told > 300, "{told}");
}

#[test]
fn lies_about_the_stack_are_refused() {
    let (told, _) = lie_about("stack", &Folder::new("stack"), Times::Without);
    assert!(told > 500, "{told}");
}

#[test]
fn lies_about_times_velocities_limits_and_events_are_refused() {
    for scene in ["demo", "drawer", "stack"] {
        for (name, times) in [("rest", Times::RestToRest), ("planned", Times::Planned)] {
            let (told, kinds) = lie_about(scene, &Folder::new(&format!("{name}-{scene}")), times);
            assert!(told > 150 && kinds >= 35, "{scene}: {told} of {kinds} kinds");
        }
    }
}

const LEVEL: &str = r#"
format = "foliate.scene/1"
name = "balanced"
description = "An arm turns beside a door that stands open, in balance and level"
margins = [{ pair = ["arm/upper", "door/leaf"], distance = 0.02 }]
ignore = [["arm/tip", "door/post"]]

[[part]]
name = "arm"
kind = "robot"
urdf = "arm.urdf"

[[part]]
name = "door"
kind = "environment"
urdf = "door.urdf"
pose = { xyz = [1.4, 0.0, 0.0] }
values = { hinge = 1.2 }

[[constraint]]
name = "level"
kind = "pose"
frame = "arm/tip"
value = { xyz = [0.0, 0.0, 0.5] }
mask = [0, 0, 1, 1, 1, 0]

[[constraint]]
name = "balance"
kind = "centre_of_mass"
frame = "arm/base"
polygon = [[-0.6, -0.6], [0.6, -0.6], [0.6, 0.6], [-0.6, 0.6]]
margin = 0.01

[[constraint]]
name = "near"
kind = "distance"
frame = "arm/tip"
to = "arm/base"
at_most = 1.2

[graph]
everywhere = ["level", "balance", "near"]

[locked]
"arm/wrist" = 0.1

[start]
"arm/shoulder" = 0.0
"arm/elbow" = 0.4

[[goal]]
configuration = { "arm/shoulder" = 1.0, "arm/elbow" = -0.3 }
"#;

fn link(name: &str, size: &str) -> String {
    format!(
        "<link name=\"{name}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>\
         </inertial><collision><origin xyz=\"0.2 0 0\"/><geometry><box size=\"{size}\"/></geometry></collision></link>"
    )
}

fn joint(name: &str, parent: &str, child: &str, xyz: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"revolute\"><origin xyz=\"{xyz}\"/><axis xyz=\"0 0 1\"/><parent link=\"{parent}\"/>\
         <child link=\"{child}\"/><limit lower=\"-2.5\" upper=\"2.5\" effort=\"1\" velocity=\"1\"/></joint>"
    )
}

#[test]
fn lies_about_constraints_balance_and_values_are_refused() {
    let folder = Folder::new("balanced");
    let arm = [
        link("base", "0.05 0.05 0.05"),
        link("upper", "0.3 0.04 0.04"),
        link("lower", "0.3 0.04 0.04"),
        link("tip", "0.05 0.04 0.04"),
        joint("shoulder", "base", "upper", "0 0 0.5"),
        joint("elbow", "upper", "lower", "0.4 0 0"),
        joint("wrist", "lower", "tip", "0.4 0 0"),
    ];
    folder.write("arm.urdf", &format!("<robot name=\"arm\">{}</robot>", arm.concat()));
    let door = [link("post", "0.02 0.02 1.0"), link("leaf", "0.4 0.02 1.0"), joint("hinge", "post", "leaf", "0 0 0")];
    folder.write("door.urdf", &format!("<robot name=\"door\">{}</robot>", door.concat()));
    folder.write("scene.toml", LEVEL);
    let scene = folder.0.join("scene.toml");
    let (told, _) = lie_about(&scene.display().to_string(), &folder, Times::Without);
    assert!(told > 100, "{told}");
}
