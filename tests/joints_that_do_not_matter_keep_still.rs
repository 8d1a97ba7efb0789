//! Promise: a joint on which nothing depends, such as that of a head, costs no effort and keeps still. What it is follows from the
//! structure of the robot, not from names. A goal that wants it elsewhere moves it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::Planner;
use foliate::components::robot::Source;
use foliate::scene::{PackagePath, Scene};
use std::path::{Path, PathBuf};

/// Where the head is at the start, radians.
const AHEAD: f64 = 0.3;

/// The files of the demo, in a folder of their own; its robot has a head.
fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("foliate-head-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/demo")).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), folder.join(entry.file_name())).unwrap();
    }
    let head = r#"<joint name="neck" type="revolute">
        <origin xyz="0 0 1.6"/><parent link="body"/><child link="head"/><axis xyz="0 0 1"/>
        <limit lower="-1.5" upper="1.5" velocity="1" effort="5"/>
      </joint>
      <link name="head"><collision><geometry><box size="0.2 0.15 0.15"/></geometry></collision></link>
    </robot>"#;
    let robot = std::fs::read_to_string(folder.join("robot.urdf")).unwrap();
    std::fs::write(folder.join("headed.urdf"), robot.replace("</robot>", head)).unwrap();
    folder
}

fn scene(folder: &Path, headed: bool, goal: &str) -> Scene {
    let mut text = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
    if headed {
        text =
            text.replace("robot.urdf", "headed.urdf").replace("[start]", &format!("[start]\n\"robot/neck\" = {AHEAD}"));
    }
    let text = text.replace("configuration = {", &format!("configuration = {{ {goal}"));
    Scene::from_text("demo", &text, folder, &PackagePath::default()).unwrap()
}

/// Steps of a solve, and whether the head moves on the first path.
fn solved(scene: &Scene, seed: u64) -> (u64, bool) {
    let solution = Planner::new(scene.problem.clone()).unwrap().seed(seed).first_path().solve().unwrap();
    let robot = &scene.problem.robot;
    let moves = robot.joint("robot/neck").is_some_and(|joint| {
        let Source::Coordinates { q, .. } = robot.joints[joint.at()].source else { return false };
        solution.path.segments.iter().flat_map(|segment| &segment.knots).any(|knot| knot[q] != AHEAD)
    });
    (solution.report.steps, moves)
}

fn median(mut numbers: Vec<u64>) -> u64 {
    numbers.sort_unstable();
    numbers[numbers.len() / 2]
}

#[test]
fn a_head_costs_nothing_and_keeps_still() {
    let folder = folder();
    let seeds = 1..=15;
    let [without, with] = [false, true].map(|headed| {
        let scene = scene(&folder, headed, "");
        seeds.clone().map(|seed| solved(&scene, seed)).collect::<Vec<_>>()
    });
    let moved = with.iter().filter(|(_, moves)| *moves).count();
    assert!(moved <= 3, "the head moves in {moved} of 15 solves");
    let [without, with] = [without, with].map(|solves| median(solves.into_iter().map(|(steps, _)| steps).collect()));
    assert!(with as f64 <= 1.5 * without as f64, "{without} steps without a head, {with} with one");
    // Where a goal wants it elsewhere, it goes there.
    let elsewhere = scene(&folder, true, "\"robot/neck\" = -1.0, ");
    assert!(seeds.take(3).all(|seed| solved(&elsewhere, seed).1));
    std::fs::remove_dir_all(&folder).unwrap();
}
