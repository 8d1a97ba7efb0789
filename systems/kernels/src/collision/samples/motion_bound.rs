//! How far two bodies can come closer along a motion.
//!
//! V = Σ |Δᵢ| rᵢ over the joints between the two bodies in the attachment tree (HPP's `velocityBound`), where rᵢ is at least the distance from joint i's axis to any point of the moving body over the whole
//! interval. There are two bounds on rᵢ, and the smaller counts: the static reach of the chain beyond the joint, and the
//! distance at the sample plus what the joints beyond it can add within the interval.
//!
//! Where a direction n separates the two, less is enough ([`MotionBound::of_pair_along`]): only the speed along n at the
//! sample counts in first order, and the rest is ½h² sup‖ẍ‖ with
//! ‖ẍ‖ ≤ Σⱼ |Δⱼ| rⱼ (|Δⱼ| + 2 Σᵢ |Δᵢ|) over the joints i that carry joint j. Bodies that slide past each other need far
//! fewer samples so.
//!
//! On a curve |Δᵢ| is the farthest that joint i gets from the sample within the interval. For ‖ẍ‖ it is the largest |q̇ᵢ|, and
//! Σⱼ |q̈ⱼ| rⱼ is added.

use crate::collision::samples::joint_rate::JointRate;
use crate::collision::scene::body_chains::Chain;
use crate::collision::scene::collision_scene::{CollisionScene, PairId};
use crate::collision::scene::pair_query::{place_balls, solid_balls};
use crate::collision::scene::pair_set::{ActiveGroup, PairSet};
use crate::collision::solids::volumes::Ball;
use crate::curve::cubic::Cubic;
use foliate_components::Pose;
use foliate_components::robot::JointType;
use glam::DVec3;

/// Radians turned by all joints together within half an interval, beyond which directions are not used.
pub(crate) const FINE: f64 = 0.8;

/// Bounds for one motion; buffers are reused from motion to motion.
#[derive(Clone, Debug, Default)]
pub struct MotionBound {
    /// By joint: its straight motion; empty on a curve.
    straight: Vec<JointRate>,
    /// By joint: how it moves within the interval.
    within: Vec<JointRate>,
    /// By joint: how far from zero its translation may be during the motion, metres.
    travel: Vec<f64>,
    /// By joint: how fast it turns at the sample, in the world.
    world_spin: Vec<DVec3>,
    /// By joint: how fast it slides at the sample, in the world.
    world_drift: Vec<DVec3>,
    /// By chain link: reach of the body beyond that joint, metres.
    reach: Vec<f64>,
    /// By chain link: at least the distance of the body's points from that joint's axis within the interval, metres.
    radius: Vec<f64>,
    /// By joint: origin and axis in the world at the sample.
    origins: Vec<(DVec3, DVec3)>,
    /// By chain link, and one more per cluster: displacement that the joints from the body up to there can cause within the
    /// interval, metres.
    moved: Vec<f64>,
    /// By cluster: the sample for which `moved` was computed.
    fresh: Vec<u32>,
    sample: u32,
}

impl MotionBound {
    /// Starts a straight motion from `q` by the velocity `delta` (the configuration space's difference) in unit time.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn begin(&mut self, scene: &CollisionScene, pairs: &PairSet, q: &[f64], delta: &[f64]) {
        self.clear();
        for joint in scene.joints.iter() {
            let (rate, travel) = JointRate::straight(joint, q, delta);
            self.straight.push(rate);
            self.travel.push(travel);
        }
        self.make_room(scene, pairs);
    }

    /// Starts a piece of a curve over u ∈ [0, 1], by coordinate.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn begin_curve(&mut self, scene: &CollisionScene, pairs: &PairSet, cubics: &[Cubic]) {
        self.clear();
        self.travel.extend(scene.joints.iter().map(|joint| joint.moves_along(cubics).2));
        self.make_room(scene, pairs);
    }

    fn clear(&mut self) {
        self.straight.clear();
        self.travel.clear();
    }

    fn make_room(&mut self, scene: &CollisionScene, pairs: &PairSet) {
        let joints = scene.joints.len();
        self.radius.clear();
        self.radius.resize(pairs.chains.links.len(), 0.0);
        self.world_spin.clear();
        self.world_spin.resize(joints, DVec3::ZERO);
        self.world_drift.clear();
        self.world_drift.resize(joints, DVec3::ZERO);
        self.reach.clear();
        self.reach.resize(pairs.chains.links.len(), 0.0);
        for cluster in &scene.clusters {
            let chain = pairs.chains.chain_of(cluster.body);
            let mut travel = 0.0;
            for index in chain.start as usize..chain.end as usize {
                let link = &pairs.chains.links[index];
                self.reach[index] = link.reach + travel;
                travel += self.travel[link.joint as usize];
            }
        }
        self.origins.clear();
        self.origins.resize(joints, (DVec3::ZERO, DVec3::ZERO));
        self.moved.clear();
        self.moved.resize(pairs.chains.links.len() + scene.clusters.len(), 0.0);
        self.fresh.clear();
        self.fresh.resize(scene.clusters.len(), 0);
        self.sample = 0;
    }

    /// Goes to the interval of parameters within `half_width` of a sample at which the bodies have the poses `X_WJ`.
    ///
    /// # Panics
    /// If `X_WJ` is too short.
    pub fn look_at(&mut self, scene: &CollisionScene, X_WJ: &[Pose], half_width: f64) {
        self.within.clear();
        self.within.extend(self.straight.iter().map(|rate| rate.over(half_width)));
        self.settle(scene, X_WJ);
    }

    /// Goes to the parameters within `half_width` of `t` on the piece with which [`Self::begin_curve`] began, where the bodies
    /// have the poses `X_WJ` at `t`.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn look_at_curve(
        &mut self,
        scene: &CollisionScene,
        X_WJ: &[Pose],
        cubics: &[Cubic],
        (t, half_width): (f64, f64),
    ) {
        self.within.clear();
        self.within.extend(scene.joints.iter().map(|joint| JointRate::on_curve(joint, cubics, t, half_width)));
        self.settle(scene, X_WJ);
    }

    fn settle(&mut self, scene: &CollisionScene, X_WJ: &[Pose]) {
        self.sample += 1;
        for (index, joint) in scene.joints.iter().enumerate().filter(|&(i, _)| self.within[i].turn > 0.0) {
            let axis = match joint.motion {
                JointType::Revolute { axis } => X_WJ[index].rotation * axis,
                JointType::Planar => X_WJ[index].rotation * DVec3::Z,
                JointType::Prismatic { .. } | JointType::FreeFlyer => DVec3::ZERO,
            };
            self.origins[index] = (X_WJ[index].translation, axis);
            self.world_spin[index] = X_WJ[index].rotation * self.within[index].spin;
        }
        for (index, joint) in scene.joints.iter().enumerate().filter(|&(i, _)| self.within[i].slide > 0.0) {
            let along = joint.X_PJ.rotation * self.within[index].drift;
            self.world_drift[index] = joint.parent.map_or(along, |p| X_WJ[p.at()].rotation * along);
        }
    }

    /// At most this far, in metres, do the shapes of a pair come closer or move apart anywhere in the interval, compared to
    /// the sample; 0 for pairs that do not move on the leaf. For inspecting bounds: the certificate uses groups.
    ///
    /// # Panics
    /// If `pair` is not the scene's, or `X_WJ` is too short.
    pub fn of_pair(&mut self, scene: &CollisionScene, pairs: &PairSet, pair: PairId, X_WJ: &[Pose]) -> f64 {
        let mut balls = Vec::new();
        place_balls(scene, X_WJ, &mut balls);
        let holds = |active: &&ActiveGroup| {
            let group = &scene.groups[active.group as usize];
            (group.start..group.end).contains(&pair.0)
        };
        pairs.moving.iter().find(holds).map_or(0.0, |active| self.approach(scene, pairs, active, &balls))
    }

    /// As [`Self::of_pair`], for the gap along the unit vector `n`, which is given in the world at the sample and fixed in
    /// the frame of the two bodies' nearest common ancestor.
    ///
    /// # Panics
    /// If `pair` is not the scene's, or `X_WJ` is too short.
    pub fn of_pair_along(
        &mut self,
        scene: &CollisionScene,
        pairs: &PairSet,
        pair: PairId,
        X_WJ: &[Pose],
        n: DVec3,
    ) -> f64 {
        self.of_pair(scene, pairs, pair, X_WJ);
        let holds = |active: &&ActiveGroup| {
            let group = &scene.groups[active.group as usize];
            (group.start..group.end).contains(&pair.0)
        };
        let balls = solid_balls(scene, pair, X_WJ);
        pairs.moving.iter().find(holds).map_or(0.0, |active| self.approach_along(scene, pairs, active, balls, n))
    }

    /// At most this far do the two clusters of a group come closer (or move apart) anywhere in the interval. `balls` are
    /// the clusters' bounding balls in the world at the sample.
    #[inline]
    pub(crate) fn approach(
        &mut self,
        scene: &CollisionScene,
        pairs: &PairSet,
        active: &ActiveGroup,
        balls: &[Ball],
    ) -> f64 {
        let group = &scene.groups[active.group as usize];
        let mut of = |cluster: u32, count: u32| match count {
            0 => 0.0,
            _ => self.displacement(scene, pairs, cluster as usize, &balls[cluster as usize], count),
        };
        of(group.first, active.apart.0) + of(group.second, active.apart.1)
    }

    /// At most this far does the gap of a group's shapes along the unit vector `n` shrink anywhere in the interval, where `n`
    /// is given in the world at the sample and fixed in the frame of the nearest common ancestor. `balls` hold the two
    /// shapes in the world at the sample. To be called after [`Self::approach`] for the group.
    #[inline]
    pub(crate) fn approach_along(
        &self,
        scene: &CollisionScene,
        pairs: &PairSet,
        active: &ActiveGroup,
        balls: [Ball; 2],
        n: DVec3,
    ) -> f64 {
        let group = &scene.groups[active.group as usize];
        let side = |cluster: u32, count: u32, ball: Ball| {
            let chain = pairs.chains.chain_of(scene.clusters[cluster as usize].body);
            self.side(pairs, chain, count as usize, ball, n)
        };
        let (a, b) = (side(group.first, active.apart.0, balls[0]), side(group.second, active.apart.1, balls[1]));
        let speed = (a.speed - b.speed).abs() + a.spread + b.spread;
        speed + 0.5 * (a.acceleration + b.acceleration)
    }

    /// How the points within a ball move along `n`, by the `count` most distal joints of a chain.
    fn side(&self, pairs: &PairSet, chain: Chain, count: usize, ball: Ball, n: DVec3) -> Side {
        let start = chain.start as usize;
        let links = &pairs.chains.links[start..start + count];
        let mut carried: f64 = links.iter().map(|l| self.within[l.joint as usize].turning.0).sum();
        let mut side = Side { speed: 0.0, spread: 0.0, acceleration: 0.0 };
        // n · (ω × (x − o)) changes by (n × ω) · δ when x changes by δ.
        let mut gradient = DVec3::ZERO;
        for (link, radius) in links.iter().zip(&self.radius[start..]) {
            let joint = link.joint as usize;
            let JointRate { turn, slide, turning: (fastest, bend), sliding, .. } = self.within[joint];
            if turn > 0.0 {
                carried = (carried - fastest).max(0.0);
                let lever = n.cross(self.world_spin[joint]);
                side.speed += lever.dot(ball.center - self.origins[joint].0);
                gradient += lever;
                side.acceleration += fastest * radius * (fastest + 2.0 * carried) + bend * radius;
            }
            if slide > 0.0 {
                side.speed += n.dot(self.world_drift[joint]);
                side.acceleration += 2.0 * sliding.0 * carried + sliding.1;
            }
        }
        side.spread += gradient.length() * ball.radius;
        side
    }

    fn displacement(
        &mut self,
        scene: &CollisionScene,
        pairs: &PairSet,
        cluster: usize,
        ball: &Ball,
        count: u32,
    ) -> f64 {
        let chain = pairs.chains.chain_of(scene.clusters[cluster].body);
        // Chains stand in the order of clusters, and each has one more number than links, so that "no joint" has a place.
        let base = chain.start as usize + cluster;
        if self.fresh[cluster] != self.sample {
            self.fresh[cluster] = self.sample;
            self.accumulate(scene, pairs, chain, base, ball);
        }
        self.moved[base + count as usize]
    }

    fn accumulate(&mut self, scene: &CollisionScene, pairs: &PairSet, chain: Chain, base: usize, ball: &Ball) {
        let mut moved = 0.0;
        self.moved[base] = 0.0;
        for (place, index) in (chain.start as usize..chain.end as usize).enumerate() {
            let joint = pairs.chains.links[index].joint as usize;
            let JointRate { turn, slide, .. } = self.within[joint];
            if turn > 0.0 {
                let (origin, axis) = self.origins[joint];
                let out = ball.center - origin;
                let here = match scene.joints[joint].motion {
                    JointType::FreeFlyer | JointType::Prismatic { .. } => out.length(),
                    JointType::Revolute { .. } | JointType::Planar => out.cross(axis).length(),
                };
                let radius = self.reach[index].min(here + ball.radius + moved);
                self.radius[index] = radius;
                moved += turn * radius;
            }
            moved += slide;
            self.moved[base + place + 1] = moved;
        }
    }
}

/// Motion of some points along a direction, for half of the interval as the unit of time: speed at the middle, metres; how much
/// more any of them may have; and a bound on the acceleration in any direction.
struct Side {
    speed: f64,
    spread: f64,
    acceleration: f64,
}
