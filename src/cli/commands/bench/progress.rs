//! How far a batch is: a bar where there is a terminal, a line for each row elsewhere.

use crate::batch::{Progress, Row};
use crate::cli::commands::bench::text;
use crate::cli::console::print::say;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Shows what a batch has done.
#[derive(Debug)]
pub(crate) struct Shown {
    bar: Option<ProgressBar>,
    is_silent: bool,
    solved: AtomicUsize,
    unsolved: AtomicUsize,
}

impl Shown {
    /// Where standard error is a terminal a bar, unless nothing is to be shown.
    pub(crate) fn new(is_silent: bool) -> Self {
        let is_shown = !is_silent && std::io::stderr().is_terminal();
        Self { bar: is_shown.then(bar), is_silent, solved: AtomicUsize::new(0), unsolved: AtomicUsize::new(0) }
    }

    /// Shows a row: as a line, or, beside a bar, only where it is not solved.
    pub(crate) fn row(&self, row: &Row) {
        let count = if row.is_solved() { &self.solved } else { &self.unsolved };
        count.fetch_add(1, Ordering::Relaxed);
        match &self.bar {
            _ if self.is_silent => {}
            None => say(&text::line(row)),
            Some(_) if row.is_solved() => {}
            Some(bar) => bar.suspend(|| say(&text::line(row))),
        }
    }

    /// What is to be called with the progress of the batch.
    pub(crate) fn watcher(&self) -> Option<impl Fn(Progress) + Send + Sync + 'static> {
        let bar = self.bar.clone()?;
        let began = Instant::now();
        // Rows of an earlier run took no time of this one.
        let before = AtomicUsize::new(usize::MAX);
        Some(move |progress: Progress| {
            before.fetch_min(progress.done, Ordering::Relaxed);
            bar.set_length(progress.all as u64);
            bar.set_position(progress.done as u64);
            let made = progress.done.saturating_sub(before.load(Ordering::Relaxed));
            bar.set_message(words(made, began.elapsed(), progress.left));
        })
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    /// Adds what the rows of this run were, for the end of a run with a bar.
    pub(crate) fn sum(&self) -> Option<String> {
        self.bar.as_ref()?;
        let (solved, unsolved) = (self.solved.load(Ordering::Relaxed), self.unsolved.load(Ordering::Relaxed));
        Some(format!("{} rows: {solved} solved, {unsolved} not\n", solved + unsolved))
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{elapsed_precise} {wide_bar} {pos} of {len}, {msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
}

/// `35.2 rows/s, 12 s left`.
fn words(made: usize, time: Duration, left: Option<Duration>) -> String {
    let rate = made as f64 / time.as_secs_f64().max(1e-9);
    let rate = if rate >= 10.0 { format!("{rate:.0}") } else { format!("{rate:.2}") };
    let left = left.map_or_else(|| "time left unknown".into(), |left| format!("{} left", spoken(left)));
    format!("{rate} rows/s, {left}")
}

/// A time as people say it.
fn spoken(time: Duration) -> String {
    let seconds = time.as_secs_f64().round() as u64;
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, seconds) => format!("{seconds} s"),
        (0, minutes, seconds) => format!("{minutes} min {seconds} s"),
        (hours, minutes, _) => format!("{hours} h {minutes} min"),
    }
}

#[cfg(test)]
mod tests {
    use super::{spoken, words};
    use std::time::Duration;

    #[test]
    fn times_and_rates_are_spoken() {
        let spoken = |seconds: f64| spoken(Duration::from_secs_f64(seconds));
        assert_eq!([0.4, 59.6, 3599.0, 7260.0].map(spoken), ["0 s", "1 min 0 s", "59 min 59 s", "2 h 1 min"]);
        let left = Some(Duration::from_secs(12));
        assert_eq!(words(35, Duration::from_secs(1), left), "35 rows/s, 12 s left");
        assert_eq!(words(1, Duration::from_secs(4), None), "0.25 rows/s, time left unknown");
    }
}
