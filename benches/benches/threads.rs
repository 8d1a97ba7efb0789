//! What does a second thread bring to one search, and what would it bring to two that know nothing of each other?
#![allow(clippy::unwrap_used, reason = "a bench that cannot be set up has nothing to measure")]

use criterion::{Criterion, criterion_group, criterion_main};
use foliate::Planner;
use foliate_benches::{criterion, scene_model};
use foliate_systems::planning_model::ProblemTables;
use rayon::ThreadPool;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

const SEEDS: u64 = 20;

/// Of so many runs of a seed the shortest counts.
const RUNS: usize = 5;

fn pool(threads: usize) -> ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

/// From the loaded problem to the certified path, milliseconds, and the roadmap's hash.
fn solve(tables: &Arc<ProblemTables>, seed: u64, pool: &ThreadPool) -> (f64, u64) {
    let started = Instant::now();
    let solution =
        pool.install(|| Planner::from_tables(Arc::clone(tables)).unwrap().seed(seed).first_path().solve()).unwrap();
    let time = started.elapsed().as_secs_f64() * 1e3;
    (time, solution.report.fingerprint)
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// One and two threads interleaved, and two solves at once on a thread each.
fn compare(name: &str, tables: &Arc<ProblemTables>, pools: &[ThreadPool; 3]) {
    let [one, other, two] = pools;
    let (mut alone, mut together, mut at_once) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 1..=SEEDS {
        let mut best = [f64::INFINITY; 3];
        for _ in 0..RUNS {
            let (first, second) = (solve(tables, seed, one), solve(tables, seed, two));
            assert_eq!(first.1, second.1, "{name}: the same roadmap");
            let started = Instant::now();
            std::thread::scope(|scope| {
                let beside = scope.spawn(|| solve(tables, seed, other));
                black_box(solve(tables, seed, one));
                beside.join().unwrap()
            });
            let both = started.elapsed().as_secs_f64() * 1e3;
            for (best, time) in best.iter_mut().zip([first.0, second.0, both]) {
                *best = best.min(time);
            }
        }
        alone.push(best[0]);
        together.push(best[1]);
        at_once.push(2.0 * best[0] / best[2]);
    }
    let ratio = median(alone.iter().zip(&together).map(|(a, b)| a / b).collect());
    println!(
        "{name}: one thread {:.2} ms, two {:.2} ms, {ratio:.2} times as fast, the same roadmaps; two solves at once {:.2} times as \
         fast as one after the other",
        median(alone),
        median(together),
        median(at_once)
    );
}

fn bench(c: &mut Criterion) {
    let pools = [pool(1), pool(1), pool(2)];
    for name in ["baxter-case2", "baxter-case4", "romeo-placard"] {
        let Some(model) = scene_model(name) else { continue };
        let tables = model.tables();
        compare(name, tables, &pools);
        let mut group = c.benchmark_group(format!("threads/{name}"));
        group.sample_size(20);
        for (threads, pool) in [(1, &pools[0]), (2, &pools[2])] {
            let mut seed = 0;
            group.bench_function(format!("{threads}"), |b| {
                b.iter(|| {
                    seed = seed % SEEDS + 1;
                    black_box(solve(tables, seed, pool))
                });
            });
        }
        group.finish();
    }
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
