//! An elbow opens past a plate of 1 mm between two samples: start, end and every coarse sample are free, the motion is not.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{at, compose, cuboid, joint, link, placed, single};
use foliate_components::Pose;
use foliate_components::robot::model::{JointKind, Model};
use foliate_components::robot::shape::Geometry;
use foliate_components::robot::{PartKind, Robot, RootJoint};
use foliate_kernels::collision::{
    CertificateSettings, CollisionScene, CollisionScratch, MotionVerdict, PairRule, PairSet, certify_motion,
    first_collision,
};
use foliate_kernels::kinematics::Kinematics;
use glam::{DQuat, DVec3};

/// Elbow angle at which the plate lies in the middle of the forearm, radians: halfway between two samples.
const BLOCKED: f64 = 0.3125;

/// An upper arm along x, an elbow about z, and a forearm that a plate across its way cuts at `distance` from the elbow.
fn robot(plate: Pose) -> Robot {
    let along_x = |from: f64, length: f64| {
        let pose =
            Pose::from_parts(DVec3::X * (from + 0.5 * length), DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2));
        (pose, Geometry::Cylinder { radius: 0.03, half_length: 0.5 * length })
    };
    let arm = Model {
        name: "arm".into(),
        links: vec![
            link("base", vec![]),
            link("upper", vec![along_x(0.0, 0.3)]),
            link("fore", vec![along_x(0.1, 0.3)]),
        ],
        joints: vec![
            joint("shoulder", JointKind::Revolute, 0, 1, Pose::IDENTITY, DVec3::Z),
            joint("elbow", JointKind::Revolute, 1, 2, at(0.3, 0.0, 0.0), DVec3::Z),
        ],
        ..Model::default()
    };
    let wall = single(vec![(Pose::IDENTITY, cuboid(0.1, 0.001, 0.2))]);
    compose(&[
        (&arm, placed("arm", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY)),
        (&wall, placed("plate", PartKind::Environment, RootJoint::Fixed, plate)),
    ])
}

fn certify(robot: &Robot, from: f64, to: f64, settings: &CertificateSettings) -> MotionVerdict {
    let (scene, kinematics) = (CollisionScene::new(robot, &PairRule::default()), Kinematics::new(robot));
    let pairs = PairSet::new(&scene, &[], &[]);
    let mut scratch = CollisionScratch::new();
    certify_motion(&scene, &kinematics, &[], &[0.2, from], &[0.2, to], &pairs, settings, &mut scratch)
}

fn free_at(robot: &Robot, elbow: f64) -> bool {
    let (scene, kinematics) = (CollisionScene::new(robot, &PairRule::default()), Kinematics::new(robot));
    let mut X_WJ = vec![Pose::IDENTITY; kinematics.bodies()];
    kinematics.forward(&[0.2, elbow], &mut X_WJ);
    let pairs = PairSet::new(&scene, &[], &[]);
    first_collision(&scene, &X_WJ, &pairs, 1e-5, &mut CollisionScratch::new()).is_none()
}

/// The plate stands in the forearm's way at elbow angle `BLOCKED`.
fn plate_in_the_way() -> Pose {
    let elbow = Pose::from_parts(
        DVec3::new(0.3 * 0.2_f64.cos(), 0.3 * 0.2_f64.sin(), 0.0),
        DQuat::from_rotation_z(0.2 + BLOCKED),
    );
    elbow * at(0.35, 0.0, 0.0)
}

#[test]
fn both_ends_and_coarse_samples_are_free() {
    let robot = robot(plate_in_the_way());
    // The forearm is 6 cm thick, 35 cm out: eight samples of 0.375 rad pass by.
    for sample in 0..=8 {
        assert!(free_at(&robot, 2.0 - 0.375 * f64::from(sample)), "sample {sample}");
    }
    assert!(!free_at(&robot, BLOCKED));
}

#[test]
fn the_motion_is_refused_where_the_plate_is() {
    let robot = robot(plate_in_the_way());
    let MotionVerdict::FreeUntil { t, blocked_by } = certify(&robot, 2.0, -1.0, &CertificateSettings::default()) else {
        panic!("tunnelled through the plate");
    };
    assert!(blocked_by.is_some());
    // Contact begins half a forearm before the plate: the prefix ends there, and not much earlier.
    let last = 2.0 - 3.0 * t;
    assert!(free_at(&robot, last) && last > BLOCKED + 0.08 && last < BLOCKED + 0.11, "free until {last}");
    let strict = CertificateSettings { all_or_nothing: true, ..CertificateSettings::default() };
    assert!(matches!(certify(&robot, 2.0, -1.0, &strict), MotionVerdict::FreeUntil { t: 0.0, .. }));
    assert!(matches!(certify(&robot, 2.0, 0.5, &strict), MotionVerdict::Free { .. }));
}

#[test]
fn the_motion_is_accepted_once_the_plate_is_gone() {
    let robot = robot(at(0.0, 0.0, 0.0) * plate_in_the_way() * at(0.2, 0.0, 0.0));
    let verdict = certify(&robot, 2.0, -1.0, &CertificateSettings::default());
    assert!(matches!(verdict, MotionVerdict::Free { min_clearance_lower_bound } if min_clearance_lower_bound > 0.0));
}
