//! Damped Gauss–Newton in lanes: one problem a lane, the next from the queue as soon as one has ended.
//!
//! The same algorithm as `scalar`, lane by lane, in either precision. What a lane computes depends on its own problem alone:
//! nothing is skipped unless every lane's result stays the same bit for bit.

use crate::constrained_motion::lane_rows::form::{LaneProgram, LaneRows};
use crate::constrained_motion::lane_rows::linearise::linearise;
use crate::constrained_motion::lane_rows::memory::LaneMemory;
use crate::constrained_motion::lane_rows::slots::{At, Out};
use crate::constrained_motion::newton::settings::Settings;
use crate::kinematics::lane_forward::run as run_lanes;
use crate::lanes::level::{Kernel, Level};
use crate::lanes::vector::{F64Row, Isa, Lanes, Mask, Scalar};
use crate::linear::lane_ldlt::{LaneSystem, Rows, damped_step_lanes};

/// How a lane's problem ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Converged,
    Stagnated,
    LimitReached,
}

/// Who brings problems to the lanes and takes them away.
pub(crate) trait Queue<R> {
    /// Puts the next problem into `memory.q` and `memory.given` of a lane and answers how many steps it has taken elsewhere;
    /// `None` where there is no problem left.
    fn next(&mut self, lane: usize, memory: &mut LaneMemory<R>) -> Option<u32>;
    /// Takes the problem of a lane away. `iterations` counts the steps taken elsewhere too.
    fn ended(&mut self, lane: usize, end: End, iterations: u32, residual: f64, memory: &LaneMemory<R>);
}

/// Solves the problems of a queue until it is empty, in lanes of double precision. Not for the level `scalar`: the scalar Newton
/// is faster there, and compilers take minutes over these kernels on arrays.
pub(crate) fn solve(
    program: &LaneProgram,
    coordinates: usize,
    settings: &Settings,
    memory: &mut LaneMemory<F64Row>,
    queue: &mut dyn Queue<F64Row>,
) {
    memory.prepare(program, coordinates);
    settings.level.run(Double(Solve { program, settings, memory, queue }));
}

/// What a solve in lanes works with.
pub(crate) struct Solve<'a, R> {
    pub(crate) program: &'a LaneProgram,
    pub(crate) settings: &'a Settings,
    pub(crate) memory: &'a mut LaneMemory<R>,
    pub(crate) queue: &'a mut dyn Queue<R>,
}

/// How often a step is solved at most, each time without the coordinates that it would push out of their bounds.
const SOLVES: u32 = 3;

struct Double<'a>(Solve<'a, F64Row>);

impl Kernel for Double<'_> {
    type Output = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        if I::SIDE_BY_SIDE {
            work_off::<I::F64>(isa, self.0, SOLVES);
        }
    }
}

/// Prepares a lane for a problem that has taken so many steps.
#[inline(always)]
fn begin<V: Lanes>(lane: usize, taken: u32, memory: &mut LaneMemory<V::Row>) {
    memory.best[lane] = V::Scalar::of(f64::INFINITY);
    memory.since_halved[lane] = V::Scalar::of(0.0);
    memory.iterations[lane] = V::Scalar::of(f64::from(taken));
}

/// Works the queue off; a step is solved `solves` times at most.
#[inline(always)]
pub(crate) fn work_off<V: Lanes>(isa: V::Isa, solve: Solve<'_, V::Row>, solves: u32) {
    let Solve { program, settings, memory, queue } = solve;
    let mut running = 0_u32;
    for lane in 0..V::COUNT {
        if let Some(taken) = queue.next(lane, memory) {
            begin::<V>(lane, taken, memory);
            running |= 1 << lane;
        }
    }
    let number = |x: f64| V::constant(isa, x);
    while running != 0 {
        let is_running = <V::Mask as Mask>::from_bits(isa, running);
        let at_rest = evaluate::<V>(isa, program, memory, is_running, false);
        let (mut worst, mut squared) = (number(0.0), number(0.0));
        for row in &memory.values[..program.rows] {
            let e = V::load(isa, row);
            worst = worst.max(e.abs());
            squared = e.mul_add(e, squared);
        }
        let finite = squared.le(V::splat(isa, V::Scalar::MAX));
        let best = V::load(isa, &memory.best);
        let halved = squared.le(best * number(0.5));
        let since = V::load(isa, &memory.since_halved) + number(1.0);
        let since = V::select(halved, number(0.0), since);
        let best = V::select(halved, squared, best);
        let iterations = V::load(isa, &memory.iterations);
        let converged = worst.le(number(settings.tolerance)) & finite;
        let stagnated = number(f64::from(settings.patience)).le(since) | !finite;
        let exhausted = number(f64::from(settings.iterations)).le(iterations);
        let ended = (converged | stagnated | exhausted) & is_running;
        let mut stuck = 0;
        if ended.bits() != running {
            let damping = squared.mul_add(number(settings.damping), number(settings.damping_floor));
            stuck = step::<V>(isa, program, (settings, solves), memory, is_running & !ended, at_rest, damping);
        }
        best.store(&mut memory.best);
        since.store(&mut memory.since_halved);
        (iterations + number(1.0)).store(&mut memory.iterations);
        let done = ended.bits() | stuck;
        if done == 0 {
            continue;
        }
        worst.store(&mut memory.residual);
        let (converged, stagnated) = (converged.bits(), stagnated.bits() | stuck);
        let mut left = done;
        while left != 0 {
            let (lane, bit) = (left.trailing_zeros() as usize % V::COUNT, left & left.wrapping_neg());
            left &= !bit;
            let end = if converged & bit != 0 {
                End::Converged
            } else if stagnated & bit != 0 {
                End::Stagnated
            } else {
                End::LimitReached
            };
            let steps = memory.iterations[lane].to_f64() as u32 - 1;
            queue.ended(lane, end, steps, memory.residual[lane].to_f64(), memory);
            match queue.next(lane, memory) {
                Some(taken) => begin::<V>(lane, taken, memory),
                None => running &= !bit,
            }
        }
    }
}

/// Values of the rows where the lanes are, all of them, in double precision. Not for the level `scalar`, as [`solve`].
pub(crate) fn evaluate_values(program: &LaneProgram, level: Level, memory: &mut LaneMemory<F64Row>) {
    level.run(Values { program, memory });
}

struct Values<'a> {
    program: &'a LaneProgram,
    memory: &'a mut LaneMemory<F64Row>,
}

impl Kernel for Values<'_> {
    type Output = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        if I::SIDE_BY_SIDE {
            let all = <<I::F64 as Lanes>::Mask as Mask>::from_bits(isa, u32::MAX >> (32 - I::F64::COUNT));
            let _at_rest = evaluate::<I::F64>(isa, self.program, self.memory, all, true);
        }
    }
}

/// Poses, values and, unless values alone are asked for, Jacobian where the lanes are. Answers the lanes in which a lone contact
/// has two rows at rest.
#[inline(always)]
fn evaluate<V: Lanes>(
    isa: V::Isa,
    program: &LaneProgram,
    memory: &mut LaneMemory<V::Row>,
    running: V::Mask,
    values_alone: bool,
) -> V::Mask {
    let LaneMemory { q, given, bodies, values, jacobian, vectors, .. } = memory;
    run_lanes::<V>(isa, &program.steps, q, given, bodies);
    if !program.is_dense && !values_alone {
        let zero = V::constant(isa, 0.0);
        for number in &mut jacobian[..program.rows * program.moves.len()] {
            zero.store(number);
        }
    }
    let at = At { bodies, given };
    let mut out = Out { values, jacobian, vectors, stride: program.rows, adds: !program.is_dense, values_alone };
    let mut at_rest = running;
    for rows in &program.blocks {
        at_rest = linearise::<V>(isa, rows, at, running, &mut out);
    }
    at_rest
}

/// One step of the lanes that go on; answers (bits) those that cannot move.
#[inline(always)]
fn step<V: Lanes>(
    isa: V::Isa,
    program: &LaneProgram,
    (settings, solves): (&Settings, u32),
    memory: &mut LaneMemory<V::Row>,
    going: V::Mask,
    at_rest: V::Mask,
    damping: V,
) -> u32 {
    let (rows, width) = (program.rows, program.moves.len());
    freeze_by_gradient::<V>(isa, program, memory);
    let going_bits = going.bits();
    // Where every lane's contact is inside, its two rows at rest are zero in value and Jacobian: leaving them out changes no
    // bit of the others.
    let lone_contact = matches!(program.blocks.as_slice(), [LaneRows::Contact(_)]);
    let short = lone_contact && at_rest.bits() & going_bits == going_bits;
    let chosen = if short { Rows::ThreeOfFive } else { Rows::Every };
    let mut positive = going;
    for left in (0..solves).rev() {
        let LaneMemory { values, jacobian, frozen, multipliers, gram, step, .. } = &mut *memory;
        let system =
            LaneSystem { jacobian: &mut jacobian[..rows * width], values: &values[..rows], frozen: &frozen[..width] };
        positive = damped_step_lanes::<V>(isa, system, chosen, damping, (gram, multipliers), &mut step[..width]);
        // The last solution is cut to the bounds anyhow.
        if left == 0 || freeze_by_step::<V>(isa, program, memory, going_bits) == 0 {
            break;
        }
    }
    integrate::<V>(isa, program, settings, memory, going, positive)
}

/// Freezes coordinates at a bound that the gradient of ½|e|² pushes outward. With so many lanes there is nearly always one at
/// some bound, and which one cannot be predicted: gradients of all are found, and no branch is taken.
#[inline(always)]
fn freeze_by_gradient<V: Lanes>(isa: V::Isa, program: &LaneProgram, memory: &mut LaneMemory<V::Row>) {
    let LaneMemory { q, values, jacobian, at_bounds, frozen, .. } = memory;
    let values = &values[..program.rows];
    let zero = V::constant(isa, 0.0);
    // As in the scalar code; scaled with the type.
    let slack = 4096.0 * V::Scalar::EPSILON.to_f64();
    let columns = jacobian.chunks_exact(values.len().max(1));
    for (((change, column), at), frozen) in program.moves.iter().zip(columns).zip(at_bounds).zip(frozen) {
        let q = V::load(isa, &q[change.coordinate]);
        let upper = V::constant(isa, change.upper - slack).le(q);
        let lower = q.le(V::constant(isa, change.lower + slack)) & !upper;
        let mut gradient = zero;
        for (j, e) in column.iter().zip(values) {
            gradient = V::load(isa, j).mul_add(V::load(isa, e), gradient);
        }
        *at = [upper.bits(), lower.bits()];
        *frozen = ((upper & gradient.lt(zero)) | (lower & zero.lt(gradient))).bits();
    }
}

/// Freezes coordinates at a bound that the step pushes outward; answers the lanes among those that go on where there were any.
#[inline(always)]
fn freeze_by_step<V: Lanes>(isa: V::Isa, program: &LaneProgram, memory: &mut LaneMemory<V::Row>, going: u32) -> u32 {
    let LaneMemory { step, at_bounds, frozen, .. } = memory;
    let zero = V::constant(isa, 0.0);
    let mut any = 0;
    for ((step, [upper, lower]), frozen) in step[..program.moves.len()].iter().zip(at_bounds).zip(frozen) {
        let step = V::load(isa, step);
        let outward = (*upper & zero.lt(step).bits()) | (*lower & step.lt(zero).bits());
        let new = outward & !*frozen & going;
        *frozen |= new;
        any |= new;
    }
    any
}

/// Moves the lanes that go on by their steps, within bounds; answers those that cannot move.
#[inline(always)]
fn integrate<V: Lanes>(
    isa: V::Isa,
    program: &LaneProgram,
    settings: &Settings,
    memory: &mut LaneMemory<V::Row>,
    going: V::Mask,
    positive: V::Mask,
) -> u32 {
    let mut most = V::constant(isa, 0.0);
    let mut fine = positive;
    let largest = V::splat(isa, V::Scalar::MAX);
    for step in &memory.step[..program.moves.len()] {
        let size = V::load(isa, step).abs();
        most = most.max(size);
        fine = fine & size.le(largest);
    }
    let stuck = going & !(fine & V::constant(isa, 1e-14).lt(most));
    let moving = going & !stuck;
    let limit = V::constant(isa, settings.step_limit);
    let scale = V::select(limit.lt(most), limit / most, V::constant(isa, 1.0));
    for (change, step) in program.moves.iter().zip(&memory.step) {
        let row = &mut memory.q[change.coordinate];
        let q = V::load(isa, row);
        let next = V::load(isa, step).mul_add(scale, q);
        let next = next.max(V::constant(isa, change.lower)).min(V::constant(isa, change.upper));
        V::select(moving, next, q).store(row);
    }
    stuck.bits()
}
