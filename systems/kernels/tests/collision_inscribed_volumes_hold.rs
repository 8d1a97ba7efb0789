//! What inscribed volumes call a collision is one for the exact queries too, one pair at a time and in lanes.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{always_colliding, at, bench, box_mesh, compose, cuboid, place, placed, random_configuration};
use collision_models::{random_geometry, random_pose, random_vector, single, star};
use foliate_components::Pose;
use foliate_components::robot::shape::{Geometry, Mesh};
use foliate_components::robot::{PartKind, Robot, RootJoint};
use foliate_kernels::collision::{
    CollisionScene, CollisionScratch, DistanceQuery, PairId, PairRule, PairSet, Verdicts, contained, pair_clearance,
    surely_colliding,
};
use foliate_kernels::kinematics::Kinematics;
use foliate_kernels::lanes::Level;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// Two solids adrift.
fn couple(a: &Geometry, b: &Geometry, rng: &mut ChaCha8Rng) -> CollisionScene {
    let mut model = |geometry: &Geometry| single(vec![(random_pose(rng, 0.1), geometry.clone())]);
    let (a, b) = (model(a), model(b));
    let robot = compose(&[
        (&a, placed("a", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
        (&b, placed("b", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
    ]);
    CollisionScene::new(&robot, &PairRule::default())
}

fn exact(scene: &CollisionScene, id: PairId, X_WJ: &[Pose]) -> f64 {
    pair_clearance(scene, id, X_WJ, DistanceQuery::exact(0.0), &mut DVec3::ZERO.clone())
}

/// Whether the exact queries say that a pair collides, whatever is asked for.
fn collides(scene: &CollisionScene, id: PairId, X_WJ: &[Pose]) -> bool {
    let clear = exact(scene, id, X_WJ) >= 0.0;
    !clear || contained(scene, id, X_WJ)
}

#[test]
fn what_overlaps_inside_collides_among_shapes_of_all_kinds() {
    let mut rng = ChaCha8Rng::seed_from_u64(101);
    for first in 0..5 {
        for second in first..5 {
            let (mut sure, mut colliding) = (0, 0);
            for round in 0..40 {
                let (a, b) = (random_geometry(&mut rng, first), random_geometry(&mut rng, second));
                let scene = couple(&a, &b, &mut rng);
                let around = DVec3::new([0.0, 3.0, 40.0][round % 3], 0.0, 0.0);
                for _ in 0..50 {
                    let mut X_WJ = [random_pose(&mut rng, 0.3), random_pose(&mut rng, 0.3)];
                    X_WJ.iter_mut().for_each(|X| X.translation += around);
                    let collides = collides(&scene, PairId(0), &X_WJ);
                    colliding += i32::from(collides);
                    if let Some(contact) = surely_colliding(&scene, PairId(0), &X_WJ) {
                        sure += 1;
                        assert!(collides, "{contact:?} of kinds {first} and {second}");
                        assert!(contact.clearance <= 0.0, "{contact:?}");
                    }
                }
            }
            println!("kinds {first} and {second}: {sure} of {colliding} collisions are found by inscribed volumes");
            assert!(5 * sure > colliding, "kinds {first} and {second}: {sure} of {colliding}");
        }
    }
}

/// Pairs pushed together until they barely touch: the depth at which inscribed volumes find them is never before contact.
#[test]
fn contact_is_never_called_too_early() {
    let mut rng = ChaCha8Rng::seed_from_u64(102);
    let mut called = 0;
    for round in 0..400 {
        let (a, b) = (random_geometry(&mut rng, round % 4), random_geometry(&mut rng, round / 4 % 5));
        let scene = couple(&a, &b, &mut rng);
        let X_WB = random_pose(&mut rng, 0.3);
        let (from, turn) = (random_vector(&mut rng, 3.0).normalize() * 4.0, random_pose(&mut rng, 0.1));
        let at = |t: f64| [Pose::from_parts(X_WB.translation + from * t, turn.rotation), X_WB];
        let (mut apart, mut together) = (1.0, 0.0);
        if surely_colliding(&scene, PairId(0), &at(together)).is_none() {
            continue;
        }
        // The outermost place, to the last bits, at which they are called colliding.
        for _ in 0..60 {
            let middle = 0.5 * (apart + together);
            let sure = surely_colliding(&scene, PairId(0), &at(middle)).is_some();
            *(if sure { &mut together } else { &mut apart }) = middle;
        }
        called += 1;
        assert!(collides(&scene, PairId(0), &at(together)), "round {round}");
    }
    assert!(called > 200, "{called}");
}

#[test]
fn one_solid_inside_another_is_seen_and_called_so() {
    let cube = Geometry::Mesh(Arc::new(box_mesh(DVec3::splat(0.3), 2)));
    let mut rng = ChaCha8Rng::seed_from_u64(103);
    let robot = |inner: Geometry| {
        compose(&[
            (
                &single(vec![(Pose::IDENTITY, cube.clone())]),
                placed("cube", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY),
            ),
            (
                &single(vec![(Pose::IDENTITY, inner)]),
                placed("inner", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY),
            ),
        ])
    };
    for inner in
        [cuboid(0.1, 0.1, 0.1), Geometry::Sphere { radius: 0.05 }, Geometry::Mesh(Arc::new(star(&mut rng, 0.1)))]
    {
        let scene = CollisionScene::new(&robot(inner), &PairRule::default());
        let X_WJ = [at(1.0, 0.0, 0.0), at(1.02, 0.01, 0.0)];
        assert!(exact(&scene, PairId(0), &X_WJ) >= 0.0, "surfaces are apart");
        let contact = surely_colliding(&scene, PairId(0), &X_WJ).expect("deep inside");
        assert_eq!(contact.clearance, f64::NEG_INFINITY);
    }
}

#[test]
fn a_mesh_that_is_not_closed_has_no_inside() {
    let whole = box_mesh(DVec3::splat(0.3), 2);
    let open = Mesh::new("open".into(), whole.vertices.clone(), whole.triangles[1..].to_vec());
    assert!(whole.closed && !open.closed);
    let mut rng = ChaCha8Rng::seed_from_u64(104);
    let ball = Geometry::Sphere { radius: 0.25 };
    for (mesh, sure) in [(whole, true), (open, false)] {
        let scene = couple(&Geometry::Mesh(Arc::new(mesh)), &ball, &mut rng);
        let X_WB = [Pose::IDENTITY; 2];
        assert_eq!(surely_colliding(&scene, PairId(0), &X_WB).is_some(), sure);
    }
}

#[test]
fn numbers_that_are_none_are_no_overlap() {
    let mut rng = ChaCha8Rng::seed_from_u64(105);
    for kind in 0..5 {
        let scene = couple(&random_geometry(&mut rng, kind), &cuboid(0.1, 0.1, 0.1), &mut rng);
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(surely_colliding(&scene, PairId(0), &[at(bad, 0.0, 0.0), Pose::IDENTITY]), None);
        }
    }
}

/// Shapes of all kinds adrift around a fixed one.
fn debris(rng: &mut ChaCha8Rng) -> Robot {
    let models: Vec<_> = (0..6)
        .map(|number| {
            let shapes = (0..1 + number % 2).map(|_| (random_pose(rng, 0.1), random_geometry(rng, number % 5)));
            single(shapes.collect())
        })
        .collect();
    let parts: Vec<_> = (models.iter().enumerate())
        .map(|(number, model)| {
            let (kind, root) = match number {
                0 => (PartKind::Environment, RootJoint::Fixed),
                _ => (PartKind::Object, RootJoint::FreeFlyer),
            };
            let mut part = placed(&format!("part{number}"), kind, root, at(0.3, 0.0, 0.0));
            part.root_bounds = vec![(-50.0, 50.0); 3];
            (model, part)
        })
        .collect();
    compose(&parts)
}

/// Of a block the lanes in which the exact queries find a collision, one pair after another.
fn colliding_lanes(scene: &CollisionScene, kinematics: &Kinematics, block: &[Vec<f64>]) -> u16 {
    let mut lanes = 0;
    for (lane, q) in block.iter().enumerate() {
        let mut X_WJ = vec![Pose::IDENTITY; kinematics.bodies()];
        kinematics.forward(q, &mut X_WJ);
        let any = (0..scene.pairs().len() as u32).any(|id| collides(scene, PairId(id), &X_WJ));
        lanes |= u16::from(any) << lane;
    }
    lanes
}

#[test]
fn what_overlaps_inside_in_lanes_collides() {
    for level in Level::available() {
        let mut rng = ChaCha8Rng::seed_from_u64(106);
        let (mut sure, mut colliding, mut scratch) = (0, 0, CollisionScratch::at_level(level));
        for round in 0..30 {
            let robot = debris(&mut rng);
            let (scene, kinematics) = (CollisionScene::new(&robot, &PairRule::default()), Kinematics::new(&robot));
            let pairs = PairSet::new(&scene, &[], &[]);
            // Far from the origin single precision has fewer digits.
            let around = DVec3::new([0.0, 3.0, 40.0][round % 3], 0.0, 0.0);
            let draw = |rng: &mut ChaCha8Rng| {
                let mut q = robot.space.neutral();
                for number in 1..6 {
                    let mut pose = random_pose(rng, 0.9);
                    pose.translation += around;
                    place(&robot, &mut q, &format!("part{number}"), pose);
                }
                q
            };
            let block: Vec<_> = (0..16).map(|_| draw(&mut rng)).collect();
            let verdicts =
                Verdicts { scene: &scene, kinematics: &kinematics, rigid_attachments: &[], pairs: &pairs, guard: 1e-5 };
            let lanes = verdicts.surely_colliding(&block.concat(), &mut scratch);
            let known = colliding_lanes(&scene, &kinematics, &block);
            assert_eq!(lanes & !known, 0, "{level}: {lanes:b}, exactly {known:b}");
            (sure, colliding) = (sure + lanes.count_ones(), colliding + known.count_ones());
        }
        println!("{level}: {sure} of {colliding} configurations in collision are found by inscribed volumes");
        assert!(2 * sure > colliding, "{level}: {sure} of {colliding}");
    }
}

/// On a scene as planners have it most collisions of random configurations need no exact query.
#[test]
fn most_collisions_of_two_arms_are_seen_from_inside() {
    let robot = bench();
    let ignored = always_colliding(&robot);
    let scene = CollisionScene::new(&robot, &PairRule { ignored: &ignored, ..PairRule::default() });
    let (kinematics, pairs) = (Kinematics::new(&robot), PairSet::new(&scene, &[], &[]));
    let mut rng = ChaCha8Rng::seed_from_u64(107);
    let (mut sure, mut colliding, mut scratch) = (0, 0, CollisionScratch::new());
    for _ in 0..40 {
        let draw = |rng: &mut ChaCha8Rng| {
            let mut q = random_configuration(&robot, rng);
            place(&robot, &mut q, "box1", at(0.8, rng.random_range(0.1..0.5), -0.114));
            place(&robot, &mut q, "box2", at(0.8, rng.random_range(-0.5..-0.1), -0.114));
            q
        };
        let block: Vec<_> = (0..16).map(|_| draw(&mut rng)).collect();
        let verdicts =
            Verdicts { scene: &scene, kinematics: &kinematics, rigid_attachments: &[], pairs: &pairs, guard: 1e-5 };
        let lanes = verdicts.surely_colliding(&block.concat(), &mut scratch);
        let known = colliding_lanes(&scene, &kinematics, &block);
        assert_eq!(lanes & !known, 0);
        (sure, colliding) = (sure + lanes.count_ones(), colliding + known.count_ones());
    }
    println!("{sure} of {colliding} configurations in collision are found by inscribed volumes");
    assert!(colliding > 50 && 2 * sure > colliding, "{sure} of {colliding}");
}
