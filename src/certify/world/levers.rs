//! How far two bodies can move against each other: how far joints move along a curve, times how far from their axes things are.
//!
//! Reaches are plain sums of lengths along the tree of who carries whom: loose, and hard to get wrong. If each joint j between two
//! bodies turns by at most tⱼ and shifts by at most sⱼ, no two points of theirs come closer by more than Σ tⱼ rⱼ + sⱼ.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::certify::motion::piecewise::{Curve, Motion, Segment};
use foliate_components::robot::{JointType as JointMotion, Robot, Source};
use foliate_kernels::collision::CollisionScene;
use foliate_kernels::kinematics::RigidAttachment;

/// How a joint is driven by a motion.
#[derive(Clone, Copy, Debug)]
struct Drive {
    kind: Kind,
    /// Columns of the motion that move its first three coordinates.
    columns: [Option<usize>; 3],
    /// Which of the segments' turns is its.
    turn: Option<usize>,
    /// Of a follower, from its leader.
    multiplier: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Revolute,
    Prismatic,
    Planar,
    FreeFlyer,
}

/// How far a joint turns, radians, and shifts, metres.
pub(crate) type Rate = (f64, f64);

/// Joints of a robot, and which columns of a motion drive them.
#[derive(Clone, Debug)]
pub(crate) struct Drives(Vec<Drive>);

impl Drives {
    pub(crate) fn new(robot: &Robot, motion: &Motion) -> Self {
        let turns = motion.segments.first().map_or(&[][..], |s| &s.turns);
        Self(robot.joints.iter().map(|joint| Drive::of(robot, joint, motion, turns)).collect())
    }

    /// Upper bounds of the first (or second) derivatives by u, of all joints, within [from, to] of a segment.
    pub(crate) fn rates(&self, segment: &Segment, (from, to): (f64, f64), order: u32) -> Vec<Rate> {
        let largest: Vec<f64> = segment
            .curves
            .iter()
            .map(|curve| match curve {
                Curve::Number(p) if order == 1 => p.derivative().largest(from, to),
                Curve::Number(p) => p.derivative().derivative().largest(from, to),
                Curve::Quaternion => 0.0,
            })
            .collect();
        // A chord of a curve of rotations is farther off than the acceleration says, by less than as much again while it turns less
        // than a quarter.
        let turned = |turn: usize| match &segment.turns[turn].scaled {
            Some(scaled) if order == 1 => scaled.rates(from, to).0,
            Some(scaled) => 2.0 * scaled.rates(from, to).1,
            None if order == 1 => segment.turns[turn].by.length(),
            None => 0.0,
        };
        self.0.iter().map(|drive| drive.rate(&largest, turned)).collect()
    }
}

impl Drive {
    fn of(
        robot: &Robot,
        joint: &foliate_components::robot::Joint,
        motion: &Motion,
        turns: &[crate::certify::motion::piecewise::Turn],
    ) -> Self {
        let kind = match joint.motion {
            JointMotion::Revolute { .. } => Kind::Revolute,
            JointMotion::Prismatic { .. } => Kind::Prismatic,
            JointMotion::Planar => Kind::Planar,
            JointMotion::FreeFlyer => Kind::FreeFlyer,
        };
        let (q, multiplier) = match joint.source {
            Source::Coordinates { q, .. } => (Some(q), 1.0),
            Source::Follows { leader, multiplier, .. } => match robot.joints[leader.at()].source {
                Source::Coordinates { q, .. } => (Some(q), multiplier),
                Source::Follows { .. } => (None, 0.0),
            },
        };
        let count = joint.motion.configuration_size().min(3);
        let column = |i: usize| {
            let wanted = q.filter(|_| i < count)? + i;
            motion.coordinates.iter().position(|&c| c == wanted)
        };
        let turn = match kind {
            Kind::FreeFlyer => turns.iter().position(|t| Some(t.q) == q.map(|q| q + 3)),
            Kind::Revolute | Kind::Prismatic | Kind::Planar => None,
        };
        Self { kind, columns: [column(0), column(1), column(2)], turn, multiplier: multiplier.abs() }
    }

    fn rate(&self, largest: &[f64], turned: impl Fn(usize) -> f64) -> Rate {
        let [x, y, z] = self.columns.map(|c| c.map_or(0.0, |c| largest[c]) * self.multiplier);
        match self.kind {
            Kind::Revolute => (x, 0.0),
            Kind::Prismatic => (0.0, x),
            Kind::Planar => (z, x.hypot(y)),
            Kind::FreeFlyer => (self.turn.map_or(0.0, turned), x.hypot(y).hypot(z)),
        }
    }
}

/// For each cluster of shapes the joints between it and the world, the nearest first, each with the longest that a point of the
/// cluster can be from its axis, metres.
#[derive(Clone, Debug)]
pub(crate) struct Levers {
    chains: Vec<Vec<(usize, f64)>>,
    /// By group of pairs: its clusters, each with how many of its joints are between the two.
    apart: Vec<[(usize, usize); 2]>,
}

/// Sums of what the first so many joints of each cluster can move it by.
pub(crate) struct Moved(Vec<Vec<f64>>);

impl Levers {
    /// `slides` are, by joint, the farthest that its translation is from zero.
    pub(crate) fn new(
        robot: &Robot,
        scene: &CollisionScene,
        rigid_attachments: &[RigidAttachment],
        slides: &[f64],
    ) -> Self {
        let chain = |cluster: &foliate_kernels::collision::scene::Cluster| {
            let Some(mut body) = cluster.body else { return Vec::new() };
            let ball = |&i: &u32| {
                let ball = &scene.solids()[i as usize].ball;
                ball.center.length() + ball.radius
            };
            let mut reach = cluster.solids.iter().map(ball).fold(0.0, f64::max);
            let mut chain = Vec::new();
            // Attachments that form a circle end after as many steps as there are bodies.
            for _ in 0..=robot.joints.len() {
                let next = match rigid_attachments.iter().rev().find(|c| c.object == body) {
                    Some(rigid_attachment) => {
                        reach += rigid_attachment.X_CO.translation.length();
                        rigid_attachment.carrier
                    }
                    None => {
                        let joint = &robot.joints[body.at()];
                        chain.push((body.at(), reach));
                        reach += joint.parent_from_joint.translation.length() + slides[body.at()];
                        joint.parent
                    }
                };
                match next {
                    Some(parent) => body = parent,
                    None => break,
                }
            }
            chain
        };
        let chains: Vec<Vec<(usize, f64)>> = scene.clusters().iter().map(chain).collect();
        let apart = scene.groups().iter().map(|g| apart(&chains, g.first as usize, g.second as usize)).collect();
        Self { chains, apart }
    }

    /// What joints that move so far can do.
    pub(crate) fn moved(&self, rates: &[Rate]) -> Moved {
        let sums = |chain: &Vec<(usize, f64)>| {
            let mut sum = 0.0;
            let add = |&(joint, reach): &(usize, f64)| {
                let (turn, shift) = rates[joint];
                sum += turn * reach + shift;
                sum
            };
            std::iter::once(0.0).chain(chain.iter().map(add)).collect()
        };
        Moved(self.chains.iter().map(sums).collect())
    }

    /// How far two clusters move against each other at most, metres.
    pub(crate) fn between(&self, moved: &Moved, a: u32, b: u32) -> f64 {
        apart(&self.chains, a as usize, b as usize).into_iter().map(|(cluster, joints)| moved.0[cluster][joints]).sum()
    }

    /// The most that any two clusters with pairs between them move against each other, metres.
    pub(crate) fn most(&self, moved: &Moved) -> f64 {
        let of = |ends: &[(usize, usize); 2]| ends.iter().map(|&(cluster, joints)| moved.0[cluster][joints]).sum();
        self.apart.iter().map(of).fold(0.0, f64::max)
    }
}

/// How many joints of each of two clusters are between the two.
fn apart(chains: &[Vec<(usize, f64)>], a: usize, b: usize) -> [(usize, usize); 2] {
    let (one, other) = (&chains[a], &chains[b]);
    let common = one.iter().rev().zip(other.iter().rev()).take_while(|(x, y)| x.0 == y.0).count();
    [(a, one.len() - common), (b, other.len() - common)]
}

/// The farthest that each joint's translation is from zero along a motion, metres.
pub(crate) fn slides(robot: &Robot, motion: &Motion, base: &[f64]) -> Vec<f64> {
    let mut farthest: Vec<f64> = base.iter().map(|x| x.abs()).collect();
    for segment in &motion.segments {
        for (&index, curve) in motion.coordinates.iter().zip(&segment.curves) {
            if let Curve::Number(p) = curve {
                farthest[index] = farthest[index].max(p.largest(0.0, 1.0));
            }
        }
    }
    let norm = |q: usize, n: usize| farthest[q..q + n].iter().map(|x| x * x).sum::<f64>().sqrt();
    let of = |joint: &foliate_components::robot::Joint| match (joint.motion, joint.source) {
        (JointMotion::Revolute { .. }, _) => 0.0,
        (JointMotion::Prismatic { .. }, Source::Coordinates { q, .. }) => farthest[q],
        (JointMotion::Prismatic { .. }, Source::Follows { leader, multiplier, offset }) => {
            match robot.joints[leader.at()].source {
                Source::Coordinates { q, .. } => multiplier.abs() * farthest[q] + offset.abs(),
                Source::Follows { .. } => offset.abs(),
            }
        }
        (JointMotion::Planar, Source::Coordinates { q, .. }) => norm(q, 2),
        (JointMotion::FreeFlyer, Source::Coordinates { q, .. }) => norm(q, 3),
        (JointMotion::Planar | JointMotion::FreeFlyer, Source::Follows { .. }) => 0.0,
    };
    robot.joints.iter().map(of).collect()
}
