//! Convex pieces: a core (point, segment, box, cylinder, triangle) and its farthest points.
//!
//! Balls and capsules are cores with a radius around them, which the caller takes off the distance of the cores.

use foliate_components::Pose;
use foliate_components::robot::shape::Geometry;
use glam::{DMat3, DVec3};

/// A convex set in its own frame, z along the axis. Metres.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Core {
    Point,
    /// Along z.
    Segment {
        half: f64,
    },
    Box {
        half: DVec3,
    },
    /// About z.
    Cylinder {
        radius: f64,
        half: f64,
    },
    Triangle([DVec3; 3]),
}

impl Core {
    /// The core of a primitive and the radius around it; none for a mesh.
    pub(crate) fn of(geometry: &Geometry) -> Option<(Self, f64)> {
        Some(match geometry {
            Geometry::Sphere { radius } => (Self::Point, *radius),
            Geometry::Box { half_extents } => (Self::Box { half: *half_extents }, 0.0),
            Geometry::Cylinder { radius, half_length } => (Self::Cylinder { radius: *radius, half: *half_length }, 0.0),
            Geometry::Capsule { radius, half_length } => (Self::Segment { half: *half_length }, *radius),
            Geometry::Mesh(_) => return None,
        })
    }

    /// A point of the core that is farthest along a direction.
    fn farthest(&self, along: DVec3) -> DVec3 {
        match self {
            Self::Point => DVec3::ZERO,
            Self::Segment { half } => DVec3::new(0.0, 0.0, half.copysign(along.z)),
            Self::Box { half } => {
                DVec3::new(half.x.copysign(along.x), half.y.copysign(along.y), half.z.copysign(along.z))
            }
            Self::Cylinder { radius, half } => {
                let flat = along.x.hypot(along.y);
                let out = if flat > 0.0 { radius / flat } else { 0.0 };
                DVec3::new(along.x * out, along.y * out, half.copysign(along.z))
            }
            Self::Triangle([a, b, c]) => {
                let (at_a, at_b, at_c) = (a.dot(along), b.dot(along), c.dot(along));
                if at_a >= at_b && at_a >= at_c {
                    *a
                } else if at_b >= at_c {
                    *b
                } else {
                    *c
                }
            }
        }
    }

    /// Directions in which faces look, for a bound of how deep two cores overlap.
    fn faces(&self) -> [DVec3; 3] {
        match self {
            Self::Triangle([a, b, c]) => [(*b - *a).cross(*c - *a), DVec3::ZERO, DVec3::ZERO],
            _ => DVec3::AXES,
        }
    }

    /// Somewhere in the middle.
    fn middle(&self) -> DVec3 {
        match self {
            Self::Triangle([a, b, c]) => (*a + *b + *c) / 3.0,
            _ => DVec3::ZERO,
        }
    }
}

/// A core where another frame sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    core: Core,
    place: Option<(DMat3, DVec3)>,
}

impl Piece {
    pub(crate) fn at_home(core: Core) -> Self {
        Self { core, place: None }
    }

    /// As the frame sees it in which the rotation and the position are given.
    pub(crate) fn seen(core: Core, (turn, position): &(DMat3, DVec3)) -> Self {
        match core {
            Core::Triangle(corners) => Self::at_home(Core::Triangle(corners.map(|c| *turn * c + *position))),
            core => Self { core, place: Some((*turn, *position)) },
        }
    }

    /// A point that is farthest along a direction.
    pub(crate) fn farthest(&self, along: DVec3) -> DVec3 {
        match &self.place {
            None => self.core.farthest(along),
            Some((turn, position)) => *turn * self.core.farthest(turn.transpose() * along) + *position,
        }
    }

    pub(crate) fn middle(&self) -> DVec3 {
        match &self.place {
            None => self.core.middle(),
            Some((turn, position)) => *turn * self.core.middle() + *position,
        }
    }

    pub(crate) fn faces(&self) -> [DVec3; 3] {
        match &self.place {
            None => self.core.faces(),
            Some((turn, _)) => self.core.faces().map(|face| *turn * face),
        }
    }
}

/// The rotation and position of a pose.
pub(crate) fn parts(pose: &Pose) -> (DMat3, DVec3) {
    (DMat3::from_quat(pose.rotation), pose.translation)
}
