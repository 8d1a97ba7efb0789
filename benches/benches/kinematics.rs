//! What do poses and Jacobians cost?
#![allow(non_snake_case, reason = "pose names carry their frames")]

use criterion::{Criterion, criterion_group, criterion_main};
use foliate_benches::{criterion, random_configurations, sample_model, scene_model};
use foliate_components::Pose;
use foliate_components::robot::GripperIndex;
use foliate_kernels::kinematics::{AttachmentTree, Column, geometric_jacobian};
use foliate_systems::model::PlanningModel;
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
}

fn bench(c: &mut Criterion) {
    bench_robot(c, "sample", &sample_model());
    if let Some(model) = scene_model("baxter-case2") {
        bench_robot(c, "baxter-case2", &model);
    }
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
