//! Shortcuts of some coordinates alone, also over several motions: the other coordinates move as before, and these go straight from
//! their values at one point of the path to those at another. So one arm moves to its next pregrasp while the other one still
//! carries (partial shortcuts: Geraerts and Overmars, IJRR 2007).

use crate::improvement::changes::changed::Changed;
use crate::improvement::changes::context::{Context, ImprovementScratch};
use crate::improvement::changes::shortcut::LEAST_GAIN;
use crate::improvement::cost::path_cost;
use crate::improvement::leaf_motion::LeafMotion;
use foliate_components::graph::StateId;
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex};
use rand::{Rng, RngExt};
use std::ops::Range;

/// Numbers of a configuration that differ by less are the same where two motions meet: metres and radians.
const SAME: f64 = 1e-9;

/// Where a shortcut begins and ends: in ways along the whole path.
struct Span {
    from: f64,
    to: f64,
    /// By motion: the way up to each of its knots.
    ways: Vec<Vec<f64>>,
    range: Range<usize>,
}

/// Tries one shortcut of one set of coordinates. `cost` is what the path costs.
pub(crate) fn attempt(
    context: &Context<'_>,
    motions: &[LeafMotion],
    cost: f64,
    rng: &mut impl Rng,
    scratch: &mut ImprovementScratch,
) -> Option<Changed> {
    let limb = draw_limb(context, rng)?;
    let span = draw_span(context, motions, rng)?;
    if !motions[span.range.clone()].iter().all(|motion| leaves_rows_alone(context, motion, &limb)) {
        return None;
    }
    let (start, end) =
        (configuration(context, motions, &span, span.from), configuration(context, motions, &span, span.to));
    let moved = |way: f64, q: &mut [f64]| {
        let share = ((way - span.from) / (span.to - span.from)).clamp(0.0, 1.0);
        limb.iter().for_each(|&i| q[i] = start[i] + share * (end[i] - start[i]));
    };
    let mut changed = Vec::with_capacity(span.range.len());
    for index in span.range.clone() {
        changed.push(change(context, &motions[index], (&span, index), &moved));
    }
    join(context, &mut changed)?;
    if !keeps_waypoints(context, motions, span.range.clone(), &changed) {
        return None;
    }
    let whole = [&motions[..span.range.start], &changed, &motions[span.range.end..]].concat();
    let gain = cost - path_cost(context.cost, context.model, &whole);
    if gain.is_nan() || gain <= LEAST_GAIN {
        return None;
    }
    changed
        .iter()
        .all(|motion| context.is_free(motion, &mut scratch.collision))
        .then_some(Changed { range: span.range, motions: changed })
}

/// Limbs and single joints are drawn equally often.
fn draw_limb(context: &Context<'_>, rng: &mut impl Rng) -> Option<Vec<usize>> {
    let (limbs, joints) = (&context.limbs.limbs, &context.limbs.joints);
    if !limbs.is_empty() && (joints.is_empty() || rng.random_bool(0.5)) {
        return Some(limbs[rng.random_range(0..limbs.len())].clone());
    }
    (!joints.is_empty()).then(|| vec![joints[rng.random_range(0..joints.len())]])
}

fn draw_span(context: &Context<'_>, motions: &[LeafMotion], rng: &mut impl Rng) -> Option<Span> {
    let size = context.size();
    let mut way = 0.0;
    let mut ways = Vec::with_capacity(motions.len());
    for motion in motions {
        let mut of_motion = vec![way];
        for pair in motion.knots.windows(2 * size).step_by(size) {
            way += context.way(&[&pair[..size], &pair[size..]]);
            of_motion.push(way);
        }
        ways.push(of_motion);
    }
    // Short spans are drawn as often as long ones, on a scale of octaves.
    let length = way * 0.5_f64.powf(rng.random_range(0.0..6.0));
    let middle = rng.random_range(0.0..=way);
    let (from, to) = ((middle - 0.5 * length).max(0.0), (middle + 0.5 * length).min(way));
    let first = ways.iter().position(|of_motion| of_motion.last().is_some_and(|last| *last > from))?;
    let last = ways.iter().rposition(|of_motion| of_motion[0] < to)?;
    let mut span = Span { from, to, ways, range: first..last + 1 };
    // Motions with implicit rows have no points but their knots.
    for (index, is_start) in [(first, true), (last, false)] {
        if motions[index].is_implicit {
            let of_motion = &span.ways[index];
            if is_start {
                span.from = of_motion.iter().copied().rfind(|way| *way <= from)?;
            } else {
                span.to = of_motion.iter().copied().find(|way| *way >= to)?;
            }
        }
    }
    (first <= last && span.to - span.from > LEAST_GAIN).then_some(span)
}

/// Whether the implicit rows of a motion do not depend on some coordinates.
fn leaves_rows_alone(context: &Context<'_>, motion: &LeafMotion, limb: &[usize]) -> bool {
    let interior = context.model.interior_program(motion.state);
    !motion.is_implicit || interior.is_ok_and(|interior| limb.iter().all(|i| interior.idle.contains(i)))
}

/// The configuration at a way along the path.
fn configuration(context: &Context<'_>, motions: &[LeafMotion], span: &Span, way: f64) -> Vec<f64> {
    let index = span.range.clone().rfind(|&index| span.ways[index][0] <= way).unwrap_or(span.range.start);
    point(context, &motions[index], &span.ways[index], way)
}

/// The configuration at a way along a motion.
fn point(context: &Context<'_>, motion: &LeafMotion, ways: &[f64], way: f64) -> Vec<f64> {
    let size = context.size();
    let piece = ways.partition_point(|w| *w <= way).saturating_sub(1);
    let knot = |index: usize| &motion.knots[index * size..(index + 1) * size];
    let mut q = knot(piece.min(ways.len() - 1)).to_vec();
    if piece + 1 < ways.len() && way > ways[piece] {
        let t = (way - ways[piece]) / (ways[piece + 1] - ways[piece]);
        context.model.problem.robot.space.interpolate(knot(piece), knot(piece + 1), t, &mut q);
        context.carry(&motion.rigid_attachments, &mut q);
    }
    q
}

/// A motion with some coordinates moved: its knots, and the ends of the span where they lie between knots.
fn change(
    context: &Context<'_>,
    motion: &LeafMotion,
    (span, index): (&Span, usize),
    moved: &impl Fn(f64, &mut [f64]),
) -> LeafMotion {
    let (size, ways) = (context.size(), &span.ways[index]);
    let mut knots = Vec::with_capacity(motion.knots.len() + 2 * size);
    let mut add = |way: f64, q: &[f64]| {
        let first = knots.len();
        knots.extend_from_slice(q);
        if way > span.from && way < span.to {
            moved(way, &mut knots[first..]);
            context.carry(&motion.rigid_attachments, &mut knots[first..]);
        }
    };
    for (number, q) in motion.knots.chunks_exact(size).enumerate() {
        add(ways[number], q);
        let Some(&next) = ways.get(number + 1) else { break };
        for end in [span.from, span.to] {
            if end > ways[number] && end < next {
                add(end, &point(context, motion, ways, end));
            }
        }
    }
    LeafMotion { knots, ..motion.clone() }
}

/// Makes consecutive motions share their joint knots bit for bit, with objects where the later one has them. `None` where
/// they are apart: an object would have to be at two places.
fn join(context: &Context<'_>, motions: &mut [LeafMotion]) -> Option<()> {
    let size = context.size();
    for index in 1..motions.len() {
        let (before, after) = motions.split_at_mut(index);
        let (before, after) = (before.last_mut()?, &mut after[0]);
        let first = before.knots.len() - size;
        let apart = before.knots[first..].iter().zip(&after.knots[..size]).any(|(a, b)| {
            // Compared so that NaN is apart.
            let is_near = (a - b).abs() <= SAME;
            !is_near
        });
        if apart {
            return None;
        }
        before.knots[first..].copy_from_slice(&after.knots[..size]);
    }
    Some(())
}

/// Whether the hands and objects of the grasps that a waypoint is about are where they were.
fn keeps_waypoints(context: &Context<'_>, old: &[LeafMotion], range: Range<usize>, new: &[LeafMotion]) -> bool {
    let size = context.size();
    let at_waypoint = |index: &usize| old[*index].starts_at_waypoint && *index > range.start;
    range.clone().filter(at_waypoint).all(|index| {
        let (was, is) = (old[index].start(size), new[index - range.start].start(size));
        if was == is {
            return true;
        }
        let bodies = taking_part(context, old, index);
        let [was, is] = [was, is].map(|q| context.model.kinematics.poses(q));
        let stays = |body: &JointIndex| {
            let (was, is) = (was[body.at()], is[body.at()]);
            was.translation.distance(is.translation) <= SAME && was.rotation.angle_between(is.rotation) <= SAME.sqrt()
        };
        !bodies.is_empty() && bodies.iter().all(stays)
    })
}

/// The bodies of hands and held objects at the grasp changes before and after a waypoint.
fn taking_part(context: &Context<'_>, motions: &[LeafMotion], waypoint: usize) -> Vec<JointIndex> {
    let model = context.model;
    let grasps = |state: StateId| &model.graph.state(state).grasps;
    let differs = |index: &usize| grasps(motions[index - 1].state) != grasps(motions[*index].state);
    let before = (1..waypoint).rev().find(differs);
    let after = (waypoint..motions.len()).skip(1).find(differs);
    let robot = &model.problem.robot;
    let bodies = |&(gripper, handle): &(GripperIndex, HandleIndex)| {
        let links = [robot.grippers[gripper.at()].link, robot.handles[handle.at()].link];
        links.into_iter().filter_map(|link| robot.links[link.at()].joint)
    };
    let changes = before.into_iter().chain(after).flat_map(|index| {
        let (had, has) = (grasps(motions[index - 1].state), grasps(motions[index].state));
        let released = had.iter().filter(|grasp| !has.contains(grasp));
        let taken = has.iter().filter(|grasp| !had.contains(grasp));
        released.chain(taken).flat_map(bodies).collect::<Vec<_>>()
    });
    changes.collect()
}
