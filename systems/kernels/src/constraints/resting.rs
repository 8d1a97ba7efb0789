//! Whether an object lies on a support as its placement's rule asks, and where the nearest places are at which it does.
//!
//! Its footings (points in the plane) are inside the support by a margin where the origin p of its polygon keeps
//! `n_k · p ≤ b_k(turn)` for every edge k: the support's polygon, shrunk by what the turned footings need. So a place is found by
//! shrinking the support, without trying.

use foliate_components::Pose;
use foliate_components::constraint::{Placement, Polygon};
use glam::{DVec2, DVec3};

/// Most steps to a place where the footings fit.
const STEPS: usize = 32;
/// A step goes this much farther than onto the edge, metres.
const BEYOND: f64 = 1e-9;

/// An object that does not lie on its support as it must.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overhang {
    /// How far it is from where it does, in the plane, metres; zero up to rounding only at its bounds.
    pub distance: f64,
    /// Where it is less where it is to be, (y, z) of the support's frame, metres. As long as no place fits it at its turn this never
    /// gets shorter than what is missing.
    pub error: DVec2,
}

/// How the object of a placement, its polygon `object` at `X_SO` in the frame of polygon `support`, breaks the rule; `None` where it
/// keeps it. On a polygon that cannot carry the object the distance is infinite. Not for [`Rests::Centre`], which has no footings.
///
/// What is outside is mapped inwards along the ray to a place where the footings fit, by inversion: near the bounds of the places
/// stays near, and what is far away gets near the middle.
///
/// [`Rests::Centre`]: foliate_components::constraint::Rests::Centre
#[must_use]
pub fn overhang(placement: &Placement, object: usize, support: usize, X_SO: &Pose) -> Option<Overhang> {
    let footings = placement.footings.get(object).map_or(&[][..], Vec::as_slice);
    if footings.is_empty() {
        return Some(Overhang { distance: f64::INFINITY, error: DVec2::Y });
    }
    let polygon = &placement.supports[support];
    let turned = |footing: &DVec2| in_plane(X_SO.rotation * DVec3::new(0.0, footing.x, footing.y));
    // n_k · p − b_k: how far beyond edge k the farthest footing is.
    let beyond = |k: usize, p: DVec2| {
        let reach = footings.iter().map(|f| polygon.normals[k].dot(turned(f))).fold(f64::NEG_INFINITY, f64::max);
        polygon.normals[k].dot(p - polygon.vertices[k]) + reach + placement.rests.margin()
    };
    let p = in_plane(X_SO.translation);
    if worst(polygon, |k| beyond(k, p)).1 <= 0.0 {
        return None;
    }
    let middle = footings.iter().map(turned).sum::<DVec2>() / footings.len() as f64;
    let (fits, missing) = fitting(polygon, -middle, &beyond);
    let away = p - fits;
    if missing > 0.0 {
        // Never zero, so that no solve ends here.
        let error = away + missing * away.try_normalize().unwrap_or(DVec2::X);
        return Some(Overhang { distance: error.length(), error });
    }
    // Share of the way to the place that fits at which every edge is kept.
    let share = |k: usize| {
        let out = beyond(k, p);
        if out > 0.0 { out / (out - beyond(k, fits)) } else { 0.0 }
    };
    let share = (0..polygon.normals.len()).map(share).fold(0.0, f64::max);
    let left = 1.0 - share;
    Some(Overhang { distance: share * away.length(), error: (1.0 - left * left) * away })
}

/// A place at which the footings fit, looked for from `p` by steps over the edge that is broken most (Agmon's relaxation), and what
/// is missing there: zero where they fit.
fn fitting(polygon: &Polygon, mut p: DVec2, beyond: &impl Fn(usize, DVec2) -> f64) -> (DVec2, f64) {
    for _ in 0..STEPS {
        let (edge, out) = worst(polygon, |k| beyond(k, p));
        if out <= 0.0 {
            return (p, 0.0);
        }
        p -= (out + BEYOND) * polygon.normals[edge];
    }
    (p, worst(polygon, |k| beyond(k, p)).1.max(0.0))
}

fn worst(polygon: &Polygon, beyond: impl Fn(usize) -> f64) -> (usize, f64) {
    let edges = (0..polygon.normals.len()).map(|k| (k, beyond(k)));
    edges.fold((0, f64::NEG_INFINITY), |most, edge| if edge.1 > most.1 { edge } else { most })
}

fn in_plane(v: DVec3) -> DVec2 {
    DVec2::new(v.y, v.z)
}
