//! Promise: every shipped scene loads as it says, with start and goals within bounds.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

use foliate::NoSolutionReason;
use foliate::Planner;
use foliate::components::problem::Goal;
use foliate::components::robot::{PartKind, Robot};
use foliate::scene::{Origin, PackagePath, Scene, coordinate_names, shipped_scenes};
use foliate::systems::settings::SearchSettings;

fn assert_within_bounds(scene: &Scene) {
    let problem = &scene.problem;
    let names = coordinate_names(&problem.robot);
    let whole = problem.goals.iter().filter_map(|g| match g {
        Goal::Configuration(q) => Some(q),
        Goal::Partial(_) => None,
    });
    for q in std::iter::once(&problem.start).chain(whole) {
        let out = problem.robot.space.first_out_of_bounds(q, 0.0);
        assert_eq!(out.map(|i| &names[i]), None, "{}: out of bounds", problem.name);
    }
}

#[test]
fn the_demo_loads_without_any_package() {
    let scene = Scene::load("demo", &PackagePath::default()).expect("the demo loads");
    let robot = &scene.problem.robot;
    assert_eq!(scene.warnings, []);
    assert_within_bounds(&scene);
    assert_eq!(robot.space.dimension(), 2 * 8 + 2 * 6);
    assert_eq!(robot.shapes.len(), 25);
    assert_eq!(scene.problem.graph.grippers.len(), 2);
    assert_eq!(scene.problem.graph.objects.len(), 2);
    assert_eq!(scene.problem.graph.supports.len(), 1);
    let kinds: Vec<_> = robot.parts.iter().map(|p| p.kind).collect();
    assert_eq!(kinds, [PartKind::Robot, PartKind::Environment, PartKind::Object, PartKind::Object]);
    assert!(scene.parts.iter().all(|p| matches!(p.urdf.origin, Origin::Program(_))));
}

#[test]
fn small_scenes_load_from_their_directories_as_from_the_program() {
    for shipped in shipped_scenes().iter().filter(|s| !s.needs_models) {
        let path = format!("{}/scenes/{}/scene.toml", env!("CARGO_MANIFEST_DIR"), shipped.name);
        let (file, program) = (Scene::load(&path, &PackagePath::default()), shipped.load(&PackagePath::default()));
        let (file, program) = (file.expect("from disk"), program.expect("from the program"));
        assert_eq!((program.problem.name.as_str(), &program.warnings[..]), (shipped.name, &[][..]));
        assert_within_bounds(&program);
        assert_eq!(file.problem.start, program.problem.start);
        assert_eq!(file.problem.goals, program.problem.goals);
        let sums = |scene: &Scene| scene.parts.iter().map(|p| p.urdf.sha256.clone()).collect::<Vec<_>>();
        assert_eq!(sums(&file), sums(&program));
    }
}

#[test]
fn scenes_with_published_robots_load_with_the_files_they_were_made_with() {
    let Some(packages) = common::published_models("scenes_with_published_robots") else { return };
    for shipped in shipped_scenes().iter().filter(|s| s.needs_models) {
        let scene = shipped.load(&packages).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(scene.problem.name, shipped.name);
        assert_within_bounds(&scene);
        let differs = scene.warnings.iter().find(|w| w.message.contains("differs"));
        assert_eq!(differs, None);
    }
}

/// A search classifies start and goals before its first step: in bounds, free of collisions, in a state.
#[test]
fn every_start_and_goal_may_be_one() {
    let packages = common::published_models("every_start_and_goal_may_be_one");
    for shipped in shipped_scenes().iter().filter(|s| packages.is_some() || !s.needs_models) {
        let scene =
            shipped.load(packages.as_ref().unwrap_or(&PackagePath::default())).unwrap_or_else(|e| panic!("{e}"));
        let planner = Planner::new(scene.problem).unwrap_or_else(|e| panic!("{}: {e}", shipped.name));
        let settings = SearchSettings::default().with(|s| (s.max_steps, s.candidates) = (1, 1));
        let reason = planner.settings(settings).solve().err().map(|none| none.reason);
        assert!(matches!(reason, None | Some(NoSolutionReason::StepLimit)), "{}: {reason:?}", shipped.name);
    }
}

/// `tests/facts/problems.json`: nq, order of joints, start and goal of the records that the scenes were made from.
#[test]
fn the_scenes_are_the_published_records() {
    let Some(packages) = common::published_models("the_scenes_are_the_published_records") else { return };
    let text = include_str!("facts/problems.json");
    let facts: serde_json::Value = serde_json::from_str(text).expect("facts are JSON");
    let numbers = |v: &serde_json::Value| -> Vec<f64> {
        v.as_array().into_iter().flatten().filter_map(serde_json::Value::as_f64).collect()
    };
    for (name, record) in facts["problems"].as_object().expect("records by name") {
        let scene = Scene::load(name, &packages).unwrap_or_else(|e| panic!("{e}"));
        let robot = &scene.problem.robot;
        let joints: Vec<&str> = robot.joints.iter().map(|j| j.name.as_str()).collect();
        assert_eq!(serde_json::json!(joints), record["joints"], "{name}");
        assert_eq!(robot.space.size(), record["nq"].as_u64().unwrap_or_default() as usize);
        let [Goal::Configuration(goal)] = &scene.problem.goals[..] else { panic!("{name}: one whole goal") };
        assert_same(robot, &scene.problem.start, &numbers(&record["start"]), name);
        assert_same(robot, goal, &numbers(&record["goal"]), name);
    }
}

/// Bit for bit, but for quaternions, which are scaled to length one as they are read.
fn assert_same(robot: &Robot, read: &[f64], record: &[f64], scene: &str) {
    assert_eq!(read.len(), record.len(), "{scene}");
    for ((name, a), b) in coordinate_names(robot).iter().zip(read).zip(record) {
        let of_quaternion = ["/qx", "/qy", "/qz", "/qw"].iter().any(|q| name.ends_with(q));
        assert!(a == b || (of_quaternion && (a - b).abs() < 1e-8), "{scene}: {name} is {a}, not {b}");
    }
}
