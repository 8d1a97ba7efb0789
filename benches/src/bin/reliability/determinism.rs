//! Whether a seed gives the same roadmap on any number of threads, at each SIMD level.

use crate::page::Figure;
use crate::{Result, scenes};
use foliate::Report;
use foliate::kernels::lanes::Level;
use foliate::planner::outcome_name;
use foliate::systems::settings::SearchSettings;
use std::time::Duration;

const THREADS: [usize; 4] = [1, 2, 3, 8];

pub(crate) fn measure(size: usize) -> Result<Figure> {
    let scenes = scenes::all(if size == 1 { 4 } else { usize::MAX });
    let levels = Level::available();
    let [mut solves, mut compared, mut different] = [0_u64; 3];
    for (number, scene) in scenes.iter().enumerate() {
        for seed in 0..size as u64 {
            for &level in &levels {
                let answers = THREADS.map(|threads| -> Result<Option<(u64, Option<f64>)>> {
                    // A clock decides nothing here: work does.
                    let settings =
                        SearchSettings::default().with(|s| (s.seed, s.level, s.max_steps) = (seed, level, 400));
                    let planner = scene.planner(seed, Duration::from_secs(600))?.settings(settings);
                    let answer = planner.solve_on(threads);
                    let (ended, report) = (outcome_name(&answer) != "timeout", Report::of(&answer));
                    Ok(ended.then_some((report.fingerprint, report.path_length)))
                });
                let answers = answers.into_iter().collect::<Result<Vec<_>>>()?;
                let ended: Vec<_> = answers.into_iter().flatten().collect();
                solves += ended.len() as u64;
                compared += ended.len().saturating_sub(1) as u64;
                different += ended.iter().skip(1).filter(|answer| **answer != ended[0]).count() as u64;
            }
        }
        scenes::progress("determinism", number + 1, scenes.len());
    }
    let names: Vec<_> = levels.iter().map(|level| level.name()).collect();
    let how = format!(
        "{} scenes × {size} seeds × the levels {} × {THREADS:?} threads, at most 400 steps each; roadmap and path are those of one thread.",
        scenes.len(),
        names.join(", ")
    );
    let mut figure = Figure::new("Threads and levels", how);
    figure.row("solves", solves);
    figure.row("compared with one thread", compared);
    figure.zero("different", different);
    Ok(figure)
}
