//! What is wrong with a start or goal that is infeasible, as rows.

use crate::planner::answer::NoSolutionReason;
use crate::planner::recording::document::{FindingEntry, MisplacedEntry};
use foliate_components::infeasibility::{CollidingPair, Infeasibility, NearestState};
use foliate_components::pose::pose_to_array;
use foliate_components::problem::{Correction, Moved};

/// Rows of a reason; none where it is about no start or goal.
pub(crate) fn findings(reason: &NoSolutionReason) -> Vec<FindingEntry> {
    match reason {
        NoSolutionReason::InfeasibleStart(why) => rows("start", why),
        NoSolutionReason::InfeasibleGoal(why) => rows("goal", why),
        _ => Vec::new(),
    }
}

fn rows(at: &str, why: &Infeasibility) -> Vec<FindingEntry> {
    let row = FindingEntry { at: at.into(), words: why.to_string(), ..FindingEntry::default() };
    match why {
        Infeasibility::Collision(pairs) => pairs.iter().map(|pair| pair_row(at, pair)).collect(),
        Infeasibility::OutOfBounds { coordinate, value, bounds: (low, high), .. } => {
            let limit = if value < low { *low } else { *high };
            vec![FindingEntry { coordinate: Some(coordinate.clone()), ..with_numbers(row, *value, limit) }]
        }
        Infeasibility::Locked { coordinate, value, locked_at } => {
            vec![FindingEntry { coordinate: Some(coordinate.clone()), ..with_numbers(row, *value, *locked_at) }]
        }
        Infeasibility::NoState { nearest: Some(nearest), .. } => state_rows(row, nearest),
        Infeasibility::FingersBlocked { by: Some((first, second)) } => {
            vec![FindingEntry { shapes: Some([first.clone(), second.clone()]), ..row }]
        }
        Infeasibility::GoalsNotFound(failures) => {
            failures.iter().map(|failure| FindingEntry { words: failure.message.clone(), ..row.clone() }).collect()
        }
        _ => vec![row],
    }
}

/// What keeps a configuration out of the nearest state; where several things would have to be moved, a row for each of the others.
fn state_rows(row: FindingEntry, nearest: &NearestState) -> Vec<FindingEntry> {
    let at = row.at.clone();
    let mut corrections = nearest.corrections.iter();
    let first = corrections.next().map_or_else(FindingEntry::default, correction_row);
    let whole = FindingEntry { at: row.at, words: row.words, ..first };
    let others = corrections.map(|correction| FindingEntry { at: at.clone(), ..correction_row(correction) });
    std::iter::once(with_numbers(whole, nearest.residual, 0.0)).chain(others).collect()
}

/// Something that would have to be moved.
fn correction_row(correction: &Correction) -> FindingEntry {
    let (name, angle) = (&correction.name, correction.angle);
    let (coordinate, misplaced) = match correction.moved {
        Moved::Object(_, pose) => {
            (None, Some(MisplacedEntry { object: name.clone(), pose: pose_to_array(&pose), angle }))
        }
        _ => (Some(name.clone()), None),
    };
    FindingEntry { words: correction.to_words(), coordinate, misplaced, ..FindingEntry::default() }
}

/// What is not finite has no word in JSON.
fn with_numbers(row: FindingEntry, value: f64, limit: f64) -> FindingEntry {
    let finite = |x: f64| x.is_finite().then_some(x);
    FindingEntry { value: finite(value), limit: finite(limit), ..row }
}

fn pair_row(at: &str, pair: &CollidingPair) -> FindingEntry {
    let row = FindingEntry {
        at: at.into(),
        words: pair.to_string(),
        shapes: Some([pair.names.0.clone(), pair.names.1.clone()]),
        links: Some([pair.links.0.clone(), pair.links.1.clone()]),
        ..FindingEntry::default()
    };
    with_numbers(row, pair.distance, pair.margin)
}
