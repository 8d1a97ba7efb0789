//! How late solves end that were given little time, and whether any of them crash.

use crate::page::{Figure, quantile};
use crate::{Result, scenes};
use foliate::memory::peak;
use foliate::planner::outcome_name;
use rand::RngExt;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// A solve that takes so much longer than it may counts as hung.
const HUNG: Duration = Duration::from_secs(10);

pub(crate) fn measure(size: usize) -> Result<Figure> {
    let scenes = scenes::all(usize::MAX);
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (mut late, mut outcomes) = (Vec::new(), BTreeMap::<&str, u64>::new());
    let (mut crashed, mut hung) = (0, 0);
    for number in 0..size {
        let scene = &scenes[number % scenes.len().max(1)];
        let limit = Duration::from_micros(random.random_range(500..200_000));
        let planner = scene.planner(number as u64, limit)?;
        let started = Instant::now();
        let answer = planner.solve_on(1);
        let over = started.elapsed().saturating_sub(limit);
        let outcome = outcome_name(&answer);
        if outcome == "timeout" {
            late.push(over.as_secs_f64() * 1e3);
        }
        crashed += u64::from(outcome == "crashed");
        hung += u64::from(over > HUNG);
        *outcomes.entry(outcome).or_default() += 1;
        scenes::progress("deadlines", number + 1, size);
    }
    late.sort_by(f64::total_cmp);
    let names: Vec<_> = scenes.iter().map(|scene| scene.name).collect();
    let how = format!(
        "{size} solves on one thread with limits from 0.5 to 200 ms, drawn at random, over {} scenes ({}). Late is what passes \
         between the deadline and the answer of those that ran out of time.",
        names.len(),
        names.join(", ")
    );
    let mut figure = Figure::new("Deadlines", how);
    for (outcome, count) in outcomes {
        figure.row(outcome, count);
    }
    for (name, share) in [("p50", 0.5), ("p99", 0.99), ("max", 1.0)] {
        figure.row(&format!("late, {name} (ms)"), format!("{:.2}", quantile(&late, share)));
    }
    figure.zero("crashes", crashed);
    figure.zero("later than 10 s", hung);
    figure.row(
        "most memory of the process (MB)",
        peak().map_or("unknown".into(), |bytes| (bytes / 1_000_000).to_string()),
    );
    Ok(figure)
}
