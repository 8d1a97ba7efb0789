//! The versions of the format that are read, and what only the later one has.

use crate::path_file::document::{FORMAT, FORMAT_1, PathFile};

/// Whether files of a format are read.
pub(crate) fn is_known(format: &str) -> bool {
    format == FORMAT || format == FORMAT_1
}

/// The first key of a file of version 1 that only version 2 has, as a JSON path.
pub(crate) fn later_key(file: &PathFile) -> Option<String> {
    if file.format != FORMAT_1 {
        return None;
    }
    let segment = file.segments.iter().position(|segment| segment.velocities.is_some());
    let claims = &file.certificate;
    [
        (file.rate_limits.is_some(), "rate_limits"),
        (!file.corrections.is_empty(), "corrections"),
        (file.start_file.is_some(), "start_file"),
        (file.events.is_some(), "events"),
        (claims.max_velocity.is_some(), "certificate.max_velocity"),
        (claims.max_acceleration.is_some(), "certificate.max_acceleration"),
        (claims.continuity.is_some(), "certificate.continuity"),
    ]
    .into_iter()
    .find_map(|(has, key)| has.then(|| key.to_owned()))
    .or_else(|| segment.map(|index| format!("segments[{index}].velocities")))
}
