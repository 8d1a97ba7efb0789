//! How long does a whole solve take, seed after seed, on one thread?

use criterion::{Criterion, criterion_group, criterion_main};
use foliate::Planner;
use foliate_benches::{criterion, one_thread, sample_model, scene_model};
use foliate_systems::planning_model::PlanningModel;
use std::hint::black_box;
use std::time::Duration;

/// Seeds that alternate, so that the mean is over their spread and not one lucky draw.
const SEEDS: u64 = 20;

fn bench_scene(c: &mut Criterion, name: &str, model: &PlanningModel) {
    let mut group = c.benchmark_group("whole_problem");
    group.sample_size(10);
    let mut seed = 0;
    group.bench_function(name, |b| {
        b.iter(|| {
            seed = seed % SEEDS + 1;
            let solution =
                Planner::from_model(model.clone()).seed(seed).first_path().time_limit(Duration::from_secs(60)).solve();
            assert!(solution.is_ok());
            black_box(solution)
        });
    });
    group.finish();
}

fn bench(c: &mut Criterion) {
    one_thread();
    bench_scene(c, "swap_two_boxes", &sample_model());
    if let Some(model) = scene_model("baxter-case2") {
        bench_scene(c, "baxter-case2", &model);
    }
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
