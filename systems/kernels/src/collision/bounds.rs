//! Bounding balls and capsules: what is looked at before anything exact.

use super::convex::{Convex, Core};
use super::distance::{Solid, between_segments};
use foliate_components::Pose;
use glam::DVec3;

/// A ball, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre.
    pub center: DVec3,
    /// Its radius.
    pub radius: f64,
}

/// Everything within `radius` of the segment from `middle − half` to `middle + half`, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Middle of the segment.
    pub middle: DVec3,
    /// Half of the segment, as a vector.
    pub half: DVec3,
    /// Radius.
    pub radius: f64,
}

/// Sums of squares round: bounds are this much larger than computed.
const SLACK: f64 = 1.0 + 1e-12;

impl Ball {
    /// Nearly the smallest ball that holds everything that `farthest` can name: it gives, from a point, the farthest point
    /// (Bădoiu and Clarkson 2003: step towards it, by less every time). Starts at `start`.
    pub fn around(start: DVec3, farthest: impl Fn(DVec3) -> DVec3) -> Self {
        let mut center = start;
        let mut best = Self { center, radius: farthest(center).distance(center) };
        for step in 0..400 {
            center += (farthest(center) - center) / f64::from(step + 2);
            let radius = farthest(center).distance(center);
            if radius < best.radius {
                best = Self { center, radius };
            }
        }
        best.radius *= SLACK;
        best
    }

    /// The ball of a solid, in the solid's frame.
    #[must_use]
    pub fn of(solid: &Solid) -> Self {
        match solid {
            // The primitives are symmetric about their origin.
            Solid::Convex(convex) => {
                let core = convex.core.farthest_from(DVec3::ZERO).length();
                Self { center: DVec3::ZERO, radius: (core + convex.radius) * SLACK }
            }
            Solid::Mesh(mesh) => {
                let start = mesh.bounds().map_or(DVec3::ZERO, |b| b.center);
                // Where the centre should be, the extreme points in some directions tell; the radius is then exact.
                let center = Self::around(start, |from| farthest_of(&mesh.hull.points, from)).center;
                Self { center, radius: farthest(solid, center).distance(center) * SLACK }
            }
        }
    }
}

impl Capsule {
    /// A capsule of a solid along its longest axis, in the solid's frame.
    #[must_use]
    pub fn of(solid: &Solid) -> Self {
        match solid {
            Solid::Convex(Convex { core, radius }) => match *core {
                Core::Segment { half_length } => Self::along_z(half_length, *radius),
                Core::Cylinder { radius: r, half_length } => Self::along_z(half_length, r * SLACK + radius),
                Core::Box { half_extents } => {
                    Self::of_points(DVec3::ZERO, half_extents, &corners(half_extents), *radius)
                }
                Core::Point | Core::Triangle(_) => {
                    let ball = Ball::of(solid);
                    Self { middle: ball.center, half: DVec3::ZERO, radius: ball.radius }
                }
            },
            Solid::Mesh(mesh) => {
                let (center, half) = mesh.bounds().map_or((DVec3::ZERO, DVec3::ZERO), |b| (b.center, b.half));
                let points: Vec<DVec3> = mesh.triangles.iter().flatten().copied().collect();
                Self::of_points(center, half, &points, 0.0)
            }
        }
    }

    fn along_z(half_length: f64, radius: f64) -> Self {
        Self { middle: DVec3::ZERO, half: DVec3::Z * half_length, radius }
    }

    /// Along the longest side of a box that holds the points; the segment is shortened as far as the radius, which
    /// the other sides force, covers the ends.
    fn of_points(center: DVec3, half: DVec3, points: &[DVec3], radius: f64) -> Self {
        let axis = if half.x >= half.y && half.x >= half.z {
            DVec3::X
        } else if half.y >= half.z {
            DVec3::Y
        } else {
            DVec3::Z
        };
        let across = |p: DVec3| (p - center).reject_from(axis).length();
        let widest = points.iter().map(|&p| across(p)).fold(0.0, f64::max);
        let reach = points
            .iter()
            .map(|&p| (p - center).dot(axis).abs() - (widest * widest - across(p) * across(p)).max(0.0).sqrt())
            .fold(0.0, f64::max);
        Self { middle: center, half: axis * reach, radius: widest * SLACK + 1e-12 + radius }
    }

    /// The capsule in a frame in which its own has this pose.
    #[must_use]
    #[inline]
    pub fn moved(&self, X: &Pose) -> Self {
        Self { middle: X.rotation * self.middle + X.translation, half: X.rotation * self.half, radius: self.radius }
    }

    /// Distance of two capsules in one frame; negative where they overlap.
    #[must_use]
    #[inline]
    pub fn distance(&self, other: &Self) -> f64 {
        between_segments(self.middle, self.half, other.middle, other.half).length() - self.radius - other.radius
    }
}

/// The point of a solid farthest from `from`, in the solid's frame. For round solids and cylinders near their axis it is
/// one of many.
pub(super) fn farthest(solid: &Solid, from: DVec3) -> DVec3 {
    match solid {
        Solid::Convex(convex) => {
            let core = convex.core.farthest_from(from);
            core + (core - from).normalize_or(DVec3::X) * convex.radius
        }
        Solid::Mesh(mesh) => farthest_of(mesh.triangles.as_flattened(), from),
    }
}

fn farthest_of(points: &[DVec3], from: DVec3) -> DVec3 {
    let by_distance = |a: &&DVec3, b: &&DVec3| a.distance_squared(from).total_cmp(&b.distance_squared(from));
    points.iter().max_by(by_distance).copied().unwrap_or(from)
}

fn corners(h: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        h * DVec3::new(sign(0), sign(1), sign(2))
    })
}
