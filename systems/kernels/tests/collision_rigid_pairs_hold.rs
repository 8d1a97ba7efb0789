//! Two arms that turn side by side: their joints could bring them decimetres closer, a constraint keeps them together.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{at, compose, cuboid, joint, link, placed};
use foliate_components::Pose;
use foliate_components::robot::model::{JointKind, Model};
use foliate_components::robot::{JointIndex, PartKind, Robot, RootJoint};
use foliate_kernels::collision::{
    CertificateSettings, CollisionScene, CollisionScratch, PairRule, PairSet, PolylineVerdict, RigidPair,
    certify_polyline,
};
use foliate_kernels::kinematics::Kinematics;
use glam::DVec3;

/// Side of the cubes, metres.
const SIDE: f64 = 0.1;
/// What the constraint leaves, metres and radians.
const WITHIN: f64 = 1e-4;

/// Where cubes are on their arms, metres.
const OUT: f64 = 1.0;

/// Two arms about one axis with a cube each, the second `gap` ahead of the first. A plate is hinged to the first; it stands beside
/// its cube, and turns into the second.
fn arms(gap: f64) -> Robot {
    let first = Model {
        name: "first".into(),
        links: vec![
            link("base", vec![]),
            link("arm", vec![(at(OUT, 0.0, 0.0), cuboid(SIDE, SIDE, SIDE))]),
            link("plate", vec![(at(0.0, -0.06, 0.0), cuboid(0.01, 0.12, 0.02))]),
        ],
        joints: vec![
            joint("shoulder", JointKind::Revolute, 0, 1, Pose::IDENTITY, DVec3::Z),
            joint("hinge", JointKind::Revolute, 1, 2, at(OUT + 0.07, 0.05, 0.0), DVec3::Z),
        ],
        ..Model::default()
    };
    let second = Model {
        name: "second".into(),
        links: vec![link("base", vec![]), link("arm", vec![(at(OUT, SIDE + gap, 0.0), cuboid(SIDE, SIDE, SIDE))])],
        joints: vec![joint("shoulder", JointKind::Revolute, 0, 1, Pose::IDENTITY, DVec3::Z)],
        ..Model::default()
    };
    compose(&[
        (&first, placed("first", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY)),
        (&second, placed("second", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY)),
    ])
}

/// Both turn by two radians and never leave one another by more than half of what the constraint leaves; the hinge turns by
/// `turned`.
fn certify(robot: &Robot, tie_them: bool, turned: f64) -> PolylineVerdict {
    let (scene, kinematics) = (CollisionScene::new(robot, &PairRule::default()), Kinematics::new(robot));
    let rigid_pair = RigidPair { a: Some(JointIndex(0)), b: Some(JointIndex(2)), origin: DVec3::new(OUT, SIDE, 0.0) };
    let rigid_pairs = if tie_them { vec![rigid_pair] } else { Vec::new() };
    let pairs = PairSet::new(&scene, &[], &[]).with_rigid_pairs(rigid_pairs);
    let knots: Vec<f64> = (0..=8_i32)
        .flat_map(|knot| {
            let (t, error) = (f64::from(knot) / 8.0, if knot % 2 == 0 { 0.0 } else { 0.5 * WITHIN });
            [2.0 * t, turned * t, 2.0 * t + error]
        })
        .collect();
    // As much as one block of lanes: what needs more has not been proved by the rigid pair.
    let settings = CertificateSettings {
        start_is_free: true,
        max_samples: 16,
        rigid_within: WITHIN,
        ..CertificateSettings::default()
    };
    certify_polyline(&scene, &kinematics, &[], &knots, &pairs, &settings, &mut CollisionScratch::new())
}

#[test]
fn what_is_tied_together_is_proved_by_one_look() {
    let robot = arms(1e-3);
    assert!(matches!(certify(&robot, false, 0.0), PolylineVerdict::FreeUntil { .. }), "no need for the rigid pair");
    let PolylineVerdict::Free { min_clearance_lower_bound: clearance } = certify(&robot, true, 0.0) else {
        panic!("the rigid pair was not used");
    };
    assert!((1e-3 - 2.0 * WITHIN..=1e-3).contains(&clearance), "{clearance}");
}

#[test]
fn a_tie_says_nothing_of_what_is_closer_than_it_leaves_room() {
    for gap in [0.9 * WITHIN, 0.1 * WITHIN] {
        assert!(matches!(certify(&arms(gap), true, 0.0), PolylineVerdict::FreeUntil { .. }), "{gap}");
    }
}

#[test]
fn what_moves_on_a_tied_body_is_not_tied() {
    // Three quarters of a turn: it points into the other cube then.
    assert!(matches!(certify(&arms(1e-3), true, 0.0), PolylineVerdict::Free { .. }));
    let PolylineVerdict::FreeUntil { blocked_by, .. } = certify(&arms(1e-3), true, 4.5) else {
        panic!("the plate went through the cube");
    };
    assert!(blocked_by.is_some_and(|contact| contact.clearance < 1e-3));
}
