//! Distance of two convex cores by Gilbert, Johnson and Keerthi's algorithm, with a *certified* lower bound.
//!
//! Every direction n gives a separating slab: no point of A − B lies nearer to the origin than n · support(−n). That
//! number is what is returned, computed anew from the supports, so a result cannot be too large whatever the simplex
//! did on the way. If the iteration ends early (flat simplices, too many steps) the bound is merely loose, which by the
//! house's rule reads *in collision*. It also means that most queries "at least d?" end after one or two supports.

use crate::collision::convex::core::Core;
use crate::collision::convex::simplex::{Closest, Simplex};
use foliate_components::Pose;
use glam::{DMat3, DVec3};

/// Rounding of coordinates up to some tens of metres; taken off every bound. Metres.
pub(crate) const ROUNDING: f64 = 1e-10;
/// Iterations that have not converged by then end with the bound that they have.
const MAX_STEPS: usize = 64;

/// How precisely a distance is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceQuery {
    /// The question is "at least this?": the answer need not be exact above. Metres.
    pub needed: f64,
    /// If it is not at least `needed`, it may be enough to know that it is at least this (for no such shortcut, as large as
    /// `needed`). Metres.
    pub floor: f64,
    /// If it is not at least `floor` either, it may be enough to know that it is at least this (for no such shortcut, as
    /// large as `floor`). Metres.
    pub ground: f64,
    /// Below all three, how far the answer may lie under the true distance, metres …
    pub absolute: f64,
    /// … or as a share of the distance, whichever allows more.
    pub relative: f64,
}

impl DistanceQuery {
    /// Whether bounds of a distance from both sides, metres, say all that is asked.
    #[inline]
    pub(crate) fn is_settled(&self, lower: f64, upper: f64) -> bool {
        upper - lower <= self.absolute.max(self.relative * upper)
            || (upper < self.needed && lower >= self.floor)
            || (upper < self.floor && lower >= self.ground)
    }

    /// At least `needed`, or the distance to within a micrometre.
    #[must_use]
    pub fn exact(needed: f64) -> Self {
        Self { needed, floor: needed, ground: needed, absolute: 1e-6, relative: 0.0 }
    }
}

/// Pose of core B in the frame of core A, as matrices want it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relative {
    pub rotation: DMat3,
    pub translation: DVec3,
}

impl Relative {
    #[inline]
    pub(crate) fn between(X_WA: &Pose, X_WB: &Pose) -> Self {
        let back = X_WA.rotation.conjugate();
        Self {
            rotation: DMat3::from_quat(back * X_WB.rotation),
            translation: back * (X_WB.translation - X_WA.translation),
        }
    }

    #[inline]
    pub(crate) fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    pub(crate) fn inverse(&self) -> Self {
        Self { rotation: self.rotation.transpose(), translation: -self.direction_back(self.translation) }
    }

    #[inline]
    pub(crate) fn back(&self, p: DVec3) -> DVec3 {
        self.direction_back(p - self.translation)
    }

    #[inline]
    pub(crate) fn direction_back(&self, d: DVec3) -> DVec3 {
        DVec3::new(self.rotation.x_axis.dot(d), self.rotation.y_axis.dot(d), self.rotation.z_axis.dot(d))
    }
}

/// A lower bound of the distance of two cores less `radii` that is at least `query.needed` or nearly exact; at most
/// −`radii` where the cores (may) overlap. `hint` is a separating direction, from B to A in A's frame, that worked before
/// (zero for none); it is updated.
pub(crate) fn core_distance(
    a: &Core,
    b: &Core,
    X_AB: &Relative,
    radii: f64,
    query: DistanceQuery,
    hint: &mut DVec3,
) -> f64 {
    let farthest_against = |v: DVec3| a.support(-v) - X_AB.point(b.support(X_AB.direction_back(v)));
    descend(farthest_against, || first_direction(a, b, X_AB), radii, query, hint)
}

/// As [`core_distance`] for any two convex sets: `farthest_against` gives the point of A − B that lies farthest against a
/// direction, `first` a direction to begin with and whether it is a point of A − B.
#[inline(always)]
pub(crate) fn descend(
    farthest_against: impl Fn(DVec3) -> DVec3,
    first: impl FnOnce() -> (DVec3, bool),
    radii: f64,
    query: DistanceQuery,
    hint: &mut DVec3,
) -> f64 {
    // What is returned has lost `ROUNDING` and still has to be at least `needed`.
    let enough = query.needed + radii + 2.0 * ROUNDING;
    let floor = query.floor + radii + 2.0 * ROUNDING;
    let ground = query.ground + radii + 2.0 * ROUNDING;
    let mut lower = 0.0_f64;
    if *hint != DVec3::ZERO {
        // The hint is a unit vector.
        lower = hint.dot(farthest_against(*hint)).max(0.0);
        if lower >= enough {
            return lower - radii - ROUNDING;
        }
    }
    let (mut v, mut on_difference) = first();
    let mut simplex: Option<Simplex> = None;
    for _ in 0..MAX_STEPS {
        let length = v.length();
        let n = v / length;
        let w = farthest_against(n);
        let bound = n.dot(w);
        if bound > lower {
            lower = bound;
            *hint = n;
        }
        // A point of A − B also bounds the distance from above.
        let exact = length - lower <= query.absolute.max(query.relative * (length - radii));
        let settled = exact || (length < enough && lower >= floor) || (length < floor && lower >= ground);
        if lower >= enough || (on_difference && settled) {
            return lower - radii - ROUNDING;
        }
        let walked = match &mut simplex {
            Some(simplex) => simplex.add(w),
            None => {
                simplex = Some(Simplex::of(w));
                true
            }
        };
        let Some(simplex) = simplex.as_mut().filter(|_| walked) else { break };
        on_difference = true;
        match simplex.reduce() {
            Closest::Outside(closest) if closest.length_squared() > 1e-24 => v = closest,
            _ => return -radii - ROUNDING,
        }
    }
    // NaN ends here as well: every comparison above is false for it.
    lower - radii - ROUNDING
}

/// A vector from a point of B to a point of A by one step of alternating projection, which for most pairs is already
/// (nearly) the separating direction; and whether it is such a difference (false for the way out of concentric cores).
fn first_direction(a: &Core, b: &Core, X_AB: &Relative) -> (DVec3, bool) {
    let middle = X_AB.point(b.center());
    let on_a = a.closest_to(middle);
    let on_b = X_AB.point(b.closest_to(X_AB.back(on_a)));
    for v in [on_a - on_b, a.center() - middle] {
        if v.length_squared() > 1e-20 {
            return (v, true);
        }
    }
    (DVec3::X, false)
}
