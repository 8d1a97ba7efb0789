//! First steps in single precision, sixteen problems at a time.
//!
//! Queues of hundreds of problems gain by it. Searches do not use it: they have too few problems at a time to fill the lanes
//! (docs/decisions/0010).

use crate::constrained_motion::lane_rows::form::LaneProgram;
use crate::constrained_motion::lane_rows::memory::LaneMemory;
use crate::constrained_motion::newton::lane_jobs::{LaneJobs, outcome};
use crate::constrained_motion::newton::lanes::{End, Queue, Solve, work_off};
use crate::constrained_motion::newton::settings::Settings;
use crate::lanes::level::Kernel;
use crate::lanes::vector::{F32Row, Isa};

/// What keeps a problem from single precision: poses or coordinates larger than this, metres and radians. Below, rounding
/// leaves residuals that are a tenth of what single precision is asked for.
const SINGLE_REACH: f64 = 16.0;

/// Smallest λ² in single precision: below, rounding would leave nothing of the matrix of a singular configuration.
const SINGLE_FLOOR: f64 = 1e-6;

/// With sixteen lanes there is nearly always one that meets a bound, and all would be solved again for it; first steps need not
/// be so exact.
const SOLVES: u32 = 1;

/// Steps all jobs down to [`Settings::single_until`]. `todo` takes those that come so far, with the steps that they have taken.
pub(crate) fn first_steps(
    lanes: &LaneProgram,
    coordinates: usize,
    settings: &Settings,
    jobs: &mut LaneJobs<'_, '_>,
    todo: &mut Vec<(usize, u32)>,
) {
    let mut memory = std::mem::take(&mut jobs.scratch.single_lanes);
    let rough = Settings {
        tolerance: settings.tolerance.max(settings.single_until),
        damping_floor: settings.damping_floor.max(SINGLE_FLOOR),
        ..*settings
    };
    memory.prepare(lanes, coordinates);
    let mut queue = First { jobs: &mut *jobs, next: 0, todo };
    settings.level.run(Single(Solve { program: lanes, settings: &rough, memory: &mut memory, queue: &mut queue }));
    jobs.scratch.single_lanes = memory;
}

struct Single<'a>(Solve<'a, F32Row>);

impl Kernel for Single<'_> {
    type Output = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        if I::SIDE_BY_SIDE {
            work_off::<I::F32>(isa, self.0, SOLVES);
        }
    }
}

/// The jobs in single precision: what comes near enough is to be done in double precision, what fails has failed.
struct First<'a, 'd, 'j> {
    jobs: &'a mut LaneJobs<'d, 'j>,
    /// First job that was not taken yet.
    next: usize,
    /// Jobs with the steps that they have taken.
    todo: &'a mut Vec<(usize, u32)>,
}

impl Queue<F32Row> for First<'_, '_, '_> {
    fn next(&mut self, lane: usize, memory: &mut LaneMemory<F32Row>) -> Option<u32> {
        while self.next < self.jobs.jobs.len() {
            self.next += 1;
            let job = self.next - 1;
            if self.jobs.begin(job) {
                self.jobs.holds[lane] = job;
                if self.jobs.fill(lane, memory) <= SINGLE_REACH {
                    return Some(0);
                }
                self.todo.push((job, 0));
            }
        }
        None
    }

    fn ended(&mut self, lane: usize, end: End, iterations: u32, residual: f64, memory: &LaneMemory<F32Row>) {
        let number = self.jobs.holds[lane];
        // Where nothing has moved the start keeps all its digits.
        if iterations > 0 {
            self.jobs.read(lane, memory);
        }
        match end {
            End::Converged => self.todo.push((number, iterations)),
            _ => self.jobs.jobs[number].outcome = outcome(end, iterations, residual),
        }
    }
}
