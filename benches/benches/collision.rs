//! What do the exact verdict of a configuration and the certificate of a motion cost?
#![allow(non_snake_case, reason = "pose names carry their frames")]

use criterion::{Criterion, criterion_group, criterion_main};
use foliate_benches::{criterion, random_configurations, sample_model, scene_model};
use foliate_components::Pose;
use foliate_components::graph::StateId;
use foliate_components::robot::{JointType, Source};
use foliate_kernels::collision::{
    CertificateSettings, CollisionScratch, MotionVerdict, PairSet, certify_motion, first_collision, first_collisions,
    open_to_bounds,
};
use foliate_kernels::kinematics::RigidAttachment;
use foliate_systems::planning_model::PlanningModel;
use std::hint::black_box;

/// Random configurations of the robot with the objects where they start.
fn configurations(model: &PlanningModel, count: usize) -> Vec<Vec<f64>> {
    let mut samples = random_configurations(&model.problem.robot, count);
    for q in &mut samples {
        model.place_objects(&model.problem.start, &[], q);
        model.lock(q);
    }
    samples
}

/// Objects stay where they start.
fn lying(model: &PlanningModel) -> Vec<RigidAttachment> {
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    model.kinematics.forward(&model.problem.start, &mut X_WJ);
    let roots = model.objects().iter().filter_map(|object| object.root);
    roots.map(|object| RigidAttachment { object, carrier: None, X_CO: X_WJ[object.at()] }).collect()
}

fn bench_scene(c: &mut Criterion, name: &str, model: &PlanningModel) {
    let samples = configurations(model, 2000);
    let mut scratch = CollisionScratch::new();
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    let mut is_free = |q: &[f64]| {
        model.kinematics.forward(q, &mut X_WJ);
        model.first_collision(StateId(0), &X_WJ, 1e-5, &mut scratch).is_none()
    };
    let (free, blocked): (Vec<_>, Vec<_>) = samples.into_iter().partition(|q| is_free(q));
    println!("{name}: {} pairs; {} of 2000 random configurations are free", model.collision.pairs().len(), free.len());
    let mut group = c.benchmark_group(format!("collision/{name}"));
    bench_verdict(&mut group, "verdict, free configurations", model, &free);
    bench_verdict(&mut group, "verdict, configurations in collision", model, &blocked);
    bench_along(&mut group, model, &free);
    bench_motions(&mut group, model, &free);
    group.finish();
}

type Group<'a> = criterion::BenchmarkGroup<'a, criterion::measurement::WallTime>;

fn bench_verdict(group: &mut Group<'_>, what: &str, model: &PlanningModel, samples: &[Vec<f64>]) {
    if samples.is_empty() {
        return;
    }
    let pairs = PairSet::new(&model.collision, &[], &[]);
    let mut scratch = CollisionScratch::new();
    let poses: Vec<Vec<Pose>> = samples
        .iter()
        .map(|q| {
            let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
            model.kinematics.forward(q, &mut X_WJ);
            X_WJ
        })
        .collect();
    let mut next = poses.iter().cycle();
    group.bench_function(what, |b| {
        b.iter(|| {
            let X_WJ = next.next().unwrap_or(&poses[0]);
            black_box(first_collision(&model.collision, X_WJ, &pairs, 1e-5, &mut scratch))
        });
    });
}

/// Sixteen configurations along motions of at most 0.8 rad of the first arm: verdicts of all pairs that move, and what bounds
/// alone say. Times are per configuration.
fn bench_along(group: &mut Group<'_>, model: &PlanningModel, free: &[Vec<f64>]) {
    let (space, rigid_attachments) = (&model.problem.robot.space, lying(model));
    let pairs = PairSet::new(&model.collision, &rigid_attachments, &[]);
    let Some(arm) = first_arm(model) else { return };
    let blocks: Vec<Vec<f64>> = free
        .windows(2)
        .take(256)
        .map(|ends| {
            let mut end = ends[0].clone();
            let turns = arm.clone().map(|i| ends[1][i] - ends[0][i]);
            let share = (0.8 / turns.map(|x| x * x).sum::<f64>().sqrt()).min(1.0);
            arm.clone().for_each(|i| end[i] += share * (ends[1][i] - end[i]));
            let mut q = ends[0].clone();
            let along = (0..16).flat_map(|i| {
                space.interpolate(&ends[0], &end, (f64::from(i) + 0.5) / 16.0, &mut q);
                q.clone()
            });
            along.collect()
        })
        .collect();
    if blocks.is_empty() {
        return;
    }
    let (mut scratch, mut found) = (CollisionScratch::new(), Vec::new());
    let (scene, kinematics) = (&model.collision, &model.kinematics);
    let mut verdicts = |block: &[f64], found: &mut Vec<_>| {
        found.clear();
        first_collisions(scene, kinematics, &rigid_attachments, block, &pairs, 1e-5, &mut scratch, found);
    };
    let mut colliding = 0;
    for block in &blocks {
        verdicts(block, &mut found);
        colliding += found.iter().flatten().count();
    }
    println!("{colliding} of {} configurations along motions of one arm collide", 16 * blocks.len());
    group.throughput(criterion::Throughput::Elements(16));
    let mut next = blocks.iter().cycle();
    group.bench_function("sixteen verdicts along a motion", |b| {
        b.iter(|| verdicts(black_box(next.next().unwrap_or(&blocks[0])), &mut found));
    });
    let mut scratch = CollisionScratch::new();
    group.bench_function("sixteen configurations along a motion, bounds alone", |b| {
        b.iter(|| {
            let block = next.next().unwrap_or(&blocks[0]);
            black_box(open_to_bounds(scene, kinematics, &rigid_attachments, block, &pairs, 1e-5, &mut scratch))
        });
    });
    group.throughput(criterion::Throughput::Elements(1));
}

/// The coordinates of the first seven joints in a row that turn, each on the one before it.
fn first_arm(model: &PlanningModel) -> Option<std::ops::Range<usize>> {
    let joints = &model.problem.robot.joints;
    let coordinate = |index: usize| match (joints[index].motion, joints[index].source) {
        (JointType::Revolute { .. }, Source::Coordinates { q, .. }) => Some(q),
        _ => None,
    };
    let follows = |index: usize| joints[index].parent.is_some_and(|p| p.at() + 1 == index);
    let first = (0..joints.len().saturating_sub(6))
        .find(|&first| (first..first + 7).all(|i| coordinate(i).is_some()) && (first + 1..first + 7).all(follows))?;
    coordinate(first).map(|q| q..q + 7)
}

/// Motions of 0.3 weighted metres from free configurations towards others: whole ones, and such that end in front of
/// something.
fn bench_motions(group: &mut Group<'_>, model: &PlanningModel, free: &[Vec<f64>]) {
    let space = &model.problem.robot.space;
    let rigid_attachments = lying(model);
    let pairs = PairSet::new(&model.collision, &rigid_attachments, &[]);
    let (settings, mut scratch) = (CertificateSettings::default(), CollisionScratch::new());
    let shorter = |pair: &[Vec<f64>]| {
        let share = (0.3 / space.distance(&pair[0], &pair[1], &model.weights)).min(1.0);
        let mut end = pair[1].clone();
        space.interpolate(&pair[0], &pair[1], share, &mut end);
        (pair[0].clone(), end)
    };
    let motions: Vec<_> = free.windows(2).take(200).map(shorter).collect();
    let mut certify = |(a, b): &(Vec<f64>, Vec<f64>)| {
        certify_motion(&model.collision, &model.kinematics, &rigid_attachments, a, b, &pairs, &settings, &mut scratch)
    };
    let (whole, cut): (Vec<_>, Vec<_>) =
        motions.into_iter().partition(|motion| matches!(certify(motion), MotionVerdict::Free { .. }));
    println!("{} motions of 0.3 m are free, {} end in front of something", whole.len(), cut.len());
    for (what, motions) in [("certificate, free motions", &whole), ("certificate, motions that are cut", &cut)] {
        let mut next = motions.iter().cycle();
        if motions.is_empty() {
            continue;
        }
        group.bench_function(what, |b| b.iter(|| black_box(certify(next.next().unwrap_or(&motions[0])))));
    }
}

fn bench(c: &mut Criterion) {
    bench_scene(c, "sample", &sample_model());
    if let Some(model) = scene_model("baxter-case2") {
        bench_scene(c, "baxter-case2", &model);
    }
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
