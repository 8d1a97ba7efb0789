//! Are problems without a solution recognised, and never those that have one?
//!
//! `cargo run --profile dist -p foliate_benches --bin feasibility [-- --impossible N --solvable N --time-limit SECONDS --threads N --show]`.
//! Generated problems of one arm above a table: `N` impossible ones of each cause, and `N` solvable ones in all, each solved with default
//! settings on one thread, first paths, wall time from the problem to the verdict. Of every solvable problem it is also asked what a
//! search could say against it after its first steps, whether or not the search would have come so far. `--show` prints a verdict of each cause.
#![forbid(unsafe_code)]
#![allow(clippy::expect_used, reason = "a measurement that cannot be made ends")]

use foliate_benches::feasibility::impossible::{self, Cause};
use foliate_benches::feasibility::solvable::{self, Task};
use foliate_benches::feasibility::verdict::{Told, Verdict, doubts, told};
use std::error::Error;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

struct Options {
    impossible: u64,
    solvable: u64,
    limit: Duration,
    threads: usize,
    show: bool,
}

fn main() -> Result<()> {
    let options = read(std::env::args().skip(1))?;
    let told_of_impossible = tell_impossible(&options);
    let wrong = tell_solvable(&options);
    println!("\nimpossible problems told within {} s: {told_of_impossible}", options.limit.as_secs_f64());
    println!("solvable problems called impossible: {wrong}");
    if wrong > 0 { Err("a solvable problem was called impossible".into()) } else { Ok(()) }
}

fn read(mut arguments: impl Iterator<Item = String>) -> Result<Options> {
    let mut options =
        Options { impossible: 10, solvable: 10_000, limit: Duration::from_secs(1), threads: 1, show: false };
    while let Some(option) = arguments.next() {
        if option == "--show" {
            options.show = true;
            continue;
        }
        let value = arguments.next().ok_or_else(|| format!("{option} VALUE"))?;
        match option.as_str() {
            "--impossible" => options.impossible = value.parse()?,
            "--solvable" => options.solvable = value.parse()?,
            "--time-limit" => options.limit = Duration::try_from_secs_f64(value.parse()?)?,
            "--threads" => options.threads = value.parse()?,
            _ => return Err(format!("no option `{option}`").into()),
        }
    }
    Ok(options)
}

/// Does the work for seeds from 1 to a number, on so many threads, each with a pool of its own that has one.
fn each<T: Send>(threads: usize, seeds: u64, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let next = AtomicU64::new(1);
    let take = || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        let seeds = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed)).take_while(|&seed| seed <= seeds);
        seeds.map(|seed| (seed, pool.install(|| work(seed)))).collect::<Vec<_>>()
    };
    let mut done: Vec<(u64, T)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(take)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("no work panics")).collect()
    });
    done.sort_by_key(|&(seed, _)| seed);
    done.into_iter().map(|(_, told)| told).collect()
}

fn tell_impossible(options: &Options) -> String {
    println!("| impossible because | problems | proved | likely | given up | not told | median (ms) | worst (ms) |");
    println!("| :-- | --: | --: | --: | --: | --: | --: | --: |");
    let (mut all, mut against) = (0, 0);
    for cause in Cause::ALL {
        let solve = |seed| told(impossible::scene(cause, seed).problem(), seed, options.limit);
        let answers: Vec<Told> = each(options.threads, options.impossible, solve);
        let count = |is: fn(&Verdict) -> bool| answers.iter().filter(|told| is(&told.verdict)).count();
        let mut times: Vec<f64> = answers.iter().map(|told| told.after.as_secs_f64() * 1e3).collect();
        times.sort_by(f64::total_cmp);
        all += answers.len();
        against += answers.iter().filter(|told| told.verdict.is_against() && told.after <= options.limit).count();
        println!(
            "| {} | {} | {} | {} | {} | {} | {:.0} | {:.0} |",
            cause.name(),
            answers.len(),
            count(|verdict| matches!(verdict, Verdict::Proved(_))),
            count(|verdict| matches!(verdict, Verdict::Likely(_))),
            count(|verdict| matches!(verdict, Verdict::GivenUp(_))),
            count(|verdict| !verdict.is_against()),
            times.get(times.len() / 2).copied().unwrap_or_default(),
            times.last().copied().unwrap_or_default(),
        );
        if options.show {
            answers.iter().take(2).for_each(|told| println!("  {:?}", told.verdict));
        }
    }
    format!("{against} of {all}")
}

fn tell_solvable(options: &Options) -> usize {
    println!("\n| solvable | problems | solved | called impossible | doubted when asked | median (ms) | worst (ms) |");
    println!("| :-- | --: | --: | --: | --: | --: | --: |");
    let mut wrong = 0;
    for (number, task) in Task::ALL.into_iter().enumerate() {
        let tasks = Task::ALL.len() as u64;
        let count = options.solvable / tasks + u64::from((number as u64) < options.solvable % tasks);
        let solve = |seed| {
            let problem = solvable::scene(task, seed).problem();
            let said = doubts(problem.clone(), seed);
            (seed, told(problem, seed, 20 * options.limit), said)
        };
        let answers: Vec<(u64, Told, Vec<String>)> = each(options.threads, count, solve);
        let refused = answers.iter().filter(|(_, told, _)| told.verdict.is_against());
        let solved: Vec<_> = answers.iter().filter(|(_, told, _)| told.verdict == Verdict::Solved).collect();
        let doubted = || solved.iter().filter(|(.., said)| !said.is_empty());
        let mut times: Vec<f64> = solved.iter().map(|(_, told, _)| told.after.as_secs_f64() * 1e3).collect();
        times.sort_by(f64::total_cmp);
        println!(
            "| {} | {} | {} | {} | {} | {:.1} | {:.0} |",
            task.name(),
            answers.len(),
            solved.len(),
            refused.clone().count(),
            doubted().count(),
            times.get(times.len() / 2).copied().unwrap_or_default(),
            times.last().copied().unwrap_or_default(),
        );
        wrong += refused.clone().count() + doubted().count();
        refused.take(3).for_each(|(seed, told, _)| println!("  seed {seed}: {:?}", told.verdict));
        doubted().take(3).for_each(|(seed, _, said)| println!("  seed {seed}, when asked: {}", said.join("; ")));
        if options.show {
            let unsolved = answers.iter().filter(|(_, told, _)| matches!(told.verdict, Verdict::Nothing(_)));
            unsolved.take(3).for_each(|(seed, told, _)| println!("  seed {seed}: {:?}", told.verdict));
        }
    }
    wrong
}
