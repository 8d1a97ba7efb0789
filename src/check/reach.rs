//! How far things can move: travel of every joint, and upper bounds of distances that hold all along a segment.
//!
//! Reaches are plain sums of lengths along the attachment tree: nothing on a body is farther from an axis than the
//! offsets between them added up. Loose, and hard to get wrong.

use super::models::Value;
use super::motion::{At, SegmentMotion, Via, half_angle};
use foliate_components::Pose;
use foliate_components::robot::Motion;

/// What a joint does along a segment, summed up from the first knot to each knot.
#[derive(Clone, Debug, Default)]
pub(super) struct Travel {
    /// Radians.
    pub turn: Vec<f64>,
    /// Metres.
    pub shift: Vec<f64>,
}

/// Travel of all joints, and lengths of all edges of the attachment tree.
pub(super) struct Reach {
    /// By joint; none where it stands still.
    pub travel: Vec<Option<Travel>>,
    /// By body: from the parent's origin to the axis, and from there to the body's origin. Metres.
    lengths: Vec<(f64, f64)>,
    /// By body: the joint of its edge, if any.
    joints: Vec<Option<usize>>,
    parents: Vec<Option<usize>>,
}

/// A joint between two bodies, and how far from its axis the farthest point on the way to the end is at most.
pub(super) struct Lever {
    pub joint: usize,
    pub reach: f64,
}

impl Reach {
    pub(super) fn new(motion: &SegmentMotion<'_>) -> Self {
        let bodies = 0..motion.world.bodies.len();
        let joint = |via: Via| match via {
            Via::Rigid(_) => None,
            Via::Joint(j) | Via::Back(j) => Some(j),
        };
        Self {
            travel: bodies.clone().map(|j| travel(motion, j)).collect(),
            lengths: bodies.map(|b| edge_lengths(motion, motion.edges[b].via)).collect(),
            joints: motion.edges.iter().map(|e| joint(e.via)).collect(),
            parents: motion.edges.iter().map(|e| e.parent).collect(),
        }
    }

    fn up(&self, body: Option<usize>) -> Vec<usize> {
        let mut chain = Vec::new();
        let mut next = body;
        while let Some(body) = next {
            chain.push(body);
            next = self.parents[body];
        }
        chain
    }

    /// Bodies from each end up to, and without, the lowest that carries both.
    fn between(&self, a: Option<usize>, b: Option<usize>) -> [Vec<usize>; 2] {
        let (mut a, mut b) = (self.up(a), self.up(b));
        while let (Some(x), Some(y)) = (a.last(), b.last()) {
            if x != y {
                break;
            }
            a.pop();
            b.pop();
        }
        [a, b]
    }

    /// Moving joints between two solids that lie within the given distances of their bodies' origins (for the world,
    /// anywhere), each with its lever to the solid on its own side.
    pub(super) fn levers(&self, a: (Option<usize>, f64), b: (Option<usize>, f64)) -> Vec<Lever> {
        let chains = self.between(a.0, b.0);
        let mut levers = Vec::new();
        for (chain, reach) in chains.iter().zip([a.1, b.1]) {
            let mut reach = reach;
            for &body in chain {
                let (before, after) = self.lengths[body];
                reach += after;
                if let Some(joint) = self.joints[body].filter(|&j| self.travel[j].is_some()) {
                    levers.push(Lever { joint, reach });
                }
                reach += before;
            }
        }
        levers
    }

    /// Joints between two frames, and the length of the whole way between their origins, given how far the frames are
    /// from their bodies' origins: no axis is farther from either frame.
    pub(super) fn way(&self, a: (Option<usize>, f64), b: (Option<usize>, f64)) -> (Vec<usize>, f64) {
        let chains = self.between(a.0, b.0);
        let length: f64 = chains.iter().flatten().map(|&body| self.lengths[body].0 + self.lengths[body].1).sum();
        let joints = chains.iter().flatten().filter_map(|&body| self.joints[body]);
        (joints.filter(|&j| self.travel[j].is_some()).collect(), length + a.1 + b.1)
    }

    /// How far two solids have moved against each other at most, from the first knot to each knot. Metres.
    pub(super) fn movement(&self, levers: &[Lever], knots: usize) -> Vec<f64> {
        let mut movement = vec![0.0; knots];
        for lever in levers {
            let Some(travel) = &self.travel[lever.joint] else { continue };
            for (sum, (turn, shift)) in movement.iter_mut().zip(travel.turn.iter().zip(&travel.shift)) {
                *sum += turn * lever.reach + shift;
            }
        }
        movement
    }

    /// Sum of the travels of joints, radians and metres alike, from the first knot to each knot.
    pub(super) fn total(&self, joints: &[usize], knots: usize) -> Vec<f64> {
        let mut total = vec![0.0; knots];
        for travel in joints.iter().filter_map(|&j| self.travel[j].as_ref()) {
            for (sum, (turn, shift)) in total.iter_mut().zip(travel.turn.iter().zip(&travel.shift)) {
                *sum += turn + shift;
            }
        }
        total
    }
}

fn travel(motion: &SegmentMotion<'_>, joint: usize) -> Option<Travel> {
    let body = &motion.world.bodies[joint];
    if body.value == Value::Still {
        return None;
    }
    let mut travel = Travel { turn: vec![0.0], shift: vec![0.0] };
    let (mut turned, mut shifted) = (0.0, 0.0);
    for knot in 0..motion.last() {
        let (turn, shift) = step(motion, joint, knot);
        turned += turn;
        shifted += shift;
        travel.turn.push(turned);
        travel.shift.push(shifted);
    }
    let still = turned == 0.0 && shifted == 0.0;
    (!still).then_some(travel)
}

/// How far a joint turns and shifts from a knot to the next.
fn step(motion: &SegmentMotion<'_>, joint: usize, knot: usize) -> (f64, f64) {
    let body = &motion.world.bodies[joint];
    let (here, there) = (&motion.knots[knot], &motion.knots[knot + 1]);
    let scalar = || (motion.scalar(joint, At::knot(knot + 1)) - motion.scalar(joint, At::knot(knot))).abs();
    let shift = |columns: &[usize]| columns.iter().map(|&c| (there[c] - here[c]).powi(2)).sum::<f64>().sqrt();
    match (body.motion, &body.value) {
        (Motion::Revolute { .. }, _) => (scalar(), 0.0),
        (Motion::Prismatic { .. }, _) => (0.0, scalar()),
        (Motion::Planar, Value::Columns(c)) => ((there[c[2]] - here[c[2]]).abs(), shift(&c[..2])),
        (Motion::FreeFlyer, Value::Columns(c)) => {
            (2.0 * half_angle(motion.quaternion(c, knot), motion.quaternion(c, knot + 1)), shift(&c[..3]))
        }
        (Motion::Planar | Motion::FreeFlyer, _) => (0.0, 0.0),
    }
}

/// From the parent's origin to the axis, and from there to the body's origin.
fn edge_lengths(motion: &SegmentMotion<'_>, via: Via) -> (f64, f64) {
    let length = |pose: &Pose| pose.translation.length();
    match via {
        Via::Rigid(pose) => (length(&pose), 0.0),
        // A turn is about the body's own origin, after the shift.
        Via::Joint(joint) => (length(&motion.world.bodies[joint].parent_from_joint) + slide(motion, joint), 0.0),
        Via::Back(joint) => (0.0, length(&motion.world.bodies[joint].parent_from_joint) + slide(motion, joint)),
    }
}

/// How far a joint shifts its body's origin at most.
fn slide(motion: &SegmentMotion<'_>, joint: usize) -> f64 {
    let body = &motion.world.bodies[joint];
    let knots = 0..motion.knots.len();
    let offset = |columns: &[usize]| {
        let length = |row: &Vec<f64>| columns.iter().map(|&c| row[c] * row[c]).sum::<f64>().sqrt();
        motion.knots.iter().map(length).fold(0.0, f64::max)
    };
    match (body.motion, &body.value) {
        (Motion::Revolute { .. }, _) => 0.0,
        (Motion::Prismatic { .. }, _) => knots.map(|k| motion.scalar(joint, At::knot(k)).abs()).fold(0.0, f64::max),
        (Motion::Planar, Value::Columns(c)) => offset(&c[..2]),
        (Motion::FreeFlyer, Value::Columns(c)) => offset(&c[..3]),
        (Motion::Planar | Motion::FreeFlyer, _) => 0.0,
    }
}
