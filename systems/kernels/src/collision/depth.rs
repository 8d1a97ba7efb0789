//! How deep two solids are in each other: a lower bound, which for convex ones is sharp or nearly so.
//!
//! A ball of radius r around a point of one solid, all inside of it, whose middle is d deep inside the other: to set the two apart the
//! one has to be shifted by at least d + r. For convex solids the largest such sum is found by climbing; for two boxes or balls it
//! is the penetration depth. The climb starts from points of both shapes and of the box that holds their common part. It is slow: for
//! messages and reports only.

use crate::collision::convex::gjk::DistanceQuery;
use crate::collision::convex::{Convex, Core};
use crate::collision::distance::query::clearance;
use crate::collision::solids::solid::Solid;
use foliate_components::Pose;
use foliate_components::robot::shape::Geometry;
use glam::DVec3;

/// Points of a side of the lattice from which the climb starts.
const LATTICE: i32 = 7;
/// Vertices of a mesh from which it starts.
const VERTICES: usize = 400;
/// Starts that are followed.
const CLIMBS: usize = 4;
/// A point that is outside by less is on the surface, metres.
const ON: f64 = 1e-9;
/// How often steps are halved: from a quarter of the smaller shape to two millionths of its size.
const HALVINGS: u32 = 17;

/// A shape at its place in the world.
#[derive(Clone, Copy)]
pub struct PlacedSolid<'a> {
    /// The shape as the model has it.
    pub geometry: &'a Geometry,
    /// What distances are computed with.
    pub solid: &'a Solid,
    /// Where it is in the world.
    pub pose: Pose,
}

impl PlacedSolid<'_> {
    /// How deep a point of the world is inside; none outside, or where nothing is known to be inside.
    fn inside(&self, point: DVec3) -> Option<f64> {
        let p = self.pose.inverse_transform_point(point);
        match self.geometry {
            Geometry::Mesh(_) => self.inside_mesh(p),
            _ => Some(self.primitive(p)).filter(|depth| *depth > 0.0),
        }
    }

    /// How deep a point of the shape's frame is inside of a primitive; negative outside.
    fn primitive(&self, p: DVec3) -> f64 {
        match self.geometry {
            Geometry::Sphere { radius } => radius - p.length(),
            Geometry::Box { half_extents } => (*half_extents - p.abs()).min_element(),
            Geometry::Cylinder { radius, half_length } => (radius - p.truncate().length()).min(half_length - p.z.abs()),
            Geometry::Capsule { radius, half_length } => {
                radius - p.distance(DVec3::Z * p.z.clamp(-half_length, *half_length))
            }
            Geometry::Mesh(_) => f64::NEG_INFINITY,
        }
    }

    fn inside_mesh(&self, p: DVec3) -> Option<f64> {
        let Solid::Mesh(mesh) = self.solid else { return None };
        if !mesh.is_closed() || !mesh.contains(p) {
            return None;
        }
        let point = Solid::Convex(Convex { core: Core::Point, radius: 0.0 });
        let at = Pose::from_translation(p);
        let mut hint = DVec3::ZERO;
        Some(clearance(self.solid, &Pose::identity(), &point, &at, DistanceQuery::exact(f64::MAX), &mut hint).max(0.0))
    }

    /// A box along the axes of the world that holds the shape: least and greatest corner.
    fn bounds(&self) -> [DVec3; 2] {
        if let Geometry::Mesh(mesh) = self.geometry {
            let placed = mesh.vertices.iter().map(|&v| self.pose.transform_point(v));
            let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
            return placed.fold(none, |[low, high], v| [low.min(v), high.max(v)]);
        }
        let half = DVec3::splat(self.geometry.radius_about_origin());
        [self.pose.translation - half, self.pose.translation + half]
    }

    /// Points from which to look, in the world.
    fn starts(&self) -> Vec<DVec3> {
        let half = match self.geometry {
            Geometry::Sphere { radius } => DVec3::splat(*radius),
            Geometry::Box { half_extents } => *half_extents,
            Geometry::Cylinder { radius, half_length } => DVec3::new(*radius, *radius, *half_length),
            Geometry::Capsule { radius, half_length } => DVec3::new(*radius, *radius, half_length + radius),
            Geometry::Mesh(mesh) => {
                let stride = mesh.vertices.len().div_ceil(VERTICES).max(1);
                return mesh.vertices.iter().step_by(stride).map(|&v| self.pose.transform_point(v)).collect();
            }
        };
        let place = |i: i32| 2.0 * f64::from(i) / f64::from(LATTICE - 1) - 1.0;
        let points = lattice(0..LATTICE).map(|(x, y, z)| half * DVec3::new(place(x), place(y), place(z)));
        points.filter(|&p| self.primitive(p) >= -ON).map(|p| self.pose.transform_point(p)).collect()
    }
}

/// No shift shorter than this sets the two apart, metres; none where no point is known to be inside both.
#[must_use]
pub fn depth(a: PlacedSolid<'_>, b: PlacedSolid<'_>) -> Option<f64> {
    deepest(a, b).map(|(depth, _)| depth)
}

/// As [`depth`], and the point in the world that is so deep in both together.
#[must_use]
pub fn deepest(a: PlacedSolid<'_>, b: PlacedSolid<'_>) -> Option<(f64, DVec3)> {
    // What is cheap is asked first, and most points are outside of it.
    let (cheap, dear) = if matches!(a.geometry, Geometry::Mesh(_)) { (b, a) } else { (a, b) };
    let both = |p: DVec3| Some(cheap.inside(p)? + dear.inside(p)?);
    // A start is in or on the one solid, and inside the other.
    let starts_of = |one: PlacedSolid<'_>, other: PlacedSolid<'_>| {
        let inside = move |p: DVec3| Some((other.inside(p)?, p));
        one.starts().into_iter().filter_map(inside).collect::<Vec<_>>()
    };
    let mut starts = starts_of(a, b);
    starts.extend(starts_of(b, a));
    let inside = |p: DVec3| Some((both(p)?, p));
    starts.extend(common_box(a, b).filter_map(inside));
    starts.sort_by(|x, y| y.0.total_cmp(&x.0));
    let step = 0.25 * size(&a).min(size(&b));
    let best = starts.iter().take(CLIMBS).map(|&(found, start)| {
        let (mut best, mut at, mut step) = (found, start, step);
        for _ in 0..HALVINGS {
            let around = directions().map(|direction| direction * step);
            let better = around.filter_map(|by| Some((both(at + by)?, at + by)));
            match better.max_by(|x, y| x.0.total_cmp(&y.0)).filter(|(found, _)| *found > best) {
                Some(next) => (best, at) = next,
                None => step *= 0.5,
            }
        }
        (best, at)
    });
    best.reduce(|x, y| if y.0 > x.0 { y } else { x })
}

/// Points of a lattice over the common part of the boxes around two shapes, along the axes of the world.
fn common_box(a: PlacedSolid<'_>, b: PlacedSolid<'_>) -> impl Iterator<Item = DVec3> {
    let ([low_a, high_a], [low_b, high_b]) = (a.bounds(), b.bounds());
    let (low, high) = (low_a.max(low_b), high_a.min(high_b));
    let share = |i: i32| (f64::from(i) + 0.5) / f64::from(LATTICE);
    lattice(0..LATTICE).map(move |(x, y, z)| low + (high - low) * DVec3::new(share(x), share(y), share(z)))
}

/// The axes, and what is between two and three of them: a ridge of the depth is climbed along one of these.
fn directions() -> impl Iterator<Item = DVec3> {
    let all = lattice(-1..2).map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
    all.filter_map(DVec3::try_normalize)
}

fn lattice(side: std::ops::Range<i32>) -> impl Iterator<Item = (i32, i32, i32)> {
    let (y, z) = (side.clone(), side.clone());
    side.flat_map(move |x| {
        let z = z.clone();
        y.clone().flat_map(move |y| z.clone().map(move |z| (x, y, z)))
    })
}

fn size(shape: &PlacedSolid<'_>) -> f64 {
    shape.geometry.radius_about_origin().max(1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::robot::shape::Mesh;
    use glam::DQuat;
    use std::sync::Arc;

    fn found(one: &Geometry, other: &Geometry, apart: DVec3) -> Option<f64> {
        let (first, second) = (Solid::of(one), Solid::of(other));
        depth(
            PlacedSolid { geometry: one, solid: &first, pose: Pose::identity() },
            PlacedSolid { geometry: other, solid: &second, pose: Pose::from_translation(apart) },
        )
    }

    #[test]
    fn boxes_and_balls_have_their_penetration_depth() {
        let cube = Geometry::Box { half_extents: DVec3::splat(0.1) };
        let ball = Geometry::Sphere { radius: 0.1 };
        for (depth, apart) in [(0.03, 0.17), (0.001, 0.199), (0.15, 0.05)] {
            let boxes = found(&cube, &cube, DVec3::new(apart, 0.01, 0.02)).unwrap();
            assert!((boxes - depth).abs() < 1e-4 * depth.max(0.1), "{boxes} {depth}");
            let balls = found(&ball, &ball, DVec3::X * apart).unwrap();
            assert!(balls <= depth + 1e-9 && balls > 0.98 * depth - 1e-4, "{balls} {depth}");
        }
        assert_eq!(found(&cube, &cube, DVec3::X * 0.21), None);
    }

    /// Pushes `other`, turned, into the top of `one` at z = 0.05, by `depth`; its lowest point is `low` under its origin.
    fn pushed(one: &Geometry, other: &Geometry, turn: DQuat, low: f64, depth_wanted: f64) {
        let (first, second) = (Solid::of(one), Solid::of(other));
        let at = Pose::from_parts(DVec3::new(0.013, -0.007, 0.05 + low - depth_wanted), turn);
        let found = depth(
            PlacedSolid { geometry: one, solid: &first, pose: Pose::identity() },
            PlacedSolid { geometry: other, solid: &second, pose: at },
        );
        let found = found.unwrap();
        let close = found <= depth_wanted + 1e-9 && found > 0.97 * depth_wanted - 2e-5;
        assert!(close, "{} in {}: {found} instead of {depth_wanted}", other.kind(), one.kind());
    }

    fn mesh_box(half: DVec3) -> Geometry {
        let vertices = (0..8).map(|i| half * DVec3::new(sign(i, 1), sign(i, 2), sign(i, 4))).collect();
        let triangles = [
            [0, 2, 3],
            [0, 3, 1],
            [4, 5, 7],
            [4, 7, 6],
            [0, 1, 5],
            [0, 5, 4],
            [2, 6, 7],
            [2, 7, 3],
            [0, 4, 6],
            [0, 6, 2],
            [1, 3, 7],
            [1, 7, 5],
        ];
        let mesh = Mesh::new("box".into(), vertices, triangles.to_vec());
        assert!(mesh.closed);
        Geometry::Mesh(Arc::new(mesh))
    }

    fn sign(number: i32, bit: i32) -> f64 {
        if number & bit == 0 { -1.0 } else { 1.0 }
    }

    #[test]
    fn overlaps_of_known_depth_are_found_between_boxes_and_meshes() {
        let (table, block) = (DVec3::new(0.4, 0.3, 0.05), DVec3::new(0.03, 0.04, 0.06));
        // The corner that points down.
        let turn = DQuat::from_rotation_x(0.4) * DQuat::from_rotation_y(0.7);
        let corner = (turn.conjugate() * DVec3::Z).abs().dot(block);
        for depth in [0.002, 0.028] {
            for table in [Geometry::Box { half_extents: table }, mesh_box(table)] {
                for block_shape in [Geometry::Box { half_extents: block }, mesh_box(block)] {
                    pushed(&table, &block_shape, DQuat::from_rotation_z(0.3), block.z, depth);
                    pushed(&table, &block_shape, turn, corner, depth);
                }
                pushed(&table, &Geometry::Sphere { radius: 0.05 }, DQuat::IDENTITY, 0.05, depth);
                let lying = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
                pushed(&table, &Geometry::Cylinder { radius: 0.04, half_length: 0.1 }, lying, 0.04, depth);
            }
        }
    }

    #[test]
    fn meshes_that_cross_without_a_vertex_inside_have_a_depth() {
        // A bar through a plate: to set them apart it has to leave sideways.
        let (plate, bar) = (mesh_box(DVec3::new(0.2, 0.2, 0.01)), mesh_box(DVec3::new(0.02, 0.02, 0.3)));
        let (first, second) = (Solid::of(&plate), Solid::of(&bar));
        let found = depth(
            PlacedSolid { geometry: &plate, solid: &first, pose: Pose::identity() },
            PlacedSolid { geometry: &bar, solid: &second, pose: Pose::from_translation(DVec3::new(0.03, 0.05, 0.0)) },
        );
        assert!(found.is_some_and(|found| (found - 0.03).abs() < 1e-4), "{found:?}");
    }
}
