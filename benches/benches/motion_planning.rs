//! What does plain motion planning cost, one state and one transition: a solve, the verdict of a configuration, the certificate
//! of a motion?
//!
//! Beside the exact verdict stands what it would cost if bounds alone decided (balls, capsules, hulls of meshes; in doubt, in
//! collision). That is a measure of the kernel; searches always ask exactly.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use criterion::{Criterion, criterion_group, criterion_main};
use foliate::Planner;
use foliate_benches::{criterion, one_thread, random_configurations, scene_model};
use foliate_components::Pose;
use foliate_components::robot::JointIndex;
use foliate_kernels::collision::distance::hull_distance::hull_distance;
use foliate_kernels::collision::scene::SceneSolid;
use foliate_kernels::collision::solids::volumes::Ball;
use foliate_kernels::collision::{
    CertificateSettings, CollisionScratch, DistanceQuery, MotionVerdict, PairSet, certify_motion, first_collision,
};
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::settings::SearchSettings;
use glam::DVec3;
use std::hint::black_box;
use std::time::Duration;

const SCENES: [&str; 4] = ["panda-table", "panda-shelf", "panda-box", "panda-cage"];

/// Seeds that alternate, so that the mean is over their spread and not one lucky draw.
const SEEDS: u64 = 20;

/// Room for the rounding of other people's checkers, as in a search; metres.
const GUARD: f64 = 1e-5;

type Group<'a> = criterion::BenchmarkGroup<'a, criterion::measurement::WallTime>;

fn bench_scene(c: &mut Criterion, name: &str, model: &PlanningModel) {
    let mut group = c.benchmark_group(format!("motion_planning/{name}"));
    bench_solves(&mut group, model);
    let place = Place::new(model);
    let (free, blocked) = place.samples(4000);
    println!("{name}: {} pairs; {} of 4000 random configurations are free", model.collision.pairs().len(), free.len());
    bench_verdicts(&mut group, &place, "free", &free);
    bench_verdicts(&mut group, &place, "in collision", &blocked);
    bench_motions(&mut group, &place, &free);
    group.finish();
}

fn bench_solves(group: &mut Group<'_>, model: &PlanningModel) {
    group.sample_size(20);
    let mut seed = 0;
    group.bench_function("solve", |b| {
        b.iter(|| {
            seed = seed % SEEDS + 1;
            let solution =
                Planner::from_model(model.clone()).seed(seed).first_path().time_limit(Duration::from_secs(60)).solve();
            assert!(solution.is_ok());
            black_box(solution)
        });
    });
}

/// A robot among things that stand still.
struct Place<'a> {
    model: &'a PlanningModel,
    pairs: PairSet,
}

impl<'a> Place<'a> {
    fn new(model: &'a PlanningModel) -> Self {
        Self { pairs: PairSet::new(&model.collision, &[], &[]), model }
    }

    fn poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut X_WJ = vec![Pose::identity(); self.model.kinematics.bodies()];
        self.model.kinematics.forward(q, &mut X_WJ);
        X_WJ
    }

    /// Random configurations, those that are free and those that are not.
    fn samples(&self, count: usize) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let mut samples = random_configurations(&self.model.problem.robot, count);
        samples.iter_mut().for_each(|q| self.model.lock(q));
        let mut scratch = CollisionScratch::new();
        let is_free = |q: &Vec<f64>| {
            first_collision(&self.model.collision, &self.poses(q), &self.pairs, GUARD, &mut scratch).is_none()
        };
        samples.into_iter().partition(is_free)
    }

    /// Whether bounds alone show that nothing is closer than the guard: balls of bodies first, as in the exact verdict.
    fn is_surely_free(&self, X_WJ: &[Pose]) -> bool {
        let scene = &self.model.collision;
        let pose = |body: Option<JointIndex>| body.map_or(Pose::identity(), |body| X_WJ[body.at()]);
        scene.groups().iter().filter(|group| !group.fixed).all(|group| {
            let [a, b] = [group.first, group.second].map(|cluster| &scene.clusters()[cluster as usize]);
            let (X_WA, X_WB) = (pose(a.body), pose(b.body));
            are_apart(&a.ball, &X_WA, &b.ball, &X_WB)
                || scene.pairs()[group.start as usize..group.end as usize].iter().all(|pair| {
                    let [a, b] = [pair.first, pair.second].map(|shape| &scene.solids()[shape.at()]);
                    are_surely_apart(a, &X_WA, b, &X_WB)
                })
        })
    }
}

fn are_apart(a: &Ball, X_WA: &Pose, b: &Ball, X_WB: &Pose) -> bool {
    let between = X_WA.transform_point(a.center).distance(X_WB.transform_point(b.center));
    between - a.radius - b.radius >= GUARD
}

fn are_surely_apart(a: &SceneSolid, X_WA: &Pose, b: &SceneSolid, X_WB: &Pose) -> bool {
    are_apart(&a.ball, X_WA, &b.ball, X_WB) || a.capsule.moved(X_WA).distance(&b.capsule.moved(X_WB)) >= GUARD || {
        let (ask, mut hint) = (DistanceQuery { relative: 0.01, ..DistanceQuery::exact(GUARD) }, DVec3::ZERO);
        hull_distance(&a.solid, &(X_WA * a.X_JS), &b.solid, &(X_WB * b.X_JS), ask, &mut hint) >= GUARD
    }
}

/// From a configuration to the verdict, forward kinematics included.
fn bench_verdicts(group: &mut Group<'_>, place: &Place<'_>, what: &str, samples: &[Vec<f64>]) {
    let Place { model, pairs } = place;
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    let mut scratch = CollisionScratch::new();
    let Some(first) = samples.first() else { return };
    let decided = samples.iter().filter(|q| place.is_surely_free(&place.poses(q))).count();
    println!("bounds alone call {decided} of {} free ({what})", samples.len());
    let mut next = samples.iter().cycle();
    group.bench_function(format!("verdict, {what}"), |b| {
        b.iter(|| {
            model.kinematics.forward(next.next().unwrap_or(first), &mut X_WJ);
            black_box(first_collision(&model.collision, &X_WJ, pairs, GUARD, &mut scratch))
        });
    });
    group.bench_function(format!("bounds alone, {what}"), |b| {
        b.iter(|| {
            model.kinematics.forward(next.next().unwrap_or(first), &mut X_WJ);
            black_box(place.is_surely_free(&X_WJ))
        });
    });
}

/// Two configurations.
type Ends = (Vec<f64>, Vec<f64>);

/// Motions of one radian (root of the sum of squares) from free configurations towards others, as VAMP's figures have them, and
/// motions all the way there, as a search asks for them: cut at an eighth of their length where they are blocked.
fn bench_motions(group: &mut Group<'_>, place: &Place<'_>, free: &[Vec<f64>]) {
    let Place { model, pairs } = place;
    let settings = CertificateSettings {
        start_is_free: true,
        prefix_resolution: SearchSettings::default().prefix_resolution,
        ..CertificateSettings::default()
    };
    let mut scratch = CollisionScratch::new();
    let mut certify =
        |(a, b): &Ends| certify_motion(&model.collision, &model.kinematics, &[], a, b, pairs, &settings, &mut scratch);
    for (length, most) in [("one radian", 1.0), ("full length", f64::INFINITY)] {
        let motions = motions(model, free, most);
        let (whole, cut): (Vec<_>, Vec<_>) =
            motions.into_iter().partition(|motion| matches!(certify(motion), MotionVerdict::Free { .. }));
        println!("{length}: {} motions are free, {} are not", whole.len(), cut.len());
        for (what, motions) in [("free", whole), ("cut", cut)] {
            let Some(first) = motions.first() else { continue };
            let mut next = motions.iter().cycle();
            group.bench_function(format!("certificate, {length}, {what}"), |b| {
                b.iter(|| black_box(certify(next.next().unwrap_or(first))));
            });
        }
    }
}

/// From each of some configurations towards the next, `most` radians at most.
fn motions(model: &PlanningModel, free: &[Vec<f64>], most: f64) -> Vec<Ends> {
    let space = &model.problem.robot.space;
    let ones = vec![1.0; space.dimension()];
    let motion = |ends: &[Vec<f64>]| {
        let share = (most / space.distance(&ends[0], &ends[1], &ones)).min(1.0);
        let mut end = ends[1].clone();
        space.interpolate(&ends[0], &ends[1], share, &mut end);
        (ends[0].clone(), end)
    };
    free.windows(2).take(400).map(motion).collect()
}

fn bench(c: &mut Criterion) {
    one_thread();
    for name in SCENES {
        if let Some(model) = scene_model(name) {
            bench_scene(c, name, &model);
        }
    }
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
