//! Distances of two shapes. Those of primitives are computed twice, by parry's GJK and by the planner's own, and the
//! smaller counts; where they differ that is told. Meshes go through the planner's triangle hierarchy, which its tests
//! hold against coal.

use super::models::Shape;
use foliate_components::Pose;
use foliate_components::robot::shape::Geometry;
use foliate_kernels::collision::{Ask, Solid, clearance};
use glam::{DQuat, DVec3};
use parry3d_f64::query;
use parry3d_f64::shape::{Ball, Capsule, Cuboid, Cylinder};
use std::f64::consts::FRAC_PI_2;

/// How far two codes may differ on a distance, metres.
const AGREEMENT: f64 = 2e-6;
/// Share of a distance that parry's iteration may leave open; taken off.
const OPEN: f64 = 1e-6;

/// A shape, ready for queries.
pub(super) struct Measured {
    body: Option<usize>,
    body_from_shape: Pose,
    solid: Solid,
    /// parry's shape and its pose in the shape's frame; none for a mesh.
    parry: Option<(Box<dyn parry3d_f64::shape::Shape>, Pose)>,
    /// Middle of a box around the shape, and half its sides, in the shape's frame.
    center: DVec3,
    half: DVec3,
}

/// A shape's pose at some moment.
pub(super) type Placed<'s> = (&'s Measured, Pose);

/// A distance, and whether the codes that computed it disagree (by how much).
pub(super) struct Distance {
    pub value: f64,
    pub disagreement: Option<f64>,
}

impl Measured {
    pub(super) fn new(shape: &Shape) -> Self {
        let (center, half) = bounds(&shape.geometry);
        Self {
            body: shape.rigid.1,
            body_from_shape: shape.body_from_shape,
            solid: Solid::of(&shape.geometry),
            parry: parry(&shape.geometry),
            center,
            half,
        }
    }

    pub(super) fn body(&self) -> Option<usize> {
        self.body
    }

    pub(super) fn in_world(&self, world_from_body: Pose) -> Pose {
        world_from_body * self.body_from_shape
    }

    /// No point of the shape is farther than this from its body's origin, metres.
    pub(super) fn reach(&self) -> f64 {
        self.body_from_shape.transform_point(self.center).length() + self.half.length()
    }

    pub(super) fn is_mesh(&self) -> bool {
        self.parry.is_none()
    }
}

/// A lower bound of the distance from the balls around the shapes.
pub(super) fn ball_bound(a: Placed<'_>, b: Placed<'_>) -> f64 {
    let center = |(shape, pose): &Placed<'_>| pose.transform_point(shape.center);
    center(&a).distance(center(&b)) - a.0.half.length() - b.0.half.length()
}

/// A lower bound of the distance from the boxes around the shapes: along the axes of either box, how far the other's
/// shadow is away.
pub(super) fn box_bound(a: Placed<'_>, b: Placed<'_>) -> f64 {
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
pub(super) fn at_least(a: Placed<'_>, b: Placed<'_>, enough: f64) -> f64 {
    let ask = Ask { absolute: 1e-6, relative: 0.05, ..Ask::exact(enough.max(0.0)) };
    let ours = clearance(&a.0.solid, &a.1, &b.0.solid, &b.1, ask, &mut DVec3::ZERO.clone());
    match parry_distance(a, b) {
        Some(theirs) => ours.min(theirs * (1.0 - OPEN)),
        None => ours,
    }
}

/// The distance, to a micrometre.
pub(super) fn exact(a: Placed<'_>, b: Placed<'_>) -> Distance {
    let ask = Ask { absolute: 1e-9, relative: 0.0, ..Ask::exact(f64::MAX) };
    let ours = clearance(&a.0.solid, &a.1, &b.0.solid, &b.1, ask, &mut DVec3::ZERO.clone());
    let Some(theirs) = parry_distance(a, b) else { return Distance { value: ours, disagreement: None } };
    let apart = (ours.max(0.0) - theirs).abs();
    Distance { value: ours.min(theirs), disagreement: (apart > AGREEMENT).then_some(apart) }
}

fn parry_distance(a: Placed<'_>, b: Placed<'_>) -> Option<f64> {
    let ((one, one_local), (other, other_local)) = (a.0.parry.as_ref()?, b.0.parry.as_ref()?);
    let (first, second) = (a.1 * *one_local, b.1 * *other_local);
    let found = query::distance(&first, one.as_ref(), &second, other.as_ref()).ok()?;
    Some(found.distance).filter(|d| d.is_finite())
}

fn parry(geometry: &Geometry) -> Option<(Box<dyn parry3d_f64::shape::Shape>, Pose)> {
    // parry's cylinders stand along y.
    let upright = Pose::from_rotation(DQuat::from_rotation_x(FRAC_PI_2));
    Some(match geometry {
        Geometry::Sphere { radius } => (Box::new(Ball::new(*radius)), Pose::identity()),
        Geometry::Box { half_extents } => (Box::new(Cuboid::new(*half_extents)), Pose::identity()),
        Geometry::Cylinder { radius, half_length } => (Box::new(Cylinder::new(*half_length, *radius)), upright),
        Geometry::Capsule { radius, half_length } => {
            (Box::new(Capsule::new_z(*half_length, *radius)), Pose::identity())
        }
        Geometry::Mesh(_) => return None,
    })
}

fn bounds(geometry: &Geometry) -> (DVec3, DVec3) {
    match geometry {
        Geometry::Sphere { radius } => (DVec3::ZERO, DVec3::splat(*radius)),
        Geometry::Box { half_extents } => (DVec3::ZERO, *half_extents),
        Geometry::Cylinder { radius, half_length } => (DVec3::ZERO, DVec3::new(*radius, *radius, *half_length)),
        Geometry::Capsule { radius, half_length } => {
            (DVec3::ZERO, DVec3::new(*radius, *radius, *half_length + *radius))
        }
        Geometry::Mesh(mesh) => {
            let low = mesh.vertices.iter().copied().reduce(DVec3::min).unwrap_or_default();
            let high = mesh.vertices.iter().copied().reduce(DVec3::max).unwrap_or_default();
            ((low + high) / 2.0, (high - low) / 2.0)
        }
    }
}
