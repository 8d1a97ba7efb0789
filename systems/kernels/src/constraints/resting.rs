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
    let beyond = beyond_edges(placement, footings, polygon, X_SO);
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

/// The shortest way in the plane, (y, z) of the support's frame, metres, after which an object lies on its support as the rule asks: where it
/// hangs over one edge, and nearly so at corners. `None` where it lies so already, where no place is found at its turn, and by
/// [`Rests::Centre`], which has no footings.
///
/// [`Rests::Centre`]: foliate_components::constraint::Rests::Centre
#[must_use]
pub fn way_inside(placement: &Placement, object: usize, support: usize, X_SO: &Pose) -> Option<DVec2> {
    let footings = placement.footings.get(object).filter(|footings| !footings.is_empty())?;
    let polygon = &placement.supports[support];
    let p = in_plane(X_SO.translation);
    let (fits, missing) = fitting(polygon, p, &beyond_edges(placement, footings, polygon, X_SO));
    (missing <= 0.0 && fits != p).then(|| fits - p)
}

/// n_k · p − b_k: how far beyond edge k the farthest footing is where the origin of the object's polygon is at p.
fn beyond_edges<'p>(
    placement: &'p Placement,
    footings: &'p [DVec2],
    polygon: &'p Polygon,
    X_SO: &Pose,
) -> impl Fn(usize, DVec2) -> f64 + 'p {
    let rotation = X_SO.rotation;
    move |k, p| {
        let turned = |footing: &DVec2| in_plane(rotation * DVec3::new(0.0, footing.x, footing.y));
        let reach = footings.iter().map(|f| polygon.normals[k].dot(turned(f))).fold(f64::NEG_INFINITY, f64::max);
        polygon.normals[k].dot(p - polygon.vertices[k]) + reach + placement.rests.margin()
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::constraint::{Frame, Rests, Side};
    use foliate_components::pose::exp_so3;

    /// Numbers in [-1, 1), the same in every run.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    fn rectangle(half: DVec2, at: DVec2, side: Side) -> Polygon {
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let points = corners.map(|(x, y)| DVec3::new(at.x + x * half.x, at.y + y * half.y, 0.0));
        Polygon::new(Frame::world(Pose::identity()), &points, side).unwrap()
    }

    fn placement(half: DVec2, support: Polygon, rests: Rests, centre: DVec3) -> Placement {
        let object = rectangle(half, DVec2::ZERO, Side::Object);
        Placement::from_polygons(vec![object], vec![support], 0.001).unwrap().resting(rests, Some(centre)).unwrap()
    }

    fn at(p: DVec2, turn: f64) -> Pose {
        Pose::from_parts(DVec3::new(-0.001, p.x, p.y), exp_so3(DVec3::X * turn))
    }

    /// How far the farthest footing is beyond the margin, from the definition.
    fn broken(placement: &Placement, X_SO: &Pose) -> f64 {
        let inside = |footing: &DVec2| {
            let p = in_plane(X_SO.transform_point(DVec3::new(0.0, footing.x, footing.y)));
            placement.supports[0].signed_distance(p) + placement.rests.margin()
        };
        placement.footings[0].iter().map(inside).fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn one_correction_leads_to_a_place_that_keeps_the_rule() {
        let mut random = Numbers(7);
        let rules =
            [Rests::Stable { margin: 0.005 }, Rests::WholeFace { margin: 0.0 }, Rests::WholeFace { margin: 0.01 }];
        let mut spread: f64 = 0.0;
        for case in 0..3000 {
            let half = DVec2::new(0.05 + 0.02 * random.next(), 0.08 + 0.03 * random.next());
            let support = rectangle(DVec2::new(0.2, 0.3), DVec2::ZERO, Side::Support);
            let centre = DVec3::new(0.02 * random.next(), 0.03 * random.next(), 0.1);
            let lying = placement(half, support, rules[case % 3], centre);
            let p = DVec2::new(random.next(), random.next());
            let turn = 3.0 * random.next();
            let Some(over) = overhang(&lying, 0, 0, &at(p, turn)) else {
                assert!(broken(&lying, &at(p, turn)) <= 1e-12);
                continue;
            };
            assert!(broken(&lying, &at(p, turn)) > -1e-12 && over.distance > 0.0);
            let corrected = p - over.error;
            assert!(broken(&lying, &at(corrected, turn)) <= 1e-12, "{p} {corrected}");
            spread = spread.max(corrected.length());
        }
        assert!(spread > 0.15, "all corrections end in the middle");
    }

    #[test]
    fn near_the_edge_the_error_is_about_what_hangs_over() {
        let support = || rectangle(DVec2::new(0.2, 0.3), DVec2::ZERO, Side::Support);
        let lying = placement(DVec2::new(0.05, 0.08), support(), Rests::WholeFace { margin: 0.0 }, DVec3::ZERO);
        for by in [1e-12, 1e-6, 1e-3] {
            // Along the long side of the support: y of its frame is x of the world or its opposite.
            let over = [0.15 + by, 0.22 + by]
                .map(|far| [DVec2::X, DVec2::Y].map(|axis| overhang(&lying, 0, 0, &at(axis * far, 0.0))));
            let errors = over.iter().flatten().flatten().map(|over| (over.error.length(), over.distance));
            let near = errors
                .filter(|&(error, distance)| (distance - by).abs() < 0.5 * by && (error - 2.0 * by).abs() < 0.5 * by);
            assert!(near.count() >= 1, "{by}: {over:?}");
        }
    }

    #[test]
    fn where_nothing_fits_the_error_never_ends() {
        // 100 mm of object on 60 mm of support: it fits at no turn.
        let support = rectangle(DVec2::new(0.03, 0.5), DVec2::ZERO, Side::Support);
        let lying = placement(DVec2::new(0.05, 0.05), support, Rests::WholeFace { margin: 0.0 }, DVec3::ZERO);
        let mut random = Numbers(11);
        for _ in 0..200 {
            let (mut p, turn) = (0.3 * DVec2::new(random.next(), random.next()), 3.0 * random.next());
            for _ in 0..30 {
                let over = overhang(&lying, 0, 0, &at(p, turn)).unwrap();
                assert!(over.error.length() > 0.015, "{over:?}");
                p -= over.error;
            }
        }
    }

    #[test]
    fn a_place_is_found_that_is_not_in_the_middle() {
        // The mean of the corners of this triangle is too near to its sides for the long object, the wide end is not.
        let points = [(0.0, 0.0), (0.3, -0.02), (0.3, 0.2), (0.28, 0.2)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let support = Polygon::new(Frame::world(Pose::identity()), &points, Side::Support).unwrap();
        let lying = placement(DVec2::new(0.01, 0.075), support, Rests::WholeFace { margin: 0.0 }, DVec3::ZERO);
        let fits = (0..64).filter(|turn| {
            let pose = |p| at(p, f64::from(*turn) * 0.1);
            let over = overhang(&lying, 0, 0, &pose(DVec2::new(1.0, 1.0))).unwrap();
            broken(&lying, &pose(DVec2::new(1.0, 1.0) - over.error)) <= 1e-9
        });
        assert!(fits.count() > 4);
    }
}
