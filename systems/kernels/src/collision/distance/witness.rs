//! The nearest points of two solids: for pictures, not for proofs.
//!
//! Of meshes the triangles are found that are as near as the distance says. Then both sides are convex, and half of the squared distance of a
//! point of each is minimised by projected gradients with momentum, which begins anew where it overshoots (O'Donoghue and Candès, *Adaptive
//! restart for accelerated gradient schemes*, 2015).

use crate::collision::convex::core::{Convex, Core};
use crate::collision::convex::gjk::DistanceQuery;
use crate::collision::distance::query::clearance;
use crate::collision::solids::solid::Solid;
use foliate_components::Pose;
use glam::DVec3;

/// Most steps.
const STEPS: usize = 3000;
/// Points that are farther apart than the solids by less than this are the nearest, metres.
const NEAREST: f64 = 1e-7;
/// A triangle that is farther than the distance by this is none of the nearest, metres, or this share of the distance.
const SLACK: (f64, f64) = (2e-6, 1e-6);

/// A convex solid at a place in the world.
struct Placed {
    convex: Convex,
    X_WC: Pose,
}

impl Placed {
    /// The point of the core that is nearest to a point of the world.
    fn closest(&self, p: DVec3) -> DVec3 {
        self.X_WC.transform_point(self.convex.core.closest_to(self.X_WC.inverse_transform_point(p)))
    }

    fn solid(&self) -> Solid {
        Solid::Convex(self.convex)
    }
}

/// A point of each of two solids, in the world, as far apart as the solids are; `distance` is what [`clearance`] says of them, to a micrometre. None
/// where they touch, and where no such points are found.
///
/// Solids at `X_WA` and `X_WB` in the world.
#[must_use]
pub fn witnesses(a: &Solid, X_WA: &Pose, b: &Solid, X_WB: &Pose, distance: f64) -> Option<[DVec3; 2]> {
    let is_apart = distance > 0.0 && distance.is_finite();
    if !is_apart {
        return None;
    }
    let near = distance + SLACK.0 + SLACK.1 * distance;
    let a = nearest_piece(a, X_WA, b, X_WB, near)?;
    let b = nearest_piece(b, X_WB, &a.solid(), &a.X_WC, near)?;
    let [p, q] = nearest_points(&a, &b, distance + a.convex.radius + b.convex.radius);
    let apart = q - p;
    let direction = apart.normalize_or_zero();
    let points = [p + direction * a.convex.radius, q - direction * b.convex.radius];
    (direction != DVec3::ZERO).then_some(points)
}

/// The nearest points of two cores that are so far apart.
fn nearest_points(a: &Placed, b: &Placed, distance: f64) -> [DVec3; 2] {
    let mut p = a.closest(b.X_WC.transform_point(b.convex.core.center()));
    let mut q = b.closest(p);
    // Where the next gradient is taken, and how much momentum there is.
    let (mut from, mut momentum) = ([p, q], 1.0_f64);
    let mut best = [p, q];
    for _ in 0..STEPS {
        if best[0].distance(best[1]) <= distance + NEAREST {
            break;
        }
        let half = 0.5 * (from[0] - from[1]);
        let next = [a.closest(from[0] - half), b.closest(from[1] + half)];
        let farther = next[0].distance_squared(next[1]) > p.distance_squared(q);
        momentum = if farther { 1.0 } else { momentum };
        let later = 0.5 * (1.0 + (1.0 + 4.0 * momentum * momentum).sqrt());
        let share = if farther { 0.0 } else { (momentum - 1.0) / later };
        from = [next[0] + (next[0] - p) * share, next[1] + (next[1] - q) * share];
        [p, q] = next;
        momentum = later;
        if p.distance_squared(q) < best[0].distance_squared(best[1]) {
            best = [p, q];
        }
    }
    best
}

/// The solid itself where it is convex, else a triangle of it that is as near to the other solid as `near`.
fn nearest_piece(solid: &Solid, X_WS: &Pose, other: &Solid, X_WO: &Pose, near: f64) -> Option<Placed> {
    let mesh = match solid {
        Solid::Convex(convex) => return Some(Placed { convex: *convex, X_WC: *X_WS }),
        Solid::Mesh(mesh) => mesh,
    };
    // A ball around the other solid, in the mesh's frame, tells most triangles apart.
    let ball = crate::collision::solids::volumes::Ball::of(other);
    let center = (X_WS.inverse() * *X_WO).transform_point(ball.center);
    let reach = ball.radius + near;
    let mut hint = DVec3::ZERO;
    let mut best: Option<(f64, [DVec3; 3])> = None;
    for triangle in &mesh.triangles {
        let (low, high) =
            (triangle[0].min(triangle[1]).min(triangle[2]), triangle[0].max(triangle[1]).max(triangle[2]));
        if center.clamp(low, high).distance_squared(center) > reach * reach {
            continue;
        }
        let least = best.map_or(near, |(least, _)| least);
        let piece = Solid::Convex(Convex { core: Core::Triangle(*triangle), radius: 0.0 });
        let query = DistanceQuery { absolute: 1e-8, ..DistanceQuery::exact(least) };
        let found = clearance(&piece, X_WS, other, X_WO, query, &mut hint);
        if found < least {
            best = Some((found, *triangle));
        }
    }
    best.map(|(_, triangle)| Placed { convex: Convex { core: Core::Triangle(triangle), radius: 0.0 }, X_WC: *X_WS })
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::robot::shape::{Geometry, Mesh};
    use glam::DQuat;
    use std::sync::Arc;

    fn mesh_box(half: f64) -> Geometry {
        let sign = |bit: u32| if bit == 0 { -half } else { half };
        let vertices = (0..8_u32).map(|i| DVec3::new(sign(i & 1), sign(i & 2), sign(i & 4))).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Geometry::Mesh(Arc::new(Mesh::new("box".into(), vertices, triangles)))
    }

    #[test]
    fn nearest_points_are_as_far_apart_as_the_solids_and_lie_on_them() {
        let solids = [
            Geometry::Box { half_extents: DVec3::splat(0.1) },
            Geometry::Sphere { radius: 0.1 },
            Geometry::Cylinder { radius: 0.05, half_length: 0.2 },
            Geometry::Capsule { radius: 0.05, half_length: 0.2 },
            mesh_box(0.1),
        ];
        let turn = DQuat::from_rotation_x(0.4) * DQuat::from_rotation_y(0.7);
        let point = Solid::Convex(Convex { core: Core::Point, radius: 0.0 });
        for first in &solids {
            for second in &solids {
                for at in [DVec3::new(0.5, 0.1, 0.05), DVec3::new(0.0, 0.0, 0.6)] {
                    let (a, b) = (Solid::of(first), Solid::of(second));
                    let (X_WA, X_WB) = (Pose::identity(), Pose::from_parts(at, turn));
                    let ask = DistanceQuery::exact(f64::MAX);
                    let distance = clearance(&a, &X_WA, &b, &X_WB, ask, &mut DVec3::ZERO.clone());
                    let [p, q] = witnesses(&a, &X_WA, &b, &X_WB, distance).expect("they are apart");
                    let pair = format!("{} {}", first.kind(), second.kind());
                    assert!((p.distance(q) - distance).abs() < 1e-5, "{pair}: {} {distance}", p.distance(q));
                    for (solid, pose, at) in [(&a, &X_WA, p), (&b, &X_WB, q)] {
                        let at = Pose::from_translation(at);
                        let off = clearance(solid, pose, &point, &at, ask, &mut DVec3::ZERO.clone());
                        assert!(off.abs() < 1e-5, "{pair}: {off}");
                    }
                }
            }
        }
    }

    #[test]
    fn faces_that_are_nearly_parallel_have_nearest_points_too() {
        let solid = Solid::of(&Geometry::Box { half_extents: DVec3::new(0.03, 0.2, 0.1) });
        for tilt in [0.3, 0.03, 0.003] {
            let X_WB = Pose::from_parts(DVec3::new(0.08, 0.05, 0.0), DQuat::from_rotation_z(tilt));
            let X_WA = Pose::identity();
            let ask = DistanceQuery::exact(f64::MAX);
            let distance = clearance(&solid, &X_WA, &solid, &X_WB, ask, &mut DVec3::ZERO.clone());
            if distance <= 0.0 {
                continue;
            }
            let [p, q] = witnesses(&solid, &X_WA, &solid, &X_WB, distance).expect("they are apart");
            assert!((p.distance(q) - distance).abs() < 2e-5, "{tilt}: {} {distance}", p.distance(q));
        }
    }
}
