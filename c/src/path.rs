//! Paths: what a robot's program asks of a trajectory.

use crate::arguments::{array, reference, target, text};
use crate::error::{Failure, FoliateStatus, status_of};
use foliate::Solution;
use foliate::components::path::EventKind;
use foliate::components::pose::pose_to_array;
use foliate::kernels::lanes::Level;
use foliate::prelude::{Scene, Trajectory};
use std::ffi::{CString, c_char};
use std::path::Path;

/// A certified path with times.
pub struct FoliatePath {
    solution: Solution,
    scene: Scene,
    seed: u64,
    scheduler: String,
    joints: Vec<(String, CString)>,
    segments: Vec<[CString; 2]>,
    events: Vec<[CString; 3]>,
}

/// A motion on one leaf. The texts belong to the path.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FoliateSegment {
    /// Name of the state in which it lies.
    pub state: *const c_char,
    /// Name of the transition that is travelled.
    pub transition: *const c_char,
    /// When it begins, seconds.
    pub begin: f64,
    /// When it ends, seconds.
    pub end: f64,
}

/// What a hand does.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoliateEventKind {
    /// It closes about an object.
    Grasp = 0,
    /// It opens.
    Release = 1,
}

/// A hand takes or lets go of an object. The texts belong to the path.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FoliateEvent {
    /// Seconds.
    pub time: f64,
    /// How long the robot stands still then, seconds.
    pub dwell: f64,
    /// What it does.
    pub kind: FoliateEventKind,
    /// The part that is taken or let go.
    pub object: *const c_char,
    /// `part/gripper`.
    pub gripper: *const c_char,
    /// `part/handle`.
    pub handle: *const c_char,
}

impl FoliatePath {
    pub(crate) fn of(solution: Solution, scene: Scene, (seed, scheduler): (u64, String)) -> Result<Self, Failure> {
        let c = |text: &str| CString::new(text).unwrap_or_default();
        let trajectory = solution.trajectory().map_err(Failure::argument)?;
        let mut joints = Vec::new();
        for robot in trajectory.robots() {
            let names = trajectory.joint_names(robot).map_err(Failure::argument)?;
            joints.extend(names.into_iter().map(|name| (name.to_owned(), c(name))));
        }
        let events = trajectory.events().iter().map(|e| [c(e.object), c(e.gripper), c(e.handle)]).collect();
        let graph = &solution.model.graph;
        let names = |s: &foliate::components::path::Segment| {
            [c(&graph.state(s.state).name), c(&graph.transition(s.transition).name)]
        };
        let segments = solution.path.segments.iter().map(names).collect();
        drop(trajectory);
        Ok(Self { solution, scene, seed, scheduler, joints, segments, events })
    }

    fn trajectory(&self) -> Result<Trajectory<'_>, Failure> {
        self.solution.trajectory().map_err(Failure::argument)
    }
}

/// Frees a path. Null is nothing to free.
///
/// # Safety
/// `path` is null or came from this interface, and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_free(path: *mut FoliatePath) {
    if !path.is_null() {
        // SAFETY: the caller's promise.
        drop(unsafe { Box::from_raw(path) });
    }
}

/// How long a path takes, seconds; 0 of null.
///
/// # Safety
/// `path` is null or came from this interface.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_duration(path: *const FoliatePath) -> f64 {
    // SAFETY: the caller's promise.
    unsafe { path.as_ref() }.and_then(|path| path.solution.path.duration()).unwrap_or(0.0)
}

/// How many joints of one coordinate all robots have, those that follow others included; 0 of null.
///
/// # Safety
/// `path` is null or came from this interface.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_joint_count(path: *const FoliatePath) -> usize {
    // SAFETY: the caller's promise.
    unsafe { path.as_ref() }.map_or(0, |path| path.joints.len())
}

/// Name of a joint, `part/joint`; null where there is none. The text belongs to the path.
///
/// # Safety
/// `path` is null or came from this interface.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_joint_name(path: *const FoliatePath, index: usize) -> *const c_char {
    // SAFETY: the caller's promise.
    let path = unsafe { path.as_ref() };
    path.and_then(|path| path.joints.get(index)).map_or(std::ptr::null(), |(_, name)| name.as_ptr())
}

/// What the joints do at times (seconds; clamped to the path): rows of `foliate_path_joint_count` numbers, a row for each time; rad, rad/s, rad/s² or metres. `velocities` and `accelerations` may be null.
///
/// # Safety
/// `path` came from this interface; `times` has `count` numbers; the others are null or have room for `count` rows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_sample(
    path: *const FoliatePath,
    times: *const f64,
    count: usize,
    positions: *mut f64,
    velocities: *mut f64,
    accelerations: *mut f64,
) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (path, times) = unsafe { (reference(path, "path")?, array(times, count, "times")?) };
        if positions.is_null() {
            return Err(Failure::argument("`positions` is null"));
        }
        if let Some(time) = times.iter().find(|time| !time.is_finite()) {
            return Err(Failure::argument(format!("`times`: {time} is no time")));
        }
        let trajectory = path.trajectory()?;
        let names: Vec<&str> = path.joints.iter().map(|(name, _)| name.as_str()).collect();
        let joints = trajectory.joints(&names).map_err(Failure::argument)?;
        let mut sample = Default::default();
        for (row, &time) in times.iter().enumerate() {
            joints.sample_into(time, &mut sample);
            let rows = [
                (positions, &sample.positions),
                (velocities, &sample.velocities),
                (accelerations, &sample.accelerations),
            ];
            for (out, numbers) in rows.into_iter().filter(|(out, _)| !out.is_null()) {
                // SAFETY: not null, with room for `count` rows of so many numbers.
                unsafe { std::ptr::copy_nonoverlapping(numbers.as_ptr(), out.add(row * names.len()), names.len()) };
            }
        }
        Ok(())
    })
}

/// The pose in the world of a link (`part/link`) or a part (its root link) at a time: x, y, z in metres and the quaternion x, y, z, w, into seven numbers.
///
/// # Safety
/// `path` came from this interface; `name` is a text; `pose` has room for seven numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_pose(
    path: *const FoliatePath,
    name: *const c_char,
    time: f64,
    pose: *mut f64,
) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (path, name) = unsafe { (reference(path, "path")?, text(name, "name")?) };
        // SAFETY: the caller's promise.
        let out = unsafe { target(pose.cast::<[f64; 7]>(), "pose") }?;
        if !time.is_finite() {
            return Err(Failure::argument(format!("`time`: {time} is no time")));
        }
        *out = pose_to_array(&path.trajectory()?.pose(name, time).map_err(Failure::argument)?);
        Ok(())
    })
}

/// How many segments a path has; 0 of null.
///
/// # Safety
/// `path` is null or came from this interface.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_segment_count(path: *const FoliatePath) -> usize {
    // SAFETY: the caller's promise.
    unsafe { path.as_ref() }.map_or(0, |path| path.segments.len())
}

/// A segment, in the direction of travel.
///
/// # Safety
/// `path` came from this interface; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_segment(
    path: *const FoliatePath,
    index: usize,
    out: *mut FoliateSegment,
) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (path, out) = unsafe { (reference(path, "path")?, target(out, "out")?) };
        let missing = || {
            Failure::argument(format!("the path has {} segments, not {}", path.segments.len(), index.saturating_add(1)))
        };
        let [state, transition] = path.segments.get(index).ok_or_else(missing)?;
        let times = path.solution.path.segments[index].timing.as_ref().map_or(&[][..], |timing| &timing.times);
        let (begin, end) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0));
        *out = FoliateSegment { state: state.as_ptr(), transition: transition.as_ptr(), begin, end };
        Ok(())
    })
}

/// How often hands take or let go; 0 of null.
///
/// # Safety
/// `path` is null or came from this interface.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_event_count(path: *const FoliatePath) -> usize {
    // SAFETY: the caller's promise.
    unsafe { path.as_ref() }.map_or(0, |path| path.events.len())
}

/// An event, in the order of time.
///
/// # Safety
/// `path` came from this interface; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_event(
    path: *const FoliatePath,
    index: usize,
    out: *mut FoliateEvent,
) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (path, out) = unsafe { (reference(path, "path")?, target(out, "out")?) };
        let missing =
            || Failure::argument(format!("the path has {} events, not {}", path.events.len(), index.saturating_add(1)));
        let [object, gripper, handle] = path.events.get(index).ok_or_else(missing)?;
        let trajectory = path.trajectory()?;
        let events = trajectory.events();
        let event = events.get(index).ok_or_else(missing)?;
        let kind = match event.kind {
            EventKind::Grasp => FoliateEventKind::Grasp,
            EventKind::Release => FoliateEventKind::Release,
        };
        let texts = [object, gripper, handle].map(|text| text.as_ptr());
        let [object, gripper, handle] = texts;
        *out = FoliateEvent { time: event.time, dwell: event.dwell, kind, object, gripper, handle };
        Ok(())
    })
}

/// Writes the path file, which `foliate_check` and the program `foliate` read.
///
/// # Safety
/// `path` came from this interface; `file` is a text.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_path_save(path: *const FoliatePath, file: *const c_char) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (path, file) = unsafe { (reference(path, "path")?, text(file, "file")?) };
        let search = (path.seed, path.scheduler.as_str(), Level::default());
        let saved = path.solution.save(&path.scene, search, Path::new(file));
        saved.map_err(|why| Failure::new(FoliateStatus::Unwritable, why))
    })
}
