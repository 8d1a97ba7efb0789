//! Moves the waypoints of a grasp or release, such as pregrasp, grasp and the knot where the object is lifted: they are drawn towards
//! the motions before and behind and projected again, so that redundant joints, a mobile base or another branch of inverse kinematics
//! make these motions shorter. The leaf stays, so that nothing else has to change.

use crate::improvement::changes::context::{Context, ImprovementScratch};
use crate::improvement::changes::local_change::Changed;
use crate::improvement::changes::shortcut::LEAST_GAIN;
use crate::improvement::cost::path_cost;
use crate::improvement::leaf_motion::{LeafMotion, legs_ending_at};
use crate::planning_model::state_classification::{parameters_of, residual};
use crate::step::{steering, validation};
use foliate_components::Pose;
use foliate_components::candidate::LegParameter;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::robot::configuration::Group;
use foliate_kernels::constrained_motion::{Settings, project};
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
    let is_free = |motion: &LeafMotion| {
        let (along, attachments) = ((motion.transition, motion.state), &motion.rigid_attachments);
        let (model, settings) = (context.model, context.settings);
        validation::certify_whole(model, settings, along, attachments, &motion.knots, &mut scratch.collision).is_ok()
    };
    changed.iter().all(is_free).then_some(Changed { range: first - 1..last + 1, motions: whole })
}

/// The joint knots of one grasp change, by the number of the motion that begins there: the knot where the leaf changes, and those to
/// either side up to a waypoint.
fn draw_chain(motions: &[LeafMotion], rng: &mut impl Rng) -> Option<RangeInclusive<usize>> {
    let changes_leaf = |index: usize| !motions[index - 1].is_on_leaf_of(&motions[index]);
    let changes: Vec<usize> = (1..motions.len()).filter(|&index| changes_leaf(index)).collect();
    let at = *changes.get(rng.random_range(0..changes.len().max(1)))?;
    let (mut first, mut last) = (at, at);
    while first > 1 && changes_leaf(first) && (motions[first - 1].starts_at_waypoint || is_still(&motions[first - 1])) {
        first -= 1;
    }
    while last + 1 < motions.len()
        && changes_leaf(last)
        && (motions[last + 1].starts_at_waypoint || is_still(&motions[last]))
    {
        last += 1;
    }
    Some(first..=last)
}

/// Whether a motion stands still.
fn is_still(motion: &LeafMotion) -> bool {
    let half = motion.knots.len() / 2;
    motion.knots[..half] == motion.knots[half..]
}

/// How many knots away from a waypoint a motion is left: often one.
fn draw_steps(motion: &LeafMotion, size: usize, rng: &mut impl Rng) -> usize {
    let knots = motion.knots.len() / size;
    if rng.random_bool(0.5) { 1 } else { rng.random_range(1..knots.max(2)) }
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
    let mut moved: Vec<Vec<f64>> = Vec::new();
    for index in chain {
        // A motion that stands still begins and ends at one configuration.
        if let Some(known) = moved.last().filter(|_| is_still(&motions[index - 1])) {
            moved.push(known.clone());
            continue;
        }
        let mut q = motions[index].start(size).to_vec();
        for _ in 0..wish.rounds() {
            q = projected(context, motions, index, &wish.of(&q), scratch)?;
        }
        moved.push(q);
    }
    Some(moved)
}

/// Quaternions are not moved: numbers of theirs cannot be added.
fn keep_rotations(context: &Context<'_>, by: &mut [f64]) {
    let factors = &context.model.problem.robot.space.factors;
    factors
        .iter()
        .filter(|factor| factor.group == Group::FreeFlyer)
        .for_each(|factor| by[factor.q + 3..factor.q + 7].fill(0.0));
}

/// A configuration near `target` at which motion `index` may begin and the one before may end: on both leaves, and with the constraints
/// of the waypoint that was there.
fn projected(
    context: &Context<'_>,
    motions: &[LeafMotion],
    index: usize,
    target: &[f64],
    scratch: &mut ImprovementScratch,
) -> Option<Vec<f64>> {
    let sides = [&motions[index], &motions[index - 1]];
    let was = motions[index].start(context.size());
    let legs = legs_ending_at(context.model, was, sides.map(|side| side.transition));
    for side in sides {
        for &(transition, leg) in &legs {
            let record = &context.model.graph.transition(transition).legs[leg];
            if record.state != side.state || !record.drawn.is_empty() {
                continue;
            }
            let Ok(program) = context.model.leg_program(transition, leg) else { continue };
            let fresh: Vec<_> = side.parameters.iter().map(|p| LegParameter::Fresh(*p)).collect();
            let arguments = program.arguments(context.model, &LeafIndex::default(), side.state, &fresh, None);
            let (tolerance, iterations) =
                (context.settings.projection_tolerance, context.settings.projection_iterations);
            let settings = Settings { tolerance, iterations, level: context.settings.level, ..Settings::default() };
            let mut q = target.to_vec();
            let outcome = project(&program.program, &mut q, &arguments, &settings, &mut scratch.solve);
            if outcome.is_converged() && sides.iter().all(|side| is_on_leaf(context, side, &q)) {
                // Objects are where the motion that begins here has them.
                context.carry(&motions[index].rigid_attachments, &mut q);
                return Some(q);
            }
        }
    }
    None
}

/// Whether a configuration lies on the leaf of a motion.
fn is_on_leaf(context: &Context<'_>, motion: &LeafMotion, q: &[f64]) -> bool {
    let model = context.model;
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    model.kinematics.forward(q, &mut X_WJ);
    let tolerance = 2.0 * context.settings.projection_tolerance;
    let holds = |constraint: &_| residual(model, *constraint, q, &X_WJ) <= tolerance;
    model.graph.state(motion.state).manifold.iter().all(holds)
        && motion.has_parameters(&parameters_of(model, motion.state, q, &X_WJ))
}
