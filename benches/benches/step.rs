//! What does one step of the search cost with 8, 64 and 512 candidates, and what per candidate?

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use foliate_benches::{criterion, long_model, one_thread, scene_model, under_way};
use foliate_systems::planning_model::PlanningModel;

/// A step is measured when the search has tried this many candidates, whatever their number per step, so that the
/// roadmaps are of like size.
const WARM_UP: usize = 512;

fn bench_scene(c: &mut Criterion, name: &str, model: &PlanningModel) {
    let mut group = c.benchmark_group(format!("step/{name}"));
    group.sample_size(20);
    for candidates in [8, 64, 512] {
        group.throughput(Throughput::Elements(candidates as u64));
        let mut seed = 0;
        group.bench_function(format!("{candidates} candidates"), |b| {
            // The search goes back to criterion, which drops it outside the measured time.
            b.iter_batched(
                || under_way(model, candidates, WARM_UP, u64::MAX, &mut seed),
                |mut search| {
                    let _over = search.as_mut().map(|search| search.step().is_some());
                    search
                },
                BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

fn bench(c: &mut Criterion) {
    one_thread();
    bench_scene(c, "four boxes", &long_model());
    if let Some(model) = scene_model("baxter-case4") {
        bench_scene(c, "baxter-case4", &model);
    }
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
