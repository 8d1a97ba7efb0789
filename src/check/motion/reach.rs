//! How far things can move: travel of every joint, and upper bounds of distances that hold all along a segment.
//!
//! Reaches are plain sums of lengths along the attachment tree: nothing on a body is farther from an axis than the
//! offsets between them added up. Loose, and hard to get wrong.

use crate::check::motion::segment::{SegmentMotion, Via, half_angle};
use crate::check::world::models::Value;
use foliate_components::Pose;
use foliate_components::robot::JointType;

/// What a joint does along a segment at most.
#[derive(Clone, Debug, Default)]
pub(crate) struct Travel {
    /// Radians, summed up from the first knot to each knot; from knot to knot as if it were always at its fastest.
    pub turn: Vec<f64>,
    /// Metres, likewise.
    pub shift: Vec<f64>,
    /// From each knot to the next, the largest second derivative by the fraction of the way; none where all are zero.
    bends: Option<Vec<Step>>,
}

/// A turn and a shift, or derivatives of them: radians and metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Step {
    turn: f64,
    shift: f64,
}

/// Travel of all joints, and lengths of all edges of the attachment tree.
pub(crate) struct Reach {
    /// By joint; none where it stands still.
    pub travel: Vec<Option<Travel>>,
    /// By body: from the parent's origin to the axis, and from there to the body's origin. Metres.
    lengths: Vec<(f64, f64)>,
    /// By body: the joint of its edge, if any.
    joints: Vec<Option<usize>>,
    parents: Vec<Option<usize>>,
}

/// A joint between two bodies, and how far from its axis the farthest point on the way to the end is at most.
pub(crate) struct Lever {
    pub joint: usize,
    pub reach: f64,
}

/// A solid on a body (none for the world): at most how far it is from the body's origin and, where a joint turns the body, from that
/// joint's axis. Metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub body: Option<usize>,
    pub reach: f64,
    pub about: f64,
}

impl Reach {
    pub(crate) fn new(motion: &SegmentMotion<'_>) -> Self {
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

    /// Moving joints between two solids (for the world, anywhere), each with its lever to the solid on its own side.
    pub(crate) fn levers(&self, a: End, b: End) -> Vec<Lever> {
        let chains = self.between(a.body, b.body);
        let mut levers = Vec::new();
        for (chain, end) in chains.iter().zip([a, b]) {
            let mut reach = end.reach;
            for &body in chain {
                let (before, after) = self.lengths[body];
                reach += after;
                if let Some(joint) = self.joints[body].filter(|&j| self.travel[j].is_some()) {
                    levers.push(Lever { joint, reach: reach.min(about(end, joint)) });
                }
                reach += before;
            }
        }
        levers
    }

    /// As [`Self::movement`] of [`Self::levers`], or less: two solids approach each other by no more than both move, seen from any body
    /// between them. Of all these bodies the one counts from which they move least on the whole way.
    pub(crate) fn least_movement(&self, a: End, b: End, knots: usize) -> Vec<f64> {
        let total = |movement: &Vec<f64>| movement.last().copied().unwrap_or(0.0);
        let from = |body: Option<usize>| {
            let levers: Vec<Lever> = self.outwards(body, a).into_iter().chain(self.outwards(body, b)).collect();
            self.movement(&levers, knots)
        };
        let bodies = self.between(a.body, b.body).concat();
        let common = self.movement(&self.levers(a, b), knots);
        let others = bodies.into_iter().map(|body| from(Some(body)));
        others.fold(common, |least, other| if total(&other) < total(&least) { other } else { least })
    }

    /// Moving joints from one frame outwards to a point that is within a distance of its body's origin (or of the
    /// world's), each with the longest that the point can be from its axis.
    fn outwards(&self, from: Option<usize>, point: End) -> Vec<Lever> {
        let [near, far] = self.between(from, point.body);
        let mut reach = point.reach;
        let mut levers = Vec::new();
        let moving = |body: usize| self.joints[body].filter(|&j| self.travel[j].is_some());
        // From the point back to where the way turns down, and on to the frame.
        for &body in &far {
            let (before, after) = self.lengths[body];
            levers.extend(moving(body).map(|joint| Lever { joint, reach: (reach + after).min(about(point, joint)) }));
            reach += after + before;
        }
        for &body in near.iter().rev() {
            let (before, after) = self.lengths[body];
            levers.extend(moving(body).map(|joint| Lever { joint, reach: reach + before }));
            reach += before + after;
        }
        levers.reverse();
        levers
    }

    /// How fast and how bent the way of a point is, read from a frame: see [`Bends`].
    pub(crate) fn bends(&self, from: Option<usize>, (body, reach): (Option<usize>, f64), knots: usize) -> Bends {
        let mut bends = Bends::still(knots);
        for lever in self.outwards(from, End { body, reach, about: f64::INFINITY }) {
            let Some(travel) = &self.travel[lever.joint] else { continue };
            for knot in 0..bends.turn.len() {
                let turn = travel.turn[knot + 1] - travel.turn[knot];
                let shift = travel.shift[knot + 1] - travel.shift[knot];
                bends.add(knot, Step { turn, shift }, travel.bend(knot), lever.reach);
            }
        }
        bends
    }

    /// How far two solids have moved against each other at most, from the first knot to each knot. Metres.
    pub(crate) fn movement(&self, levers: &[Lever], knots: usize) -> Vec<f64> {
        let mut movement = vec![0.0; knots];
        for lever in levers {
            let Some(travel) = &self.travel[lever.joint] else { continue };
            for (sum, (turn, shift)) in movement.iter_mut().zip(travel.turn.iter().zip(&travel.shift)) {
                *sum += turn * lever.reach + shift;
            }
        }
        movement
    }
}

/// Bounds on how a point moves against a frame from each knot to the next, derivatives by the fraction of the way: with the joints
/// between them read outwards, ‖p″‖ ≤ Σᵢⱼ|qᵢ′||qⱼ′|cᵢⱼ + Σⱼ|qⱼ″|cⱼ, where cᵢⱼ is, for i inside j or the same, the distance of the
/// point from axis j if both turn, 1 if only i turns, 0 if i shifts, and cⱼ that distance if j turns, 1 if it shifts.
#[derive(Clone, Debug)]
pub(crate) struct Bends {
    /// ‖p′‖, metres.
    pub speed: Vec<f64>,
    /// ‖p″‖, metres.
    pub point: Vec<f64>,
    /// Sum of the turns, radians.
    pub turn: Vec<f64>,
    /// Sum of the turns' second derivatives, radians.
    pub turn_bend: Vec<f64>,
    /// Sum of turns and shifts, radians and metres.
    pub travel: Vec<f64>,
}

impl Bends {
    /// Of what does not move.
    pub(crate) fn still(knots: usize) -> Self {
        let zeros = vec![0.0; knots.saturating_sub(1)];
        let turn_bend = zeros.clone();
        Self { speed: zeros.clone(), point: zeros.clone(), turn: zeros.clone(), turn_bend, travel: zeros }
    }

    /// A further joint, outside those that were added before.
    fn add(&mut self, knot: usize, Step { turn, shift }: Step, bend: Step, reach: f64) {
        let swing = turn * reach + shift;
        // A root's shift may be outside its turn: twice their product is never too little.
        self.point[knot] += turn * turn * reach + 2.0 * turn * shift + 2.0 * self.turn[knot] * swing;
        self.point[knot] += bend.turn * reach + bend.shift;
        self.turn_bend[knot] += bend.turn;
        self.speed[knot] += swing;
        self.turn[knot] += turn;
        self.travel[knot] += turn + shift;
    }

    /// The sum of two motions, the other times a factor; turns and travels are the larger ones.
    pub(crate) fn plus(mut self, factor: f64, other: &Self) -> Self {
        let sum = |a: &mut Vec<f64>, b: &[f64]| a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
        sum(&mut self.speed, &other.speed);
        sum(&mut self.point, &other.point);
        let most = |a: &mut Vec<f64>, b: &[f64]| a.iter_mut().zip(b).for_each(|(a, b)| *a = a.max(*b));
        most(&mut self.turn, &other.turn);
        most(&mut self.turn_bend, &other.turn_bend);
        most(&mut self.travel, &other.travel);
        self
    }
}

/// How far a solid is from the axis of a joint that turns the solid's own body; infinite for any other joint.
fn about(end: End, joint: usize) -> f64 {
    if end.body == Some(joint) { end.about } else { f64::INFINITY }
}

impl Travel {
    fn bend(&self, knot: usize) -> Step {
        self.bends.as_ref().map_or(Step::default(), |bends| bends[knot])
    }
}

fn travel(motion: &SegmentMotion<'_>, joint: usize) -> Option<Travel> {
    let body = &motion.world.bodies[joint];
    if body.value == Value::Still {
        return None;
    }
    let mut travel = Travel { turn: vec![0.0], shift: vec![0.0], bends: motion.timed.map(|_| Vec::new()) };
    let (mut turned, mut shifted) = (0.0, 0.0);
    for knot in 0..motion.last() {
        let (step, bend) = step(motion, joint, knot);
        turned += step.turn;
        shifted += step.shift;
        travel.turn.push(turned);
        travel.shift.push(shifted);
        if let Some(bends) = &mut travel.bends {
            bends.push(bend);
        }
    }
    let still = turned == 0.0 && shifted == 0.0;
    (!still).then_some(travel)
}

/// How far a joint turns and shifts from a knot to the next if it is always at its fastest, and its largest second derivatives.
fn step(motion: &SegmentMotion<'_>, joint: usize, knot: usize) -> (Step, Step) {
    let body = &motion.world.bodies[joint];
    let scalar = || {
        let led = motion.world.led(joint);
        let cubic = led.column.map(|column| motion.cubic(column, knot));
        cubic.map_or((0.0, 0.0), |c| (led.factor.abs() * c.fastest(), led.factor.abs() * c.most_bent()))
    };
    let turn_of = |(turn, bend): (f64, f64)| (Step { turn, shift: 0.0 }, Step { turn: bend, shift: 0.0 });
    let with_shift = |(turn, bend): (f64, f64), columns: &[usize]| {
        let cubics = || columns.iter().map(|&column| motion.cubic(column, knot));
        let norm = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>().sqrt();
        let bends = [0, 1].map(|end| norm(&mut cubics().map(|cubic| cubic.bends()[end])));
        let shift = norm(&mut cubics().map(|cubic| cubic.fastest()));
        (Step { turn, shift }, Step { turn: bend, shift: bends[0].max(bends[1]) })
    };
    match (body.motion, &body.value) {
        (JointType::Revolute { .. }, _) => turn_of(scalar()),
        (JointType::Prismatic { .. }, _) => {
            let (shift, bend) = scalar();
            (Step { turn: 0.0, shift }, Step { turn: 0.0, shift: bend })
        }
        (JointType::Planar, Value::Columns(c)) => {
            let theta = motion.cubic(c[2], knot);
            with_shift((theta.fastest(), theta.most_bent()), &c[..2])
        }
        (JointType::FreeFlyer, Value::Columns(c)) => {
            let turn = match motion.timed {
                Some(_) => motion.turning(c, knot).spin(),
                None => (2.0 * half_angle(motion.quaternion(c, knot), motion.quaternion(c, knot + 1)), 0.0),
            };
            with_shift(turn, &c[..3])
        }
        (JointType::Planar | JointType::FreeFlyer, _) => (Step::default(), Step::default()),
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
    let offset = |columns: &[usize]| {
        // From knot to knot a straight line, farthest at an end, or a curve in the box of its coordinates' ranges.
        let of_range = |knot: usize| {
            let farthest = |(low, high): (f64, f64)| low.abs().max(high.abs());
            columns.iter().map(|&c| farthest(motion.cubic(c, knot).range()).powi(2)).sum::<f64>().sqrt()
        };
        let length = |row: &Vec<f64>| columns.iter().map(|&c| row[c] * row[c]).sum::<f64>().sqrt();
        match motion.timed {
            Some(_) => (0..motion.last().max(1)).map(of_range).fold(0.0, f64::max),
            None => motion.knots.iter().map(length).fold(0.0, f64::max),
        }
    };
    match (body.motion, &body.value) {
        (JointType::Revolute { .. }, _) => 0.0,
        (JointType::Prismatic { .. }, _) => motion.farthest_from(joint, 0.0).fold(0.0, f64::max),
        (JointType::Planar, Value::Columns(c)) => offset(&c[..2]),
        (JointType::FreeFlyer, Value::Columns(c)) => offset(&c[..3]),
        (JointType::Planar | JointType::FreeFlyer, _) => 0.0,
    }
}
