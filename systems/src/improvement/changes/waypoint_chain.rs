//! The waypoints of a grasp change: the knots that belong to it, and how they are projected again when something moves them.

use crate::improvement::changes::context::{Context, ImprovementScratch};
use crate::improvement::leaf_motion::{LeafMotion, legs_ending_at, moves_fingers, same_value};
use crate::planning_model::state_classification::{parameters_of, residual};
use foliate_components::candidate::LegParameter;
use foliate_components::graph::ConstraintId;
use foliate_components::graph::leaf::{LeafIndex, Parameter};
use foliate_components::robot::configuration::Group;
use foliate_kernels::constrained_motion::{Settings, project};
use rand::{Rng, RngExt};
use std::ops::RangeInclusive;

/// The joint knots of one grasp change, drawn among all.
pub(crate) fn draw_chain(motions: &[LeafMotion], rng: &mut impl Rng) -> Option<RangeInclusive<usize>> {
    let changes: Vec<usize> = (1..motions.len()).filter(|&index| changes_leaf(motions, index)).collect();
    let at = *changes.get(rng.random_range(0..changes.len().max(1)))?;
    Some(chain_around(motions, at))
}

fn changes_leaf(motions: &[LeafMotion], index: usize) -> bool {
    !motions[index - 1].is_on_leaf_of(&motions[index])
}

/// The joint knots of the grasp change at a motion's start, by the number of the motion that begins there: the knot where the leaf
/// changes, and those to either side up to a waypoint.
pub(crate) fn chain_around(motions: &[LeafMotion], at: usize) -> RangeInclusive<usize> {
    let (mut first, mut last) = (at, at);
    while first > 1
        && changes_leaf(motions, first)
        && (motions[first - 1].starts_at_waypoint
            || is_still(&motions[first - 1])
            || moves_fingers(&motions[first - 1]))
    {
        first -= 1;
    }
    while last + 1 < motions.len()
        && changes_leaf(motions, last)
        && (motions[last + 1].starts_at_waypoint || is_still(&motions[last]) || moves_fingers(&motions[last]))
    {
        last += 1;
    }
    first..=last
}

/// Whether a motion leads from a waypoint to another one of the same grasp change.
pub(crate) fn is_inside_chain(motions: &[LeafMotion], index: usize) -> bool {
    let ends = [index, index + 1];
    let chains = ends.iter().filter(|at| (1..motions.len()).contains(at)).map(|&at| chain_around(motions, at));
    chains.into_iter().any(|chain| ends.iter().all(|at| chain.contains(at)))
}

/// Whether a motion stands still.
pub(crate) fn is_still(motion: &LeafMotion) -> bool {
    let half = motion.knots.len() / 2;
    motion.knots[..half] == motion.knots[half..]
}

/// Where a motion begins whose other end, or whose predecessor's, has `moved`, where only fingers move between the two.
pub(crate) fn across_fingers(
    context: &Context<'_>,
    motions: &[LeafMotion],
    index: usize,
    moved: impl Fn(usize) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let fingers_of = |motion: &LeafMotion| moves_fingers(motion).then(|| context.model.moving_fingers(motion.fingers));
    let before = index.checked_sub(1).and_then(|before| Some((moved(before)?, fingers_of(&motions[before])?)));
    let behind = || Some((moved(index + 1)?, fingers_of(motions.get(index)?)?));
    let (mut q, fingers) = before.or_else(behind)?;
    let own = motions[index].start(context.size());
    fingers.for_each(|i| q[i] = own[i]);
    Some(q)
}

/// How many knots away from a waypoint a motion is left: often one.
pub(crate) fn draw_steps(motion: &LeafMotion, size: usize, rng: &mut impl Rng) -> usize {
    let knots = motion.knots.len() / size;
    if rng.random_bool(0.5) { 1 } else { rng.random_range(1..knots.max(2)) }
}

/// Quaternions are not moved: numbers of theirs cannot be added.
pub(crate) fn keep_rotations(context: &Context<'_>, by: &mut [f64]) {
    let factors = &context.model.problem.robot.space.factors;
    factors
        .iter()
        .filter(|factor| factor.group == Group::FreeFlyer)
        .for_each(|factor| by[factor.q + 3..factor.q + 7].fill(0.0));
}

/// A configuration near `target` at which motion `index` may begin and the one before may end: on both leaves, and with the constraints
/// of the waypoint that was there. Where the motion may begin on any leaf of a constraint, it is `free`: the value is what comes of it.
pub(crate) fn projected(
    context: &Context<'_>,
    motions: &[LeafMotion],
    (index, free): (usize, Option<ConstraintId>),
    target: &[f64],
    scratch: &mut ImprovementScratch,
) -> Option<Vec<f64>> {
    let sides = [&motions[index], &motions[index - 1]];
    let was = motions[index].start(context.size());
    let legs = legs_ending_at(context.model, was, sides.map(|side| side.transition));
    let is_bound = |side: &&&LeafMotion| side.parameters.iter().all(|p| Some(p.constraint) != free);
    for side in sides.iter().filter(is_bound) {
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
            // A projection looks at the coordinates alone that its rows depend on.
            context.model.problem.robot.space.clamp(&mut q);
            let outcome = project(&program.program, &mut q, &arguments, &settings, &mut scratch.solve);
            if outcome.is_converged() && sides.iter().all(|side| is_on_leaf(context, side, free, &q)) {
                // Objects are where the motion that begins here has them.
                if free.is_none() {
                    context.carry(&motions[index].rigid_attachments, &mut q);
                }
                return Some(q);
            }
        }
    }
    None
}

/// Whether a configuration lies on the leaf of a motion, whatever the value of a `free` constraint.
pub(crate) fn is_on_leaf(context: &Context<'_>, motion: &LeafMotion, free: Option<ConstraintId>, q: &[f64]) -> bool {
    let model = context.model;
    let X_WJ = model.kinematics.poses(q);
    let tolerance = 2.0 * context.settings.projection_tolerance;
    let holds = |constraint: &_| residual(model, *constraint, q, &X_WJ) <= tolerance;
    let is_kept = |(was, is): (&Parameter, &Parameter)| Some(was.constraint) == free || same_value(was, is);
    model.graph.state(motion.state).manifold.iter().all(holds)
        && motion.parameters.iter().zip(&parameters_of(model, motion.state, q, &X_WJ)).all(is_kept)
}
