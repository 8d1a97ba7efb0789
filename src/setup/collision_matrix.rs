//! Which links of a robot touch one another, and when: the table that MoveIt's Setup Assistant calls the self-collision matrix.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::solids::surface_points::PURPOSE;
use foliate_components::Pose;
use foliate_components::robot::{DisabledPair, LinkIndex, PartIndex, Robot};
use foliate_kernels::collision::{
    CollisionScene, DistanceQuery, PairId, PairRule, adjacent_links, contained, pair_clearance, surely_colliding,
};
use foliate_kernels::kinematics::Kinematics;
use foliate_systems::runtime::random::stream;
use glam::DVec3;
use std::collections::BTreeMap;

/// Share of the samples in which a pair touches that touches always; MoveIt's.
const ALWAYS: f64 = 0.95;

/// Samples after which a pair may be clear.
const FEW: u32 = 100;
/// Below this share a pair does not touch always.
const FAR_FROM_ALWAYS: f64 = 0.8;

/// Why two links of a robot need not be tested against each other, or must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairReason {
    /// One joint joins them, and they touch at every value of it.
    Adjacent,
    /// They touch in nearly every sample: they overlap by design.
    Always,
    /// They touch at the default configuration, and in some samples.
    Default,
    /// They touch in some samples, not at the default configuration.
    Sometimes,
    /// They touch in no sample.
    Never,
}

impl PairReason {
    /// The word for it in tables and files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Adjacent => "adjacent",
            Self::Always => "always",
            Self::Default => "default",
            Self::Sometimes => "sometimes",
            Self::Never => "never",
        }
    }
}

/// Two links and how often they touch.
#[derive(Clone, Debug, PartialEq)]
pub struct MatrixPair {
    /// One link.
    pub first: LinkIndex,
    /// The other.
    pub second: LinkIndex,
    /// Share of the samples in which they touch, 0 to 1, of those that were tested until the reason was clear; 1 of neighbours.
    pub share: f64,
    /// What follows from it.
    pub reason: PairReason,
}

/// The pairs of links with shapes of a robot that move against each other.
#[derive(Clone, Debug, PartialEq)]
pub struct CollisionMatrix {
    /// All of them, by reason, then by name.
    pub pairs: Vec<MatrixPair>,
    /// Random configurations that were drawn.
    pub samples: u32,
}

impl CollisionMatrix {
    /// The pairs that a scene leaves out: those that touch at every value of their joint or nearly always. Pairs that never touch stay
    /// tested, so that a proof covers them.
    pub fn ignored(&self) -> impl Iterator<Item = &MatrixPair> {
        self.pairs.iter().filter(|pair| pair.reason <= PairReason::Always)
    }
}

/// Settings of [`collision_matrix`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MatrixSettings {
    /// Random configurations to test.
    pub samples: u32,
    /// Seed of the random configurations.
    pub seed: u64,
}

impl Default for MatrixSettings {
    fn default() -> Self {
        Self { samples: 1000, seed: 0 }
    }
}

/// Tests the pairs of links at random configurations and at the default configuration (joints at zero, or at the bound nearest to it),
/// by the distances that plans and proofs use. Pairs that an SRDF disables are not among them. The same input gives the same table.
#[must_use]
pub fn collision_matrix(robot: &Robot, settings: MatrixSettings) -> CollisionMatrix {
    let scene = CollisionScene::new(robot, &PairRule::default());
    let kinematics = Kinematics::new(robot);
    let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
    let adjacent: Vec<DisabledPair> =
        (0..robot.parts.len() as u32).flat_map(|part| adjacent_links(robot, PartIndex(part))).collect();
    let links = pairs_of_links(&scene);
    let mut q = robot.space.neutral();
    robot.space.clamp(&mut q);
    kinematics.forward(&q, &mut X_WJ);
    let at_default: Vec<bool> = links.values().map(|pairs| touch(&scene, pairs, &X_WJ)).collect();
    let is_adjacent = |&(first, second): &(LinkIndex, LinkIndex)| {
        adjacent.iter().any(|p| (p.first, p.second) == (first, second) || (p.second, p.first) == (first, second))
    };
    let mut counts: Vec<Count> = links.keys().map(|key| Count::new(is_adjacent(key))).collect();
    for sample in 0..settings.samples {
        robot.space.random(&mut stream(settings.seed, PURPOSE, 1, sample), &mut q);
        kinematics.forward(&q, &mut X_WJ);
        for (count, pairs) in counts.iter_mut().zip(links.values()).filter(|(count, _)| !count.is_clear()) {
            count.samples += 1;
            count.touching += u32::from(touch(&scene, pairs, &X_WJ));
        }
    }
    let mut pairs: Vec<MatrixPair> = links
        .keys()
        .zip(counts)
        .zip(at_default)
        .map(|((&(first, second), count), at_default)| {
            let share = count.share();
            let reason = match () {
                () if count.is_adjacent => PairReason::Adjacent,
                () if share >= ALWAYS => PairReason::Always,
                () if at_default => PairReason::Default,
                () if count.touching > 0 => PairReason::Sometimes,
                () => PairReason::Never,
            };
            MatrixPair { first, second, share, reason }
        })
        .collect();
    let name = |link: LinkIndex| robot.links[link.at()].name.as_str();
    pairs.sort_by(|a, b| {
        a.reason.cmp(&b.reason).then_with(|| (name(a.first), name(a.second)).cmp(&(name(b.first), name(b.second))))
    });
    CollisionMatrix { pairs, samples: settings.samples }
}

/// How often a pair touches.
struct Count {
    /// It touches at every value of the joint between.
    is_adjacent: bool,
    samples: u32,
    touching: u32,
}

impl Count {
    fn new(is_adjacent: bool) -> Self {
        Self { is_adjacent, samples: 0, touching: 0 }
    }

    /// Whether more samples would not change the reason: of a pair that touches in all of the first 200, or in some and by far not in all
    /// of the first 100. Meshes that overlap take the longest.
    fn is_clear(&self) -> bool {
        let is_always = self.samples >= 2 * FEW && self.touching == self.samples;
        let is_sometimes = self.samples >= FEW && self.touching > 0 && self.share() < FAR_FROM_ALWAYS;
        self.is_adjacent || is_always || is_sometimes
    }

    fn share(&self) -> f64 {
        if self.is_adjacent { 1.0 } else { f64::from(self.touching) / f64::from(self.samples.max(1)) }
    }
}

/// The scene's pairs of shapes by pairs of links, the smaller link first.
fn pairs_of_links(scene: &CollisionScene) -> BTreeMap<(LinkIndex, LinkIndex), Vec<PairId>> {
    let mut links: BTreeMap<_, Vec<PairId>> = BTreeMap::new();
    for (index, pair) in scene.pairs().iter().enumerate() {
        let [a, b] = [pair.first, pair.second].map(|shape| scene.solids()[shape.at()].link);
        links.entry((a.min(b), a.max(b))).or_default().push(PairId(index as u32));
    }
    links
}

/// Whether some of the pairs touch where the bodies are.
pub(crate) fn touch(scene: &CollisionScene, pairs: &[PairId], X_WJ: &[Pose]) -> bool {
    pairs.iter().any(|&pair| {
        let [a, b] = [scene.pairs()[pair.at()].first, scene.pairs()[pair.at()].second].map(|shape| {
            let solid = &scene.solids()[shape.at()];
            let X_WB = solid.body.map_or(Pose::IDENTITY, |body| X_WJ[body.at()]);
            (X_WB.transform_point(solid.ball.center), solid.ball.radius)
        });
        if a.0.distance(b.0) > a.1 + b.1 {
            return false;
        }
        if surely_colliding(scene, pair, X_WJ).is_some() {
            return true;
        }
        let distance = pair_clearance(scene, pair, X_WJ, DistanceQuery::exact(0.0), &mut DVec3::ZERO.clone());
        // Compared so that NaN touches.
        let clear = distance > 0.0;
        !clear || contained(scene, pair, X_WJ)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::robot::model::{JointKind, JointModel, LinkModel, Model};
    use foliate_components::robot::shape::Geometry;
    use foliate_components::samples::models::fixed_robot;

    /// Three links in a row: the second turns about the end of the first, the third about the end of the second.
    fn arm(length: f64) -> Robot {
        let half = DVec3::new(length / 2.0, 0.02, 0.02);
        let link = |name: &str| LinkModel {
            name: name.into(),
            shapes: vec![(Pose::from_translation(DVec3::X * half.x), Geometry::Box { half_extents: half })],
            inertial: None,
        };
        let joint = |parent: usize| JointModel {
            name: format!("j{parent}"),
            kind: JointKind::Revolute,
            parent,
            child: parent + 1,
            parent_from_joint: Pose::from_translation(DVec3::X * length),
            axis: DVec3::Z,
            limits: (-3.1, 3.1),
            velocity_limit: None,
            mimic: None,
        };
        let model =
            Model { links: ["a", "b", "c"].map(link).to_vec(), joints: vec![joint(0), joint(1)], ..Model::default() };
        Robot::compose(&[(&model, fixed_robot("arm", Pose::identity()))]).unwrap()
    }

    #[test]
    fn neighbours_touch_and_others_sometimes() {
        let robot = arm(0.3);
        let matrix = collision_matrix(&robot, MatrixSettings::default());
        let reasons: Vec<_> = matrix.pairs.iter().map(|p| (p.first.0, p.second.0, p.reason)).collect();
        let (adjacent, sometimes) = (PairReason::Adjacent, PairReason::Sometimes);
        assert_eq!(reasons, [(0, 1, adjacent), (1, 2, adjacent), (0, 2, sometimes)]);
        assert_eq!(matrix.ignored().count(), 2);
        assert_eq!(matrix, collision_matrix(&robot, MatrixSettings::default()));
        let other = collision_matrix(&robot, MatrixSettings { seed: 1, ..MatrixSettings::default() });
        assert_ne!(matrix.pairs[2].share, other.pairs[2].share);
    }

    #[test]
    fn what_overlaps_by_design_touches_always() {
        // Links so short that the first and the third overlap wherever the joints are.
        let matrix = collision_matrix(&arm(0.005), MatrixSettings::default());
        assert!(matrix.pairs.iter().any(|p| (p.first.0, p.second.0, p.reason) == (0, 2, PairReason::Always)));
    }
}
