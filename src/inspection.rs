//! What a model's geometry says about itself.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use foliate_components::Pose;
use foliate_components::robot::{DisabledPair, Robot};
use foliate_kernels::collision::{Ask, CollisionScene, PairId, PairRule, verdict::pair_clearance};
use foliate_kernels::kinematics::Kinematics;
use foliate_systems::random::{Purpose, stream};
use glam::DVec3;

/// Random configurations that are looked at.
const SAMPLES: u32 = 100;

/// Models with more shapes are not looked at: their pairs grow with the square.
const SHAPES: usize = 500;

/// Pairs of shapes that collide in every one of a hundred random configurations: a model in which they are not disabled
/// admits no motion at all. Neighbours of parts without an SRDF are left alone, as scenes leave them. `None` for models with
/// more than 500 shapes.
#[must_use]
pub fn always_colliding(robot: &Robot) -> Option<Vec<(String, String)>> {
    if robot.shapes.len() > SHAPES {
        return None;
    }
    let adjacent = |(first, second)| DisabledPair { first, second, reason: "adjacent".into() };
    let without = robot.parts.iter().filter(|part| !part.has_srdf);
    let ignored: Vec<_> = without.flat_map(|part| robot.neighbouring_links(part)).map(adjacent).collect();
    let scene = CollisionScene::new(robot, &PairRule { ignored: &ignored, ..PairRule::default() });
    let kinematics = Kinematics::new(robot);
    let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
    let mut q = robot.space.neutral();
    let mut suspects: Vec<PairId> = (0..scene.pairs().len() as u32).map(PairId).collect();
    for sample in 0..SAMPLES {
        if suspects.is_empty() {
            break;
        }
        robot.space.random(&mut stream(0, Purpose::Sample, 0, sample), &mut q);
        kinematics.forward(&q, &mut X_WJ);
        let touches = |pair: &PairId| {
            let clearance = pair_clearance(&scene, *pair, &X_WJ, Ask::exact(0.0), &mut DVec3::ZERO.clone());
            clearance <= 0.0 || clearance.is_nan()
        };
        suspects.retain(touches);
    }
    let name = |shape: foliate_components::robot::ShapeIndex| robot.shapes[shape.at()].name.clone();
    Some(suspects.iter().map(|p| scene.pairs()[p.at()]).map(|p| (name(p.first), name(p.second))).collect())
}
