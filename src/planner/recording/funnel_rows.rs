//! The funnel in a recording: what became of the candidates of each transition, and the pairs that stopped them.

use crate::planner::recording::document::{BlockedPairEntry, FunnelEntry, GoalSearchEntry, LEFT_OUT, RejectionEntry};
use crate::planner::recording::graph_rows::GraphRows;
use crate::planner::search_record::SearchRecord;
use foliate_components::outcome::{GoalStatistics, Rejection, TransitionStatistics};
use foliate_components::robot::{Robot, ShapeIndex};
use std::collections::BTreeMap;

/// Pairs of a transition, or of goals, that are listed.
const MOST_PAIRS: usize = 64;

/// The rows of a funnel, and the configurations to which their pairs refer.
#[derive(Debug, Default)]
pub(crate) struct FunnelRows {
    pub rows: Vec<FunnelEntry>,
    /// End to end.
    pub collisions: Vec<f32>,
    pub rows_left_out: u64,
    pub pairs_left_out: u64,
    pub collisions_left_out: u64,
}

impl FunnelRows {
    /// The funnel of a search: transitions by id; with at most so many bytes of configurations, those of the most frequent pairs.
    pub fn new(robot: &Robot, record: &SearchRecord, graph: &GraphRows, most_bytes: u64) -> Self {
        let mut rows = Self::default();
        let mut frequent = Vec::new();
        for (id, statistics) in &record.funnel {
            let transition = graph.transition(id.0);
            if transition == LEFT_OUT {
                rows.rows_left_out += 1;
                continue;
            }
            let pairs = most_frequent(&statistics.blocked_by);
            rows.pairs_left_out += (statistics.blocked_by.len() - pairs.len()) as u64;
            for (place, &(pair, count)) in pairs.iter().enumerate() {
                if let Some(q) = record.collisions.get(&(*id, pair)) {
                    frequent.push((count, rows.rows.len(), place, q));
                }
            }
            rows.rows.push(row(robot, transition, statistics, &pairs));
        }
        frequent.sort_by_key(|&(count, row, place, _)| (std::cmp::Reverse(count), row, place));
        let room = most_bytes / (4 * record.width.max(1) as u64);
        for (number, (_, row, place, q)) in (0_u32..).zip(frequent) {
            if u64::from(number) < room {
                rows.rows[row].pairs[place].at = Some(number);
                rows.collisions.extend(q);
            } else {
                rows.collisions_left_out += 1;
            }
        }
        rows
    }
}

type CountedPair = ((ShapeIndex, ShapeIndex), u64);

fn most_frequent(pairs: &BTreeMap<(ShapeIndex, ShapeIndex), u64>) -> Vec<CountedPair> {
    let mut all: Vec<CountedPair> = pairs.iter().map(|(&pair, &count)| (pair, count)).collect();
    all.sort_by_key(|&(pair, count)| (std::cmp::Reverse(count), pair));
    all.truncate(MOST_PAIRS);
    all
}

fn pair_row(robot: &Robot, &((first, second), count): &CountedPair) -> BlockedPairEntry {
    let shape = |shape: ShapeIndex| robot.shapes[shape.at()].name.clone();
    let link = |shape: ShapeIndex| robot.links[robot.shapes[shape.at()].link.at()].name.clone();
    BlockedPairEntry { shapes: [shape(first), shape(second)], links: [link(first), link(second)], count, at: None }
}

fn row(robot: &Robot, transition: u32, statistics: &TransitionStatistics, pairs: &[CountedPair]) -> FunnelEntry {
    let count = |which: fn(&Rejection) -> bool| {
        statistics.rejections.iter().filter(|(reason, _)| which(reason)).map(|(_, n)| n).sum::<u64>()
    };
    let projected = statistics.attempts.saturating_sub(count(|reason| !is_projected(*reason)));
    let free = projected.saturating_sub(count(|reason| matches!(reason, Rejection::WaypointBlocked(_))));
    let rejection = |(reason, &count): (&Rejection, &u64)| RejectionEntry {
        reason: reason.describe().into(),
        leg: reason.leg(),
        count,
    };
    FunnelEntry {
        transition,
        tried: statistics.attempts,
        projected,
        free,
        reached: statistics.reached,
        partial: statistics.partial,
        rejections: statistics.rejections.iter().map(rejection).collect(),
        pairs: pairs.iter().map(|pair| pair_row(robot, pair)).collect(),
    }
}

/// Whether all waypoints of a candidate were found that was rejected for a reason.
fn is_projected(reason: Rejection) -> bool {
    matches!(
        reason,
        Rejection::WaypointBlocked(_)
            | Rejection::SteeringFailed(_)
            | Rejection::MotionBlocked(_)
            | Rejection::NoProgress
    )
}

/// How goals fared; and how many pairs are left out.
pub(crate) fn goal_search(robot: &Robot, statistics: &GoalStatistics) -> (GoalSearchEntry, u64) {
    let pairs = most_frequent(&statistics.blocked_by);
    let left_out = (statistics.blocked_by.len() - pairs.len()) as u64;
    let row = GoalSearchEntry {
        tries: statistics.tries,
        found: statistics.found,
        projection_failed: statistics.projection_failed,
        refused: statistics.refused,
        pairs: pairs.iter().map(|pair| pair_row(robot, pair)).collect(),
    };
    (row, left_out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::graph::TransitionId;
    use foliate_components::samples::swap_two_boxes;

    #[test]
    fn candidates_are_told_by_how_far_they_came() {
        let robot = swap_two_boxes().expect("a sample").robot;
        let pair = (ShapeIndex(0), ShapeIndex(1));
        let mut statistics =
            TransitionStatistics { attempts: 20, reached: 3, partial: 2, ..TransitionStatistics::default() };
        for (reason, times) in [
            (Rejection::NoLeafToAimAt, 1),
            (Rejection::ProjectionFailed(0), 4),
            (Rejection::OutOfBounds(1), 1),
            (Rejection::WaypointBlocked(0), 5),
            (Rejection::SteeringFailed(1), 2),
            (Rejection::MotionBlocked(1), 4),
        ] {
            (0..times).for_each(|_| statistics.count_rejection(reason, Some(pair)));
        }
        let row = row(&robot, 7, &statistics, &most_frequent(&statistics.blocked_by));
        assert_eq!((row.transition, row.tried, row.projected, row.free, row.reached), (7, 20, 14, 9, 3));
        assert_eq!(row.rejections.iter().map(|rejection| rejection.count).sum::<u64>() + row.reached, row.tried);
        assert_eq!((row.pairs.len(), row.pairs[0].count), (1, 17));
        assert_eq!(row.pairs[0].shapes[0], robot.shapes[0].name);
    }

    #[test]
    fn the_most_frequent_pairs_have_their_configurations() {
        let robot = swap_two_boxes().expect("a sample").robot;
        let mut statistics = TransitionStatistics { attempts: 9, ..TransitionStatistics::default() };
        let pairs = [(0, 1, 2), (0, 2, 5), (1, 2, 1)];
        for (first, second, times) in pairs {
            let pair = (ShapeIndex(first), ShapeIndex(second));
            (0..times).for_each(|_| statistics.count_rejection(Rejection::MotionBlocked(0), Some(pair)));
        }
        let id = TransitionId(0);
        let collisions = pairs.map(|(a, b, n)| ((id, (ShapeIndex(a), ShapeIndex(b))), vec![n as f32; 2]));
        let record = SearchRecord {
            width: 2,
            funnel: vec![(id, statistics)],
            collisions: collisions.into_iter().collect(),
            ..SearchRecord::default()
        };
        let graph = GraphRows::with_transitions(&[0]);
        let rows = FunnelRows::new(&robot, &record, &graph, 16);
        assert_eq!(rows.collisions, [5.0, 5.0, 2.0, 2.0]);
        assert_eq!(rows.rows[0].pairs.iter().map(|pair| pair.at).collect::<Vec<_>>(), [Some(0), Some(1), None]);
        assert_eq!((rows.collisions_left_out, rows.pairs_left_out, rows.rows_left_out), (1, 0, 0));
        assert_eq!(FunnelRows::new(&robot, &record, &GraphRows::default(), 16).rows_left_out, 1);
    }
}
