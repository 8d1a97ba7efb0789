//! What a check refuses, at its place in time.

use crate::check::{CheckReport, Kind, Violation};
use crate::planner::trajectory::trajectory::Trajectory;
use crate::view::document::path::RefusalEntry;
use foliate_components::robot::Robot;

/// The broken promises of a path, those of the file as a whole first, then in the order of time.
pub(crate) fn refusals(report: &CheckReport, trajectory: &Trajectory<'_>) -> Vec<RefusalEntry> {
    let entry = |violation: &Violation| RefusalEntry {
        time: violation.segment.and_then(|segment| time(trajectory, segment, violation.t.unwrap_or(0.0))),
        words: words(violation),
        links: links(trajectory.robot(), &violation.subject),
    };
    let mut entries: Vec<RefusalEntry> = report.violations.iter().map(entry).collect();
    entries.sort_by(|a, b| {
        let at = |entry: &RefusalEntry| entry.time.unwrap_or(f64::NEG_INFINITY);
        at(a).total_cmp(&at(b))
    });
    entries
}

/// The time of a place of a segment, in knots: half way between two knots is half way between their times.
fn time(trajectory: &Trajectory<'_>, segment: usize, t: f64) -> Option<f64> {
    let times = &trajectory.path().segments.get(segment)?.timing.as_ref()?.times;
    let last = times.len().checked_sub(1)?;
    let t = t.clamp(0.0, last as f64);
    let knot = (t.floor() as usize).min(last);
    let next = (knot + 1).min(last);
    let share = t - knot as f64;
    Some(times[knot] + share * (times[next] - times[knot]) - trajectory.start())
}

fn words(violation: &Violation) -> String {
    let what = match violation.kind {
        Kind::Collision => "collision".to_owned(),
        Kind::Margin => "closer than the margin".to_owned(),
        Kind::Enclosed => "one inside the other".to_owned(),
        kind => kind.name().replace('-', " "),
    };
    let mut words = format!("{what}: {}", violation.subject);
    if let Some(value) = violation.value {
        words += &format!(": {}", number(value));
    }
    if let Some(limit) = violation.limit {
        words += &format!(" (allowed {})", number(limit));
    }
    words
}

/// A number with four digits, as people write it.
fn number(x: f64) -> String {
    let size = x.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{x:.3e}");
    }
    let before = if size < 1.0 { 0 } else { size.log10() as usize + 1 };
    let text = format!("{x:.*}", 4_usize.saturating_sub(before));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The two links that a subject names: `a - b`, or `a inside b`.
fn links(robot: &Robot, subject: &str) -> Option<[usize; 2]> {
    let link = |name: &str| robot.link(name).map(|link| link.at());
    let (first, second) = [" - ", " inside "].iter().find_map(|between| subject.split_once(between))?;
    Some([link(first.trim())?, link(second.trim())?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases =
            [(57.2, "57.2"), (2.0, "2"), (17315.2, "17315"), (0.0, "0"), (-0.0312, "-0.0312"), (2.5e-7, "2.500e-7")];
        for (x, text) in cases {
            assert_eq!(number(x), text);
        }
    }
}
