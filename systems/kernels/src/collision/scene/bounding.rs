//! What bounds in lanes know of a solid: a box, a cylinder or a capsule around it, in single precision.

use crate::collision::convex::core::{Convex, Core};
use crate::collision::solids::solid::Solid;
use crate::collision::solids::volumes::Capsule;
use foliate_components::Pose;
use glam::{DMat3, DVec3};

/// A set that holds a solid, in the frame of its body or in the world. Metres.
///
/// Numbers are rounded, not rounded up: who compares with them allows for that (`broad_phase`).
#[derive(Clone, Debug)]
pub(crate) struct BoundingVolume {
    /// Its centre, about which it is symmetric.
    pub center: [f32; 3],
    /// Its axes, one column each.
    pub axes: [[f32; 3]; 3],
    pub form: Form,
    /// Radius of a ball about the centre that holds it as well.
    pub ball: f32,
    /// Another one: a capsule along one of the axes.
    pub along: usize,
    pub half_length: f32,
    pub radius: f32,
    /// Whether the capsule says more than the form.
    pub is_long: bool,
    /// Of a mesh: the points of its hull in the frame of the axes, and how far beyond them it reaches.
    pub hull: Vec<[f32; 3]>,
    pub hull_slack: f32,
}

/// What stands along the axes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Form {
    /// Half of each side.
    Box([f32; 3]),
    /// About the third axis.
    Cylinder { radius: f32, half_length: f32 },
    /// About the third axis; a ball where it has no length.
    Capsule { radius: f32, half_length: f32 },
}

impl BoundingVolume {
    /// Of a solid at `X_JS` in its body's frame.
    pub(crate) fn of(solid: &Solid, X_JS: &Pose) -> Self {
        let capsule = Capsule::of(solid);
        let (center, form) = match solid {
            Solid::Convex(Convex { core, radius }) => (DVec3::ZERO, Form::of(core, *radius)),
            Solid::Mesh(mesh) => {
                let root = mesh.bounds().map_or((DVec3::ZERO, DVec3::INFINITY), |b| (b.center, b.half));
                (root.0, Form::Box(single(root.1)))
            }
        };
        let along = largest(capsule.half.abs());
        let axes = DMat3::from_quat(X_JS.rotation);
        let (hull, hull_slack) = match solid {
            Solid::Convex(_) => (Vec::new(), 0.0),
            Solid::Mesh(mesh) => {
                (mesh.hull.points.iter().map(|&p| single(p - center)).collect(), mesh.hull.slack as f32)
            }
        };
        let ball = match form {
            Form::Box(_) => reach(solid, center) as f32,
            Form::Cylinder { radius, half_length } => radius.hypot(half_length),
            Form::Capsule { radius, half_length } => radius + half_length,
        };
        Self {
            ball,
            center: single(X_JS.transform_point(center)),
            axes: [single(axes.x_axis), single(axes.y_axis), single(axes.z_axis)],
            is_long: matches!(form, Form::Box(_)) && capsule.half.length() > 0.5 * capsule.radius,
            form,
            along,
            half_length: capsule.half.length() as f32,
            radius: capsule.radius as f32,
            hull,
            hull_slack,
        }
    }
}

/// How far from its centre a solid reaches.
fn reach(solid: &Solid, center: DVec3) -> f64 {
    match solid {
        Solid::Convex(_) => crate::collision::solids::solid::farthest(solid, center).distance(center),
        Solid::Mesh(mesh) => mesh.bounding.about_middle,
    }
}

impl Form {
    fn of(core: &Core, radius: f64) -> Self {
        match *core {
            Core::Point => Self::Capsule { radius: radius as f32, half_length: 0.0 },
            Core::Segment { half_length } => Self::Capsule { radius: radius as f32, half_length: half_length as f32 },
            Core::Box { half_extents } => Self::Box(single(half_extents + radius)),
            Core::Cylinder { radius: r, half_length } => {
                Self::Cylinder { radius: (r + radius) as f32, half_length: (half_length + radius) as f32 }
            }
            Core::Triangle(t) => {
                let farthest = t.iter().map(|p| p.length()).fold(0.0, f64::max);
                Self::Capsule { radius: (farthest + radius) as f32, half_length: 0.0 }
            }
        }
    }
}

fn single(v: DVec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

fn largest(v: DVec3) -> usize {
    if v.x > v.y && v.x > v.z {
        0
    } else if v.y > v.z {
        1
    } else {
        2
    }
}
