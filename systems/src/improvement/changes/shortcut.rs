//! Shortcuts: the straight motion between two points of one motion, in place of what lies between them (Geraerts and Overmars,
//! "Creating high-quality paths for motion planning", IJRR 2007).

use crate::improvement::changes::context::{Context, ImprovementScratch};
use crate::improvement::leaf_motion::LeafMotion;
use crate::step::{steering, validation};
use rand::{Rng, RngExt};

/// A point of a motion: the piece, and how far along it, in [0, 1).
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct At {
    piece: usize,
    t: f64,
}

/// Tries one shortcut of a motion. `None` where the motion has no corner, the shortcut is no shorter, or it is not free.
pub(crate) fn attempt(
    context: &Context<'_>,
    motion: &LeafMotion,
    rng: &mut impl Rng,
    scratch: &mut ImprovementScratch,
) -> Option<LeafMotion> {
    let size = context.size();
    let knots: Vec<&[f64]> = motion.knots.chunks_exact(size).collect();
    if knots.len() < 3 {
        return None;
    }
    let shares = [(); 2].map(|()| draw_share(rng));
    let [a, b] = places(context, motion, &knots, shares)?;
    let (q_a, q_b) = (point(context, motion, &knots, a), point(context, motion, &knots, b));
    let between: Vec<&[f64]> =
        std::iter::once(&q_a[..]).chain(knots[a.piece + 1..=b.piece].iter().copied()).chain([&q_b[..]]).collect();
    let gain = context.way(&between) - context.way(&[&q_a, &q_b]);
    // Compared so that NaN is no gain.
    let gains = gain > LEAST_GAIN;
    if !gains {
        return None;
    }
    let steered = steering::steer_whole(
        context.model,
        context.settings,
        motion.state,
        &motion.arguments,
        (&q_a, &q_b),
        &mut scratch.motion,
    )?;
    let straight: Vec<&[f64]> = steered.knots.chunks_exact(size).collect();
    let gain = context.way(&between) - context.way(&straight);
    if gain.is_nan() || gain <= LEAST_GAIN {
        return None;
    }
    validation::certify_whole(
        context.model,
        context.with_room,
        (motion.transition, motion.state),
        &motion.rigid_attachments,
        &steered.knots,
        &mut scratch.collision,
    )
    .ok()?;
    let before = &motion.knots[..(a.piece + usize::from(a.t > 0.0)) * size];
    let after = motion.knots.get((b.piece + 1) * size..).unwrap_or_default();
    let residual = motion.residual.max(steered.residual);
    Some(LeafMotion { knots: [before, &steered.knots, after].concat(), residual, ..motion.clone() })
}

/// A shortcut that gains less is not worth its corners: seconds at full speed, or metres.
pub(crate) const LEAST_GAIN: f64 = 1e-6;

/// A place on a motion as a share of its way. Both ends are drawn often: a straight line from one to the other leaves no corner.
fn draw_share(rng: &mut impl Rng) -> f64 {
    (rng.random_range(-AT_AN_END..1.0 + AT_AN_END)).clamp(0.0, 1.0)
}

/// How often an end is drawn, relative to all that is between both.
const AT_AN_END: f64 = 0.15;

/// Two points of a motion at shares of its way, the first before the second. `None` where no knot is between them.
fn places(context: &Context<'_>, motion: &LeafMotion, knots: &[&[f64]], shares: [f64; 2]) -> Option<[At; 2]> {
    let lengths: Vec<f64> = knots.windows(2).map(|pair| context.way(pair)).collect();
    let whole: f64 = lengths.iter().sum();
    let mut places = shares.map(|share| place(&lengths, share * whole));
    if places[1] < places[0] {
        places.swap(0, 1);
    }
    if motion.is_implicit {
        // Between knots of implicit rows a configuration is on the leaf only to within the path tolerance.
        places.iter_mut().for_each(|at| at.t = 0.0);
    }
    let [a, b] = places;
    let knots_between = b.piece - a.piece;
    (knots_between > 1 || (knots_between == 1 && b.t > 0.0)).then_some([a, b])
}

fn place(lengths: &[f64], mut way: f64) -> At {
    for (piece, length) in lengths.iter().enumerate() {
        if way < *length {
            return At { piece, t: way / length };
        }
        way -= length;
    }
    At { piece: lengths.len(), t: 0.0 }
}

/// The configuration at a point.
fn point(context: &Context<'_>, motion: &LeafMotion, knots: &[&[f64]], at: At) -> Vec<f64> {
    let mut q = knots[at.piece].to_vec();
    if at.t > 0.0 {
        context.model.problem.robot.space.interpolate(knots[at.piece], knots[at.piece + 1], at.t, &mut q);
        context.carry(&motion.rigid_attachments, &mut q);
    }
    q
}
