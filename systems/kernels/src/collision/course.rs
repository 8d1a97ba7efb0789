//! A motion cut into intervals, and sixteen of its configurations placed side by side.
//!
//! A motion is a polyline; most have one piece. An interval is a span of whole pieces, seen from the knot in its middle, or
//! a dyadic part of one piece, seen from its midpoint. Sixteen intervals make a block: their configurations, and how far
//! each joint moves to either side of them, stand in lanes. Configurations that lie on no common motion are knots with
//! nothing between them.

use super::pairs::{ActiveGroup, PairSet};
use super::scene::{CollisionScene, SceneJoint};
use super::velocity_bound::FINE;
use crate::kinematics::{Carriage, Kinematics};
use crate::lanes::{F32Row, F64Row, Isa, Kernel, Lanes, Level, Rotation, Transform, Vector3, sin_cos};
use foliate_components::Pose;
use foliate_components::configuration::quaternion;
use foliate_components::pose::exp_so3;
use foliate_components::robot::{JointIndex, Motion};
use glam::{DMat3, DQuat, DVec3};

/// Lanes of a block.
pub(super) const LANES: usize = 16;
/// Numbers of a pose: columns of the rotation, then the translation.
pub(super) const POSE: usize = 12;
/// Intervals are not halved more often than this.
const DEEPEST: u32 = 48;

/// Part of a polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    /// From knot `first` to knot `last`; where that is one piece, the part of it below.
    first: u32,
    last: u32,
    /// [k, k + 1] · 2^−depth.
    k: u64,
    depth: u32,
}

/// Where an interval is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sample {
    /// At a knot, as the middle of a span.
    Knot { first: u32, middle: u32, last: u32 },
    /// At a parameter of a piece, as the middle of an interval of twice that half width.
    Inside { piece: u32, t: f64, half_width: f64 },
}

impl Interval {
    /// One knot, and nothing to either side of it.
    pub(super) fn knot(knot: u32) -> Self {
        Self { first: knot, last: knot, k: 0, depth: 0 }
    }

    pub(super) fn whole(pieces: u32) -> Self {
        Self { first: 0, last: pieces, k: 0, depth: 0 }
    }

    fn is_span(self) -> bool {
        self.last - self.first != 1
    }

    /// Where it begins, in pieces.
    pub(super) fn left(self) -> f64 {
        f64::from(self.first) + self.k as f64 * 0.5_f64.powi(self.depth as i32)
    }

    /// Whether another interval begins where this one ends.
    pub(super) fn is_followed_by(self, next: Self) -> bool {
        let end =
            if self.is_span() || self.k + 1 == 1 << self.depth { (self.last, 0) } else { (self.first, self.k + 1) };
        // Both as multiples of the shortest part that there is.
        end.0 == next.first && end.1 << (DEEPEST - self.depth) == next.k << (DEEPEST - next.depth)
    }

    /// Where the sample is, in pieces.
    pub(super) fn middle(self) -> f64 {
        match self.sample() {
            Sample::Knot { middle, .. } => f64::from(middle),
            Sample::Inside { piece, t, .. } => f64::from(piece) + t,
        }
    }

    pub(super) fn sample(self) -> Sample {
        if self.is_span() {
            let middle = self.first.midpoint(self.last);
            return Sample::Knot { first: self.first, middle, last: self.last };
        }
        let width = 0.5_f64.powi(self.depth as i32);
        Sample::Inside { piece: self.first, t: (self.k as f64 + 0.5) * width, half_width: 0.5 * width }
    }

    /// Its halves; none where it is as short as intervals get.
    pub(super) fn halves(self) -> Option<[Self; 2]> {
        if self.is_span() {
            let middle = self.first.midpoint(self.last);
            return Some([Self { last: middle, ..self }, Self { first: middle, ..self }]);
        }
        let half = |side| Self { k: 2 * self.k + side, depth: self.depth + 1, ..self };
        (self.depth < DEEPEST).then(|| [half(0), half(1)])
    }
}

/// Sines in lanes are exact up to here, radians; beyond it nothing is proved.
const FARTHEST: f64 = 1e5;

/// A body that moves along the motion, and what moves it.
#[derive(Clone, Copy, Debug)]
struct Step {
    body: u32,
    /// The body that it hangs on; none for the world.
    parent: Option<u32>,
    /// Where it hangs (with joint: at zero).
    hangs: Pose,
    motion: Option<Motion>,
    /// First of its rows in `values`.
    value: u32,
}

/// What is known of a motion, and of the block being looked at. Buffers are reused from motion to motion.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    /// By joint: whether it moves its body somewhere along the motion.
    joint_moves: Vec<bool>,
    /// By body: whether its pose changes along the motion.
    body_moves: Vec<bool>,
    steps: Vec<Step>,
    /// By piece: the configuration space's difference.
    deltas: Vec<f64>,
    /// By knot and joint: path lengths of rotation (radians) and translation (metres) up to there.
    lengths: Vec<(f64, f64)>,
    /// By joint: the farthest that its translation is from zero, metres.
    pub(super) travel: Vec<f64>,
    /// By body: poses at the start; those that do not move stay there.
    pub(super) start: Vec<Pose>,
    /// By step: coordinates, two rows each.
    values: Vec<[F64Row; 2]>,
    /// By body, two halves each.
    exact: Vec<[[F64Row; POSE]; 2]>,
    /// By body: poses, rounded.
    pub(super) poses: Vec<[F32Row; POSE]>,
    /// By joint: how far it turns and slides to either side of the sample, in radians and metres; a little more than that.
    pub(super) turns: Vec<F32Row>,
    pub(super) slides: Vec<F32Row>,
    /// By chain link: reach of the body beyond that joint, metres.
    pub(super) reach: Vec<f32>,
    /// As displacements stand: how many of the joints from the body up to there move.
    moving: Vec<u32>,
    /// Whether nothing moves within intervals: each is one configuration.
    is_still: bool,
}

/// Displacements in lanes are computed with single precision, and so from joint motions that are this much larger.
const MORE: f64 = 1.0 + 1e-5;

impl Course {
    /// Starts a motion through `knots` of `pieces` pieces.
    pub(super) fn begin(
        &mut self,
        (scene, kinematics, carriages): (&CollisionScene, &Kinematics, &[Carriage]),
        pairs: &PairSet,
        knots: &[f64],
    ) {
        let (size, dimension, joints) = (scene.space.size(), scene.space.dimension(), scene.joints.len());
        let pieces = (knots.len() / size).saturating_sub(1);
        self.is_still = false;
        self.deltas.clear();
        self.deltas.resize(pieces * dimension, 0.0);
        self.lengths.clear();
        self.lengths.resize(joints, (0.0, 0.0));
        self.travel.clear();
        self.travel.resize(joints, 0.0);
        for piece in 0..pieces {
            let (a, b) = (&knots[piece * size..][..size], &knots[(piece + 1) * size..][..size]);
            let delta = &mut self.deltas[piece * dimension..][..dimension];
            scene.space.difference(a, b, delta);
            for (index, joint) in scene.joints.iter().enumerate() {
                let (turn, slide, travel) = joint.moves_by(a, delta);
                let (turned, slid) = self.lengths[piece * joints + index];
                self.lengths.push((turned + turn, slid + slide));
                self.travel[index] = self.travel[index].max(travel);
            }
        }
        self.joint_moves.clear();
        self.joint_moves.extend((0..joints).map(|j| {
            let (turned, slid) = self.lengths[pieces * joints + j];
            // Compared so that NaN moves.
            !(turned == 0.0 && slid == 0.0)
        }));
        self.set_out((scene, kinematics, carriages), pairs, knots);
    }

    /// Starts with at least one configuration, and with nothing between those that there are: joints that have the same
    /// coordinates in all of them do not move.
    pub(super) fn begin_still(
        &mut self,
        (scene, kinematics, carriages): (&CollisionScene, &Kinematics, &[Carriage]),
        pairs: &PairSet,
        configurations: &[f64],
    ) {
        let (size, joints) = (scene.space.size(), scene.joints.len());
        self.is_still = true;
        self.travel.clear();
        self.travel.resize(joints, 0.0);
        self.joint_moves.clear();
        self.joint_moves.resize(joints, false);
        let (first, others) = configurations.split_at(size);
        for other in others.chunks_exact(size) {
            for (moves, joint) in self.joint_moves.iter_mut().zip(&scene.joints) {
                let own = joint.q..joint.q + joint.motion.configuration_size();
                // Compared so that NaN moves.
                *moves |= first[own.clone()] != other[own];
            }
        }
        self.set_out((scene, kinematics, carriages), pairs, configurations);
    }

    /// Places the bodies at the first of `knots` and finds which of them move.
    fn set_out(
        &mut self,
        (scene, kinematics, carriages): (&CollisionScene, &Kinematics, &[Carriage]),
        pairs: &PairSet,
        knots: &[f64],
    ) {
        self.start.clear();
        self.start.resize(scene.joints.len(), Pose::IDENTITY);
        kinematics.forward(knots, &mut self.start);
        kinematics.carry(knots, carriages, &mut self.start);
        self.find_what_moves(scene, carriages, kinematics.passes(carriages));
        self.make_room(scene, pairs);
    }

    /// Lists the bodies that move, each behind what it hangs on.
    fn find_what_moves(&mut self, scene: &CollisionScene, carriages: &[Carriage], passes: usize) {
        let joints = scene.joints.len();
        self.body_moves.clear();
        self.body_moves.resize(joints, false);
        self.steps.clear();
        self.values.clear();
        for carriage in carriages {
            self.joint_moves[carriage.object.at()] = false;
        }
        let mut carried = 0..0;
        for (index, joint) in scene.joints.iter().enumerate() {
            if carriages.iter().any(|c| c.object.at() == index) {
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
        for carriage in std::iter::repeat_n(carriages, passes).flatten() {
            let object = carriage.object.at();
            if carriage.carrier.is_some_and(|c| self.body_moves[c.at()]) {
                self.body_moves[object] = true;
                let parent = carriage.carrier.map(|c| c.0);
                let hangs = carriage.X_CO;
                self.steps.push(Step { body: object as u32, parent, hangs, motion: None, value: 0 });
            }
            for index in object + 1..joints {
                if scene.joints[index].parent.is_none_or(|p| p.at() < object) {
                    break;
                }
                self.add_joint(index, &scene.joints[index]);
            }
        }
    }

    fn add_joint(&mut self, index: usize, joint: &SceneJoint) {
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
            hangs: Pose::from_parts(joint.offset, joint.turned),
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
        self.reach.resize(pairs.tree.links.len(), 0.0);
        self.moving.clear();
        self.moving.resize(pairs.tree.links.len() + scene.clusters.len() + 1, 0);
        for (number, cluster) in scene.clusters.iter().enumerate() {
            let chain = pairs.tree.chain_of(cluster.body);
            let (mut travel, mut moving) = (0.0, 0);
            for index in chain.start as usize..chain.end as usize {
                let link = &pairs.tree.links[index];
                self.reach[index] = ((link.reach + travel) * MORE) as f32;
                travel += self.travel[link.joint as usize];
                moving += u32::from(self.joint_moves[link.joint as usize]);
                self.moving[index + number + 1] = moving;
            }
        }
    }

    /// Whether nothing moves within intervals.
    #[inline]
    pub(super) fn is_still(&self) -> bool {
        self.is_still
    }

    /// Whether a joint moves its body somewhere along the motion.
    #[inline]
    pub(super) fn joint_moves(&self, joint: u32) -> bool {
        self.joint_moves[joint as usize]
    }

    /// Whether the two clusters of a group change their relative pose along the motion.
    #[inline]
    pub(super) fn moves_between(&self, active: &ActiveGroup) -> bool {
        self.moving[active.rows.0 as usize] + self.moving[active.rows.1 as usize] > 0
    }

    /// Whether the motion is straight within a lane's interval, and turns little enough for the velocity bound's directions
    /// to have a chance.
    pub(super) fn is_fine(&self, sample: Sample, lane: usize) -> bool {
        let turned = || self.turns.iter().map(|row| f64::from(row[lane])).sum::<f64>();
        matches!(sample, Sample::Inside { .. }) && turned() < FINE
    }

    /// Whether a body, or the world, changes its pose along the motion.
    #[inline]
    pub(super) fn body_moves(&self, body: Option<JointIndex>) -> bool {
        body.is_some_and(|b| self.body_moves[b.at()])
    }

    /// The first configuration of a piece, and its difference to the next.
    pub(super) fn piece<'a>(&'a self, scene: &CollisionScene, knots: &'a [f64], piece: u32) -> (&'a [f64], &'a [f64]) {
        let (size, dimension) = (scene.space.size(), scene.space.dimension());
        (&knots[piece as usize * size..][..size], &self.deltas[piece as usize * dimension..][..dimension])
    }

    /// Goes to a block of at most sixteen intervals; the last of them fills the lanes that are left.
    pub(super) fn look_at(&mut self, scene: &CollisionScene, level: Level, knots: &[f64], intervals: &[Interval]) {
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
        let joints = scene.joints.len();
        for index in (0..joints).filter(|&j| self.joint_moves[j]) {
            let at = |knot: u32| self.lengths[knot as usize * joints + index];
            let (turn, slide) = match sample {
                Sample::Knot { first, middle, last } => {
                    let (a, m, b) = (at(first), at(middle), at(last));
                    ((m.0 - a.0).max(b.0 - m.0), (m.1 - a.1).max(b.1 - m.1))
                }
                Sample::Inside { piece, half_width, .. } => {
                    let (a, b) = (at(piece), at(piece + 1));
                    ((b.0 - a.0) * half_width, (b.1 - a.1) * half_width)
                }
            };
            self.turns[index][lane] = (turn * MORE) as f32;
            self.slides[index][lane] = (slide * MORE) as f32;
        }
    }

    fn write_coordinates(&mut self, scene: &CollisionScene, knots: &[f64], sample: Sample, lane: usize) {
        let (size, dimension) = (scene.space.size(), scene.space.dimension());
        let (knot, delta, t) = match sample {
            Sample::Knot { middle, .. } => (middle as usize, None, 0.0),
            Sample::Inside { piece, t, .. } => {
                (piece as usize, Some(&self.deltas[piece as usize * dimension..][..dimension]), t)
            }
        };
        let q = &knots[knot * size..][..size];
        let (half, lane) = (lane / 8, lane % 8);
        for step in &self.steps {
            let Some(motion) = step.motion else { continue };
            let joint = &scene.joints[step.body as usize];
            let rows = &mut self.values[step.value as usize..];
            let linear = |i: usize| q[joint.q + i] + delta.map_or(0.0, |d| t * d[joint.v + i]);
            match motion {
                Motion::Revolute { .. } | Motion::Prismatic { .. } => {
                    let value = joint.multiplier * linear(0) + joint.constant;
                    rows[0][half][lane] = if value.abs() < FARTHEST { value } else { f64::NAN };
                }
                Motion::Planar => {
                    (0..3).for_each(|i| rows[i][half][lane] = linear(i));
                    if rows[2][half][lane].abs() > FARTHEST {
                        rows[2][half][lane] = f64::NAN;
                    }
                }
                Motion::FreeFlyer => {
                    (0..3).for_each(|i| rows[i][half][lane] = linear(i));
                    let turned = match delta {
                        Some(d) => {
                            let v = joint.v + 3;
                            quaternion(q, joint.q) * exp_so3(DVec3::new(d[v], d[v + 1], d[v + 2]) * t)
                        }
                        None => quaternion(q, joint.q),
                    };
                    let turned = turned.normalize().to_array();
                    (0..4).for_each(|i| rows[3 + i][half][lane] = turned[i]);
                }
            }
        }
    }

    /// Poses of all bodies in one lane.
    pub(super) fn poses_in(&self, lane: usize, X_WJ: &mut Vec<Pose>) {
        X_WJ.clear();
        X_WJ.extend_from_slice(&self.start);
        for step in &self.steps {
            X_WJ[step.body as usize] = self.moved_pose(step.body as usize, lane);
        }
    }

    /// Pose of a body, or of the world, in one lane.
    #[inline]
    pub(super) fn pose_in(&self, lane: usize, body: Option<JointIndex>) -> Pose {
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

fn rows_of(motion: Motion) -> usize {
    match motion {
        Motion::Revolute { .. } | Motion::Prismatic { .. } => 1,
        Motion::Planar => 3,
        Motion::FreeFlyer => 7,
    }
}

fn numbers_of(X: &Pose) -> [f64; POSE] {
    let r = DMat3::from_quat(X.rotation).to_cols_array();
    let t = X.translation;
    [r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], t.x, t.y, t.z]
}

impl SceneJoint {
    /// By how much it turns and slides along a straight motion, and how far from zero its translation is at most.
    fn moves_by(&self, q: &[f64], delta: &[f64]) -> (f64, f64, f64) {
        let (i, j) = (self.q, self.v);
        let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        match self.motion {
            Motion::Revolute { .. } => ((self.multiplier * delta[j]).abs(), 0.0, 0.0),
            Motion::Prismatic { .. } => {
                let value = |x: f64| (self.multiplier * x + self.constant).abs();
                (0.0, (self.multiplier * delta[j]).abs(), value(q[i]).max(value(q[i] + delta[j])))
            }
            Motion::Planar => {
                let end = [q[i] + delta[j], q[i + 1] + delta[j + 1]];
                (delta[j + 2].abs(), length(&delta[j..j + 2]), length(&q[i..i + 2]).max(length(&end)))
            }
            Motion::FreeFlyer => {
                let end = [q[i] + delta[j], q[i + 1] + delta[j + 1], q[i + 2] + delta[j + 2]];
                (length(&delta[j + 3..j + 6]), length(&delta[j..j + 3]), length(&q[i..i + 3]).max(length(&end)))
            }
        }
    }
}

/// Forward kinematics of the bodies that move, with carried objects.
struct PlaceBodies<'a> {
    steps: &'a [Step],
    values: &'a [[F64Row; 2]],
    start: &'a [Pose],
    body_moves: &'a [bool],
    exact: &'a mut [[[F64Row; POSE]; 2]],
    poses: &'a mut [[F32Row; POSE]],
}

impl Kernel for PlaceBodies<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        for step in self.steps {
            for half in 0..2 {
                let values = &self.values[step.value as usize..];
                let hung: Transform<I::F64> = match step.parent {
                    None => Transform::splat(isa, &step.hangs),
                    Some(parent) if self.body_moves[parent as usize] => {
                        Transform::load(isa, &self.exact[parent as usize][half])
                            .times(&Transform::splat(isa, &step.hangs))
                    }
                    Some(parent) => Transform::splat(isa, &(self.start[parent as usize] * step.hangs)),
                };
                let placed = match step.motion {
                    None => hung,
                    Some(Motion::Revolute { axis }) => {
                        let angle = I::F64::load(isa, &values[0][half]);
                        Transform { rotation: turned(hung.rotation, axis, angle), translation: hung.translation }
                    }
                    Some(Motion::Prismatic { axis }) => {
                        let by = I::F64::load(isa, &values[0][half]);
                        let along = Vector3::splat(isa, axis).scaled(by);
                        Transform { rotation: hung.rotation, translation: hung.point(along) }
                    }
                    Some(Motion::Planar) => {
                        let (x, y) = (I::F64::load(isa, &values[0][half]), I::F64::load(isa, &values[1][half]));
                        let at = hung.point(Vector3::new(x, y, I::F64::constant(isa, 0.0)));
                        let angle = I::F64::load(isa, &values[2][half]);
                        Transform { rotation: turned(hung.rotation, DVec3::Z, angle), translation: at }
                    }
                    Some(Motion::FreeFlyer) => {
                        let row = [
                            I::F64::load(isa, &values[0][half]),
                            I::F64::load(isa, &values[1][half]),
                            I::F64::load(isa, &values[2][half]),
                            I::F64::load(isa, &values[3][half]),
                            I::F64::load(isa, &values[4][half]),
                            I::F64::load(isa, &values[5][half]),
                            I::F64::load(isa, &values[6][half]),
                        ];
                        let own = Transform {
                            rotation: Rotation::from_quaternion(row[3], row[4], row[5], row[6]),
                            translation: Vector3::new(row[0], row[1], row[2]),
                        };
                        hung.times(&own)
                    }
                };
                let rows = &mut self.exact[step.body as usize][half];
                placed.store(rows);
                let rounded = &mut self.poses[step.body as usize];
                for number in 0..POSE {
                    for lane in 0..8 {
                        rounded[number].0[8 * half + lane] = rows[number].0[lane] as f32;
                    }
                }
            }
        }
    }
}

/// A frame, turned about an axis of its own.
#[inline(always)]
fn turned<V: Lanes>(frame: Rotation<V>, axis: DVec3, angle: V) -> Rotation<V> {
    let (sine, cosine) = sin_cos(angle);
    let [x, y, z] = frame.columns;
    if axis.x.abs() == 1.0 {
        let sine = sine * V::constant(angle.isa(), axis.x);
        Rotation { columns: [x, y.scaled_plus(cosine, z.scaled(sine)), z.scaled_plus(cosine, y.scaled(-sine))] }
    } else if axis.y.abs() == 1.0 {
        let sine = sine * V::constant(angle.isa(), axis.y);
        Rotation { columns: [x.scaled_plus(cosine, z.scaled(-sine)), y, z.scaled_plus(cosine, x.scaled(sine))] }
    } else if axis.z.abs() == 1.0 {
        let sine = sine * V::constant(angle.isa(), axis.z);
        Rotation { columns: [x.scaled_plus(cosine, y.scaled(sine)), y.scaled_plus(cosine, x.scaled(-sine)), z] }
    } else {
        // Rodrigues: c + (1 − c) a aᵀ + s [a]×, column by column.
        let isa = angle.isa();
        let a = Vector3::<V>::splat(isa, axis);
        let rest = V::constant(isa, 1.0) - cosine;
        let (ax, ay, az) = (a.scaled(rest * a.x), a.scaled(rest * a.y), a.scaled(rest * a.z));
        let (sx, sy, sz) = (a.x * sine, a.y * sine, a.z * sine);
        let own = Rotation {
            columns: [
                Vector3::new(ax.x + cosine, ax.y + sz, ax.z - sy),
                Vector3::new(ay.x - sz, ay.y + cosine, ay.z + sx),
                Vector3::new(az.x + sy, az.y - sx, az.z + cosine),
            ],
        };
        frame.times(&own)
    }
}
