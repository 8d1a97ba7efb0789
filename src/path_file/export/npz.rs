//! NumPy archives: arrays with a row for each sample.

use crate::path_file::export::columns::columns;
use crate::path_file::export::options::{ExportError, ExportOptions, fits};
use crate::planner::trajectory::trajectory::Trajectory;
use foliate_components::path::EventKind;
use foliate_components::pose::pose_to_array;
use foliate_components::robot::{LinkIndex, PartKind};
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// A trajectory as NumPy arrays. Poses are x y z qx qy qz qw in the world.
///
/// | array | shape | |
/// |---|---|---|
/// | `time` | samples | seconds |
/// | `joint_names` | joints | of robots `part/joint`, their roots as `part/x` …; then joints of objects |
/// | `positions`, `velocities`, `accelerations` | samples × joints | rad, m; per second; per second squared |
/// | `link_names`, `link_poses` | links; samples × links × 7 | links of robots |
/// | `object_names`, `object_poses` | links; samples × links × 7 | links of objects: `part` for the root link |
/// | `segment_starts`, `segment_states` | segments | seconds; names |
/// | `event_times`, `event_dwells` | events | seconds |
/// | `event_kinds`, `event_objects`, `event_grippers`, `event_handles` | events | `grasp` or `release`; names |
///
/// # Errors
/// There is no such robot or joint; the rate is none; there are more than 2²⁶ numbers.
pub fn npz(trajectory: &Trajectory<'_>, options: &ExportOptions) -> Result<Vec<u8>, ExportError> {
    let columns = columns(trajectory, options)?;
    let times: Vec<f64> = trajectory.sample_times(options.rate)?.collect();
    let (links, objects) = (links(trajectory, PartKind::Robot), links(trajectory, PartKind::Object));
    fits(times.len(), 3 * columns.len() + 7 * (links.len() + objects.len()))?;
    let mut rows: [Vec<f64>; 3] = std::array::from_fn(|_| Vec::with_capacity(times.len() * columns.len()));
    let (mut link_poses, mut object_poses) = (Vec::new(), Vec::new());
    let mut poses = trajectory.poses();
    for &time in &times {
        let moment = trajectory.moment(time);
        for column in &columns {
            let numbers = column.at(trajectory, &moment);
            rows.iter_mut().zip(numbers).for_each(|(row, number)| row.push(number));
        }
        poses.place(time);
        link_poses.extend(links.iter().flat_map(|(_, link)| pose_to_array(&poses.link(*link))));
        object_poses.extend(objects.iter().flat_map(|(_, link)| pose_to_array(&poses.link(*link))));
    }
    let mut archive = Archive::new();
    let (count, [positions, velocities, accelerations]) = (times.len(), rows);
    archive.reals("time", &[count], &times)?;
    archive.texts("joint_names", columns.iter().map(|column| column.name.as_str()))?;
    archive.reals("positions", &[count, columns.len()], &positions)?;
    archive.reals("velocities", &[count, columns.len()], &velocities)?;
    archive.reals("accelerations", &[count, columns.len()], &accelerations)?;
    archive.texts("link_names", links.iter().map(|(name, _)| name.as_str()))?;
    archive.reals("link_poses", &[count, links.len(), 7], &link_poses)?;
    archive.texts("object_names", objects.iter().map(|(name, _)| name.as_str()))?;
    archive.reals("object_poses", &[count, objects.len(), 7], &object_poses)?;
    story(trajectory, &mut archive)?;
    archive.finish()
}

/// Segments and events.
fn story(trajectory: &Trajectory<'_>, archive: &mut Archive) -> Result<(), ExportError> {
    let (segments, events) = (trajectory.segments(), trajectory.events());
    let starts: Vec<f64> = segments.iter().map(|segment| segment.start).collect();
    archive.reals("segment_starts", &[starts.len()], &starts)?;
    archive.texts("segment_states", segments.iter().map(|segment| segment.state))?;
    let numbers = |pick: fn(&crate::planner::trajectory::events::TrajectoryEvent<'_>) -> f64| -> Vec<f64> {
        events.iter().map(pick).collect()
    };
    archive.reals("event_times", &[events.len()], &numbers(|event| event.time))?;
    archive.reals("event_dwells", &[events.len()], &numbers(|event| event.dwell))?;
    archive.texts("event_kinds", events.iter().map(|event| kind(event.kind)))?;
    archive.texts("event_objects", events.iter().map(|event| event.object))?;
    archive.texts("event_grippers", events.iter().map(|event| event.gripper))?;
    archive.texts("event_handles", events.iter().map(|event| event.handle))
}

pub(super) fn kind(kind: EventKind) -> &'static str {
    match kind {
        EventKind::Grasp => "grasp",
        EventKind::Release => "release",
    }
}

/// Links of parts of a kind; an object's root link is called like the object.
fn links(trajectory: &Trajectory<'_>, kind: PartKind) -> Vec<(String, LinkIndex)> {
    let robot = trajectory.robot();
    let parts = robot.parts.iter().filter(|part| part.kind == kind);
    let link = |index: usize| {
        let link = &robot.links[index];
        let part = &robot.parts[link.part.at()];
        let is_object = part.kind == PartKind::Object && part.root_link.at() == index;
        let name = if is_object { part.name.clone() } else { link.name.clone() };
        (name, LinkIndex(index as u32))
    };
    parts.flat_map(|part| part.links.clone()).map(link).collect()
}

/// An archive that is being written.
struct Archive {
    zip: ZipWriter<Cursor<Vec<u8>>>,
}

impl Archive {
    fn new() -> Self {
        Self { zip: ZipWriter::new(Cursor::new(Vec::new())) }
    }

    fn reals(&mut self, name: &str, shape: &[usize], numbers: &[f64]) -> Result<(), ExportError> {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        self.array(name, "<f8", shape, &bytes)
    }

    fn texts<'t>(&mut self, name: &str, texts: impl Iterator<Item = &'t str>) -> Result<(), ExportError> {
        let texts: Vec<Vec<char>> = texts.map(|text| text.chars().collect()).collect();
        let longest = texts.iter().map(Vec::len).max().unwrap_or(0).max(1);
        let filled = texts.iter().flat_map(|text| text.iter().copied().chain(std::iter::repeat('\0')).take(longest));
        let bytes: Vec<u8> = filled.flat_map(|c| u32::from(c).to_le_bytes()).collect();
        self.array(name, &format!("<U{longest}"), &[texts.len()], &bytes)
    }

    /// An array in format version 1.0: the header ends at a multiple of 64 bytes.
    fn array(&mut self, name: &str, kind: &str, shape: &[usize], data: &[u8]) -> Result<(), ExportError> {
        let sizes: Vec<String> = shape.iter().map(|n| format!("{n},")).collect();
        let shape = format!("({})", sizes.join(" "));
        let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
        const BEFORE: usize = 10;
        let length = (BEFORE + header.len() + 1).next_multiple_of(64) - BEFORE;
        header.extend(std::iter::repeat_n(' ', length - header.len() - 1));
        header.push('\n');
        let failed = |error: std::io::Error| ExportError::write("NPZ", error);
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated).large_file(true);
        self.zip.start_file(format!("{name}.npy"), options).map_err(|error| ExportError::write("NPZ", error))?;
        self.zip.write_all(b"\x93NUMPY\x01\x00").map_err(failed)?;
        self.zip.write_all(&(length as u16).to_le_bytes()).map_err(failed)?;
        self.zip.write_all(header.as_bytes()).map_err(failed)?;
        self.zip.write_all(data).map_err(failed)
    }

    fn finish(self) -> Result<Vec<u8>, ExportError> {
        self.zip.finish().map(Cursor::into_inner).map_err(|error| ExportError::write("NPZ", error))
    }
}
