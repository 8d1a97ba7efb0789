//! Bounding balls and capsules, which are tested before anything exact.

use crate::collision::convex::segments::between_segments;
use foliate_components::Pose;
use glam::DVec3;

/// What holds a mesh, in its frame. Metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshBounding {
    pub ball: Ball,
    /// Along its longest side.
    pub capsule: Capsule,
    /// Radius of a ball about the middle of its box.
    pub about_middle: f64,
}

impl Default for MeshBounding {
    fn default() -> Self {
        let nothing = Ball { center: DVec3::ZERO, radius: 0.0 };
        let capsule = Capsule { middle: DVec3::ZERO, half: DVec3::ZERO, radius: 0.0 };
        Self { ball: nothing, capsule, about_middle: 0.0 }
    }
}

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
pub(crate) const SLACK: f64 = 1.0 + 1e-12;

impl Ball {
    /// Nearly the smallest ball that holds everything that `farthest` can name: it gives, from a point, the farthest point
    /// (Bădoiu and Clarkson 2003: step towards it, by less every time). Starts at `start`.
    pub fn bounding(start: DVec3, farthest: impl Fn(DVec3) -> DVec3) -> Self {
        let mut center = start;
        let mut point = farthest(center);
        let mut best = Self { center, radius: point.distance(center) };
        for step in 0..400 {
            center += (point - center) / f64::from(step + 2);
            point = farthest(center);
            let radius = point.distance(center);
            if radius < best.radius {
                best = Self { center, radius };
            }
        }
        best.radius *= SLACK;
        best
    }

    /// About a centre, as far as the farthest point that it has to hold.
    pub(crate) fn reaching(center: DVec3, farthest: f64) -> Self {
        Self { center, radius: farthest * SLACK }
    }
}

impl Capsule {
    pub(crate) fn along_z(half_length: f64, radius: f64) -> Self {
        Self { middle: DVec3::ZERO, half: DVec3::Z * half_length, radius }
    }

    /// Along the longest side of a box that holds the points; the segment is shortened as far as the radius, which
    /// the other sides force, covers the ends.
    pub(crate) fn of_points(center: DVec3, half: DVec3, points: &[DVec3], radius: f64) -> Self {
        let axis = DVec3::AXES[longest_axis(half)];
        let across = |p: DVec3| (p - center).reject_from(axis).length();
        let widest = points.iter().map(|&p| across(p)).fold(0.0, f64::max);
        let reach = points
            .iter()
            .map(|&p| (p - center).dot(axis).abs() - (widest * widest - across(p) * across(p)).max(0.0).sqrt())
            .fold(0.0, f64::max);
        let capsule = Self::about(center, axis * reach, widest);
        Self { radius: capsule.radius + radius, ..capsule }
    }

    /// What holds points within `widest` of a segment.
    pub(crate) fn about(middle: DVec3, half: DVec3, widest: f64) -> Self {
        Self { middle, half, radius: widest * SLACK + 1e-12 }
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

/// The last of the points that lie farthest from `from`; `from` itself where there are none.
pub(crate) fn farthest_of(points: &[DVec3], from: DVec3) -> DVec3 {
    let by_distance = |a: &&DVec3, b: &&DVec3| a.distance_squared(from).total_cmp(&b.distance_squared(from));
    points.iter().max_by(by_distance).copied().unwrap_or(from)
}

/// Of a box's sides the longest, as the number of its axis.
pub(crate) fn longest_axis(half: DVec3) -> usize {
    if half.x >= half.y && half.x >= half.z {
        0
    } else if half.y >= half.z {
        1
    } else {
        2
    }
}
