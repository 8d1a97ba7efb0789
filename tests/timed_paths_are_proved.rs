//! Promise: what is proved of a path with times is proved of the curve itself, not of its chords. Curves that leave what their knots
//! keep (limits, clearance, constraints) are refused, curves that keep it where their chords would not are proved, and solved scenes
//! with times are proved whole.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "a test that cannot go on says so")]

mod common;
#[path = "common/story.rs"]
#[allow(dead_code, reason = "each test uses its part")]
mod story;
#[path = "common/timed_story.rs"]
mod timed_story;

#[path = "common/written.rs"]
mod written;

use common::timed::{rest_to_rest, stand_still_at_events};
use foliate::Planner;
use foliate::check::{CheckOptions, CheckReport, Verdict, check, check_problem};
use foliate::components::constraint::Rests;
use foliate::path_file::{PathFile, save};
use foliate::scene::{PackagePath, Scene};
use serde_json::{Value, json};
use std::time::Instant;
use story::*;
use timed_story::{DWELL, STEP, with_times};
use written::written;

fn timed() -> Value {
    with_times(story())
}

fn assert_only(folder: &Folder, path: &Value, kinds: &[&str]) {
    assert_eq!(folder.kinds(path), kinds, "{:#?}", folder.check(path).map(|r| r.violations));
}

fn changed(change: impl FnOnce(&mut Value)) -> Value {
    let mut path = timed();
    change(&mut path);
    path
}

/// A path of the arm alone, past a thin plate: knots of shoulder and elbow, and their velocities, a second apart.
fn arm_alone(knots: &[[f64; 2]], velocities: &[[f64; 2]], plate: Option<Pose>) -> Value {
    let mut path = story();
    path["parts"] = json!([path["parts"][0]]);
    if let Some(pose) = plate {
        path["parts"].as_array_mut().unwrap().push(part("plate", "environment", "fixed", pose));
    }
    path["coordinates"] = json!(["arm/shoulder", "arm/elbow"]);
    path["limits"] = json!({ "arm/shoulder": [-3.0, 3.0], "arm/elbow": [-3.0, 3.0] });
    path["documents"] = json!({ "grippers": {}, "handles": {}, "surfaces": {} });
    path["segments"] = json!([segment(json!([]), knots.iter().map(|k| json!(k)).collect())]);
    path["certificate"] = json!({ "path_tolerance": 2e-4, "max_residual": 2e-4, "joint_limits": "within" });
    let mut path = with_times(path);
    path["segments"][0]["velocities"] = json!(velocities);
    let wide = json!({ "velocity": 100.0, "acceleration": 1000.0 });
    path["rate_limits"] = json!({ "arm/shoulder": wide, "arm/elbow": wide });
    path
}

#[test]
fn the_timed_story_is_proved() {
    let folder = Folder::new();
    let report = folder.check(&timed()).unwrap();
    assert!(report.passed(), "{:#?}", report.violations);
    // Four moves of a second each, and two dwells.
    assert!((report.duration.unwrap() - (5.0 * STEP + 2.0 * DWELL)).abs() < 1e-12);
    // The last move turns the elbow by 0.6 rad from rest to rest.
    let fastest = report.max_velocity.unwrap();
    assert!((fastest.value - 1.5 * 0.6).abs() < 1e-12 && fastest.subject == "arm/elbow", "{fastest:?}");
    assert!((report.max_acceleration.unwrap().value - 6.0 * 0.6 / 4.0).abs() < 1e-12);
}

#[test]
fn limits_of_rates_are_exact() {
    let folder = Folder::new();
    let with_limit = |key: &str, limit: f64| changed(|path| path["rate_limits"]["arm/elbow"][key] = json!(limit));
    for (key, kind, used) in [("velocity", "velocity-limit", 0.9), ("acceleration", "acceleration-limit", 3.6)] {
        assert_only(&folder, &with_limit(key, used * (1.0 + 1e-12)), &[]);
        assert_only(&folder, &with_limit(key, used * (1.0 - 1e-10)), &[]);
        let mut path = with_limit(key, used * (1.0 - 1e-7));
        path["certificate"][format!("max_{key}")] = json!(1.000_001);
        assert_only(&folder, &path, &[kind]);
    }
    // From rest to rest the acceleration jumps at both ends: no limit of the jerk holds.
    assert_only(&folder, &with_limit("jerk", 1e6), &["jerk-limit"]);
}

#[test]
fn a_limit_exceeded_only_between_knots_is_refused() {
    let folder = Folder::new();
    // Between 2.9 and 2.9 the curve rises by a quarter of the velocity.
    let path = |velocity: f64| {
        let still = [0.0, 0.0];
        arm_alone(
            &[[2.0, 0.0], [2.9, 0.0], [2.9, 0.0], [2.0, 0.0]],
            &[still, [velocity, 0.0], [-velocity, 0.0], still],
            None,
        )
    };
    assert_only(&folder, &path(0.39), &[]);
    assert_only(&folder, &path(0.41), &["limit"]);
    let report = folder.check(&path(0.41)).unwrap();
    assert!((report.violations[0].value.unwrap() - (2.9 + 0.41 / 4.0)).abs() < 1e-12, "{:?}", report.violations);
}

#[test]
fn a_follower_beyond_its_limit_between_knots_is_refused() {
    let folder = Folder::new();
    let mimic = r#"<mimic joint="elbow" multiplier="-2"/>"#;
    let follower = joint("tip", "lower", "finger", [0.5, 0.3, 0.0], mimic);
    folder.write("arm.urdf", &arm(&[link("finger", "", 0.0), follower]));
    let path = |velocity: f64| {
        let still = [0.0, 0.0];
        arm_alone(
            &[[0.0, 0.0], [0.0, 1.4], [0.0, 1.4], [0.0, 0.0]],
            &[still, [0.0, velocity], [0.0, -velocity], still],
            None,
        )
    };
    assert_only(&folder, &path(0.39), &[]);
    assert_only(&folder, &path(0.41), &["follower-limit"]);
}

#[test]
fn a_curve_that_bulges_into_a_plate_is_refused_and_one_round_it_is_proved() {
    let folder = Folder::new();
    // The arm stretched out at 0, a thin plate beside it at 0.2 rad.
    let plate = Some(about_z(0.99 * 0.2_f64.cos(), 0.99 * 0.2_f64.sin(), 0.5, 0.2));
    let swing = |velocity: f64| {
        arm_alone(
            &[[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
            &[[0.0, 0.0], [velocity, 0.0], [-velocity, 0.0], [0.0, 0.0]],
            plate,
        )
    };
    assert_only(&folder, &swing(0.4), &[]);
    assert_only(&folder, &swing(0.0), &[]);
    assert_only(&folder, &swing(0.9), &["collision"]);
    let met = folder.check(&swing(0.9)).unwrap();
    assert!(met.violations[0].t.is_some_and(|t| t > 1.0 && t < 2.0), "{:?}", met.violations);
    // The elbow folds the arm away from the plate, which stands in the way of the arm stretched out.
    let (still, knots) = ([0.0, 0.0], [[0.0, 0.0], [0.0, -1.0], [0.4, -1.0], [0.4, 0.0]]);
    assert_only(&folder, &arm_alone(&knots, &[still; 4], plate), &[]);
    let straight = [[0.0, 0.0], [0.4, 0.0]];
    assert_only(&folder, &arm_alone(&straight, &[still; 2], plate), &["collision"]);
    let round = arm_alone(&straight, &[[0.0, -8.0], [0.0, 8.0]], plate);
    let kinds = folder.kinds(&round);
    assert_eq!(kinds, ["velocity-jump"], "{:#?}", folder.check(&round).map(|r| r.violations));
}

#[test]
fn random_curves_are_judged_as_fine_samples_judge_them() {
    let folder = Folder::new();
    let mut state = 11_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let (mut refused, mut proved) = (0, 0);
    for _ in 0..80 {
        let knots: Vec<[f64; 2]> = (0..6).map(|_| [1.4 * next(), 2.0 * next()]).collect();
        let mut velocities: Vec<[f64; 2]> = (0..6).map(|_| [2.0 * next(), 3.0 * next()]).collect();
        (velocities[0], velocities[5]) = ([0.0; 2], [0.0; 2]);
        let plate = about_z(0.92, 0.5 * next(), 0.5, next());
        let path = arm_alone(&knots, &velocities, Some(plate));
        let kinds = folder.kinds(&path);
        // Every fine sample as a knot of a path without velocities, straight in between.
        let mut fine = path.clone();
        fine["format"] = json!("foliate.path/1");
        for key in ["rate_limits", "events"] {
            fine.as_object_mut().unwrap().remove(key);
        }
        for key in ["max_velocity", "max_acceleration", "continuity"] {
            fine["certificate"].as_object_mut().unwrap().remove(key);
        }
        let curve = |piece: usize, s: f64, i: usize| {
            let (p, q, v, w) = (knots[piece][i], knots[piece + 1][i], velocities[piece][i], velocities[piece + 1][i]);
            let (s2, s3) = (s * s, s * s * s);
            p * (2.0 * s3 - 3.0 * s2 + 1.0) + v * (s3 - 2.0 * s2 + s) + q * (3.0 * s2 - 2.0 * s3) + w * (s3 - s2)
        };
        let samples = (0..=2000).map(|k| {
            let (piece, s) = ((k / 400).min(4), f64::from(k as u32) / 400.0);
            json!([curve(piece, s - piece as f64, 0), curve(piece, s - piece as f64, 1)])
        });
        fine["segments"] = json!([segment(json!([]), samples.collect())]);
        assert_eq!(kinds, folder.kinds(&fine), "{path}");
        if kinds.is_empty() { proved += 1 } else { refused += 1 }
    }
    assert!(refused > 15 && proved > 5, "{refused} {proved}");
}

#[test]
fn what_stands_still_has_no_velocity_between_knots_either() {
    let folder = Folder::new();
    // A joint that a constraint keeps at 0.
    let constrained = |velocity: f64| {
        let mut path =
            arm_alone(&[[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]], &[[0.0, 0.0], [0.1, velocity], [0.0, 0.0]], None);
        path["segments"][0]["constraints"] =
            json!([{ "kind": "joint", "joint": "arm/elbow", "position": 0.0, "tolerance": 1e-4 }]);
        path
    };
    assert_only(&folder, &constrained(0.0), &[]);
    assert_only(&folder, &constrained(1e-2), &["constraint"]);
    // A pose that only straight knots keep: the tip stays at its height, and its x at 1 in between.
    let pose = |velocity: f64| {
        let mut path =
            arm_alone(&[[0.0, 0.0], [0.0, 0.0], [0.0, 0.0]], &[[0.0, 0.0], [0.0, velocity], [0.0, 0.0]], None);
        path["segments"][0]["constraints"] = json!([{ "kind": "pose", "frame": "arm/lower", "to": "world", "tolerance": 1e-4,
            "mask": [false, false, false, true, true, true] }]);
        path
    };
    assert_only(&folder, &pose(0.0), &[]);
    assert_only(&folder, &pose(5e-4), &[]);
    assert_only(&folder, &pose(2e-3), &["constraint"]);
}

#[test]
fn a_door_that_is_not_held_does_not_swing_between_knots() {
    let folder = Folder::new();
    let hinge = joint("hinge", "frame", "leaf", [0.0; 3], "");
    folder.write("door.urdf", &robot(&[link("frame", "", 0.0), link("leaf", &cuboid(0.2, 0.02, 0.2), 0.1), hinge]));
    let path = |velocity: f64| {
        let mut path = arm_alone(&[[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]], &[[0.0, 0.0], [0.1, 0.0], [0.0, 0.0]], None);
        path["parts"].as_array_mut().unwrap().push(part(
            "door",
            "object",
            "fixed",
            [0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        ));
        path["coordinates"].as_array_mut().unwrap().push(json!("door/hinge"));
        path["rate_limits"]["door/hinge"] = json!({ "velocity": 1.0, "acceleration": 100.0 });
        for (knot, speed) in [0.0, velocity, 0.0].into_iter().enumerate() {
            path["segments"][0]["knots"][knot].as_array_mut().unwrap().push(json!(0.5));
            path["segments"][0]["velocities"][knot].as_array_mut().unwrap().push(json!(speed));
        }
        path
    };
    assert_only(&folder, &path(0.0), &[]);
    assert_only(&folder, &path(1e-3), &["joint-unheld"]);
}

/// A free-flying robot that turns by a chord of its quaternion.
fn flyer(velocities: [[f64; 7]; 2]) -> Value {
    let mut path = story();
    path["parts"] = json!([part("cube", "robot", "freeflyer", IDENTITY)]);
    path["limits"] = json!({});
    path["coordinates"] = json!(["x", "y", "z", "qx", "qy", "qz", "qw"].map(|axis| format!("cube/{axis}")));
    path["documents"] = json!({ "grippers": {}, "handles": {}, "surfaces": {} });
    path["segments"] =
        json!([segment(json!([]), vec![json!(about_z(0.0, 0.0, 0.5, 0.0)), json!(about_z(0.0, 0.0, 0.5, 1.5))])]);
    path["certificate"] = json!({ "path_tolerance": 2e-4, "max_residual": 2e-4, "joint_limits": "within" });
    let mut path = with_times(path);
    path["rate_limits"] = json!({});
    path["segments"][0]["velocities"] = json!(velocities);
    path
}

#[test]
fn quaternions_are_scaled_and_may_not_pass_by_zero() {
    let folder = Folder::new();
    let still = [0.0; 7];
    assert_only(&folder, &flyer([still; 2]), &[]);
    // It turns about z alone: x and y stay zero.
    let about_z_alone = |path: &mut Value| {
        path["segments"][0]["constraints"] = json!([{ "kind": "pose", "frame": "cube", "to": "world", "tolerance": 1e-4,
            "mask": [true, true, true, true, true, false] }]);
    };
    let mut turned = flyer([still; 2]);
    about_z_alone(&mut turned);
    assert_only(&folder, &turned, &[]);
    let tilted = [0.0, 0.0, 0.0, 0.05, 0.0, 0.0, 0.0];
    let mut path = flyer([tilted, still]);
    about_z_alone(&mut path);
    assert_only(&folder, &path, &["constraint", "velocity-jump"]);
    // Backwards through zero.
    let through = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -12.0];
    assert!(folder.kinds(&flyer([through, still])).contains(&"quaternion-norm"));
}

#[test]
fn a_curve_with_continuous_acceleration_keeps_a_limit_of_its_jerk() {
    let folder = Folder::new();
    // Jerk +j, -j, -j, +j for half a second each: positions and velocities where it switches, from rest.
    let j = 2.0;
    let h = 0.5_f64;
    let (v1, q1) = (j * h * h / 2.0, j * h.powi(3) / 6.0);
    let (v2, q2) = (2.0 * v1, q1 + v1 * h + j * h.powi(3) / 3.0);
    let (v3, q3) = (v1, q2 + v2 * h - j * h.powi(3) / 6.0);
    let q4 = 2.0 * q2;
    let path = |jerk: f64| {
        let mut path = arm_alone(
            &[[0.0, 0.0], [0.0, q1], [0.0, q2], [0.0, q3], [0.0, q4]],
            &[[0.0, 0.0], [0.0, v1], [0.0, v2], [0.0, v3], [0.0, 0.0]],
            None,
        );
        path["segments"][0]["times"] = json!([0.0, h, 2.0 * h, 3.0 * h, 4.0 * h]);
        path["rate_limits"]["arm/elbow"] = json!({ "velocity": v2, "acceleration": j * h, "jerk": jerk });
        path["certificate"]["continuity"] = json!(2);
        path
    };
    assert_only(&folder, &path(j), &[]);
    assert_only(&folder, &path(0.999 * j), &["jerk-limit"]);
    let mut jumps = path(j);
    jumps["rate_limits"]["arm/elbow"] = json!({ "velocity": 10.0, "acceleration": 100.0 });
    assert_only(&folder, &jumps, &[]);
    jumps["segments"][0]["velocities"][2][1] = json!(v2 * 1.01);
    assert_only(&folder, &jumps, &["certificate"]);
    jumps["certificate"]["continuity"] = json!(1);
    assert_only(&folder, &jumps, &[]);
}

#[test]
fn keys_of_version_2_are_refused_in_version_1() {
    let folder = Folder::new();
    for (key, value) in [
        ("/rate_limits", json!({})),
        ("/events", json!([])),
        ("/certificate/max_velocity", json!(0.5)),
        ("/certificate/max_acceleration", json!(0.5)),
        ("/certificate/continuity", json!(1)),
        ("/segments/0/velocities", json!([])),
    ] {
        let mut path = story();
        let (place, name) = key.rsplit_once('/').unwrap();
        path.pointer_mut(place).unwrap()[name] = value;
        let error = folder.check(&path).unwrap_err();
        assert!(error.contains(name) && error.contains("foliate.path/1"), "{error}");
    }
    // Times mean what they meant.
    let mut path = story();
    for (index, segment) in path["segments"].as_array_mut().unwrap().iter_mut().enumerate() {
        let knots = segment["knots"].as_array().unwrap().len();
        segment["times"] = json!((0..knots).map(|k| 10 * index + k).collect::<Vec<_>>());
    }
    assert_only(&folder, &path, &[]);
}

#[test]
fn a_file_of_version_1_is_read_as_before() {
    let text = include_str!("data/demo-1.json");
    let folder = Folder::new();
    let scene = Scene::load("demo", &PackagePath::only(&[])).unwrap();
    save::model_names(&scene, &folder.path.join("demo.json")).unwrap();
    let file = save::read(&folder.write("demo.json", text)).unwrap();
    assert_eq!(file.format, "foliate.path/1");
    // Such files know one rule of how objects rest, which the demo had then.
    let mut problem = scene.problem;
    problem.graph.rests = Rests::Centre;
    let options = CheckOptions::default();
    let report = check_problem(&file, &folder.path, &PackagePath::only(&[]), &options, &problem).unwrap();
    assert_eq!(report.verdict(), Verdict::Proved, "{:#?}", report.violations);
    assert!(report.duration.is_none() && report.max_velocity.is_none());
}

fn prove(file: &PathFile, base: &std::path::Path, packages: &PackagePath) -> (CheckReport, f64) {
    let started = Instant::now();
    let report = check(file, base, packages, &CheckOptions::default()).unwrap();
    (report, started.elapsed().as_secs_f64())
}

/// Cuts every piece of a segment in so many, all on the same curve; segments whose objects move stay as they are.
fn cut(file: &mut PathFile, pieces: usize) {
    let is_object = |name: &String| {
        let part = file.parts.iter().find(|part| name.split('/').next() == Some(&part.name));
        part.is_some_and(|part| part.kind == "object")
    };
    let objects: Vec<bool> = file.coordinates.iter().map(is_object).collect();
    for segment in &mut file.segments {
        let (knots, times) = (segment.knots.clone(), segment.times.clone().unwrap());
        let velocities = segment.velocities.clone().unwrap();
        let moves =
            |(column, is_object): (usize, &bool)| *is_object && knots.iter().any(|row| row[column] != knots[0][column]);
        if objects.iter().enumerate().any(moves) {
            continue;
        }
        let mut cut = (vec![knots[0].clone()], vec![times[0]], vec![velocities[0].clone()]);
        for knot in 0..knots.len() - 1 {
            let h = times[knot + 1] - times[knot];
            // A move of the last bit takes no time that could be divided.
            let pieces = if h > 1e-3 { pieces } else { 1 };
            for piece in 1..=pieces {
                let s = piece as f64 / pieces as f64;
                let (mut position, mut velocity) = (knots[knot + 1].clone(), velocities[knot + 1].clone());
                for column in (0..position.len()).filter(|_| piece < pieces) {
                    let (p, q) = (knots[knot][column], knots[knot + 1][column]);
                    let (d, a, b) = (q - p, h * velocities[knot][column], h * velocities[knot + 1][column]);
                    position[column] = p + s * (a + s * (3.0 * d - 2.0 * a - b + s * (a + b - 2.0 * d)));
                    velocity[column] = (a + s * (2.0 * (3.0 * d - 2.0 * a - b) + 3.0 * s * (a + b - 2.0 * d))) / h;
                }
                cut.0.push(position);
                cut.1.push(if piece < pieces { times[knot] + s * h } else { times[knot + 1] });
                cut.2.push(velocity);
            }
        }
        (segment.knots, segment.times, segment.velocities) = (cut.0, Some(cut.1), Some(cut.2));
    }
}

#[test]
fn planned_paths_are_proved_whole_and_in_short_pieces() {
    let packages = common::published_models("planned_paths_are_proved_whole_and_in_short_pieces (published scenes)");
    let mut scenes = vec!["demo", "stack", "drawer"];
    if packages.is_some() {
        scenes.extend(["baxter-case1", "panda-shelf", "ur3-spheres"]);
    }
    let packages = packages.unwrap_or_else(|| PackagePath::only(&[]));
    let folder = Folder::new();
    for name in scenes {
        let scene = Scene::load(name, &packages).unwrap();
        let planner = Planner::new(scene.problem.clone()).unwrap().seed(1);
        let solution = planner.solve().unwrap();
        let out = folder.path.join(format!("{name}.json"));
        let mut file = written(&scene, &solution.model.graph, &solution.path, &out);
        let (report, whole) = prove(&file, &folder.path, &packages);
        assert_eq!(report.verdict(), Verdict::Proved, "{name}: {:#?}", report.violations);
        assert!(report.duration.is_some(), "{name} has no times");
        let (knots, most) = (report.counts.knots, report.max_acceleration.unwrap().value);
        cut(&mut file, 30);
        let (report, pieces) = prove(&file, &folder.path, &packages);
        assert_eq!(report.verdict(), Verdict::Proved, "{name} in short pieces: {:#?}", report.violations);
        assert!((report.max_acceleration.unwrap().value - most).abs() < 1e-6, "{name}");
        println!("{name}: {knots} knots, {whole:.3} s; {} knots, {pieces:.3} s", report.counts.knots);
    }
}

#[test]
fn solved_scenes_with_times_are_proved() {
    let packages = common::published_models("solved_scenes_with_times_are_proved (published scenes)");
    let mut scenes = vec!["demo", "stack", "drawer"];
    if packages.is_some() {
        scenes.extend([
            "baxter-case1",
            "panda-shelf",
            "ur3-spheres",
            "pr2-manipulation-two-hand",
            "talos-pass-box",
            "pyrene-on-the-ground",
            "construction-set",
        ]);
    }
    let packages = packages.unwrap_or_else(|| PackagePath::only(&[]));
    let folder = Folder::new();
    for name in scenes {
        let scene = Scene::load(name, &packages).unwrap();
        let planner = Planner::new(scene.problem.clone()).unwrap().seed(1).first_path();
        let solution = planner.solve().unwrap();
        let out = folder.path.join(format!("{name}.json"));
        let write =
            |path: &foliate::components::path::ManipulationPath| written(&scene, &solution.model.graph, path, &out);
        let mut bare = solution.path.clone();
        let (report, before) = prove(&write(&bare), &folder.path, &packages);
        assert_eq!(report.verdict(), Verdict::Proved, "{name} without times: {:#?}", report.violations);
        stand_still_at_events(&mut bare);
        rest_to_rest(&scene.problem, &mut bare);
        let file = write(&bare);
        save::save(&file, &out).unwrap();
        let read = save::read(&out).unwrap();
        assert_eq!(read, file, "{name}");
        let (report, with) = prove(&read, &folder.path, &packages);
        assert_eq!(report.verdict(), Verdict::Proved, "{name}: {:#?}", report.violations);
        println!("{name}: {} knots, {before:.3} s without times, {with:.3} s with", report.counts.knots);
        assert!(read.certificate.max_velocity.unwrap() <= 1.0 + 1e-9);
        if !["demo", "drawer", "panda-shelf", "baxter-case1"].contains(&name) {
            continue; // roots with quaternions, and closed chains, are not cut by their numbers
        }
        let mut fine = read;
        cut(&mut fine, 60);
        let (report, with) = prove(&fine, &folder.path, &packages);
        assert_eq!(report.verdict(), Verdict::Proved, "{name} in short pieces: {:#?}", report.violations);
        println!("{name}: {} knots, {with:.3} s", report.counts.knots);
    }
}
