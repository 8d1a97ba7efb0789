//! How long does it take from a scene's name to a planner that may start?

use criterion::{Criterion, criterion_group, criterion_main};
use foliate::batch::Entry;
use foliate::scene::{PackagePath, load_scene, shipped_scenes};
use foliate_benches::{criterion, skipped};
use foliate_systems::model::Model;
use std::hint::black_box;

fn bench(c: &mut Criterion) {
    let packages = PackagePath::from_environment(&[]);
    let mut group = c.benchmark_group("loading");
    group.sample_size(10);
    for name in ["demo", "baxter-case1", "baxter-case4"] {
        if !shipped_scenes().iter().any(|scene| scene.name == name) {
            continue;
        }
        let scene = match load_scene(name, &packages) {
            Ok(scene) => scene,
            Err(error) => {
                skipped(name, &error.to_string());
                continue;
            }
        };
        group.bench_function(format!("{name}: files and model"), |b| {
            b.iter(|| black_box(Entry::load(name, &packages).map(|entry| entry.load_time())));
        });
        group.bench_function(format!("{name}: graph and tables alone"), |b| {
            b.iter(|| black_box(Model::new(scene.problem.clone()).map(|model| model.graph.states.len())));
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
