//! From the problems to the paths: where rows of a group were lost.

use crate::batch::report::groups::Group;
use crate::batch::results::row::RowOutcome;

/// A stage: its name, and how many rows got there.
pub(crate) type Stage = (&'static str, usize);

/// The stages of a group: each counts rows that the one before counts, too. All groups of a page have the same stages.
pub(crate) fn stages(group: &Group<'_>, varied: bool, improved: bool) -> Vec<Stage> {
    let count = |is: &dyn Fn(RowOutcome) -> bool| group.rows.iter().filter(|row| is(row.outcome)).count();
    let is_posed = |outcome| outcome != RowOutcome::NoInstance;
    let is_feasible =
        |outcome| is_posed(outcome) && !matches!(outcome, RowOutcome::InfeasibleStart | RowOutcome::InfeasibleGoal);
    let ended = |outcome| is_feasible(outcome) && !matches!(outcome, RowOutcome::Crashed | RowOutcome::Failed);
    let mut stages = vec![("rows", group.rows.len())];
    if varied {
        stages.push(("instances", count(&is_posed)));
    }
    stages.push(("feasible ends", count(&is_feasible)));
    stages.push(("searched", count(&ended)));
    stages.push(("path", count(&|outcome| outcome == RowOutcome::Solved)));
    if improved {
        let answers = group.rows.iter().filter_map(|row| row.answer.as_ref());
        stages.push(("path with times", answers.filter(|answer| answer.duration.is_some()).count()));
    }
    stages
}

/// Why rows have no path: outcomes and counts, the most frequent first.
pub(crate) fn lost(group: &Group<'_>) -> Vec<(&'static str, usize)> {
    let mut counts: Vec<(&'static str, usize)> = Vec::new();
    for row in group.rows.iter().filter(|row| !row.is_solved()) {
        match counts.iter_mut().find(|(name, _)| *name == row.outcome.name()) {
            Some((_, count)) => *count += 1,
            None => counts.push((row.outcome.name(), 1)),
        }
    }
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts
}
