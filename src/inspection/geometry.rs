//! What a model's geometry says about itself: which pairs of shapes are tested, and which collide wherever its joints are.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use foliate_components::Pose;
use foliate_components::coverage::{LeftOutPair, PairCounts};
use foliate_components::robot::{DisabledPair, PartIndex, Robot, ShapeIndex};
use foliate_kernels::collision::{CollisionScene, DistanceQuery, PairId, PairRule, adjacent_links, pair_clearance};
use foliate_kernels::kinematics::Kinematics;
use foliate_systems::runtime::random::{Purpose, stream};
use glam::DVec3;

/// Random configurations that are tested.
const SAMPLES: u32 = 100;

/// Models with more shapes are not tested: their pairs grow with the square.
const SHAPES: usize = 500;

/// What is known of the pairs of a model's shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// How many pairs a scene would test, and how many it would leave out, by reason.
    pub counts: PairCounts,
    /// Those that it would leave out.
    pub left_out: Vec<LeftOutPair>,
    /// Those of them that an SRDF or the rule of neighbours leaves out although they do not touch at the neutral configuration.
    pub apart: Vec<LeftOutPair>,
    /// Pairs of shapes that collide in every one of a hundred random configurations: where they are not left out the model
    /// admits no motion at all.
    pub always_colliding: Vec<(ShapeIndex, ShapeIndex)>,
}

/// Tests the pairs of a model's shapes as scenes do by default: in parts without an SRDF, links that one joint
/// joins and that touch wherever it is are left alone. `None` for models with more than 500 shapes.
#[must_use]
pub fn inspect_pairs(robot: &Robot) -> Option<Inspection> {
    if robot.shapes.len() > SHAPES {
        return None;
    }
    let without = robot.parts.iter().enumerate().filter(|(_, part)| !part.has_srdf);
    let ignored: Vec<DisabledPair> =
        without.flat_map(|(part, _)| adjacent_links(robot, PartIndex(part as u32))).collect();
    let rule = PairRule { ignored: &ignored, ..PairRule::default() };
    let scene = CollisionScene::new(robot, &rule);
    let left_out = scene.left_out(robot, &rule);
    let apart = apart(robot, &scene, &left_out, &robot.space.neutral());
    Some(Inspection { counts: scene.counts(), apart, left_out, always_colliding: always_colliding(robot, &scene) })
}

/// The pairs that a file leaves out although they do not touch at a configuration: a warning.
///
/// # Panics
/// If `q` is not a configuration of the robot.
#[must_use]
pub fn apart(robot: &Robot, scene: &CollisionScene, left_out: &[LeftOutPair], q: &[f64]) -> Vec<LeftOutPair> {
    let kinematics = Kinematics::new(robot);
    let X_WJ = kinematics.poses(q);
    let decided = left_out.iter().filter(|pair| pair.why.is_a_decision());
    decided.filter(|pair| !scene.touch(pair.first, pair.second, &X_WJ)).copied().collect()
}

fn always_colliding(robot: &Robot, scene: &CollisionScene) -> Vec<(ShapeIndex, ShapeIndex)> {
    let kinematics = Kinematics::new(robot);
    let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
    let mut q = robot.space.neutral();
    let mut suspects: Vec<PairId> = (0..scene.pairs().len() as u32).map(PairId).collect();
    for sample in 0..SAMPLES {
        if suspects.is_empty() {
            break;
        }
        robot.space.random(&mut stream(0, Purpose::SAMPLE, 0, sample), &mut q);
        kinematics.forward(&q, &mut X_WJ);
        let touches = |pair: &PairId| {
            let clearance = pair_clearance(scene, *pair, &X_WJ, DistanceQuery::exact(0.0), &mut DVec3::ZERO.clone());
            clearance <= 0.0 || clearance.is_nan()
        };
        suspects.retain(touches);
    }
    suspects.iter().map(|p| scene.pairs()[p.at()]).map(|pair| (pair.first, pair.second)).collect()
}
