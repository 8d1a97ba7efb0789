//! Promise: `foliate new` writes scenes that solve and are proved, the same file for the same models and seed; what it finds in a hand and
//! on an object is right to within what a ruler shows; what it cannot do it refuses with sizes and a way out.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]
#![allow(non_snake_case, reason = "pose names carry their frames")]

#[path = "common/recorded.rs"]
mod recorded;

use foliate::components::Pose;
use foliate::components::robot::model::{LinkModel, Model};
use foliate::components::robot::shape::Geometry;
use foliate::glam::DVec3;
use foliate::scene::{PackagePath, UpAxis, read_model};
use foliate::setup::grippers::{FoundGripper, GripperKind, grippers};
use foliate::setup::handles::{HandleSettings, handles};
use foliate::setup::objects::RigidObject;
use foliate::setup::surfaces::{level_faces, lying_on, resting_faces};
use recorded::Folder;
use std::process::{Command, Output};

const ROBOT: &str = "package://foliate_scenes/demo/robot.urdf";

fn foliate(folder: &Folder, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
    command.args(arguments).current_dir(&folder.0).arg("--no-mesh-cache").output().expect("the program runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

fn hands() -> Vec<FoundGripper> {
    let mut read = read_model(ROBOT, None, UpAxis::AsWritten, &PackagePath::default()).expect("the demo's robot");
    grippers(&read.compose_as("robot").expect("composes"), &[], &[]).expect("two hands")
}

fn object(geometry: Geometry) -> RigidObject {
    let link = LinkModel { name: "body".into(), shapes: vec![(Pose::identity(), geometry)], inertial: None };
    let model = Model { name: "object".into(), links: vec![link], ..Model::default() };
    RigidObject::of("object", &model).expect("an object")
}

/// A mesh of a box: six faces of triangles.
fn box_mesh(half: DVec3) -> Geometry {
    let vertices: Vec<DVec3> = (0..8).map(|i: u32| half * DVec3::new(sign(i & 1), sign(i & 2), sign(i & 4))).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mesh = foliate::components::robot::shape::Mesh::new("box".into(), vertices, triangles);
    Geometry::Mesh(std::sync::Arc::new(mesh))
}

fn sign(bit: u32) -> f64 {
    if bit == 0 { -1.0 } else { 1.0 }
}

#[test]
fn the_demo_robots_hands_are_found_as_they_are_built() {
    let hands = hands();
    assert_eq!(hands.len(), 2);
    for hand in &hands {
        // The fingers are boxes on slides: scenes/demo/robot.urdf.
        let GripperKind::Jaws { opening, depth, tip, .. } = hand.kind else { panic!("{hand:?}") };
        assert!(opening > 0.05 && opening < 0.09, "{opening}");
        assert!(depth > 0.01 && tip > 0.0 && tip <= 0.0121, "{depth} {tip}");
        // x of the hand is x of its palm.
        let approach = hand.link_from_gripper.rotation * DVec3::X;
        assert!(approach.distance(DVec3::X) < 1e-9, "{approach}");
        let closing = hand.link_from_gripper.rotation * DVec3::Y;
        assert!((closing.y.abs() - 1.0).abs() < 1e-9, "{closing}");
        assert!(hand.fingers.iter().all(|finger| finger.open > finger.closed));
    }
}

#[test]
fn handles_hold_opposite_faces_and_fit_the_hand() {
    let hand = &hands()[0];
    let GripperKind::Jaws { opening, .. } = hand.kind else { panic!("jaws") };
    let half = DVec3::new(0.02, 0.025, 0.05);
    for geometry in [Geometry::Box { half_extents: half }, box_mesh(half)] {
        let object = object(geometry);
        let found = handles(&object, hand, HandleSettings::default());
        assert!(found.len() >= 4, "{}", found.len());
        for handle in &found {
            let X = handle.link_from_handle;
            let closing = (X.rotation * DVec3::Y).abs();
            // Two opposite faces: the closing direction is an axis of the box, and the box fits between the jaws along it.
            assert!(closing.max_element() > 0.999, "{closing}");
            assert!(2.0 * closing.dot(half) < opening, "{closing}");
            assert!((X.translation.abs() - half).max_element() < 1e-9, "the middle of a grasp is inside: {X:?}");
        }
        assert_eq!(found, handles(&object, hand, HandleSettings::default()), "the same seed, the same handles");
    }
    let wide = object(Geometry::Box { half_extents: DVec3::splat(0.1) });
    assert!(handles(&wide, hand, HandleSettings::default()).is_empty());
    let ball = handles(&object(Geometry::Sphere { radius: 0.02 }), hand, HandleSettings::default());
    assert_eq!(ball.iter().map(|h| h.mask).collect::<Vec<_>>(), [[true, true, true, false, false, false]]);
    let can = handles(&object(Geometry::Cylinder { radius: 0.02, half_length: 0.05 }), hand, HandleSettings::default());
    assert!(can.iter().any(|h| !h.mask[5]) && can.iter().any(|h| !h.mask[3]), "{can:?}");
}

#[test]
fn objects_rest_on_faces_that_hold_their_centre_of_mass() {
    let half = DVec3::new(0.02, 0.03, 0.05);
    let object = object(box_mesh(half));
    let faces = resting_faces(&object);
    assert_eq!(faces.len(), 6);
    assert!((faces[0].normal + DVec3::Z).length() < 1e-9, "the face below comes first");
    for (face, yaw) in faces.iter().zip([0.0, 0.4, 1.1, -2.0, 3.0, 0.2]) {
        let X_WO = lying_on(&object, face, (0.3, -0.2, 0.7), 0.001, yaw);
        let lowest = face.points.iter().map(|p| X_WO.transform_point(*p).z);
        assert!(lowest.into_iter().all(|z| (z - 0.701).abs() < 1e-9));
        assert!(X_WO.transform_point(DVec3::ZERO).z > 0.71);
    }
    // A plank that stands on its narrow side would tip over.
    let plank = super_thin();
    assert_eq!(resting_faces(&plank).len(), 2);
    // What looks up carries.
    let tops = level_faces(&object, &Pose::from_translation(DVec3::Z));
    assert_eq!(tops.len(), 1);
    assert!(tops[0].points.iter().all(|p| (p.z - half.z).abs() < 1e-9));
}

/// A plank of 1 cm.
fn super_thin() -> RigidObject {
    object(Geometry::Box { half_extents: DVec3::new(0.1, 0.05, 0.005) })
}

#[test]
fn new_scenes_solve_are_proved_and_are_the_same_again() {
    let folder = Folder::new("new-scene");
    std::fs::write(folder.0.join("wedge.stl"), wedge()).expect("a mesh");
    let arguments = ["--robot", ROBOT, "--table", "1.2 0.8 0.7", "--seed", "3", "--object"];
    for (name, object) in [("box", "box 0.04 0.05 0.1"), ("can", "cylinder 0.02 0.1"), ("wedge", "wedge.stl 0.001")] {
        let file = format!("{name}.toml");
        let output = foliate(&folder, &[&["new", &file], &arguments[..], &[object]].concat());
        assert_eq!(output.status.code(), Some(0), "{name}: {}", said(&output));
        let text = std::fs::read(folder.0.join(&file)).expect("the scene");
        let output = foliate(&folder, &[&["new", &file, "--force"], &arguments[..], &[object]].concat());
        assert_eq!(output.status.code(), Some(0), "{name}: {}", said(&output));
        assert_eq!(std::fs::read(folder.0.join(&file)).expect("the scene"), text, "{name}: the same scene again");
        let path = format!("{name}.json");
        let output = foliate(&folder, &["solve", &file, "--first", "--out", &path]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", said(&output));
        let output = foliate(&folder, &["check", &path]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", said(&output));
    }
    // The mesh lies beside the path: the scene's folder is not needed to read it.
    assert!(folder.0.join("wedge.models/wedge/wedge.stl").is_file());
}

/// A wedge as a binary STL, millimetres: 40 x 50 x 60, its ridge in the middle.
fn wedge() -> Vec<u8> {
    let p = [
        [-20.0, -25.0, 0.0],
        [20.0, -25.0, 0.0],
        [20.0, 25.0, 0.0],
        [-20.0, 25.0, 0.0],
        [0.0, -25.0, 60.0],
        [0.0, 25.0, 60.0],
    ];
    let triangles = [[0, 3, 2], [0, 2, 1], [0, 1, 4], [2, 3, 5], [1, 2, 5], [1, 5, 4], [3, 0, 4], [3, 4, 5]];
    let mut bytes = vec![0_u8; 80];
    bytes.extend(8_u32.to_le_bytes());
    for triangle in triangles {
        bytes.extend([0_u8; 12]);
        bytes.extend(triangle.iter().flat_map(|&i: &usize| p[i]).flat_map(|x: f32| x.to_le_bytes()));
        bytes.extend([0_u8; 2]);
    }
    bytes
}

#[test]
fn grasps_of_others_are_taken() {
    let folder = Folder::new("given-grasps");
    // From above, jaws along y; the file's frames approach along z and close along x.
    std::fs::write(folder.0.join("grasps.txt"), "# x y z qx qy qz qw score\n0 0 0.03 0.7071068 0.7071068 0 0 0.9\n")
        .expect("a file");
    let new = |file: &str| {
        let grasps = ["--grasps", "grasps.txt", "--grasp-axes", "zx"];
        foliate(
            &folder,
            &[&["new", file, "--robot", ROBOT, "--table", "1.2 0.8 0.7", "--object", "box 0.04 0.05 0.1"], &grasps[..]]
                .concat(),
        )
    };
    let output = new("given.toml");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let text = std::fs::read_to_string(folder.0.join("given.toml")).expect("the scene");
    assert_eq!(text.matches("[[part.handle]]").count(), 1, "{text}");
    std::fs::write(folder.0.join("grasps.txt"), "0 0 0.03\n").expect("a file");
    let output = new("wrong.toml");
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("grasps.txt:1: grasp: wants 7 or 8 numbers, got 3"), "{}", said(&output));
}

#[test]
fn what_cannot_be_done_is_refused_with_the_way_out() {
    let folder = Folder::new("new-refused");
    let new = |more: &[&str]| foliate(&folder, &[&["new", "refused.toml", "--robot", ROBOT], more].concat());
    let cases: [(&[&str], &str); 9] = [
        (&["--object", "box 0.3 0.3 0.3"], "`box` cannot be held: it is 300 x 300 x 300 mm"),
        (&["--object", "cube 1"], "is no object; write \"box X Y Z\""),
        (&["--object", "mug.stl"], "mug.stl"),
        (&["--object", "box 0.05 0.05 0.1", "--table", "wide"], "is no table"),
        (&["--object", "box 0.05 0.05 0.1", "--gripper", "left_plam"], "the robot has no link `left_plam`"),
        (
            &["--object", "box 0.05 0.05 0.1", "--table", "1 1 9"],
            "is within reach and free of collision at 20 places on the table",
        ),
        (&["--object", "box 0.05 0.05 0.1", "--grasp-axes", "xx"], "are no axes"),
        (&["--object", "box 0.05 0.05 0.1", "--grasps", "none.txt"], "none.txt"),
        (&["--object", "box 0.009 0.009 0.2"], "rests on none of its faces"),
    ];
    for (more, words) in cases {
        let output = new(more);
        assert_eq!(output.status.code(), Some(2), "{more:?}: {}", said(&output));
        assert!(said(&output).contains(words), "{more:?}: {}", said(&output));
        assert!(!folder.0.join("refused.toml").exists());
    }
    std::fs::write(folder.0.join("there.toml"), "kept").expect("a file");
    let output = foliate(&folder, &["new", "there.toml", "--robot", ROBOT, "--object", "box 0.05 0.05 0.1"]);
    assert!(said(&output).contains("--force"), "{}", said(&output));
    assert_eq!(std::fs::read(folder.0.join("there.toml")).expect("the file"), b"kept");
}

#[test]
fn copies_of_shipped_scenes_solve_anywhere() {
    let folder = Folder::new("copies");
    for name in ["demo", "stack", "drawer"] {
        let output = foliate(&folder, &["scenes", "--show", name]);
        assert!(output.status.success());
        let file = format!("my-{name}.toml");
        std::fs::write(folder.0.join(&file), &output.stdout).expect("a file");
        let path = format!("{name}.json");
        let output = foliate(&folder, &["solve", &file, "--first", "--seed", "1", "--out", &path]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", said(&output));
        assert_eq!(foliate(&folder, &["check", &path]).status.code(), Some(0), "{name}");
    }
    let scene = "package://foliate_scenes/demo/robbot.urdf";
    let output = foliate(&folder, &["inspect", scene]);
    assert!(
        said(&output).contains("the program has no such file (did you mean `demo/robot.urdf`?)"),
        "{}",
        said(&output)
    );
}

#[test]
fn inspect_lists_which_links_touch_and_where_grippers_are() {
    let folder = Folder::new("matrix");
    let output = foliate(&folder, &["inspect", ROBOT, "--collision-matrix", "--json"]);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let pairs = found["collision_matrix"]["pairs"].as_array().expect("pairs");
    let reason = |reason: &str| pairs.iter().filter(|pair| pair["reason"] == reason).count();
    assert!(reason("adjacent") > 4 && reason("never") > 4, "{pairs:?}");
    assert_eq!(found["found_grippers"].as_array().map(Vec::len), Some(2));
    assert_eq!(found["link_poses"]["body"].as_array().map(Vec::len), Some(7));
    let text = said(&foliate(&folder, &["inspect", ROBOT, "--collision-matrix"]));
    assert!(text.contains("For a scene, so that the default configuration is free: ignore = [\"adjacent\""), "{text}");
}

/// The blocks of a scene without those that begin with one of these headers, and the keys of a part before its first block.
fn found_anew(text: &str) -> String {
    let (mut kept, mut left_out) = (String::new(), false);
    for line in text.lines() {
        left_out = match line.starts_with('[') {
            true => ["[[part.gripper]]", "[[part.handle]]", "[[part.surface]]", "[graph.grasps]"]
                .iter()
                .any(|header| line.starts_with(header)),
            false => left_out,
        };
        if !left_out {
            kept += line;
            kept.push('\n');
        }
        let keys = match line {
            "kind = \"robot\"" => "grippers = \"auto\"\n",
            "kind = \"object\"" => "handles = \"auto\"\nsurfaces = \"auto\"\n",
            "kind = \"environment\"" => "surfaces = \"auto\"\n",
            _ => "",
        };
        kept += keys;
    }
    kept
}

#[test]
fn what_is_found_when_a_scene_is_read_is_what_would_be_written() {
    let folder = Folder::new("found-anew");
    std::fs::write(folder.0.join("wedge.stl"), wedge()).expect("a mesh");
    let objects = ["--object", "box 0.04 0.05 0.1", "--object", "cylinder 0.02 0.1", "--object", "wedge.stl 0.001"];
    let output = foliate(
        &folder,
        &[&["new", "written.toml", "--robot", ROBOT, "--table", "1.2 0.8 0.7"], &objects[..]].concat(),
    );
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let written = std::fs::read_to_string(folder.0.join("written.toml")).expect("the scene");
    let anew = found_anew(&written);
    for header in ["[[part.gripper]]", "[[part.handle]]", "[[part.surface]]"] {
        assert!(written.contains(header) && !anew.contains(header), "{anew}");
    }
    let load = |text: &str| {
        foliate::scene::Scene::from_text("scene", text, &folder.0, &PackagePath::default()).expect("a scene").problem
    };
    let (written, anew) = (load(&written), load(&anew));
    let told = |problem: &foliate::components::problem::Problem| {
        let robot = &problem.robot;
        assert!(robot.grippers.len() == 2 && robot.handles.len() > 20 && robot.surfaces.len() > 10);
        format!(
            "{:#?}\n{:#?}\n{:#?}\n{:#?}\n{:#?}\n{:#?}",
            robot.grippers, robot.handles, robot.surfaces, problem.graph, problem.start, problem.goals
        )
    };
    let (written, anew) = (told(&written), told(&anew));
    let differs = written.lines().zip(anew.lines()).find(|(a, b)| a != b);
    assert!(written == anew, "{differs:?}");
}

#[test]
fn what_cannot_be_found_is_refused_at_its_key() {
    let folder = Folder::new("found-nothing");
    let scene = |robot: &str, object: &str, table: &str| {
        let text = format!(
            "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"robot\"\nkind = \"robot\"\nurdf = \"{ROBOT}\"\n{robot}\n\
             [[part]]\nname = \"box\"\nkind = \"object\"\n{object}\n[[part]]\nname = \"table\"\nkind = \"environment\"\n{table}\n\
             [start]\nbox = {{ xyz = [0.5, 0.0, 1.0] }}\n[[goal]]\nobjects = {{ box = {{ xyz = [0.5, 0.1, 1.0] }} }}\n"
        );
        let read = foliate::scene::Scene::from_text("scene", &text, &folder.0, &PackagePath::default());
        read.map(|_| ()).expect_err(&text).to_string()
    };
    let (hands, small) = ("grippers = \"auto\"", "shape = { box = [0.04, 0.05, 0.1] }\nhandles = \"auto\"");
    let top = "shape = { box = [1, 1, 0.1] }\nsurfaces = \"auto\"";
    for ((robot, object, table), key, words) in [
        (("handles = \"auto\"", small, top), "part[0].handles", "`handles` are found of objects"),
        (("grippers = \"all\"", small, top), "part[0].grippers", "auto"),
        (("", small, top), "part[1].handles", "no robot of the scene has a gripper"),
        ((hands, &small.replace("0.04, 0.05", "0.4, 0.5"), top), "part[1].handles", "it is 400 x 500 x 100 mm"),
        ((hands, "shape = { sphere = 0.02 }\nsurfaces = \"auto\"", top), "part[1].surfaces", "a ball rests on no face"),
        ((hands, small, "shape = { sphere = 0.2 }\nsurfaces = \"auto\""), "part[2].surfaces", "no face of it is level"),
        (
            ("[[part.gripper]]\nname = \"g\"\nlink = \"left_palm\"\npose = { rpy = [0, 0, 1] }", small, top),
            "part[0]",
            "gripper `g` says no sizes",
        ),
    ] {
        let told = scene(robot, object, table);
        assert!(told.contains(key) && told.contains(words), "{key}: {told}");
    }
}

#[test]
fn end_effectors_of_an_srdf_are_the_grippers() {
    let folder = Folder::new("end-effectors");
    let srdf = "<robot name=\"r\">\n<group name=\"hand\"><joint name=\"left_finger\"/></group>\n\
                <end_effector name=\"left\" parent_link=\"left_palm\" group=\"hand\"/>\n\
                <end_effector name=\"lost\" parent_link=\"nowhere\" group=\"hand\"/>\n</robot>\n";
    std::fs::write(folder.0.join("r.srdf"), srdf).expect("a file");
    let arguments = ["new", "s.toml", "--robot", ROBOT, "--srdf", "r.srdf", "--object", "box 0.04 0.05 0.1"];
    let output = foliate(&folder, &[&arguments[..], &["--table", "1.2 0.8 0.7 0.6 0.0"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let told = said(&output);
    assert!(told.contains("gripper left: end effector `left` of the SRDF, jaws moved by"), "{told}");
    assert!(told.contains("r.srdf:4") && told.contains("`nowhere`, is not in the URDF"), "{told}");
    let text = std::fs::read_to_string(folder.0.join("s.toml")).expect("the scene");
    assert_eq!(text.matches("[[part.gripper]]").count(), 1, "{text}");
    // The table stands where it was wanted.
    assert!(text.contains("pose = { xyz = [0.6, 0.0, 0.68]") && text.contains("# as wanted"), "{text}");
    assert_eq!(text.matches("adjacent").count(), 1, "{text}");
}
