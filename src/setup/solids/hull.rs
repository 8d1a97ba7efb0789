//! The convex hull of points, as flat facets.

use glam::DVec3;
use std::collections::HashSet;

/// Directions in which extreme points are looked for where there are many points.
const DIRECTIONS: usize = 600;
/// Points up to which all are taken.
const FEW: usize = 400;
/// Facets whose normals differ by less (radians) and whose planes by less than this share of the size are one.
const FLAT: (f64, f64) = (5e-3, 5e-4);
/// Most corners of a facet.
const CORNERS: usize = 24;

/// A flat face of a hull.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Facet {
    /// Unit normal out of the hull.
    pub normal: DVec3,
    /// Corners in one plane, counter-clockwise seen from outside.
    pub corners: Vec<DVec3>,
    /// Square metres.
    pub area: f64,
}

impl Facet {
    /// How far a point, moved along the normal into the plane, is inside the facet, metres; negative outside.
    pub(crate) fn inside(&self, point: DVec3) -> f64 {
        let next = self.corners.iter().cycle().skip(1);
        let beyond = |(a, b): (&DVec3, &DVec3)| {
            let inwards = self.normal.cross(*b - *a).normalize_or_zero();
            inwards.dot(point - *a)
        };
        self.corners.iter().zip(next).map(beyond).fold(f64::INFINITY, f64::min)
    }
}

/// The facets of the hull of points, the largest first; none where the points lie in a plane. Of many points only the extreme ones in
/// evenly spread directions count.
pub(crate) fn facets(points: &[DVec3]) -> Vec<Facet> {
    let points = extreme(points);
    let Some(faces) = hull(&points) else { return Vec::new() };
    let size = size(&points);
    let mut normals: Vec<(DVec3, f64, f64, [usize; 3])> = faces
        .iter()
        .map(|&[a, b, c]| {
            let cross = (points[b] - points[a]).cross(points[c] - points[a]);
            let normal = cross.normalize_or_zero();
            (normal, normal.dot(points[a]), cross.length() / 2.0, [a, b, c])
        })
        .collect();
    // Large faces say the plane; slivers join them.
    normals.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut planes: Vec<(DVec3, f64, HashSet<usize>)> = Vec::new();
    for (normal, offset, _, corners) in normals {
        let same = |plane: &&mut (DVec3, f64, HashSet<usize>)| {
            plane.0.dot(normal) > FLAT.0.cos() && (plane.1 - offset).abs() < FLAT.1 * size
        };
        match planes.iter_mut().find(same) {
            Some(plane) => plane.2.extend(corners),
            None => planes.push((normal, offset, corners.into_iter().collect())),
        }
    }
    let mut facets: Vec<Facet> = planes.into_iter().filter_map(|plane| facet(&points, &plane)).collect();
    facets.sort_by(|a, b| b.area.total_cmp(&a.area));
    facets
}

fn size(points: &[DVec3]) -> f64 {
    let low = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let high = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
    (high - low).length()
}

/// The convex polygon of points in a plane.
fn facet(points: &[DVec3], (normal, offset, corners): &(DVec3, f64, HashSet<usize>)) -> Option<Facet> {
    let x = normal.any_orthonormal_vector();
    let y = normal.cross(x);
    let mut flat: Vec<(f64, f64)> = corners.iter().map(|&i| (points[i].dot(x), points[i].dot(y))).collect();
    flat.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let polygon = thinned(chain(&flat));
    let next = polygon.iter().cycle().skip(1);
    let area = polygon.iter().zip(next).map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum::<f64>() / 2.0;
    let corners = polygon.into_iter().map(|(u, v)| x * u + y * v + *normal * *offset).collect();
    (area > 0.0).then_some(Facet { normal: *normal, corners, area })
}

/// Andrew's chain: the convex hull of sorted points, counter-clockwise, without points on its sides.
fn chain(sorted: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let turn = |a: (f64, f64), b: (f64, f64), c: (f64, f64)| (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0);
    let half = |points: &mut dyn Iterator<Item = (f64, f64)>| {
        let mut line: Vec<(f64, f64)> = Vec::new();
        for point in points {
            while line.len() > 1 && turn(line[line.len() - 2], line[line.len() - 1], point) <= 1e-14 {
                line.pop();
            }
            line.push(point);
        }
        line.pop();
        line
    };
    let mut polygon = half(&mut sorted.iter().copied());
    polygon.extend(half(&mut sorted.iter().rev().copied()));
    polygon
}

/// Leaves out corners that cost the least area, until few are left.
fn thinned(mut polygon: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    while polygon.len() > CORNERS {
        let n = polygon.len();
        let cost = |i: usize| {
            let (a, b, c) = (polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n]);
            ((b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)).abs()
        };
        let least = (0..n).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(0);
        polygon.remove(least);
    }
    polygon
}

/// The extreme points in evenly spread directions, or all where they are few; each position once.
fn extreme(points: &[DVec3]) -> Vec<DVec3> {
    let mut kept: Vec<DVec3> = Vec::new();
    let mut seen = HashSet::new();
    let mut keep = |point: DVec3| {
        if point.is_finite() && seen.insert(point.to_array().map(f64::to_bits)) {
            kept.push(point);
        }
    };
    if points.len() <= FEW {
        points.iter().copied().for_each(&mut keep);
        return kept;
    }
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let spiral = (0..DIRECTIONS).map(|i| {
        let z = 1.0 - 2.0 * (i as f64 + 0.5) / DIRECTIONS as f64;
        let (r, angle) = ((1.0 - z * z).sqrt(), golden * i as f64);
        DVec3::new(r * angle.cos(), r * angle.sin(), z)
    });
    for along in spiral.chain([DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z]) {
        // All corners of a face that lies across the direction count.
        let farthest = points.iter().map(|p| p.dot(along)).fold(f64::NEG_INFINITY, f64::max);
        points.iter().filter(|p| p.dot(along) >= farthest - 1e-9).copied().for_each(&mut keep);
    }
    kept
}

/// The triangles of the hull, counter-clockwise seen from outside; none where the points lie in a plane.
fn hull(points: &[DVec3]) -> Option<Vec<[usize; 3]>> {
    let near = 1e-9 * size(points).max(1e-9);
    let mut faces = tetrahedron(points, near)?;
    for (index, &point) in points.iter().enumerate() {
        let sees = |face: &[usize; 3]| {
            let [a, b, c] = face.map(|i| points[i]);
            (b - a).cross(c - a).normalize_or_zero().dot(point - a) > near
        };
        let (visible, hidden): (Vec<_>, Vec<_>) = faces.iter().copied().partition(sees);
        if visible.is_empty() {
            continue;
        }
        let edges: HashSet<(usize, usize)> = visible.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        faces = hidden;
        // In the order of the faces, so that the result does not depend on the order of a set.
        for &[a, b, c] in &visible {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                if !edges.contains(&(to, from)) {
                    faces.push([from, to, index]);
                }
            }
        }
    }
    Some(faces)
}

/// Four points that span a solid.
fn tetrahedron(points: &[DVec3], near: f64) -> Option<Vec<[usize; 3]>> {
    let best = |value: &dyn Fn(DVec3) -> f64| {
        let found = (0..points.len()).max_by(|&a, &b| value(points[a]).total_cmp(&value(points[b])))?;
        (value(points[found]) > near).then_some(found)
    };
    let a = (0..points.len()).min_by(|&a, &b| points[a].x.total_cmp(&points[b].x))?;
    let b = best(&|p| p.distance(points[a]))?;
    let line = (points[b] - points[a]).normalize_or_zero();
    let c = best(&|p| (p - points[a]).reject_from_normalized(line).length())?;
    let normal = (points[b] - points[a]).cross(points[c] - points[a]).normalize_or_zero();
    let d = best(&|p| normal.dot(p - points[a]).abs())?;
    let (b, c) = if normal.dot(points[d] - points[a]) > 0.0 { (c, b) } else { (b, c) };
    Some(vec![[a, b, c], [a, d, b], [b, d, c], [c, d, a]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::solids::surface_points::{on_grid, triangles};
    use foliate_components::Pose;
    use foliate_components::robot::shape::Geometry;

    #[test]
    fn a_box_has_six_facets_whatever_points_lie_on_it() {
        let solid = Geometry::Box { half_extents: DVec3::new(0.1, 0.2, 0.3) };
        let triangles = triangles(&solid, &Pose::identity());
        for points in [on_grid(&triangles, 1.0), on_grid(&triangles, 0.02)] {
            let facets = facets(&points);
            assert_eq!(facets.len(), 6);
            for facet in &facets {
                assert_eq!(facet.corners.len(), 4);
                assert!(facet.corners.iter().all(|corner| facet.normal.dot(*corner) > 0.0));
            }
            assert!((facets[0].area - 0.24).abs() < 1e-9);
            assert!((facets[0].inside(DVec3::ZERO) - 0.2).abs() < 1e-9);
            assert!(facets[0].inside(DVec3::new(0.0, 0.25, 0.0)) < 0.0);
        }
    }

    #[test]
    fn a_cylinder_has_two_ends_and_narrow_sides() {
        let solid = Geometry::Cylinder { radius: 0.05, half_length: 0.1 };
        let points = on_grid(&triangles(&solid, &Pose::identity()), 0.05);
        let facets = facets(&points);
        assert_eq!(facets.len(), 26);
        assert_eq!(facets.iter().filter(|facet| facet.normal.z.abs() > 0.99).count(), 2);
    }

    #[test]
    fn flat_points_have_no_hull() {
        assert_eq!(facets(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)]), []);
        assert_eq!(facets(&[]), []);
    }
}
