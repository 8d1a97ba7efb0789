//! What `foliate export` writes is read by other people's libraries, and says what the path says.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

#[path = "common/written.rs"]
mod written;

use common::skip::{node_with, python_with};
use common::timed::rest_to_rest;
use foliate::certify::formats::{ReadOptions, read};
use foliate::certify::{Certifier, CertifyOptions, Verdict};
use foliate::components::path::ManipulationPath;
use foliate::components::problem::Problem;
use foliate::kernels::collision::CollisionScratch;
use foliate::path_file::save;
use foliate::scene::{PackagePath, Scene};
use foliate::{Planner, Solution};
use std::path::{Path, PathBuf};
use std::process::Command;
use written::written;

/// Scenes with what differs: boxes and two arms, objects that carry objects, a door of the environment, meshes of a published robot, a base
/// that flies.
const EMBEDDED: [&str; 3] = ["demo", "stack", "drawer"];
const PUBLISHED: [&str; 3] = ["baxter-case1", "panda-shelf", "talos-pass-box"];

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("foliate-export-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A first path with simple times, as a file.
fn planned(scene: &str, packages: &PackagePath, file: &Path, spoil: impl Fn(&Problem, &mut ManipulationPath)) -> Scene {
    let scene = Scene::load(scene, packages).unwrap_or_else(|e| panic!("{e}"));
    let planner = Planner::new(scene.problem.clone()).unwrap().seed(1).first_path();
    let mut solution = planner.solve().unwrap_or_else(|e| panic!("{}: {e}", scene.problem.name));
    rest_to_rest(&scene.problem, &mut solution.path);
    spoil(&scene.problem, &mut solution.path);
    save_path(&scene, &solution, file);
    scene
}

/// What the planner answers by default: improved, smooth, with times of its own.
fn improved(scene: &str, packages: &PackagePath, file: &Path) {
    let scene = Scene::load(scene, packages).unwrap_or_else(|e| panic!("{e}"));
    let solution = Planner::new(scene.problem.clone()).unwrap().seed(1).solve().unwrap_or_else(|e| panic!("{e}"));
    assert!(solution.path.segments.iter().all(|s| s.timing.is_some()), "{:?}", solution.report.untimed);
    save_path(&scene, &solution, file);
}

fn save_path(scene: &Scene, solution: &Solution, file: &Path) {
    save::save(&written(scene, &solution.model.graph, &solution.path, file), file).unwrap();
}

/// Gives the knots inside of segments some velocity, so that a reader that takes it for zero is found.
fn swing(problem: &Problem, path: &mut ManipulationPath) {
    let is_object = |i: usize| {
        let joint = problem.robot.joints.iter().find(|joint| match joint.source {
            foliate::components::robot::Source::Coordinates { q, .. } => {
                (q..q + joint.motion.configuration_size()).contains(&i)
            }
            foliate::components::robot::Source::Follows { .. } => false,
        });
        joint.is_none_or(|joint| {
            problem.robot.parts[joint.part.at()].kind != foliate::components::robot::PartKind::Robot
        })
    };
    for segment in &mut path.segments {
        let Some(timing) = &mut segment.timing else { continue };
        for k in 1..segment.knots.len() - 1 {
            let span = timing.times[k + 1] - timing.times[k - 1];
            for i in (0..segment.knots[k].len()).filter(|i| !is_object(*i)) {
                timing.velocities[k][i] = (segment.knots[k + 1][i] - segment.knots[k - 1][i]) / span.max(1e-3);
            }
        }
    }
}

fn foliate(arguments: &[&str]) -> (bool, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_foliate")).args(arguments).output().unwrap();
    let text = [out.stdout, out.stderr].concat();
    (out.status.success(), String::from_utf8_lossy(&text).into_owned())
}

fn export(path: &Path, out: &Path, more: &[&str]) {
    let (path, out) = (path.to_str().unwrap(), out.to_str().unwrap());
    let (done, told) = foliate(&[&["export", path, "-o", out], more].concat());
    assert!(done, "{path} {out}: {told}");
}

fn read_by_others(scene: &str, packages: &PackagePath, test: &str, is_improved: bool) {
    let folder = folder(&format!("{scene}-{is_improved}"));
    let path = folder.join("path.json");
    if is_improved {
        improved(scene, packages, &path);
    } else {
        planned(scene, packages, &path, swing);
    }
    for name in ["ros.json", "ros.yaml", "all.csv", "all.npz", "all.mcap", "all.glb"] {
        export(&path, &folder.join(name), &["--rate", "50"]);
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/independent");
    if let Some((node, modules)) = node_with("gltf-validator", test) {
        let mut command = Command::new(node);
        let command = command.arg(script.join("validate_glb.js")).arg(folder.join("all.glb"));
        let out = command.env("NODE_PATH", std::path::absolute(modules).unwrap()).output().unwrap();
        let told = String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned();
        assert!(out.status.success(), "{scene}: {told}");
        println!("{told}");
    }
    if let Some(python) = python_with("pinocchio, coal, numpy, yaml, mcap", test) {
        let mut command = Command::new(python);
        let out = command.arg(script.join("read_exports.py")).args([&path, &folder]).args(["--samples", "50"]).output();
        let out = out.unwrap();
        let told = String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned();
        assert!(out.status.success(), "{scene}: {told}");
        println!("{scene}: {told}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn embedded_scenes_are_read_by_others() {
    for scene in EMBEDDED {
        read_by_others(scene, &PackagePath::only(&[]), "embedded_scenes_are_read_by_others", false);
    }
}

#[test]
fn smooth_paths_are_read_by_others() {
    for scene in EMBEDDED {
        read_by_others(scene, &PackagePath::only(&[]), "smooth_paths_are_read_by_others", true);
    }
}

#[test]
fn published_robots_are_read_by_others() {
    let test = "published_robots_are_read_by_others";
    let Some(packages) = common::published_models(test) else { return };
    for scene in PUBLISHED {
        read_by_others(scene, &packages, test, false);
    }
}

/// `foliate certify` finds the motion of a path file and of its exports free, and of equal length.
#[test]
fn certify_agrees_about_the_exports() {
    let folder = folder("certify");
    let path = folder.join("path.json");
    for name in EMBEDDED {
        let scene = planned(name, &PackagePath::only(&[]), &path, |_, _| {});
        let certifier = Certifier::new(&scene.problem, &[]).unwrap();
        let mut clearances = Vec::new();
        for export_name in ["path.json", "ros.json", "all.npz", "all.csv"] {
            let file = folder.join(export_name);
            if export_name != "path.json" {
                export(&path, &file, &["--rate", "200"]);
            }
            if export_name == "all.npz" || export_name == "all.csv" {
                // Tables say where robots are and not what carries objects: the motion is read, and no more is compared here.
                let motion = read(&file, certifier.robot(), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
                clearances.push((motion.ends(), None));
                continue;
            }
            let motion = read(&file, certifier.robot(), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
            let options = CertifyOptions { clearance: true, ..CertifyOptions::default() };
            let report = certifier.certify(&motion, &options, &mut CollisionScratch::new()).unwrap();
            assert_eq!(report.verdict, Verdict::Free, "{name} {export_name}: {report:?}");
            let least = report.clearance.as_ref().map(|c| c.at_least);
            clearances.push((motion.ends(), least));
        }
        let (end, least) = clearances[0];
        assert!(end > 1.0, "{name}: {end} s");
        assert!(clearances.iter().all(|(other, _)| (other - end).abs() < 2e-9), "{name}: {clearances:?}");
        let (ours, theirs) = (least.unwrap(), clearances[1].1.unwrap());
        assert!((ours - theirs).abs() <= 0.1 * ours.max(theirs) + 1e-4, "{name}: {clearances:?}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// A path without times is refused with a hint; its knots are a table.
#[test]
fn a_path_without_times_is_refused_but_for_its_knots() {
    let folder = folder("untimed");
    let path = folder.join("path.json");
    let mut knots = 0;
    planned("demo", &PackagePath::only(&[]), &path, |_, path| {
        path.segments.iter_mut().for_each(|segment| segment.timing = None);
    });
    let table = folder.join("knots.csv");
    let path_name = path.to_str().unwrap();
    for ending in ["json", "npz", "mcap", "glb", "yaml"] {
        let out = folder.join(format!("out.{ending}"));
        let (done, told) = foliate(&["export", path_name, "-o", out.to_str().unwrap()]);
        assert!(!done && told.contains("no times") && told.contains("--to csv"), "{ending}: {told}");
        assert!(!out.exists());
    }
    export(&path, &table, &[]);
    let text = std::fs::read_to_string(&table).unwrap();
    let mut lines = text.lines();
    assert!(lines.next().unwrap().starts_with("robot/"), "{text}");
    knots += lines.count();
    assert!(knots > 5, "{knots}");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Names and rates that lead nowhere are refused with what there is.
#[test]
fn what_cannot_be_meant_is_refused() {
    let folder = folder("refused");
    let path = folder.join("path.json");
    planned("demo", &PackagePath::only(&[]), &path, |_, _| {});
    let (path, out) = (path.to_str().unwrap(), folder.join("out.csv"));
    let out = out.to_str().unwrap();
    let cases: [(&[&str], &str); 5] = [
        (&["--robot", "nobody"], "there are robot"),
        (&["--joints", "elbow_of_nobody"], "there are robot/"),
        (&["--rate", "0"], "0 Hz is no rate"),
        (&["--rate", "1e12"], "ten million"),
        (&["--to", "nothing"], "possible values"),
    ];
    for (more, wanted) in cases {
        let (done, told) = foliate(&[&["export", path, "-o", out], more].concat());
        assert!(!done && told.contains(wanted), "{more:?}: {told}");
    }
    let (done, told) = foliate(&["export", path, "-o", folder.join("out.xyz").to_str().unwrap()]);
    assert!(!done && told.contains("--to"), "{told}");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// The same path gives the same bytes.
#[test]
fn exports_are_repeatable() {
    let folder = folder("repeatable");
    let path = folder.join("path.json");
    planned("demo", &PackagePath::only(&[]), &path, swing);
    for ending in ["json", "yaml", "csv", "npz", "mcap", "glb"] {
        let (one, other) = (folder.join(format!("one.{ending}")), folder.join(format!("other.{ending}")));
        export(&path, &one, &[]);
        export(&path, &other, &[]);
        assert_eq!(std::fs::read(one).unwrap(), std::fs::read(other).unwrap(), "{ending}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
