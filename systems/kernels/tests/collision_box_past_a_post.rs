//! A box swings at the end of an arm past a thin post: only the box, which the arm carries, meets it.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{at, compose, cuboid, joint, link, place, placed, single};
use foliate_components::Pose;
use foliate_components::robot::model::{JointKind, Model};
use foliate_components::robot::shape::Geometry;
use foliate_components::robot::{JointIndex, PartKind, Robot, RootJoint};
use foliate_kernels::collision::{
    CertificateSettings, CollisionScene, CollisionScratch, MotionVerdict, PairRule, PairSet, certify_motion,
};
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use glam::DVec3;

fn robot(post: DVec3) -> Robot {
    let arm = Model {
        name: "arm".into(),
        links: vec![link("base", vec![]), link("arm", vec![(at(0.3, 0.0, 0.0), cuboid(0.5, 0.04, 0.04))])],
        joints: vec![joint("shoulder", JointKind::Revolute, 0, 1, Pose::IDENTITY, DVec3::Z)],
        ..Model::default()
    };
    let held = single(vec![(Pose::IDENTITY, cuboid(0.08, 0.02, 0.08))]);
    let post_model = single(vec![(Pose::IDENTITY, Geometry::Cylinder { radius: 0.002, half_length: 0.5 })]);
    compose(&[
        (&arm, placed("arm", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY)),
        (&held, placed("box", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
        (&post_model, placed("post", PartKind::Environment, RootJoint::Fixed, Pose::from_translation(post))),
    ])
}

fn swing(robot: &Robot, held: bool, from: f64, to: f64) -> MotionVerdict {
    let (scene, kinematics) = (CollisionScene::new(robot, &PairRule::default()), Kinematics::new(robot));
    let arm_from_box = at(0.6, 0.0, 0.0);
    let rigid_attachment = RigidAttachment { object: JointIndex(1), carrier: Some(JointIndex(0)), X_CO: arm_from_box };
    let rigid_attachments = if held { vec![rigid_attachment] } else { Vec::new() };
    let pairs = PairSet::new(&scene, &rigid_attachments, &[]);
    // The arm and what it holds do not move relative to each other.
    assert_eq!(pairs.constant_pairs(&scene).count(), usize::from(held));
    assert_eq!(pairs.moving_pairs(&scene).count(), 3 - usize::from(held));
    let (mut a, mut b) = (vec![0.0; robot.space.size()], vec![0.0; robot.space.size()]);
    (a[0], b[0]) = (from, to);
    // The box's own coordinates say that it lies somewhere else: while it is held they must not matter.
    for q in [&mut a, &mut b] {
        place(robot, q, "box", at(0.0, 0.0, 3.0));
    }
    let settings = CertificateSettings::default();
    certify_motion(&scene, &kinematics, &rigid_attachments, &a, &b, &pairs, &settings, &mut CollisionScratch::new())
}

fn post(radius: f64) -> DVec3 {
    let angle = 0.377_f64;
    DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
}

#[test]
fn the_swing_is_refused_while_the_box_is_held() {
    let robot = robot(post(0.61));
    let MotionVerdict::FreeUntil { t, blocked_by } = swing(&robot, true, -1.0, 1.0) else {
        panic!("the box tunnelled through the post");
    };
    // The post stands at angle 0.377; half the box is 1 cm, the post 2 mm: 0.02 rad at 0.61 m.
    let angle = -1.0 + 2.0 * t;
    assert!(angle > 0.377 - 0.03 && angle < 0.377 - 0.018, "free until {angle}");
    assert!(blocked_by.is_some());
}

#[test]
fn the_swing_is_accepted_without_the_box_or_without_the_post() {
    assert!(matches!(swing(&robot(post(0.61)), false, -1.0, 1.0), MotionVerdict::Free { .. }));
    assert!(matches!(swing(&robot(post(0.66)), true, -1.0, 1.0), MotionVerdict::Free { .. }));
    assert!(matches!(swing(&robot(post(0.61)), true, -1.0, 0.34), MotionVerdict::Free { .. }));
}
