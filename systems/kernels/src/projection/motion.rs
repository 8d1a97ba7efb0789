//! Motions that stay on their leaf between the knots too.
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
    poses: Vec<Pose>,
    /// What the last projection added to the straight way, per unit of its length, as a velocity; zero before there was
    /// one.
    correction: Vec<f64>,
    /// The straight way's next point, before it is corrected.
    straight: Vec<f64>,
    bound: BoundMemory,
    /// Length of the last step's straight way; infinite before there was one.
    stride: f64,
}

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

/// How much longer than the last one a stride may be tried.
const LARGEST_GROWTH: f64 = 2.0;

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
        s.poses.clear();
        s.correction.clear();
        s.correction.resize(dimension, 0.0);
        s.stride = f64::INFINITY;
    }

    /// Largest implicit row at the current knot or at the goal; infinite where it cannot be evaluated.
    fn residual(&mut self, at_goal: bool) -> f64 {
        let s = &mut *self.scratch;
        let q = if at_goal { &s.goal } else { &s.current };
        let residual = self.program.residual(q, self.arguments, &mut s.solve).unwrap_or(f64::INFINITY);
        s.poses.clear();
        s.poses.extend_from_slice(s.solve.poses());
        residual
    }

    /// Whether the straight motion from the current knot to the goal is certified. Leaves the way to it in `chord`.
    fn goal_in_sight(&mut self) -> bool {
        let s = &mut *self.scratch;
        self.space.difference(&s.current, &s.goal, &mut s.chord);
        self.is_certified(false)
    }

    /// Whether `step` or `chord`, taken straight from the current knot, keeps the rows.
    fn is_certified(&mut self, of_step: bool) -> bool {
        self.bound(of_step) <= self.budget()
    }

    fn take_goal(&mut self) {
        let s = &mut *self.scratch;
        self.space.interpolate(&s.current, &s.goal, 1.0, &mut s.next);
        std::mem::swap(&mut s.current, &mut s.next);
    }

    /// Takes the longest step towards the goal that can be certified, halving it until it can; false where none can.
    fn advance(&mut self) -> bool {
        let length = self.length(false);
        let mut fraction = self.certified_fraction(length);
        while fraction * length >= self.settings.shortest_step {
            if self.try_step(fraction, length) {
                let s = &mut *self.scratch;
                std::mem::swap(&mut s.current, &mut s.next);
                s.stride = fraction * length;
                s.poses.clear();
                s.poses.extend_from_slice(s.solve.poses());
                return true;
            }
            self.scratch.correction.fill(0.0);
            fraction *= 0.5;
        }
        false
    }

    /// The fraction of the chord that meets the bound, with a margin for the correction that the projection adds. The
    /// bound grows with the square of the step and a little faster, so its root is a guess on the safe side of a step that
    /// is too long. Looked for from the last stride, which is nearly right.
    fn certified_fraction(&mut self, length: f64) -> f64 {
        let mut fraction = (self.scratch.stride / length).min(0.5);
        while fraction > 1e-6 {
            let s = &mut *self.scratch;
            s.step.iter_mut().zip(&s.chord).for_each(|(x, c)| *x = c * fraction);
            let bound = self.bound(true);
            let guess = (self.budget() / bound).sqrt();
            if bound <= self.budget() {
                return (0.9 * fraction * guess.min(LARGEST_GROWTH)).min(0.5);
            }
            fraction *= if bound.is_finite() { guess.min(0.9) } else { 0.5 };
        }
        0.0
    }

    fn bound(&mut self, of_step: bool) -> f64 {
        let MotionScratch { step, chord, poses, bound, .. } = &mut *self.scratch;
        self.program.residual_bound().between_with(if of_step { step } else { chord }, poses, bound)
    }

    /// What the rows may add between two knots that are solved already.
    fn budget(&self) -> f64 {
        self.settings.path_tolerance - 2.0 * self.settings.solve.tolerance
    }

    fn try_step(&mut self, fraction: f64, length: f64) -> bool {
        let s = &mut *self.scratch;
        let stride = fraction * length;
        self.space.interpolate(&s.current, &s.goal, fraction, &mut s.straight);
        // The leaf bends little from knot to knot: what was added last time is nearly what will be added now.
        s.step.iter_mut().zip(&s.correction).for_each(|(x, c)| *x = c * stride);
        self.space.integrate(&s.straight, &s.step, &mut s.next);
        if !project(self.program, &mut s.next, self.arguments, &self.settings.solve, &mut s.solve).is_converged() {
            return false;
        }
        self.space.difference(&s.straight, &s.next, &mut s.correction);
        s.correction.iter_mut().for_each(|c| *c /= stride);
        self.space.difference(&s.current, &s.next, &mut s.step);
        let stepped = self.length(true);
        if stepped > self.settings.jump * stride || !self.is_certified(true) {
            return false;
        }
        // What is left must get shorter, or the walk could circle.
        let s = &mut *self.scratch;
        self.space.difference(&s.next, &s.goal, &mut s.step);
        self.length(true) < length
    }

    /// Length of `step` or `chord` in the free coordinates.
    fn length(&self, of_step: bool) -> f64 {
        let delta = if of_step { &self.scratch.step } else { &self.scratch.chord };
        self.program.variables().iter().map(|&v| delta[v] * delta[v]).sum::<f64>().sqrt()
    }
}
