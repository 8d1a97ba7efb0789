//! Promise: a start or a goal within `start_tolerance` of a state is moved onto the nearest one, over all that may be held or lie;
//! the correction is said, kept in the path file, and the check accepts it only where the file says so. What is farther off is refused
//! with the nearest state in words, how far it is, and the pose that would be right.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/demo.rs"]
mod demo;

use demo::{Demo, SCENE, first_of, solve};
use foliate::check::{CheckReport, Kind};
use foliate::components::path::Attachment;
use foliate::components::problem::{Correction, Goal, Moved, StartTolerance};
use foliate::scene::Scene;

const BOX_1: &str = "box1 = { xyz = [0.50, 0.10, 0.741] }\nbox2";

/// The demo with the first box elsewhere at the start.
fn with_box_1(pose: &str) -> String {
    let text = SCENE.replace(BOX_1, &format!("box1 = {{ {pose} }}\nbox2"));
    assert_ne!(text, SCENE);
    text
}

/// The demo with a line before its parts.
fn with_key(text: &str, line: &str) -> String {
    text.replacen("[[part]]", &format!("{line}\n\n[[part]]"), 1)
}

fn has(report: &CheckReport, kind: Kind) -> bool {
    report.violations.iter().any(|violation| violation.kind == kind)
}

fn proved(report: &CheckReport) {
    assert!(report.passed(), "{:?}", report.violations);
}

#[test]
fn a_box_above_the_table_is_put_down_and_this_is_said() {
    let demo = Demo::new("start-above");
    let scene = demo.scene(&with_box_1("xyz = [0.50, 0.10, 0.7445], rpy = [0.02, 0.0, 0.3]"));
    let solution = solve(&scene.problem, 1).unwrap();
    let [correction] = &solution.report.snapped[..] else { panic!("{:?}", solution.report.snapped) };
    assert_eq!((correction.goal, correction.name.as_str()), (None, "box1"));
    assert_eq!(correction.onto, "it lies on table/top");
    assert!((correction.angle - 0.02).abs() < 1e-6, "{correction:?}");
    let told = correction.to_string();
    assert!(
        told.starts_with("the start has `box1` 3.") && told.contains("mm and 1.15 degrees from where it lies"),
        "{told}"
    );
    // The path begins where it lies: the joints where they were.
    let at = first_of(&scene, "box1");
    let first = &solution.path.segments[0].knots[0];
    assert!((first[at + 2] - 0.741).abs() < 1e-6, "{:?}", &first[at..at + 7]);
    assert_eq!(first[..at], scene.problem.start[..at]);
    // The file says so; with that, and not without, it is proved.
    let mut file = demo.path(&scene, &solution);
    assert_eq!(file.corrections.len(), 1);
    let report = demo.check(&file);
    proved(&report);
    assert!(report.notes.iter().any(|note| note.contains("of the start the path has moved onto its state: box1 by")));
    let said = std::mem::take(&mut file.corrections);
    assert!(has(&demo.check(&file), Kind::Start), "the file does not say so");
    file.corrections = said.clone();
    file.corrections[0].distance = 0.001;
    assert!(has(&demo.check(&file), Kind::Start), "it was moved by more");
    file.corrections = said;
    file.corrections[0].object = Some("box2".into());
    assert!(has(&demo.check(&file), Kind::Start), "another one was moved");
}

#[test]
fn the_scene_says_how_much_may_be_moved() {
    let demo = Demo::new("start-tolerance");
    let text = with_box_1("xyz = [0.50, 0.10, 0.744]");
    let file = {
        let scene = demo.scene(&text);
        demo.path(&scene, &solve(&scene.problem, 1).unwrap())
    };
    let narrow = demo.scene(&with_key(&text, "start_tolerance = { distance = 0.002 }"));
    assert_eq!(narrow.problem.start_tolerance, StartTolerance { distance: 0.002, ..StartTolerance::default() });
    assert!(has(&demo.against(&file, &narrow.problem), Kind::Start), "3 mm are more than 2 mm");
    let refused = solve(&narrow.problem, 1).unwrap_err().to_string();
    assert!(refused.contains("`start_tolerance` moves at most 2 mm and 2 degrees"), "{refused}");
    let wide = demo.scene(&with_key(
        &with_box_1("xyz = [0.50, 0.10, 0.751]"),
        "start_tolerance = { distance = 0.02, angle = 0.1 }",
    ));
    assert_eq!(solve(&wide.problem, 1).unwrap().report.snapped.len(), 1);
    let none = demo
        .scene(&with_key(&with_box_1("xyz = [0.50, 0.10, 0.7413]"), "start_tolerance = { distance = 0, angle = 0 }"));
    let refused = solve(&none.problem, 1).unwrap_err().to_string();
    assert!(refused.contains("`start_tolerance` moves nothing") && refused.contains("0.30 mm"), "{refused}");
    for (line, words) in [
        ("start_tolerance = { distance = -0.1 }", "is negative"),
        ("start_tolerance = { distance = 0.2 }", "is more than 0.05 metres"),
        ("start_tolerance = { angle = 1.0 }", "is more than 0.2 radians"),
        ("start_tolerance = { way = 0.001 }", "is no key of a scene file"),
        ("start_tolerance = 0.001", "wants a table"),
    ] {
        let error = demo.try_scene(&with_key(SCENE, line)).unwrap_err();
        assert!(error.to_string().contains(words) && error.line.is_some(), "{error}");
    }
}

/// A configuration of a path of the demo in which the left or right hand holds the first box in the air.
fn held(demo: &Demo) -> (Scene, Vec<f64>, String) {
    let scene = demo.scene(SCENE);
    let solution = solve(&scene.problem, 1).unwrap();
    let robot = &scene.problem.robot;
    let at = first_of(&scene, "box1");
    for segment in &solution.path.segments {
        for attachment in &segment.attachments {
            let Attachment::Grasp { gripper, handle, .. } = *attachment else { continue };
            let last = segment.knots.last().unwrap();
            if robot.handles[handle.0 as usize].name == "box1/top" && last[at + 2] > 0.78 {
                let hand = robot.grippers[gripper.0 as usize].name.clone();
                return (scene, last.clone(), hand);
            }
        }
    }
    panic!("no hand holds the box in the air");
}

#[test]
fn a_box_that_slipped_in_the_hand_is_in_the_hand() {
    let demo = Demo::new("start-slipped");
    let (scene, q, hand) = held(&demo);
    let at = first_of(&scene, "box1");
    let mut problem = scene.problem.clone();
    problem.start = q.clone();
    problem.start[at] += 0.003;
    let solution = solve(&problem, 1).unwrap();
    let [correction] = &solution.report.snapped[..] else { panic!("{:?}", solution.report.snapped) };
    assert_eq!(correction.onto, format!("{hand} holds box1/top"));
    assert!((correction.distance - 0.003).abs() < 1e-5, "{correction:?}");
    let first = &solution.path.segments[0].knots[0];
    assert_eq!(first[..at], q[..at], "joints are where sensors have them");
    proved(&demo.against(&demo.path(&scene, &solution), &problem));
    // Farther off: the grasp is named, not the table under it.
    problem.start[at] += 0.005;
    let refused = solve(&problem, 1).unwrap_err().to_string();
    assert!(
        refused.contains(&format!("`box1` is 8.00 mm and 0.00 degrees from where {hand} holds box1/top, at box1 = [")),
        "{refused}"
    );
    assert!(refused.contains("grasps box1/top` is off by 8.0"), "{refused}");
}

#[test]
fn what_is_too_far_is_refused_with_the_pose_that_would_be_right() {
    let demo = Demo::new("start-far");
    let far = demo.scene(&with_box_1("xyz = [0.50, 0.10, 0.761]"));
    let refused = solve(&far.problem, 1).unwrap_err().to_string();
    let words =
        "`box1` is 20.00 mm and 0.00 degrees from where it lies on table/top, at box1 = [0.5, 0.1, 0.741, 0, 0, 0, 1]";
    assert!(refused.contains(words), "{refused}");
    assert!(refused.contains("20.00 mm above where it lies on its support"), "{refused}");
    let tilted = demo.scene(&with_box_1("xyz = [0.50, 0.10, 0.741], rpy = [0.1, 0.0, 0.0]"));
    let refused = solve(&tilted.problem, 1).unwrap_err().to_string();
    assert!(refused.contains("5.73 degrees from where it lies on table/top"), "{refused}");
}

#[test]
fn a_box_over_the_edge_is_moved_aside() {
    let demo = Demo::new("start-edge");
    // Its centre of mass has to be 5 mm inside of the table, which ends at 0.6.
    // By the shortest way, so that 5 mm of tolerance are 5 mm at an edge too; over a corner, by both of its edges.
    for (at, moved) in
        [((0.50, 0.596), (0.50, 0.595)), ((0.50, 0.5998), (0.50, 0.595)), ((0.303, 0.597), (0.305, 0.595))]
    {
        let scene = demo.scene(&with_box_1(&format!("xyz = [{}, {}, 0.741]", at.0, at.1)));
        let solution = solve(&scene.problem, 1).unwrap();
        let [correction] = &solution.report.snapped[..] else { panic!("{:?}", solution.report.snapped) };
        let Moved::Object(_, pose) = correction.moved else { panic!("{correction:?}") };
        let there = pose.translation;
        assert!((there.x - moved.0).abs() < 1e-5 && (there.y - moved.1).abs() < 1e-5, "{at:?}: {pose:?}");
        proved(&demo.check(&demo.path(&scene, &solution)));
    }
    // What is told of what is farther off is the shortest way too.
    let scene = demo.scene(&with_box_1("xyz = [0.50, 0.603, 0.741]"));
    let refused = solve(&scene.problem, 1).unwrap_err().to_string();
    assert!(
        refused.contains("8.00 mm beside where it may lie") && refused.contains("at box1 = [0.5, 0.595"),
        "{refused}"
    );
}

#[test]
fn goals_are_moved_too() {
    let demo = Demo::new("goal-off");
    let whole = SCENE.replace("box1 = { xyz = [0.50, -0.10, 0.741] }", "box1 = { xyz = [0.50, -0.10, 0.743] }");
    let at = SCENE.find("[[goal]]").unwrap();
    let poses = SCENE[..at].to_owned() + "[[goal]]\nobjects = { box1 = { xyz = [0.55, 0.0, 0.7438] } }\n";
    for (text, by) in [(whole, 0.002), (poses, 0.0028)] {
        assert_ne!(text, SCENE);
        let scene = demo.scene(&text);
        let solution = solve(&scene.problem, 1).unwrap();
        let [correction] = &solution.report.snapped[..] else { panic!("{:?}", solution.report.snapped) };
        assert_eq!(correction.goal, Some(0));
        assert!((correction.distance - by).abs() < 1e-6, "{correction:?}");
        let mut file = demo.path(&scene, &solution);
        proved(&demo.check(&file));
        file.corrections.clear();
        assert!(has(&demo.check(&file), Kind::Goal));
    }
}

#[test]
fn a_joint_a_little_outside_its_bounds_is_moved_to_them() {
    let demo = Demo::new("start-bounds");
    let bounded = |upper: f64| {
        let line = format!("srdf = \"robot.srdf\"\njoint_bounds = {{ left_elbow_pitch = [0.0, {upper}] }}\n");
        SCENE.replace("srdf = \"robot.srdf\"\n", &line)
    };
    let scene = demo.scene(&bounded(1.8985));
    let solution = solve(&scene.problem, 1).unwrap();
    let joints: Vec<&Correction> = solution.report.snapped.iter().filter(|c| c.goal.is_none()).collect();
    let [correction] = joints[..] else { panic!("{:?}", solution.report.snapped) };
    assert_eq!(correction.name, "robot/left_elbow_pitch");
    assert!(
        correction.to_string().contains("0.086 degrees from where it is within its bounds, [0, 1.8985]"),
        "{correction}"
    );
    let mut file = demo.path(&scene, &solution);
    proved(&demo.check(&file));
    // No joint is let go elsewhere because a file says so.
    let column = file.coordinates.iter().position(|name| name == "robot/left_shoulder_yaw").unwrap();
    let mut problem = scene.problem.clone();
    problem.start[column] += 0.01;
    let mut entry = file.corrections[0].clone();
    (entry.joint, entry.angle) = (Some("robot/left_shoulder_yaw".into()), 0.01);
    file.corrections.push(entry);
    assert!(has(&demo.against(&file, &problem), Kind::Start));
    // Farther outside is an error as before.
    let refused = solve(&demo.scene(&bounded(1.8)).problem, 1).unwrap_err().to_string();
    assert!(refused.contains("left_elbow_pitch = 1.9 is outside [0, 1.8]"), "{refused}");
}

#[test]
fn the_program_says_what_it_moved() {
    let demo = Demo::new("start-told");
    demo.write("scene.toml", &with_box_1("xyz = [0.50, 0.10, 0.7413]"));
    let said = demo.run(&["solve", "scene.toml", "--first", "--json", "--out", "path.json"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        said.err.contains("warning: the start has `box1` 0.30 mm and 0.00 degrees from where it lies on table/top"),
        "{}",
        said.err
    );
    let json: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let snapped = &json["snapped"][0];
    assert_eq!((snapped["object"].as_str(), snapped["onto"].as_str()), (Some("box1"), Some("it lies on table/top")));
    assert!((snapped["distance"].as_f64().unwrap() - 3e-4).abs() < 1e-8, "{snapped}");
    let checked = demo.run(&["check", "path.json"]);
    assert_eq!(checked.code, 0, "{}{}", checked.out, checked.err);
    let timed = demo.run(&["solve", "scene.toml", "--out", "timed.json"]);
    assert_eq!(timed.code, 0, "{}", timed.err);
    assert_eq!(demo.run(&["check", "timed.json"]).code, 0);
}

#[test]
fn the_start_may_come_from_a_file() {
    let demo = Demo::new("start-file");
    demo.write("scene.toml", SCENE);
    let elbow = r#"{ "robot": "ready", "left_elbow_pitch": 1.7, "box1": [0.55, 0.2, 0.7415, 0, 0, 0, 1] }"#;
    demo.write("start.json", elbow);
    let said = demo.run(&["solve", "scene.toml", "--first", "--start", "start.json", "--out", "path.json"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let checked = demo.run(&["check", "path.json"]);
    assert_eq!(checked.code, 0, "{}{}", checked.out, checked.err);
    assert!(checked.out.contains("the path starts where `start.json` says"), "{}", checked.out);
    // Another start than the path was planned from.
    demo.write("start.json", &elbow.replace("1.7", "1.6"));
    let checked = demo.run(&["check", "path.json"]);
    assert_eq!(checked.code, 1, "{}", checked.out);
    for (text, words) in [
        ("{ \"robot/elbow\": 1 }", "there is no coordinate or part of this name"),
        ("{ \"left_elbow_pitch\": \"far\" }", "there is no coordinate or part of this name"),
        ("{ \"robot\": \"redy\" }", "has no configuration `redy` (did you mean `ready`?)"),
        ("{ \"left_elbow_pitch\": [1] }", "wants a finite number"),
        ("{ \"box1\": [1, 2, 3] }", "wants 7 finite numbers"),
        ("{ \"box1\": [1, 2, 3, 0, 0, 0, 0] }", "the quaternion has length 0.0000"),
        ("{ \"x\": 1 }", "name the part too"),
        ("{ \"robot/left_finger\": 0.01 }", "the scene locks it at 0.032"),
        ("{ \"table\": [0, 0, 0, 0, 0, 0, 1] }", "its root does not move"),
        ("[1, 2]", "a start is a JSON object"),
        ("{ \"robot/left_elbow_pitch\": 1, \"robot/left_elbow_pitch\": 2 }", "is named a second time"),
        (
            "{ \"left_elbow_pitch\": 1, \"robot/left_elbow_pitch\": 1 }",
            "`robot/left_elbow_pitch`, as `left_elbow_pitch` does (name each coordinate once)",
        ),
        ("{ \"box1\": [0.5, 0.1, 0.741, 0, 0, 0, 1], \"box1/x\": 0.5 }", "gives `box1/x`, as `box1` does"),
        ("{", "start.json:1"),
    ] {
        demo.write("start.json", text);
        let said = demo.run(&["solve", "scene.toml", "--start", "start.json"]);
        assert_eq!(said.code, 2, "{text}: {}", said.err);
        assert!(said.err.contains("start.json") && said.err.contains(words), "{text}: {}", said.err);
    }
    let said = demo.run(&["solve", "scene.toml", "--start", "nothing.json"]);
    assert_eq!(said.code, 2, "{}", said.err);
    let said = demo.run(&["solve", "scene.toml", "--start", "start.json", "--out", "start.json"]);
    assert!(said.code == 2 && said.err.contains("is read by this command"), "{}", said.err);
}

#[test]
fn goals_in_a_hand_stay_there() {
    let demo = Demo::new("goal-held");
    let at = SCENE.find("[[goal]]").unwrap();
    let text = SCENE[..at].to_owned()
        + "[[goal]]\nobjects = { box1 = { xyz = [0.50, 0.10, 0.7425] } }\nhands = { \"robot/left_hand\" = \"box1\" }\n";
    let scene = demo.scene(&text);
    let solution = solve(&scene.problem, 1).unwrap();
    assert!(solution.report.snapped.is_empty(), "it is to be held there: {:?}", solution.report.snapped);
    assert!(matches!(scene.problem.goals[0], Goal::Partial(_)));
    proved(&demo.check(&demo.path(&scene, &solution)));
}
