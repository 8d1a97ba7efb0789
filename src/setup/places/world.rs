//! A whole scene for collision tests while it is being made.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::collision_matrix::touch;
use crate::setup::grippers::{coordinate, is_beyond, leader};
use foliate_components::Pose;
use foliate_components::pose::pose_to_array;
use foliate_components::robot::{DisabledPair, JointIndex, LinkIndex, PartIndex, Robot, Source};
use foliate_kernels::collision::{CollisionScene, DistanceQuery, Pair, PairId, PairRule, pair_clearance};
use foliate_kernels::kinematics::Kinematics;
use glam::DVec3;

/// Where objects wait that have no place yet, metres above everything.
const AWAY: f64 = 1e3;
/// The part of the table.
const TABLE: usize = 1;

/// Two solids that collide, or come too near.
pub(crate) struct Meeting {
    pub bodies: [Option<JointIndex>; 2],
    pub links: [LinkIndex; 2],
}

/// Robot, table and objects: the first part, the second, the others.
pub(crate) struct World {
    pub robot: Robot,
    pub kinematics: Kinematics,
    scene: CollisionScene,
}

impl World {
    pub(crate) fn new(robot: Robot, ignored: &[DisabledPair]) -> Self {
        let scene = CollisionScene::new(&robot, &PairRule { ignored, ..PairRule::default() });
        Self { kinematics: Kinematics::new(&robot), scene, robot }
    }

    /// A configuration with the robot's joints at zero or the nearest bound, and all objects away.
    pub(crate) fn default_configuration(&self) -> Vec<f64> {
        let mut q = self.robot.space.neutral();
        self.robot.space.clamp(&mut q);
        for part in 0..self.robot.parts.len() {
            if self.root(part).is_some() {
                let apart = DVec3::new(10.0 * part as f64, 0.0, AWAY);
                self.put(&mut q, part, &Pose::from_translation(apart));
            }
        }
        q
    }

    /// The body of an object's root.
    fn root(&self, part: usize) -> Option<JointIndex> {
        self.robot.parts[part].root_joint
    }

    /// Puts an object somewhere.
    pub(crate) fn put(&self, q: &mut [f64], part: usize, X_WO: &Pose) {
        let Some(root) = self.root(part) else { return };
        if let Source::Coordinates { q: at, .. } = self.robot.joints[root.at()].source {
            q[at..at + 7].copy_from_slice(&pose_to_array(X_WO));
        }
    }

    pub(crate) fn bodies(&self) -> Vec<Pose> {
        vec![Pose::identity(); self.kinematics.bodies()]
    }

    /// Whether nothing collides, or comes nearer than `clearance`, but for the hand that carries the gripper and the object that it
    /// holds.
    pub(crate) fn is_free(&self, X_WJ: &[Pose], holds: Option<(Option<JointIndex>, usize)>, clearance: f64) -> bool {
        self.meeting(X_WJ, holds, clearance).is_none()
    }

    /// The first pair that [`Self::is_free`] means.
    pub(crate) fn meeting(
        &self,
        X_WJ: &[Pose],
        holds: Option<(Option<JointIndex>, usize)>,
        clearance: f64,
    ) -> Option<Meeting> {
        let is_held = |(hand_part, body): (PartIndex, Option<JointIndex>), other: PartIndex| {
            holds.is_some_and(|(hand, object)| {
                other.at() == object && hand_part != other && body.is_some() && is_beyond(&self.robot, body, hand)
            })
        };
        // Objects lie on the table, and where they are was chosen.
        let rests = |a: PartIndex, b: PartIndex| a.at() == TABLE && b.at() > TABLE;
        let meets = |(index, pair): (usize, &Pair)| {
            let [a, b] = [pair.first, pair.second].map(|shape| {
                let solid = &self.scene.solids()[shape.at()];
                (self.robot.links[solid.link.at()].part, solid.body)
            });
            if is_held(a, b.0) || is_held(b, a.0) || rests(a.0, b.0) || rests(b.0, a.0) {
                return None;
            }
            let id = PairId(index as u32);
            let is_near = match clearance > 0.0 && a.0 != b.0 {
                true => {
                    let query = DistanceQuery::exact(clearance);
                    pair_clearance(&self.scene, id, X_WJ, query, &mut DVec3::ZERO.clone()) < clearance
                }
                false => touch(&self.scene, &[id], X_WJ, 0.0),
            };
            let links = || [pair.first, pair.second].map(|shape| self.scene.solids()[shape.at()].link);
            is_near.then(|| Meeting { bodies: [a.1, b.1], links: links() })
        };
        self.scene.pairs().iter().enumerate().find_map(meets)
    }

    /// Whether two links do not touch.
    pub(crate) fn are_apart(&self, links: [LinkIndex; 2], X_WJ: &[Pose]) -> bool {
        let is_own = |pair: &Pair| [pair.first, pair.second].map(|s| self.scene.solids()[s.at()].link) == links;
        let own = self.scene.pairs().iter().enumerate().filter(|(_, pair)| is_own(pair));
        own.into_iter().all(|(index, _)| !touch(&self.scene, &[PairId(index as u32)], X_WJ, 0.0))
    }

    /// Whether the robot is clear of the table, but for the body that carries a gripper and what is beyond it.
    pub(crate) fn is_beside_table(&self, X_WJ: &[Pose], hand: Option<JointIndex>) -> bool {
        let meets = |(index, pair): (usize, &Pair)| {
            let [a, b] = [pair.first, pair.second].map(|shape| &self.scene.solids()[shape.at()]);
            let [of_a, of_b] = [a, b].map(|solid| self.robot.links[solid.link.at()].part.at());
            let body = match (of_a, of_b) {
                (0, TABLE) => a.body,
                (TABLE, 0) => b.body,
                _ => return false,
            };
            !is_beyond(&self.robot, body, hand) && touch(&self.scene, &[PairId(index as u32)], X_WJ, 0.0)
        };
        !self.scene.pairs().iter().enumerate().any(meets)
    }

    /// The coordinates that move two bodies against each other.
    pub(crate) fn between(&self, bodies: [Option<JointIndex>; 2]) -> Vec<usize> {
        let robot = &self.robot;
        let above = |body: Option<JointIndex>| {
            std::iter::successors(body, |at| robot.joints[at.at()].parent).collect::<Vec<_>>()
        };
        let [first, second] = bodies.map(above);
        let of_one = |joint: &&JointIndex| first.contains(joint) != second.contains(joint);
        let joints = first.iter().chain(&second).filter(of_one);
        joints.filter_map(|&joint| coordinate(robot, leader(robot, joint))).collect()
    }
}
