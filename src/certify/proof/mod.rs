//! TODO(page): what lies in certify/proof.

pub(crate) mod advance;
pub(crate) mod chords;
pub(crate) mod contact;
pub(crate) mod depth;
pub(crate) mod nearest;
