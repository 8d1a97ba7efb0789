//! A motion over time.

use crate::view::document::Offset;
use serde::Serialize;

/// A motion. Between two samples numbers go straight and quaternions turn on the shortest arc.
#[derive(Clone, Debug, Serialize)]
pub struct PathEntry {
    /// Whether times are the path's own. Without them a unit of length of the joints' motion takes a second.
    pub timed: bool,
    /// When it ends, seconds; it begins at 0.
    pub duration: f64,
    /// `samples` times: 32-bit floating-point numbers, increasing from 0 to `duration`.
    pub times: Offset,
    /// `samples` configurations: 32-bit floating-point numbers.
    pub configurations: Offset,
    /// How many samples.
    pub samples: usize,
    /// By how much a number between two samples is off at most, metres and radians, measured half way and at the quarters.
    pub deviation: f64,
    /// `samples` velocities, by joint from `v` on: 32-bit floating-point numbers; 0 for objects that are carried, which have none of their
    /// own. Only where times are the path's own.
    pub velocities: Option<Offset>,
    /// Motions on one leaf each, in the order of time, without gaps.
    pub segments: Vec<SegmentEntry>,
    /// Where hands take and let go.
    pub events: Vec<EventEntry>,
    /// How close things come.
    pub clearance: Option<ClearanceEntry>,
    /// `proved`, `refused`, `relative` or `undecided`, where the path was checked.
    pub verdict: Option<String>,
    /// What a check refuses.
    pub refused: Vec<RefusalEntry>,
}

/// A motion on one leaf.
#[derive(Clone, Debug, Serialize)]
pub struct SegmentEntry {
    /// When it begins, seconds.
    pub from: f64,
    /// When it ends.
    pub to: f64,
    /// Place of its state in the graph's list.
    pub state: Option<usize>,
    /// Place of its transition in the graph's list.
    pub transition: Option<usize>,
    /// What happens, in plain words.
    pub words: String,
    /// What it ends at, where that is a waypoint of its transition.
    pub waypoint: Option<String>,
    /// Segments of one state have one colour: numbers from 0 in the order of first appearance.
    pub colour: usize,
    /// Who holds what: pairs of gripper and handle.
    pub held: Vec<[String; 2]>,
}

/// A hand takes or lets go of something.
#[derive(Clone, Debug, Serialize)]
pub struct EventEntry {
    /// Seconds.
    pub time: f64,
    /// How long everything stands still from then on, seconds.
    pub dwell: f64,
    /// `grasp` or `release`.
    pub kind: &'static str,
    /// In plain words.
    pub words: String,
    /// `part/gripper`.
    pub gripper: String,
    /// `part/handle`.
    pub handle: String,
}

/// The closest pair of shapes that move against each other, over time. Pairs that are not tested, and pairs that one carries with the other,
/// do not count.
#[derive(Clone, Debug, Serialize)]
pub struct ClearanceEntry {
    /// How many samples.
    pub samples: usize,
    /// Their times: 32-bit floating-point numbers.
    pub times: Offset,
    /// Distances, metres, to a micrometre: 32-bit floating-point numbers; not positive where the two touch or overlap.
    pub values: Offset,
    /// By sample the number of its pair: 16-bit.
    pub pair: Offset,
    /// Six 32-bit floating-point numbers a sample: the nearest points of the two in the world; not a number where they touch.
    pub points: Offset,
    /// Pairs of links.
    pub pairs: Vec<[usize; 2]>,
}

/// A promise that a path breaks.
#[derive(Clone, Debug, Serialize)]
pub struct RefusalEntry {
    /// When; none for the file as a whole.
    pub time: Option<f64>,
    /// What, with its numbers.
    pub words: String,
    /// The links that it is about, where it is about two.
    pub links: Option<[usize; 2]>,
}
