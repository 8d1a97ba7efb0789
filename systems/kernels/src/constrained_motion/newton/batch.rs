//! Many problems of one program: one per lane, refilled from the queue as lanes end.

use crate::constrained_motion::lane_rows::form::LaneProgram;
use crate::constrained_motion::lane_rows::memory::LaneMemory;
use crate::constrained_motion::newton::lanes::{End, Queue, solve, solve_single};
use crate::constrained_motion::newton::scalar::project;
use crate::constrained_motion::newton::settings::{Outcome, Settings};
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::constrained_motion::program::scratch::Scratch;
use crate::constrained_motion::rows::bodies;
use crate::kinematics::lane_steps::POSE_ROWS;
use crate::lanes::{F32Row, F64Row, Scalar};
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

/// Moves configurations onto the program's constraints, each with its own arguments, as
/// [`project`](crate::constrained_motion::newton::scalar::project()) does.
///
/// Programs that [have a form for lanes](ConstraintProgram::is_for_lanes) are solved eight at a time at the settings' level
/// (or first sixteen at a time in single precision, see [`Settings::single_until`]), others (and all of them at the level
/// `scalar`) one after another. What becomes of a job depends on nothing but
/// itself, the settings and the level: not on how many there are, nor in what order they come.
pub fn project_batch(program: &ConstraintProgram, jobs: &mut [Job<'_>], settings: &Settings, scratch: &mut Scratch) {
    let solved = program.solved();
    match solved.lanes_at(settings.level) {
        Some(lanes) => project_in_lanes(solved, lanes, jobs, settings, scratch),
        _ => {
            for job in jobs {
                job.outcome = project(program, job.q, job.arguments, settings, scratch);
            }
        }
    }
}

/// What keeps a problem from single precision: poses or coordinates larger than this, metres and radians. Below, rounding
/// leaves residuals that are a tenth of what single precision is asked for.
const SINGLE_REACH: f64 = 16.0;

/// Smallest λ² in single precision: below, rounding would leave nothing of the matrix of a singular configuration.
const SINGLE_FLOOR: f64 = 1e-6;

fn project_in_lanes(
    program: &ConstraintProgram,
    lanes: &LaneProgram,
    jobs: &mut [Job<'_>],
    settings: &Settings,
    scratch: &mut Scratch,
) {
    let (mut double, mut todo) = (std::mem::take(&mut scratch.lanes), std::mem::take(&mut scratch.todo));
    todo.clear();
    let coordinates = program.configuration_size();
    let mut desk = Desk { program, lanes, jobs, settings, scratch, holds: [0; MOST_LANES] };
    if settings.single_until > 0.0 {
        let mut single = std::mem::take(&mut desk.scratch.single_lanes);
        let rough = Settings {
            tolerance: settings.tolerance.max(settings.single_until),
            damping_floor: settings.damping_floor.max(SINGLE_FLOOR),
            ..*settings
        };
        let mut first = First { desk: &mut desk, next: 0, todo: &mut todo };
        solve_single(lanes, coordinates, &rough, &mut single, &mut first);
        desk.scratch.single_lanes = single;
    } else {
        todo.extend((0..desk.jobs.len()).map(|job| (job, 0)));
    }
    solve(lanes, coordinates, settings, &mut double, &mut Last { desk: &mut desk, todo: todo.iter() });
    (scratch.lanes, scratch.todo) = (double, todo);
}

const MOST_LANES: usize = F32Row::LANES;

/// Brings jobs to lanes and takes them away.
struct Desk<'a, 'j> {
    program: &'a ConstraintProgram,
    lanes: &'a LaneProgram,
    jobs: &'a mut [Job<'j>],
    settings: &'a Settings,
    scratch: &'a mut Scratch,
    /// Which job each lane holds.
    holds: [usize; MOST_LANES],
}

/// The jobs in single precision: what comes near enough is to be done in double precision, what fails has failed.
struct First<'a, 'd, 'j> {
    desk: &'a mut Desk<'d, 'j>,
    /// First job that has not been taken.
    next: usize,
    /// Jobs with the steps that they have taken.
    todo: &'a mut Vec<(usize, u32)>,
}

impl Queue<F32Row> for First<'_, '_, '_> {
    fn next(&mut self, lane: usize, memory: &mut LaneMemory<F32Row>) -> Option<u32> {
        while self.next < self.desk.jobs.len() {
            self.next += 1;
            let job = self.next - 1;
            if self.desk.begin(job) {
                self.desk.holds[lane] = job;
                if self.desk.fill(lane, memory) <= SINGLE_REACH {
                    return Some(0);
                }
                self.todo.push((job, 0));
            }
        }
        None
    }

    fn ended(&mut self, lane: usize, end: End, iterations: u32, residual: f64, memory: &LaneMemory<F32Row>) {
        let number = self.desk.holds[lane];
        // Where nothing has moved the start keeps all its digits.
        if iterations > 0 {
            self.desk.read(lane, memory);
        }
        match end {
            End::Converged => self.todo.push((number, iterations)),
            _ => self.desk.jobs[number].outcome = outcome(end, iterations, residual),
        }
    }
}

/// The jobs in double precision, which decides.
struct Last<'a, 'd, 'j> {
    desk: &'a mut Desk<'d, 'j>,
    todo: std::slice::Iter<'a, (usize, u32)>,
}

impl Queue<F64Row> for Last<'_, '_, '_> {
    fn next(&mut self, lane: usize, memory: &mut LaneMemory<F64Row>) -> Option<u32> {
        for &(job, taken) in self.todo.by_ref() {
            if self.desk.begin(job) {
                self.desk.holds[lane] = job;
                self.desk.fill(lane, memory);
                return Some(taken);
            }
        }
        None
    }

    fn ended(&mut self, lane: usize, end: End, iterations: u32, residual: f64, memory: &LaneMemory<F64Row>) {
        self.desk.read(lane, memory);
        let Desk { program, jobs, scratch, holds, .. } = &mut *self.desk;
        let job = &mut jobs[holds[lane]];
        job.outcome = outcome(end, iterations, residual);
        if job.outcome.is_converged() && !program.finish(job.q, job.arguments, scratch) {
            job.outcome = Outcome::RootOutOfBounds;
        }
    }
}

fn outcome(end: End, iterations: u32, residual: f64) -> Outcome {
    match end {
        End::Converged => Outcome::Converged { iterations, residual },
        End::Stagnated => Outcome::Stagnated { iterations, residual },
        End::LimitReached => Outcome::LimitReached { residual },
    }
}

impl Desk<'_, '_> {
    /// Whether there is something to solve; else how the job ended is written.
    fn begin(&mut self, job: usize) -> bool {
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
    fn fill<R>(&self, lane: usize, memory: &mut LaneMemory<R>) -> f64
    where
        R: IndexMut<usize>,
        R::Output: Scalar,
    {
        let job = &self.jobs[self.holds[lane]];
        fill(self.lanes, (job.q, job.arguments), self.scratch, lane, memory)
    }

    /// Takes the configuration of the job that a lane holds.
    fn read<R>(&mut self, lane: usize, memory: &LaneMemory<R>)
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
    fn finish(&self, q: &mut [f64], arguments: &[Pose], scratch: &mut Scratch) -> bool {
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
