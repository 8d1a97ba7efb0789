//! What a change of a path answers.

use crate::improvement::leaf_motion::LeafMotion;
use std::ops::Range;

/// Motions of a path in place of those of a range.
pub(crate) struct Changed {
    pub range: Range<usize>,
    pub motions: Vec<LeafMotion>,
}
