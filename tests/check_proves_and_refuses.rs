//! `foliate check` must be able to fail: good paths pass, and every kind of wrong path is refused by its name.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

#[path = "common/story.rs"]
mod story;

use foliate::Planner;
use foliate::check::{CheckOptions, Kind, Verdict, check};
use foliate::path_file::{PathContext, PathFile, save, write_path};
use foliate::scene::{PackagePath, Scene};
use serde_json::{Value, json};
use story::*;

fn assert_only(folder: &Folder, path: &Value, kinds: &[&str]) {
    assert_eq!(folder.kinds(path), kinds, "{:#?}", folder.check(path).map(|r| r.violations));
}

/// The story with a thin plate in the elbow's way, touched only between the knots.
fn with_plate(radius: f64, angle: f64) -> Value {
    let mut path = story();
    let pose = about_z(0.5 + radius * angle.cos(), radius * angle.sin(), 0.5, angle);
    push(&mut path["parts"], part("plate", "environment", "fixed", pose));
    path
}

fn push(list: &mut Value, item: Value) {
    list.as_array_mut().unwrap().push(item);
}

/// A path of nothing but these parts and one segment.
fn alone(parts: Vec<Value>, coordinates: Value, knots: Vec<Value>) -> Value {
    let mut path = story();
    path["parts"] = Value::Array(parts);
    path["coordinates"] = coordinates;
    path["limits"] = json!({});
    path["documents"] = json!({ "grippers": {}, "handles": {}, "surfaces": {} });
    path["segments"] = json!([segment(json!([]), knots)]);
    path["certificate"]["min_clearance"] = json!(0.0);
    path
}

fn root_of(name: &str) -> Value {
    json!(["x", "y", "z", "qx", "qy", "qz", "qw"].map(|axis| format!("{name}/{axis}")))
}

#[test]
fn a_planned_path_passes_and_survives_its_file() {
    let folder = Folder::new();
    let scene = Scene::load("demo", &PackagePath::only(&[])).unwrap();
    let planner = Planner::new(scene.problem.clone()).unwrap();
    let solution = planner.solve().unwrap();
    let out = folder.path.join("demo.json");
    let models = save::model_names(&scene, &out).unwrap();
    let context = PathContext {
        problem: &planner.model().problem,
        graph: &planner.model().graph,
        models: &models,
        seed: 1,
        scheduler: "mrrt",
        simd: foliate::kernels::lanes::Level::detected().name(),
    };
    save::save(&write_path(&context, &solution.path), &out).unwrap();
    let file = save::read(&out).unwrap();
    let prove = |file: &PathFile, work_limit| {
        check(file, &folder.path, &PackagePath::only(&[]), &CheckOptions { work_limit, ..CheckOptions::default() })
            .unwrap()
    };
    let report = prove(&file, 1_000_000);
    assert!(report.passed(), "{:#?}", report.violations);
    assert!(report.min_clearance.unwrap().value >= file.certificate.min_clearance.unwrap());

    // A check that may not work proves nothing.
    assert!(prove(&file, 100).has(Kind::Undecided));

    // A joint of the robot a little off where segments meet is seen.
    for (segment, entry) in file.segments.iter().enumerate() {
        let mut spoiled = file.clone();
        spoiled.segments[segment].knots[0][segment % 6] += 1e-9;
        assert!(segment == 0 || prove(&spoiled, 1_000_000).has(Kind::SharedKnot), "{}", entry.transition);
    }
}

#[test]
fn the_story_is_valid() {
    let folder = Folder::new();
    let report = folder.check(&story()).unwrap();
    assert!(report.passed(), "{:#?}", report.violations);
    let nearest = report.min_clearance.unwrap();
    assert!((nearest.value - 0.001).abs() < 1e-6, "{nearest:?}");
    assert!(report.max_residual.unwrap().value < 1e-12);
}

#[test]
fn the_order_of_coordinates_does_not_matter() {
    let folder = Folder::new();
    let mut path = story();
    let turn = |list: &mut Value| list.as_array_mut().unwrap().rotate_left(2);
    turn(&mut path["coordinates"]);
    for segment in path["segments"].as_array_mut().unwrap() {
        segment["knots"].as_array_mut().unwrap().iter_mut().for_each(turn);
    }
    assert_only(&folder, &path, &[]);
}

mod collisions {
    use super::*;

    #[test]
    fn an_elbow_opens_past_a_thin_plate_between_two_knots() {
        let folder = Folder::new();
        let path = with_plate(0.3, -0.15);
        assert_only(&folder, &path, &["collision"]);
        let report = folder.check(&path).unwrap();
        let found = &report.violations[0];
        assert_eq!((found.segment, found.subject.as_str()), (Some(0), "arm/lower - plate/plate"));
        assert!(found.t.is_some_and(|t| 1.0 < t && t < 2.0), "{found:?}");
        assert_only(&folder, &with_plate(0.52, -0.15), &[]);
    }

    #[test]
    fn a_carried_cube_swings_past_a_thin_post() {
        let folder = Folder::new();
        folder.write("post.urdf", &robot(&[link("post", &cuboid(0.001, 0.001, 0.05), 0.0)]));
        let mut path = story();
        let at = |radius: f64| about_z(radius * 0.075_f64.cos(), radius * 0.075_f64.sin(), 0.5, 0.0);
        push(&mut path["parts"], part("post", "environment", "fixed", at(1.015)));
        path["segments"][1]["knots"] = json!([held_knot(0.0, 0.0), held_knot(0.2, 0.0)]);
        path["segments"][2]["knots"] = json!([held_knot(0.2, 0.0), knot(0.2, -0.6, in_hand(0.2, 0.0))]);
        assert_only(&folder, &path, &["collision"]);
        assert_eq!(folder.subject(&path), "cube/cube - post/post");
        path["parts"][3] = part("post", "environment", "fixed", at(1.03));
        assert_only(&folder, &path, &[]);
    }

    #[test]
    fn a_robot_turns_on_the_geodesic_into_a_post() {
        let folder = Folder::new();
        folder.write("bar.urdf", &robot(&[link("bar", &cuboid(1.0, 0.02, 0.02), 0.0)]));
        folder.write("post.urdf", &robot(&[link("post", &cuboid(0.002, 0.002, 0.5), 0.0)]));
        let beside = about_z(0.45 * 0.7_f64.cos(), 0.45 * 0.7_f64.sin(), 0.0, 0.0);
        let path = |z: f64| {
            let parts = vec![part("bar", "robot", "freeflyer", IDENTITY), part("post", "environment", "fixed", beside)];
            alone(parts, root_of("bar"), vec![json!(about_z(0.0, 0.0, z, 0.0)), json!(about_z(0.0, 0.0, z, 1.5))])
        };
        assert_only(&folder, &path(0.0), &["collision"]);
        assert_only(&folder, &path(1.0), &[]);
    }

    #[test]
    fn a_planar_root_moves_in_its_plane() {
        let folder = Folder::new();
        folder.write("bar.urdf", &robot(&[link("bar", &cuboid(1.0, 0.02, 0.02), 0.0)]));
        let pose = about_z(0.0, 0.0, 0.5, 0.0);
        let path = |knots: Vec<Value>| {
            let plate = part("plate", "environment", "fixed", about_z(2.0, 0.0, 0.5, 0.0));
            let parts = vec![part("bar", "robot", "planar", pose), plate];
            let mut path = alone(parts, json!(["bar/x", "bar/y", "bar/theta"]), knots);
            path["limits"] = json!({ "bar/x": [-1.0, 5.0] });
            path
        };
        assert_only(&folder, &path(vec![json!([0, -1, 0]), json!([4, 1, 6.5])]), &["collision"]);
        assert_only(&folder, &path(vec![json!([0, 1, 0]), json!([6, 1, 6.5])]), &["limit"]);
    }

    #[test]
    fn pairs_are_left_out_for_a_reason_that_is_told() {
        let folder = Folder::new();
        let mut path = with_plate(0.3, -0.15);
        path["ignored_pairs"] = json!([["arm/lower", "plate/plate", "by hand"]]);
        let report = folder.check(&path).unwrap();
        let Verdict::Relative(reasons) = report.verdict() else { panic!("{:?}", report.verdict()) };
        assert!(reasons.iter().any(|reason| reason == "1 link pairs ignored by the file: by hand"), "{reasons:?}");
    }

    #[test]
    fn disabled_pairs_come_from_the_srdf() {
        let folder = Folder::new();
        let longer = arm(&[]).replacen("0.4 0.04 0.04", "0.6 0.04 0.04", 1);
        folder.write("arm.urdf", &longer);
        assert_only(&folder, &story(), &[]);
        folder.write("arm.srdf", &ARM_SRDF.replace("link1=\"upper\"", "link1=\"base\""));
        assert_only(&folder, &story(), &["collision"]);
    }

    #[test]
    fn margins_are_kept_but_not_where_things_touch() {
        let folder = Folder::new();
        let mut path = story();
        path["certificate"]["min_clearance"] = json!(0.0);
        let mut with = |margins: Value| {
            path["margins"] = margins;
            path.clone()
        };
        assert_only(&folder, &with(json!([["arm/upper", "table/top", 0.05]])), &[]);
        assert_only(&folder, &with(json!([["arm/lower", "table/top", 0.01]])), &["margin"]);
        let touching = json!([["cube/cube", "table/top", 0.01], ["arm/lower", "cube/cube", 0.05]]);
        assert_only(&folder, &with(touching), &[]);
    }

    #[test]
    fn margins_are_lifted_along_the_whole_transition_that_ends_the_touch() {
        let folder = Folder::new();
        let mut path = story();
        path["certificate"]["min_clearance"] = json!(0.0);
        path["margins"] = json!([["arm/lower", "cube/cube", 0.05]]);
        let cube = in_hand(0.1, 0.0);
        let turn = |from: f64, to: f64| segment(json!([placed()]), vec![knot(0.1, from, cube), knot(0.1, to, cube)]);
        path["segments"][2] = turn(0.0, -0.05);
        path["segments"].as_array_mut().unwrap().push(turn(-0.05, -0.6));
        let mut with = |names: [&str; 2]| {
            path["segments"][2]["transition"] = json!(names[0]);
            path["segments"][3]["transition"] = json!(names[1]);
            path.clone()
        };
        assert_only(&folder, &with(["let go", "let go"]), &[]);
        assert_only(&folder, &with(["let go", "go on"]), &["margin"]);
        assert_only(&folder, &with(["", ""]), &["margin"]);
    }

    #[test]
    fn a_cube_inside_a_closed_mesh_is_not_free() {
        let folder = Folder::new();
        folder.write("shell.stl", &cube_as_stl(0.2));
        folder.write("shell.urdf", &robot(&[link("shell", r#"<mesh filename="shell.stl"/>"#, 0.0)]));
        let path = |x: f64| {
            let shell = part("shell", "environment", "fixed", about_z(1.0, 0.0, 0.5, 0.0));
            let cube = json!(about_z(x, 0.0, 0.5, 0.0));
            alone(vec![part("cube", "object", "freeflyer", IDENTITY), shell], root_of("cube"), vec![cube.clone(), cube])
        };
        assert_only(&folder, &path(1.0), &["enclosed"]);
        assert_only(&folder, &path(1.3), &[]);
        assert_only(&folder, &path(1.1), &["collision"]);
    }

    fn cube_as_stl(side: f64) -> String {
        let mut text = String::from("solid cube\n");
        for axis in 0..3 {
            for end in [0.0, 1.0] {
                let corner = |u: f64, v: f64| {
                    let mut p = [0.0; 3];
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (end, u, v);
                    p.map(|x| (x - 0.5) * side)
                };
                let mut ring = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
                if end == 0.0 {
                    ring.reverse();
                }
                for triangle in [[ring[0], ring[1], ring[2]], [ring[0], ring[2], ring[3]]] {
                    text.push_str("facet normal 0 0 0\nouter loop\n");
                    triangle.iter().for_each(|[x, y, z]| text.push_str(&format!("vertex {x} {y} {z}\n")));
                    text.push_str("endloop\nendfacet\n");
                }
            }
        }
        text + "endsolid cube\n"
    }
}

mod structure {
    use super::*;

    #[test]
    fn a_jumped_knot() {
        let folder = Folder::new();
        for off in [1e-13, -0.0] {
            let mut path = story();
            path["segments"][1]["knots"][0][0] = json!(off);
            assert_only(&folder, &path, &["shared-knot"]);
        }
    }

    #[test]
    fn limits_of_joints_and_bounds_of_objects() {
        let folder = Folder::new();
        let mut path = story();
        path["limits"]["arm/elbow"] = json!([-0.5, 3.0]);
        assert_only(&folder, &path, &["limit"]);
        let report = folder.check(&path).unwrap();
        let found = &report.violations[0];
        assert_eq!((found.subject.as_str(), found.value, found.limit), ("arm/elbow below", Some(-0.6), Some(-0.5)));
        assert!(report.notes.iter().any(|n| n.contains("the model says [-3, 3]")), "{:?}", report.notes);

        let mut path = story();
        path["limits"]["cube/y"] = json!([-0.05, 0.05]);
        let report = folder.check(&path).unwrap();
        assert!(report.violations.iter().all(|v| v.kind == Kind::ObjectBounds && v.segment == Some(2)));
        assert!(!report.passed());
    }

    #[test]
    fn limits_that_the_file_leaves_out_are_the_models() {
        let folder = Folder::new();
        folder.write("arm.urdf", &arm(&[]).replace("lower=\"-3\"", "lower=\"-0.5\""));
        let mut path = story();
        path["limits"] = json!({});
        assert_only(&folder, &path, &["limit"]);
    }

    #[test]
    fn a_follower_moves_with_its_leader_and_obeys_its_limits() {
        let folder = Folder::new();
        let mimic = r#"<mimic joint="elbow" multiplier="-1"/>"#;
        let follower = joint("tip", "lower", "finger", [0.5, 0.3, 0.0], mimic);
        folder.write("arm.urdf", &arm(&[link("finger", &cuboid(0.01, 0.01, 0.01), 0.0), follower.clone()]));
        assert_only(&folder, &story(), &[]);
        let mut path = story();
        path["parts"][0]["mimic"] = json!("free");
        let refused = folder.check(&path).unwrap_err();
        assert!(refused.contains("arm/tip"), "{refused}");
        let narrow = follower.replace("upper=\"3\"", "upper=\"0.5\"");
        folder.write("arm.urdf", &arm(&[link("finger", "", 0.0), narrow]));
        assert_only(&folder, &story(), &["follower-limit"]);
    }

    #[test]
    fn quaternions() {
        let folder = Folder::new();
        for (factor, kind) in [(-1.0, "quaternion-sign"), (1.001, "quaternion-norm")] {
            let mut path = story();
            let knot = &mut path["segments"][2]["knots"][1];
            (5..9).for_each(|i| knot[i] = json!(knot[i].as_f64().unwrap() * factor));
            assert_only(&folder, &path, &[kind]);
        }
    }

    #[test]
    fn documents_times_and_claims() {
        let folder = Folder::new();
        let spoiled = |pointer: &str, value: Value| {
            let mut path = story();
            *path.pointer_mut(pointer).unwrap() = value;
            path
        };
        let gripper = "/documents/grippers/arm~1hand/link_from_gripper/0";
        assert_only(&folder, &spoiled(gripper, json!(0.5001)), &["document"]);
        assert_only(&folder, &spoiled("/certificate/min_clearance", json!(0.002)), &["certificate"]);
        assert_only(&folder, &spoiled("/certificate/path_tolerance", json!(0.1)), &["path-tolerance"]);
        let mut path = story();
        path["segments"][0]["times"] = json!([0.0, 2.0, 1.0]);
        assert_only(&folder, &path, &["times"]);
    }
}

mod leaves {
    use super::*;

    #[test]
    fn objects_stay_on_what_carries_them() {
        let folder = Folder::new();
        let mut path = story();
        path["segments"][1]["knots"][1][2] = json!(in_hand(0.05, 0.0)[0] + 2e-5);
        assert_only(&folder, &path, &["object-off-carrier"]);
        let mut path = story();
        path["segments"][0]["knots"][1][3] = json!(1e-3);
        assert_only(&folder, &path, &["placed-object-moved"]);
        path["segments"][0]["attachments"] = json!([]);
        assert_only(&folder, &path, &["unattached-object-moved"]);
        path["segments"][0]["attachments"] = json!([{ "object": "cube", "carrier": true }]);
        assert_only(&folder, &path, &["unattached-object-moved"]);
        path["segments"][0]["knots"][1][3] = json!(0.0);
        assert_only(&folder, &path, &[]);
    }

    #[test]
    fn a_wrong_grasp() {
        let folder = Folder::new();
        for (pose, what) in [(about_z(0.001, 0.0, 0.0, 0.0), "translation"), (about_z(0.0, 0.0, 0.0, 0.01), "rotation")]
        {
            let mut path = story();
            path["documents"]["handles"]["cube/handle"]["link_from_handle"] = json!(pose);
            assert_only(&folder, &path, &["grasp"]);
            assert!(folder.subject(&path).contains(what));
        }
    }

    #[test]
    fn a_grasp_free_about_an_axis_may_turn_about_it_only() {
        let folder = Folder::new();
        let with = |pose: Pose| {
            let mut path = story();
            let handle = &mut path["documents"]["handles"]["cube/handle"];
            handle["link_from_handle"] = json!(pose);
            handle["mask"] = json!([true, true, true, true, true, false]);
            handle["mask_complement"] = json!([false, false, false, false, false, true]);
            path
        };
        assert_only(&folder, &with(about_z(0.0, 0.0, 0.0, 2.5)), &[]);
        let tilted = [0.0, 0.0, 0.0, 0.005_f64.sin(), 0.0, 0.0, 0.005_f64.cos()];
        assert_only(&folder, &with(tilted), &["grasp"]);
    }

    #[test]
    fn a_second_grasp_must_not_slip() {
        let folder = Folder::new();
        let mut path = story();
        let handle = &mut path["documents"]["handles"]["cube/handle"];
        (handle["mask"], handle["mask_complement"]) = (json!(vec![false; 6]), json!(vec![true; 6]));
        path["segments"][1]["attachments"][0]["carrier"] = json!(false);
        let still = in_hand(0.0, 0.0);
        path["segments"][1]["knots"] = json!([knot(0.0, 0.0, still), knot(0.1, 0.0, still)]);
        path["segments"][2]["knots"] = json!([knot(0.1, 0.0, still), knot(0.1, -0.6, still)]);
        assert!(folder.kinds(&path).contains(&"grasp-constancy"));
    }

    #[test]
    fn a_placement_that_floats_is_beside_its_support_or_tilted() {
        let folder = Folder::new();
        let mut path = story();
        for segment in path["segments"].as_array_mut().unwrap() {
            for knot in segment["knots"].as_array_mut().unwrap() {
                knot[4] = json!(0.51);
            }
        }
        path["documents"]["handles"]["cube/handle"]["link_from_handle"] = json!(about_z(0.0, 0.0, -0.01, 0.0));
        assert_only(&folder, &path, &["placement"]);
        assert!(folder.subject(&path).contains("gap is not the margin"));

        let mut path = story();
        for point in path["documents"]["surfaces"]["table/top"]["points"].as_array_mut().unwrap() {
            point[0] = json!(point[0].as_f64().unwrap() - 0.3);
        }
        assert_only(&folder, &path, &["placement"]);
        assert!(folder.subject(&path).contains("centre outside the support"));

        let mut path = story();
        path["documents"]["surfaces"]["cube/bottom"]["polygons"] = json!([[3, 2, 1, 0]]);
        assert!(folder.subject(&path).contains("normals not opposite"));
    }

    fn constraint(kind: &str, frame: &str, mask: [bool; 6]) -> Value {
        json!({ "kind": kind, "frame": frame, "to": "world", "mask": mask, "tolerance": 2e-4 })
    }

    #[test]
    fn a_constraint_holds_between_the_knots() {
        let folder = Folder::new();
        let mut path = story();
        let x_only = [true, false, false, false, false, false];
        // Held to its first x in the world's axes; it is equal at both knots, and larger between them.
        let mut bounded = constraint("pose", "arm/lower", x_only);
        bounded["value"] = json!(about_z(0.5 * 0.1_f64.cos(), 0.0, 0.0, 0.0));
        path["segments"][2]["constraints"] = json!([bounded]);
        let cube = in_hand(0.1, 0.0);
        path["segments"][2]["knots"] = json!([knot(0.1, 0.0, cube), knot(-0.1, 0.0, cube)]);
        assert!(folder.kinds(&path).contains(&"constraint"));
        path["segments"][2]["knots"] = json!([knot(0.1, 0.0, cube), knot(0.1, -0.6, cube)]);
        assert_only(&folder, &path, &[]);
    }

    #[test]
    fn a_bound_between_the_knots_is_one() {
        // The sagitta of the same motion is 0.5 (1 - cos 0.1): held to a little more it passes, to a little less not.
        let folder = Folder::new();
        let sagitta = 0.5 * (1.0 - 0.1_f64.cos());
        let cube = in_hand(0.1, 0.0);
        for (share, holds) in [(1.01, true), (0.99, false)] {
            let mut path = story();
            let mut bounded = constraint("pose", "arm/lower", [true, false, false, false, false, false]);
            bounded["tolerance"] = json!(sagitta * share);
            bounded["value"] = json!(about_z(0.5 * 0.1_f64.cos(), 0.0, 0.0, 0.0));
            path["segments"][2]["constraints"] = json!([bounded]);
            path["segments"][2]["knots"] = json!([knot(0.1, 0.0, cube), knot(-0.1, 0.0, cube)]);
            assert_eq!(!folder.kinds(&path).contains(&"constraint"), holds, "{share}");
        }
    }

    #[test]
    fn a_centre_of_mass_constraint() {
        let folder = Folder::new();
        let mut path = story();
        let mut mass = constraint("centre_of_mass", "arm", [true, true, true, false, false, false]);
        path["segments"][1]["constraints"] = json!([mass]);
        assert_only(&folder, &path, &["constraint"]);
        path["segments"][1]["constraints"] = json!([]);
        // One kilogram at each link's origin: (0, 0, 0), (0, 0, 0.5) and the elbow.
        mass["value"] = json!(about_z(0.5 * 0.1_f64.cos() / 3.0, 0.5 * 0.1_f64.sin() / 3.0, 1.0 / 3.0, 0.0));
        path["segments"][2]["constraints"] = json!([mass]);
        assert_only(&folder, &path, &[]);
    }

    #[test]
    fn what_is_not_known_here_is_not_passed_over() {
        let folder = Folder::new();
        let mut path = story();
        path["segments"][2]["constraints"] = json!([constraint("magic", "arm", [true; 6])]);
        assert_only(&folder, &path, &["unchecked-constraint"]);
    }

    #[test]
    fn an_articulated_object_is_held_beyond_its_joint() {
        let folder = Folder::new();
        let hinge = joint("hinge", "back", "lid", [-0.1, 0.0, 0.0], "");
        folder.write("book.urdf", &robot(&[link("back", &cuboid(0.02, 0.02, 0.02), 0.0), link("lid", "", 0.0), hinge]));
        let row = |shoulder: f64, hinge: f64| {
            // The lid is at the arm's tip; the back is a tenth ahead of the hinge, turned against it.
            let tip = in_hand(shoulder, 0.0);
            let yaw = shoulder - hinge;
            let back = about_z(tip[0] + 0.1 * yaw.cos(), tip[1] + 0.1 * yaw.sin(), 0.5, yaw);
            let mut row = vec![shoulder, 0.0, hinge];
            row.extend(back);
            json!(row)
        };
        let mut coordinates = vec![json!("arm/shoulder"), json!("arm/elbow"), json!("book/hinge")];
        coordinates.extend(root_of("book").as_array().unwrap().clone());
        let full = story();
        let parts = vec![full["parts"][0].clone(), part("book", "object", "freeflyer", IDENTITY)];
        let mut path = alone(parts, json!(coordinates), vec![row(0.0, 0.0), row(0.3, 0.5)]);
        path["documents"]["grippers"] = full["documents"]["grippers"].clone();
        let mut handle = full["documents"]["handles"]["cube/handle"].clone();
        handle["link"] = json!("book/lid");
        path["documents"]["handles"]["book/lid"] = handle;
        path["segments"][0]["attachments"] =
            json!([{ "object": "book/lid", "gripper": "arm/hand", "handle": "book/lid", "carrier": true }]);
        assert_only(&folder, &path, &[]);
        path["segments"][0]["knots"][1][3] = json!(path["segments"][0]["knots"][1][3].as_f64().unwrap() + 1e-4);
        assert_only(&folder, &path, &["object-off-carrier"]);
    }
}

mod malformed {
    use super::*;

    /// Spoils one place of the story; the refusal names it.
    #[test]
    fn what_is_no_path_is_refused_with_its_place() {
        let folder = Folder::new();
        let huge = json!(1e300);
        let part_named_twice = story()["parts"][0].clone();
        let cases: Vec<(&str, Value, &str)> = vec![
            ("/format", json!("foliate.path/3"), "foliate.path/3"),
            ("/coordinates/1", json!("arm/wrist"), "arm/elbow"),
            ("/coordinates/1", json!("arm/shoulder"), "coordinates[1]"),
            ("/segments/0/knots/2/4", huge.clone(), "segments[0].knots[2][4]"),
            ("/segments/0/knots/1/0", json!(null), "segments[0].knots[1][0]"),
            ("/segments/0/knots/0/0", json!(true), "segments[0].knots[0][0]"),
            ("/segments/1/knots/1", json!([0.0]), "segments[1].knots[1]"),
            ("/segments/1/knots", json!([]), "segments[1].knots"),
            ("/segments", json!([]), "segments"),
            ("/parts/0/urdf", json!("missing.urdf"), "missing.urdf"),
            ("/parts/0/urdf", json!("package://nowhere/arm.urdf"), "parts[0]"),
            ("/parts/0/urdf", json!("http://nowhere/arm.urdf"), "parts[0]"),
            ("/parts/0/root", json!("hinged"), "parts[0].root"),
            ("/parts/1/root", json!("freeflyer"), "parts[1].root"),
            ("/parts/0/kind", json!("toy"), "parts[0].kind"),
            ("/parts/0/mimic", json!("dance"), "parts[0].mimic"),
            ("/parts/0/world_from_root/6", json!(0.5), "parts[0].world_from_root"),
            ("/parts/1", part_named_twice, "parts[1]"),
            ("/documents/grippers/arm~1hand/link", json!("arm/thumb"), "documents.grippers[\"arm/hand\"].link"),
            ("/documents/surfaces/table~1top/polygons/0", json!([0, 1, 9]), "polygons[0]"),
            ("/documents/surfaces/table~1top/polygons/0", json!([0, 0, 0]), "polygons[0]"),
            ("/documents/handles/cube~1handle/mask", json!([true, true]), "documents.handles[\"cube/handle\"].mask"),
            ("/segments/1/attachments/0/gripper", json!("arm/foot"), "segments[1].attachments[0].gripper"),
            ("/segments/1/attachments/0/object", json!("table"), "segments[1].attachments[0].handle"),
            ("/segments/1/attachments/0/handle", json!(null), "segments[1].attachments[0]"),
            ("/segments/1/attachments", json!([held(), placed()]), "segments[1].attachments"),
            ("/limits/arm~1elbow", json!([1.0, -1.0]), "limits[\"arm/elbow\"]"),
            ("/limits", json!({ "arm/wrist": [0.0, 1.0] }), "limits[\"arm/wrist\"]"),
            ("/ignored_pairs", json!([["arm/lower", "arm/thumb", "?"]]), "ignored_pairs[0][1]"),
            ("/margins", json!([["arm/lower", "arm/thumb", 0.1]]), "margins[0][1]"),
            ("/margins", json!([["arm/lower", "arm/upper", huge]]), "margins[0][2]"),
        ];
        for (pointer, value, place) in cases {
            let mut path = story();
            *path.pointer_mut(pointer).unwrap() = value;
            let refused = folder.check(&path).expect_err(pointer);
            assert!(refused.contains(place), "{pointer}: {refused}");
        }
    }

    #[test]
    fn text_that_is_no_json_is_refused_with_its_place() {
        let folder = Folder::new();
        let text = story().to_string();
        let elbow = text.replacen("\"arm/elbow\":[-3.0,", "\"arm/elbow\":[NaN,", 1);
        assert!(folder.check_text(&elbow).unwrap_err().contains("limits[\"arm/elbow\"][0]"));
        let twice = text.replacen("\"arm/elbow\":[", "\"arm/shoulder\":[0.0,1.0],\"arm/elbow\":[", 1);
        assert!(folder.check_text(&twice).unwrap_err().contains("given twice"));
        for broken in ["", "{", "[]", "null", "{\"format\": 1}", &"[".repeat(100_000), "{\"a\":1e999}"] {
            let refused = folder.check_text(broken).unwrap_err();
            assert!(refused.contains("path.json"), "{refused}");
        }
        // Cut anywhere, it is refused, and nothing panics.
        for end in (0..text.len()).step_by(97) {
            assert!(folder.check_text(&text[..end]).is_err());
        }
    }

    #[test]
    fn objects_that_carry_each_other_are_refused() {
        let folder = Folder::new();
        let mut path = story();
        let other = path["parts"][2].as_object().unwrap().clone();
        push(&mut path["parts"], Value::Object(other));
        path["parts"][3]["name"] = json!("box");
        path["coordinates"].as_array_mut().unwrap().extend(root_of("box").as_array().unwrap().clone());
        for segment in path["segments"].as_array_mut().unwrap() {
            for knot in segment["knots"].as_array_mut().unwrap() {
                knot.as_array_mut().unwrap().extend(about_z(3.0, 0.0, 0.5, 0.0).map(|x| json!(x)));
            }
        }
        assert_only(&folder, &path, &[]);
        let mut surface = path["documents"]["surfaces"]["cube/bottom"].clone();
        surface["link"] = json!("box/cube");
        path["documents"]["surfaces"]["box/bottom"] = surface;
        path["segments"][0]["attachments"] = json!([
            { "object": "cube", "surface": "cube/bottom", "support": "box/bottom", "carrier": true },
            { "object": "box", "surface": "box/bottom", "support": "cube/bottom", "carrier": true },
        ]);
        let refused = folder.check(&path).unwrap_err();
        assert!(refused.contains("segments[0].attachments") && refused.contains("carry each other"), "{refused}");
    }
}
