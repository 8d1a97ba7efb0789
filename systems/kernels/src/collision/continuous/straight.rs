//! A straight motion is free over the continuum, or free up to here.
//!
//! The proof is that of `adaptive_certifier.rs`.

use crate::collision::continuous::polyline::{PolylineVerdict, certify_polyline};
use crate::collision::narrow_phase::scratch::CollisionScratch;
use crate::collision::narrow_phase::settings::CertificateSettings;
use crate::collision::scene::collision_scene::CollisionScene;
use crate::collision::scene::pair_query::Contact;
use crate::collision::scene::pair_set::PairSet;
use crate::kinematics::forward::{Kinematics, RigidAttachment};

/// What is proved about a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionVerdict {
    /// All of it keeps all margins.
    Free {
        /// Every pair keeps at least this clearance throughout, metres; a lower bound, and often far below the truth.
        /// Infinite without pairs.
        min_clearance_lower_bound: f64,
    },
    /// Only parameters in [0, t] are proved; t is 0 where nothing is. With `all_or_nothing` t is always 0.
    FreeUntil {
        /// End of the proved prefix.
        t: f64,
        /// The pair that ends it, with its clearance at the sample that did; none where a configuration is not finite
        /// or the samples ran out.
        blocked_by: Option<Contact>,
    },
}

/// Proves clearance along the straight motion from `q_a` to `q_b` (in the sense of the configuration space: joints
/// linearly, roots linearly and on the quaternion geodesic), with carried objects following. `rigid_attachments` must be those of
/// `pairs`. For polylines there is [`crate::collision::continuous::polyline::certify_polyline`].
///
/// Containment in closed meshes is not asked along the way: by continuity it cannot begin without touching, so the
/// caller asks [`crate::collision::discrete::one::first_collision`] at the start.
///
/// # Panics
/// If a configuration is shorter than the configuration space.
#[must_use]
#[allow(clippy::too_many_arguments, reason = "tables, the motion, and buffers: nothing here belongs together")]
pub fn certify_motion(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    rigid_attachments: &[RigidAttachment],
    q_a: &[f64],
    q_b: &[f64],
    pairs: &PairSet,
    settings: &CertificateSettings,
    scratch: &mut CollisionScratch,
) -> MotionVerdict {
    let size = scene.space.size();
    let mut knots = std::mem::take(&mut scratch.knots);
    knots.clear();
    knots.extend_from_slice(&q_a[..size]);
    knots.extend_from_slice(&q_b[..size]);
    let found = certify_polyline(scene, kinematics, rigid_attachments, &knots, pairs, settings, scratch);
    scratch.knots = knots;
    match found {
        PolylineVerdict::Free { min_clearance_lower_bound } => MotionVerdict::Free { min_clearance_lower_bound },
        PolylineVerdict::FreeUntil { t, blocked_by, .. } => MotionVerdict::FreeUntil { t, blocked_by },
    }
}
