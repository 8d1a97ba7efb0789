//! Clusters, joint axes and solids of a block, placed in lanes in the world, and bounds on how far groups approach.
//!
//! `BroadPhaseScratch` caches these rows, so that each solid and each cluster is computed at most once per block. `approach` sums up
//! the displacement of each cluster within the interval of each lane, by the same recursion as `samples/motion_bound.rs`.
//! `BroadPhaseScratch` also holds the slack: the rounding error of the bounds in each lane.

use crate::collision::samples::interval::POSE;
use crate::collision::samples::motion_samples::MotionSamples;
use crate::collision::scene::collision_scene::CollisionScene;
use crate::collision::scene::pair_set::{ActiveGroup, PairSet};
use crate::lanes::geometry::{Rotation, Transform, Vector3};
use crate::lanes::vector::Lanes;
use crate::lanes::vector::{F32Row, Isa};
use foliate_components::robot::JointType;
use glam::DVec3;

/// Rounding of single-precision bounds, as a share of the largest coordinate.
const SLACK: f32 = 64.0 / 16_777_216.0;

/// Buffers of the broad phase. Rows are valid for one block.
#[derive(Clone, Debug, Default)]
pub(crate) struct BroadPhaseScratch {
    /// By cluster: centre of its ball in the world.
    pub(crate) centers: Vec<[F32Row; 3]>,
    /// By solid: centre and axes in the world.
    pub(crate) solids: Vec<[F32Row; POSE]>,
    /// By solid: the block for which its rows were computed.
    fresh_solids: Vec<u32>,
    /// By joint: axis in the world.
    axes: Vec<[F32Row; 3]>,
    /// By chain link, one more per cluster, and a last one that is zero: how far the joints from the body up to there can
    /// displace it, metres.
    moved: Vec<F32Row>,
    fresh_clusters: Vec<u32>,
    pub(crate) block: u32,
    /// At most this much do lanes' bounds err in the block, metres.
    pub(crate) slack: F32Row,
}

impl BroadPhaseScratch {
    /// Starts a motion.
    pub(crate) fn begin(&mut self, scene: &CollisionScene, pairs: &PairSet) {
        self.centers.resize(scene.clusters.len().max(self.centers.len()), Default::default());
        self.solids.resize(scene.solids.len().max(self.solids.len()), Default::default());
        self.axes.resize(scene.joints.len().max(self.axes.len()), Default::default());
        let rows = pairs.chains.links.len() + scene.clusters.len() + 1;
        self.moved.clear();
        self.moved.resize(rows, F32Row::default());
        self.fresh_solids.clear();
        self.fresh_solids.resize(scene.solids.len(), 0);
        self.fresh_clusters.clear();
        self.fresh_clusters.resize(scene.clusters.len(), 0);
        self.block = 0;
    }
}

impl BroadPhaseScratch {
    /// At most this far do the clusters of a group come closer within the interval of a lane, metres; to be asked after a
    /// sweep over the group.
    pub(crate) fn closer(&self, active: &ActiveGroup, lane: usize) -> f64 {
        f64::from(self.moved[active.rows.0 as usize][lane]) + f64::from(self.moved[active.rows.1 as usize][lane])
    }
}

/// Centres of the clusters' balls, and from them how much rounding there is.
#[inline(always)]
pub(crate) fn place_clusters<I: Isa>(
    isa: I,
    scene: &CollisionScene,
    motion_samples: &MotionSamples,
    scratch: &mut BroadPhaseScratch,
    mut most: I::F32,
) {
    for index in 0..scene.clusters.len() {
        let (cluster, rows) = (&scene.clusters[index], &mut scratch.centers[index]);
        if scratch.block == 1 || motion_samples.body_moves(cluster.body) {
            let center = Vector3::<I::F32>::splat(isa, cluster.ball.center);
            let center = match cluster.body {
                Some(body) => Transform::load(isa, &motion_samples.poses[body.at()]).point(center),
                None => center,
            };
            center.store(rows);
        }
        let center = Vector3::<I::F32>::load(isa, rows);
        let farthest = center.x.abs().max(center.y.abs()).max(center.z.abs());
        most = most.max(farthest + I::F32::constant(isa, cluster.ball.radius));
    }
    (most * SLACK).store(&mut scratch.slack);
}

/// Axes of the joints that move; also the largest coordinate of their origins.
#[inline(always)]
pub(crate) fn place_axes<I: Isa>(
    isa: I,
    scene: &CollisionScene,
    motion_samples: &MotionSamples,
    scratch: &mut BroadPhaseScratch,
) -> I::F32 {
    let mut most = I::F32::constant(isa, 0.0);
    for index in 0..scene.joints.len() {
        if !motion_samples.joint_moves(index as u32) {
            continue;
        }
        let origin = Vector3::<I::F32>::load(isa, &motion_samples.poses[index][9..]);
        most = most.max(origin.x.abs()).max(origin.y.abs()).max(origin.z.abs());
        let axis = match scene.joints[index].motion {
            JointType::Revolute { axis } => axis,
            JointType::Planar => DVec3::Z,
            JointType::Prismatic { .. } | JointType::FreeFlyer => continue,
        };
        let rotation = Rotation::<I::F32>::load(isa, &motion_samples.poses[index][..9]);
        rotation.turn(Vector3::splat(isa, axis)).store(&mut scratch.axes[index]);
    }
    most
}

#[inline(always)]
pub(crate) fn place_solid<I: Isa>(
    isa: I,
    scene: &CollisionScene,
    motion_samples: &MotionSamples,
    scratch: &mut BroadPhaseScratch,
    index: usize,
) {
    let solid = &scene.solids[index];
    let fresh = scratch.fresh_solids[index];
    if fresh == scratch.block || (fresh > 0 && !motion_samples.body_moves(solid.body)) {
        return;
    }
    scratch.fresh_solids[index] = scratch.block;
    let vector = |v: [f32; 3]| {
        Vector3::<I::F32>::new(I::F32::splat(isa, v[0]), I::F32::splat(isa, v[1]), I::F32::splat(isa, v[2]))
    };
    let own = Transform {
        rotation: Rotation {
            columns: [vector(solid.bounding.axes[0]), vector(solid.bounding.axes[1]), vector(solid.bounding.axes[2])],
        },
        translation: vector(solid.bounding.center),
    };
    let placed = match solid.body {
        Some(body) => Transform::load(isa, &motion_samples.poses[body.at()]).times(&own),
        None => own,
    };
    let rows = &mut scratch.solids[index];
    placed.translation.store(&mut rows[..3]);
    placed.rotation.store(&mut rows[3..]);
}

/// At most this far do the two clusters of a group come closer within each lane's interval.
#[inline(always)]
pub(crate) fn approach<I: Isa>(
    isa: I,
    scene: &CollisionScene,
    pairs: &PairSet,
    motion_samples: &MotionSamples,
    scratch: &mut BroadPhaseScratch,
    active: &ActiveGroup,
) -> I::F32 {
    if motion_samples.is_still() {
        return I::F32::constant(isa, 0.0);
    }
    let group = &scene.groups[active.group as usize];
    for (cluster, count) in [(group.first as usize, active.apart.0), (group.second as usize, active.apart.1)] {
        if count > 0 && scratch.fresh_clusters[cluster] != scratch.block {
            scratch.fresh_clusters[cluster] = scratch.block;
            accumulate(isa, scene, pairs, motion_samples, scratch, cluster);
        }
    }
    let moved = &scratch.moved;
    I::F32::load(isa, &moved[active.rows.0 as usize]) + I::F32::load(isa, &moved[active.rows.1 as usize])
}

/// As the velocity bound accumulates, in lanes.
#[inline(always)]
fn accumulate<I: Isa>(
    isa: I,
    scene: &CollisionScene,
    pairs: &PairSet,
    motion_samples: &MotionSamples,
    scratch: &mut BroadPhaseScratch,
    cluster: usize,
) {
    let chain = pairs.chains.chain_of(scene.clusters[cluster].body);
    let base = chain.start as usize + cluster;
    let center = Vector3::<I::F32>::load(isa, &scratch.centers[cluster]);
    let ball = I::F32::constant(isa, scene.clusters[cluster].ball.radius) + I::F32::load(isa, &scratch.slack);
    let mut moved = I::F32::constant(isa, 0.0);
    moved.store(&mut scratch.moved[base]);
    for place in 0..(chain.end - chain.start) as usize {
        let index = chain.start as usize + place;
        let joint = pairs.chains.links[index].joint;
        if motion_samples.joint_moves(joint) {
            let joint = joint as usize;
            let origin = Vector3::<I::F32>::load(isa, &motion_samples.poses[joint][9..]);
            let out = center.minus(origin);
            let lever = match scene.joints[joint].motion {
                JointType::FreeFlyer | JointType::Prismatic { .. } => out,
                JointType::Revolute { .. } | JointType::Planar => out.cross(Vector3::load(isa, &scratch.axes[joint])),
            };
            let radius = (lever.dot(lever).sqrt() + ball + moved).min(I::F32::splat(isa, motion_samples.reach[index]));
            let (turn, slide) =
                (I::F32::load(isa, &motion_samples.turns[joint]), I::F32::load(isa, &motion_samples.slides[joint]));
            moved = turn.mul_add(radius, moved) + slide;
        }
        moved.store(&mut scratch.moved[base + place + 1]);
    }
}
