//! The free motions of the joints between two frames: turns and slides, in order from one frame to the other.
//!
//! A planar joint or a free-flyer gives two links, a slide and a turn. A follower moves with its leader's coordinate, scaled.
//! All bounds are sums over such links.

use crate::kinematics::attachment_tree::AttachmentTree;
use crate::kinematics::joint_table::JointCoordinates;
use foliate_components::robot::{JointIndex, JointType, Robot};
use glam::DVec3;

/// How fast coordinates move over an interval of unit length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace<'a> {
    /// By velocity coordinate: at least its largest speed. Only lengths count: of a rotation any vector as long as it turns.
    pub delta: &'a [f64],
    /// By velocity coordinate: at least its largest acceleration; empty where there is none.
    pub bend: &'a [f64],
}

impl<'a> Pace<'a> {
    /// That of a straight motion.
    pub(crate) fn even(delta: &'a [f64]) -> Self {
        Self { delta, bend: &[] }
    }
}

/// One free motion of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Link {
    /// Turns about an axis through the body's origin (about any axis, where none is given).
    Turn { body: usize, axis: Option<DVec3>, v: usize, count: usize, scale: f64 },
    /// Slides.
    Slide { v: usize, count: usize, scale: f64 },
}

impl Link {
    /// How far it moves, metres or radians.
    pub(crate) fn length(&self, pace: &Pace<'_>) -> f64 {
        self.norm(pace.delta)
    }

    /// How much its speed changes, at most.
    pub(crate) fn bend(&self, pace: &Pace<'_>) -> f64 {
        if pace.bend.is_empty() { 0.0 } else { self.norm(pace.bend) }
    }

    fn norm(&self, of: &[f64]) -> f64 {
        let (Self::Turn { v, count, scale, .. } | Self::Slide { v, count, scale }) = *self;
        of[v..v + count].iter().map(|d| d * d).sum::<f64>().sqrt() * scale.abs()
    }
}

pub(crate) fn links_between(
    robot: &Robot,
    tree: &AttachmentTree,
    a: Option<JointIndex>,
    b: Option<JointIndex>,
    is_free: &[bool],
) -> Vec<Link> {
    let (up, down) = tree.between(a, b);
    let of = |joint: JointIndex| if tree.is_carried(joint) { Vec::new() } else { links_of(robot, joint, is_free) };
    // A root slides, then turns; seen from beyond it is the other way round.
    let up = up.into_iter().flat_map(|joint| of(joint).into_iter().rev().collect::<Vec<_>>());
    up.chain(down.into_iter().flat_map(of)).collect()
}

pub(crate) fn links_of(robot: &Robot, index: JointIndex, is_free: &[bool]) -> Vec<Link> {
    let joint = &robot.joints[index.at()];
    let JointCoordinates { v, multiplier: scale, .. } = JointCoordinates::of(robot, joint);
    if !is_free[v] {
        return Vec::new();
    }
    let body = index.at();
    match joint.motion {
        JointType::Revolute { axis } => vec![Link::Turn { body, axis: Some(axis), v, count: 1, scale }],
        JointType::Prismatic { .. } => vec![Link::Slide { v, count: 1, scale }],
        JointType::Planar => vec![
            Link::Slide { v, count: 2, scale },
            Link::Turn { body, axis: Some(DVec3::Z), v: v + 2, count: 1, scale },
        ],
        JointType::FreeFlyer => {
            vec![Link::Slide { v, count: 3, scale }, Link::Turn { body, axis: None, v: v + 3, count: 3, scale }]
        }
    }
}
