//! A straight motion is free over the continuum, or free up to here.
//!
//! How it is proved stands in proof.rs.

use super::pairs::PairSet;
use super::polyline::{PolylineVerdict, certify_polyline};
use super::scene::CollisionScene;
use super::scratch::CollisionScratch;
use super::verdict::Contact;
use crate::kinematics::{Carriage, Kinematics};

/// What to prove, and how hard to try.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CertificateSettings {
    /// Added to every margin, so that independent checkers agree; metres.
    pub clearance_guard: f64,
    /// Where a pair can move by no more than this within an interval and still is not certified, it is taken to collide:
    /// in doubt, in collision. Metres.
    pub resolution: f64,
    /// How close to the truth the end of the valid prefix has to be, as a share of the motion.
    pub prefix_resolution: f64,
    /// Whether to stop at the first collision found, without looking for the valid prefix.
    pub all_or_nothing: bool,
    /// Whether the start is known to be free: pairs that do not move along this motion are then not looked at.
    pub start_is_free: bool,
    /// Configurations that may be looked at; a motion that needs more is free up to where it is certified by then.
    pub max_samples: u32,
    /// How far along the motion the relative pose of bodies that are tied together may leave that at its start: metres of the
    /// tie's origin, and radians. Infinite where nothing is known: ties then say nothing.
    pub tied_within: f64,
}

impl Default for CertificateSettings {
    fn default() -> Self {
        Self {
            clearance_guard: 1e-5,
            resolution: 1e-4,
            prefix_resolution: 4e-3,
            all_or_nothing: false,
            start_is_free: false,
            max_samples: 20_000,
            tied_within: f64::INFINITY,
        }
    }
}

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
/// linearly, roots linearly and on the quaternion geodesic), with carried objects following. `carriages` must be those of
/// `pairs`. For polylines there is [`super::polyline::certify_polyline`].
///
/// Containment in closed meshes is not asked along the way: by continuity it cannot begin without touching, so the
/// caller asks [`super::verdict::first_collision`] at the start.
///
/// # Panics
/// If a configuration is shorter than the configuration space.
#[must_use]
#[allow(clippy::too_many_arguments, reason = "tables, the motion, and buffers: nothing here belongs together")]
pub fn certify_motion(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    carriages: &[Carriage],
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
    let found = certify_polyline(scene, kinematics, carriages, &knots, pairs, settings, scratch);
    scratch.knots = knots;
    match found {
        PolylineVerdict::Free { min_clearance_lower_bound } => MotionVerdict::Free { min_clearance_lower_bound },
        PolylineVerdict::FreeUntil { t, blocked_by, .. } => MotionVerdict::FreeUntil { t, blocked_by },
    }
}
