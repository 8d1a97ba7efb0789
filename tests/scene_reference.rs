//! Promise: the reference of scene files (`docs/scene-reference.md`) is true: its example loads, says every key, and every key that
//! is read is described. Mistakes in a scene are told with line, key and a hint.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

use foliate::components::problem::cost::MotionCost;
use foliate::components::problem::{CostOptions, Goal, RateLimits};
use foliate::components::robot::{JointIndex, RootJoint, Source};
use foliate::scene::{PackagePath, Scene, SceneError};
use std::path::Path;

const REFERENCE: &str = include_str!("../docs/scene-reference.md");

fn example() -> &'static str {
    let (_, rest) = REFERENCE.split_once("```toml\n").expect("the reference has an example");
    rest.split_once("```").expect("the example ends").0
}

fn load(text: &str) -> Result<Scene, SceneError> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    Scene::from_text("example", text, &directory, &PackagePath::default())
}

#[test]
fn the_example_loads_as_the_page_says() {
    let scene = load(example()).unwrap_or_else(|e| panic!("{e}"));
    let problem = &scene.problem;
    let robot = &problem.robot;
    assert_eq!(robot.parts.len(), 7);
    assert_eq!(robot.space.size(), 18 + 7 + 7 + 1);
    assert_eq!(robot.parts[2].root, RootJoint::FreeFlyer);
    let elbow = robot.joint("robot/left_elbow_pitch").expect("the elbow");
    assert_eq!(robot.joints[elbow.at()].upper, [2.2]);
    let top = &robot.handles[robot.handle("box/top").expect("the handle").at()];
    assert_eq!(top.mask, [true, true, true, false, true, true]);
    assert_eq!(top.mask_complement, [false, false, false, true, false, false]);
    assert!(robot.gripper("robot/left_palm_face").is_some());
    assert_eq!(robot.surfaces[robot.surface("brick/bottom").expect("the surface").at()].polygons.len(), 1);

    assert_eq!(problem.graph.locked.len(), 3);
    assert_eq!(problem.graph.grasps.as_ref().map(Vec::len), Some(3));
    assert_eq!(problem.graph.rules.len(), 2);
    assert!(!problem.graph.rules[0].allowed && problem.graph.rules[1].grasps[0].1.is_none());
    assert_eq!(problem.graph.objects[1].handles.len(), 1);
    let plane = problem.graph.objects[1].plane.expect("the brick's plane");
    assert_eq!((plane.world_from_plane.translation.z, plane.object_from_frame.translation.z), (0.7, -0.041));
    assert_eq!(plane.on, robot.link("table/table"));
    assert!(problem.ignored_pairs.iter().any(|p| p.reason == "adjacent"));
    assert_eq!(problem.margins.len(), 1);
    let elbow = |side: &str| {
        let joint = robot.joint(&format!("robot/{side}_elbow_pitch")).expect("the joint");
        let Source::Coordinates { q, .. } = robot.joints[joint.at()].source else { panic!("it follows nothing") };
        q
    };
    let limits = RateLimits::of(robot, &problem.timing);
    // The scene's own limit counts, then that of the part; the rest is scaled. The acceleration is the part's, the scene's, by `ramp`.
    let box_x = 18;
    for (i, velocity, acceleration) in [(elbow("left"), 0.8, 4.0), (elbow("right"), 1.2, 3.0), (box_x, 0.25, 0.625)] {
        assert_eq!((limits.velocity[i], limits.acceleration[i]), (velocity, acceleration));
        assert!((limits.jerk[i] - 20.0 * acceleration).abs() < 1e-12);
    }
    assert_eq!(problem.projection_tolerance, 2e-6);
    assert_eq!(problem.timing.dwell, 0.25);
    assert_eq!(problem.cost, CostOptions { motion: MotionCost::Duration, grasp_charge: 3.0 });
    assert_eq!(problem.start[0], 0.1);
    assert_eq!(problem.goals.len(), 8, "`any` lists two");
    let suggested: Vec<f64> = problem.suggestions.iter().map(|(_, pose)| pose.translation.x).collect();
    assert_eq!((robot.parts[problem.suggestions[0].0.at()].name.as_str(), suggested), ("box", vec![0.5, 0.6]));
    let Goal::Configuration(whole) = &problem.goals[0] else { panic!("the first goal is whole") };
    assert_eq!((whole[0], whole[19]), (0.1, 0.2));
    assert!(matches!(&problem.goals[1], Goal::Partial(goal) if goal.poses.len() == 2));
    let Goal::Partial(partial) = &problem.goals[2] else { panic!("the third goal is not whole") };
    assert_eq!(partial.coordinates, [(0, 0.2), (32, 0.0)]);
    assert_eq!(partial.constraints[0].name, "upright");
    let sum = scene.warnings.iter().find(|w| w.message.contains("differs")).expect("the sum differs");
    assert_eq!(sum.element, "sha256.demo/box.urdf");
}

#[test]
fn every_key_that_is_read_is_in_the_example_and_described() {
    // The readers refuse every other key; a new one belongs here, in the example and in a table.
    let keys = "format name description part shape box cylinder sphere mesh scale mass coordinates ignore margins default_margin constraint locked graph start goal sha256 kind urdf srdf root \
                pose root_bounds joint_bounds values mimic avoided_by mesh_up_axis masks mask_complements gripper handle surface link \
                clearance mask mask_complement approaching_direction points polygons grippers supports objects grasps rules \
                when allow placement_margin rests rests_margin preplacement_distance plane frame pair distance configuration handles surfaces xyz rpy \
                quaternion frame to value parameter at_least at_most length parts polygon margin first second height joint \
                everywhere while_held state constraints transition from legs within until short hands fingers open closed travel approach approach_clearance approach_line approach_lines lift resting_joints velocity_limits acceleration_limits \
                timing velocity_scale velocity acceleration ramp jerk_ramp object_speed dwell cost motion grasp_charge suggest \
                start_tolerance projection_tolerance angle on near tolerance held any object x y z within";
    let kinds = "\"pose\" \"centre_of_mass\" \"centre_of_mass_between\" \"distance\" \"tilt\" \"region\" \"joint\" \"start\" \"stays\" \"auto\"";
    let keys = format!("{keys} {kinds}");
    let tables = REFERENCE.replacen(example(), "", 1);
    for key in keys.split_whitespace() {
        assert!(
            tables.contains(&format!("`{key}`"))
                || tables.contains(&format!("{key} ="))
                || tables.contains(&format!("= {key}")),
            "`{key}` is not described"
        );
        assert!(example().contains(key), "`{key}` is not in the example");
    }
}

/// A change of the example, and the refusal: line of the changed text, key, words.
fn refusal(before: &str, after: &str) -> SceneError {
    assert!(example().contains(before), "{before}");
    let text = example().replacen(before, after, 1);
    let error = load(&text).map(|_| ()).expect_err(after);
    let line = 1 + text[..text.find(after.trim()).expect("the change")].lines().count() as u32 - 1;
    let found = error.line.unwrap_or_default();
    let last = line + after.lines().count() as u32;
    assert!((line.saturating_sub(1)..=last).contains(&found), "{error}: expected line {line}");
    error
}

#[test]
fn mistakes_are_told_with_line_key_and_a_way_out() {
    let cases = [
        ("mimic = \"free\"", "mimik = \"free\"", "part[0].mimik", "did you mean `mimic`?"),
        ("kind = \"robot\"", "kind = \"robto\"", "part[0].kind", "did you mean `robot`?"),
        ("demo/robot.urdf", "demo/robbot.urdf", "part[0].urdf", "no such file"),
        (
            "\"robot/left_hand\", \"robot",
            "\"robot/left_hnad\", \"robot",
            "graph.grippers[0]",
            "did you mean `robot/left_hand`?",
        ),
        ("supports = [\"table/top\",", "supports = [\"table/tap\",", "graph.supports[0]", "did you mean `table/top`?"),
        (
            "masks = { top = [1, 1, 1, 0, 1, 1] }",
            "masks = { top = [1, 1, 1, 0, 0, 1] }",
            "part[2].masks.top",
            "exactly one rotation",
        ),
        ("root_bounds = [[0.2, 1.0],", "root_bounds = [[1.2, 1.0],", "part[2].root_bounds[0]", "above the upper"),
        ("[suggest]\nbox = [", "[suggest]\nbax = [", "suggest.bax", "did you mean `box`?"),
        ("[suggest]\nbox = [{ xyz = [0.5, 0.0,", "[suggest]\nbox = [{ xyz = [0.5,", "suggest.box[0].xyz", "3"),
        ("velocity_scale = 0.5", "velocity_scale = 1.5", "timing.velocity_scale", "above 1"),
        ("velocity_scale = 0.5", "velocity_scale = 0", "timing.velocity_scale", "not above 0"),
        ("ramp = 0.4", "rampe = 0.4", "timing.rampe", "did you mean `ramp`?"),
        ("jerk_ramp = 0.05", "jerk_ramp = -0.05", "timing.jerk_ramp", "negative"),
        ("dwell = 0.25", "dwell = \"short\"", "timing.dwell", "wants a number"),
        (
            "velocity = { \"robot/left_elbow_pitch\" = 0.8 }",
            "velocity = { \"robot/left_elbow_pich\" = 0.8 }",
            "timing.velocity.robot/left_elbow_pich",
            "did you mean `robot/left_elbow_pitch`?",
        ),
        (
            "acceleration_limits = { left_elbow_pitch = 4.0 }",
            "acceleration_limits = { left_elbow_pitsch = 4.0 }",
            "part[0].acceleration_limits.left_elbow_pitsch",
            "did you mean `left_elbow_pitch`?",
        ),
        (
            "velocity_limits = { left_elbow_pitch = 1.2,",
            "velocity_limits = { left_elbow_pitch = 0.0,",
            "part[0].velocity_limits.left_elbow_pitch",
            "not above 0",
        ),
        ("motion = \"duration\"", "motion = \"durations\"", "cost.motion", "did you mean `duration`?"),
        ("grasp_charge = 3.0", "grasp_charge = -3.0", "cost.grasp_charge", "negative"),
        ("distance = 0.01", "distance = -0.01", "margins[0].distance", "negative"),
        ("distance = 0.01", "distance = nan", "margins[0].distance", "not a finite number"),
        ("clearance = 0.05", "clearance = \"5 cm\"", "part[0].gripper[0].clearance", "wants a number, got a string"),
        (
            "brick = [0.5, -0.1, 0.741, 0.0, 0.0, 0.0, 1.0]",
            "brick = [0.5, -0.1, 0.741, 0.0, 0.0, 0.0, 2.0]",
            "start.brick",
            "length 2",
        ),
        (
            "\"robot/right_finger\" = 0.032",
            "\"robot/rihgt_finger\" = 0.032",
            "locked.robot/rihgt_finger",
            "did you mean",
        ),
        ("robot = \"ready\"", "robot = \"redy\"", "start.robot", "did you mean `ready`?"),
        ("joint_bounds = { left_elbow_pitch", "joint_bounds = { left_elbow", "part[0].joint_bounds.left_elbow", ""),
        ("polygons = [[0, 1, 2, 3]]", "polygons = [[0, 1, 2, 4]]", "part[3].surface[0].polygons[0][3]", "no index"),
        ("polygons = [[0, 1, 2, 3]]", "polygons = [[0, 2, 1, 3]]", "part[3].surface[0].polygons", "polygon 0"),
        ("foliate.scene/1", "foliate.scene/9", "format", "no format of scenes"),
        ("name = \"table\"", "name = \"ta/ble\"", "part[1].name", "letters, digits"),
        ("name = \"brick\"", "name = \"box\"", "part[2]", "two parts"),
        ("allow = false", "alow = false", "graph.rules[0]", "`allow` is missing"),
    ];
    for (before, after, element, says) in cases {
        let error = refusal(before, after);
        assert_eq!(error.element, element, "{error}");
        assert!(error.to_string().contains(says), "{error}");
    }
}

#[test]
fn an_environment_stands_still_at_the_values_that_are_given() {
    let door = "<robot name=\"d\"><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"prismatic\"><parent link=\"a\"/>\
                <child link=\"b\"/><axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"1\" velocity=\"1\"/></joint></robot>";
    let directory = std::env::temp_dir().join(format!("foliate-door-{}", std::process::id()));
    std::fs::create_dir_all(&directory).expect("a directory");
    std::fs::write(directory.join("door.urdf"), door).expect("a model");
    let text = "format = \"foliate.scene/1\"\nname = \"door\"\n[[part]]\nname = \"door\"\nkind = \"environment\"\n\
                urdf = \"door.urdf\"\nvalues = { j = 0.25 }\n[start]\n[[goal]]\nconfiguration = {}\n";
    let scene = Scene::from_text("door", text, &directory, &PackagePath::default()).unwrap_or_else(|e| panic!("{e}"));
    let _ = std::fs::remove_dir_all(&directory);
    let robot = &scene.problem.robot;
    assert_eq!((robot.joints.len(), robot.space.size()), (0, 0));
    assert_eq!(robot.links[1].joint_from_link.translation.z, 0.25);
    assert_eq!(robot.links[1].joint, None::<JointIndex>);
}

#[test]
fn a_root_that_is_locked_stands_where_it_is_locked() {
    let text = "format = \"foliate.scene/1\"\nname = \"cart\"\n[[part]]\nname = \"cart\"\nkind = \"robot\"\nroot = \"planar\"\n\
                urdf = \"demo/box.urdf\"\nroot_bounds = [[-1.0, 1.0], [-1.0, 1.0]]\n[[part]]\nname = \"kite\"\nkind = \"robot\"\n\
                root = \"freeflyer\"\nurdf = \"demo/box.urdf\"\n[locked]\n\"cart/root_joint\" = [0.5, -0.5, 0.25]\n\
                \"kite/root_joint\" = [0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0]\n[start]\n[[goal]]\nconfiguration = {}\n";
    let scene = load(text).unwrap_or_else(|e| panic!("{e}"));
    let problem = &scene.problem;
    let stands = [0.5, -0.5, 0.25, 0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0];
    assert_eq!(problem.start, stands);
    assert_eq!((&problem.robot.space.lower[..], &problem.robot.space.upper[..]), (&stands[..], &stands[..]));
    assert!(problem.robot.joints.iter().all(|j| j.is_immovable()));
    assert!(problem.graph.locked.is_empty());

    let cases = [
        ("[0.5, -0.5, 0.25]", "[1.5, -0.5, 0.25]", "locked.cart/root_joint", "outside the `root_bounds`"),
        ("[start]", "[start]\n\"cart/theta\" = 0.5", "start", "never moves from 0.25"),
        ("[-1.0, 1.0]]", "[-1.0, 1.0], [-2.0, 2.0]]", "part[0].root_bounds", "half a turn"),
    ];
    for (before, after, element, says) in cases {
        let error = load(&text.replacen(before, after, 1)).map(|_| ()).expect_err(after);
        assert_eq!(error.element, element, "{error}");
        assert!(error.to_string().contains(says), "{error}");
    }
}
