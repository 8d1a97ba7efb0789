//! Promise: impossible motions are refused whatever a file calls them, and no file keeps a check busy, or fills its
//! memory.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/story.rs"]
mod story;

use foliate::check::{CheckOptions, Kind, Verdict, check};
use foliate::path_file::save;
use foliate::scene::PackagePath;
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use story::*;

fn assert_only(folder: &Folder, path: &Value, kinds: &[&str]) {
    assert_eq!(folder.kinds(path), kinds, "{:#?}", folder.check(path).map(|r| r.violations));
}

mod impossible {
    use super::*;

    /// The arm waits; the cube slides by the same little in each of many segments.
    fn sliding(step: f64, count: usize) -> Value {
        let mut path = story();
        let [x, rest @ ..] = in_hand(0.0, 0.0);
        let row = |i: usize| {
            let mut numbers = vec![0.0, -0.6, x + step * i as f64];
            numbers.extend(rest);
            json!(numbers)
        };
        let segments = (0..count).map(|i| segment(json!([placed()]), vec![row(i), row(i + 1)]));
        path["segments"] = segments.collect();
        path
    }

    #[test]
    fn small_steps_do_not_add_up_to_a_motion() {
        let folder = Folder::new();
        assert_only(&folder, &sliding(0.0, 50), &[]);
        assert_only(&folder, &sliding(9.9e-6, 1), &[]);
        assert_only(&folder, &sliding(9.9e-6, 2), &["drift"]);
        assert_only(&folder, &sliding(1e-7, 150), &["drift"]);
        // To and fro it ends where it was; all its steps together are too many.
        let mut path = sliding(0.0, 40);
        for (number, segment) in path["segments"].as_array_mut().unwrap().iter_mut().enumerate() {
            let knot = if number % 2 == 0 { 1 } else { 0 };
            let x = segment["knots"][knot][2].as_f64().unwrap();
            segment["knots"][knot][2] = json!(x + 5e-6);
        }
        assert_only(&folder, &path, &["drift"]);
        // Called one time placed and one time resting on nothing, it is the same table that carries it.
        let mut path = sliding(9.9e-6, 4);
        path["segments"][1]["attachments"] = json!([]);
        path["segments"][2]["attachments"] = json!([]);
        assert_only(&folder, &path, &["drift"]);
    }

    #[test]
    fn a_lid_that_no_gripper_holds_does_not_creep_open() {
        let folder = Folder::new();
        let hinge = joint("hinge", "back", "lid", [-0.1, 0.0, 0.0], "");
        folder.write("book.urdf", &robot(&[link("back", "", 0.0), link("lid", "", 0.0), hinge]));
        let mut path = story();
        path["parts"].as_array_mut().unwrap().push(part("book", "object", "fixed", about_z(3.0, 0.0, 0.0, 0.0)));
        path["coordinates"].as_array_mut().unwrap().push(json!("book/hinge"));
        let mut at = 0.0;
        for segment in path["segments"].as_array_mut().unwrap() {
            let knots = segment["knots"].as_array_mut().unwrap();
            let last = knots.len() - 1;
            for (number, knot) in knots.iter_mut().enumerate() {
                knot.as_array_mut().unwrap().push(json!(at + if number == last { 8e-6 } else { 0.0 }));
            }
            at += 8e-6;
        }
        assert_only(&folder, &path, &["drift"]);
    }

    #[test]
    fn documents_of_no_part_hold_nothing() {
        let folder = Folder::new();
        let mut path = story();
        let handle = path["documents"]["handles"].as_object_mut().unwrap().remove("cube/handle").unwrap();
        path["documents"]["handles"]["top"] = handle.clone();
        path["segments"][1]["attachments"][0]["handle"] = json!("top");
        assert_only(&folder, &path, &["document"]);
        // Nor does one that is called after another part.
        path["documents"]["handles"].as_object_mut().unwrap().remove("top");
        path["documents"]["handles"]["arm/top"] = handle;
        path["segments"][1]["attachments"][0]["handle"] = json!("arm/top");
        assert_only(&folder, &path, &["document"]);
    }

    #[test]
    fn a_grasp_that_fixes_nothing_is_none() {
        let folder = Folder::new();
        let mut path = story();
        let nothing = json!(vec![false; 6]);
        path["documents"]["handles"]["cube/handle"]["mask"] = nothing.clone();
        path["documents"]["handles"]["cube/handle"]["mask_complement"] = nothing;
        path["segments"][1]["attachments"][0]["carrier"] = json!(false);
        assert_only(&folder, &path, &["grasp"]);
        assert!(folder.subject(&path).contains("fixes nothing"), "{}", folder.subject(&path));
    }

    #[test]
    fn objects_do_not_drive() {
        let folder = Folder::new();
        let mut path = story();
        path["parts"][2]["root"] = json!("planar");
        let names: Vec<Value> =
            ["arm/shoulder", "arm/elbow", "cube/x", "cube/y", "cube/theta"].map(|n| json!(n)).to_vec();
        path["coordinates"] = Value::Array(names);
        path["limits"] = json!({});
        path["segments"] = json!([segment(json!([]), vec![json!([0, -0.6, 2, 0, 0]), json!([0, -0.6, 2, 1, 1])])]);
        path["certificate"]["min_clearance"] = json!(null);
        assert_only(&folder, &path, &["unattached-object-moved"]);
    }

    #[test]
    fn a_hand_holds_one_thing_and_no_part_holds_itself() {
        let folder = Folder::new();
        let mut path = story();
        path["segments"][1]["attachments"].as_array_mut().unwrap().push(held());
        path["segments"][1]["attachments"][1]["carrier"] = json!(false);
        assert!(folder.check(&path).unwrap_err().contains("takes part in two grasps"));
        let mut path = story();
        path["documents"]["grippers"]["cube/magnet"] = json!({ "link": "cube/cube", "link_from_gripper": IDENTITY });
        path["segments"][1]["attachments"][0]["gripper"] = json!("cube/magnet");
        for carrier in [true, false] {
            path["segments"][1]["attachments"][0]["carrier"] = json!(carrier);
            assert!(folder.check(&path).unwrap_err().contains("can neither hold nor carry itself"));
        }
    }

    #[test]
    fn time_goes_on_from_segment_to_segment() {
        let folder = Folder::new();
        let timed = |times: [Value; 3]| {
            let mut path = story();
            for (segment, times) in path["segments"].as_array_mut().unwrap().iter_mut().zip(times) {
                if !times.is_null() {
                    segment["times"] = times;
                }
            }
            path
        };
        assert_only(&folder, &timed([json!([0, 1, 2]), json!([2, 3, 4]), json!([4, 5])]), &[]);
        assert_only(&folder, &timed([json!([0, 1, 2]), json!([1, 3, 4]), json!([4, 5])]), &["times"]);
        assert_only(&folder, &timed([json!([0, 0, 0]), json!([0, 0, 0]), json!([0, 0])]), &["times"]);
        assert_only(&folder, &timed([json!([0, 1, 2]), json!(null), json!([4, 5])]), &["times"]);
    }

    #[test]
    fn links_far_from_one_another_are_no_neighbours() {
        let folder = Folder::new();
        let mut path = story();
        path["ignored_pairs"] = json!([["arm/lower", "table/top", "adjacent"]]);
        assert_only(&folder, &path, &["not-adjacent"]);
        // The upper and the lower arm have a gap of a tenth at the elbow.
        folder.write("arm.srdf", &ARM_SRDF.replace("link1=\"upper\"", "link1=\"base\""));
        path["ignored_pairs"] = json!([["arm/upper", "arm/lower", "adjacent"]]);
        assert_only(&folder, &path, &["not-adjacent"]);
        // Longer ones overlap there, however it turns.
        folder.write("arm.urdf", &arm(&[]).replace("0.4 0.04 0.04", "0.52 0.04 0.04"));
        path["segments"].as_array_mut().unwrap().truncate(1);
        path["segments"][0]["knots"].as_array_mut().unwrap().truncate(2);
        assert_only(&folder, &path, &[]);
    }
}

mod bounded {
    use super::*;

    fn options() -> CheckOptions {
        CheckOptions::default()
    }

    fn prove(folder: &Folder, path: &Value, options: &CheckOptions) -> foliate::check::CheckReport {
        let file = save::read(&folder.write("path.json", &path.to_string())).unwrap();
        check(&file, &folder.path, &PackagePath::only(&[]), options).unwrap()
    }

    /// One number is a million: the arm turns for ever.
    #[test]
    fn a_broken_limit_is_not_marched_on() {
        let folder = Folder::new();
        let mut path = story();
        path["segments"][0]["knots"][1][1] = json!(1e6);
        let started = Instant::now();
        let report = prove(&folder, &path, &options());
        assert_eq!(report.verdict(), Verdict::Refused);
        assert!(report.has(Kind::Limit));
        assert!(started.elapsed() < Duration::from_secs(1), "{:?}", started.elapsed());
    }

    #[test]
    fn what_the_limits_leave_is_undecided_and_said() {
        let folder = Folder::new();
        folder.write("arm.urdf", &arm(&[]).replace("\"revolute\"", "\"continuous\""));
        let mut path = story();
        path["limits"] = json!({});
        path["segments"].as_array_mut().unwrap().truncate(1);
        // Out of the cube's way, so that it turns for ever.
        path["segments"][0]["knots"] =
            json!([knot(0.0, -1.0, about_z(0.95, 0.2, 0.5, 0.0)), knot(0.0, -1e6, about_z(0.95, 0.2, 0.5, 0.0))]);
        let short = CheckOptions { time_limit: Some(Duration::from_millis(200)), ..options() };
        let few = CheckOptions { work_limit: 3_000, ..options() };
        let ended = CheckOptions { cancelled: Some(Arc::new(AtomicBool::new(true))), ..options() };
        for (options, why) in [(short, "time limit"), (few, "work limit"), (ended, "cancelled")] {
            let started = Instant::now();
            let report = prove(&folder, &path, &options);
            let told = &report.violations;
            assert_eq!(report.verdict(), Verdict::Undecided, "{told:?}");
            assert!(told[0].subject.contains(why) && told[0].subject.contains("segments 0 to 0"), "{told:?}");
            assert!(started.elapsed() < Duration::from_secs(2), "{:?}", started.elapsed());
        }
    }

    #[test]
    fn only_regular_files_are_read() {
        let folder = Folder::new();
        assert!(save::read(std::path::Path::new("/dev/zero")).unwrap_err().to_string().contains("not a regular file"));
        assert!(save::read(&folder.path).unwrap_err().to_string().contains("not a regular file"));
        let pipe = folder.path.join("pipe");
        if std::process::Command::new("mkfifo").arg(&pipe).status().is_ok_and(|status| status.success()) {
            assert!(save::read(&pipe).unwrap_err().to_string().contains("not a regular file"));
        }
    }

    #[test]
    fn a_text_of_brackets_is_refused_before_it_fills_the_memory() {
        let folder = Folder::new();
        let text = format!("{{\"format\":\"foliate.path/1\",\"segments\":[{}[]]}}", "[],".repeat(2_100_000));
        let refused = save::read(&folder.write("path.json", &text)).unwrap_err().to_string();
        assert!(refused.contains("lists are more than"), "{refused}");
    }
}

#[test]
fn the_smallest_clearance_is_told_to_a_tenth() {
    let folder = Folder::new();
    let file = save::read(&folder.write("path.json", &story().to_string())).unwrap();
    let options = CheckOptions { clearance: true, pairs: true, ..CheckOptions::default() };
    let report = check(&file, &folder.path, &PackagePath::only(&[]), &options).unwrap();
    // The cube is a millimetre above the table.
    let least = report.clearance.unwrap();
    assert!((0.0009 - 1e-9..=0.001).contains(&least), "{least}");
    let left_out: Vec<_> = report.left_out.iter().map(|pair| (pair.first.as_str(), pair.second.as_str())).collect();
    assert_eq!(left_out, [("arm/lower", "arm/upper")]);
}
