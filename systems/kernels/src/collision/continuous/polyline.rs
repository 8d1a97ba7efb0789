//! A polyline is free over the continuum, or free up to here.
//!
//! Motions that are kept on their leaf have hundreds of short pieces. One sample can prove many of them: from a knot in the
//! middle of a span of pieces no joint moves farther than its path is long, and the bound of `adaptive_certifier.rs` asks for
//! no more than that. A straight motion is the polyline of one piece.

use crate::collision::continuous::adaptive_certifier::AdaptiveCertifier;
use crate::collision::narrow_phase::scratch::CollisionScratch;
use crate::collision::narrow_phase::settings::CertificateSettings;
use crate::collision::scene::collision_scene::CollisionScene;
use crate::collision::scene::pair_query::Contact;
use crate::collision::scene::pair_set::PairSet;
use crate::kinematics::{Kinematics, RigidAttachment};

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
        /// Where that sample is, in pieces from the start of the polyline; where there is none, the end of what is proved.
        blocked_at: f64,
    },
}

/// Proves clearance along the straight motions from knot to knot; `knots` are whole configurations, end to end. As
/// [`certify_motion`](crate::collision::continuous::straight::certify_motion) for each piece in turn, with the shares of
/// [`CertificateSettings`] meant of the whole polyline (its pieces taken to be alike), `max_samples` too. Without a piece
/// nothing is asked and the answer is free.
///
/// # Panics
/// If `knots` is not a whole number of configurations of at least one coordinate.
#[must_use]
#[allow(clippy::too_many_arguments, reason = "as certify_motion")]
pub fn certify_polyline(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    rigid_attachments: &[RigidAttachment],
    knots: &[f64],
    pairs: &PairSet,
    settings: &CertificateSettings,
    scratch: &mut CollisionScratch,
) -> PolylineVerdict {
    let size = scene.space.size();
    let pieces = (knots.len() / size).saturating_sub(1);
    if !knots.iter().all(|x| x.is_finite()) {
        return PolylineVerdict::FreeUntil { piece: 0, t: 0.0, blocked_by: None, blocked_at: 0.0 };
    }
    if pieces == 0 {
        return PolylineVerdict::Free { min_clearance_lower_bound: f64::INFINITY };
    }
    scratch.motion_samples.begin((scene, kinematics, rigid_attachments), pairs, knots);
    let certifier = AdaptiveCertifier::of(scene, knots, pairs, settings, scratch);
    if !certifier.blocked {
        return PolylineVerdict::Free { min_clearance_lower_bound: certifier.min_clearance };
    }
    let limit = if settings.all_or_nothing { 0.0 } else { certifier.limit.max(0.0) };
    let piece = (limit as usize).min(pieces.saturating_sub(1));
    PolylineVerdict::FreeUntil {
        piece,
        t: (limit - piece as f64).clamp(0.0, 1.0),
        blocked_by: certifier.blocked_by,
        blocked_at: certifier.blocked_at.clamp(0.0, pieces as f64),
    }
}
