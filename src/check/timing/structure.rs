//! Whether times, velocities, limits of rates and events are well formed.

use crate::check::report::check_report::shown;
use crate::check::report::error::CheckError;
use crate::path_file::document::{EventEntry, FORMAT_1, PathFile, RateLimitEntry, SegmentEntry};
use std::collections::HashSet;

/// Seconds, and metres and radians per second, beyond which a number is a slip.
const LARGEST: f64 = 1e6;

type Checked = Result<(), CheckError>;

/// Refuses the first thing of a file of version 2 that is not well formed.
pub(crate) fn check(file: &PathFile) -> Checked {
    if file.format == FORMAT_1 {
        return Ok(());
    }
    let has_times = file.segments.iter().any(|segment| segment.times.is_some());
    for (index, entry) in file.segments.iter().enumerate() {
        segment(file, index, entry, has_times)?;
    }
    limits(file, has_times)?;
    for (index, entry) in file.events.iter().flatten().enumerate() {
        event(file, entry, &format!("events[{index}]"), has_times)?;
    }
    claims(file, has_times)
}

fn refuse(place: impl Into<String>, message: impl Into<String>) -> Checked {
    Err(CheckError::malformed(place, message))
}

/// Positions and velocities of fingers are read as other numbers of the same kind.
fn number(value: f64, place: impl FnOnce() -> String) -> Checked {
    match value.abs() <= LARGEST {
        true => Ok(()),
        false => refuse(place(), format!("{value} is no number between -1e6 and 1e6")),
    }
}

fn segment(file: &PathFile, index: usize, entry: &SegmentEntry, has_times: bool) -> Checked {
    let place = |key: &str| format!("segments[{index}].{key}");
    let rows = match (&entry.times, &entry.velocities) {
        (None, None) if has_times => return refuse(place("times"), "is missing: other segments have times"),
        (None, None) => return Ok(()),
        (None, Some(_)) => return refuse(place("times"), "is missing: the segment has velocities"),
        (Some(_), None) => return refuse(place("velocities"), "is missing: the segment has times"),
        (Some(times), Some(rows)) => {
            times.iter().enumerate().try_for_each(|(knot, &t)| number(t, || format!("{}[{knot}]", place("times"))))?;
            rows
        }
    };
    if rows.len() != entry.knots.len() {
        return refuse(place("velocities"), format!("{} rows for {} knots", rows.len(), entry.knots.len()));
    }
    for (knot, row) in rows.iter().enumerate() {
        let place = || format!("{}[{knot}]", place("velocities"));
        if row.len() != file.coordinates.len() {
            let message = format!("has {} numbers, there are {} coordinates", row.len(), file.coordinates.len());
            return refuse(place(), message);
        }
        for (column, &value) in row.iter().enumerate() {
            number(value, || format!("{}[{column}]", place()))?;
        }
    }
    Ok(())
}

fn limits(file: &PathFile, has_times: bool) -> Checked {
    let table = match (&file.rate_limits, has_times) {
        (None, false) => return Ok(()),
        (None, true) => return refuse("rate_limits", "is missing: the path has times"),
        (Some(_), false) => return refuse("rate_limits", "the path has no times"),
        (Some(table), true) => table,
    };
    let known: HashSet<&str> = file.coordinates.iter().map(String::as_str).collect();
    for (name, &RateLimitEntry { velocity, acceleration, jerk }) in table {
        let place = format!("rate_limits[\"{}\"]", shown(name));
        if !known.contains(name.as_str()) {
            return refuse(place, "is no coordinate");
        }
        for (key, limit) in [("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)] {
            let is_limit = limit.is_none_or(|limit| limit > 0.0 && limit.is_finite());
            if !is_limit {
                return refuse(format!("{place}.{key}"), "a limit is finite and more than 0");
            }
        }
    }
    Ok(())
}

fn event(file: &PathFile, entry: &EventEntry, place: &str, has_times: bool) -> Checked {
    if entry.segment == 0 || entry.segment >= file.segments.len() {
        let message = format!("{} is not one of 1 to {}", entry.segment, file.segments.len() - 1);
        return refuse(format!("{place}.segment"), message);
    }
    if !["grasp", "release"].contains(&entry.kind.as_str()) {
        return refuse(format!("{place}.kind"), format!("`{}` is none of grasp, release", shown(&entry.kind)));
    }
    match entry.time {
        None if has_times => return refuse(format!("{place}.time"), "is missing"),
        Some(_) if !has_times => return refuse(format!("{place}.time"), "the path has no times"),
        Some(time) => number(time, || format!("{place}.time"))?,
        None => {}
    }
    let is_dwell = entry.dwell >= 0.0 && entry.dwell <= LARGEST;
    if !is_dwell {
        return refuse(format!("{place}.dwell"), format!("{} is no number of seconds", entry.dwell));
    }
    for (name, position) in &entry.fingers {
        number(*position, || format!("{place}.fingers[\"{}\"]", shown(name)))?;
    }
    Ok(())
}

fn claims(file: &PathFile, has_times: bool) -> Checked {
    let claims = &file.certificate;
    for (key, share) in [("max_velocity", claims.max_velocity), ("max_acceleration", claims.max_acceleration)] {
        let Some(share) = share else { continue };
        let is_share = has_times && share >= 0.0 && share.is_finite();
        if !is_share {
            return refuse(format!("certificate.{key}"), "is a share of a limit, in a path with times");
        }
    }
    match claims.continuity {
        None => Ok(()),
        Some(1 | 2) if has_times => Ok(()),
        Some(_) => refuse("certificate.continuity", "is 1 or 2, in a path with times"),
    }
}
