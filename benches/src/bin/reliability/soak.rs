//! Many solves in one process: whether its memory grows.

use crate::page::Figure;
use crate::{Result, scenes};
use foliate::memory::{peak, resident};
use foliate::planner::outcome_name;
use std::time::Duration;

pub(crate) fn measure(size: usize) -> Result<Figure> {
    let scenes: Vec<_> = scenes::all(3);
    let mut samples = Vec::new();
    let [mut solved, mut crashed] = [0_u64; 2];
    for number in 0..size {
        let scene = &scenes[number % scenes.len().max(1)];
        // Few seeds, so that every part of the run does the same work.
        let planner = scene.planner((number % 50) as u64, Duration::from_secs(20))?;
        let outcome = outcome_name(&planner.solve_on(1));
        solved += u64::from(outcome == "solved");
        crashed += u64::from(outcome == "crashed");
        if number.is_multiple_of((size / 100).max(1)) {
            samples.push((number as f64, resident().unwrap_or(0) as f64));
        }
        scenes::progress("soak", number + 1, size);
    }
    // What allocators take at first is not what is lost: the slope of the second half.
    let late = &samples[samples.len() / 2..];
    let how = format!(
        "{size} solves, one after another, in one process; the slope is a least-squares line through the second half."
    );
    let mut figure = Figure::new("Soak", how);
    figure.row("solved", solved);
    figure.zero("crashes", crashed);
    figure.row("memory at the end (MB)", format!("{:.1}", samples.last().map_or(0.0, |s| s.1 / 1e6)));
    figure.row("most memory (MB)", peak().unwrap_or(0) / 1_000_000);
    figure.row("slope (bytes per solve)", format!("{:.1}", slope(late)));
    Ok(figure)
}

fn slope(samples: &[(f64, f64)]) -> f64 {
    let count = samples.len().max(1) as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| samples.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|s| s.0), mean(|s| s.1));
    let across: f64 = samples.iter().map(|s| (s.0 - x) * (s.1 - y)).sum();
    let along: f64 = samples.iter().map(|s| (s.0 - x).powi(2)).sum();
    if along > 0.0 { across / along } else { 0.0 }
}
