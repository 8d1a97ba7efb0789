//! Settings of motions on a leaf, a motion as a job, and how it ended.
//!
//! They have a file of their own because `constrained_path` and its two callers share them.

use crate::constrained_motion::newton::settings::Settings;
use foliate_components::Pose;

/// How a motion is kept on its leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSettings {
    /// Largest residual anywhere along the motion; metres and radians.
    pub path_tolerance: f64,
    /// How each knot is solved.
    pub solve: Settings,
    /// A step this many times longer than the chord that it was to follow is a jump to another branch.
    pub jump: f64,
    /// Steps shorter than this are given up; radians and metres, root of the sum of squares.
    pub shortest_step: f64,
    /// Largest number of knots.
    pub knots: usize,
}

impl Default for MotionSettings {
    fn default() -> Self {
        Self { path_tolerance: 2e-4, solve: Settings::default(), jump: 2.0, shortest_step: 1e-3, knots: 2000 }
    }
}

/// Where a motion ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionEnd {
    /// At its goal.
    Reached,
    /// Before it: every step that can be certified has become too short, fails to project, jumps, or leads away.
    Stopped,
    /// Before it, at the limit of knots.
    TooManyKnots,
    /// At its start: start or goal do not lie on the leaf, or do not fit the program.
    NotOnLeaf,
}

/// A motion that is to be kept on its leaf, with arguments of its own.
#[derive(Debug)]
pub struct MotionJob<'a> {
    /// Where it starts, and where it shall end: whole configurations.
    pub ends: (&'a [f64], &'a [f64]),
    /// Right-hand sides, as [`project`](crate::constrained_motion::newton::scalar::project()) takes them.
    pub arguments: &'a [Pose],
    /// Whole configurations, one after the other, the first of them the start; appended to what is there.
    pub knots: &'a mut Vec<f64>,
    /// Where it ends; written.
    pub end: MotionEnd,
}

impl<'a> MotionJob<'a> {
    /// A job that has not been done.
    pub fn new(ends: (&'a [f64], &'a [f64]), arguments: &'a [Pose], knots: &'a mut Vec<f64>) -> Self {
        Self { ends, arguments, knots, end: MotionEnd::NotOnLeaf }
    }
}
