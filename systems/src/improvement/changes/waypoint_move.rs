//! Moves the waypoints of a grasp or release, such as pregrasp, grasp and the knot where the object is lifted: they are drawn towards
//! the motions before and behind and projected again, so that redundant joints, a mobile base or another branch of inverse kinematics
//! make these motions shorter. The leaf stays, so that nothing else has to change.

use crate::improvement::changes::changed::Changed;
use crate::improvement::changes::context::{Context, ImprovementScratch};
use crate::improvement::changes::shortcut::LEAST_GAIN;
use crate::improvement::changes::waypoint_chain::{
    across_fingers, draw_chain, draw_steps, is_still, keep_rotations, projected,
};
use crate::improvement::cost::path_cost;
use crate::improvement::leaf_motion::{LeafMotion, moves_fingers};
use crate::step::steering;
use rand::{Rng, RngExt};
use std::ops::RangeInclusive;

/// Tries to move the waypoints of one grasp change. `cost` is what the path costs.
pub(crate) fn attempt(
    context: &Context<'_>,
    motions: &[LeafMotion],
    cost: f64,
    rng: &mut impl Rng,
    scratch: &mut ImprovementScratch,
) -> Option<Changed> {
    let size = context.size();
    let chain = draw_chain(motions, rng)?;
    let (first, last) = (*chain.start(), *chain.end());
    // The motion before turns off at one of its knots, and the motion behind is joined at one.
    let (before, behind) = (&motions[first - 1], &motions[last]);
    let turn_off = before.knots.len() / size - 1 - draw_steps(before, size, rng);
    let join = draw_steps(behind, size, rng);
    let knot = |motion: &LeafMotion, number: usize| motion.knots[number * size..][..size].to_vec();
    let ends = (knot(before, turn_off), knot(behind, join));
    let moved = moved_knots(context, motions, chain, (&ends.0, &ends.1), rng, scratch)?;
    let stops: Vec<&[f64]> =
        [&ends.0[..]].into_iter().chain(moved.iter().map(Vec::as_slice)).chain([&ends.1[..]]).collect();
    let mut changed = Vec::with_capacity(stops.len() - 1);
    for (motion, pair) in motions[first - 1..=last].iter().zip(stops.windows(2)) {
        let steered = steering::steer_whole(
            context.model,
            context.settings,
            motion.state,
            &motion.arguments,
            (pair[0], pair[1]),
            &mut scratch.motion,
        )?;
        let residual = motion.residual.max(steered.residual);
        changed.push(LeafMotion { knots: steered.knots, residual, ..motion.clone() });
    }
    let mut whole = changed.clone();
    whole[0].knots = [&before.knots[..turn_off * size], &whole[0].knots].concat();
    let end = whole.len() - 1;
    whole[end].knots.extend_from_slice(&behind.knots[(join + 1) * size..]);
    let path = [&motions[..first - 1], &whole, &motions[last + 1..]].concat();
    let gain = cost - path_cost(context.cost, context.model, &path);
    if gain.is_nan() || gain <= LEAST_GAIN {
        return None;
    }
    let is_free = changed.iter().all(|motion| context.is_free(motion, &mut scratch.collision));
    is_free.then_some(Changed { range: first - 1..last + 1, motions: whole })
}

/// Where the waypoints of a chain are wanted.
enum Wish {
    /// Every one of them is moved by this.
    All(Vec<f64>),
    /// One coordinate goes by this share of the way to a value.
    One { coordinate: usize, value: f64, share: f64 },
}

impl Wish {
    fn of(&self, was: &[f64]) -> Vec<f64> {
        let mut q = was.to_vec();
        match self {
            Self::All(by) => q.iter_mut().zip(by).for_each(|(q, by)| *q += by),
            Self::One { coordinate, value, share } => q[*coordinate] += share * (value - was[*coordinate]),
        }
        q
    }

    /// A projection moves all coordinates. So often one of them is set to its value again.
    fn rounds(&self) -> usize {
        if matches!(self, Self::All(_)) { 1 } else { 3 }
    }
}

/// Half of the time all coordinates are drawn towards the neighbours, else the coordinate that takes longest on one of the ways.
fn draw_wish(context: &Context<'_>, stops: &[&[f64]], rng: &mut impl Rng) -> Wish {
    let (before, behind) = (stops[0], stops[stops.len() - 1]);
    let (first, last) = (stops[1], stops[stops.len() - 2]);
    if rng.random_bool(0.5) {
        let shares = [(); 2].map(|()| rng.random_range(0.0..0.7));
        let by = |i: usize| shares[0] * (before[i] - first[i]) + shares[1] * (behind[i] - last[i]);
        let mut by: Vec<f64> = (0..context.size()).map(by).collect();
        keep_rotations(context, &mut by);
        return Wish::All(by);
    }
    let piece = rng.random_range(0..stops.len() - 1);
    let coordinate = slowest(context, stops[piece], stops[piece + 1]).unwrap_or(0);
    let value = [before, first, last, behind][rng.random_range(0..4)][coordinate];
    Wish::One { coordinate, value, share: rng.random_range(0.3..1.0) }
}

/// The joint whose way alone is the longest.
fn slowest(context: &Context<'_>, a: &[f64], b: &[f64]) -> Option<usize> {
    let way = |&i: &usize| {
        let mut moved = a.to_vec();
        moved[i] = b[i];
        context.way(&[a, &moved])
    };
    context.limbs.joints.iter().copied().max_by(|x, y| way(x).total_cmp(&way(y)))
}

/// The knots of a chain, moved as is wished and projected again.
fn moved_knots(
    context: &Context<'_>,
    motions: &[LeafMotion],
    chain: RangeInclusive<usize>,
    (before, behind): (&[f64], &[f64]),
    rng: &mut impl Rng,
    scratch: &mut ImprovementScratch,
) -> Option<Vec<Vec<f64>>> {
    let size = context.size();
    let knots = chain.clone().map(|index| motions[index].start(size));
    let stops: Vec<&[f64]> = [before].into_iter().chain(knots).chain([behind]).collect();
    let wish = draw_wish(context, &stops, rng);
    let mut wished = |index: usize| {
        let mut q = motions[index].start(size).to_vec();
        for _ in 0..wish.rounds() {
            q = projected(context, motions, (index, None), &wish.of(&q), scratch)?;
        }
        Some(q)
    };
    let first = *chain.start();
    let mut moved: Vec<Option<Vec<f64>>> = vec![None; chain.clone().count()];
    for index in chain.clone() {
        if moved[index - first].is_some() {
            continue;
        }
        // What is let go lies on its leaf where the fingers have opened.
        if chain.contains(&(index + 1)) && opens(context, motions, index) {
            moved[index + 1 - first] = Some(wished(index + 1)?);
        }
        let known = |knot: usize| moved.get(knot.checked_sub(first)?).cloned().flatten();
        // A motion that stands still begins and ends at one configuration.
        let still = || known(index - 1).filter(|_| is_still(&motions[index - 1]));
        moved[index - first] = match across_fingers(context, motions, index, known).or_else(still) {
            Some(known) => Some(known),
            None => Some(wished(index)?),
        };
    }
    moved.into_iter().collect()
}

/// Whether a motion opens a hand that lets go of something.
fn opens(context: &Context<'_>, motions: &[LeafMotion], index: usize) -> bool {
    let grasps = |motion: &LeafMotion| context.model.graph.state(motion.state).grasps.len();
    let lets_go = |behind: &LeafMotion| grasps(behind) < grasps(&motions[index]);
    moves_fingers(&motions[index]) && motions.get(index + 1).is_some_and(lets_go)
}
