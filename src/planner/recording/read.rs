//! Reading recordings, which may be hostile: regular files only, never more than a cap, and no more memory than a small multiple of the
//! file.

use crate::path_file::place::json_path;
use crate::path_file::read::{counts, regular_file};
use crate::path_file::version;
use crate::planner::recording::columns;
use crate::planner::recording::document::{BlockedPairEntry, FORMAT, FunnelEntry, LEFT_OUT, Recording, RecordingHead};
use crate::planner::recording::error::RecordingError;
use crate::scene::reading::error::quoted;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Largest recording that is read, bytes.
pub(crate) const CAP: u64 = 1 << 28;

impl Recording {
    /// Reads a recording.
    ///
    /// # Errors
    /// It is no regular file, cannot be read, is larger than 256 MiB, is no recording, is of another version, or something in it does not
    /// fit together.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let io = |source| RecordingError::Io { path: path.to_owned(), source };
        Self::of_bytes(path, &regular_file(path, CAP).map_err(io)?)
    }

    /// Whether a file begins as recordings do.
    #[must_use]
    pub fn is_one(path: &Path) -> bool {
        const BEGIN: &str = "{\"format\":\"foliate.search/";
        let mut begin = [0; BEGIN.len()];
        let is_file = std::fs::metadata(path).is_ok_and(|found| found.is_file());
        is_file
            && File::open(path).and_then(|mut file| file.read_exact(&mut begin)).is_ok()
            && begin == *BEGIN.as_bytes()
    }

    /// The recording in the bytes of a file; its name is for messages.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn of_bytes(path: &Path, bytes: &[u8]) -> Result<Self, RecordingError> {
        let malformed =
            |place: String, message: String| RecordingError::Malformed { path: path.to_owned(), place, message };
        let end = bytes.iter().position(|&byte| byte == b'\n');
        let end = end.ok_or_else(|| {
            malformed("the file".into(), "has no line with a head: it is no recording, or cut off".into())
        })?;
        let (head, body) = (&bytes[..end], &bytes[end + 1..]);
        let head = std::str::from_utf8(head)
            .map_err(|error| malformed("the head".into(), format!("byte {} is not UTF-8", error.valid_up_to())))?;
        let head = parsed(path, head)?;
        let announced =
            columns::announced(&head).ok_or_else(|| malformed("the head".into(), "announces too much".into()))?;
        if announced != body.len() as u64 {
            let message = format!("{announced} bytes are announced behind the head, and there are {}", body.len());
            return Err(malformed("the columns".into(), message));
        }
        let split = columns::split(&head, body);
        let (nodes, edges, collisions) = split.map_err(|(place, message)| malformed(place, message))?;
        let recording = Self { head, nodes, edges, collisions };
        match recording.fault() {
            Some((place, message)) => Err(malformed(place, message)),
            None => Ok(recording),
        }
    }

    /// What does not fit together, and where.
    fn fault(&self) -> Option<(String, String)> {
        let Self { head, nodes, edges, collisions } = self;
        let told = |place: &str, message: &str| Some((place.to_owned(), message.to_owned()));
        if head.path.coordinates.len() != head.width.saturating_add(head.still.len()) {
            return told("width", "with `still` it is not as many as there are coordinates in the path file");
        }
        let size = head.path.coordinates.len();
        if head.start.iter().chain(&head.goals).any(|q| q.len() != size) {
            return told("start", "it and every goal has a number for each coordinate of the path file");
        }
        if let Some(row) = head.transitions.iter().position(|row| row.from.max(row.to) as usize >= head.states.len()) {
            return told(&format!("transitions[{row}]"), "leads from or to a state that there is not");
        }
        let is_known = |at: u32, count: usize| (at as usize) < count;
        let has_place = |pair: &BlockedPairEntry| pair.at.is_none_or(|at| u64::from(at) < head.collisions);
        let is_sound =
            |row: &FunnelEntry| is_known(row.transition, head.transitions.len()) && row.pairs.iter().all(has_place);
        if let Some(row) = head.funnel.iter().position(|row| !is_sound(row)) {
            return told(&format!("funnel[{row}]"), "refers to a transition or a configuration that there is not");
        }
        let is_listed = |at: u32, count: usize| at == LEFT_OUT || is_known(at, count);
        if let Some(node) = nodes.states.iter().position(|&state| !is_listed(state, head.states.len())) {
            return told(&format!("node {node}"), "is in a state that there is not");
        }
        let ends = edges.from.iter().zip(&edges.to).zip(&edges.transitions);
        let is_sound = |((&from, &to), &along): ((&u32, &u32), &u32)| {
            is_known(from.max(to), nodes.len()) && is_listed(along, head.transitions.len())
        };
        if let Some(edge) = { ends }.position(|edge| !is_sound(edge)) {
            return told(&format!("edge {edge}"), "refers to a node or a transition that there is not");
        }
        if head.roots.start.iter().chain(&head.roots.goals).any(|&root| !is_known(root, nodes.len())) {
            return told("roots", "refers to a node that there is not");
        }
        if let Some(at) = nodes.configurations.iter().chain(collisions).position(|x| !x.is_finite()) {
            return told(&format!("number {at} of the configurations"), "is not finite");
        }
        None
    }
}

fn parsed(path: &Path, text: &str) -> Result<RecordingHead, RecordingError> {
    let io = |source| RecordingError::Io { path: path.to_owned(), source };
    let other = |found: String| RecordingError::Format { path: path.to_owned(), found: quoted(&found) };
    counts(text).map_err(io)?;
    let head: RecordingHead = serde_json::from_str(text).map_err(|source| {
        // A file of another format is refused by its name and not by a missing field.
        match serde_json::from_str::<Format>(text) {
            Ok(Format { format }) if format != FORMAT => other(format),
            _ => {
                let place = json_path(text, source.line(), source.column());
                RecordingError::Json { path: path.to_owned(), place, source }
            }
        }
    })?;
    if head.format != FORMAT {
        return Err(other(head.format));
    }
    if !version::is_known(&head.path.format) || version::later_key(&head.path).is_some() {
        let message = format!("a path file of `{}` is not known", quoted(&head.path.format));
        return Err(RecordingError::Malformed { path: path.to_owned(), place: "path".into(), message });
    }
    Ok(head)
}

/// Only the format.
#[derive(serde::Deserialize)]
struct Format {
    format: String,
}
