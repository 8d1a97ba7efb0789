//! Promise: a goal says what people want of the end: an object here, on this support, in this region; hands empty or holding something;
//! a named configuration, joints near a value, any of several. What is not named is free, but nothing is left in a hand that was not
//! asked for. The check proves the same by its own code.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/demo.rs"]
mod demo;

use demo::{Demo, SCENE, first_of, solve};
use foliate::Solution;
use foliate::check::Kind;
use foliate::components::path::Attachment;
use foliate::components::problem::{Goal, PartialGoal};
use foliate::path_file::PathFile;
use foliate::scene::Scene;

/// The demo with another goal.
fn with_goal(goal: &str) -> String {
    let at = SCENE.find("[[goal]]").unwrap();
    format!("{}[[goal]]\n{goal}\n", &SCENE[..at])
}

/// Solves with a few seeds; every answer is proved. The last one is kept.
fn solved(demo: &Demo, text: &str) -> (Scene, Solution, PathFile) {
    let scene = demo.scene(text);
    let mut last = None;
    for seed in 1..=3 {
        let solution = solve(&scene.problem, seed).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        let file = demo.path(&scene, &solution);
        let report = demo.check(&file);
        assert!(report.passed(), "seed {seed}: {:?}", report.violations);
        last = Some((solution, file));
    }
    let (solution, file) = last.unwrap();
    (scene, solution, file)
}

/// The last configuration of a path.
fn end(solution: &Solution) -> Vec<f64> {
    solution.path.segments.last().unwrap().knots.last().unwrap().clone()
}

/// Which handles hands are around in the end: those of the last motion's grasps, and of what it takes hold of.
fn in_hands(scene: &Scene, solution: &Solution) -> Vec<String> {
    let last = end(solution);
    let robot = &scene.problem.robot;
    let kinematics = foliate::kernels::kinematics::Kinematics::new(robot);
    let mut bodies = vec![foliate::components::Pose::identity(); kinematics.bodies()];
    kinematics.forward(&last, &mut bodies);
    let mut around = Vec::new();
    for gripper in &robot.grippers {
        for handle in &robot.handles {
            let place = |link: foliate::components::robot::LinkIndex, pose: &foliate::components::Pose| {
                let (joint, on_joint) = robot.frame_on_joint(link, pose);
                joint.map_or(on_joint, |joint| bodies[joint.0 as usize] * on_joint).translation
            };
            let (hand, held) =
                (place(gripper.link, &gripper.link_from_gripper), place(handle.link, &handle.link_from_handle));
            if hand.distance(held) < 1e-4 {
                around.push(format!("{} {}", gripper.name, handle.name));
            }
        }
    }
    around
}

fn z(scene: &Scene, solution: &Solution, object: &str) -> f64 {
    end(solution)[first_of(scene, object) + 2]
}

#[test]
fn nothing_is_left_in_a_hand_that_was_not_asked_for() {
    let demo = Demo::new("goal-hands");
    let (scene, solution, file) = solved(&demo, &with_goal("objects = { box1 = { xyz = [0.50, 0.00, 0.741] } }"));
    assert!(in_hands(&scene, &solution).is_empty(), "{:?}", in_hands(&scene, &solution));
    // Asked to hold it there.
    let asked = "objects = { box1 = { xyz = [0.50, 0.00, 0.741] } }\nheld = [\"box1\"]";
    let (held_scene, held, held_file) = solved(&demo, &with_goal(asked));
    assert_eq!(in_hands(&held_scene, &held).len(), 1);
    // Either path is no answer to the other goal.
    let refused = demo.against(&held_file, &scene.problem);
    let left: Vec<_> = refused.violations.iter().filter(|v| v.kind == Kind::Goal).collect();
    assert!(left.iter().any(|v| v.subject.contains("which is left around box1/top")), "{:?}", refused.violations);
    let refused = demo.against(&file, &held_scene.problem);
    assert!(
        refused.violations.iter().any(|v| v.subject.contains("box1, which no hand holds")),
        "{:?}",
        refused.violations
    );
    // What the goal does not name is put down too.
    let mut problem = held_scene.problem.clone();
    problem.start = end(&held);
    let shoulder = problem.start[0] + 0.1;
    problem.goals = vec![Goal::Partial(PartialGoal { coordinates: vec![(0, shoulder)], ..PartialGoal::default() })];
    let away = solve(&problem, 1).unwrap();
    assert!(in_hands(&scene, &away).is_empty(), "{:?}", in_hands(&scene, &away));
}

#[test]
fn hands_hold_what_they_are_asked_to() {
    let demo = Demo::new("goal-hold");
    let goal = "hands = { \"robot/right_hand\" = \"box1/top\", \"robot/left_hand\" = \"empty\" }";
    let (scene, solution, _) = solved(&demo, &with_goal(goal));
    assert_eq!(in_hands(&scene, &solution), ["robot/right_hand box1/top"]);
    let goal = "hands = \"empty\"\ncoordinates = { \"robot/left_shoulder_yaw\" = 0.3 }";
    let (scene, solution, _) = solved(&demo, &with_goal(goal));
    assert!(in_hands(&scene, &solution).is_empty());
    let goal = "held = [\"box1\", \"box2\"]";
    let (scene, solution, _) = solved(&demo, &with_goal(goal));
    assert_eq!(in_hands(&scene, &solution).len(), 2);
    // Two demands that no state meets: both boxes in one hand's place.
    let none = demo.scene(&with_goal("held = [\"box1\", \"box2\"]\nhands = { \"robot/left_hand\" = \"empty\" }"));
    let refused = solve(&none.problem, 1).unwrap_err().to_string();
    assert!(refused.contains("contradicts every state"), "{refused}");
}

#[test]
fn objects_lie_on_a_support_and_in_a_region() {
    let demo = Demo::new("goal-region");
    let tray = "[[part.surface]]\nname = \"tray\"\nlink = \"table\"\n\
                points = [[-0.2, 0.2, 0.7], [0.1, 0.2, 0.7], [0.1, 0.45, 0.7], [-0.2, 0.45, 0.7]]\npolygons = [[0, 1, 2, 3]]\n\n";
    let with_tray = |goal: &str| {
        let text =
            with_goal(goal).replacen("[[part]]\nname = \"box1\"", &format!("{tray}[[part]]\nname = \"box1\""), 1);
        text.replace("supports = [\"table/top\"]", "supports = [\"table/top\", \"table/tray\"]")
    };
    let (scene, solution, _) = solved(&demo, &with_tray("on = { box2 = \"table/tray\" }"));
    let at = &end(&solution)[first_of(&scene, "box2")..];
    assert!((0.4..=0.7).contains(&at[0]) && (0.2..=0.45).contains(&at[1]), "{:?}", &at[..3]);
    assert!((at[2] - 0.741).abs() < 1e-5 && in_hands(&scene, &solution).is_empty());
    let region =
        "on = { box1 = [\"table/top\"] }\nwithin = [{ object = \"box1\", x = [0.45, 0.55], y = [-0.05, 0.02] }]";
    let (scene, solution, file) = solved(&demo, &with_goal(region));
    let at = &end(&solution)[first_of(&scene, "box1")..];
    let within = |value: f64, low: f64, high: f64| (low - 1e-6..=high + 1e-6).contains(&value);
    assert!(within(at[0], 0.45, 0.55) && within(at[1], -0.05, 0.02), "{:?}", &at[..3]);
    let elsewhere = demo.scene(&with_goal(&region.replace("[-0.05, 0.02]", "[-0.08, -0.06]")));
    assert!(demo.against(&file, &elsewhere.problem).violations.iter().any(|v| v.kind == Kind::Goal));
    // In the air it is held; of one in a frame of a link the frame counts.
    let high = "within = [{ object = \"box1\", frame = { link = \"table/table\" }, z = [0.85, 0.95] }]";
    let (scene, solution, _) = solved(&demo, &with_goal(high));
    assert!((0.85 - 1e-6..=0.95 + 1e-6).contains(&z(&scene, &solution, "box1")));
    assert_eq!(in_hands(&scene, &solution).len(), 1);
}

#[test]
fn joints_may_be_near_and_robots_at_named_configurations() {
    let demo = Demo::new("goal-near");
    let goal = "coordinates = { robot = \"ready\", \"robot/left_wrist_roll\" = 0.4 }\nobjects = { box1 = { xyz = [0.5, 0.0, 0.741] } }";
    let (scene, solution, _) = solved(&demo, &with_goal(goal));
    let names = foliate::scene::coordinate_names(&scene.problem.robot);
    let of = |name: &str| end(&solution)[names.iter().position(|known| known == name).unwrap()];
    assert!((of("robot/left_elbow_pitch") - 1.9).abs() < 1e-5 && (of("robot/left_wrist_roll") - 0.4).abs() < 1e-5);
    let goal = "near = { coordinates = { \"robot/left_shoulder_yaw\" = 0.5, \"robot/right_shoulder_yaw\" = -0.4 }, tolerance = 0.1 }";
    let (scene, solution, file) = solved(&demo, &with_goal(goal));
    let last = end(&solution);
    let left = names.iter().position(|known| known == "robot/left_shoulder_yaw").unwrap();
    assert!((last[left] - 0.5).abs() <= 0.1 + 1e-9, "{}", last[left]);
    let far = demo.scene(&with_goal(&goal.replace("0.5,", "0.8,")));
    let refused = demo.against(&file, &far.problem);
    assert!(refused.violations.iter().any(|v| v.subject.contains("left_shoulder_yaw")), "{:?}", refused.violations);
    drop(scene);
}

#[test]
fn any_of_several_goals_will_do() {
    let demo = Demo::new("goal-any");
    // The first is out of reach.
    let goal = "hands = \"empty\"\nany = [{ objects = { box1 = { xyz = [0.88, 0.55, 0.741] } } }, { on = { box1 = \"table/top\" }, \
                within = [{ object = \"box1\", y = [0.0, 0.03] }] }]";
    let (scene, solution, _) = solved(&demo, &with_goal(goal));
    assert_eq!(scene.problem.goals.len(), 2);
    let y = end(&solution)[first_of(&scene, "box1") + 1];
    assert!((-1e-6..=0.03 + 1e-6).contains(&y), "{y}");
}

#[test]
fn two_demands_that_hold_together_are_met() {
    let demo = Demo::new("goal-two");
    // Where the hand has the box in a grasp.
    let in_hand = "[[constraint]]\nname = \"in hand\"\nkind = \"pose\"\nframe = \"box1/box\"\nto = \"robot/left_palm\"\n\
                   value = { xyz = [0.16, 0.0, 0.0], rpy = [0.0, -1.5707963267948966, 0.0] }\n";
    let lifted = "[[constraint]]\nname = \"lifted\"\nkind = \"pose\"\nframe = \"box1/box\"\nvalue = { xyz = [0.0, 0.0, 0.85] }\n\
                  mask = [0, 0, 1, 0, 0, 0]\n";
    let text = with_goal("constraints = [\"in hand\", \"lifted\"]")
        .replace("[[goal]]", &format!("{in_hand}\n{lifted}\n[[goal]]"));
    let (scene, solution, _) = solved(&demo, &text);
    assert!((z(&scene, &solution, "box1") - 0.85).abs() < 1e-5);
    assert_eq!(in_hands(&scene, &solution), ["robot/left_hand box1/top"]);
    let held = solution.path.segments.last().unwrap().attachments.iter();
    assert!(held.clone().any(|attachment| matches!(attachment, Attachment::Grasp { .. })), "{held:?}");
}

#[test]
fn objects_that_a_goal_has_in_each_other_are_named() {
    let demo = Demo::new("goal-overlap");
    let goal = "objects = { box1 = { xyz = [0.5, 0.02, 0.741] }, box2 = { xyz = [0.5, 0.0, 0.741] } }";
    let refused = solve(&demo.scene(&with_goal(goal)).problem, 1).unwrap_err().to_string();
    assert!(refused.contains("where it has its objects, box1 and box2 are 30.0 mm in each other"), "{refused}");
}

#[test]
fn places_outside_of_an_objects_bounds_are_named_with_them() {
    let demo = Demo::new("goal-bounds");
    let goal = "objects = { box1 = { xyz = [0.5, 0.9, 0.741] } }";
    let refused = solve(&demo.scene(&with_goal(goal)).problem, 1).unwrap_err();
    let words = "goal 1: `box1` at y = 0.9 is outside its bounds, [-0.7, 0.7] (`root_bounds`)";
    assert!(refused.to_string().contains(words) && refused.report.steps == 0, "{refused}");
}

#[test]
fn slips_in_goals_are_named() {
    let demo = Demo::new("goal-slips");
    for (goal, words) in [
        ("on = { box1 = \"table/bottom\" }", "is no support of the graph"),
        ("on = { robot = \"table/top\" }", "no freely moving object"),
        ("on = { box1 = [] }", "names no support"),
        ("hands = \"open\"", "is neither \"empty\" nor \"any\""),
        ("hands = { \"robot/left\" = \"empty\" }", "there is no gripper of this name"),
        ("hands = { \"robot/left_hand\" = \"box3\" }", "there is no object `box3` with a handle"),
        ("held = [\"table\"]", "there is no object `table` with a handle"),
        ("within = [{ object = \"box1\" }]", "bounds nothing"),
        ("within = [{ object = \"box1\", x = [1.0, 0.0] }]", "is above the upper bound"),
        ("within = [{ object = \"box1\", frame = \"box1/box\", x = [0.0, 1.0] }]", "moves with the object"),
        (
            "within = [{ object = \"box1\", x = [0.0, 1.0], y = [90.0, 91.0] }]",
            "the region has y from 90 to 91, and `root_bounds` of `box1`",
        ),
        ("near = { coordinates = { \"robot/left_shoulder_yaw\" = 0.0 } }", "key `tolerance` is missing"),
        (
            "near = { tolerance = 0.1, coordinates = { \"box1/qx\" = 0.0, \"box1/qy\" = 0.0, \"box1/qz\" = 0.0, \"box1/qw\" = 1.0 } }",
            "names numbers of a pose",
        ),
        ("coordinates = { robot = \"redy\" }", "has no configuration `redy`"),
        ("any = []", "0 goals are given"),
        ("any = [{}]", "asks for nothing"),
        ("any = [{ any = [] }]", "is no key of a scene file"),
        (
            "configuration = { box1 = { xyz = [0.5, 0.0, 0.741] } }\nhands = \"empty\"",
            "wants either `configuration` alone",
        ),
        ("hand = \"empty\"", "is no key of a scene file (did you mean `hands`?)"),
    ] {
        let error = demo.try_scene(&with_goal(goal)).map(|_| goal).unwrap_err();
        assert!(error.to_string().contains(words) && error.line.is_some(), "{goal}: {error}");
    }
}
