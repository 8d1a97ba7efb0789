//! Distances of random pairs of shapes of all kinds, beside the search's code; written for coal where that is asked
//! (`FOLIATE_WRITE_DISTANCES=FILE`, see `tests/independent/checker_distances.py`).

use super::apart::Wanted;
use super::pieces::{Pieces, distance};
use foliate_components::Pose;
use foliate_components::pose::exp_so3;
use foliate_components::robot::shape::{Geometry, Mesh};
use foliate_kernels::collision::{DistanceQuery, Solid, clearance};
use glam::DVec3;
use serde_json::json;
use std::fmt::Write;
use std::sync::Arc;

/// Numbers in [-1, 1), the same in every run.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A length between a millimetre and a metre, all sizes alike.
    fn length(&mut self) -> f64 {
        10.0_f64.powf(-1.5 + 1.5 * self.next())
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }

    fn shape(&mut self, kind: usize) -> Geometry {
        match kind {
            0 => Geometry::Sphere { radius: self.length() },
            1 => Geometry::Box { half_extents: DVec3::new(self.length(), self.length(), self.length()) },
            2 => Geometry::Cylinder { radius: self.length(), half_length: self.length() },
            3 => Geometry::Capsule { radius: self.length(), half_length: self.length() },
            _ => Geometry::Mesh(Arc::new(self.mesh())),
        }
    }

    /// A bumpy ball: a mesh that is not convex.
    fn mesh(&mut self) -> Mesh {
        let (rings, sides) = (6_u32, 9_u32);
        let size = self.length();
        let mut vertices = vec![DVec3::Z * size, -DVec3::Z * size];
        for ring in 1..rings {
            for side in 0..sides {
                let (polar, around) = (
                    std::f64::consts::PI * f64::from(ring) / f64::from(rings),
                    std::f64::consts::TAU * f64::from(side) / f64::from(sides),
                );
                let out = DVec3::new(polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos());
                vertices.push(out * size * (1.0 + 0.4 * self.next()));
            }
        }
        let at = |ring: u32, side: u32| match ring {
            0 => 0,
            r if r == rings => 1,
            r => 2 + (r - 1) * sides + side % sides,
        };
        let mut triangles = Vec::new();
        for ring in 0..rings {
            for side in 0..sides {
                let quad = [at(ring, side), at(ring + 1, side), at(ring + 1, side + 1), at(ring, side + 1)];
                triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
            }
        }
        triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        Mesh::new("bumpy".into(), vertices, triangles)
    }
}

fn told(geometry: &Geometry) -> serde_json::Value {
    match geometry {
        Geometry::Sphere { radius } => json!({ "kind": "sphere", "radius": radius }),
        Geometry::Box { half_extents } => json!({ "kind": "box", "half": half_extents.to_array() }),
        Geometry::Cylinder { radius, half_length } => {
            json!({ "kind": "cylinder", "radius": radius, "half": half_length })
        }
        Geometry::Capsule { radius, half_length } => {
            json!({ "kind": "capsule", "radius": radius, "half": half_length })
        }
        Geometry::Mesh(mesh) => {
            let vertices: Vec<_> = mesh.vertices.iter().map(|v| v.to_array()).collect();
            json!({ "kind": "mesh", "vertices": vertices, "triangles": mesh.triangles })
        }
    }
}

#[test]
fn distances_are_those_of_the_search_and_bounds_close() {
    let out = std::env::var("FOLIATE_WRITE_DISTANCES").ok();
    let rounds = if out.is_some() { 1_000 } else { 60 };
    let mut random = Numbers(11);
    let mut text = String::new();
    for round in 0..rounds {
        for (one, other) in (0..5).flat_map(|a| (a..5).map(move |b| (a, b))) {
            let (a, b) = (random.shape(one), random.shape(other));
            let far = (a.radius_about_origin() + b.radius_about_origin()) * (0.9 + 0.6 * random.next());
            let pose = Pose::from_parts(random.vector().normalize() * far, exp_so3(3.0 * random.vector()));
            let wanted = Wanted { enough: f64::INFINITY, open: 1e-9, share: 0.0, around: 0.0 };
            let found = distance(&Pieces::of(&a), &Pieces::of(&b), &pose, &wanted, &mut None);
            let ask = DistanceQuery { absolute: 1e-9, ..DistanceQuery::exact(f64::MAX) };
            let search =
                clearance(&Solid::of(&a), &Pose::identity(), &Solid::of(&b), &pose, ask, &mut DVec3::ZERO.clone());
            let case = format!("round {round}: {} {}: {found:?}, the search says {search}", a.kind(), b.kind());
            assert!(found.upper - found.lower < 1e-7 || found.upper <= 0.0, "{case}");
            if search > 1e-9 || found.lower > 1e-9 {
                // A mesh around the other's surface is hollow here: enclosure is tested elsewhere.
                let hollow = search <= 0.0 && (one == 4 || other == 4);
                assert!(hollow || (found.lower - search).abs() < 1e-6, "{case}");
            }
            // Less is asked for: no more than what is, and enough where there is.
            let enough = 0.5 * found.lower.max(0.0);
            let less = Wanted { enough, open: 1e-6, share: 0.05, around: 0.0 };
            let bound = distance(&Pieces::of(&a), &Pieces::of(&b), &pose, &less, &mut None).lower;
            assert!(
                bound <= found.upper.max(0.0) + 1e-12 && (bound >= enough || found.upper <= 0.0),
                "{case}: {bound}"
            );
            if out.is_some() {
                let row = json!({ "a": told(&a), "b": told(&b), "position": pose.translation.to_array(),
                                  "quaternion": pose.rotation.to_array(), "lower": found.lower, "upper": found.upper });
                let _ = writeln!(text, "{row}");
            }
        }
    }
    if let Some(out) = out {
        std::fs::write(out, text).expect("the file of distances");
    }
}
