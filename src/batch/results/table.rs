//! The table that the papers give: minimum, median and maximum of time and nodes.

use crate::batch::improvement::summary::ImprovementTable;
use crate::batch::machine::Machine;
use crate::batch::results::row::Row;
use crate::batch::run::seeds::Seeds;
use crate::batch::vary::rejections::Rejections;
use foliate_systems::settings::SearchSettings;
use std::fmt::Write;
use std::time::Duration;

/// Minimum, median and maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Minimum.
    pub min: f64,
    /// Median; between two values in the middle their mean.
    pub median: f64,
    /// Maximum.
    pub max: f64,
}

/// A problem's line of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSummary {
    /// Name of the problem.
    pub scene: String,
    /// Solves that gave a path.
    pub solved: usize,
    /// All solves.
    pub runs: usize,
    /// Seconds, of the solves that gave a path.
    pub time: Option<Spread>,
    /// Roadmap nodes, of the solves that gave a path.
    pub nodes: Option<Spread>,
}

/// The summary of a problem with one scheduler and settings.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupSummary {
    /// Name of the scheduler.
    pub scheduler: String,
    /// Name of the settings; empty where the batch has one.
    pub settings: String,
    /// The rest.
    pub summary: SceneSummary,
}

/// The table, and what has to be said about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Where it was measured.
    pub machine: Machine,
    /// When.
    pub date: String,
    /// Name of the scheduler; of several, their names with commas.
    pub scheduler: String,
    /// Settings of the searches.
    pub search: SearchSettings,
    /// Seeds.
    pub seeds: Seeds,
    /// Threads of all solves that ran at once.
    pub threads: usize,
    /// Wall time after which one solve gave up.
    pub time_limit: Duration,
    /// The lines: all rows of each scene.
    pub scenes: Vec<SceneSummary>,
    /// The lines of each scene with each scheduler and all settings; empty where there is one of both.
    pub groups: Vec<GroupSummary>,
    /// Varied instances of each scene; `None` where scenes are not varied.
    pub instances: Option<u64>,
    /// Draws that made no instance, by reason.
    pub refused: Rejections,
    /// What the improvement has made of the paths, where there was one.
    pub improvement: Option<ImprovementTable>,
}

impl Spread {
    /// Of some values; `None` without any.
    #[must_use]
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let (&min, &max) = (values.first()?, values.last()?);
        let half = values.len() / 2;
        let median = if values.len() % 2 == 1 { values[half] } else { 0.5 * (values[half - 1] + values[half]) };
        Some(Self { min, median, max })
    }
}

impl SceneSummary {
    /// Of the rows of one problem.
    #[must_use]
    pub fn of(scene: &str, rows: &[Row]) -> Self {
        Self::of_rows(scene, rows.iter().filter(|row| row.scene == scene))
    }

    pub(crate) fn of_rows<'a>(scene: &str, rows: impl Iterator<Item = &'a Row> + Clone) -> Self {
        let solved: Vec<&Row> = rows.clone().filter(|row| row.is_solved()).collect();
        Self {
            scene: scene.into(),
            solved: solved.len(),
            runs: rows.count(),
            time: Spread::of(solved.iter().map(|row| row.solve_time.as_secs_f64()).collect()),
            nodes: Spread::of(solved.iter().filter_map(|row| Some(row.work?.nodes as f64)).collect()),
        }
    }
}

impl GroupSummary {
    /// Of the rows of one problem with one scheduler and settings.
    #[must_use]
    pub fn of(scene: &str, scheduler: &str, settings: &str, rows: &[Row]) -> Self {
        let is_of = |row: &&Row| (&*row.scene, &*row.scheduler, &*row.settings) == (scene, scheduler, settings);
        let summary = SceneSummary::of_rows(scene, rows.iter().filter(is_of));
        Self { scheduler: scheduler.to_owned(), settings: settings.to_owned(), summary }
    }
}

impl Table {
    /// The table in Markdown, with machine, date and version at its head.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut out = String::new();
        let build = if cfg!(debug_assertions) { "debug build, whose times say nothing" } else { "release build" };
        let _ = writeln!(
            out,
            "foliate {} ({build}), scheduler {}{}, {} arithmetic; {}; {}",
            env!("CARGO_PKG_VERSION"),
            self.scheduler,
            changed(&self.search),
            self.search.level,
            self.machine,
            self.date
        );
        let instances = self.instances.map(|count| format!("{count} varied instances of each scene, "));
        let _ = writeln!(
            out,
            "{}seeds {}, {} threads in all, at most {} s each; times without loading{}\n",
            instances.unwrap_or_default(),
            self.seeds,
            self.threads,
            self.time_limit.as_secs_f64(),
            if self.improvement.is_some() { ", up to the first path" } else { "" }
        );
        self.write_lines(&mut out);
        if self.scenes.iter().any(|line| line.solved < line.runs) {
            out.push_str("\nTimes and nodes are those of the solves that gave a path.\n");
        }
        if !self.refused.is_empty() {
            let _ = writeln!(out, "\nDraws that were no instance: {}.", self.refused.words());
        }
        if let Some(improvement) = &self.improvement {
            out.push_str(&improvement.markdown());
        }
        out
    }
}

impl Table {
    /// A line per scene, or per scene, scheduler and settings.
    fn write_lines(&self, out: &mut String) {
        let has_settings = self.groups.iter().any(|group| !group.settings.is_empty());
        let columns = match (self.groups.is_empty(), has_settings) {
            (true, _) => "scene |",
            (false, false) => "scene | scheduler |",
            (false, true) => "scene | scheduler | settings |",
        };
        let _ = writeln!(out, "| {columns} solved | time (s): min / median / max | nodes: min / median / max |");
        let _ = writeln!(out, "|{} --: | --: | --: |", " :-- |".repeat(columns.matches('|').count()));
        let mut line = |name: String, line: &SceneSummary| {
            let (time, nodes) = (spread(line.time, seconds), spread(line.nodes, count));
            let _ = writeln!(out, "| {name} | {}/{} | {time} | {nodes} |", line.solved, line.runs);
        };
        match self.groups.is_empty() {
            true => self.scenes.iter().for_each(|scene| line(scene.scene.clone(), scene)),
            false => self.groups.iter().for_each(|group| {
                let settings = if has_settings { format!(" | {}", group.settings) } else { String::new() };
                line(format!("{} | {}{settings}", group.summary.scene, group.scheduler), &group.summary);
            }),
        }
    }
}

/// The settings that are not the defaults.
fn changed(search: &SearchSettings) -> String {
    let default = SearchSettings::default();
    let mut out = String::new();
    if search.candidates != default.candidates {
        let _ = write!(out, ", {} candidates per step", search.candidates);
    }
    if search.selection != default.selection {
        let _ = write!(out, ", selection {:?}", search.selection);
    }
    let told = search.clone().with(|s| {
        (s.seed, s.candidates) = (default.seed, default.candidates);
        (s.selection, s.level) = (default.selection, default.level);
    });
    if told != default {
        out.push_str(", other settings changed");
    }
    out
}

fn spread(spread: Option<Spread>, cell: fn(f64) -> String) -> String {
    let cells = spread.map(|s| [s.min, s.median, s.max].map(cell).join(" / "));
    cells.unwrap_or_else(|| "–".into())
}

/// Three digits.
fn seconds(value: f64) -> String {
    let decimals = match value {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        v if v >= 1.0 => 2,
        v if v >= 0.1 => 3,
        _ => 4,
    };
    format!("{value:.decimals$}")
}

fn count(value: f64) -> String {
    if value.fract() == 0.0 { format!("{value:.0}") } else { format!("{value:.1}") }
}

#[cfg(test)]
mod tests {
    use super::{Spread, count, seconds};

    #[test]
    fn the_median_stands_in_the_middle() {
        assert_eq!(Spread::of(vec![3.0, 1.0, 2.0]), Some(Spread { min: 1.0, median: 2.0, max: 3.0 }));
        assert_eq!(Spread::of(vec![4.0, 1.0, 2.0, 3.0]), Some(Spread { min: 1.0, median: 2.5, max: 4.0 }));
        assert_eq!(Spread::of(Vec::new()), None);
    }

    #[test]
    fn numbers_keep_three_digits() {
        assert_eq!([0.0123, 0.5, 1.234, 12.34, 1234.5].map(seconds), ["0.0123", "0.500", "1.23", "12.3", "1234"]);
        assert_eq!([199.0, 199.5].map(count), ["199", "199.5"]);
    }
}
