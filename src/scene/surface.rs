//! Solids as triangles.

use foliate_components::robot::shape::Geometry;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Corners around a cylinder or ball.
const AROUND: u32 = 48;
/// Rings of half a ball.
const RINGS: u32 = 12;

/// The surface of a solid as triangles, for what shows it. Round solids are approximated from inside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Corners, metres, in the frame of the solid.
    pub vertices: Vec<[f32; 3]>,
    /// Three indices of vertices each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// The surface of a solid; none where nothing is to be seen.
    #[must_use]
    pub fn of(geometry: &Geometry) -> Option<Self> {
        let (vertices, triangles) = match geometry {
            Geometry::Mesh(mesh) => (mesh.vertices.clone(), mesh.triangles.clone()),
            Geometry::Box { half_extents } => cuboid(*half_extents),
            Geometry::Sphere { radius } => turned(&ball(*radius, 0.0)),
            Geometry::Capsule { radius, half_length } => turned(&ball(*radius, *half_length)),
            Geometry::Cylinder { radius, half_length } => {
                let (r, h) = (*radius, *half_length);
                turned(&[(0.0, -h), (r, -h), (r, h), (0.0, h)])
            }
        };
        let vertices: Vec<[f32; 3]> = vertices.iter().map(|v| v.to_array().map(|x| x as f32)).collect();
        let is_seen = !triangles.is_empty() && vertices.iter().flatten().all(|x| x.is_finite());
        is_seen.then_some(Self { vertices, triangles })
    }
}

fn cuboid(half: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let sign = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    let corner = |i: u32| half * DVec3::new(sign(i & 1), sign(i >> 1 & 1), sign(i >> 2));
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    ((0..8).map(corner).collect(), faces.into_iter().flat_map(halves).collect())
}

/// The outline (distance from the axis, height) of a ball whose halves are drawn apart along z, from below.
fn ball(radius: f64, half_length: f64) -> Vec<(f64, f64)> {
    let ring = |angle: f64, height: f64| (radius * angle.cos().max(0.0), radius * angle.sin() + height);
    let half = |number: u32| f64::from(number) / f64::from(RINGS) * 0.5 * PI;
    let lower = (0..=RINGS).map(|n| ring(half(n) - 0.5 * PI, -half_length));
    let upper = (0..=RINGS).map(|n| ring(half(n), half_length));
    let skipped = usize::from(half_length == 0.0);
    lower.chain(upper.skip(skipped)).collect()
}

/// An outline turned about z; it begins and ends on the axis.
fn turned(outline: &[(f64, f64)]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let last = outline.len() - 1;
    let mut vertices = vec![DVec3::new(0.0, 0.0, outline[0].1), DVec3::new(0.0, 0.0, outline[last].1)];
    for &(radius, height) in &outline[1..last] {
        for number in 0..AROUND {
            let angle = f64::from(number) / f64::from(AROUND) * TAU;
            vertices.push(DVec3::new(radius * angle.cos(), radius * angle.sin(), height));
        }
    }
    let rings = last as u32 - 1;
    let at = |ring: u32, number: u32| 2 + ring * AROUND + number % AROUND;
    let mut triangles = Vec::new();
    for number in 0..AROUND {
        triangles.push([0, at(0, number + 1), at(0, number)]);
        triangles.push([1, at(rings - 1, number), at(rings - 1, number + 1)]);
        for ring in 1..rings {
            let (a, b) = (at(ring - 1, number), at(ring - 1, number + 1));
            let (c, d) = (at(ring, number), at(ring, number + 1));
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    (vertices, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the divergence theorem: positive where triangles are seen from outside.
    fn volume(geometry: &Geometry) -> f64 {
        let surface = Surface::of(geometry).expect("a surface");
        let corner = |i: u32| DVec3::from_array(surface.vertices[i as usize].map(f64::from));
        surface.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0).sum()
    }

    #[test]
    fn solids_have_their_volume_and_are_seen_from_outside() {
        let solids = [
            (Geometry::Box { half_extents: DVec3::new(0.1, 0.2, 0.3) }, 0.048),
            (Geometry::Sphere { radius: 0.5 }, 4.0 / 3.0 * PI * 0.125),
            (Geometry::Cylinder { radius: 0.5, half_length: 1.0 }, PI * 0.5),
            (Geometry::Capsule { radius: 0.5, half_length: 1.0 }, PI * 0.5 + 4.0 / 3.0 * PI * 0.125),
        ];
        for (solid, wanted) in solids {
            let found = volume(&solid);
            assert!((found - wanted).abs() < 0.02 * wanted, "{solid:?}: {found} {wanted}");
        }
    }
}
