//! How far two bodies can come closer along a straight motion.
//!
//! V = Σ |Δᵢ| rᵢ over the joints between the two bodies in the attachment tree (DESIGN §5.5; HPP's `velocityBound`,
//! hpp-notes card L), where rᵢ is at least the distance from joint i's axis to any point of the moving body over the whole
//! interval. Two bounds on rᵢ are at hand, and the smaller counts: the static reach of the chain beyond the joint, and the
//! distance at the sample plus what the joints beyond it can add within the interval.

use super::attachment::Chain;
use super::bounds::Ball;
use super::pairs::{ActiveGroup, PairSet};
use super::scene::{CollisionScene, PairId, SceneJoint};
use super::scratch::place_balls;
use foliate_components::Pose;
use foliate_components::robot::Motion;
use glam::DVec3;

/// Bounds for one straight motion; buffers are reused from motion to motion.
#[derive(Clone, Debug, Default)]
pub struct MotionBound {
    /// By joint: |Δ| of its rotation over the whole motion, radians.
    turn: Vec<f64>,
    /// By joint: |Δ| of its translation, metres.
    slide: Vec<f64>,
    /// By joint: how far from zero its translation may be during the motion, metres.
    travel: Vec<f64>,
    /// By chain link: reach of the body beyond that joint, metres.
    reach: Vec<f64>,
    /// By joint: origin and axis in the world at the sample.
    origins: Vec<(DVec3, DVec3)>,
    /// By chain link, and one more per cluster: displacement that the joints from the body up to there can cause within the
    /// interval, metres.
    moved: Vec<f64>,
    /// By cluster: the sample for which `moved` was computed.
    fresh: Vec<u32>,
    sample: u32,
    half_width: f64,
}

impl MotionBound {
    /// Starts a motion from `q` by the velocity `delta` (the configuration space's difference) in unit time.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn begin(&mut self, scene: &CollisionScene, pairs: &PairSet, q: &[f64], delta: &[f64]) {
        let joints = scene.joints.len();
        self.turn.clear();
        self.slide.clear();
        self.travel.clear();
        for joint in &scene.joints {
            let rate = JointRate::of(joint, q, delta);
            self.turn.push(rate.turn);
            self.slide.push(rate.slide);
            self.travel.push(rate.travel);
        }
        self.reach.clear();
        self.reach.resize(pairs.tree.links.len(), 0.0);
        for cluster in &scene.clusters {
            let chain = pairs.tree.chain_of(cluster.body);
            let mut travel = 0.0;
            for index in chain.start as usize..chain.end as usize {
                let link = &pairs.tree.links[index];
                self.reach[index] = link.reach + travel;
                travel += self.travel[link.joint as usize];
            }
        }
        self.origins.clear();
        self.origins.resize(joints, (DVec3::ZERO, DVec3::ZERO));
        self.moved.clear();
        self.moved.resize(pairs.tree.links.len() + scene.clusters.len(), 0.0);
        self.fresh.clear();
        self.fresh.resize(scene.clusters.len(), 0);
        self.sample = 0;
    }

    /// Goes to the interval of parameters within `half_width` of a sample at which the bodies have the poses `X_WJ`.
    ///
    /// # Panics
    /// If `X_WJ` is too short.
    pub fn look_at(&mut self, scene: &CollisionScene, X_WJ: &[Pose], half_width: f64) {
        self.sample += 1;
        self.half_width = half_width;
        for (index, joint) in scene.joints.iter().enumerate().filter(|&(i, _)| self.turn[i] > 0.0) {
            let axis = match joint.motion {
                Motion::Revolute { axis } => X_WJ[index].rotation * axis,
                Motion::Planar => X_WJ[index].rotation * DVec3::Z,
                Motion::Prismatic { .. } | Motion::FreeFlyer => DVec3::ZERO,
            };
            self.origins[index] = (X_WJ[index].translation, axis);
        }
    }

    /// At most this far, in metres, do the shapes of a pair come closer or move apart anywhere in the interval, compared to
    /// the sample; 0 for pairs that do not move on the leaf. Of use for looking at bounds: the certificate asks by group.
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

    /// At most this far do the two clusters of a group come closer (or move apart) anywhere in the interval. `balls` are
    /// the clusters' bounding balls in the world at the sample.
    #[inline]
    pub(super) fn approach(
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

    fn displacement(
        &mut self,
        scene: &CollisionScene,
        pairs: &PairSet,
        cluster: usize,
        ball: &Ball,
        count: u32,
    ) -> f64 {
        let chain = pairs.tree.chain_of(scene.clusters[cluster].body);
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
            let joint = pairs.tree.links[index].joint as usize;
            if self.turn[joint] > 0.0 {
                let (origin, axis) = self.origins[joint];
                let out = ball.center - origin;
                let here = match scene.joints[joint].motion {
                    Motion::FreeFlyer | Motion::Prismatic { .. } => out.length(),
                    Motion::Revolute { .. } | Motion::Planar => out.cross(axis).length(),
                };
                let radius = self.reach[index].min(here + ball.radius + moved);
                moved += self.half_width * self.turn[joint] * radius;
            }
            moved += self.half_width * self.slide[joint];
            self.moved[base + place + 1] = moved;
        }
    }
}

/// How much one joint moves.
struct JointRate {
    turn: f64,
    slide: f64,
    travel: f64,
}

impl JointRate {
    fn of(joint: &SceneJoint, q: &[f64], delta: &[f64]) -> Self {
        let vector = |values: &[f64], i: usize, n: usize| {
            DVec3::new(values[i], values[i + 1], if n > 2 { values[i + 2] } else { 0.0 })
        };
        let farthest = |start: DVec3, by: DVec3| start.length().max((start + by).length());
        let (i, j) = (joint.q, joint.v);
        match joint.motion {
            Motion::Revolute { .. } => Self { turn: (joint.multiplier * delta[j]).abs(), slide: 0.0, travel: 0.0 },
            Motion::Prismatic { .. } => {
                let value = |x: f64| (joint.multiplier * x + joint.constant).abs();
                let travel = value(q[i]).max(value(q[i] + delta[j]));
                Self { turn: 0.0, slide: (joint.multiplier * delta[j]).abs(), travel }
            }
            Motion::Planar => {
                let (start, by) = (vector(q, i, 2), vector(delta, j, 2));
                Self { turn: delta[j + 2].abs(), slide: by.length(), travel: farthest(start, by) }
            }
            Motion::FreeFlyer => {
                let (start, by) = (vector(q, i, 3), vector(delta, j, 3));
                Self { turn: vector(delta, j + 3, 3).length(), slide: by.length(), travel: farthest(start, by) }
            }
        }
    }
}
