//! A motion cut into intervals, and sixteen of its configurations placed side by side.
//!
//! A motion is a polyline or a curve; most have one piece. An interval is a span of whole pieces, seen from the knot in its
//! middle, or a dyadic part of one piece, seen from its midpoint. Samples of a curve lie on the curve itself. Sixteen intervals
//! make a block: their configurations, and how far each joint moves to either side of them, stand in lanes. Configurations that
//! lie on no common motion are knots with nothing between them.

use crate::collision::samples::interval::{Interval, LANES, POSE, Sample};
use crate::collision::samples::motion_bound::FINE;
use crate::collision::samples::pieces::Pieces;
use crate::collision::samples::place_bodies::{PlaceBodies, Step, numbers_of, rows_of};
use crate::collision::scene::collision_scene::CollisionScene;
use crate::collision::scene::pair_set::{ActiveGroup, PairSet};
use crate::curve::hermite::HermiteCurve;
use crate::kinematics::forward::{Kinematics, RigidAttachment};
use crate::kinematics::joint_table::JointEntry;
use crate::lanes::level::Level;
use crate::lanes::vector::{F32Row, F64Row};
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, JointType};
use glam::{DMat3, DQuat, DVec3};

/// Sines in lanes are exact up to here, radians; beyond it nothing is proved.
const FARTHEST: f64 = 1e5;

/// What poses depend on: bodies, how they are placed, and who carries what.
type Tables<'a> = (&'a CollisionScene, &'a Kinematics, &'a [RigidAttachment]);

/// What is known of a motion, and of the current block. Buffers are reused from motion to motion.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionSamples {
    /// By joint: whether it moves its body somewhere along the motion.
    joint_moves: Vec<bool>,
    /// By body: whether its pose changes along the motion.
    body_moves: Vec<bool>,
    steps: Vec<Step>,
    pub(crate) pieces: Pieces,
    /// By body: poses at the start; those that do not move stay there.
    pub(crate) start: Vec<Pose>,
    /// By step: coordinates, two rows each.
    values: Vec<[F64Row; 2]>,
    /// By body, two halves each.
    exact: Vec<[[F64Row; POSE]; 2]>,
    /// By body: poses, rounded.
    pub(crate) poses: Vec<[F32Row; POSE]>,
    /// By joint: how far it turns and slides to either side of the sample, in radians and metres; a little more than that.
    pub(crate) turns: Vec<F32Row>,
    pub(crate) slides: Vec<F32Row>,
    /// By chain link: reach of the body beyond that joint, metres.
    pub(crate) reach: Vec<f32>,
    /// As displacements stand: how many of the joints from the body up to there move.
    moving: Vec<u32>,
    /// Whether nothing moves within intervals: each is one configuration.
    is_still: bool,
}

/// Displacements in lanes are computed with single precision, and so from joint motions that are this much larger.
const MORE: f64 = 1.0 + 1e-5;

impl MotionSamples {
    /// Starts a motion through `knots`.
    pub(crate) fn begin(&mut self, tables: Tables<'_>, pairs: &PairSet, knots: &[f64]) {
        self.is_still = false;
        self.pieces.begin(tables.0, knots);
        self.pieces.moving_joints(&mut self.joint_moves);
        self.set_out(tables, pairs, knots);
    }

    /// Starts a motion along a curve.
    pub(crate) fn begin_curve(&mut self, tables: Tables<'_>, pairs: &PairSet, curve: &HermiteCurve<'_>) {
        self.is_still = false;
        self.pieces.begin_curve(tables.0, curve);
        self.pieces.moving_joints(&mut self.joint_moves);
        self.set_out(tables, pairs, curve.knots);
    }

    /// Starts with at least one configuration, and with nothing between those that there are: joints that have the same
    /// coordinates in all of them do not move.
    pub(crate) fn begin_still(
        &mut self,
        (scene, kinematics, rigid_attachments): Tables<'_>,
        pairs: &PairSet,
        configurations: &[f64],
    ) {
        let (size, joints) = (scene.space.size(), scene.joints.len());
        self.is_still = true;
        self.pieces.start_over(scene);
        self.joint_moves.clear();
        self.joint_moves.resize(joints, false);
        let (first, others) = configurations.split_at(size);
        for other in others.chunks_exact(size) {
            for (moves, joint) in self.joint_moves.iter_mut().zip(scene.joints.iter()) {
                let first_own = joint.coordinates.q;
                let own = first_own..first_own + joint.motion.configuration_size();
                // Compared so that NaN moves.
                *moves |= first[own.clone()] != other[own];
            }
        }
        self.set_out((scene, kinematics, rigid_attachments), pairs, configurations);
    }

    /// Places the bodies at the first of `knots` and finds which of them move.
    fn set_out(&mut self, (scene, kinematics, rigid_attachments): Tables<'_>, pairs: &PairSet, knots: &[f64]) {
        self.start.clear();
        self.start.resize(scene.joints.len(), Pose::IDENTITY);
        kinematics.forward(knots, &mut self.start);
        kinematics.carry(knots, rigid_attachments, &mut self.start);
        self.find_what_moves(scene, rigid_attachments, kinematics.passes(rigid_attachments));
        self.make_room(scene, pairs);
    }

    /// Lists the bodies that move, each behind what it is attached to.
    fn find_what_moves(&mut self, scene: &CollisionScene, rigid_attachments: &[RigidAttachment], passes: usize) {
        let joints = scene.joints.len();
        self.body_moves.clear();
        self.body_moves.resize(joints, false);
        self.steps.clear();
        self.values.clear();
        for rigid_attachment in rigid_attachments {
            self.joint_moves[rigid_attachment.object.at()] = false;
        }
        let mut carried = 0..0;
        for (index, joint) in scene.joints.iter().enumerate() {
            if rigid_attachments.iter().any(|c| c.object.at() == index) {
                carried = index..joints;
            }
            // An articulated object's own joints stand directly behind its root.
            if carried.contains(&index)
                && (index == carried.start || joint.parent.is_some_and(|p| p.at() >= carried.start))
            {
                continue;
            }
            carried = 0..0;
            self.add_joint(index, joint);
        }
        for rigid_attachment in std::iter::repeat_n(rigid_attachments, passes).flatten() {
            let object = rigid_attachment.object.at();
            if rigid_attachment.carrier.is_some_and(|c| self.body_moves[c.at()]) {
                self.body_moves[object] = true;
                let parent = rigid_attachment.carrier.map(|c| c.0);
                let X_PB = rigid_attachment.X_CO;
                self.steps.push(Step { body: object as u32, parent, X_PB, motion: None, value: 0 });
            }
            for index in object + 1..joints {
                if scene.joints[index].parent.is_none_or(|p| p.at() < object) {
                    break;
                }
                self.add_joint(index, &scene.joints[index]);
            }
        }
    }

    fn add_joint(&mut self, index: usize, joint: &JointEntry) {
        let with_parent = joint.parent.is_some_and(|p| self.body_moves[p.at()]);
        if !with_parent && !self.joint_moves[index] {
            return;
        }
        self.body_moves[index] = true;
        let value = self.values.len() as u32;
        self.values.resize(self.values.len() + rows_of(joint.motion), [F64Row::default(); 2]);
        self.steps.push(Step {
            body: index as u32,
            parent: joint.parent.map(|p| p.0),
            X_PB: joint.X_PJ,
            motion: Some(joint.motion),
            value,
        });
    }

    fn make_room(&mut self, scene: &CollisionScene, pairs: &PairSet) {
        let joints = scene.joints.len();
        self.exact.resize(joints.max(self.exact.len()), [[F64Row::default(); POSE]; 2]);
        self.poses.resize(joints.max(self.poses.len()), [F32Row::default(); POSE]);
        for (X_WJ, rows) in self.start.iter().zip(&mut self.poses) {
            let numbers = numbers_of(X_WJ);
            for (row, number) in rows.iter_mut().zip(numbers) {
                *row = F32Row::splat(number as f32);
            }
        }
        self.turns.clear();
        self.turns.resize(joints, F32Row::default());
        self.slides.clear();
        self.slides.resize(joints, F32Row::default());
        self.reach.clear();
        self.reach.resize(pairs.chains.links.len(), 0.0);
        self.moving.clear();
        self.moving.resize(pairs.chains.links.len() + scene.clusters.len() + 1, 0);
        for (number, cluster) in scene.clusters.iter().enumerate() {
            let chain = pairs.chains.chain_of(cluster.body);
            let (mut travel, mut moving) = (0.0, 0);
            for index in chain.start as usize..chain.end as usize {
                let link = &pairs.chains.links[index];
                self.reach[index] = ((link.reach + travel) * MORE) as f32;
                travel += self.pieces.travel[link.joint as usize];
                moving += u32::from(self.joint_moves[link.joint as usize]);
                self.moving[index + number + 1] = moving;
            }
        }
    }

    /// Whether nothing moves within intervals.
    #[inline]
    pub(crate) fn is_still(&self) -> bool {
        self.is_still
    }

    /// Whether a joint moves its body somewhere along the motion.
    #[inline]
    pub(crate) fn joint_moves(&self, joint: u32) -> bool {
        self.joint_moves[joint as usize]
    }

    /// Whether the two clusters of a group change their relative pose along the motion.
    #[inline]
    pub(crate) fn moves_between(&self, active: &ActiveGroup) -> bool {
        self.moving[active.rows.0 as usize] + self.moving[active.rows.1 as usize] > 0
    }

    /// Whether the motion is smooth within a lane's interval, and turns little enough for the velocity bound's directions to
    /// have a chance.
    pub(crate) fn is_fine(&self, sample: Sample, lane: usize) -> bool {
        let turned = || self.turns.iter().map(|row| f64::from(row[lane])).sum::<f64>();
        matches!(sample, Sample::Inside { .. }) && turned() < FINE
    }

    /// Whether a body, or the world, changes its pose along the motion.
    #[inline]
    pub(crate) fn body_moves(&self, body: Option<JointIndex>) -> bool {
        body.is_some_and(|b| self.body_moves[b.at()])
    }

    /// Goes to a block of at most sixteen intervals; the last of them fills the lanes that are left.
    pub(crate) fn look_at(&mut self, scene: &CollisionScene, level: Level, knots: &[f64], intervals: &[Interval]) {
        for lane in 0..LANES {
            let interval = intervals[lane.min(intervals.len() - 1)];
            if !self.is_still {
                self.bound_joints(scene, interval.sample(), lane);
            }
            self.write_coordinates(scene, knots, interval.sample(), lane);
        }
        level.run(PlaceBodies {
            steps: &self.steps,
            values: &self.values,
            start: &self.start,
            body_moves: &self.body_moves,
            exact: &mut self.exact,
            poses: &mut self.poses,
        });
    }

    fn bound_joints(&mut self, scene: &CollisionScene, sample: Sample, lane: usize) {
        for (index, joint) in scene.joints.iter().enumerate().filter(|&(j, _)| self.joint_moves[j]) {
            let (turn, slide) = self.pieces.moves_within(joint, index, sample);
            self.turns[index][lane] = (turn * MORE) as f32;
            self.slides[index][lane] = (slide * MORE) as f32;
        }
    }

    fn write_coordinates(&mut self, scene: &CollisionScene, knots: &[f64], sample: Sample, lane: usize) {
        let (half, lane) = (lane / 8, lane % 8);
        let way = self.pieces.way(knots, sample);
        for step in &self.steps {
            let Some(motion) = step.motion else { continue };
            let joint = scene.joints[step.body as usize].coordinates;
            let rows = &mut self.values[step.value as usize..];
            match motion {
                JointType::Revolute { .. } | JointType::Prismatic { .. } => {
                    let value = joint.multiplier * way.number(joint, 0) + joint.offset;
                    rows[0][half][lane] = if value.abs() < FARTHEST { value } else { f64::NAN };
                }
                JointType::Planar => {
                    (0..3).for_each(|i| rows[i][half][lane] = way.number(joint, i));
                    if rows[2][half][lane].abs() > FARTHEST {
                        rows[2][half][lane] = f64::NAN;
                    }
                }
                JointType::FreeFlyer => {
                    (0..3).for_each(|i| rows[i][half][lane] = way.number(joint, i));
                    let turned = way.rotation(joint).to_array();
                    (0..4).for_each(|i| rows[3 + i][half][lane] = turned[i]);
                }
            }
        }
    }

    /// Poses of all bodies in one lane.
    pub(crate) fn poses_in(&self, lane: usize, X_WJ: &mut Vec<Pose>) {
        X_WJ.clear();
        X_WJ.extend_from_slice(&self.start);
        for step in &self.steps {
            X_WJ[step.body as usize] = self.moved_pose(step.body as usize, lane);
        }
    }

    /// Pose of a body, or of the world, in one lane.
    #[inline]
    pub(crate) fn pose_in(&self, lane: usize, body: Option<JointIndex>) -> Pose {
        match body {
            None => Pose::IDENTITY,
            Some(body) if self.body_moves[body.at()] => self.moved_pose(body.at(), lane),
            Some(body) => self.start[body.at()],
        }
    }

    fn moved_pose(&self, body: usize, lane: usize) -> Pose {
        let rows = &self.exact[body][lane / 8];
        let v = |i: usize| DVec3::new(rows[i][lane % 8], rows[i + 1][lane % 8], rows[i + 2][lane % 8]);
        let rotation = DQuat::from_mat3(&DMat3::from_cols(v(0), v(3), v(6)));
        Pose::from_parts(v(9), rotation.normalize())
    }
}
