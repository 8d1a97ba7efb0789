//! Motions that stay on their leaf between the knots too.
//!
//! The bound on second derivatives adds up how far every joint turns, whatever cancels, and so is often ten times what the
//! rows really do. Where a step is too long for it, the rows are evaluated in between: in each of n equal parts they leave
//! the larger of the residuals at its ends by at most 1/n² of the bound. An evaluation costs a fraction of a knot.
//!
//! No step bridges two branches of a leaf. The bound on second derivatives holds for the whole straight line between two
//! knots, so everything on it is within the path tolerance of the constraints: it could only lead from one branch to
//! another where those are that close, and there the line is as good a motion as any. The comparison of lengths
//! ([`MotionSettings::jump`]) merely finds out sooner.

use super::newton::{Settings, project};
use super::point_rates::BoundMemory;
use super::program::ConstraintProgram;
use super::scratch::Scratch;
use foliate_components::Pose;
use foliate_components::configuration::ConfigurationSpace;

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

/// Working memory of one thread.
#[derive(Clone, Debug, Default)]
pub struct MotionScratch {
    /// Of the solves.
    pub solve: Scratch,
    current: Vec<f64>,
    next: Vec<f64>,
    goal: Vec<f64>,
    chord: Vec<f64>,
    step: Vec<f64>,
    /// Where bodies are at the current knot, and at the next.
    poses: [Vec<Pose>; 2],
    /// What the last projection added to the straight way, per unit of its length, as a velocity, and what the one before
    /// it did; zero before there was one.
    correction: Vec<f64>,
    earlier: Vec<f64>,
    /// The straight way's next point, before it is corrected.
    straight: Vec<f64>,
    /// Between two knots.
    probe: Vec<f64>,
    /// Lengths of the last two steps' straight ways; infinite before there were any.
    strides: [f64; 2],
    /// The bound of the last step.
    bound: f64,
    /// What the rows did half-way through the last step, as a share of the bound.
    bend: f64,
    bound_memory: BoundMemory,
}

/// Into how many parts a step is divided at most.
const PARTS: u32 = 8;

/// The share of the bound that the rows are taken to make use of before anything is known.
const FIRST_BEND: f64 = 0.25;

/// Appends to `knots` the motion from `from` towards `to` on the leaf of `arguments`: whole configurations, one after the
/// other, the first of them `from`. Between two knots the residual stays below the path tolerance, by the bound on second
/// derivatives; a motion that stops early is valid as far as it goes.
///
/// Without implicit rows the motion is its two ends. The last knot is `to` bit for bit, but for whole turns of unlimited
/// angles and signs of quaternions, which follow the motion.
pub fn project_motion(
    program: &ConstraintProgram,
    space: &ConfigurationSpace,
    (from, to): (&[f64], &[f64]),
    arguments: &[Pose],
    settings: &MotionSettings,
    scratch: &mut MotionScratch,
    knots: &mut Vec<f64>,
) -> MotionEnd {
    let size = program.configuration_size();
    if from.len() != size || to.len() != size || space.size() != size {
        return MotionEnd::NotOnLeaf;
    }
    let mut walk = Walk { program, space, arguments, settings, scratch };
    walk.start(from, to);
    // The goal first: what the current knot's evaluation leaves behind is used.
    let most = 2.0 * settings.solve.tolerance;
    if walk.residual(true) > most || walk.residual(false) > most {
        return MotionEnd::NotOnLeaf;
    }
    knots.extend_from_slice(from);
    for _ in 1..settings.knots {
        if walk.goal_in_sight() {
            walk.take_goal();
            knots.extend_from_slice(&walk.scratch.current);
            return MotionEnd::Reached;
        }
        if !walk.advance() {
            return MotionEnd::Stopped;
        }
        knots.extend_from_slice(&walk.scratch.current);
    }
    MotionEnd::TooManyKnots
}

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

/// A motion under way: `scratch.current` is the last knot, `scratch.poses` its bodies.
struct Walk<'a> {
    program: &'a ConstraintProgram,
    space: &'a ConfigurationSpace,
    arguments: &'a [Pose],
    settings: &'a MotionSettings,
    scratch: &'a mut MotionScratch,
}

impl Walk<'_> {
    fn start(&mut self, from: &[f64], to: &[f64]) {
        let dimension = self.space.dimension();
        let s = &mut *self.scratch;
        for (buffer, q) in [(&mut s.current, from), (&mut s.next, from), (&mut s.straight, from), (&mut s.goal, to)] {
            buffer.clear();
            buffer.extend_from_slice(q);
        }
        s.chord.resize(dimension, 0.0);
        s.step.resize(dimension, 0.0);
        s.probe.clone_from(&s.current);
        for zeros in [&mut s.correction, &mut s.earlier] {
            zeros.clear();
            zeros.resize(dimension, 0.0);
        }
        s.strides = [f64::INFINITY; 2];
        s.bound = 0.0;
        s.bend = FIRST_BEND;
    }

    /// Largest implicit row at the current knot or at the goal; infinite where it cannot be evaluated.
    fn residual(&mut self, at_goal: bool) -> f64 {
        let s = &mut *self.scratch;
        let q = if at_goal { &s.goal } else { &s.current };
        let residual = self.program.residual(q, self.arguments, &mut s.solve).unwrap_or(f64::INFINITY);
        s.poses[0].clear();
        s.poses[0].extend_from_slice(s.solve.poses());
        residual
    }

    /// Whether the straight motion from the current knot to the goal is certified. Leaves the way to it in `chord`.
    fn goal_in_sight(&mut self) -> bool {
        let s = &mut *self.scratch;
        self.space.difference(&s.current, &s.goal, &mut s.chord);
        if self.length(false) > SIGHT * self.scratch.strides[0] {
            return false;
        }
        let bound = self.bound(false);
        bound <= self.promising() && self.holds(bound, true)
    }

    /// The largest bound that a step is likely to be certified with, as the last one bent.
    fn promising(&self) -> f64 {
        self.budget() / (self.scratch.bend + 1.0 / f64::from(PARTS * PARTS))
    }

    /// Whether the rows stay within the path tolerance on the straight motion from the current knot to the next, or to the
    /// goal; `bound` is that of all of it.
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
        // The middle first: that is where a step fails, if it does.
        let inner = std::iter::once(parts / 2).chain((1..parts).filter(|&k| k != parts / 2));
        for k in inner {
            let s = &mut *self.scratch;
            let end = if to_goal { &s.goal } else { &s.next };
            self.space.interpolate(&s.current, end, f64::from(k) / f64::from(parts), &mut s.probe);
            let residual = self.program.longest_error(&s.probe, self.arguments, &mut s.solve).unwrap_or(f64::INFINITY);
            if 2 * k == parts {
                s.bend = residual / bound;
            }
            if residual + left > budget {
                return false;
            }
        }
        true
    }

    /// Whether in that many parts the bound leaves room for the residuals that are to be expected.
    fn leaves_room(&self, bound: f64, parts: u32) -> bool {
        let left = bound / f64::from(parts * parts);
        left + 1.2 * self.scratch.bend * bound <= self.budget() || (parts == PARTS && left <= self.budget())
    }

    fn take_goal(&mut self) {
        let s = &mut *self.scratch;
        self.space.interpolate(&s.current, &s.goal, 1.0, &mut s.next);
        std::mem::swap(&mut s.current, &mut s.next);
    }

    /// Takes the longest step towards the goal that can be certified, halving it until it can; false where none can.
    fn advance(&mut self) -> bool {
        let length = self.length(false);
        let mut fraction = self.next_fraction(length);
        let mut led_away = 0;
        while fraction * length >= self.settings.shortest_step && led_away < PATIENCE {
            match self.try_step(fraction, length) {
                Step::Taken => {
                    let s = &mut *self.scratch;
                    std::mem::swap(&mut s.current, &mut s.next);
                    s.poses.swap(0, 1);
                    s.strides = [fraction * length, s.strides[0]];
                    return true;
                }
                Step::LeadsAway => led_away += 1,
                Step::TooLong => {
                    fraction *= 0.7;
                    continue;
                }
                Step::Lost => {}
            }
            fraction *= 0.5;
        }
        false
    }

    /// The fraction of the chord to try: the bound grows with the square of the stride.
    fn next_fraction(&mut self, length: f64) -> f64 {
        let (stride, bound) = (self.scratch.strides[0], self.scratch.bound);
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
            let s = &mut *self.scratch;
            s.step.iter_mut().zip(&s.chord).for_each(|(x, c)| *x = c * fraction);
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
        let MotionScratch { step, chord, poses, bound_memory, .. } = &mut *self.scratch;
        self.program.residual_bound().between_with(if of_step { step } else { chord }, &poses[0], bound_memory)
    }

    /// What the rows may add between two knots that are solved already.
    fn budget(&self) -> f64 {
        self.settings.path_tolerance - 2.0 * self.settings.solve.tolerance
    }

    fn try_step(&mut self, fraction: f64, length: f64) -> Step {
        let stride = fraction * length;
        self.predict(fraction, stride);
        let s = &mut *self.scratch;
        if !project(self.program, &mut s.next, self.arguments, &self.settings.solve, &mut s.solve).is_converged() {
            self.forget();
            return Step::Lost;
        }
        s.poses[1].clear();
        s.poses[1].extend_from_slice(s.solve.poses());
        self.space.difference(&s.current, &s.next, &mut s.step);
        let (stepped, bound) = (self.length(true), self.bound(true));
        if stepped > self.settings.jump * stride {
            self.forget();
            return Step::Lost;
        }
        if !self.holds(bound, false) {
            return Step::TooLong;
        }
        // What is left must get shorter, or the walk could circle.
        let s = &mut *self.scratch;
        s.bound = bound;
        self.space.difference(&s.next, &s.goal, &mut s.step);
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
        let s = &mut *self.scratch;
        self.space.interpolate(&s.current, &s.goal, fraction, &mut s.straight);
        let [last, before] = s.strides;
        let trend = (stride + last) / (last + before);
        // Before there were two steps there is no trend, and an infinite length.
        let trend = if trend.is_finite() { trend } else { 0.0 };
        let corrections = s.correction.iter().zip(&s.earlier);
        s.step.iter_mut().zip(corrections).for_each(|(x, (c, e))| *x = (c + trend * (c - e)) * stride);
        self.space.integrate(&s.straight, &s.step, &mut s.next);
    }

    /// Drops what led astray.
    fn forget(&mut self) {
        self.scratch.correction.fill(0.0);
        self.scratch.earlier.fill(0.0);
    }

    /// Keeps what the projection added.
    fn learn(&mut self, stride: f64) {
        let s = &mut *self.scratch;
        std::mem::swap(&mut s.correction, &mut s.earlier);
        self.space.difference(&s.straight, &s.next, &mut s.correction);
        s.correction.iter_mut().for_each(|c| *c /= stride);
    }

    /// Length of `step` or `chord` in the free coordinates.
    fn length(&self, of_step: bool) -> f64 {
        let delta = if of_step { &self.scratch.step } else { &self.scratch.chord };
        self.program.variables().iter().map(|&v| delta[v] * delta[v]).sum::<f64>().sqrt()
    }
}
