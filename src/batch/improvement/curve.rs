//! What paths cost over time: the median of several improvements and the band around it.

use crate::batch::improvement::quantile::quantile;
use crate::planner::refinement::CostRow;

/// One time of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CurvePoint {
    /// Seconds since the improvements began.
    pub seconds: f64,
    /// 10th percentile of the costs.
    pub low: f64,
    /// Median.
    pub median: f64,
    /// 90th percentile.
    pub high: f64,
}

/// The curve at some times, seconds. A cost holds until the next better path, the last one for ever.
pub(crate) fn curve(histories: &[&[CostRow]], times: &[f64]) -> Vec<CurvePoint> {
    let point = |&seconds: &f64| {
        let costs: Vec<f64> = histories.iter().filter_map(|history| cost_at(history, seconds)).collect();
        let of = |share| quantile(&costs, share);
        Some(CurvePoint { seconds, low: of(0.1)?, median: of(0.5)?, high: of(0.9)? })
    };
    times.iter().filter_map(point).collect()
}

fn cost_at(history: &[CostRow], seconds: f64) -> Option<f64> {
    let next = history.partition_point(|row| row.time.as_secs_f64() <= seconds);
    Some(history.get(next.max(1) - 1)?.cost)
}

#[cfg(test)]
mod tests {
    use super::{CurvePoint, curve};
    use crate::planner::refinement::CostRow;
    use std::time::Duration;

    #[test]
    fn costs_hold_until_the_next_better_path() {
        let row = |seconds, cost| CostRow { work: 0, time: Duration::from_secs(seconds), cost };
        let (one, two) = ([row(0, 9.0), row(2, 5.0)], [row(0, 7.0), row(1, 3.0), row(4, 1.0)]);
        let medians = curve(&[&one, &two], &[0.0, 1.5, 2.0, 100.0]).into_iter().map(|p| p.median).collect::<Vec<_>>();
        assert_eq!(medians, [8.0, 6.0, 4.0, 3.0]);
        let alone = CurvePoint { seconds: 3.0, low: 5.0, median: 5.0, high: 5.0 };
        assert_eq!(curve(&[&one], &[3.0]), [alone]);
        assert_eq!(curve(&[], &[3.0]), []);
    }
}
