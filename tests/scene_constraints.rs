//! Promise: what a scene defines itself (constraints, states, resting joints, goals that leave things free) reaches the
//! problem as the page of scene files says, with values of the start where it asks for them.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::components::constraint::{Constraint, LockedValue, Reference, Row};
use foliate::components::pose::log_so3;
use foliate::components::problem::{GraphOptions, JointRest};
use foliate::components::robot::Robot;
use foliate::scene::{PackagePath, Scene, SceneError};
use std::path::Path;

fn load(text: &str) -> Result<Scene, SceneError> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    Scene::from_text("test", text, &directory, &PackagePath::default())
}

/// A walker of two boxes: a free body, and a foot that slides in it; and a box with a mass, whose centre is its origin.
const PARTS: &str = r#"
format = "foliate.scene/1"
name = "test"

[[part]]
name = "cabinet"
kind = "object"
root = "fixed"
urdf = "drawer/cabinet.urdf"
srdf = "drawer/cabinet.srdf"
ignore = [["shell", "tray"]]

[[part]]
name = "a"
kind = "robot"
root = "freeflyer"
root_bounds = [[-1.0, 1.0], [-1.0, 1.0], [0.0, 2.0]]
urdf = "demo/box.urdf"

[[part]]
name = "b"
kind = "robot"
root = "freeflyer"
urdf = "demo/box.urdf"

[start]
a = { xyz = [0.1, 0.2, 0.3], rpy = [0.0, 0.0, 1.5707963267948966] }
b = { xyz = [0.4, 0.2, 0.3] }
"cabinet/drawer" = 0.125

[[goal]]
configuration = {}
"#;

fn options(more: &str) -> (GraphOptions, Robot) {
    let scene = load(&format!("{PARTS}{more}")).unwrap_or_else(|e| panic!("{e}"));
    (scene.problem.graph, scene.problem.robot)
}

#[test]
fn the_value_of_a_pose_is_part_of_its_frames_so_that_rows_are_zero_there() {
    let (graph, _) = options(
        r#"
        [[constraint]]
        name = "beside"
        kind = "pose"
        frame = "b/box"
        to = { link = "a/box", pose = { xyz = [0.0, 0.0, 0.5] } }
        value = { xyz = [0.0, -0.3, -0.5], rpy = [0.0, 0.0, -1.5707963267948966] }
        mask = [0, 0, 1, 1, 1, 0]
        parameter = [1, 0, 0, 0, 0, 1]
        at_least = [0, 1, 0, 0, 0, 0]
        [[constraint]]
        name = "as it stands"
        kind = "pose"
        frame = "b/box"
        to = "a/box"
        value = "start"
        "#,
    );
    let Constraint::RelativePose(pose) = &graph.constraints[0].constraint else { panic!("a pose") };
    let (zero, parameter, bounded) = (Some(Row::Zero), Some(Row::Parameter), Some(Row::Inequality));
    assert_eq!(pose.rows, [parameter, bounded, zero, zero, zero, parameter]);
    assert_eq!(pose.reference, Reference::Argument(0));
    let a = pose.a.joint_from_frame;
    assert!((a.translation - glam::DVec3::new(0.0, -0.3, 0.0)).length() < 1e-12, "{a:?}");
    assert!((log_so3(a.rotation).z + std::f64::consts::FRAC_PI_2).abs() < 1e-12);

    let Constraint::RelativePose(pose) = &graph.constraints[1].constraint else { panic!("a pose") };
    assert_eq!((pose.rows, pose.reference), ([zero; 6], Reference::Identity));
    // b is 0.3 ahead of a in the world, which a, turned by a quarter, sees on its right.
    let a = pose.a.joint_from_frame;
    assert!((a.translation - glam::DVec3::new(0.0, -0.3, 0.0)).length() < 1e-12, "{a:?}");
}

#[test]
fn a_centre_of_mass_is_fixed_where_it_is_or_kept_above_a_polygon() {
    let (graph, _) = options(
        r#"
        [[constraint]]
        name = "both, as they stand"
        kind = "centre_of_mass"
        parts = ["a", "b"]
        frame = "a/box"
        value = "start"
        mask = [1, 1, 0]
        [[constraint]]
        name = "above"
        kind = "centre_of_mass"
        frame = "b/box"
        polygon = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1]]
        margin = 0.02
        [[constraint]]
        name = "between"
        kind = "centre_of_mass_between"
        parts = ["b"]
        first = "a/box"
        second = { link = "b/box", pose = { xyz = [0.0, 0.0, -0.2] } }
        height = "start"
        "#,
    );
    let Constraint::CentreOfMass(balance) = &graph.constraints[0].constraint else { panic!("a balance") };
    assert!((balance.masses.total() - 0.4).abs() < 1e-12);
    assert_eq!(balance.rows.len(), 2);
    // The middle of both is 0.15 ahead of a in the world, on its right.
    let offsets: Vec<f64> = balance.rows.iter().map(|r| r.offset).collect();
    assert!(offsets[0].abs() < 1e-12 && (offsets[1] + 0.15).abs() < 1e-12, "{offsets:?}");

    let Constraint::CentreOfMass(balance) = &graph.constraints[1].constraint else { panic!("a balance") };
    let depth = |x, y| {
        let depths = balance.rows.iter().map(|r| r.normal.dot(glam::DVec3::new(x, y, 9.0)) - r.offset);
        depths.fold(f64::INFINITY, f64::min)
    };
    assert!((depth(0.1, 0.05) - 0.03).abs() < 1e-12);
    assert!((depth(0.01, 0.05) + 0.01).abs() < 1e-12);
    assert!(balance.rows.iter().all(|r| r.row == Row::Inequality));

    let Constraint::CentreOfMassBetween(between) = &graph.constraints[2].constraint else { panic!("a balance") };
    assert!((between.height.unwrap() - 0.1).abs() < 1e-12);
}

#[test]
fn distances_and_joints_say_what_the_scene_says() {
    let (graph, robot) = options(
        r#"
        [[constraint]]
        name = "far"
        kind = "distance"
        frame = "a/box"
        to = "b/box"
        length = "start"
        [[constraint]]
        name = "no farther"
        kind = "distance"
        frame = "a/box"
        at_most = 2.0
        [[constraint]]
        name = "shut"
        kind = "joint"
        joint = "cabinet/drawer"
        value = "start"
        [[constraint]]
        name = "left"
        kind = "joint"
        joint = "cabinet/drawer"
        value = "stays"
        "#,
    );
    let Constraint::Distance(far) = &graph.constraints[0].constraint else { panic!("a distance") };
    assert!((far.length - 0.3).abs() < 1e-12 && far.row == Row::Zero);
    let Constraint::Distance(near) = &graph.constraints[1].constraint else { panic!("a distance") };
    assert_eq!((near.length, near.row, near.at_most, near.a.joint), (2.0, Row::Inequality, true, None));
    let locked = |i: usize| match &graph.constraints[i].constraint {
        Constraint::Locked(locked) => (locked.joint, locked.value),
        other => panic!("{other:?}"),
    };
    let drawer = robot.joint("cabinet/drawer").unwrap();
    assert_eq!(locked(2), (drawer, LockedValue::Fixed(0.125)));
    assert_eq!(locked(3), (drawer, LockedValue::Argument(0)));
}

#[test]
fn states_of_the_problems_own_name_constraints_and_each_other() {
    let (graph, _) = options(
        r#"
        [[constraint]]
        name = "near"
        kind = "distance"
        frame = "a/box"
        to = "b/box"
        at_most = 0.5
        [[constraint]]
        name = "far"
        kind = "distance"
        frame = "a/box"
        to = "b/box"
        at_least = 0.1
        [graph]
        everywhere = ["far"]
        [[graph.state]]
        name = "one"
        constraints = ["near"]
        [[graph.state]]
        name = "two"
        [[graph.transition]]
        from = "one"
        to = "two"
        [[graph.transition]]
        name = "back"
        from = "two"
        to = "one"
        legs = [{ within = "two", until = ["near", "far"], short = true }, { within = "one" }]
        "#,
    );
    assert_eq!(graph.everywhere, [1]);
    assert_eq!(graph.states[0].constraints, [0]);
    assert_eq!(graph.states[1].constraints, [0; 0]);
    let (there, back) = (&graph.transitions[0], &graph.transitions[1]);
    assert_eq!((there.name.as_str(), there.from, there.to, there.legs.len()), ("one → two", 0, 1, 0));
    assert_eq!((back.name.as_str(), back.from, back.to, back.legs.len()), ("back", 1, 0, 2));
    assert_eq!((back.legs[0].within, &back.legs[0].until[..], back.legs[0].short), (1, &[0, 1][..], true));
    assert_eq!((back.legs[1].within, back.legs[1].short), (0, false));
}

#[test]
fn a_part_is_locked_as_a_whole_but_for_joints_that_rest() {
    let locked = "[locked]\ncabinet = \"start\"\n";
    let (graph, robot) = options(locked);
    let drawer = robot.joint("cabinet/drawer").unwrap();
    assert_eq!(graph.locked, [(drawer, 0.125)]);
    assert_eq!(graph.resting_joints, []);

    let (graph, _) = options(&format!("{locked}[graph]\nresting_joints = {{ \"cabinet/drawer\" = 0.125 }}\n"));
    assert_eq!(graph.locked, []);
    assert_eq!(graph.resting_joints[0].rest, JointRest::At(0.125));
    let (graph, _) = options("[graph]\nresting_joints = { \"cabinet/drawer\" = \"stays\" }\n");
    assert_eq!((graph.resting_joints[0].joint, graph.resting_joints[0].rest), (drawer, JointRest::Stays));
}

#[test]
fn furniture_carries_and_is_held_but_lies_on_nothing() {
    let (graph, robot) = options("");
    let cabinet = &graph.objects[0];
    assert_eq!(robot.parts[cabinet.part.at()].name, "cabinet");
    assert_eq!((cabinet.handles.len(), cabinet.surfaces.len()), (1, 0));
    let names: Vec<_> = graph.supports.iter().map(|s| robot.surfaces[s.at()].name.as_str()).collect();
    assert_eq!(names, ["cabinet/top", "cabinet/floor"]);
}

#[test]
fn a_default_margin_is_kept_between_parts_that_have_no_margin_of_their_own() {
    let text = PARTS.replacen(
        "name = \"test\"\n",
        "name = \"test\"\ndefault_margin = 0.02\nmargins = [{ pair = [\"cabinet/shell\", \"b\"], distance = 0.0 }]\n",
        1,
    );
    let scene = load(&text).unwrap_or_else(|e| panic!("{e}"));
    let robot = &scene.problem.robot;
    let name = |l: foliate::components::robot::LinkIndex| robot.links[l.at()].name.as_str();
    let mut margins: Vec<_> =
        scene.problem.margins.iter().map(|m| (name(m.first), name(m.second), m.distance)).collect();
    margins.sort_by(|a, b| a.partial_cmp(b).unwrap());
    // Nothing between links of the cabinet itself.
    let expected = [
        ("a/box", "b/box", 0.02),
        ("cabinet/shell", "a/box", 0.02),
        ("cabinet/shell", "b/box", 0.0),
        ("cabinet/tray", "a/box", 0.02),
        ("cabinet/tray", "b/box", 0.02),
    ];
    assert_eq!(margins, expected);
}

#[test]
fn a_robot_with_a_free_root_is_drawn_within_its_bounds() {
    use rand_chacha::rand_core::SeedableRng;
    let (_, robot) = options("");
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let root = robot.parts[1].root_joint.unwrap();
    let foliate::components::robot::Source::Coordinates { q: at, .. } = robot.joints[root.at()].source else {
        panic!("the root has coordinates")
    };
    let mut low = [f64::INFINITY; 3];
    for _ in 0..200 {
        let mut q = robot.space.neutral();
        robot.space.random(&mut rng, &mut q);
        assert_eq!(robot.space.first_out_of_bounds(&q, 0.0), None);
        assert!((q[at + 3..at + 7].iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-9);
        (0..3).for_each(|i| low[i] = low[i].min(q[at + i]));
    }
    assert!(low[0] < -0.8 && low[1] < -0.8 && low[2] < 0.2, "{low:?}");
}

/// A line that is wrong, the element that is blamed and what is said.
#[test]
fn mistakes_are_told_with_line_key_and_a_way_out() {
    let pose = "[[constraint]]\nname = \"p\"\nkind = \"pose\"\nframe = \"a/box\"\n";
    let centre = "[[constraint]]\nname = \"c\"\nkind = \"centre_of_mass\"\nframe = \"a/box\"\n";
    let apart = "[[constraint]]\nname = \"d\"\nkind = \"distance\"\nframe = \"a/box\"\nto = \"b/box\"\n";
    let state = "[[graph.state]]\nname = \"s\"\n";
    let goal = "[[goal]]\n";
    let polygon = |corners: &str| format!("polygon = [{corners}]\n");
    let cases: Vec<(String, &str, &str)> = vec![
        (format!("{pose}{pose}"), "constraint[1].name", "have this name"),
        (pose.replace("\"pose\"", "\"posse\""), "constraint[0].kind", "did you mean `pose`?"),
        (pose.replace("a/box", "a/bux"), "constraint[0].frame", "did you mean `a/box`?"),
        (format!("{pose}to = \"a/box\"\n"), "constraint[0]", "on one body"),
        (format!("{pose}to = {{ lnik = \"b/box\" }}\n"), "constraint[0].to.lnik", "did you mean `link`?"),
        (format!("{pose}value = \"now\"\n"), "constraint[0].value", "none of start"),
        (format!("{pose}value = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0]\n"), "constraint[0].value", "length 2"),
        (format!("{pose}mask = [1, 1, 1, 0, 0, 1]\n"), "constraint[0].mask", "exactly one"),
        (format!("{pose}mask = [0, 0, 0, 0, 0, 0]\n"), "constraint[0]", "no row"),
        (format!("{pose}mask = [1, 1, 1]\n"), "constraint[0].mask", "wants 6 values"),
        (
            format!("{pose}mask = [1, 0, 0, 0, 0, 0]\nparameter = [1, 0, 0, 0, 0, 0]\n"),
            "constraint[0]",
            "row tx is asked for twice",
        ),
        (format!("{pose}at_least = [0, 0, 0, 1, 0, 0]\n"), "constraint[0].at_least", "only translations"),
        (format!("{pose}polygon = []\n"), "constraint[0].polygon", "no key"),
        (centre.to_owned(), "constraint[0]", "either `value` or `polygon`"),
        (format!("{centre}value = [0.0, 0.0]\n"), "constraint[0].value", "wants 3 numbers"),
        (format!("{centre}value = \"start\"\nmask = [0, 0, 0]\n"), "constraint[0].mask", "no row"),
        (format!("{centre}value = \"start\"\nparts = []\n"), "constraint[0].parts", "is empty"),
        (format!("{centre}value = \"start\"\nparts = [\"c\"]\n"), "constraint[0].parts[0]", "no part `c`"),
        (format!("{centre}value = \"start\"\nparts = [\"b\", \"b\"]\n"), "constraint[0].parts[1]", "second time"),
        (
            format!("{centre}value = \"start\"\nparts = [\"b\", \"cabinet\"]\n"),
            "constraint[0].parts[1]",
            "no link of `cabinet` has a mass",
        ),
        (
            format!("{}value = [0.0, 0.0, 0.0]\n", centre.replace("\"a/box\"", "{}")),
            "constraint[0]",
            "key `parts` is missing",
        ),
        (format!("{centre}{}", polygon("[0.0, 0.0], [1.0, 0.0]")), "constraint[0].polygon", "2 corners"),
        (
            format!("{centre}{}", polygon("[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]")),
            "constraint[0].polygon",
            "counter-clockwise",
        ),
        (
            format!("{centre}{}margin = 0.4\n", polygon("[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]")),
            "constraint[0].polygon",
            "leaves nothing",
        ),
        (apart.to_owned(), "constraint[0]", "exactly one of"),
        (format!("{apart}length = 1.0\nat_most = 2.0\n"), "constraint[0]", "exactly one of"),
        (format!("{apart}at_least = 0.0\n"), "constraint[0].at_least", "not positive"),
        (
            "[[constraint]]\nname = \"j\"\nkind = \"joint\"\njoint = \"cabinet/drawer\"\nvalue = 3.0\n".into(),
            "constraint[0].value",
            "outside the bounds",
        ),
        (
            "[locked]\ncabinet = \"start\"\n[[constraint]]\nname = \"j\"\nkind = \"joint\"\njoint = \"cabinet/drawer\"\n\
             value = 0.0\n"
                .into(),
            "constraint[0].joint",
            "locked already",
        ),
        ("[locked]\ncabinet = \"now\"\n".into(), "locked.cabinet", "\"start\""),
        ("[locked]\ncabinet = 0.0\n".into(), "locked.cabinet", "is a part"),
        ("[graph]\neverywhere = [\"x\"]\n".into(), "graph.everywhere[0]", "no constraint `x`"),
        (format!("{state}{state}"), "graph.state[1].name", "have this name"),
        (format!("{state}constraint = []\n"), "graph.state[0].constraint", "did you mean `constraints`?"),
        (
            format!("{state}[[graph.transition]]\nfrom = \"s\"\nto = \"t\"\n"),
            "graph.transition[0].to",
            "no state `t`",
        ),
        (
            format!("{state}[[graph.transition]]\nfrom = \"s\"\nto = \"s\"\nlegs = [{{ short = true }}]\n"),
            "graph.transition[0].legs[0]",
            "`within` is missing",
        ),
        (
            format!("{state}[[graph.transition]]\nfrom = \"s\"\nto = \"s\"\n[[graph.transition]]\nfrom = \"s\"\nto = \"s\"\n"),
            "graph.transition[1]",
            "give each a `name`",
        ),
        (
            "[graph]\nresting_joints = { \"cabinet/drawer\" = 1.0 }\n".into(),
            "graph.resting_joints.cabinet/drawer",
            "outside the bounds",
        ),
        (
            "[graph]\nresting_joints = { \"cabinet/drawer\" = \"rests\" }\n".into(),
            "graph.resting_joints.cabinet/drawer",
            "none of stays",
        ),
        (
            "[locked]\n\"cabinet/drawer\" = 0.125\n[graph]\nresting_joints = { \"cabinet/drawer\" = 0.0 }\n".into(),
            "graph.resting_joints.cabinet/drawer",
            "locked as well",
        ),
        (
            "[graph]\nobjects = { cabinet = { plane = { pose = {} } } }\n".into(),
            "graph.objects.cabinet.plane",
            "lies nowhere",
        ),
        (goal.to_owned(), "goal[1]", "either `configuration`"),
        (format!("{goal}coordinates = {{ \"a/qx\" = 1.0 }}\n"), "goal[1].coordinates", "part of the rotation"),
        (format!("{goal}coordinates = {{ \"a/x\" = 3.0 }}\n"), "goal[1].coordinates.a/x", "outside the bounds"),
        (format!("{goal}constraints = [\"x\"]\n"), "goal[1].constraints[0]", "no constraint `x`"),
        (
            format!("[locked]\ncabinet = \"start\"\n{goal}coordinates = {{ \"cabinet/drawer\" = 0.0 }}\n"),
            "goal[1].coordinates.cabinet/drawer",
            "locked at another",
        ),
    ];
    for (more, element, says) in cases {
        let error = load(&format!("{PARTS}{more}")).map(|_| ()).expect_err(&more);
        assert_eq!(error.element, element, "{error}\n{more}");
        assert!(error.to_string().contains(says), "{error}\n{more}");
        assert!(error.line.is_some_and(|l| l as usize >= PARTS.lines().count()), "{error}\n{more}");
    }
}

#[test]
fn lists_without_end_are_refused_before_they_are_read() {
    let constraints = "[[constraint]]\nname = \"p\"\n".repeat(1001);
    let states = "[[graph.state]]\nname = \"p\"\n".repeat(1001);
    let corners = format!(
        "[[constraint]]\nname = \"c\"\nkind = \"centre_of_mass\"\nframe = \"a/box\"\npolygon = [{}]\n",
        "[0.0, 0.0], ".repeat(1001)
    );
    for (more, says) in [(constraints, "more than 1000"), (states, "at most 1000"), (corners, "1001 corners")] {
        let error = load(&format!("{PARTS}{more}")).map(|_| ()).unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
    }
}
