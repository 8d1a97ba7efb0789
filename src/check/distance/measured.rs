//! The distance of two placed shapes, as a bound from below and one from above.

use crate::check::distance::apart::Wanted;
use crate::check::distance::pieces;
use crate::check::distance::pieces::{Hint, Pieces, bounds};
use crate::check::motion::reach::End;
use crate::check::world::models::World;
use foliate_components::Pose;
use foliate_components::robot::JointType;
use foliate_components::robot::shape::Geometry;
use glam::DVec3;
use std::sync::Arc;

/// How far the bounds of a distance may be apart, metres; told where they are farther.
const OPEN: f64 = 1e-6;
/// How far a bound to march by may be below the distance, as a share of it. Shorter steps from cheaper distances pay: with 0.3
/// instead of 0.05 a fifth more distances are asked for, and checking a humanoid takes two thirds of the time.
const SHARE: f64 = 0.3;
/// Rounding of coordinates, as a share of them; taken off every lower bound.
const ROUNDING: f64 = 4e-15;

/// A shape, ready for queries.
pub(crate) struct Measured {
    body: Option<usize>,
    body_from_shape: Pose,
    pieces: Arc<Pieces>,
    /// Middle of a box around the shape, and half its sides, in the shape's frame.
    center: DVec3,
    half: DVec3,
    is_mesh: bool,
    /// See [`End`].
    end: End,
}

/// A shape's pose at some moment.
pub(crate) type Placed<'s> = (&'s Measured, Pose);

/// A distance from below, and how far it is open.
pub(crate) struct Distance {
    pub value: f64,
    pub open: Option<f64>,
}

impl Measured {
    /// Meshes that several shapes share are prepared once.
    pub(crate) fn all(world: &World) -> Vec<Self> {
        let mut known: Vec<(&Geometry, Arc<Pieces>)> = Vec::new();
        let mut measured = Vec::with_capacity(world.shapes.len());
        for shape in &world.shapes {
            let same = |other: &Geometry| match (other, &shape.geometry) {
                (Geometry::Mesh(a), Geometry::Mesh(b)) => Arc::ptr_eq(a, b),
                _ => false,
            };
            let pieces = known.iter().find(|(other, _)| same(other)).map(|(_, pieces)| pieces.clone());
            let pieces = pieces.unwrap_or_else(|| Arc::new(Pieces::of(&shape.geometry)));
            let is_mesh = matches!(shape.geometry, Geometry::Mesh(_));
            if is_mesh {
                known.push((&shape.geometry, pieces.clone()));
            }
            let (center, half) = bounds(&shape.geometry);
            let (body, body_from_shape) = (shape.rigid.1, shape.body_from_shape);
            let reach = body_from_shape.transform_point(center).length() + half.length();
            let about = match body.map(|body| world.bodies[body].motion) {
                Some(JointType::Revolute { axis }) => about(&shape.geometry, &body_from_shape, axis, (center, half)),
                _ => f64::INFINITY,
            };
            let end = End { body, reach, about };
            measured.push(Self { body, body_from_shape, pieces, center, half, is_mesh, end });
        }
        measured
    }

    pub(crate) fn body(&self) -> Option<usize> {
        self.body
    }

    pub(crate) fn in_world(&self, world_from_body: Pose) -> Pose {
        world_from_body * self.body_from_shape
    }

    /// How far the shape is from its body's origin and from the axis of its joint.
    pub(crate) fn end(&self) -> End {
        self.end
    }

    pub(crate) fn is_mesh(&self) -> bool {
        self.is_mesh
    }
}

/// No point of a shape is farther than this from an axis through its body's origin, metres: corners of a mesh, or of the box around the shape.
fn about(geometry: &Geometry, body_from_shape: &Pose, axis: DVec3, (center, half): (DVec3, DVec3)) -> f64 {
    let axis = axis.normalize_or_zero();
    let far = |p: DVec3| body_from_shape.transform_point(p).reject_from(axis).length();
    let corner = |i: u32| {
        let sign = |bit: u32| if i & bit == 0 { -1.0 } else { 1.0 };
        center + half * DVec3::new(sign(1), sign(2), sign(4))
    };
    let farthest = match geometry {
        Geometry::Mesh(mesh) => mesh.vertices.iter().map(|&p| far(p)).fold(0.0, f64::max),
        _ => (0..8).map(|i| far(corner(i))).fold(0.0, f64::max),
    };
    if axis == DVec3::ZERO { f64::INFINITY } else { farthest * (1.0 + 1e-9) }
}

/// A lower bound of the distance from the balls around the shapes.
pub(crate) fn ball_bound(a: Placed<'_>, b: Placed<'_>) -> f64 {
    let center = |(shape, pose): &Placed<'_>| pose.transform_point(shape.center);
    center(&a).distance(center(&b)) - a.0.half.length() - b.0.half.length()
}

/// A lower bound of the distance from the boxes around the shapes: along the axes of either box, how far the other's
/// shadow is away.
pub(crate) fn box_bound(a: Placed<'_>, b: Placed<'_>) -> f64 {
    let one_way = |(one, one_pose): Placed<'_>, (other, other_pose): Placed<'_>| {
        let between = one_pose.inverse() * other_pose;
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| between.rotation * axis);
        let shadow = axes[0].abs() * other.half.x + axes[1].abs() * other.half.y + axes[2].abs() * other.half.z;
        let gap = (between.transform_point(other.center) - one.center).abs() - one.half - shadow;
        gap.max(DVec3::ZERO).length()
    };
    one_way(a, b).max(one_way(b, a))
}

/// A lower bound of the distance: at least `enough`, or nearly exact. Not positive where the shapes (may) overlap.
pub(crate) fn at_least(a: Placed<'_>, b: Placed<'_>, enough: f64, hint: &mut Hint) -> f64 {
    let a_from_b = a.1.inverse() * b.1;
    let wanted = Wanted { enough: enough.max(0.0), open: OPEN, share: SHARE, around: 0.0 };
    pieces::distance(&a.0.pieces, &b.0.pieces, &a_from_b, &wanted, hint).lower - rounding(&a_from_b, a.0, b.0)
}

/// The distance, to a micrometre.
pub(crate) fn exact(a: Placed<'_>, b: Placed<'_>, hint: &mut Hint) -> Distance {
    let a_from_b = a.1.inverse() * b.1;
    let wanted = Wanted { enough: f64::INFINITY, open: 1e-9, share: 0.0, around: 0.0 };
    let found = pieces::distance(&a.0.pieces, &b.0.pieces, &a_from_b, &wanted, hint);
    let open = found.upper - found.lower;
    Distance { value: found.lower - rounding(&a_from_b, a.0, b.0), open: (open > OPEN).then_some(open) }
}

/// How far the rounding of coordinates may have moved a bound, metres.
fn rounding(a_from_b: &Pose, a: &Measured, b: &Measured) -> f64 {
    let size = a.center.length() + a.half.length() + b.center.length() + b.half.length();
    ROUNDING * (a_from_b.translation.length() + size)
}
