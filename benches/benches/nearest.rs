//! What does it cost to find the nearest of 10³, 10⁴ and 10⁵ nodes, in lanes, several queries to a pass or one, and one by one?
//! Times are of one query.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use foliate_benches::{criterion, one_thread, random_configurations, sample_model, scene_model};
use foliate_kernels::lanes::Level;
use foliate_kernels::nearest::{Bucket, BucketQueries, Metric, nearest};
use foliate_systems::planning_model::PlanningModel;
use std::hint::black_box;
use std::time::Instant;

fn bench_model(c: &mut Criterion, name: &str, model: &PlanningModel, weights: &[f64]) {
    let space = &model.problem.robot.space;
    let metric = Metric::new(space, weights);
    let queries = random_configurations(&model.problem.robot, 64);
    let mut group = c.benchmark_group(format!("nearest/{name}, {} rows", metric.rows()));
    for count in [1000, 10_000, 100_000] {
        let all = random_configurations(&model.problem.robot, count + queries.len()).split_off(queries.len());
        let mut bucket = Bucket::default();
        (0..).zip(&all).for_each(|(id, q)| bucket.push(&metric, id, q));
        let (mut prepared, mut best) = (BucketQueries::default(), Vec::new());
        for together in [1, 2, 4, 16] {
            let mut batches = queries.chunks(together).cycle();
            let name = format!("lanes, {together} together");
            group.bench_with_input(BenchmarkId::new(name, count), &count, |b, _| {
                b.iter_custom(|asked| {
                    let rounds = asked.div_ceil(together as u64);
                    let started = Instant::now();
                    for batch in batches.by_ref().take(rounds as usize) {
                        prepared.set(&metric, batch.iter().map(Vec::as_slice));
                        let exact = |query: usize, id: u32| space.distance(&batch[query], &all[id as usize], weights);
                        nearest((&metric, &prepared, Level::detected()), [&bucket].into_iter(), exact, &mut best);
                        black_box(&best);
                    }
                    started.elapsed().mul_f64(asked as f64 / (rounds * together as u64) as f64)
                });
            });
        }
        let mut turn = 0;
        group.bench_with_input(BenchmarkId::new("one by one", count), &count, |b, _| {
            b.iter(|| {
                turn = (turn + 1) % queries.len();
                let exact = |q: &Vec<f64>| space.distance(&queries[turn], q, weights);
                black_box(all.iter().map(exact).enumerate().min_by(|a, b| a.1.total_cmp(&b.1)))
            });
        });
    }
    group.finish();
}

fn bench(c: &mut Criterion) {
    one_thread();
    let sample = sample_model();
    bench_model(c, "sample arm, its joints", &sample, &sample.robot_weights);
    if let Some(model) = scene_model("baxter-case2") {
        bench_model(c, "Baxter, its joints", &model, &model.robot_weights);
        bench_model(c, "Baxter and two boxes", &model, &model.weights);
    }
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
