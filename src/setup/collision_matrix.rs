//! Which links of a robot touch one another, and when: the table that MoveIt's Setup Assistant calls the self-collision matrix.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::solids::surface_points::PURPOSE;
use foliate_components::Pose;
use foliate_components::robot::{DisabledPair, JointIndex, JointType, LinkIndex, PartIndex, Robot};
use foliate_kernels::collision::{
    CollisionScene, DistanceQuery, PairId, PairRule, adjacent_links, contained, pair_clearance, surely_colliding,
};
use foliate_kernels::kinematics::Kinematics;
use foliate_systems::runtime::random::stream;
use glam::DVec3;
use std::collections::BTreeMap;

/// Share of the samples in which a pair touches that touches always; MoveIt's.
const ALWAYS: f64 = 0.95;

/// Segments of a telescope that are nearer than this slide in one another, metres.
const PLAY: f64 = 1e-3;

/// Share of the samples above which a pair that touches at the default configuration is taken to overlap by design.
const MOSTLY: f64 = 0.5;

/// Sine of the angle below which two directions are one.
const PARALLEL: f64 = 1e-3;

/// Samples after which a pair may be clear.
const FEW: u32 = 100;
/// Below this share a pair does not touch always.
const FAR_FROM_ALWAYS: f64 = 0.8;

/// Why two links of a robot need not be tested against each other, or must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairReason {
    /// One joint joins them, and they touch at every value of it.
    Adjacent,
    /// They are segments of one telescope: two or more joints in a row that slide along one direction move them. At the default
    /// configuration or in some sample they touch or are nearer than 1 mm, as tubes in one another are.
    Telescope,
    /// They touch in nearly every sample: they overlap by design.
    Always,
    /// They touch at the default configuration and in more than half of the samples: the model's shapes overlap where its links do not.
    Mostly,
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
            Self::Telescope => "telescope",
            Self::Always => "always",
            Self::Mostly => "mostly",
            Self::Default => "default",
            Self::Sometimes => "sometimes",
            Self::Never => "never",
        }
    }

    /// Whether the model is made so that they touch; a scene leaves such a pair out.
    #[must_use]
    pub fn is_by_design(self) -> bool {
        self <= Self::Mostly
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
    /// The pairs that a scene leaves out: those that touch at every value of their joint, segments of a telescope, and those that touch
    /// nearly always, or by default and mostly. Pairs that never touch stay tested, so that a proof covers them.
    pub fn ignored(&self) -> impl Iterator<Item = &MatrixPair> {
        self.pairs.iter().filter(|pair| pair.reason.is_by_design())
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
    let is_adjacent = |&(first, second): &(LinkIndex, LinkIndex)| {
        adjacent.iter().any(|p| (p.first, p.second) == (first, second) || (p.second, p.first) == (first, second))
    };
    let telescopes = telescopes(robot);
    let is_nested = |first: LinkIndex, second: LinkIndex| {
        is_in_one_telescope(robot, &telescopes, [first, second].map(|link| robot.links[link.at()].joint))
    };
    let plays: Vec<f64> = links.keys().map(|&(a, b)| if is_nested(a, b) { PLAY } else { 0.0 }).collect();
    let at_default: Vec<bool> =
        links.values().zip(&plays).map(|(pairs, &play)| touch(&scene, pairs, &X_WJ, play)).collect();
    let mut counts: Vec<Count> = links.keys().map(|key| Count::new(is_adjacent(key))).collect();
    for sample in 0..settings.samples {
        robot.space.random(&mut stream(settings.seed, PURPOSE, 1, sample), &mut q);
        kinematics.forward(&q, &mut X_WJ);
        let pairs = counts.iter_mut().zip(links.values().zip(&plays));
        for (count, (pairs, &play)) in pairs.filter(|(count, _)| !count.is_clear()) {
            count.samples += 1;
            count.touching += u32::from(touch(&scene, pairs, &X_WJ, play));
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
                () if (at_default || count.touching > 0) && is_nested(first, second) => PairReason::Telescope,
                () if share >= ALWAYS => PairReason::Always,
                () if at_default && share > MOSTLY => PairReason::Mostly,
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

/// Of each joint, the first one of the telescope that it extends: of two or more sliding joints in a row along one direction.
fn telescopes(robot: &Robot) -> Vec<Option<JointIndex>> {
    let mut firsts: Vec<Option<JointIndex>> = vec![None; robot.joints.len()];
    for (at, joint) in robot.joints.iter().enumerate() {
        let JointType::Prismatic { axis } = joint.motion else { continue };
        let Some(parent) = joint.parent else { continue };
        let JointType::Prismatic { axis: before } = robot.joints[parent.at()].motion else { continue };
        // The joint between slides, so that directions in the parent's frame stay.
        if (joint.parent_from_joint.rotation * axis).cross(before).length() > PARALLEL {
            continue;
        }
        let first = *firsts[parent.at()].get_or_insert(parent);
        firsts[at] = Some(first);
    }
    firsts
}

/// Whether one of two bodies carries the other by joints of one telescope.
fn is_in_one_telescope(
    robot: &Robot,
    telescopes: &[Option<JointIndex>],
    [first, second]: [Option<JointIndex>; 2],
) -> bool {
    let carries = |base: Option<JointIndex>, tip: Option<JointIndex>| {
        let Some(telescope) = tip.and_then(|joint| telescopes[joint.at()]) else { return false };
        let above = std::iter::successors(tip, |joint| robot.joints[joint.at()].parent);
        let mut segments = above.take_while(|joint| telescopes[joint.at()] == Some(telescope));
        segments.any(|joint| robot.joints[joint.at()].parent == base)
    };
    carries(first, second) || carries(second, first)
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

/// Whether some of the pairs touch where the bodies are, or are nearer than `play`, metres.
pub(crate) fn touch(scene: &CollisionScene, pairs: &[PairId], X_WJ: &[Pose], play: f64) -> bool {
    pairs.iter().any(|&pair| {
        let [a, b] = [scene.pairs()[pair.at()].first, scene.pairs()[pair.at()].second].map(|shape| {
            let solid = &scene.solids()[shape.at()];
            let X_WB = solid.body.map_or(Pose::IDENTITY, |body| X_WJ[body.at()]);
            (X_WB.transform_point(solid.ball.center), solid.ball.radius)
        });
        if a.0.distance(b.0) > a.1 + b.1 + play {
            return false;
        }
        if surely_colliding(scene, pair, X_WJ).is_some() {
            return true;
        }
        let distance = pair_clearance(scene, pair, X_WJ, DistanceQuery::exact(play), &mut DVec3::ZERO.clone());
        // Compared so that NaN touches.
        let clear = distance > 0.0 && distance >= play;
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
        Robot::compose(&[(&arm_model(length), fixed_robot("arm", Pose::identity()))]).unwrap()
    }

    fn arm_model(length: f64) -> Model {
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
        Model { links: ["a", "b", "c"].map(link).to_vec(), joints: vec![joint(0), joint(1)], ..Model::default() }
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

    /// A lift with two tubes, the first of which slides beside the lift along x, with 0.5 mm between, and the second along `axis` beside
    /// the first. At zero the second lies in the lift's own box.
    fn tubes(axis: DVec3) -> Robot {
        let half_extents = DVec3::new(0.2, 0.02, 0.02);
        let link = |name: &str| LinkModel {
            name: name.into(),
            shapes: vec![(Pose::identity(), Geometry::Box { half_extents })],
            inertial: None,
        };
        let slide = |parent: usize, y: f64, axis: DVec3| JointModel {
            name: format!("j{parent}"),
            kind: JointKind::Prismatic,
            parent,
            child: parent + 1,
            parent_from_joint: Pose::from_translation(DVec3::Y * y),
            axis,
            limits: (0.0, 0.5),
            velocity_limit: None,
            mimic: None,
        };
        let joints = vec![slide(0, 1.0, DVec3::Z), slide(1, 0.0405, DVec3::X), slide(2, -0.0405, axis)];
        let links = ["base", "lift", "first", "second"].map(link).to_vec();
        let model = Model { links, joints, ..Model::default() };
        Robot::compose(&[(&model, fixed_robot("arm", Pose::identity()))]).unwrap()
    }

    #[test]
    fn segments_of_a_telescope_are_left_out() {
        let reasons = |axis: DVec3| -> Vec<_> {
            let matrix = collision_matrix(&tubes(axis), MatrixSettings::default());
            let pairs = matrix.pairs.iter().filter(|p| p.reason != PairReason::Never);
            pairs.map(|p| (p.first.0, p.second.0, p.reason)).collect()
        };
        let telescope = PairReason::Telescope;
        for axis in [DVec3::X, DVec3::NEG_X] {
            assert_eq!(reasons(axis), [(2, 3, telescope), (1, 2, telescope), (1, 3, telescope)]);
        }
        // What slides across is no segment: it may collide.
        assert_eq!(reasons(DVec3::Z), [(1, 3, PairReason::Default)]);
    }

    #[test]
    fn shapes_that_overlap_by_default_and_mostly_are_left_out() {
        let cube = |half: f64| Geometry::Box { half_extents: DVec3::splat(half) };
        let reason = |half: f64| {
            let mut model = arm_model(0.05);
            model.links[2].shapes[0] = (Pose::from_translation(DVec3::X * -0.05), cube(half));
            let robot = Robot::compose(&[(&model, fixed_robot("arm", Pose::identity()))]).unwrap();
            let matrix = collision_matrix(&robot, MatrixSettings::default());
            let pair = matrix.pairs.iter().find(|p| (p.first.0, p.second.0) == (0, 2)).unwrap();
            (pair.reason, pair.share, matrix.ignored().any(|ignored| ignored == pair))
        };
        let (mostly, share, is_left_out) = reason(0.05);
        assert!(mostly == PairReason::Mostly && share > 0.5 && is_left_out, "{share}");
        let (by_default, share, is_left_out) = reason(0.02);
        assert!(by_default == PairReason::Default && share < 0.5 && !is_left_out, "{share}");
    }
}
