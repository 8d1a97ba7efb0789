//! The least clearance along a motion, to within ten per cent or a tenth of a millimetre, and where.
//!
//! The search is the kernels' (`collision/continuous/minimum.rs`): branch and bound along polylines. Here curves are cut
//! into chords, as for the proof, and what these are off is taken off the bound. How far they may be off depends on the
//! clearance, so that a
//! rough search comes first where something curves; straight motions need one. The place is then measured on the curve itself.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::certify::proof::advance::{Budget, MEASURED, Window};
use crate::certify::proof::chords::{DEVIATION, Proof};
use crate::certify::world::phases::Phase;
use foliate_kernels::collision::{MinimumSettings, PairId};

/// Shares of the tenth, and of the tenth of a millimetre, for the search; chords may be off by the rest, to either side.
const SEARCH: MinimumSettings =
    MinimumSettings { relative: 0.08, absolute: 8e-5, below: f64::MAX, max_queries: u64::MAX, rigid_within: 0.0 };
const CHORD_SHARE: f64 = 0.01;
const CHORD_LENGTH: f64 = 1e-5;
/// The first step along a piece from the nearest place found, as a share of the piece, and how often steps are halved.
const STEP: f64 = 0.125;
const HALVINGS: u32 = 20;

/// How much farther apart than its margin a pair is, metres; at which place; which pair.
pub(crate) type Gap = (f64, f64, PairId);

/// The least clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    /// Proved: no pair comes closer than its margin and this, metres.
    pub at_least: f64,
    /// What was measured, where, and of which pair; none where no pair is tested.
    pub measured: Option<Gap>,
}

/// Looks for it on a motion that is free.
pub(crate) fn nearest(proof: &mut Proof<'_>, phases: &[Phase], budget: &mut Budget<'_>) -> Nearest {
    let rough = search(proof, phases, (DEVIATION, f64::MAX), budget);
    let Some((value, ..)) = rough.nearest.measured else { return rough.nearest };
    let deviation = (CHORD_SHARE * value).max(CHORD_LENGTH);
    if rough.off <= deviation || budget.is_over {
        return rough.nearest;
    }
    // What is measured on the curve may be that much farther on its chords, and then counts no more.
    let fine = search(proof, phases, (deviation, value + 2.0 * deviation), budget).nearest;
    let measured = [rough.nearest.measured, fine.measured].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
    Nearest { at_least: fine.at_least.max(rough.nearest.at_least), measured }
}

/// What a search over all of a motion found.
struct Found {
    nearest: Nearest,
    /// The farthest that a chord is off its curve, metres.
    off: f64,
}

/// Searches with chords that are off by no more than `deviation`; what is farther apart than `below` is of no interest.
fn search(proof: &mut Proof<'_>, phases: &[Phase], (deviation, below): (f64, f64), budget: &mut Budget<'_>) -> Found {
    let mut found = Found { nearest: Nearest { at_least: f64::INFINITY, measured: None }, off: 0.0 };
    let mut settings = MinimumSettings { below, ..SEARCH };
    let mut closest = None;
    for (number, phase) in phases.iter().enumerate() {
        let mut from = phase.from;
        loop {
            let part = proof.minimum(phase, from, deviation, &settings, budget);
            found.off = found.off.max(part.off);
            found.nearest.at_least = found.nearest.at_least.min(part.found.lower - part.off);
            if let Some(nearest) = part.found.nearest {
                settings.below = settings.below.min(nearest.clearance);
                closest = Some((number, nearest.pair, part.place));
            }
            from = part.to;
            if from >= phase.to || budget.is_over {
                break;
            }
        }
    }
    if budget.is_over {
        found.nearest.at_least = f64::NEG_INFINITY;
    }
    found.nearest.measured = closest.map(|(phase, pair, place)| descend(proof, &phases[phase], (pair, place), budget));
    found
}

/// From a place to one near by at which the pair is no farther apart, on the curve itself.
fn descend(proof: &Proof<'_>, phase: &Phase, (pair, place): (PairId, f64), budget: &mut Budget<'_>) -> Gap {
    let mut window = Window::new((proof.certifier, proof.motion(), phase), (place, place));
    let mut gap = |place: f64, budget: &mut Budget<'_>| window.gap(pair, place, 2.0 * MEASURED, budget);
    let mut best = (gap(place, budget), place, pair);
    let (low, high) = (phase.from.max(place.ceil() - 1.0), phase.to.min(place.floor() + 1.0));
    let mut step = STEP;
    for _ in 0..HALVINGS {
        let around = [(best.1 - step).max(low), (best.1 + step).min(high)];
        let nearer =
            around.map(|place| (gap(place, budget), place, pair)).into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        match nearer.filter(|nearer| nearer.0 < best.0) {
            Some(nearer) => best = nearer,
            None => step *= 0.5,
        }
        if budget.is_over {
            break;
        }
    }
    best
}

/// The least clearance of pairs that do not move in a phase: how much beyond their margin, metres.
pub(crate) fn still(proof: &Proof<'_>, phase: &Phase, budget: &mut Budget<'_>) -> Option<f64> {
    let mut window = Window::new((proof.certifier, proof.motion(), phase), (phase.from, phase.from));
    let scene = &proof.certifier.scene;
    let moving = proof.moves(phase);
    let mut least: Option<f64> = None;
    for pair in phase.pairs.constant_pairs(scene).chain(phase.pairs.moving_pairs(scene).filter(|p| !moving(*p))) {
        let so_far = least.unwrap_or(f64::MAX);
        let found = window.gap(pair, phase.from, so_far.clamp(0.0, 2.0 * MEASURED), budget);
        if found < so_far {
            least = Some(found);
        }
    }
    least
}
