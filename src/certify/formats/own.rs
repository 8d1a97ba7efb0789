//! Path files of our own: knots as a polyline, or with velocities as a curve, and objects on what carries them.

use crate::certify::formats::table::Table;
use crate::certify::motion::piecewise::{Attachment, POINTS, Point};
use crate::path_file::document::{AttachmentEntry, FORMAT, FORMAT_1, PathFile, SegmentEntry};
use crate::path_file::version;
use crate::scene::reading::error::SceneError;
use std::collections::BTreeMap;

/// A knot that differs by less from the one before is the same: segments share theirs. Radians, metres.
const SAME: f64 = 1e-3;

pub(super) fn read(file: &str, text: &str) -> Result<Table, SceneError> {
    let path: PathFile = serde_json::from_str(text)
        .map_err(|e| SceneError::new(file, "path", format!("cannot be read: {e}")).at(u32::try_from(e.line()).ok()))?;
    if !version::is_known(&path.format) {
        return Err(SceneError::new(file, "format", format!("is neither `{FORMAT}` nor `{FORMAT_1}`")));
    }
    if let Some(key) = version::later_key(&path) {
        return Err(SceneError::new(file, key, format!("belongs to `{FORMAT}`, the file is of `{FORMAT_1}`")));
    }
    let is_curve = path.segments.iter().all(|s| s.velocities.is_some());
    let mut table = Table { element: "knots", shortest: false, scaled: is_curve, ..Table::default() };
    let mut carriers: BTreeMap<String, Option<String>> = BTreeMap::new();
    let timed = path.segments.iter().all(|s| s.times.is_some());
    for (index, segment) in path.segments.iter().enumerate() {
        if table.points.len() + segment.knots.len() > POINTS {
            return Err(SceneError::new(file, format!("segments[{index}]"), format!("more than {POINTS} knots")));
        }
        let times = segment.times.as_ref().filter(|_| timed);
        for (number, knot) in segment.knots.iter().enumerate() {
            let time = times.and_then(|times| times.get(number).copied());
            let row = |rows: &Vec<Vec<f64>>| rows.get(number).cloned();
            let velocities = segment.velocities.as_ref().filter(|_| is_curve).and_then(row);
            // Segments share their joint knot; knots of one time are one, where nothing moves.
            let joins = table.points.last().is_some_and(|last| {
                let is_joint = number == 0 && index > 0;
                (is_joint || (is_curve && last.time == time)) && same(&last.positions, knot)
            });
            if !joins {
                table.points.push(Point { time, positions: knot.clone(), velocities, accelerations: None });
            }
            if number == 0 {
                let at = table.points.last().and_then(|p| p.time).unwrap_or(table.points.len() as f64 - 1.0);
                attach(&path, segment, at, &mut carriers, &mut table.attachments);
            }
        }
    }
    table
        .notes
        .push(String::from("path file: its knots as they stand; its constraints are what `foliate check` proves"));
    table.joints = Some(path.coordinates);
    Ok(table)
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(x, y)| (x - y).abs() <= SAME)
}

/// What is attached to something else than before.
fn attach(
    path: &PathFile,
    segment: &SegmentEntry,
    time: f64,
    carriers: &mut BTreeMap<String, Option<String>>,
    attachments: &mut Vec<Attachment>,
) {
    let mut now: BTreeMap<String, Option<String>> = carriers.keys().map(|object| (object.clone(), None)).collect();
    for entry in segment.attachments.iter().filter(|a| a.carrier && !a.object.contains('/')) {
        now.insert(entry.object.clone(), link_of(path, entry));
    }
    for (object, link) in now {
        let before = carriers.get(&object).cloned().flatten();
        if before != link {
            attachments.push(Attachment { object: object.clone(), link: link.clone(), time });
        }
        carriers.insert(object, link);
    }
}

/// The link that carries an object by an attachment.
fn link_of(path: &PathFile, entry: &AttachmentEntry) -> Option<String> {
    let gripper = entry.gripper.as_ref().and_then(|g| path.documents.grippers.get(g)).map(|g| g.link.clone());
    let support = entry.support.as_ref().and_then(|s| path.documents.surfaces.get(s)).map(|s| s.link.clone());
    gripper.or(support).or_else(|| entry.on.clone())
}
