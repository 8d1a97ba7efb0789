//! Settings and result of the search for the least clearance along a motion.
//!
//! They are apart from `minimum`, so that callers can name them without the search itself.

use crate::collision::scene::collision_scene::PairId;

/// How well to know the least clearance, and what may be spent on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinimumSettings {
    /// The proven bound may lie under the least clearance by this share of it …
    pub relative: f64,
    /// … or by this, metres, whichever allows more; but by no more than half of it.
    pub absolute: f64,
    /// What is farther apart than this is of no interest, metres: the least clearance of other motions, say.
    pub below: f64,
    /// Distances of shapes that may be asked for. What is proved by then is returned.
    pub max_queries: u64,
    /// As [`CertificateSettings::rigid_within`](crate::collision::narrow_phase::settings::CertificateSettings::rigid_within).
    pub rigid_within: f64,
}

impl Default for MinimumSettings {
    /// Within a tenth, or a tenth of a millimetre.
    fn default() -> Self {
        Self { relative: 0.1, absolute: 1e-4, below: f64::MAX, max_queries: 20_000_000, rigid_within: f64::INFINITY }
    }
}

/// The least clearance along a motion: of all pairs, the distance less the pair's margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinimumClearance {
    /// No pair comes closer than this anywhere, metres; proved over the continuum. Infinite without pairs; −∞ where two
    /// shapes touch.
    pub lower: f64,
    /// Where a pair comes as close as that, to within the settings. `None` without pairs, and where none comes closer than
    /// [`MinimumSettings::below`].
    pub nearest: Option<Nearest>,
    /// Whether [`MinimumSettings::max_queries`] ran out, or the caller's patience, so that the bound may be poor.
    pub is_cut_short: bool,
    /// Distances of shapes that were asked for.
    pub queries: u64,
}

impl MinimumClearance {
    /// Of a motion that is none: numbers that are not finite, or rows that do not fit.
    pub(crate) const UNKNOWN: Self = Self { lower: f64::NEG_INFINITY, nearest: None, is_cut_short: false, queries: 0 };
}

/// A pair at a place of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Which pair.
    pub pair: PairId,
    /// Where: the piece's number from 0, and how far along it, added up.
    pub t: f64,
    /// Its distance there less its margin is at most this, metres.
    pub clearance: f64,
}
