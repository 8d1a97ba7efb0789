//! Objects as a setup sees them: one rigid body with its shapes, its centre of mass and its hull.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::error::SetupError;
use crate::setup::solids::hull::{Facet, facets};
use crate::setup::solids::surface_points::{on_grid, triangles};
use foliate_components::Pose;
use foliate_components::robot::model::Model;
use foliate_components::robot::shape::Geometry;
use foliate_components::robot::{PartKind, PartPlacement, Robot, RootJoint};
use foliate_kernels::collision::Solid;
use glam::DVec3;

/// An object as one rigid body, in the frame of its root link. Joints of an articulated object stand at zero.
#[derive(Clone, Debug)]
pub struct RigidObject {
    /// What messages call it.
    pub name: String,
    /// The name of its root link.
    pub link: String,
    /// Its collision shapes.
    pub shapes: Vec<(Pose, Geometry)>,
    /// Its centre of mass: of its mass properties, or of its volume, or the middle of its surface.
    pub centre: DVec3,
    /// Largest side of the box that holds it, metres.
    pub size: f64,
    /// Its lower and upper corners.
    pub bounds: (DVec3, DVec3),
    /// The triangles of its surface.
    pub(crate) triangles: Vec<[DVec3; 3]>,
    /// Its shapes for distances.
    pub(crate) solids: Vec<(Pose, Solid)>,
    /// The faces of its hull, the largest first.
    pub(crate) hull: Vec<Facet>,
}

impl RigidObject {
    /// The object that a model describes.
    ///
    /// # Errors
    /// A model that cannot be composed, or without collision shapes.
    pub fn of(name: &str, model: &Model) -> Result<Self, SetupError> {
        let placement = PartPlacement::new("object", PartKind::Environment, RootJoint::Fixed, Pose::identity());
        let refused = |message: String| SetupError::Request(format!("`{name}`: {message}"));
        let robot = Robot::compose(&[(model, placement)]).map_err(|error| refused(error.to_string()))?;
        let rigid = |link: &usize| robot.links[*link].joint.is_none();
        let shapes: Vec<(Pose, Geometry)> = robot
            .shapes
            .iter()
            .filter(|shape| rigid(&shape.link.at()))
            .map(|shape| (shape.joint_from_shape, shape.geometry.clone()))
            .collect();
        if shapes.is_empty() {
            return Err(refused("its root has no collision shapes".into()));
        }
        let triangles: Vec<_> = shapes.iter().flat_map(|(pose, shape)| triangles(shape, pose)).collect();
        let corners = triangles.as_flattened();
        let low = corners.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let high = corners.iter().copied().reduce(DVec3::max).unwrap_or_default();
        Ok(Self {
            name: name.to_owned(),
            link: robot.links[robot.parts[0].root_link.at()].name["object/".len()..].to_owned(),
            centre: centre(&robot, &shapes, (low + high) / 2.0),
            size: (high - low).max_element(),
            bounds: (low, high),
            hull: facets(&on_grid(&triangles, f64::INFINITY)),
            solids: shapes.iter().map(|(pose, shape)| (*pose, Solid::of(shape))).collect(),
            shapes,
            triangles,
        })
    }

    /// Whether it is one ball, which lies on no face.
    #[must_use]
    pub fn is_ball(&self) -> bool {
        matches!(self.shapes.as_slice(), [(_, Geometry::Sphere { .. })])
    }
}

/// The centre of mass.
fn centre(robot: &Robot, shapes: &[(Pose, Geometry)], middle: DVec3) -> DVec3 {
    let weighed = |points: Vec<(f64, DVec3)>| {
        let mass: f64 = points.iter().map(|(mass, _)| mass).sum();
        (mass > 0.0).then(|| points.iter().map(|(mass, at)| *at * *mass).sum::<DVec3>() / mass)
    };
    let links = robot.links.iter().filter(|link| link.joint.is_none());
    let masses = links.filter_map(|link| {
        let inertial = link.inertial.as_ref()?;
        Some((inertial.mass, link.joint_from_link.transform_point(inertial.center)))
    });
    let volumes = shapes.iter().filter_map(|(pose, shape)| {
        let (volume, centre) = shape.volume()?;
        Some((volume, pose.transform_point(centre)))
    });
    weighed(masses.collect()).or_else(|| weighed(volumes.collect())).unwrap_or(middle)
}
