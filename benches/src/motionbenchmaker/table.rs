//! Sums rows up: a table by set, and a CSV of all rows.

use crate::motionbenchmaker::run::Row;
use std::fmt::Write as _;

/// Sets and all problems together, in Markdown. Milliseconds are of problems that were solved.
#[must_use]
pub fn markdown(rows: &[Row]) -> String {
    let mut sets: Vec<&str> = rows.iter().map(|row| row.set.as_str()).collect();
    sets.dedup();
    let checked = rows.iter().any(|row| row.verdict.is_some());
    let mut text = format!(
        "| set | solves | infeasible start | infeasible goal | solved | not solved | certified |{} median (ms) | 95 % (ms) | worst (ms) | \
         median of preparing (ms) |\n| :-- | --: | --: | --: | --: | --: | --: |{} --: | --: | --: | --: |\n",
        if checked { " proved by the checker |" } else { "" },
        if checked { " --: |" } else { "" },
    );
    for set in sets {
        let of_set: Vec<&Row> = rows.iter().filter(|row| row.set == set).collect();
        text += &line(set, &of_set, checked);
    }
    text + &line("all", &rows.iter().collect::<Vec<_>>(), checked)
}

fn line(name: &str, rows: &[&Row], checked: bool) -> String {
    let count = |is: &dyn Fn(&Row) -> bool| rows.iter().filter(|row| is(row)).count();
    let solved: Vec<&Row> = rows.iter().copied().filter(|row| row.is_solved()).collect();
    let milliseconds = sorted(solved.iter().map(|row| row.solve.as_secs_f64() * 1e3));
    let preparing = sorted(rows.iter().map(|row| row.prepare.as_secs_f64() * 1e3));
    let mut text = format!(
        "| {name} | {} | {} | {} | {} | {} | {} |",
        rows.len(),
        count(&|row| row.outcome == "infeasible_start"),
        count(&|row| row.outcome == "infeasible_goal"),
        solved.len(),
        count(&|row| !row.is_solved() && !row.is_infeasible()),
        count(&|row| row.is_certified),
    );
    if checked {
        let _ = write!(text, " {} |", count(&|row| row.verdict == Some("proved")));
    }
    for part in [0.5, 0.95, 1.0] {
        let _ = write!(text, " {} |", told(quantile(&milliseconds, part)));
    }
    text + &format!(" {} |\n", told(quantile(&preparing, 0.5)))
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The smallest of sorted values that at least this part of them does not exceed; none of nothing.
#[must_use]
pub fn quantile(sorted: &[f64], part: f64) -> Option<f64> {
    let at = (part * sorted.len() as f64).ceil() as usize;
    sorted.get(at.saturating_sub(1)).copied()
}

/// Three significant digits.
fn told(milliseconds: Option<f64>) -> String {
    let Some(value) = milliseconds else { return "-".into() };
    let digits = (2 - value.max(1e-3).log10().floor() as i32).clamp(0, 3) as usize;
    format!("{value:.digits$}")
}

/// A line per solve, seconds.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    let mut text = "set,index,seed,outcome,solve_s,prepare_s,load_s,candidates,certified,checker,detail\n".to_owned();
    for row in rows {
        let _ = writeln!(
            text,
            "{},{},{},{},{:.9},{:.9},{:.9},{},{},{},{}",
            field(&row.set),
            row.index,
            row.seed,
            row.outcome,
            row.solve.as_secs_f64(),
            row.prepare.as_secs_f64(),
            row.load.as_secs_f64(),
            row.candidates,
            row.is_certified,
            row.verdict.unwrap_or(""),
            field(&row.detail)
        );
    }
    text
}

fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into() }
}
