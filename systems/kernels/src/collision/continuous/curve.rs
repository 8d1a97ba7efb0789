//! A curve is free over the continuum, or blocked; and how close the closest pair comes along it.
//!
//! The proofs are those of polylines (`adaptive_certifier.rs`, `minimum.rs`). Samples lie on the curve itself, so nothing is lost to
//! chords. An interval asks for how far each joint gets from the sample within it, which closed forms of its cubic bound; along a
//! direction it asks for the joints' speeds at the sample, and for bounds of their speeds and accelerations
//! (`samples/joint_rate.rs`).

use crate::collision::continuous::adaptive_certifier::AdaptiveCertifier;
use crate::collision::continuous::minimum::minimum_clearance;
use crate::collision::continuous::minimum_settings::{MinimumClearance, MinimumSettings};
use crate::collision::narrow_phase::scratch::CollisionScratch;
use crate::collision::narrow_phase::settings::CertificateSettings;
use crate::collision::scene::collision_scene::CollisionScene;
use crate::collision::scene::pair_query::Contact;
use crate::collision::scene::pair_set::PairSet;
use crate::curve::hermite::HermiteCurve;
use crate::kinematics::{Kinematics, RigidAttachment};

/// A pair that an interval moves by no more than this and that is not certified there is in doubt, metres. Much less than on
/// polylines: who comes to rest near something does so with a bend, and bends are bounded to both sides.
const RESOLUTION: f64 = 1e-6;

/// What is proved about a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CurveVerdict {
    /// All of it keeps all margins.
    Free {
        /// Every pair keeps at least this clearance throughout, metres; a lower bound, and often far below the truth.
        /// Infinite without pairs.
        min_clearance_lower_bound: f64,
    },
    /// Some of it is not proved free.
    Blocked {
        /// A piece that is not free, counted from 0; not always the first one.
        piece: usize,
        /// Where on it, in [0, 1].
        u: f64,
        /// The pair that is too close there, with its clearance; none where the curve is not sound
        /// ([`HermiteCurve::is_sound`]) or the samples ran out.
        blocked_by: Option<Contact>,
    },
}

/// Proves clearance along a curve, whole or not at all: [`CertificateSettings::all_or_nothing`] is taken as set, and
/// [`CertificateSettings::resolution`] as a micrometre at most. The objects of
/// `rigid_attachments`, which must be those of `pairs`, follow their carriers whatever their own coordinates are. Without a
/// piece nothing is asked and the answer is free.
///
/// Containment in closed meshes is not asked along the way: by continuity it cannot begin without touching, so the
/// caller asks [`crate::collision::discrete::one::first_collision`] at the start.
#[must_use]
#[allow(clippy::too_many_arguments, reason = "as certify_motion")]
pub fn certify_curve(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    rigid_attachments: &[RigidAttachment],
    curve: &HermiteCurve<'_>,
    pairs: &PairSet,
    settings: &CertificateSettings,
    scratch: &mut CollisionScratch,
) -> CurveVerdict {
    if !curve.is_sound(&scene.space) {
        return CurveVerdict::Blocked { piece: 0, u: 0.0, blocked_by: None };
    }
    if curve.pieces() == 0 {
        return CurveVerdict::Free { min_clearance_lower_bound: f64::INFINITY };
    }
    scratch.motion_samples.begin_curve((scene, kinematics, rigid_attachments), pairs, curve);
    let resolution = settings.resolution.min(RESOLUTION);
    let settings = CertificateSettings { all_or_nothing: true, resolution, ..*settings };
    let certifier = AdaptiveCertifier::of(scene, curve.knots, pairs, &settings, scratch);
    if !certifier.blocked {
        return CurveVerdict::Free { min_clearance_lower_bound: certifier.min_clearance };
    }
    let at = certifier.limit.max(0.0);
    let piece = (at as usize).min(curve.pieces() - 1);
    CurveVerdict::Blocked { piece, u: (at - piece as f64).clamp(0.0, 1.0), blocked_by: certifier.blocked_by }
}

/// The least clearance along a curve, as [`minimum_clearance_along`](crate::collision::continuous::minimum::minimum_clearance_along)
/// says it of a polyline. A curve that is not sound ([`HermiteCurve::is_sound`]) or has no knot has the bound −∞.
#[must_use]
#[allow(clippy::too_many_arguments, reason = "as certify_motion")]
pub fn minimum_clearance_on_curve(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    rigid_attachments: &[RigidAttachment],
    curve: &HermiteCurve<'_>,
    pairs: &PairSet,
    settings: &MinimumSettings,
    scratch: &mut CollisionScratch,
) -> MinimumClearance {
    if curve.times.is_empty() || !curve.is_sound(&scene.space) {
        return MinimumClearance::UNKNOWN;
    }
    scratch.motion_samples.begin_curve((scene, kinematics, rigid_attachments), pairs, curve);
    let tables = (scene, kinematics, rigid_attachments);
    minimum_clearance(tables, curve.knots, pairs, (settings, &|| true), scratch)
}
