//! Promise: where a scene asks for it a gripper goes from its pregrasp to a grasp along a line, and backs off along it, as straight as the
//! scene says. The check proves it, and refuses a path that does not.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/demo.rs"]
mod demo;

use demo::{Demo, SCENE, solve};
use foliate::check::Kind;
use foliate::scene::Scene;
use foliate::systems::settings::SearchSettings;
use foliate::{Planner, Solution};
use glam::DVec3;

/// Metres and radians.
const DISTANCE: f64 = 0.003;
const ANGLE: f64 = 0.05;

fn straight(scene: &str) -> String {
    let line = format!("placement_margin = 0.001\napproach_line = {{ distance = {DISTANCE}, angle = {ANGLE} }}");
    scene.replacen("placement_margin = 0.001", &line, 1)
}

/// The demo with fingers that open and close.
fn with_fingers() -> String {
    let (before, rest) = SCENE.split_once("[locked]").unwrap();
    format!("{before}[start]{}", rest.split_once("[start]").unwrap().1)
}

fn timed(scene: &Scene, seed: u64) -> Solution {
    let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (seed, 2000));
    let planner = Planner::new(scene.problem.clone()).unwrap().settings(settings);
    planner.improve_work(100).solve().unwrap_or_else(|e| panic!("seed {seed}: {e}"))
}

/// How far grippers are off the line and turned, at most, on the last motion of an arm before each grasp and the first one after it.
fn off_line(solution: &Solution) -> (f64, f64, usize) {
    let trajectory = solution.trajectory().expect("times");
    let robot = trajectory.robot();
    let segments = trajectory.segments();
    let (mut distance, mut angle, mut ways) = (0.0_f64, 0.0_f64, 0);
    let mut poses = trajectory.poses();
    for (index, segment) in segments.iter().enumerate() {
        let beside = [index.checked_sub(1), Some(index + 1)];
        let beside = beside.into_iter().flatten().filter_map(|other| segments.get(other));
        let held: Vec<_> = beside.flat_map(|other| &other.held).filter(|held| !segment.held.contains(held)).collect();
        for held in held {
            let gripper = &robot.grippers[robot.gripper(held.gripper).unwrap().0 as usize];
            let handle = &robot.handles[robot.handle(held.handle).unwrap().0 as usize];
            ways += 1;
            for part in 0..=100 {
                let share = f64::from(part) / 100.0 * (1.0 - 1e-9);
                poses.place(segment.start + share * (segment.end - segment.start));
                let hand = poses.link(gripper.link) * gripper.link_from_gripper;
                let place = poses.link(handle.link) * handle.link_from_handle;
                let off = (place.inverse() * hand).translation;
                distance = distance.max(off.y.hypot(off.z));
                angle = angle.max((hand.rotation * DVec3::X).angle_between(place.rotation * DVec3::X));
            }
        }
    }
    (distance, angle, ways)
}

#[test]
fn hands_approach_and_back_off_on_a_line() {
    let demo = Demo::new("straight");
    // A pregrasp 15 cm off: the farther, the more hands swing.
    let far = include_str!("../scenes/demo/box.srdf").replace("clearance=\"0.04\"", "clearance=\"0.11\"");
    demo.write("box.srdf", &far);
    for scene in [SCENE.to_owned(), with_fingers()] {
        let (free, lined) = (demo.scene(&scene), demo.scene(&straight(&scene)));
        let mut swing = (0.0_f64, 0.0_f64);
        for seed in 1..=4 {
            let unbound = timed(&free, seed);
            let found = off_line(&unbound);
            swing = (swing.0.max(found.0), swing.1.max(found.1));
            let solution = timed(&lined, seed);
            let (distance, angle, ways) = off_line(&solution);
            println!("seed {seed}: free {found:?}, on the line {:?}", (distance, angle, ways));
            assert!(ways >= 4, "two boxes are taken and put down: {ways}");
            // Both directions across the line, and the path tolerance.
            assert!(distance <= DISTANCE * 2.0_f64.sqrt() + 4e-4 && angle <= ANGLE + 4e-4, "{distance} {angle}");
            let path = demo.path(&lined, &solution);
            let report = demo.check(&path);
            assert!(report.passed(), "seed {seed}: {:?}", report.violations);
            let first = demo.path(&lined, &solve(&lined.problem, seed).unwrap());
            let report = demo.check(&first);
            assert!(report.passed(), "seed {seed}, without times: {:?}", report.violations);
            // A path that knows of no line does not say that it keeps to one.
            let refused = demo.against(&demo.path(&free, &unbound), &lined.problem).violations;
            let told = |v: &&foliate::check::Violation| v.kind == Kind::Demand && v.subject.contains("the line from");
            assert!(refused.iter().any(|v| told(&v)), "{refused:?}");
        }
        println!("free at most {swing:?}");
        assert!(swing.0 > 2.0 * DISTANCE, "hands go straight anyway: {swing:?}");
    }
}

/// What is said of a handle counts before what is said of a gripper, and that before what is said of all.
#[test]
fn handles_and_grippers_may_have_lines_of_their_own() {
    let demo = Demo::new("straight-own");
    let with = |lines: &str| {
        straight(SCENE).replacen("approach_line =", &format!("approach_lines = {{ {lines} }}\napproach_line ="), 1)
    };
    let scene = demo.scene(&with("\"robot/left_hand\" = \"free\", \"box2/top\" = { distance = 0.002, angle = 0.04 }"));
    let options = &scene.problem.graph;
    let [left, right] = ["robot/left_hand", "robot/right_hand"].map(|name| scene.problem.robot.gripper(name).unwrap());
    let [one, two] = ["box1/top", "box2/top"].map(|name| scene.problem.robot.handle(name).unwrap());
    let asked = |gripper, handle| options.line_to(gripper, handle).map(|line| line.distance);
    assert_eq!([asked(left, one), asked(right, one)], [None, Some(DISTANCE)]);
    assert_eq!([asked(left, two), asked(right, two)], [Some(0.002); 2]);
    for seed in 1..=3 {
        let file = demo.path(&scene, &solve(&scene.problem, seed).unwrap());
        let report = demo.check(&file);
        assert!(report.passed(), "seed {seed}: {:?}", report.violations);
        let lines = file.segments.iter().filter(|s| s.state.contains("is on the line to"));
        assert!(lines.clone().all(|s| !s.state.contains("left_hand is on the line to box1")), "seed {seed}");
        assert!(lines.count() >= 2, "seed {seed}");
    }
    let error = demo.try_scene(&with("\"robot/left\" = \"free\"")).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("no gripper and no handle of this name") && error.contains("robot/left_hand"), "{error}");
    let error = demo.try_scene(&with("\"box1/top\" = \"straight\"")).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("box1/top"), "{error}");
}

/// The segment before a grasp is cut where the hand is half as far: what comes before need not be straight.
#[test]
fn a_line_that_begins_too_near_is_refused() {
    let demo = Demo::new("straight-near");
    let scene = demo.scene(&straight(SCENE));
    let file = demo.path(&scene, &solve(&scene.problem, 1).unwrap());
    assert!(demo.check(&file).passed());
    let mut near = file.clone();
    let grasp = near.segments.iter().position(|s| s.attachments.iter().any(|a| a.gripper.is_some())).unwrap();
    let knots = near.segments[grasp - 1].knots.clone();
    let middle: Vec<f64> = match knots.len() {
        2 => knots[0].iter().zip(&knots[1]).map(|(a, b)| 0.5 * (a + b)).collect(),
        many => knots[many / 2].clone(),
    };
    let cut = if knots.len() == 2 { 1 } else { knots.len() / 2 };
    near.segments[grasp - 1].knots = std::iter::once(middle.clone()).chain(knots[cut..].to_vec()).collect();
    near.segments[grasp - 2].knots.extend(knots[1..cut].to_vec());
    near.segments[grasp - 2].knots.push(middle);
    let told: Vec<_> = demo.check(&near).violations.iter().map(|v| v.subject.clone()).collect();
    assert!(told.iter().any(|t| t.contains("is nearer to box") && t.contains("than the pregrasp")), "{told:?}");
}

#[test]
fn a_line_that_no_motion_keeps_is_refused() {
    let demo = Demo::new("straight-wrong");
    let refused = |before: &str, after: &str| {
        let text = straight(SCENE);
        assert!(text.contains(before));
        demo.try_scene(&text.replacen(before, after, 1)).map(|_| ()).expect_err(after).to_string()
    };
    assert!(refused("distance = 0.003", "distance = 0.0001").contains("motions are not that exact"));
    assert!(refused("angle = 0.05", "angle = 0.001").contains("is not between 0.01 radians"));
    assert!(refused(", angle = 0.05", "").contains("key `angle` is missing"));
}
