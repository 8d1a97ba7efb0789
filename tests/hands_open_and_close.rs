//! Promise: fingers are no joints to be searched. A hand opens beside an object, closes on it until it nearly touches, holds it with
//! fingers that stand still, and opens where it lets go; the robot stands still meanwhile. Start and goals may have hands open as far as
//! they like. `foliate check` proves all of it.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "a test that cannot go on says so")]
#![allow(non_snake_case, reason = "pose names carry their frames")]

#[path = "common/written.rs"]
mod written;

use foliate::check::{CheckOptions, CheckReport, check_problem};
use foliate::components::Pose;
use foliate::components::graph::{ConstraintKind, Opening};
use foliate::components::infeasibility::Infeasibility;
use foliate::components::path::{Attachment, ManipulationPath};
use foliate::components::problem::{Goal, Problem};
use foliate::components::robot::Source;
use foliate::path_file::PathFile;
use foliate::scene::{PackagePath, Scene};
use foliate::systems::settings::SearchSettings;
use foliate::{NoSolutionReason, Planner};
use serde_json::Value;
use std::path::{Path, PathBuf};
use written::written;

/// Half of the width of a box of the demo, metres.
const HALF_WIDTH: f64 = 0.025;
/// How far fingers stay off what they hold, metres.
const GAP: f64 = 2e-4;
/// Wide open, metres.
const WIDE: f64 = 0.04;
const JOINTS: [&str; 2] = ["robot/left_finger", "robot/right_finger"];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/demo")
}

/// The demo without locked fingers. `start` is added to the start's table, `goal` to the goal's, `graph` to the graph's.
fn demo(start: &str, goal: &str, graph: &str) -> Result<Scene, String> {
    let text = std::fs::read_to_string(folder().join("scene.toml")).unwrap();
    let (head, rest) = text.split_once("[locked]").unwrap();
    let (_, tail) = rest.split_once("[start]").unwrap();
    let text = format!("{head}{graph}\n[start]\n{start}{tail}");
    let text = text.replace("configuration = {", &format!("configuration = {{ {goal}"));
    Scene::from_text("demo", &text, &folder(), &PackagePath::default()).map_err(|error| error.to_string())
}

fn coordinate(scene: &Scene, joint: &str) -> usize {
    let joint = scene.problem.robot.joint(joint).unwrap();
    let Source::Coordinates { q, .. } = scene.problem.robot.joints[joint.at()].source else { panic!("it follows") };
    q
}

fn checked(scene: &Scene, file: &PathFile) -> CheckReport {
    let options = CheckOptions::default();
    check_problem(file, &folder(), &PackagePath::default(), &options, &scene.problem).unwrap()
}

/// The path with times, and its file as a value.
fn solved(scene: &Scene, seed: u64, threads: usize) -> (ManipulationPath, Value) {
    let planner = Planner::new(scene.problem.clone()).unwrap().seed(seed).improve_work(500);
    let solution = planner.solve_on(threads).unwrap();
    let file = written(scene, &solution.model.graph, &solution.path, &folder().join("path.json"));
    let report = checked(scene, &file);
    assert!(report.passed(), "seed {seed}: {:#?}", report.violations);
    (solution.path, serde_json::to_value(&file).unwrap())
}

/// Which of the two hands hold something along a segment.
fn holds(scene: &Scene, path: &ManipulationPath, segment: usize) -> [bool; 2] {
    let robot = &scene.problem.robot;
    let of = |side: &str| {
        path.segments[segment].attachments.iter().any(|attachment| match attachment {
            Attachment::Grasp { gripper, .. } => robot.grippers[gripper.at()].name.contains(side),
            _ => false,
        })
    };
    [of("left"), of("right")]
}

/// What a path must keep, whatever it does; returns how often fingers close and open.
fn hands_do_as_they_should(scene: &Scene, path: &ManipulationPath, travel: [f64; 2]) -> (usize, usize) {
    let fingers = JOINTS.map(|joint| coordinate(scene, joint));
    let objects = |i: usize| scene.problem.robot.space.size() - 14 <= i;
    let (mut closed, mut opened) = (0, 0);
    for (number, segment) in path.segments.iter().enumerate() {
        let (first, last) = (&segment.knots[0], segment.knots.last().unwrap());
        let moved: Vec<usize> =
            (0..first.len()).filter(|&i| segment.knots.iter().any(|knot| knot[i] != first[i])).collect();
        let moves_fingers = moved.iter().any(|i| fingers.contains(i));
        assert!(!moves_fingers || moved.iter().all(|&i| fingers.contains(&i) || objects(i)), "segment {number}");
        let held = holds(scene, path, number);
        for hand in 0..2 {
            let [from, to] = [first, last].map(|q| q[fingers[hand]]);
            if from == to && held[hand] {
                assert!((from - HALF_WIDTH - GAP).abs() < 1e-6, "segment {number} holds at {from}");
            } else if from == to {
                assert!(from == travel[hand] || from == WIDE, "segment {number} travels at {from}");
            }
            closed += usize::from(held[hand] && to < from);
            opened += usize::from(held[hand] && to > from);
        }
    }
    (closed, opened)
}

#[test]
fn fingers_move_alone_close_until_they_nearly_touch_and_open_again() {
    let scene = demo("", "", "").unwrap();
    let ready = scene.problem.start[coordinate(&scene, JOINTS[0])];
    for seed in 1..=3 {
        let (path, file) = solved(&scene, seed, 2);
        let (closed, opened) = hands_do_as_they_should(&scene, &path, [ready; 2]);
        assert!(closed >= 2 && closed == opened, "{closed} closings, {opened} openings");
        // Events say how far fingers have moved when the hand has closed or opened.
        for event in file["events"].as_array().unwrap() {
            let position = event["fingers"].as_object().unwrap().values().next().unwrap().as_f64().unwrap();
            let wanted = if event["kind"] == "grasp" { HALF_WIDTH + GAP } else { WIDE };
            assert!((position - wanted).abs() < 1e-6, "{event}");
        }
        if seed == 1 {
            assert_eq!(file, solved(&scene, seed, 1).1, "the same on one thread");
        }
    }
}

#[cfg(feature = "view")]
#[test]
fn pages_say_when_hands_close_and_when_they_open() {
    use foliate::view::{ViewOptions, Visuals, page_of_solution};
    let scene = demo("", "", "").unwrap();
    let solution = Planner::new(scene.problem.clone()).unwrap().seed(1).improve_work(500).solve_on(1).unwrap();
    let visuals = Visuals::of_scene(&scene, &PackagePath::default()).unwrap();
    let page = page_of_solution(&solution, &visuals, &ViewOptions::default()).unwrap();
    let words: Vec<String> = page.document.path.unwrap().segments.into_iter().map(|segment| segment.words).collect();
    let count = |verb: &str| words.iter().filter(|words| words.contains(verb)).count();
    let (closed, opened) = (count(" closes on "), count(" opens to let go of "));
    assert!(closed >= 2 && closed == opened, "{words:#?}");
}

#[test]
fn start_and_goal_may_have_hands_open_as_far_as_they_like() {
    let start = "\"robot/left_finger\" = 0.005\n";
    let scene = demo(start, "\"robot/left_finger\" = 0.02, \"robot/right_finger\" = 0.0, ", "").unwrap();
    let (path, _) = solved(&scene, 1, 2);
    let fingers = JOINTS.map(|joint| coordinate(&scene, joint));
    let at = |knot: &[f64]| fingers.map(|i| knot[i]);
    let ready = scene.problem.start[fingers[1]];
    assert_eq!(at(&path.segments[0].knots[0]), [0.005, ready]);
    assert_eq!(at(path.segments.last().unwrap().knots.last().unwrap()), [0.02, 0.0]);
    // The last segment takes the goal's fingers, of both hands.
    assert_eq!(at(&path.segments.last().unwrap().knots[0]), [0.005, ready]);
}

#[test]
fn fingers_that_cannot_open_at_the_start_are_told() {
    // A post beside each open finger: shut it is free, and the hand cannot travel wide open.
    let graph = "hands = { \"robot/left_hand\" = { fingers = { \"robot/left_finger\" = { open = 0.04, closed = 0.0, travel = 0.04 } } } }\n";
    let mut scene = demo("\"robot/left_finger\" = 0.005\n", "", graph).unwrap();
    let planner = Planner::new(scene.problem.clone()).unwrap().first_path();
    assert!(planner.solve().is_ok(), "without a post it is solved");
    // The box stands between the open finger and where it is shut.
    let finger = {
        let robot = &scene.problem.robot;
        let kinematics = foliate::kernels::kinematics::Kinematics::new(robot);
        let mut X_WJ = vec![foliate::components::Pose::IDENTITY; kinematics.bodies()];
        kinematics.forward(&scene.problem.start, &mut X_WJ);
        X_WJ[robot.joint(JOINTS[0]).unwrap().at()]
    };
    // The finger's box is 12 mm thick, and moves along y by 35 mm: a box of 50 mm whose face is 20 mm beyond it is in the way.
    let middle = finger.transform_point(glam::DVec3::new(0.05, 0.012 + 0.02 + HALF_WIDTH, 0.0));
    let first = coordinate(&scene, "box1/root_joint");
    scene.problem.start[first..first + 3].copy_from_slice(&middle.to_array());
    let turn = finger.rotation;
    scene.problem.start[first + 3..first + 7].copy_from_slice(&turn.to_array());
    scene.problem.graph.objects[0].surfaces.clear();
    let reason = Planner::new(scene.problem.clone()).unwrap().first_path().solve().unwrap_err().reason;
    let NoSolutionReason::InfeasibleStart(Infeasibility::FingersBlocked { by }) = reason else {
        panic!("{reason:?}");
    };
    assert!(by.unwrap().1.contains("box1"));
}

#[test]
fn locked_fingers_and_planned_ones_are_joints_as_any() {
    let locked = Scene::load("demo", &PackagePath::default()).unwrap();
    let planned =
        demo("", "", "hands = { \"robot/left_hand\" = \"planned\", \"robot/right_hand\" = \"planned\" }").unwrap();
    for scene in [locked, planned] {
        let planner = Planner::new(scene.problem).unwrap();
        let graph = &planner.model().graph;
        assert!(graph.states.iter().all(|state| !state.is_passed_through()));
        assert!(graph.constraints.iter().all(|c| !matches!(c.kind, ConstraintKind::Finger { .. })));
    }
}

#[test]
fn a_hand_that_is_described_is_as_it_is_described() {
    let described = "hands = { \"robot/left_hand\" = { fingers = { \"robot/left_finger\" = { open = 0.03, closed = 0.01, travel = 0.028 } } } }";
    let scene = demo("", "", described).unwrap();
    let planner = Planner::new(scene.problem.clone()).unwrap();
    let hands = &planner.model().problem.graph.hands;
    assert_eq!(hands.len(), 2);
    let finger = hands[0].fingers[0];
    assert_eq!((finger.open, finger.closed, finger.travel), (0.03, 0.01, Some(0.028)));
    // The other one is found.
    let found = hands[1].fingers[0];
    assert_eq!((found.open, found.closed), (WIDE, 0.0));
}

/// Two grippers on one palm, of which the scene describes one: their fingers are the same, and have one opening at a time.
#[test]
fn grippers_on_one_palm_are_one_hand() {
    let described = "hands = { \"robot/left_hand\" = { fingers = { \"robot/left_finger\" = { open = 0.04, closed = 0.0, travel = 0.03 } } } }";
    let text = std::fs::read_to_string(folder().join("scene.toml")).unwrap();
    let (head, rest) = text.split_once("[locked]").unwrap();
    let second = "srdf = \"robot.srdf\"\n[[part.gripper]]\nname = \"fingertips\"\nlink = \"left_palm\"\npose = { xyz = [0.145, 0.0, 0.0] }\nclearance = 0.05\n";
    let head = head.replacen("srdf = \"robot.srdf\"", second, 1).replacen(
        "grippers = [",
        "grippers = [\"robot/fingertips\", ",
        1,
    );
    let text = format!("{head}{described}\n[start]{}", rest.split_once("[start]").unwrap().1);
    let scene = Scene::from_text("demo", &text, &folder(), &PackagePath::default()).unwrap();
    let planner = Planner::new(scene.problem.clone()).unwrap();
    let hands = &planner.model().problem.graph.hands;
    let names =
        |hand: usize| hands[hand].grippers.iter().map(|g| scene.problem.robot.grippers[g.0 as usize].name.as_str());
    assert_eq!(hands.len(), 2);
    assert_eq!(names(0).collect::<Vec<_>>(), ["robot/left_hand", "robot/fingertips"]);
    // Either may pick up both boxes.
    let (path, _) = solved(&scene, 1, 1);
    assert!(!path.segments.is_empty());
}

/// The demo with a post on either side of the first box: 22 mm from it, 2 mm less than a finger and half a wide hand need.
fn between_posts(graph: &str) -> Scene {
    let text = std::fs::read_to_string(folder().join("scene.toml")).unwrap();
    let (head, rest) = text.split_once("[locked]").unwrap();
    let (_, tail) = rest.split_once("[start]").unwrap();
    let post = |name: &str, y: f64| {
        let pose = format!("pose = {{ xyz = [0.5, {y}, 0.741] }}");
        format!("[[part]]\nname = \"{name}\"\nkind = \"environment\"\nurdf = \"box.urdf\"\n{pose}\n\n")
    };
    let posts = post("post1", 0.1 - 0.072) + &post("post2", 0.1 + 0.072);
    let head = head.replacen("[graph]", &format!("{posts}[graph]"), 1);
    let tail = tail.replace("box2 = { xyz = [0.50, 0.10, 0.741] }", "box2 = { xyz = [0.50, -0.10, 0.741] }");
    let tail =
        tail.replace("box1 = { xyz = [0.50, -0.10, 0.741] }, box2", "box1 = { xyz = [0.50, -0.25, 0.741] }, box2");
    let text = format!("{head}{graph}\n[start]\n{tail}");
    Scene::from_text("demo", &text, &folder(), &PackagePath::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn between_posts_a_hand_fits_that_opens_only_as_far_as_it_needs() {
    let wide = between_posts("approach = \"wide\"");
    let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (1, 150));
    let answer = Planner::new(wide.problem).unwrap().settings(settings).first_path().solve();
    assert!(matches!(answer.unwrap_err().reason, NoSolutionReason::StepLimit));
    let scene = between_posts("approach = \"as-needed\"");
    for seed in 1..=3 {
        let (path, _) = solved(&scene, seed, 2);
        let needed = HALF_WIDTH + 0.005;
        let fingers = JOINTS.map(|joint| coordinate(&scene, joint));
        // Where it has opened to approach, and where it has let go.
        let closing = |number: &usize| {
            let (first, last) = (&path.segments[*number].knots[0], path.segments[*number].knots.last().unwrap());
            fingers.iter().any(|&i| (last[i] - HALF_WIDTH - GAP).abs() < 1e-6 && (first[i] - needed).abs() < 1e-5)
        };
        assert!((0..path.segments.len()).any(|number| closing(&number)), "seed {seed}");
        let widest = path.segments.iter().flat_map(|segment| &segment.knots).flat_map(|q| fingers.map(|i| q[i]));
        let ready = scene.problem.start[fingers[0]];
        assert!(widest.fold(0.0, f64::max) <= ready.max(needed + 1e-5), "seed {seed}");
    }
    // The clearance is the scene's.
    let scene = between_posts("approach = \"as-needed\"\napproach_clearance = 0.002");
    let planner = Planner::new(scene.problem.clone()).unwrap();
    let robot = &scene.problem.robot;
    let (gripper, handle) = (robot.gripper("robot/left_hand").unwrap(), robot.handle("box1/top").unwrap());
    let ready = planner.model().finger_value(0, 0, Opening::Ready { gripper, handle }).unwrap();
    assert!((ready - HALF_WIDTH - 0.002).abs() < 1e-5, "{ready}");
}

#[test]
fn every_finger_closes_until_its_own_contact() {
    // Two fingers that do not mimic each other, and a handle 6 mm beside the middle of the box.
    let own = std::env::temp_dir().join(format!("foliate-fingers-{}", std::process::id()));
    std::fs::create_dir_all(&own).unwrap();
    for file in ["robot.urdf", "robot.srdf", "box.urdf", "box.srdf", "table.urdf", "table.srdf"] {
        let text = std::fs::read_to_string(folder().join(file)).unwrap();
        let text = text.replace("    <mimic joint=\"left_finger\" multiplier=\"1\" offset=\"0\"/>\n", "");
        let text = text.replace("<position xyz=\"0 0 0.02\"", "<position xyz=\"0 0.006 0.02\"");
        std::fs::write(own.join(file), text).unwrap();
    }
    let text = std::fs::read_to_string(folder().join("scene.toml")).unwrap();
    let (head, rest) = text.split_once("[locked]").unwrap();
    let text = format!("{head}[start]{}", rest.split_once("[start]").unwrap().1);
    let scene = Scene::from_text("demo", &text, &own, &PackagePath::default()).unwrap();
    let planner = Planner::new(scene.problem.clone()).unwrap();
    let (model, robot) = (planner.model(), &scene.problem.robot);
    let (gripper, handle) = (robot.gripper("robot/left_hand").unwrap(), robot.handle("box1/top").unwrap());
    let hand = model.problem.graph.hands.iter().position(|hand| hand.grippers.contains(&gripper)).unwrap() as u32;
    let closed = [0, 1].map(|finger| model.finger_value(hand, finger, Opening::Closed { gripper, handle }).unwrap());
    let wanted = [HALF_WIDTH - 0.006 + GAP, HALF_WIDTH + 0.006 + GAP];
    let off = |wanted: [f64; 2]| closed.iter().zip(wanted).map(|(at, wanted)| (at - wanted).abs()).fold(0.0, f64::max);
    // Which side is which does not matter here.
    assert!(off(wanted).min(off([wanted[1], wanted[0]])) < 1e-5, "{closed:?}");
    // The other hand's finger has one that follows it: both stop where the first does.
    let gripper = robot.gripper("robot/right_hand").unwrap();
    let hand = model.problem.graph.hands.iter().position(|hand| hand.grippers.contains(&gripper)).unwrap() as u32;
    let coupled = model.finger_value(hand, 0, Opening::Closed { gripper, handle }).unwrap();
    assert!((coupled - wanted[1]).abs() < 1e-5, "{coupled}");
    let solution = planner.seed(1).first_path().solve().unwrap();
    let file = written(&scene, &solution.model.graph, &solution.path, &own.join("path.json"));
    let options = CheckOptions::default();
    let report = check_problem(&file, &own, &PackagePath::default(), &options, &scene.problem).unwrap();
    assert!(report.passed(), "{:#?}", report.violations);
    let _gone = std::fs::remove_dir_all(&own);
}

#[test]
fn mistakes_are_told() {
    let graph = |text: &str| demo("", "", text).unwrap_err();
    assert!(graph("approach = \"narrow\"").contains("wide, as-needed"));
    assert!(graph("approach_clearance = 0.001").contains("no meaning"));
    assert!(graph("approach = \"as-needed\"\napproach_clearance = -0.001").contains("approach_clearance"));
    let hand = |text: &str| demo("", "", &format!("hands = {{ \"robot/left_hand\" = {text} }}")).unwrap_err();
    let finger = |name: &str, values: &str| hand(&format!("{{ fingers = {{ \"{name}\" = {{ {values} }} }} }}"));
    assert!(hand("\"plan\"").contains("planned"));
    assert!(hand("{ fingers = {} }").contains("names no finger"));
    assert!(finger("robot/left_fingr", "open = 0.03, closed = 0.0").contains("did you mean `robot/left_finger`?"));
    assert!(finger("robot/left_finger", "open = 0.05, closed = 0.0").contains("outside the bounds"));
    assert!(finger("robot/left_finger", "open = 0.03, closed = 0.03").contains("as far open as closed"));
    assert!(finger("robot/left_finger", "open = 0.03").contains("closed"));
}

#[test]
fn a_path_whose_fingers_move_while_it_carries_is_refused() {
    let scene = demo("", "", "").unwrap();
    let (path, honest) = solved(&scene, 1, 2);
    let carrying = (0..path.segments.len()).find(|&number| {
        let (first, last) = (&path.segments[number].knots[0], path.segments[number].knots.last().unwrap());
        let arm = coordinate(&scene, "robot/left_elbow_pitch");
        let right = coordinate(&scene, "robot/right_elbow_pitch");
        holds(&scene, &path, number).contains(&true) && (first[arm] != last[arm] || first[right] != last[right])
    });
    let carrying = carrying.unwrap();
    let hand = usize::from(!holds(&scene, &path, carrying)[0]);
    let column = coordinate(&scene, JOINTS[hand]);
    let mut lie = honest;
    // The hand opens a little in the middle of the way, and the file does not say that it should not.
    let segment = &mut lie["segments"][carrying];
    segment["constraints"] = Value::Array(Vec::new());
    let middle = segment["knots"].as_array().unwrap().len() / 2;
    let number = segment["knots"][middle][column].as_f64().unwrap();
    segment["knots"][middle][column] = Value::from(number + 0.005);
    let report = checked(&scene, &serde_json::from_value(lie).unwrap());
    let told = |what: &str| report.violations.iter().any(|violation| violation.subject.contains(what));
    assert!(told("while it holds something"), "{:#?}", report.violations);
}

#[test]
fn a_goal_that_leaves_the_arms_free_may_name_fingers() {
    let mut scene = demo("", "", "").unwrap();
    let place = |problem: &Problem, name: &str| {
        let first = problem.robot.joint(name).map(|joint| problem.robot.joints[joint.at()].source).unwrap();
        let Source::Coordinates { q, .. } = first else { panic!("it follows") };
        let Goal::Configuration(goal) = &problem.goals[0] else { panic!("a whole goal") };
        Pose::from_translation(glam::DVec3::from_slice(&goal[q..q + 3]))
    };
    let [one, other] = ["box1/root_joint", "box2/root_joint"].map(|name| place(&scene.problem, name));
    let wanted = [("box1", one.into()), ("box2", other.into()), (JOINTS[1], 0.01.into())];
    scene.problem.goals = vec![scene.problem.partial_goal(wanted).unwrap()];
    let finger = coordinate(&scene, JOINTS[1]);
    for scheduler in ["sequence", "portfolio"] {
        let planner = Planner::new(scene.problem.clone()).unwrap().scheduler_named(scheduler).unwrap().first_path();
        let solution = planner.solve_on(2).unwrap();
        let file = written(&scene, &solution.model.graph, &solution.path, &folder().join("path.json"));
        let report = checked(&scene, &file);
        assert!(report.passed(), "{scheduler}: {:#?}", report.violations);
        assert_eq!(solution.path.segments.last().unwrap().knots.last().unwrap()[finger], 0.01, "{scheduler}");
    }
}
