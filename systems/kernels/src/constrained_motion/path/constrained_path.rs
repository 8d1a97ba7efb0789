//! A constrained path: one motion, followed from knot to knot, each step as long as can be certified.
//!
//! A path proposes the configuration to solve next, and judges the solution. The caller solves, alone or beside other problems.

use crate::constrained_motion::bounds::point_rates::BoundMemory;
use crate::constrained_motion::path::settings::{MotionEnd, MotionSettings};
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::constrained_motion::program::scratch::Scratch;
use foliate_components::Pose;
use foliate_components::robot::configuration::ConfigurationSpace;

/// Working memory of one thread.
#[derive(Clone, Debug, Default)]
pub struct MotionScratch {
    pub(crate) tools: Tools,
    /// One per motion under way.
    pub(crate) paths: Vec<PathMemory>,
}

/// Into how many parts a step is divided at most.
const PARTS: u32 = 8;

/// The share of the bound that the rows are taken to make use of before anything is known.
const FIRST_BEND: f64 = 0.25;

/// How many strides away the goal is not looked for.
const SIGHT: f64 = 3.0;

/// What a step has to bring nearer to the goal, as a share of its straight way; below it is not worth its knot.
const LEAST_PROGRESS: f64 = 0.02;

/// How often a shorter step is tried where one leads away: the leaf may only have been bent.
const PATIENCE: u32 = 3;

/// Below this share what was learnt of the leaf's direction leads astray: it is dropped.
const POOR_PROGRESS: f64 = 0.3;

/// The share of what is promising that is tried.
const SAFETY: f64 = 0.8;

/// How much longer than the last one a stride may be tried.
const LARGEST_GROWTH: f64 = 2.0;

/// Buffers that paths share; none outlives a call.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tools {
    pub solve: Scratch,
    bound_memory: BoundMemory,
    /// Part of a step; configurations between two knots, and their errors.
    part: Vec<f64>,
    probes: Vec<f64>,
    errors: Vec<f64>,
}

/// The state of a path between two steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct PathMemory {
    /// The last knot.
    current: Vec<f64>,
    /// Where the next one is looked for, and what was found.
    pub next: Vec<f64>,
    goal: Vec<f64>,
    chord: Vec<f64>,
    step: Vec<f64>,
    /// Where bodies are at the last knot, and at the next.
    poses: [Vec<Pose>; 2],
    /// What the last projection added to the straight way, per unit of its length, as a velocity, and what the one before
    /// it did; zero before there was one.
    correction: Vec<f64>,
    earlier: Vec<f64>,
    /// The straight way's next point, before it is corrected.
    straight: Vec<f64>,
    /// Lengths of the last two steps' straight ways; infinite before there were any.
    strides: [f64; 2],
    /// The bound of the last step.
    bound: f64,
    /// What the rows did half-way through the last step, as a share of the bound.
    bend: f64,
    /// What is being tried; `None` at a knot.
    attempt: Option<Attempt>,
    /// Knots that there are.
    knots: usize,
}

/// A step that is being tried.
#[derive(Clone, Copy, Debug)]
struct Attempt {
    /// Of the chord.
    fraction: f64,
    /// Length of the chord.
    length: f64,
    /// How often a step has led away from here.
    led_away: u32,
}

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Taken,
    /// It is on the leaf, but hardly nearer to the goal.
    LeadsAway,
    /// It cannot be certified.
    TooLong,
    /// It was not found.
    Lost,
}

/// A motion under way.
pub(crate) struct ConstrainedPath<'a> {
    pub program: &'a ConstraintProgram,
    pub space: &'a ConfigurationSpace,
    pub arguments: &'a [Pose],
    pub settings: &'a MotionSettings,
    pub memory: &'a mut PathMemory,
    pub tools: &'a mut Tools,
}

impl ConstrainedPath<'_> {
    /// Stands at the start, which becomes the first knot; false where start or goal do not lie on the leaf.
    pub(crate) fn begin(&mut self, (from, to): (&[f64], &[f64]), knots: &mut Vec<f64>) -> bool {
        let size = self.program.configuration_size();
        if from.len() != size || to.len() != size || self.space.size() != size {
            return false;
        }
        self.stand(from, to);
        // The goal first: what the start's evaluation leaves behind is used.
        let most = 2.0 * self.settings.solve.tolerance;
        if self.residual(true) > most || self.residual(false) > most {
            return false;
        }
        knots.extend_from_slice(from);
        true
    }

    fn stand(&mut self, from: &[f64], to: &[f64]) {
        let dimension = self.space.dimension();
        let m = &mut *self.memory;
        for (buffer, q) in [(&mut m.current, from), (&mut m.next, from), (&mut m.straight, from), (&mut m.goal, to)] {
            buffer.clear();
            buffer.extend_from_slice(q);
        }
        m.chord.resize(dimension, 0.0);
        m.step.resize(dimension, 0.0);
        for zeros in [&mut m.correction, &mut m.earlier] {
            zeros.clear();
            zeros.resize(dimension, 0.0);
        }
        m.strides = [f64::INFINITY; 2];
        m.bound = 0.0;
        m.bend = FIRST_BEND;
        m.attempt = None;
        m.knots = 1;
    }

    /// Largest implicit row at the current knot or at the goal; infinite where it cannot be evaluated.
    fn residual(&mut self, at_goal: bool) -> f64 {
        let m = &mut *self.memory;
        let q = if at_goal { &m.goal } else { &m.current };
        let residual = self.program.residual(q, self.arguments, &mut self.tools.solve).unwrap_or(f64::INFINITY);
        m.poses[0].clear();
        m.poses[0].extend_from_slice(self.tools.solve.poses());
        residual
    }

    /// Goes on: `None` where `memory.next` is to be solved, and then judged; else how the path ended, with the goal as the last
    /// knot where it is reached.
    pub(crate) fn propose(&mut self, knots: &mut Vec<f64>) -> Option<MotionEnd> {
        let attempt = match self.memory.attempt {
            Some(attempt) => attempt,
            None => {
                if self.memory.knots >= self.settings.knots {
                    return Some(MotionEnd::TooManyKnots);
                }
                if self.goal_in_sight() {
                    self.take_goal();
                    knots.extend_from_slice(&self.memory.current);
                    return Some(MotionEnd::Reached);
                }
                let length = self.length(false);
                Attempt { fraction: self.next_fraction(length), length, led_away: 0 }
            }
        };
        let Attempt { fraction, length, led_away } = attempt;
        if fraction * length < self.settings.shortest_step || led_away >= PATIENCE {
            return Some(MotionEnd::Stopped);
        }
        self.memory.attempt = Some(attempt);
        self.predict(fraction, fraction * length);
        None
    }

    /// Judges what was proposed: whether it was solved, with bodies as `tools.solve` has them. Appends it where it is the next
    /// knot.
    pub(crate) fn judge(&mut self, is_solved: bool, knots: &mut Vec<f64>) {
        let Some(mut attempt) = self.memory.attempt.take() else { return };
        let stride = attempt.fraction * attempt.length;
        let step = if is_solved { self.weigh(attempt.length, stride) } else { Step::Lost };
        if step == Step::Lost {
            self.forget();
        }
        match step {
            Step::Taken => {
                let m = &mut *self.memory;
                std::mem::swap(&mut m.current, &mut m.next);
                m.poses.swap(0, 1);
                m.strides = [stride, m.strides[0]];
                m.knots += 1;
                knots.extend_from_slice(&m.current);
                return;
            }
            Step::LeadsAway => {
                attempt.led_away += 1;
                attempt.fraction *= 0.5;
            }
            Step::TooLong => attempt.fraction *= 0.7,
            Step::Lost => attempt.fraction *= 0.5,
        }
        self.memory.attempt = Some(attempt);
    }

    /// Whether the straight motion from the current knot to the goal is certified. Leaves the way to it in `chord`.
    fn goal_in_sight(&mut self) -> bool {
        let m = &mut *self.memory;
        self.space.difference(&m.current, &m.goal, &mut m.chord);
        if self.length(false) > SIGHT * self.memory.strides[0] {
            return false;
        }
        let bound = self.bound(false);
        bound <= self.promising() && self.holds(bound, true)
    }

    /// The largest bound that a step is likely to be certified with, as the last one bent.
    fn promising(&self) -> f64 {
        self.budget() / (self.memory.bend + 1.0 / f64::from(PARTS * PARTS))
    }

    /// Whether the rows stay within the path tolerance on the straight motion from the current knot by `step`, or by `chord` to
    /// the goal; `bound` is that of all of it.
    fn holds(&mut self, bound: f64, to_goal: bool) -> bool {
        let budget = self.budget();
        if bound <= budget {
            return true;
        }
        let most = if self.program.is_smooth() { PARTS } else { 1 };
        let Some(parts) = (1..=most.ilog2()).map(|k| 1 << k).find(|&n: &u32| self.leaves_room(bound, n)) else {
            return false;
        };
        let left = bound / f64::from(parts * parts);
        // The middle first: that is where a step fails, if it does, and where its bend is measured.
        let inner = std::iter::once(parts / 2).chain((1..parts).filter(|&k| k != parts / 2));
        let (m, tools) = (&mut *self.memory, &mut *self.tools);
        let (way, size) = (if to_goal { &m.chord } else { &m.step }, m.current.len());
        tools.probes.resize((parts as usize - 1) * size, 0.0);
        for (k, probe) in inner.zip(tools.probes.chunks_exact_mut(size.max(1))) {
            let share = f64::from(k) / f64::from(parts);
            tools.part.clear();
            tools.part.extend(way.iter().map(|x| share * x));
            self.space.integrate(&m.current, &tools.part, probe);
        }
        let level = self.settings.solve.level;
        let Tools { solve, probes, errors, .. } = tools;
        self.program.longest_errors(probes, self.arguments, level, solve, errors);
        m.bend = errors.first().map_or(m.bend, |middle| middle / bound);
        errors.iter().all(|error| error + left <= budget)
    }

    /// Whether in that many parts the bound leaves room for the residuals that are to be expected.
    fn leaves_room(&self, bound: f64, parts: u32) -> bool {
        let left = bound / f64::from(parts * parts);
        left + 1.2 * self.memory.bend * bound <= self.budget() || (parts == PARTS && left <= self.budget())
    }

    fn take_goal(&mut self) {
        let m = &mut *self.memory;
        self.space.interpolate(&m.current, &m.goal, 1.0, &mut m.next);
        std::mem::swap(&mut m.current, &mut m.next);
    }

    /// The fraction of the chord to try: the bound grows with the square of the stride.
    fn next_fraction(&mut self, length: f64) -> f64 {
        let (stride, bound) = (self.memory.strides[0], self.memory.bound);
        if stride == f64::INFINITY {
            return self.certified_fraction();
        }
        let growth = (SAFETY * self.promising() / bound).sqrt().min(LARGEST_GROWTH);
        (0.95 * growth * stride / length).min(0.5)
    }

    /// The fraction of the chord that meets the bound, with a margin for the correction that the projection adds. The
    /// bound grows with the square of the step and a little faster, so its root is a guess on the safe side of a step that
    /// is too long.
    fn certified_fraction(&mut self) -> f64 {
        let promising = SAFETY * self.promising();
        let mut fraction = 0.5;
        while fraction > 1e-6 {
            let m = &mut *self.memory;
            m.step.iter_mut().zip(&m.chord).for_each(|(x, c)| *x = c * fraction);
            let bound = self.bound(true);
            let guess = (promising / bound).sqrt();
            if bound <= promising {
                return (0.95 * fraction * guess.min(LARGEST_GROWTH)).min(0.5);
            }
            fraction *= if bound.is_finite() { guess.min(0.9) } else { 0.5 };
        }
        0.0
    }

    /// The bound on the rows between the current knot and `step` (or `chord`) away.
    fn bound(&mut self, of_step: bool) -> f64 {
        let PathMemory { step, chord, poses, .. } = &*self.memory;
        let delta = if of_step { step } else { chord };
        self.program.residual_bound().between_with(delta, &poses[0], &mut self.tools.bound_memory)
    }

    /// What the rows may add between two knots that are solved already.
    fn budget(&self) -> f64 {
        self.settings.path_tolerance - 2.0 * self.settings.solve.tolerance
    }

    /// What the solved next configuration is worth.
    fn weigh(&mut self, length: f64, stride: f64) -> Step {
        let m = &mut *self.memory;
        m.poses[1].clear();
        m.poses[1].extend_from_slice(self.tools.solve.poses());
        self.space.difference(&m.current, &m.next, &mut m.step);
        let (stepped, bound) = (self.length(true), self.bound(true));
        if stepped > self.settings.jump * stride {
            return Step::Lost;
        }
        if !self.holds(bound, false) {
            return Step::TooLong;
        }
        // What is left must get shorter, or the path could circle.
        let m = &mut *self.memory;
        m.bound = bound;
        self.space.difference(&m.next, &m.goal, &mut m.step);
        let progress = (length - self.length(true)) / stride;
        if progress < POOR_PROGRESS {
            self.forget()
        } else {
            self.learn(stride)
        }
        if progress >= LEAST_PROGRESS { Step::Taken } else { Step::LeadsAway }
    }

    /// Puts the straight way's next point into `straight`, and into `next` where the leaf is likely to be: it bends
    /// little from knot to knot, so what was added last time is nearly what will be added now, and how that changed tells
    /// the rest.
    fn predict(&mut self, fraction: f64, stride: f64) {
        let m = &mut *self.memory;
        self.space.interpolate(&m.current, &m.goal, fraction, &mut m.straight);
        let [last, before] = m.strides;
        let trend = (stride + last) / (last + before);
        // Before there were two steps there is no trend, and an infinite length.
        let trend = if trend.is_finite() { trend } else { 0.0 };
        let corrections = m.correction.iter().zip(&m.earlier);
        m.step.iter_mut().zip(corrections).for_each(|(x, (c, e))| *x = (c + trend * (c - e)) * stride);
        self.space.integrate(&m.straight, &m.step, &mut m.next);
    }

    /// Drops what led astray.
    fn forget(&mut self) {
        self.memory.correction.fill(0.0);
        self.memory.earlier.fill(0.0);
    }

    /// Keeps what the projection added.
    fn learn(&mut self, stride: f64) {
        let m = &mut *self.memory;
        std::mem::swap(&mut m.correction, &mut m.earlier);
        self.space.difference(&m.straight, &m.next, &mut m.correction);
        m.correction.iter_mut().for_each(|c| *c /= stride);
    }

    /// Length of `step` or `chord` in the free coordinates.
    fn length(&self, of_step: bool) -> f64 {
        let delta = if of_step { &self.memory.step } else { &self.memory.chord };
        self.program.variables().iter().map(|&v| delta[v] * delta[v]).sum::<f64>().sqrt()
    }
}
