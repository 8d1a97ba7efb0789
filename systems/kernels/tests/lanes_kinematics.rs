//! Poses and Jacobians in lanes are those of the scalar code, for every kind of joint, at every level.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate_components::Pose;
use foliate_components::robot::{GripperIndex, JointIndex, PartKind, Robot, RootJoint};
use foliate_components::samples::models;
use foliate_kernels::kinematics::{
    AttachmentTree, Kinematics, LaneJacobian, LaneKinematics, POSE_ROWS, geometric_jacobian,
};
use foliate_kernels::lanes::{F32Row, F64Row, Level};
use glam::{DMat3, DQuat, DVec3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Arms, a humanoid that floats, one that drives, objects: joints of all kinds, mounted straight and askew.
fn robots() -> Vec<Robot> {
    let arm = models::seven_axis_arm();
    let human = models::humanoid();
    let askew = Pose::from_parts(DVec3::new(0.1, 0.3, -0.2), DQuat::from_xyzw(0.1, 0.2, -0.3, 0.9).normalize());
    let block = models::block(DVec3::new(0.06, 0.06, 0.12));
    let bounded = |root, count| foliate_components::robot::PartPlacement {
        root_bounds: vec![(-1.0, 1.0); count],
        ..models::part("other", PartKind::Robot, root, askew)
    };
    vec![
        Robot::compose(&[
            (&arm, models::fixed_robot("left", Pose::identity())),
            (&arm, models::fixed_robot("right", askew)),
            (&block, models::movable_object("block")),
        ])
        .unwrap(),
        Robot::compose(&[(&human, bounded(RootJoint::FreeFlyer, 3))]).unwrap(),
        Robot::compose(&[(&arm, bounded(RootJoint::Planar, 2)), (&block, models::movable_object("block"))]).unwrap(),
    ]
}

fn configurations(robot: &Robot, count: usize) -> Vec<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut q = robot.space.neutral();
    let mut one = || {
        robot.space.random(&mut rng, &mut q);
        q.clone()
    };
    (0..count).map(|_| one()).collect()
}

fn numbers_of(pose: &Pose) -> Vec<f64> {
    let r = DMat3::from_quat(pose.rotation);
    r.to_cols_array().into_iter().chain(pose.translation.to_array()).collect()
}

#[test]
fn poses_agree_with_the_scalar_code() {
    for robot in robots() {
        let kinematics = Kinematics::new(&robot);
        let table = LaneKinematics::new(&robot);
        let samples = configurations(&robot, 32);
        let mut expected = vec![vec![Pose::identity(); kinematics.bodies()]; samples.len()];
        samples.iter().zip(&mut expected).for_each(|(q, X_WJ)| kinematics.forward(q, X_WJ));
        let size = robot.space.size();
        let rows = table.bodies().len() * POSE_ROWS;
        for level in Level::available() {
            let mut q = vec![F64Row::default(); 4 * size];
            let mut q_short = vec![F32Row::default(); 2 * size];
            for (k, sample) in samples.iter().enumerate() {
                for (i, &x) in sample.iter().enumerate() {
                    q[k / 8 * size + i][k % 8] = x;
                    q_short[k / 16 * size + i][k % 16] = x as f32;
                }
            }
            let mut out = vec![F64Row::default(); 4 * rows];
            let mut out_short = vec![F32Row::default(); 2 * rows];
            table.forward_f64(level, &q, &mut out);
            table.forward_f32(level, &q_short, &mut out_short);
            for (k, X_WJ) in expected.iter().enumerate() {
                for (body, pose) in X_WJ.iter().enumerate() {
                    for (i, x) in numbers_of(pose).into_iter().enumerate() {
                        let at = body * POSE_ROWS + i;
                        let (wide, short) = (out[k / 8 * rows + at][k % 8], out_short[k / 16 * rows + at][k % 16]);
                        assert!((wide - x).abs() < 1e-9, "{level}: body {body}, number {i}: {wide} {x}");
                        assert!((f64::from(short) - x).abs() < 1e-5, "{level}: body {body}, number {i}: {short} {x}");
                    }
                }
            }
        }
    }
}

#[test]
fn jacobians_agree_with_the_scalar_code() {
    for robot in robots() {
        let kinematics = Kinematics::new(&robot);
        let tip = match robot.grippers.first() {
            Some(_) => robot.links[robot.grippers[GripperIndex(0).at()].link.at()].joint.unwrap(),
            None => JointIndex(robot.joints.len() as u32 - 1),
        };
        let X_JF = Pose::from_translation(DVec3::new(0.02, -0.1, 0.15));
        let tree = AttachmentTree::new(&robot);
        let columns = tree.columns(None, Some(tip), Some);
        let table = LaneKinematics::chain_to(&robot, tip);
        let jacobian = LaneJacobian::new(&table, &columns, tip, &X_JF).unwrap();
        let samples = configurations(&robot, 16);
        let (size, width) = (robot.space.size(), jacobian.width());
        for level in Level::available() {
            let mut q = vec![F64Row::default(); 2 * size];
            let mut q_short = vec![F32Row::default(); size];
            for (k, sample) in samples.iter().enumerate() {
                for (i, &x) in sample.iter().enumerate() {
                    q[k / 8 * size + i][k % 8] = x;
                    q_short[i][k] = x as f32;
                }
            }
            let mut bodies = vec![F64Row::default(); table.bodies().len() * POSE_ROWS];
            let mut bodies_short = vec![F32Row::default(); table.bodies().len() * POSE_ROWS];
            let mut out = vec![F64Row::default(); 2 * 6 * width];
            let mut out_short = vec![F32Row::default(); 6 * width];
            jacobian.jacobian_f64(level, &table, &q, &mut bodies, &mut out);
            jacobian.jacobian_f32(level, &table, &q_short, &mut bodies_short, &mut out_short);
            let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
            let mut expected = vec![0.0; 6 * width];
            for (k, sample) in samples.iter().enumerate() {
                kinematics.forward(sample, &mut X_WJ);
                geometric_jacobian(&columns, &X_WJ, (X_WJ[tip.at()] * X_JF).translation, &mut expected);
                for (i, x) in expected.iter().enumerate() {
                    let (wide, short) = (out[k / 8 * 6 * width + i][k % 8], out_short[i][k]);
                    assert!((wide - x).abs() < 1e-9, "{level}: {i}: {wide} {x}");
                    assert!((f64::from(short) - x).abs() < 2e-5, "{level}: {i}: {short} {x}");
                }
            }
        }
    }
}
