//! Plans a second: first paths of one scene, seed after seed.
//!
//! `cargo run --profile dist -p foliate_benches --bin throughput -- SCENE PLANS THREADS`. Reading the scene and building its constraint graph do not
//! count. `python/benches/throughput.py` compares with Python.
#![forbid(unsafe_code)]

use foliate::Planner;
use foliate::batch::{Entry, plan_batch};
use foliate::scene::PackagePath;
use std::error::Error;
use std::time::Instant;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, plans, threads] = arguments.as_slice() else {
        return Err("usage: throughput SCENE PLANS THREADS".into());
    };
    let (plans, threads) = (plans.parse::<u64>()?, threads.parse::<usize>()?);
    let entry = Entry::load(scene, &PackagePath::from_environment(&[]))?;
    let solved = |seeds: std::ops::RangeInclusive<u64>| -> Result<u64> {
        let planners = seeds.map(|seed| Planner::from_model(entry.model().clone()).seed(seed).first_path());
        Ok(plan_batch(planners, threads)?.filter(|answer| answer.is_ok()).count() as u64)
    };
    // The first solves of a process fill its memory.
    solved(1..=plans.min(50))?;
    let begun = Instant::now();
    let found = solved(1..=plans)?;
    let taken = begun.elapsed().as_secs_f64();
    if found < plans {
        return Err(format!("{found} of {plans} were solved").into());
    }
    println!("{:.1}", plans as f64 / taken);
    Ok(())
}
