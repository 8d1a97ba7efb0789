//! How deep two solids are in each other: a lower bound.
//!
//! A ball of radius r around a point of one solid, all inside of it, whose middle is d deep inside the other: to set the two apart the
//! one has to be shifted by at least d + r. For convex solids the largest such sum is found by climbing; for two boxes or balls it
//! is the penetration depth. Shapes of meshes are started from their vertices.

use foliate_components::Pose;
use foliate_components::robot::shape::Geometry;
use foliate_kernels::collision::convex::{Convex, Core};
use foliate_kernels::collision::{DistanceQuery, Solid, clearance};
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
pub(crate) struct Placed<'a> {
    pub geometry: &'a Geometry,
    pub solid: &'a Solid,
    pub pose: Pose,
}

impl Placed<'_> {
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
        let side = 0..LATTICE;
        let place = |i: i32| 2.0 * f64::from(i) / f64::from(LATTICE - 1) - 1.0;
        let points = side.clone().flat_map(|x| side.clone().flat_map(move |y| (0..LATTICE).map(move |z| (x, y, z))));
        let points = points.map(|(x, y, z)| half * DVec3::new(place(x), place(y), place(z)));
        points.filter(|&p| self.primitive(p) >= -ON).map(|p| self.pose.transform_point(p)).collect()
    }
}

/// No shift shorter than this sets the two apart, metres; none where no point is known to be inside both.
pub(crate) fn depth(a: Placed<'_>, b: Placed<'_>) -> Option<f64> {
    // What is cheap is asked first, and most points are outside of it.
    let (cheap, dear) = if matches!(a.geometry, Geometry::Mesh(_)) { (b, a) } else { (a, b) };
    let both = |p: DVec3| Some(cheap.inside(p)? + dear.inside(p)?);
    // A start is in or on the one solid, and inside the other.
    let starts_of = |one: Placed<'_>, other: Placed<'_>| {
        let inside = move |p: DVec3| Some((other.inside(p)?, p));
        one.starts().into_iter().filter_map(inside).collect::<Vec<_>>()
    };
    let mut starts = starts_of(a, b);
    starts.extend(starts_of(b, a));
    starts.sort_by(|x, y| y.0.total_cmp(&x.0));
    let step = 0.25 * size(&a).min(size(&b));
    let best = starts.iter().take(CLIMBS).map(|&(found, start)| {
        let (mut best, mut at, mut step) = (found, start, step);
        for _ in 0..HALVINGS {
            let around = DVec3::AXES.into_iter().flat_map(|axis| [axis * step, -axis * step]);
            let better = around.filter_map(|by| Some((both(at + by)?, at + by)));
            match better.max_by(|x, y| x.0.total_cmp(&y.0)).filter(|(found, _)| *found > best) {
                Some(next) => (best, at) = next,
                None => step *= 0.5,
            }
        }
        best
    });
    best.reduce(f64::max)
}

fn size(shape: &Placed<'_>) -> f64 {
    shape.geometry.radius_about_origin().max(1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(one: &Geometry, other: &Geometry, apart: DVec3) -> Option<f64> {
        let (first, second) = (Solid::of(one), Solid::of(other));
        depth(
            Placed { geometry: one, solid: &first, pose: Pose::identity() },
            Placed { geometry: other, solid: &second, pose: Pose::from_translation(apart) },
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
}
