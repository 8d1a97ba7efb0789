//! What is wrong with a call is a status and a message, never a crash.

use foliate_c::check::{FoliateVerdict, foliate_check};
use foliate_c::error::{FoliateStatus, foliate_error, foliate_version};
use foliate_c::path::*;
use foliate_c::scene::*;
use foliate_c::solve::*;
use std::ffi::{CStr, CString, c_char};
use std::ptr::{null, null_mut};

fn said() -> String {
    // SAFETY: it is a text until the next call of this thread.
    unsafe { CStr::from_ptr(foliate_error()) }.to_string_lossy().into_owned()
}

fn c(text: &str) -> CString {
    CString::new(text).unwrap_or_default()
}

fn demo() -> *mut FoliateScene {
    let mut scene = null_mut();
    // SAFETY: a text, and room for a pointer.
    let status = unsafe { foliate_scene_load(c("demo").as_ptr(), null(), 0, &mut scene) };
    assert_eq!(status, FoliateStatus::Ok, "{}", said());
    scene
}

#[test]
fn null_and_nonsense_are_arguments() {
    let scene = demo();
    let mut path = null_mut();
    let (name, seven) = (c("box1"), [f64::NAN; 7]);
    let not_utf8 = [0xff_u8 as c_char, 0];
    // SAFETY: nulls are allowed, everything else is there.
    unsafe {
        assert_eq!(foliate_scene_load(null(), null(), 0, &mut null_mut()), FoliateStatus::Argument);
        assert!(said().contains("`name` is null"), "{}", said());
        assert_eq!(foliate_scene_load(not_utf8.as_ptr(), null(), 0, &mut null_mut()), FoliateStatus::Argument);
        assert_eq!(foliate_scene_load(c("demo").as_ptr(), null(), 0, null_mut()), FoliateStatus::Argument);
        assert_eq!(foliate_scene_load(c("demo").as_ptr(), null(), 2, &mut null_mut()), FoliateStatus::Argument);
        assert_eq!(
            foliate_scene_load(c("no_such.toml").as_ptr(), null(), 0, &mut null_mut()),
            FoliateStatus::Unreadable
        );
        assert!(said().contains("no_such.toml"), "{}", said());
        assert_eq!(foliate_scene_set_start(scene, name.as_ptr(), seven.as_ptr(), 7), FoliateStatus::Argument);
        assert_eq!(foliate_scene_set_start(scene, name.as_ptr(), seven.as_ptr(), 2), FoliateStatus::Argument);
        assert!(said().contains("2 numbers"), "{}", said());
        assert_eq!(foliate_scene_set_start(null_mut(), name.as_ptr(), seven.as_ptr(), 7), FoliateStatus::Argument);
        let (mut few, mut count) = ([0.0; 3], 0);
        assert_eq!(foliate_scene_start(scene, name.as_ptr(), few.as_mut_ptr(), 3, &mut count), FoliateStatus::Argument);
        assert_eq!(count, 7);
        assert_eq!(foliate_solve(null(), null(), null(), &mut path), FoliateStatus::Argument);
        let threads = FoliateOptions { threads: 0, ..foliate_options_default() };
        assert_eq!(foliate_solve(scene, &threads, null(), &mut path), FoliateStatus::Argument);
        let late = FoliateOptions { time_limit: f64::NAN, ..foliate_options_default() };
        assert_eq!(foliate_solve(scene, &late, null(), &mut path), FoliateStatus::Argument);
        let unknown = c("unknown");
        let other = FoliateOptions { scheduler: unknown.as_ptr(), ..foliate_options_default() };
        assert_eq!(foliate_solve(scene, &other, null(), &mut path), FoliateStatus::Argument);
        assert_eq!(foliate_path_sample(null(), null(), 0, null_mut(), null_mut(), null_mut()), FoliateStatus::Argument);
        let mut verdict = FoliateVerdict::Proved;
        assert_eq!(
            foliate_check(c("no.json").as_ptr(), null(), null(), 0, 1.0, &mut verdict),
            FoliateStatus::Unreadable
        );
        assert_eq!((foliate_path_duration(null()), foliate_path_event_count(null())), (0.0, 0));
        foliate_path_free(null_mut());
        foliate_cancel_free(null_mut());
        foliate_cancel(null());
        foliate_scene_free(scene);
        assert!(!CStr::from_ptr(foliate_version()).is_empty());
    }
}

#[test]
fn searches_end_as_they_are_asked() {
    let scene = demo();
    let mut path = null_mut();
    // SAFETY: handles of this interface.
    unsafe {
        let cancel = foliate_cancel_new();
        foliate_cancel(cancel);
        assert_eq!(foliate_solve(scene, null(), cancel, &mut path), FoliateStatus::Cancelled);
        foliate_cancel_free(cancel);
        let at_once = FoliateOptions { time_limit: 0.0, ..foliate_options_default() };
        assert_eq!(foliate_solve(scene, &at_once, null(), &mut path), FoliateStatus::NoSolution);
        let (name, far) = (c("box1"), [9.0, 0.0, 0.741, 0.0, 0.0, 0.0, 1.0]);
        let status = foliate_scene_set_goal(scene, &name.as_ptr(), &far.as_ptr(), &7, 1);
        assert_eq!(status, FoliateStatus::Ok, "{}", said());
        assert_eq!(foliate_solve(scene, null(), null(), &mut path), FoliateStatus::Infeasible);
        assert!(said().contains("box1"), "{}", said());
        assert!(path.is_null());
        foliate_scene_free(scene);
    }
}

#[test]
fn a_path_is_read() {
    let scene = demo();
    let (mut path, mut again) = (null_mut(), null_mut());
    let quick = FoliateOptions { improve_work: 0, ..foliate_options_default() };
    // SAFETY: handles of this interface, and room for what is asked.
    unsafe {
        assert_eq!(foliate_solve(scene, &quick, null(), &mut path), FoliateStatus::Ok, "{}", said());
        let threads = FoliateOptions { threads: 2, ..quick };
        assert_eq!(foliate_solve(scene, &threads, null(), &mut again), FoliateStatus::Ok);
        let (duration, joints) = (foliate_path_duration(path), foliate_path_joint_count(path));
        assert!(duration > 0.0 && joints >= 14);
        assert_eq!(duration, foliate_path_duration(again));
        let times: Vec<f64> = (0..=50).map(|i| f64::from(i) / 50.0 * duration).collect();
        let mut rows = [(); 3].map(|()| vec![0.0; times.len() * joints]);
        let [p, v, a] = &mut rows;
        let sampled =
            foliate_path_sample(path, times.as_ptr(), times.len(), p.as_mut_ptr(), v.as_mut_ptr(), a.as_mut_ptr());
        assert_eq!(sampled, FoliateStatus::Ok, "{}", said());
        // It stands still at both ends, and moves between.
        assert!(v[..joints].iter().chain(&v[50 * joints..]).all(|v| v.abs() < 1e-9));
        assert!(v.iter().any(|v| v.abs() > 0.05) && a.iter().any(|a| a.abs() > 0.05));
        let mut before = 0.0;
        for index in 0..foliate_path_segment_count(path) {
            let mut segment = std::mem::MaybeUninit::<FoliateSegment>::uninit();
            assert_eq!(foliate_path_segment(path, index, segment.as_mut_ptr()), FoliateStatus::Ok);
            let segment = segment.assume_init();
            assert!(segment.begin >= before - 1e-12 && segment.end > segment.begin);
            assert!(!CStr::from_ptr(segment.state).is_empty());
            before = segment.end;
        }
        assert!((before - duration).abs() < 1e-9);
        let mut event = std::mem::MaybeUninit::<FoliateEvent>::uninit();
        assert_eq!(foliate_path_event(path, 999, event.as_mut_ptr()), FoliateStatus::Argument);
        assert_eq!(foliate_path_event(path, 0, event.as_mut_ptr()), FoliateStatus::Ok);
        let event = event.assume_init();
        assert_eq!(event.kind, FoliateEventKind::Grasp);
        let mut pose = [0.0; 7];
        assert_eq!(foliate_path_pose(path, event.object, duration, pose.as_mut_ptr()), FoliateStatus::Ok);
        assert!((pose[2] - 0.741).abs() < 1e-6, "{pose:?}");
        assert_eq!(foliate_path_pose(path, c("nothing").as_ptr(), 0.0, pose.as_mut_ptr()), FoliateStatus::Argument);
        let folder = std::env::temp_dir().join(format!("foliate-c-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let file = c(folder.join("path.json").to_str().expect("a name"));
        assert_eq!(foliate_path_save(path, file.as_ptr()), FoliateStatus::Ok, "{}", said());
        let mut verdict = FoliateVerdict::Undecided;
        let checked = foliate_check(file.as_ptr(), c("demo").as_ptr(), null(), 0, 60.0, &mut verdict);
        assert_eq!((checked, verdict), (FoliateStatus::Ok, FoliateVerdict::Proved), "{}", said());
        let refused = foliate_check(file.as_ptr(), c("stack").as_ptr(), null(), 0, 60.0, &mut verdict);
        assert_eq!((refused, verdict), (FoliateStatus::Ok, FoliateVerdict::Refused));
        assert!(!said().is_empty());
        assert_eq!(foliate_path_save(path, c("/dev/null/p.json").as_ptr()), FoliateStatus::Unwritable);
        let _ = std::fs::remove_dir_all(folder);
        foliate_path_free(path);
        foliate_path_free(again);
        foliate_scene_free(scene);
    }
}
