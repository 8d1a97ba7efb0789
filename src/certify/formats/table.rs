//! A file of a motion as its reader leaves it, before names are looked up, and the caps for files of all formats.

use crate::certify::motion::piecewise::{Attachment, Point};

/// Largest file of a motion, bytes.
pub const CAP: u64 = 256 << 20;
/// Most columns of a file.
pub(crate) const COLUMNS: usize = 10_000;

/// A file as it stands, before its names are looked up.
#[derive(Debug, Default)]
pub(crate) struct Table {
    /// Names of the columns; none where the file has none.
    pub(crate) joints: Option<Vec<String>>,
    pub(crate) points: Vec<Point>,
    /// Columns that are a root's, and go straight.
    pub(crate) straight: Vec<usize>,
    /// What the file says of joints that do not move.
    pub(crate) start: Vec<(String, f64)>,
    pub(crate) attachments: Vec<Attachment>,
    pub(crate) notes: Vec<String>,
    /// Line of each point, where the format has lines.
    pub(crate) lines: Vec<u32>,
    /// How elements of a point are called: `points[3]`.
    pub(crate) element: &'static str,
    pub(crate) shortest: bool,
    /// Whether the numbers of quaternions follow the interpolation like all others, and are scaled to length 1.
    pub(crate) scaled: bool,
}
