//! Points on the surface of a solid, with normals.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use foliate_components::Pose;
use foliate_components::robot::shape::Geometry;
use foliate_systems::runtime::random::{Purpose, stream};
use glam::DVec3;
use rand::RngExt;
use std::f64::consts::TAU;

/// Sides of the prism that stands for a round solid.
const SIDES: usize = 24;
/// Most points of one triangle on a grid.
const MOST_ON_GRID: f64 = 40.0;

/// A point on a surface and the unit normal that points out of the solid there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfacePoint {
    pub point: DVec3,
    pub normal: DVec3,
}

/// The triangles of a solid, in the frame that `X_FS` leads to. Round solids become prisms whose corners lie on them.
pub(crate) fn triangles(geometry: &Geometry, X_FS: &Pose) -> Vec<[DVec3; 3]> {
    let place = |corners: [DVec3; 3]| corners.map(|p| X_FS.transform_point(p));
    match geometry {
        Geometry::Mesh(mesh) => mesh.triangles.iter().map(|t| place(t.map(|i| mesh.vertices[i as usize]))).collect(),
        Geometry::Box { half_extents } => {
            let corner = |i: usize| {
                let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
                *half_extents * DVec3::new(sign(1), sign(2), sign(4))
            };
            let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| place(t.map(corner))).collect()
        }
        Geometry::Cylinder { radius, half_length } => {
            let rings = [(0.0, -half_length), (*radius, -half_length), (*radius, *half_length), (0.0, *half_length)];
            turned(&rings).into_iter().map(place).collect()
        }
        Geometry::Sphere { radius } => turned(&arc(*radius, 0.0)).into_iter().map(place).collect(),
        Geometry::Capsule { radius, half_length } => {
            turned(&arc(*radius, *half_length)).into_iter().map(place).collect()
        }
    }
}

/// Half a circle from the lower pole to the upper one, drawn apart by twice `half_length`: distances from the axis and heights.
fn arc(radius: f64, half_length: f64) -> Vec<(f64, f64)> {
    let steps = SIDES / 2;
    let at = |i: usize| {
        let angle = TAU / 2.0 * i as f64 / steps as f64;
        let z = -radius * angle.cos();
        (radius * angle.sin(), z + half_length.copysign(z))
    };
    (0..=steps).map(at).collect()
}

/// The surface that a line of (distance from z, height) leaves when it turns about z.
fn turned(line: &[(f64, f64)]) -> Vec<[DVec3; 3]> {
    let at = |(r, z): (f64, f64), i: usize| {
        let angle = TAU * (i % SIDES) as f64 / SIDES as f64;
        DVec3::new(r * angle.cos(), r * angle.sin(), z)
    };
    let mut triangles = Vec::new();
    for pair in line.windows(2) {
        for i in 0..SIDES {
            let [a, b, c, d] = [at(pair[0], i), at(pair[0], i + 1), at(pair[1], i + 1), at(pair[1], i)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles.retain(|[a, b, c]| (*b - *a).cross(*c - *a).length() > 0.0);
    triangles
}

/// Points on triangles no farther apart than about `spacing` metres, corners included; of large triangles a bounded number.
pub(crate) fn on_grid(triangles: &[[DVec3; 3]], spacing: f64) -> Vec<DVec3> {
    let mut points = Vec::new();
    for [a, b, c] in triangles {
        let longest = a.distance(*b).max(b.distance(*c)).max(c.distance(*a));
        let steps = (longest / spacing).ceil().clamp(1.0, MOST_ON_GRID) as usize;
        for i in 0..=steps {
            for j in 0..=steps - i {
                let (u, v) = (i as f64 / steps as f64, j as f64 / steps as f64);
                points.push(*a + (*b - *a) * u + (*c - *a) * v);
            }
        }
    }
    points
}

/// So many random points on triangles, evenly by area.
pub(crate) fn random(triangles: &[[DVec3; 3]], count: usize, seed: u64) -> Vec<SurfacePoint> {
    let mut sums = Vec::with_capacity(triangles.len());
    let mut sum = 0.0;
    for [a, b, c] in triangles {
        sum += (*b - *a).cross(*c - *a).length();
        sums.push(sum);
    }
    if triangles.is_empty() || sum.is_nan() || sum <= 0.0 {
        return Vec::new();
    }
    let mut random = stream(seed, PURPOSE, 0, 0);
    let mut draw = || {
        let at: f64 = random.random_range(0.0..sum);
        let [a, b, c] = triangles[sums.partition_point(|&s| s <= at).min(triangles.len() - 1)];
        let (mut u, mut v): (f64, f64) = (random.random_range(0.0..1.0), random.random_range(0.0..1.0));
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let normal = (b - a).cross(c - a).normalize_or_zero();
        SurfacePoint { point: a + (b - a) * u + (c - a) * v, normal }
    };
    (0..count).map(|_| draw()).collect()
}

/// The purpose of the random numbers of a setup.
pub(crate) const PURPOSE: Purpose = Purpose::of_host(17);

/// Where a line from `from` along the unit vector `along` meets triangles: distances and the triangles' normals, the nearest first.
pub(crate) fn ray(triangles: &[[DVec3; 3]], from: DVec3, along: DVec3) -> Vec<(f64, DVec3)> {
    let mut hits: Vec<(f64, DVec3)> = triangles.iter().filter_map(|t| hit(t, from, along)).collect();
    hits.sort_by(|a, b| a.0.total_cmp(&b.0));
    hits
}

fn hit([a, b, c]: &[DVec3; 3], from: DVec3, along: DVec3) -> Option<(f64, DVec3)> {
    let (e, f) = (*b - *a, *c - *a);
    let p = along.cross(f);
    let determinant = e.dot(p);
    if determinant.abs() < 1e-18 {
        return None;
    }
    let s = from - *a;
    let u = s.dot(p) / determinant;
    let q = s.cross(e);
    let v = along.dot(q) / determinant;
    let distance = f.dot(q) / determinant;
    let is_inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0;
    is_inside.then(|| (distance, e.cross(f).normalize_or_zero()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_of_round_solids_lie_on_them_and_point_outwards() {
        for geometry in [
            Geometry::Sphere { radius: 0.1 },
            Geometry::Cylinder { radius: 0.1, half_length: 0.2 },
            Geometry::Capsule { radius: 0.1, half_length: 0.2 },
            Geometry::Box { half_extents: DVec3::new(0.1, 0.2, 0.3) },
        ] {
            let triangles = triangles(&geometry, &Pose::identity());
            let six: f64 = triangles.iter().map(|[a, b, c]| a.dot(b.cross(*c))).sum();
            let (volume, _) = geometry.volume().unwrap();
            // A prism of 24 sides fills at least 0.95 of what it stands for.
            assert!(six / 6.0 > 0.95 * volume && six / 6.0 < 1.0001 * volume, "{}", geometry.kind());
            let points = random(&triangles, 100, 1);
            assert!(points.iter().all(|p| p.normal.dot(p.point) > 0.0), "{}", geometry.kind());
            assert_eq!(points, random(&triangles, 100, 1));
            assert_ne!(points, random(&triangles, 100, 2));
        }
    }

    #[test]
    fn a_ray_meets_both_sides_of_a_box() {
        let triangles = triangles(&Geometry::Box { half_extents: DVec3::splat(0.5) }, &Pose::identity());
        let hits = ray(&triangles, DVec3::new(-2.0, 0.1, 0.2), DVec3::X);
        assert_eq!(hits.iter().map(|hit| hit.0).collect::<Vec<_>>(), [1.5, 2.5]);
        assert_eq!(hits[1].1, DVec3::X);
    }
}
