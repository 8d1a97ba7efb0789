//! A polyline is free over the continuum, or free up to here.
//!
//! Motions that are kept on their leaf have hundreds of short pieces. One sample can prove many of them: from a knot in
//! the middle of a span of pieces no joint moves farther than its path is long, and the bound of certificate.rs asks for
//! no more than that. Spans are halved only for the pairs that they leave open, a pair that is far from everything drops
//! out at the first sample, and what single pieces leave open goes on as a straight motion with those pairs alone.

use super::certificate::{CertificateSettings, Level, MotionVerdict, Proof, certify_motion};
use super::pairs::PairSet;
use super::scene::CollisionScene;
use super::scratch::{CollisionScratch, place_balls};
use super::verdict::Contact;
use crate::kinematics::{Carriage, Kinematics};

/// What is proved about a polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PolylineVerdict {
    /// All of it keeps all margins.
    Free {
        /// Every pair keeps at least this clearance throughout, metres; a lower bound, and often far below the truth.
        /// Infinite without pairs.
        min_clearance_lower_bound: f64,
    },
    /// Only what comes before is proved.
    FreeUntil {
        /// The piece that is not free, counted from 0; those before it are.
        piece: usize,
        /// End of the proved prefix of that piece, in [0, 1].
        t: f64,
        /// The pair that ends it, with its clearance at the sample that did; none where a configuration is not finite
        /// or the samples ran out.
        blocked_by: Option<Contact>,
    },
}

/// The pieces from knot `first` to knot `last`, and the runs that are open there.
#[derive(Clone, Copy, Debug)]
struct Span {
    first: u32,
    last: u32,
    start: u32,
    end: u32,
}

/// Buffers of a polyline's proof.
#[derive(Clone, Debug, Default)]
pub(super) struct PolylineScratch {
    spans: Vec<Span>,
    next: Vec<Span>,
    pieces: Vec<Span>,
    /// Open runs of `spans`, of `next` and of `pieces`.
    levels: [Level; 3],
}

/// Proves clearance along the straight motions from knot to knot; `knots` are whole configurations, end to end. As
/// [`certify_motion`] for each piece in turn, with the shares of [`CertificateSettings`] meant of the whole polyline (its
/// pieces taken to be alike), `max_samples` too. Without a piece nothing is asked and the answer is free.
///
/// # Panics
/// If `knots` is not a whole number of configurations of at least one coordinate.
#[must_use]
#[allow(clippy::too_many_arguments, reason = "as certify_motion")]
pub fn certify_polyline(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    carriages: &[Carriage],
    knots: &[f64],
    pairs: &PairSet,
    settings: &CertificateSettings,
    scratch: &mut CollisionScratch,
) -> PolylineVerdict {
    let size = scene.space.size();
    let pieces = (knots.len() / size).saturating_sub(1);
    if pieces == 1 {
        let (a, b) = knots.split_at(size);
        return match certify_motion(scene, kinematics, carriages, a, b, pairs, settings, scratch) {
            MotionVerdict::Free { min_clearance_lower_bound } => PolylineVerdict::Free { min_clearance_lower_bound },
            MotionVerdict::FreeUntil { t, blocked_by } => PolylineVerdict::FreeUntil { piece: 0, t, blocked_by },
        };
    }
    if !knots.iter().all(|x| x.is_finite()) {
        return PolylineVerdict::FreeUntil { piece: 0, t: 0.0, blocked_by: None };
    }
    // Doubt is for pieces: a span that is not certified is halved.
    let halving = CertificateSettings { resolution: 0.0, ..*settings };
    let share = settings.prefix_resolution * pieces as f64;
    let straight = CertificateSettings { prefix_resolution: share.min(1.0), ..*settings };
    let mut proof = Proof::new((scene, kinematics, carriages), pairs, &halving);
    proof.limit = pieces as f64;
    let mut buffers = std::mem::take(&mut scratch.polyline);
    halve_spans(&mut proof, knots, share, &mut buffers, scratch);
    proof.settings = &straight;
    prove_pieces(&mut proof, knots, &mut buffers, scratch);
    scratch.polyline = buffers;
    verdict_of(&proof, pieces)
}

/// Halves spans until they are certified or single pieces; leaves the latter in `buffers.pieces`.
fn halve_spans(
    proof: &mut Proof<'_>,
    knots: &[f64],
    share: f64,
    buffers: &mut PolylineScratch,
    scratch: &mut CollisionScratch,
) {
    let PolylineScratch { spans, next, pieces, levels: [level, next_level, rest] } = buffers;
    scratch.make_room(proof.scene);
    scratch.forget_hints(proof.scene);
    scratch.bound.begin_polyline(proof.scene, proof.pairs, knots, &mut scratch.delta);
    level.fill(proof.scene, proof.pairs);
    pieces.clear();
    rest.clear();
    spans.clear();
    let last = proof.limit as u32;
    if last > 0 {
        spans.push(Span { first: 0, last, start: 0, end: level.runs.len() as u32 });
    }
    while !spans.is_empty() && !proof.given_up() {
        next.clear();
        next_level.clear();
        for span in spans.iter() {
            let open = look_into(proof, knots, level, *span, share, next_level, scratch);
            if proof.given_up() {
                return;
            }
            let Some((start, end)) = open else { continue };
            let middle = span.first.midpoint(span.last);
            for (first, last) in [(span.first, middle), (middle, span.last)] {
                if last - first > 1 {
                    next.push(Span { first, last, start, end });
                } else {
                    let from = rest.runs.len() as u32;
                    rest.copy(next_level, start..end);
                    pieces.push(Span { first, last, start: from, end: rest.runs.len() as u32 });
                }
            }
        }
        std::mem::swap(spans, next);
        std::mem::swap(level, next_level);
    }
}

/// Certifies what it can of a span from the knot in its middle; the runs that stay open, where there are any.
fn look_into(
    proof: &mut Proof<'_>,
    knots: &[f64],
    level: &Level,
    span: Span,
    share: f64,
    next: &mut Level,
    scratch: &mut CollisionScratch,
) -> Option<(u32, u32)> {
    let left = f64::from(span.first);
    if left >= proof.limit {
        return None;
    }
    if proof.samples >= proof.settings.max_samples {
        proof.cut(left, None);
        return None;
    }
    proof.samples += 1;
    let middle = span.first.midpoint(span.last);
    go_to_knot(proof, knots, middle as usize, scratch);
    let knots_of_span = (span.first as usize, middle as usize, span.last as usize);
    scratch.bound.look_at_span(proof.scene, &scratch.X_WJ, knots_of_span);
    let start = next.runs.len() as u32;
    for run in &level.runs[span.start as usize..span.end as usize] {
        proof.look_at_run(run, &level.pairs, (left, f64::from(middle)), next, scratch);
        if proof.given_up() {
            return None;
        }
    }
    let end = next.runs.len() as u32;
    if end == start {
        return None;
    }
    if proof.blocked && proof.limit <= f64::from(span.last) && f64::from(span.last - span.first) <= share {
        // Something here or right behind is in collision, and the prefix is known well enough.
        proof.cut(left, None);
        return None;
    }
    Some((start, end))
}

fn go_to_knot(proof: &Proof<'_>, knots: &[f64], knot: usize, scratch: &mut CollisionScratch) {
    let size = proof.scene.space.size();
    let q = &knots[knot * size..][..size];
    proof.kinematics.forward(q, &mut scratch.X_WJ);
    proof.kinematics.carry(q, proof.carriages, &mut scratch.X_WJ);
    place_balls(proof.scene, &scratch.X_WJ, &mut scratch.balls);
}

/// Proves the single pieces that are left, in order, up to the first that is not free.
fn prove_pieces(proof: &mut Proof<'_>, knots: &[f64], buffers: &mut PolylineScratch, scratch: &mut CollisionScratch) {
    let size = proof.scene.space.size();
    let PolylineScratch { pieces, levels: [_, _, rest], .. } = buffers;
    pieces.sort_unstable_by_key(|span| span.first);
    for span in pieces.iter() {
        if proof.given_up() || f64::from(span.first) >= proof.limit {
            return;
        }
        let at = span.first as usize * size;
        scratch.level.clear();
        scratch.level.copy(rest, span.start..span.end);
        let tables = (proof.scene, proof.kinematics, proof.carriages);
        let mut piece = Proof::new(tables, proof.pairs, proof.settings);
        piece.samples = proof.samples;
        piece.prove_straight((&knots[at..at + size], &knots[at + size..at + 2 * size]), scratch);
        proof.samples = piece.samples;
        proof.min_clearance = proof.min_clearance.min(piece.min_clearance);
        if piece.blocked {
            proof.cut(f64::from(span.first) + piece.limit.clamp(0.0, 1.0), piece.blocked_by);
        }
    }
}

fn verdict_of(proof: &Proof<'_>, pieces: usize) -> PolylineVerdict {
    if !proof.blocked {
        return PolylineVerdict::Free { min_clearance_lower_bound: proof.min_clearance };
    }
    let limit = if proof.settings.all_or_nothing { 0.0 } else { proof.limit.max(0.0) };
    let piece = (limit as usize).min(pieces.saturating_sub(1));
    PolylineVerdict::FreeUntil { piece, t: (limit - piece as f64).clamp(0.0, 1.0), blocked_by: proof.blocked_by }
}
