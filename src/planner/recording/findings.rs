//! What is wrong with a start or goal that is infeasible, as rows.

use crate::planner::answer::NoSolutionReason;
use crate::planner::recording::document::FindingEntry;
use foliate_components::infeasibility::{CollidingPair, Infeasibility};

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
        Infeasibility::NoState { nearest: Some(nearest), .. } => vec![with_numbers(row, nearest.residual, 0.0)],
        Infeasibility::FingersBlocked { by: Some((first, second)) } => {
            vec![FindingEntry { shapes: Some([first.clone(), second.clone()]), ..row }]
        }
        Infeasibility::GoalsNotFound(failures) => {
            failures.iter().map(|failure| FindingEntry { words: failure.message.clone(), ..row.clone() }).collect()
        }
        _ => vec![row],
    }
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
