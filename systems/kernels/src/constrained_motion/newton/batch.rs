//! Many problems of one program: one per lane, refilled from the queue as lanes end.

use crate::constrained_motion::lane_rows::form::LaneProgram;
use crate::constrained_motion::lane_rows::memory::LaneMemory;
use crate::constrained_motion::newton::lane_jobs::{Job, LaneJobs, MOST_LANES, outcome};
use crate::constrained_motion::newton::lanes::{End, Queue, solve};
use crate::constrained_motion::newton::scalar::project;
use crate::constrained_motion::newton::settings::{Outcome, Settings};
use crate::constrained_motion::newton::single::first_steps;
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::constrained_motion::program::scratch::Scratch;
use crate::lanes::F64Row;

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
    let mut jobs = LaneJobs { program, lanes, jobs, settings, scratch, holds: [0; MOST_LANES] };
    if settings.single_until > 0.0 {
        first_steps(lanes, coordinates, settings, &mut jobs, &mut todo);
    } else {
        todo.extend((0..jobs.jobs.len()).map(|job| (job, 0)));
    }
    solve(lanes, coordinates, settings, &mut double, &mut Last { jobs: &mut jobs, todo: todo.iter() });
    (scratch.lanes, scratch.todo) = (double, todo);
}

/// The jobs in double precision, which decides.
struct Last<'a, 'd, 'j> {
    jobs: &'a mut LaneJobs<'d, 'j>,
    todo: std::slice::Iter<'a, (usize, u32)>,
}

impl Queue<F64Row> for Last<'_, '_, '_> {
    fn next(&mut self, lane: usize, memory: &mut LaneMemory<F64Row>) -> Option<u32> {
        for &(job, taken) in self.todo.by_ref() {
            if self.jobs.begin(job) {
                self.jobs.holds[lane] = job;
                self.jobs.fill(lane, memory);
                return Some(taken);
            }
        }
        None
    }

    fn ended(&mut self, lane: usize, end: End, iterations: u32, residual: f64, memory: &LaneMemory<F64Row>) {
        self.jobs.read(lane, memory);
        let LaneJobs { program, jobs, scratch, holds, .. } = &mut *self.jobs;
        let job = &mut jobs[holds[lane]];
        job.outcome = outcome(end, iterations, residual);
        if job.outcome.is_converged() && !program.finish(job.q, job.arguments, scratch) {
            job.outcome = Outcome::RootOutOfBounds;
        }
    }
}
