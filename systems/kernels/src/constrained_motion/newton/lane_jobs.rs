//! Jobs of one program, and how they are brought to lanes and taken away.

use crate::constrained_motion::lane_rows::form::LaneProgram;
use crate::constrained_motion::lane_rows::memory::LaneMemory;
use crate::constrained_motion::newton::lanes::End;
use crate::constrained_motion::newton::settings::{Outcome, Settings};
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::constrained_motion::program::scratch::Scratch;
use crate::constrained_motion::rows::bodies;
use crate::kinematics::lane_steps::POSE_ROWS;
use crate::lanes::{F32Row, Scalar};
use foliate_components::Pose;
use glam::DMat3;
use std::ops::IndexMut;

/// A configuration that is to be moved onto a program's constraints, with arguments of its own.
#[derive(Debug)]
pub struct Job<'a> {
    /// Where the solve starts, and where it ended.
    pub q: &'a mut [f64],
    /// Right-hand sides, as [`project`](crate::constrained_motion::newton::scalar::project()) takes them.
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

pub(crate) const MOST_LANES: usize = F32Row::LANES;

/// Brings jobs to lanes and takes them away.
pub(crate) struct LaneJobs<'a, 'j> {
    pub(crate) program: &'a ConstraintProgram,
    pub(crate) lanes: &'a LaneProgram,
    pub(crate) jobs: &'a mut [Job<'j>],
    pub(crate) settings: &'a Settings,
    pub(crate) scratch: &'a mut Scratch,
    /// Which job each lane holds.
    pub(crate) holds: [usize; MOST_LANES],
}

pub(crate) fn outcome(end: End, iterations: u32, residual: f64) -> Outcome {
    match end {
        End::Converged => Outcome::Converged { iterations, residual },
        End::Stagnated => Outcome::Stagnated { iterations, residual },
        End::LimitReached => Outcome::LimitReached { residual },
    }
}

impl LaneJobs<'_, '_> {
    /// Whether there is something to solve; else how the job ended is written.
    pub(crate) fn begin(&mut self, job: usize) -> bool {
        let job = &mut self.jobs[job];
        match self.program.begin(job.q, job.arguments, self.settings, self.scratch) {
            Some(outcome) => {
                job.outcome = outcome;
                false
            }
            None => true,
        }
    }

    /// Puts the job that a lane holds into it; answers the largest number that was put there.
    pub(crate) fn fill<R>(&self, lane: usize, memory: &mut LaneMemory<R>) -> f64
    where
        R: IndexMut<usize>,
        R::Output: Scalar,
    {
        let job = &self.jobs[self.holds[lane]];
        fill(self.lanes, (job.q, job.arguments), self.scratch, lane, memory)
    }

    /// Takes the configuration of the job that a lane holds.
    pub(crate) fn read<R>(&mut self, lane: usize, memory: &LaneMemory<R>)
    where
        R: IndexMut<usize>,
        R::Output: Scalar,
    {
        read(self.lanes, lane, memory, self.jobs[self.holds[lane]].q);
    }
}

/// Puts a configuration and what does not change during a solve into a lane; `scratch` holds the arguments as they were read,
/// and the bodies that do not move. Answers the largest number that was put there.
pub(crate) fn fill<R>(
    lanes: &LaneProgram,
    (q, arguments): (&[f64], &[Pose]),
    scratch: &Scratch,
    lane: usize,
    memory: &mut LaneMemory<R>,
) -> f64
where
    R: IndexMut<usize>,
    R::Output: Scalar,
{
    let mut largest = 0.0_f64;
    for &coordinate in &lanes.reads {
        memory.q[coordinate][lane] = Scalar::of(q[coordinate]);
        largest = largest.max(q[coordinate].abs());
    }
    let Scratch { X_WJ, rigid_attachments, decoded, .. } = scratch;
    for (given, rows) in lanes.givens.iter().zip(memory.given.chunks_exact_mut(POSE_ROWS)) {
        let pose = given.pose(arguments, rigid_attachments, decoded, X_WJ);
        let columns = DMat3::from_quat(pose.rotation).to_cols_array();
        for (row, x) in rows.iter_mut().zip(columns.into_iter().chain(pose.translation.to_array())) {
            row[lane] = Scalar::of(x);
        }
        largest = largest.max(pose.translation.abs().max_element());
    }
    largest
}

/// Takes the coordinates that a solve has moved out of a lane.
pub(crate) fn read<R>(lanes: &LaneProgram, lane: usize, memory: &LaneMemory<R>, q: &mut [f64])
where
    R: IndexMut<usize>,
    R::Output: Scalar,
{
    for change in &lanes.moves {
        q[change.coordinate] = memory.q[change.coordinate][lane].to_f64();
    }
}

impl ConstraintProgram {
    /// Writes eliminated objects, and a root that a foot puts in its place, where the bodies of a converged configuration
    /// carry them; the same numbers as after a scalar solve that ended there. False where that root is out of its bounds.
    pub(crate) fn finish(&self, q: &mut [f64], arguments: &[Pose], scratch: &mut Scratch) -> bool {
        self.written.is_empty() && self.root.is_none() || self.place(q, arguments, scratch)
    }

    /// The same, with all bodies in their places too.
    pub(crate) fn place(&self, q: &mut [f64], arguments: &[Pose], scratch: &mut Scratch) -> bool {
        if !self.resolve(arguments, scratch) {
            return true; // not reached: the solve has read them
        }
        for steps in [&self.bodies.still, &self.bodies.moving] {
            bodies::run(steps, q, &scratch.rigid_attachments, &mut scratch.X_WJ);
        }
        self.close(q, scratch);
        self.root_is_within(q)
    }
}
