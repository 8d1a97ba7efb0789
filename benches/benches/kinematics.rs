//! What do poses and Jacobians cost, one configuration at a time and in lanes?
#![allow(non_snake_case, reason = "pose names carry their frames")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use foliate_benches::{criterion, random_configurations, sample_model, scene_model};
use foliate_components::Pose;
use foliate_components::robot::GripperIndex;
use foliate_kernels::kinematics::{
    AttachmentTree, Column, LaneJacobian, LaneKinematics, POSE_ROWS, geometric_jacobian,
};
use foliate_kernels::lanes::{F32Row, F64Row, Level};
use foliate_systems::planning_model::PlanningModel;
use std::hint::black_box;

/// The columns of the arm that carries the first gripper, numbered from 0.
fn arm(model: &PlanningModel) -> Vec<Column> {
    let robot = &model.problem.robot;
    let gripper = &robot.grippers[GripperIndex(0).at()];
    let tip = robot.links[gripper.link.at()].joint;
    let tree = AttachmentTree::new(robot);
    let seen: Vec<usize> = tree.columns(None, tip, Some).iter().map(Column::variable).collect();
    tree.columns(None, tip, |v| seen.iter().position(|&s| s == v))
}

fn bench_robot(c: &mut Criterion, name: &str, model: &PlanningModel) {
    let robot = &model.problem.robot;
    let samples = random_configurations(robot, 1024);
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    let mut next = samples.iter().cycle();
    let mut group = c.benchmark_group(format!("kinematics/{name}"));
    group.bench_function(format!("forward, {} bodies", X_WJ.len()), |b| {
        b.iter(|| model.kinematics.forward(black_box(next.next().unwrap_or(&samples[0])), &mut X_WJ));
    });
    let columns = arm(model);
    let tip = robot.links[robot.grippers[0].link.at()].joint.map_or(0, |j| j.at());
    let mut jacobian = vec![0.0; 6 * columns.len()];
    group.bench_function(format!("forward and the Jacobian of {} joints", columns.len()), |b| {
        b.iter(|| {
            model.kinematics.forward(black_box(next.next().unwrap_or(&samples[0])), &mut X_WJ);
            geometric_jacobian(&columns, &X_WJ, X_WJ[tip].translation, &mut jacobian);
            black_box(&jacobian);
        });
    });
    group.finish();
    bench_lanes(c, name, model, &samples);
}

/// The arm alone, a thousand configurations a call, at every level; to be read per configuration.
fn bench_lanes(c: &mut Criterion, name: &str, model: &PlanningModel, samples: &[Vec<f64>]) {
    let robot = &model.problem.robot;
    let gripper = &robot.grippers[0];
    let Some(tip) = robot.links[gripper.link.at()].joint else { return };
    let table = LaneKinematics::chain_to(robot, tip);
    let Some(jacobian) = LaneJacobian::new(&table, &arm(model), tip, &gripper.link_from_gripper) else { return };
    let (size, width, bodies) = (robot.space.size(), jacobian.width(), table.bodies().len() * POSE_ROWS);
    let mut q = vec![F64Row::default(); samples.len() / 8 * size];
    let mut q_short = vec![F32Row::default(); samples.len() / 16 * size];
    for (k, sample) in samples.iter().enumerate() {
        for (i, &x) in sample.iter().enumerate() {
            q[k / 8 * size + i][k % 8] = x;
            q_short[k / 16 * size + i][k % 16] = x as f32;
        }
    }
    let (mut poses, mut poses_short) = (vec![F64Row::default(); bodies], vec![F32Row::default(); bodies]);
    let mut out = vec![F64Row::default(); samples.len() / 8 * 6 * width];
    let mut out_short = vec![F32Row::default(); samples.len() / 16 * 6 * width];
    let mut group = c.benchmark_group(format!("kinematics/{name}/lanes"));
    group.throughput(Throughput::Elements(samples.len() as u64));
    for level in Level::available() {
        group.bench_function(format!("Jacobian of {width} joints, f64, {level}"), |b| {
            b.iter(|| jacobian.jacobian_f64(level, &table, black_box(&q), &mut poses, &mut out));
        });
        group.bench_function(format!("Jacobian of {width} joints, f32, {level}"), |b| {
            b.iter(|| jacobian.jacobian_f32(level, &table, black_box(&q_short), &mut poses_short, &mut out_short));
        });
    }
    group.finish();
}

fn bench(c: &mut Criterion) {
    bench_robot(c, "sample", &sample_model());
    if let Some(model) = scene_model("baxter-case2") {
        bench_robot(c, "baxter-case2", &model);
    }
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
