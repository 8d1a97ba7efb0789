//! How long does it take from a scene's name to a planner that may start; without the mesh cache, and from it?

use criterion::{Criterion, criterion_group, criterion_main};
use foliate::batch::Entry;
use foliate::scene::{MeshCache, PackagePath, Scene, shipped_scenes};
use foliate_benches::{criterion, skipped};
use foliate_systems::planning_model::Model;
use std::hint::black_box;

fn bench(c: &mut Criterion) {
    let packages = PackagePath::from_environment(&[]);
    let directory = std::env::temp_dir().join(format!("foliate-bench-meshes-{}", std::process::id()));
    let cached = packages.clone().with_mesh_cache(MeshCache::in_directory(&directory));
    let mut group = c.benchmark_group("loading");
    group.sample_size(10);
    for name in ["demo", "baxter-case4", "ur3-spheres", "pr2-manipulation-kitchen", "talos-pass-box", "romeo-placard"] {
        if !shipped_scenes().iter().any(|scene| scene.name == name) {
            continue;
        }
        let scene = match Scene::load(name, &packages) {
            Ok(scene) => scene,
            Err(error) => {
                skipped(name, &error.to_string());
                continue;
            }
        };
        group.bench_function(format!("{name}: files and model"), |b| {
            b.iter(|| black_box(Entry::load(name, &packages).map(|entry| entry.load_time())));
        });
        // What is not kept yet is kept by this load.
        let from_cache = || Entry::load(name, &cached).map(|entry| entry.load_time());
        if let Err(error) = from_cache() {
            skipped(name, &error.to_string());
            continue;
        }
        group.bench_function(format!("{name}: files and model, meshes from the cache"), |b| {
            b.iter(|| black_box(from_cache()))
        });
        group.bench_function(format!("{name}: graph and tables alone"), |b| {
            b.iter(|| black_box(Model::new(scene.problem.clone()).map(|model| model.graph.states.len())));
        });
    }
    group.finish();
    let _gone = std::fs::remove_dir_all(directory);
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
