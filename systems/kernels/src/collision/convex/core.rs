//! Convex solids as a *core* and a *radius*: a ball is a point with a radius, a capsule a segment with one.
//!
//! Distances are computed between cores and lose the radii at the end, so that round solids stay exact and never need a
//! penetration depth as long as their cores are apart.

use crate::collision::convex::simplex::closest_of_triangle;
use glam::{DMat3, DVec3};

/// The set of points that a radius is added to, in the solid's own frame, z along axes (URDF's convention). Metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Core {
    /// The origin.
    Point,
    /// From −z to z.
    Segment {
        /// Half of its length.
        half_length: f64,
    },
    /// A box about the origin.
    Box {
        /// Half of each side.
        half_extents: DVec3,
    },
    /// A cylinder about z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Half of its length.
        half_length: f64,
    },
    /// A triangle anywhere.
    Triangle([DVec3; 3]),
}

/// A core and everything within `radius` of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convex {
    /// The core.
    pub core: Core,
    /// Metres, at least 0.
    pub radius: f64,
}

impl Core {
    /// A point of the core that lies farthest in direction `d` (any length; where it is zero, any point).
    #[inline]
    #[must_use]
    pub fn support(&self, d: DVec3) -> DVec3 {
        match *self {
            Self::Point => DVec3::ZERO,
            Self::Segment { half_length } => DVec3::new(0.0, 0.0, half_length.copysign(d.z)),
            Self::Box { half_extents: h } => DVec3::new(h.x.copysign(d.x), h.y.copysign(d.y), h.z.copysign(d.z)),
            Self::Cylinder { radius, half_length } => {
                let across = (d.x * d.x + d.y * d.y).sqrt();
                let scale = if across > 0.0 { radius / across } else { 0.0 };
                DVec3::new(d.x * scale, d.y * scale, half_length.copysign(d.z))
            }
            Self::Triangle([a, b, c]) => {
                let (da, db, dc) = (a.dot(d), b.dot(d), c.dot(d));
                if da >= db && da >= dc {
                    a
                } else if db >= dc {
                    b
                } else {
                    c
                }
            }
        }
    }

    /// The point of the core that is closest to `p`; `p` itself where it lies inside.
    #[inline]
    #[must_use]
    pub fn closest_to(&self, p: DVec3) -> DVec3 {
        match *self {
            Self::Point => DVec3::ZERO,
            Self::Segment { half_length } => DVec3::new(0.0, 0.0, clamp(p.z, half_length)),
            Self::Box { half_extents: h } => DVec3::new(clamp(p.x, h.x), clamp(p.y, h.y), clamp(p.z, h.z)),
            Self::Cylinder { radius, half_length } => {
                let across = (p.x * p.x + p.y * p.y).sqrt();
                let scale = if across > radius { radius / across } else { 1.0 };
                DVec3::new(p.x * scale, p.y * scale, clamp(p.z, half_length))
            }
            Self::Triangle(t) => closest_on_triangle(p, &t),
        }
    }

    /// A point in the middle of the core.
    #[inline]
    #[must_use]
    pub fn center(&self) -> DVec3 {
        match *self {
            Self::Triangle([a, b, c]) => (a + b + c) / 3.0,
            _ => DVec3::ZERO,
        }
    }

    /// The point of the core that is farthest from `p`.
    #[must_use]
    pub fn farthest_from(&self, p: DVec3) -> DVec3 {
        match *self {
            // These are symmetric about the origin: the farthest point lies on the other side in every coordinate.
            Self::Point | Self::Segment { .. } | Self::Box { .. } | Self::Cylinder { .. } => {
                let away = self.support(-p);
                if let Self::Cylinder { radius, .. } = *self
                    && p.x == 0.0
                    && p.y == 0.0
                {
                    // On the axis every rim point is as far as any other.
                    return DVec3::new(radius, 0.0, away.z);
                }
                away
            }
            Self::Triangle(t) => t
                .into_iter()
                .max_by(|a, b| a.distance_squared(p).total_cmp(&b.distance_squared(p)))
                .unwrap_or(DVec3::ZERO),
        }
    }

    /// Half extents of the core's bounding box along the rows of `axes` (columns are the core's axes seen from there),
    /// about its centre.
    #[inline]
    #[must_use]
    pub fn extents_along(&self, axes: &DMat3) -> DVec3 {
        match *self {
            Self::Point => DVec3::ZERO,
            Self::Segment { half_length } => axes.z_axis.abs() * half_length,
            Self::Box { half_extents: h } => {
                axes.x_axis.abs() * h.x + axes.y_axis.abs() * h.y + axes.z_axis.abs() * h.z
            }
            Self::Cylinder { radius, half_length } => {
                let z = axes.z_axis;
                let across = (DVec3::ONE - z * z).max(DVec3::ZERO);
                let across = DVec3::new(across.x.sqrt(), across.y.sqrt(), across.z.sqrt());
                z.abs() * half_length + across * radius
            }
            Self::Triangle(t) => {
                let center = self.center();
                t.into_iter().fold(DVec3::ZERO, |h, p| h.max((*axes * (p - center)).abs()))
            }
        }
    }
}

#[inline]
fn clamp(x: f64, half: f64) -> f64 {
    x.max(-half).min(half)
}

/// The point of a triangle that is closest to `p`.
#[inline]
#[must_use]
pub fn closest_on_triangle(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> DVec3 {
    p + closest_of_triangle(a - p, b - p, c - p)
}
