//! Many problems of one program: one per lane, refilled from the queue as lanes end.

use super::bodies;
use super::lane_newton::{End, LaneMemory, Queue, solve};
use super::lane_program::LaneProgram;
use super::newton::{Outcome, Settings, project};
use super::program::ConstraintProgram;
use super::scratch::Scratch;
use crate::kinematics::POSE_ROWS;
use crate::lanes::Level;
use foliate_components::Pose;
use glam::DMat3;

/// A configuration that is to be moved onto a program's constraints, with arguments of its own.
#[derive(Debug)]
pub struct Job<'a> {
    /// Where the solve starts, and where it ended.
    pub q: &'a mut [f64],
    /// Right-hand sides, as [`project`](super::project()) takes them.
    pub arguments: &'a [Pose],
    /// How it ended; written.
    pub outcome: Outcome,
}

impl<'a> Job<'a> {
    /// A job that has not been done.
    pub fn new(q: &'a mut [f64], arguments: &'a [Pose]) -> Self {
        Self { q, arguments, outcome: Outcome::Idle }
    }
}

/// Moves configurations onto the program's constraints, each with its own arguments, as [`project`](super::project()) does.
///
/// Programs that [have a form for lanes](ConstraintProgram::is_for_lanes) are solved eight at a time at the settings' level,
/// others (and all of them at the level `scalar`) one after another. What becomes of a job depends on nothing but
/// itself, the settings and the level: not on how many there are, nor in what order they come.
pub fn project_batch(program: &ConstraintProgram, jobs: &mut [Job<'_>], settings: &Settings, scratch: &mut Scratch) {
    match &program.lanes {
        Some(lanes) if settings.level != Level::scalar() => {
            project_in_lanes(program, lanes, jobs, settings, scratch);
        }
        _ => {
            for job in jobs {
                job.outcome = project(program, job.q, job.arguments, settings, scratch);
            }
        }
    }
}

fn project_in_lanes(
    program: &ConstraintProgram,
    lanes: &LaneProgram,
    jobs: &mut [Job<'_>],
    settings: &Settings,
    scratch: &mut Scratch,
) {
    let mut memory = std::mem::take(&mut scratch.lanes);
    let mut desk = Desk { program, lanes, jobs, settings, scratch, next: 0, holds: [0; MOST_LANES] };
    solve(lanes, program.configuration_size(), settings, &mut memory, &mut desk);
    scratch.lanes = memory;
}

const MOST_LANES: usize = 16;

/// Brings jobs to lanes and takes them away.
struct Desk<'a, 'j> {
    program: &'a ConstraintProgram,
    lanes: &'a LaneProgram,
    jobs: &'a mut [Job<'j>],
    settings: &'a Settings,
    scratch: &'a mut Scratch,
    /// First job that nobody has looked at.
    next: usize,
    /// Which job each lane holds.
    holds: [usize; MOST_LANES],
}

impl Queue for Desk<'_, '_> {
    fn next(&mut self, lane: usize, memory: &mut LaneMemory) -> bool {
        while self.next < self.jobs.len() {
            let job = &mut self.jobs[self.next];
            self.next += 1;
            match self.program.begin(job.q, job.arguments, self.settings, self.scratch) {
                Some(outcome) => job.outcome = outcome,
                None => {
                    self.holds[lane] = self.next - 1;
                    self.fill(lane, memory);
                    return true;
                }
            }
        }
        false
    }

    fn ended(&mut self, lane: usize, end: End, iterations: u32, residual: f64, memory: &LaneMemory) {
        let job = &mut self.jobs[self.holds[lane]];
        for change in &self.lanes.moves {
            job.q[change.coordinate] = memory.q[change.coordinate][lane];
        }
        job.outcome = match end {
            End::Converged => Outcome::Converged { iterations, residual },
            End::Stagnated => Outcome::Stagnated { iterations, residual },
            End::LimitReached => Outcome::LimitReached { residual },
        };
        if job.outcome.is_converged() {
            self.program.finish(job.q, job.arguments, self.scratch);
        }
    }
}

impl Desk<'_, '_> {
    fn fill(&self, lane: usize, memory: &mut LaneMemory) {
        let job = &self.jobs[self.holds[lane]];
        for &coordinate in &self.lanes.reads {
            memory.q[coordinate][lane] = job.q[coordinate];
        }
        let Scratch { X_WJ, carriages, decoded, .. } = &*self.scratch;
        for (given, rows) in self.lanes.givens.iter().zip(memory.given.chunks_exact_mut(POSE_ROWS)) {
            let pose = given.pose(job.arguments, carriages, decoded, X_WJ);
            let columns = DMat3::from_quat(pose.rotation).to_cols_array();
            for (row, x) in rows.iter_mut().zip(columns.into_iter().chain(pose.translation.to_array())) {
                row[lane] = x;
            }
        }
    }
}

impl ConstraintProgram {
    /// Writes eliminated objects where the bodies of a converged configuration carry them; the same numbers as after a
    /// scalar solve that ended there.
    fn finish(&self, q: &mut [f64], arguments: &[Pose], scratch: &mut Scratch) {
        if self.written.is_empty() || !self.resolve(arguments, scratch) {
            return;
        }
        for steps in [&self.bodies.still, &self.bodies.moving] {
            bodies::run(steps, q, &scratch.carriages, &mut scratch.X_WJ);
        }
        self.close(q, scratch);
    }
}
