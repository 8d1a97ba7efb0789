//! Times for paths that have none: every piece from rest to rest, as fast as its limits allow.

use foliate_components::path::{ManipulationPath, SegmentTiming};
use foliate_components::problem::{Problem, RateLimits};

/// Gives a path times: along each piece all coordinates follow 3u² − 2u³. The robot stands still at every knot.
pub fn rest_to_rest(problem: &Problem, path: &mut ManipulationPath) {
    let limits = RateLimits::of(&problem.robot, &problem.timing);
    let mut now = 0.0;
    for segment in &mut path.segments {
        let mut times = vec![now];
        for pair in segment.knots.windows(2) {
            let duration = |(i, (a, b)): (usize, (&f64, &f64))| {
                let by = (b - a).abs();
                (1.5 * by / limits.velocity[i]).max((6.0 * by / limits.acceleration[i]).sqrt())
            };
            let of_piece = pair[0].iter().zip(&pair[1]).enumerate().map(duration).fold(0.0, f64::max);
            now += of_piece.max(problem.timing.dwell * f64::from(u8::from(of_piece == 0.0))) * (1.0 + 1e-12);
            times.push(now);
        }
        let velocities = vec![vec![0.0; segment.knots[0].len()]; segment.knots.len()];
        segment.timing = Some(SegmentTiming { times, velocities });
    }
}

/// Repeats the first knot of every segment that begins with an event, so that the path can stand still there.
#[allow(dead_code, reason = "each test uses its part")]
pub fn stand_still_at_events(path: &mut ManipulationPath) {
    let mut segments: Vec<usize> =
        foliate_components::path::events(path).into_iter().map(|event| event.segment).collect();
    segments.dedup();
    for index in segments {
        let first = path.segments[index].knots[0].clone();
        path.segments[index].knots.insert(0, first);
    }
}
