//! The main job: every shipped scene is solved, `foliate check` proves each path again from its file, other people's code
//! (pinocchio and coal) finds nothing wrong with it, and the file is the same byte for byte on one thread and on two.
//!
//! One path per scene is re-checked at a step at which no body point moves more than half a millimetre, more paths with
//! steps chosen by coal's distances. All of it through the program, as a user would.

#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

mod common;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const BAXTER: [&str; 5] = ["baxter-case1", "baxter-case2", "baxter-case3", "baxter-case4", "baxter-manipulation-boxes"];

/// Scenes of the papers' family on other robots: planar roots, unlimited joints, axial grasps, a handover.
const OTHERS: [&str; 5] =
    ["ur3-spheres", "hpp-tutorial-3", "pr2-manipulation-two-hand", "pr2-manipulation-kitchen", "pr2-in-iai-kitchen"];

/// Plain motion planning: one state, nothing to hold.
const PANDA: [&str; 4] = ["panda-table", "panda-shelf", "panda-box", "panda-cage"];

/// Closed chains, balance, steps, a door held open, magnets.
const WHAT_ELSE_HOLDS: [&str; 6] = [
    "romeo-placard",
    "talos-pass-box",
    "talos-steps",
    "pyrene-on-the-ground",
    "romeo-fridge-upright",
    "construction-set",
];

/// Scenes with models of their own.
const SMALL: [&str; 3] = ["demo", "stack", "drawer"];

/// The small scenes, and the Baxter's where the published models are at hand.
fn scenes(test: &str) -> Vec<&'static str> {
    let mut scenes = SMALL.to_vec();
    if common::published_models(test).is_some() {
        scenes.extend(BAXTER);
    }
    scenes
}

/// A folder of this test's own, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("foliate-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

fn foliate(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_foliate"))
        .arg("--no-mesh-cache")
        .args(arguments)
        .output()
        .expect("the program runs")
}

fn solve(folder: &Folder, scene: &str, seed: u32, threads: u32) -> PathBuf {
    let path = folder.0.join(format!("{scene}-{seed}.json"));
    let (seed, threads, out) = (seed.to_string(), threads.to_string(), path.to_string_lossy().into_owned());
    let limit = ["--time-limit", "300"];
    let arguments = [&["solve", scene, "--seed", &seed, "--threads", &threads, "--out", &out], &limit[..]].concat();
    let output = foliate(&arguments);
    assert!(output.status.success(), "{scene} seed {seed}: {}", String::from_utf8_lossy(&output.stdout));
    path
}

#[test]
fn every_scene_is_solved_and_proven_again_from_the_file() {
    let folder = Folder::new("solved");
    for scene in scenes("every_scene_is_solved") {
        for seed in 1..=3 {
            let path = solve(&folder, scene, seed, 1);
            let output = foliate(&["check", &path.to_string_lossy()]);
            assert!(output.status.success(), "{scene} seed {seed}: {}", String::from_utf8_lossy(&output.stdout));
        }
    }
}

#[test]
fn every_other_scene_is_solved_once_and_proven_again() {
    if common::published_models("every_other_scene_is_solved_once").is_none() {
        return;
    }
    let folder = Folder::new("others");
    let python = common::skip::python_with("pinocchio, coal", "every_other_scene_is_solved_once (its second look)");
    for scene in OTHERS.into_iter().chain(PANDA).chain(WHAT_ELSE_HOLDS) {
        let path = solve(&folder, scene, 1, 2);
        let output = foliate(&["check", &path.to_string_lossy()]);
        assert!(output.status.success(), "{scene}: {}", String::from_utf8_lossy(&output.stdout));
        if let Some(python) = &python {
            recheck(python, &path, &["--adaptive"]);
        }
    }
}

/// Waypoints are moved by shares of the ways to their neighbours, which together may lead beyond a joint's limit. A projection does
/// not look at joints that its rows do not depend on, such as fingers.
#[test]
fn moved_waypoints_keep_joint_limits() {
    if common::published_models("moved_waypoints_keep_joint_limits").is_none() {
        return;
    }
    let folder = Folder::new("limits");
    for (seed, work) in [(20, "0"), (22, "2000")] {
        let path = folder.0.join(format!("{seed}.json"));
        let (seed, out) = (seed.to_string(), path.to_string_lossy().into_owned());
        let scene = "pr2-manipulation-two-hand";
        let solved =
            foliate(&["solve", scene, "--seed", &seed, "--threads", "1", "--improve-work", work, "--out", &out]);
        assert!(solved.status.success(), "{}", String::from_utf8_lossy(&solved.stdout));
        let output = foliate(&["check", &out]);
        assert!(output.status.success(), "seed {seed}: {}", String::from_utf8_lossy(&output.stdout));
    }
}

#[test]
fn files_do_not_depend_on_threads() {
    let folder = Folder::new("threads");
    let mut scenes = scenes("files_do_not_depend_on_threads");
    if scenes.len() > SMALL.len() {
        scenes.push("talos-pass-box");
    }
    for scene in scenes {
        let bytes = [1, 2].map(|threads| std::fs::read(solve(&folder, scene, 4, threads)).expect("a path file"));
        assert!(bytes[0] == bytes[1], "{scene}: the path files differ");
    }
}

#[test]
fn an_independent_checker_finds_no_violation() {
    let test = "an_independent_checker_finds_no_violation";
    let Some(python) = common::skip::python_with("pinocchio, coal", test) else { return };
    let folder = Folder::new("recheck");
    for scene in scenes("an_independent_checker_finds_no_violation") {
        recheck(&python, &solve(&folder, scene, 1, 1), &["--step", "0.5"]);
        for seed in 5..=7 {
            recheck(&python, &solve(&folder, scene, seed, 1), &["--adaptive"]);
        }
    }
}

/// The interpreter with pinocchio and coal.
fn recheck(python: &Path, path: &Path, mode: &[&str]) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/independent/recheck.py");
    let mut command = Command::new(python);
    command.arg(script).arg(path).args(mode);
    if let Some(cache) = foliate::scene::model_cache() {
        command.arg("--package-path").arg(cache);
    }
    let output = command.output().expect("python runs");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}: {said}{}", path.display(), String::from_utf8_lossy(&output.stderr));
}
