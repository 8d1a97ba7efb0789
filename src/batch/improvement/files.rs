//! `improvement.csv` and `history.csv`: what a row of `results.csv` has no cells for.
//!
//! The rows of a solve are appended before its row in `results.csv`. So a row there has all of its rows here, and what an
//! interruption leaves here without a row there is dropped.

use crate::batch::error::{BatchError, write_whole};
use crate::batch::improvement::checkpoint::{CHECKPOINT_COLUMNS, Checkpoint, HISTORY_COLUMNS};
use crate::batch::improvement::numbers::ImprovementNumbers;
use crate::batch::results::csv::csv_line;
use crate::batch::results::kept;
use crate::batch::results::row::Row;
use crate::os::output::Lines;
use crate::planner::refinement::CostRow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Both files, open to be appended to.
pub(crate) struct ImprovementFiles {
    checkpoints: Growing,
    history: Growing,
}

struct Growing {
    path: PathBuf,
    lines: Lines,
}

impl Growing {
    /// Replaces a file and goes on with it.
    fn begin(path: PathBuf, text: &str) -> Result<Self, BatchError> {
        write_whole(&path, text)?;
        let lines = Lines::open(&path).map_err(|source| BatchError::Io { path: path.clone(), source })?;
        Ok(Self { path, lines })
    }

    /// All lines or none.
    fn append(&mut self, lines: &str) -> Result<(), BatchError> {
        self.lines.append(lines).map_err(|source| BatchError::Io { path: self.path.clone(), source })
    }
}

impl ImprovementFiles {
    /// Begins both files, with what some rows have.
    pub(crate) fn begin<'a>(out: &Path, rows: impl Iterator<Item = &'a Row> + Clone) -> Result<Self, BatchError> {
        Ok(Self {
            checkpoints: Growing::begin(out.join("improvement.csv"), &checkpoints_text(rows.clone()))?,
            history: Growing::begin(out.join("history.csv"), &history_text(rows))?,
        })
    }

    /// Adds what a row has.
    pub(crate) fn append(&mut self, row: &Row) -> Result<(), BatchError> {
        let Some(numbers) = improvement(row) else { return Ok(()) };
        self.history.append(&history_lines(row, numbers))?;
        self.checkpoints.append(&checkpoint_lines(row, numbers))
    }

    /// Puts what rows have in their order.
    pub(crate) fn finish<'a>(self, rows: impl Iterator<Item = &'a Row> + Clone) -> Result<(), BatchError> {
        write_whole(&self.history.path, &history_text(rows.clone()))?;
        write_whole(&self.checkpoints.path, &checkpoints_text(rows))
    }
}

fn improvement(row: &Row) -> Option<&ImprovementNumbers> {
    row.answer.as_ref()?.improvement.as_ref()
}

fn checkpoints_text<'a>(rows: impl Iterator<Item = &'a Row>) -> String {
    let lines = rows.filter_map(|row| Some(checkpoint_lines(row, improvement(row)?)));
    lines.fold(csv_line(&CHECKPOINT_COLUMNS), |text, lines| text + &lines)
}

fn history_text<'a>(rows: impl Iterator<Item = &'a Row>) -> String {
    let lines = rows.filter_map(|row| Some(history_lines(row, improvement(row)?)));
    lines.fold(csv_line(&HISTORY_COLUMNS), |text, lines| text + &lines)
}

fn checkpoint_lines(row: &Row, numbers: &ImprovementNumbers) -> String {
    let name = [row.scene.clone(), row.seed.to_string(), row.id.clone()];
    numbers.checkpoints.iter().map(|checkpoint| csv_line(&[&name[..], &checkpoint.cells()].concat())).collect()
}

fn history_lines(row: &Row, numbers: &ImprovementNumbers) -> String {
    let line = |cost: &CostRow| {
        let seconds = format!("{:?}", cost.time.as_secs_f64());
        let (work, cost) = (cost.work.to_string(), format!("{:?}", cost.cost));
        csv_line(&[row.scene.clone(), row.seed.to_string(), row.id.clone(), seconds, work, cost])
    };
    numbers.history.iter().map(line).collect()
}

/// Gives rows of an earlier run what the files of `out` have of them, and drops rows that miss some of it.
pub(crate) fn join(out: &Path, rows: &mut Vec<(usize, Row)>) -> Result<(), BatchError> {
    let mut checkpoints = read_checkpoints(&out.join("improvement.csv"))?;
    let mut history = read(&out.join("history.csv"), &HISTORY_COLUMNS, cost_row, |cost| cost.work == 0)?;
    rows.retain_mut(|(_, row)| {
        let Some(numbers) = row.answer.as_mut().and_then(|answer| answer.improvement.as_mut()) else { return true };
        numbers.checkpoints = checkpoints.remove(&row.id).map(|(_, rows)| rows).unwrap_or_default();
        numbers.history = history.remove(&row.id).map(|(_, rows)| rows).unwrap_or_default();
        let is_whole = numbers.checkpoints.last().is_some_and(Checkpoint::is_end);
        is_whole && numbers.history.last().is_some_and(|last| last.cost == numbers.final_cost)
    });
    Ok(())
}

/// The scene, and its rows, by the identity of the solve.
pub(crate) type BySolve<T> = HashMap<String, (String, Vec<T>)>;

/// Reads an `improvement.csv`; one that is not there is empty.
pub(crate) fn read_checkpoints(path: &Path) -> Result<BySolve<Checkpoint>, BatchError> {
    read(path, &CHECKPOINT_COLUMNS, Checkpoint::of_cells, |checkpoint| checkpoint.at == Some(Duration::ZERO))
}

/// Reads rows that begin with scene, seed and identity. Those of a solve begin with its `first`: what stands before it was left by an
/// interruption.
fn read<T>(
    path: &Path,
    columns: &[&str],
    row: impl Fn(&[String]) -> Option<T>,
    is_first: impl Fn(&T) -> bool,
) -> Result<BySolve<T>, BatchError> {
    let mut found = BySolve::new();
    if !path.try_exists().map_err(|source| BatchError::Io { path: path.to_owned(), source })? {
        return Ok(found);
    }
    for (line, cells) in kept::table(path, columns)? {
        let damaged = || BatchError::Damaged { path: path.to_owned(), line, what: "is no row".into() };
        let (key, cells) = cells.split_at_checked(3).ok_or_else(damaged)?;
        let row = row(cells).ok_or_else(damaged)?;
        let (_, rows) = found.entry(key[2].clone()).or_insert_with(|| (key[0].clone(), Vec::new()));
        if is_first(&row) {
            rows.clear();
        }
        rows.push(row);
    }
    Ok(found)
}

fn cost_row(cells: &[String]) -> Option<CostRow> {
    let [seconds, work, cost] = cells else { return None };
    let time = Duration::try_from_secs_f64(seconds.parse().ok()?).ok()?;
    Some(CostRow { work: work.parse().ok()?, time, cost: cost.parse().ok()? })
}
