//! The least clearance along a motion, to within ten per cent or a tenth of a millimetre.
//!
//! A guess is proved or refuted: that no pair comes closer than its margin and so much. Lanes refute it quickly and name a pair,
//! of which the nearest place is then looked for, which makes the next guess smaller.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use super::advance::{Budget, MEASURED, Window};
use super::motion::Motion;
use super::proof::{Proof, Refuted};
use super::world::Phase;
use foliate_kernels::collision::PairId;

/// The first guess, metres: whoever stays that far away is not near.
const FAR: f64 = 0.5;
/// How much less than measured is proved: this share, or this many metres.
const SHARE: f64 = 0.1;
const LENGTH: f64 = 1e-4;
/// Guesses at most.
const GUESSES: u32 = 200;
/// Places of a segment at which a pair is looked at, and of a motion at most.
const SAMPLES: usize = 16;
const MOST_SAMPLES: usize = 400;
/// How often the nearest place is narrowed down.
const NARROWINGS: u32 = 30;

/// The least clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    /// Proved: no pair comes closer than its margin and this, metres.
    pub at_least: f64,
    /// What was measured, where, and of which pair; none where all stay farther away than half a metre.
    pub measured: Option<(f64, f64, PairId)>,
}

/// Looks for it on a motion that is free; `still` is the least of what does not move.
pub(super) fn nearest(
    proof: &mut Proof<'_>,
    phases: &[Phase],
    still: Option<(f64, f64, PairId)>,
    budget: &mut Budget<'_>,
) -> Nearest {
    let mut measured = still.filter(|(value, ..)| *value < FAR);
    for _ in 0..GUESSES {
        let keep = match measured {
            None => FAR,
            Some((value, ..)) => value - (SHARE * value).max(LENGTH),
        };
        if keep <= 0.0 {
            break;
        }
        let mut answer = Guess::Proved;
        for phase in phases {
            answer = guess(proof, phase, keep, measured.map_or(f64::INFINITY, |known| known.0), budget);
            if answer != Guess::Proved {
                break;
            }
        }
        match answer {
            Guess::Proved if !budget.is_over => return Nearest { at_least: keep, measured },
            Guess::Nearer(found) if !budget.is_over => measured = Some(found),
            _ => break,
        }
    }
    Nearest { at_least: 0.0, measured }
}

/// What came of a guess in a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Guess {
    Proved,
    /// How much beyond its margin, where, which pair.
    Nearer((f64, f64, PairId)),
    /// Neither.
    Open,
}

/// Whether no pair comes closer than its margin and `keep`; `known` is the least that was measured so far.
fn guess(proof: &mut Proof<'_>, phase: &Phase, keep: f64, known: f64, budget: &mut Budget<'_>) -> Guess {
    let mut from = phase.from;
    while from < phase.to {
        let refuted = match proof.refute(phase, from, keep) {
            Ok(to) => {
                from = to;
                continue;
            }
            Err(refuted) => refuted,
        };
        if budget.is_over {
            return Guess::Open;
        }
        if let Some(pair) = refuted.pair
            && let Some(found) = look(proof.motion(), proof, phase, pair, budget).filter(|found| found.0 < known)
        {
            return Guess::Nearer(found);
        }
        // What lanes only doubt is looked at on the curve.
        match beyond(proof, phase, &refuted, keep, budget) {
            Ok(next) if next > from => from = next,
            Ok(_) => return Guess::Open,
            Err(found) => return Guess::Nearer(found),
        }
    }
    Guess::Proved
}

/// The least clearance of pairs that do not move in a phase: how much beyond their margin, where, which.
pub(super) fn still(proof: &Proof<'_>, phase: &Phase, budget: &mut Budget<'_>) -> Option<(f64, f64, PairId)> {
    let mut window = Window::new((proof.certifier, proof.motion(), phase), (phase.from, phase.from), 0.0);
    let scene = &proof.certifier.scene;
    let moving = proof.moves(phase);
    let mut least: Option<(f64, f64, PairId)> = None;
    for pair in phase.pairs.constant_pairs(scene).chain(phase.pairs.moving_pairs(scene).filter(|p| !moving(*p))) {
        let so_far = least.map_or(f64::MAX, |(value, ..)| value);
        let found = window.gap(pair, phase.from, so_far.clamp(0.0, 2.0 * MEASURED), budget);
        if found < so_far {
            least = Some((found, phase.from, pair));
        }
    }
    least
}

/// Where a pair is nearest in a phase, as far as samples tell.
fn look(
    motion: &Motion,
    proof: &Proof<'_>,
    phase: &Phase,
    pair: PairId,
    budget: &mut Budget<'_>,
) -> Option<(f64, f64, PairId)> {
    let count = ((phase.to - phase.from) * SAMPLES as f64).ceil().clamp(2.0, MOST_SAMPLES as f64);
    let mut window = Window::new((proof.certifier, motion, phase), (phase.from, phase.from), 0.0);
    let mut gap = |place: f64, budget: &mut Budget<'_>| window.gap(pair, place, 2.0 * MEASURED, budget);
    let place = |i: f64| phase.from + (phase.to - phase.from) * i / count;
    let mut best = (f64::INFINITY, phase.from, 0.0);
    let mut i = 0.0;
    while i <= count && !budget.is_over {
        let found = gap(place(i), budget);
        if found < best.0 {
            best = (found, place(i), i);
        }
        i += 1.0;
    }
    // Golden section around the nearest sample.
    let (mut low, mut high) = (place((best.2 - 1.0).max(0.0)), place((best.2 + 1.0).min(count)));
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (gap(a, budget), gap(b, budget));
    for _ in 0..NARROWINGS {
        if budget.is_over {
            break;
        }
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = gap(a, budget);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = gap(b, budget);
        }
    }
    for (found, at) in [(at_a, a), (at_b, b)] {
        if found < best.0 {
            best = (found, at, 0.0);
        }
    }
    Some((best.0, best.1, pair)).filter(|found| found.0.is_finite())
}

/// Goes over a doubtful place on the curve itself: to behind it, or to a place that is too close for sure.
fn beyond(
    proof: &Proof<'_>,
    phase: &Phase,
    refuted: &Refuted,
    keep: f64,
    budget: &mut Budget<'_>,
) -> Result<f64, (f64, f64, PairId)> {
    let from = refuted.free_until;
    let to = (from + proof.step_at(from)).min(phase.to).min(from.floor() + 1.0);
    let mut window = Window::new((proof.certifier, proof.motion(), phase), (from, to), keep);
    let found = window.advance(None, budget);
    match found.met {
        Some(met) => Err((met.distance - phase.pairs.margin(met.pair), met.at, met.pair)),
        None => Ok(to),
    }
}
