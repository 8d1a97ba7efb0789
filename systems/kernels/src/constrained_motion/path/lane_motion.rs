//! Motions side by side: one per lane, the next from the queue as soon as one has ended.
//!
//! Each lane solves the step that its path has proposed last. As soon as it is solved the path judges it and proposes the next, so
//! no lane waits for another.

use crate::constrained_motion::lane_rows::form::LaneProgram;
use crate::constrained_motion::lane_rows::memory::LaneMemory;
use crate::constrained_motion::newton::lane_jobs::{fill, read};
use crate::constrained_motion::newton::lanes::{End, Queue, solve};
use crate::constrained_motion::path::constrained_path::{ConstrainedPath, MotionScratch, PathMemory, Tools};
use crate::constrained_motion::path::settings::{MotionEnd, MotionJob, MotionSettings};
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::lanes::F64Row;
use foliate_components::robot::configuration::ConfigurationSpace;

/// Lanes of double precision.
const LANES: usize = F64Row::LANES;

pub(crate) fn follow_in_lanes(
    program: &ConstraintProgram,
    lanes: &LaneProgram,
    space: &ConfigurationSpace,
    jobs: &mut [MotionJob<'_>],
    settings: &MotionSettings,
    scratch: &mut MotionScratch,
) {
    let MotionScratch { tools, paths } = scratch;
    paths.resize_with(paths.len().max(LANES.min(jobs.len())), PathMemory::default);
    let mut memory = std::mem::take(&mut tools.solve.lanes);
    let mut queue = PathQueue { program, lanes, space, settings, jobs, begun: 0, tools, paths, holds: [None; LANES] };
    solve(lanes, program.configuration_size(), &settings.solve, &mut memory, &mut queue);
    tools.solve.lanes = memory;
}

/// Gives steps of paths to lanes, and the solutions back to the paths.
struct PathQueue<'a, 'j> {
    program: &'a ConstraintProgram,
    lanes: &'a LaneProgram,
    space: &'a ConfigurationSpace,
    settings: &'a MotionSettings,
    jobs: &'a mut [MotionJob<'j>],
    /// Jobs that a lane has taken.
    begun: usize,
    tools: &'a mut Tools,
    /// By lane.
    paths: &'a mut [PathMemory],
    /// Which job each lane follows.
    holds: [Option<usize>; LANES],
}

impl PathQueue<'_, '_> {
    /// The path of a lane, with the knots that it has so far.
    fn path(&mut self, lane: usize, job: usize) -> (ConstrainedPath<'_>, &mut Vec<f64>) {
        let Self { program, space, settings, jobs, tools, paths, .. } = self;
        let MotionJob { arguments, knots, .. } = &mut jobs[job];
        (ConstrainedPath { program, space, arguments, settings, memory: &mut paths[lane], tools }, knots)
    }

    /// The motion that a lane follows, the next of the queue where its last one has ended; `None` where none is left.
    fn under_way(&mut self, lane: usize) -> Option<usize> {
        while self.holds[lane].is_none() && self.begun < self.jobs.len() {
            let job = self.begun;
            self.begun += 1;
            let ends = self.jobs[job].ends;
            let (mut path, knots) = self.path(lane, job);
            if path.begin(ends, knots) {
                self.holds[lane] = Some(job);
            } else {
                self.jobs[job].end = MotionEnd::NotOnLeaf;
            }
        }
        self.holds[lane]
    }
}

impl Queue<F64Row> for PathQueue<'_, '_> {
    fn next(&mut self, lane: usize, memory: &mut LaneMemory<F64Row>) -> Option<u32> {
        while let Some(job) = self.under_way(lane) {
            let lanes = self.lanes;
            let (mut path, knots) = self.path(lane, job);
            if let Some(end) = path.propose(knots) {
                self.jobs[job].end = end;
                self.holds[lane] = None;
                continue;
            }
            let (q, solve) = (&mut path.memory.next, &mut path.tools.solve);
            let failed = path.program.solved().begin(q, path.arguments, &path.settings.solve, solve);
            if failed.is_none() {
                fill(lanes, (q, path.arguments), solve, lane, memory);
                return Some(0);
            }
            path.judge(false, knots);
        }
        None
    }

    fn ended(&mut self, lane: usize, end: End, _iterations: u32, _residual: f64, memory: &LaneMemory<F64Row>) {
        let Some(job) = self.holds[lane] else { return };
        let lanes = self.lanes;
        let (mut path, knots) = self.path(lane, job);
        let q = &mut path.memory.next;
        read(lanes, lane, memory, q);
        let is_converged = end == End::Converged;
        let is_solved = is_converged && path.program.solved().place(q, path.arguments, &mut path.tools.solve);
        path.judge(is_solved, knots);
    }
}
