//! Moves a leaf: where an object is put down on the way, how a hand holds it where its handle leaves that free, where a joint is left. The
//! waypoints at which the leaf is reached are drawn towards their neighbours. What the leaf's value becomes follows from them, and the
//! waypoints at which it is left follow the value.

use crate::improvement::changes::changed::Changed;
use crate::improvement::changes::context::{Context, ImprovementScratch};
use crate::improvement::changes::shortcut::LEAST_GAIN;
use crate::improvement::changes::waypoint_chain::{
    across_fingers, chain_around, draw_steps, is_inside_chain, is_on_leaf, is_still, keep_rotations, projected,
};
use crate::improvement::cost::path_cost;
use crate::improvement::leaf_motion::{LeafMotion, interior_arguments, same_value};
use crate::planning_model::model::Model;
use crate::planning_model::state_classification::parameter_of;
use crate::step::steering;
use foliate_components::graph::leaf::Parameter;
use foliate_components::graph::{ConstraintId, ConstraintKind};
use foliate_kernels::constrained_motion::{Settings, project};
use rand::{Rng, RngExt};
use std::ops::{Range, RangeInclusive};

/// Motions, one after the other, on which a foliating constraint has one value, neither the first nor the last of the path.
#[derive(Clone, Debug, PartialEq)]
struct Run {
    constraint: ConstraintId,
    motions: Range<usize>,
}

/// Tries to move one leaf. `cost` is what the path costs.
pub(crate) fn attempt(
    context: &Context<'_>,
    motions: &[LeafMotion],
    cost: f64,
    rng: &mut impl Rng,
    scratch: &mut ImprovementScratch,
) -> Option<Changed> {
    let runs = runs(context.model, motions);
    let run = runs.get(rng.random_range(0..runs.len().max(1)))?;
    let mut moving = Moving { context, run, motions: motions.to_vec(), moved: vec![None; motions.len() + 1] };
    let chains = [run.motions.start, run.motions.end].map(|at| chain_around(motions, at));
    moving.arrive(&chains, rng, scratch)?;
    moving.depart(&chains[1], scratch)?;
    moving.go_along(scratch)?;
    let range = *chains[0].start() - 1..(*chains[0].end()).max(*chains[1].end()) + 1;
    let changed = moving.rebuilt(range.clone(), rng, scratch)?;
    let path = [&motions[..range.start], &changed, &motions[range.end..]].concat();
    let gain = cost - path_cost(context.cost, context.model, &path);
    // Compared so that NaN is no gain.
    let gains = gain > LEAST_GAIN;
    if !gains {
        return None;
    }
    let is_free = changed.iter().all(|motion| context.is_free(motion, &mut scratch.collision));
    is_free.then_some(Changed { range, motions: changed })
}

/// Whether a path has a leaf that can be moved.
pub(crate) fn is_possible(model: &Model, motions: &[LeafMotion]) -> bool {
    !runs(model, motions).is_empty()
}

/// Whether nothing else hangs on a value: the line of a straight lift is that of the placement.
fn may_move(model: &Model, constraint: ConstraintId) -> bool {
    match model.graph.constraint(constraint).kind {
        ConstraintKind::Lift { .. } => false,
        ConstraintKind::Placement { object, on } => model.constraint_of(ConstraintKind::Lift { object, on }).is_none(),
        _ => true,
    }
}

/// The leaves that can be moved: they are reached and left on the way.
fn runs(model: &Model, motions: &[LeafMotion]) -> Vec<Run> {
    let has = |index: usize, value: &Parameter| motions[index].parameters.iter().any(|p| same_value(p, value));
    let mut runs = Vec::new();
    for begin in 1..motions.len() {
        for value in motions[begin].parameters.iter().filter(|value| !has(begin - 1, value)) {
            let end = (begin..motions.len()).find(|&index| !has(index, value));
            // A value that goes over into another one of its constraint is not of waypoints.
            let is_new = |index: usize| motions[index].parameters.iter().all(|p| p.constraint != value.constraint);
            let is_alone = |end: usize| is_new(begin - 1) && is_new(end) && may_move(model, value.constraint);
            if let Some(end) = end.filter(|&end| is_alone(end)) {
                runs.push(Run { constraint: value.constraint, motions: begin..end });
            }
        }
    }
    runs
}

/// A path of which one leaf moves.
struct Moving<'a> {
    context: &'a Context<'a>,
    run: &'a Run,
    /// The motions; those of the run get their new leaf.
    motions: Vec<LeafMotion>,
    /// The waypoints that have moved, by the number of the motion that begins there.
    moved: Vec<Option<Vec<f64>>>,
}

impl Moving<'_> {
    /// Moves the waypoints at which the leaf is reached, and gives the motions of the run the leaf that comes of it.
    fn arrive(
        &mut self,
        chains: &[RangeInclusive<usize>; 2],
        rng: &mut impl Rng,
        scratch: &mut ImprovementScratch,
    ) -> Option<()> {
        let (at, size) = (self.run.motions.start, self.context.size());
        let start = |index: usize| self.motions[index].start(size);
        // Either end of the run, and what is before and behind it.
        let stops = chains.each_ref().map(|chain| [start(*chain.start() - 1), self.motions[*chain.end()].end(size)]);
        let mut by = vec![0.0; size];
        for stop in stops.iter().flatten() {
            let share = if rng.random_bool(0.5) { rng.random_range(0.0..0.5) } else { 0.0 };
            by.iter_mut().zip(*stop).zip(start(at)).for_each(|((by, there), here)| *by += share * (there - here));
        }
        keep_rotations(self.context, &mut by);
        let target: Vec<f64> = start(at).iter().zip(&by).map(|(q, by)| q + by).collect();
        let q = projected(self.context, &self.motions, (at, Some(self.run.constraint)), &target, scratch)?;
        self.take_leaf_of(&q)?;
        self.follow(chains[0].clone(), (at, q), scratch)
    }

    /// Moves the waypoints at which the leaf is left.
    fn depart(&mut self, chain: &RangeInclusive<usize>, scratch: &mut ImprovementScratch) -> Option<()> {
        let at = self.run.motions.end;
        let q = match self.moved[at].clone() {
            Some(known) => known,
            None => {
                let was = self.motions[at].start(self.context.size());
                projected(self.context, &self.motions, (at, None), was, scratch)?
            }
        };
        self.follow(chain.clone(), (at, q), scratch)
    }

    /// Moves waypoints inside the run that depend on its value: what is put into a drawer that is open wider is put elsewhere.
    fn go_along(&mut self, scratch: &mut ImprovementScratch) -> Option<()> {
        for index in self.run.motions.start + 1..self.run.motions.end {
            if self.moved[index].is_some() {
                continue;
            }
            let mut q = self.motions[index].start(self.context.size()).to_vec();
            self.put_on_leaf(index, &mut q, scratch)?;
            if !is_on_leaf(self.context, &self.motions[index - 1], None, &q) {
                let q = projected(self.context, &self.motions, (index, None), &q, scratch)?;
                self.follow(chain_around(&self.motions, index), (index, q), scratch)?;
            }
        }
        Some(())
    }

    /// Gives the motions of the run the value that their constraint has at a configuration.
    fn take_leaf_of(&mut self, q: &[f64]) -> Option<()> {
        let model = self.context.model;
        let X_WJ = model.kinematics.poses(q);
        let value = parameter_of(model, self.run.constraint, q, &X_WJ);
        for motion in &mut self.motions[self.run.motions.clone()] {
            let mut parameters = motion.parameters.clone();
            parameters.iter_mut().filter(|p| p.constraint == value.constraint).for_each(|p| *p = value);
            *motion = motion.clone().on_leaf(model, parameters)?;
        }
        Some(())
    }

    /// Moves the other waypoints of a chain as one of them has moved.
    fn follow(
        &mut self,
        chain: RangeInclusive<usize>,
        (at, q): (usize, Vec<f64>),
        scratch: &mut ImprovementScratch,
    ) -> Option<()> {
        let size = self.context.size();
        let was = self.motions[at].start(size);
        let mut by: Vec<f64> = q.iter().zip(was).map(|(q, was)| q - was).collect();
        keep_rotations(self.context, &mut by);
        self.moved[at] = Some(q);
        for index in chain {
            if self.moved[index].is_some() {
                continue;
            }
            // A motion that stands still begins and ends at one configuration.
            let known = match index > 0 && is_still(&self.motions[index - 1]) {
                true => self.moved[index - 1].clone(),
                false => across_fingers(self.context, &self.motions, index, |knot| self.moved[knot].clone()),
            };
            let target: Vec<f64> = self.motions[index].start(size).iter().zip(&by).map(|(q, by)| q + by).collect();
            let moved = match known {
                Some(known) => known,
                None => projected(self.context, &self.motions, (index, None), &target, scratch)?,
            };
            self.moved[index] = Some(moved);
        }
        Some(())
    }

    /// The motions of a range between the waypoints that have moved.
    fn rebuilt(
        &self,
        range: Range<usize>,
        rng: &mut impl Rng,
        scratch: &mut ImprovementScratch,
    ) -> Option<Vec<LeafMotion>> {
        let stops: Vec<Vec<f64>> =
            (range.start..=range.end).map(|index| self.stop(index, scratch)).collect::<Option<_>>()?;
        let mut rebuilt = Vec::with_capacity(range.len());
        for (index, ends) in range.zip(stops.windows(2)) {
            // Between two waypoints of one grasp change a motion goes straight, and on another leaf of implicit rows all its knots are new.
            let is_new = self.motions[index].is_implicit && self.run.motions.contains(&index);
            let kept = match is_new || is_inside_chain(&self.motions, index) {
                true => 0..0,
                false => self.kept(index, rng),
            };
            rebuilt.push(self.through(index, kept, (&ends[0], &ends[1]), scratch)?);
        }
        Some(rebuilt)
    }

    /// Where a motion begins; behind the last one where it ends.
    fn stop(&self, index: usize, scratch: &mut ImprovementScratch) -> Option<Vec<f64>> {
        let size = self.context.size();
        if let Some(moved) = self.moved.get(index).and_then(Option::as_ref) {
            return Some(moved.clone());
        }
        let Some(motion) = self.motions.get(index) else {
            return Some(self.motions.last()?.end(size).to_vec());
        };
        let mut q = motion.start(size).to_vec();
        if self.run.motions.contains(&index) {
            self.put_on_leaf(index, &mut q, scratch)?;
        }
        Some(q)
    }

    /// The knots of a motion that stay where the robot is, by number: those between its ends, but some next to ends that have moved.
    fn kept(&self, index: usize, rng: &mut impl Rng) -> Range<usize> {
        let (motion, size) = (&self.motions[index], self.context.size());
        let count = motion.knots.len() / size;
        let mut steps = |has_moved: bool| if has_moved { draw_steps(motion, size, rng) } else { 1 };
        let (first, left_out) = (steps(self.moved[index].is_some()), steps(self.moved[index + 1].is_some()));
        first..count.saturating_sub(left_out).max(first)
    }

    /// A motion from one end to the other, through some of its knots.
    fn through(
        &self,
        index: usize,
        kept: Range<usize>,
        (start, end): (&[f64], &[f64]),
        scratch: &mut ImprovementScratch,
    ) -> Option<LeafMotion> {
        let (context, size, motion) = (self.context, self.context.size(), &self.motions[index]);
        let mut middle = motion.knots[kept.start * size..kept.end * size].to_vec();
        if self.run.motions.contains(&index) {
            for q in middle.chunks_exact_mut(size) {
                self.put_on_leaf(index, q, scratch)?;
            }
        }
        let mut residual = motion.residual;
        let mut steer = |a: &[f64], b: &[f64]| {
            let (state, arguments) = (motion.state, &motion.arguments);
            let steered =
                steering::steer_whole(context.model, context.settings, state, arguments, (a, b), &mut scratch.motion)?;
            residual = residual.max(steered.residual);
            Some(steered.knots)
        };
        let knots = match middle.is_empty() {
            true => steer(start, end)?,
            false => {
                let mut knots = steer(start, &middle[..size])?;
                let last = middle[middle.len() - size..].to_vec();
                knots.extend_from_slice(&middle[size..]);
                knots.extend_from_slice(&steer(&last, end)?[size..]);
                knots
            }
        };
        Some(LeafMotion { knots, residual, ..motion.clone() })
    }

    /// Puts objects and resting joints where a motion's leaf has them.
    fn put_on_leaf(&self, index: usize, q: &mut [f64], scratch: &mut ImprovementScratch) -> Option<()> {
        let (motion, settings) = (&self.motions[index], self.context.settings);
        let model = self.context.model;
        let arguments = interior_arguments(model, motion.state, &motion.parameters)?;
        let interior = model.interior_program(motion.state).ok()?;
        let (tolerance, iterations) = (settings.projection_tolerance, settings.projection_iterations);
        let solve = Settings { tolerance, iterations, level: settings.level, ..Settings::default() };
        project(&interior.program, q, &arguments, &solve, &mut scratch.solve).is_converged().then_some(())
    }
}
