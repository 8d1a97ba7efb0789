//! Whether a file is well formed: names, sizes, numbers. What is wrong is told by its JSON path.

use crate::check::report::check_report::shown;
use crate::check::report::error::CheckError;
use crate::check::timing::structure as timing;
use crate::path_file::ConstraintEntry;
use crate::path_file::constraint::PoseRow;
use crate::path_file::document::{HandleEntry, PathFile, SegmentEntry, SurfaceEntry};
use crate::path_file::version;
use std::collections::HashSet;

/// Most parts of a file.
const PARTS: usize = 1024;
/// Most coordinates of a knot.
const COORDINATES: usize = 100_000;
/// Metres and radians beyond which a number is a slip (a million turns, a thousand kilometres).
const LARGEST: f64 = 1e6;
/// How far the quaternion of a frame may be from one; those of knots are held to more.
const UNIT: f64 = 1e-6;

type Checked = Result<(), CheckError>;

/// Refuses the first thing that is not well formed.
pub(super) fn check(file: &PathFile) -> Checked {
    sizes(file)?;
    for (index, part) in file.parts.iter().enumerate() {
        pose(&part.world_from_root, || format!("parts[{index}].world_from_root"))?;
    }
    unique("parts", "part", file.parts.iter().map(|p| p.name.as_str()))?;
    unique("coordinates", "coordinate", file.coordinates.iter().map(String::as_str))?;
    limits(file)?;
    version(file)?;
    timing::check(file)?;
    documents(file)?;
    for (index, (.., margin)) in file.margins.iter().enumerate() {
        number(*margin, || format!("margins[{index}][2]"))?;
    }
    number(file.placement_margin, || "placement_margin".into())?;
    number(file.rests.map_or(0.0, |rests| rests.margin), || "rests.margin".into())?;
    for (index, correction) in file.corrections.iter().enumerate() {
        number(correction.distance, || format!("corrections[{index}].distance"))?;
        number(correction.angle, || format!("corrections[{index}].angle"))?;
        if correction.object.is_some() == correction.joint.is_some() {
            return refuse(format!("corrections[{index}]"), "names either an object or a joint");
        }
    }
    for (what, value) in [
        ("path_tolerance", file.certificate.path_tolerance),
        ("max_residual", file.certificate.max_residual),
        ("min_clearance", file.certificate.min_clearance.unwrap_or_default()),
    ] {
        if value.is_nan() {
            return refuse(format!("certificate.{what}"), "is not a number");
        }
    }
    file.segments.iter().enumerate().try_for_each(|(index, s)| segment(file, index, s))
}

/// Keys are those of the file's version.
fn version(file: &PathFile) -> Checked {
    if !version::is_known(&file.format) {
        return refuse("format", format!("`{}` is not known", shown(&file.format)));
    }
    match version::later_key(file) {
        Some(key) => refuse(key, "this key belongs to version 2, the file is of version 1"),
        None => Ok(()),
    }
}

fn refuse(place: impl Into<String>, message: impl Into<String>) -> Checked {
    Err(CheckError::malformed(place, message))
}

fn sizes(file: &PathFile) -> Checked {
    if file.parts.is_empty() || file.parts.len() > PARTS {
        return refuse("parts", format!("{} parts are given, 1 to {PARTS} are read", file.parts.len()));
    }
    for (index, part) in file.parts.iter().enumerate() {
        if part.name.is_empty() || part.name.contains('/') || part.name.len() > 256 {
            return refuse(format!("parts[{index}].name"), "a part's name is short and has no `/`");
        }
    }
    if file.coordinates.len() > COORDINATES {
        return refuse("coordinates", format!("{} are more than {COORDINATES}", file.coordinates.len()));
    }
    match file.segments.is_empty() {
        true => refuse("segments", "a path has at least one segment"),
        false => Ok(()),
    }
}

fn unique<'a>(place: &str, what: &str, names: impl Iterator<Item = &'a str>) -> Checked {
    let mut seen = HashSet::new();
    for (index, name) in names.enumerate() {
        if !seen.insert(name) {
            return refuse(format!("{place}[{index}]"), format!("two {what}s are called `{}`", shown(name)));
        }
    }
    Ok(())
}

fn number(value: f64, place: impl FnOnce() -> String) -> Checked {
    match value.abs() <= LARGEST {
        true => Ok(()),
        false => refuse(place(), format!("{value} is no number between -1e6 and 1e6")),
    }
}

fn pose(row: &PoseRow, place: impl Fn() -> String) -> Checked {
    row.iter().try_for_each(|&x| number(x, &place))?;
    let norm = row[3..].iter().map(|x| x * x).sum::<f64>().sqrt();
    match (norm - 1.0).abs() <= UNIT {
        true => Ok(()),
        false => refuse(place(), format!("the quaternion (x y z w) has length {norm}, not 1")),
    }
}

fn limits(file: &PathFile) -> Checked {
    let known: HashSet<&str> = file.coordinates.iter().map(String::as_str).collect();
    for (name, [low, high]) in &file.limits {
        let place = || format!("limits[\"{}\"]", shown(name));
        if !known.contains(name.as_str()) {
            return refuse(place(), "is no coordinate");
        }
        // Compared so that NaN is refused.
        let in_order = low <= high;
        if !in_order {
            return refuse(place(), format!("{low} is above {high}"));
        }
    }
    Ok(())
}

fn documents(file: &PathFile) -> Checked {
    for (name, gripper) in &file.documents.grippers {
        pose(&gripper.link_from_gripper, || format!("documents.grippers[\"{}\"].link_from_gripper", shown(name)))?;
    }
    for (name, entry) in &file.documents.handles {
        handle(entry, || format!("documents.handles[\"{}\"]", shown(name)))?;
    }
    for (name, entry) in &file.documents.surfaces {
        surface(entry, || format!("documents.surfaces[\"{}\"]", shown(name)))?;
    }
    Ok(())
}

fn handle(entry: &HandleEntry, place: impl Fn() -> String) -> Checked {
    pose(&entry.link_from_handle, || format!("{}.link_from_handle", place()))?;
    match entry.mask[3..].iter().filter(|m| **m).count() == 1 {
        true => refuse(format!("{}.mask", place()), "exactly one fixed rotation describes no grasp"),
        false => Ok(()),
    }
}

fn surface(entry: &SurfaceEntry, place: impl Fn() -> String) -> Checked {
    for (index, point) in entry.points.iter().enumerate() {
        point.iter().try_for_each(|&x| number(x, || format!("{}.points[{index}]", place())))?;
    }
    for (index, polygon) in entry.polygons.iter().enumerate() {
        let place = || format!("{}.polygons[{index}]", place());
        if polygon.len() < 3 || polygon.iter().any(|&i| i as usize >= entry.points.len()) {
            return refuse(place(), "at least three indices of points are wanted");
        }
        let corners = crate::check::world::models::corners(entry, polygon);
        if crate::check::world::models::normal(&corners).is_none() {
            return refuse(place(), "has no area, so no normal");
        }
    }
    match entry.polygons.is_empty() {
        true => refuse(format!("{}.polygons", place()), "is empty"),
        false => Ok(()),
    }
}

fn segment(file: &PathFile, index: usize, entry: &SegmentEntry) -> Checked {
    if entry.knots.is_empty() {
        return refuse(format!("segments[{index}].knots"), "a segment has at least one knot");
    }
    for (knot, row) in entry.knots.iter().enumerate() {
        let place = || format!("segments[{index}].knots[{knot}]");
        if row.len() != file.coordinates.len() {
            let message = format!("has {} numbers, there are {} coordinates", row.len(), file.coordinates.len());
            return refuse(place(), message);
        }
        if let Some(column) = row.iter().position(|&x| number(x, String::new).is_err()) {
            return number(row[column], || format!("{}[{column}]", place()));
        }
    }
    for (number, entry) in entry.constraints.iter().enumerate() {
        constraint(entry, &format!("segments[{index}].constraints[{number}]"))?;
    }
    match &entry.times {
        Some(times) if times.len() != entry.knots.len() => {
            let message = format!("{} times for {} knots", times.len(), entry.knots.len());
            refuse(format!("segments[{index}].times"), message)
        }
        Some(times) => match times.iter().position(|t| !t.is_finite()) {
            Some(at) => refuse(format!("segments[{index}].times[{at}]"), "is not a finite number"),
            None => Ok(()),
        },
        None => Ok(()),
    }
}

fn constraint(entry: &ConstraintEntry, place: &str) -> Checked {
    if let Some(value) = &entry.value {
        pose(value, || format!("{place}.value"))?;
    }
    for (key, frame) in [("frame", &entry.frame), ("to", &entry.to)] {
        if let Some(within) = frame.as_ref().and_then(|f| f.parts().1) {
            pose(within, || format!("{place}.{key}.pose"))?;
        }
    }
    for (key, value) in [("height", entry.height), ("length", entry.length), ("position", entry.position)] {
        number(value.unwrap_or_default(), || format!("{place}.{key}"))?;
    }
    for (index, plane) in entry.planes.iter().enumerate() {
        number(plane.offset, || format!("{place}.planes[{index}].offset"))?;
        let length = glam::DVec3::from_array(plane.normal).length();
        let unit = (length - 1.0).abs() <= UNIT;
        if !unit {
            return refuse(format!("{place}.planes[{index}].normal"), format!("has length {length}, not 1"));
        }
    }
    unique(&format!("{place}.parts"), "part", entry.parts.iter().map(String::as_str))?;
    let (mask, sided) = (entry.mask.unwrap_or_default(), entry.inequality.unwrap_or_default());
    if mask.iter().zip(sided).any(|(counts, sided)| sided && !counts) {
        return refuse(format!("{place}.inequality"), "has rows that the mask leaves out");
    }
    let fine = entry.tolerance >= 0.0 && entry.tolerance <= LARGEST;
    match fine {
        true => Ok(()),
        false => refuse(format!("{place}.tolerance"), format!("{} is no tolerance", entry.tolerance)),
    }
}
