//! Draws of placements of one object on supports that are fixed in the world.

use crate::planning_model::graph::support_placement::SupportPlacement;
use crate::planning_model::model::Model;
use foliate_components::Pose;
use foliate_components::graph::leaf::Parameter;
use foliate_components::graph::{ConstraintId, ConstraintKind};
use foliate_components::pose::exp_so3;
use foliate_components::robot::{JointIndex, Source};
use foliate_kernels::constraints::placement;
use glam::{DVec2, DVec3};
use rand::RngExt;
use std::f64::consts::PI;

/// Share of the draws that lie between a placement of the start's side and one of the goal's.
const BETWEEN: f64 = 0.75;

/// Draws between two placements stray from the straight way by at most this share of its length, and most by far less.
const ASTRAY: f64 = 0.5;

/// Where one object may rest.
#[derive(Clone, Debug)]
pub(crate) struct Resting {
    ground: Ground,
    /// The constraint of the graph.
    pub(crate) constraint: ConstraintId,
}

/// What is fixed in the world and may carry one object.
#[derive(Clone, Debug)]
struct Ground {
    root: JointIndex,
    place: SupportPlacement,
    /// Bounds of the root's translation, in the frame of its joint.
    bounds: [(f64, f64); 3],
    X_WP: Pose,
}

/// Draws a pose of an object's root in the world in which it lies on a support that is fixed in the world: any of its faces on any polygon,
/// anywhere, turned any way. `None` where what was drawn is beyond the support's edge or the object's bounds, and of an object that has no
/// such support. Collisions are not looked at, nor whether it would fall over an edge.
#[must_use]
pub fn draw_place(model: &Model, object: u32, rng: &mut impl RngExt) -> Option<Pose> {
    let ground = Ground::of_object(model, object)?;
    ground.draw_anywhere(rng).filter(|X_WO| ground.is_within_bounds(X_WO))
}

impl Ground {
    fn of_object(model: &Model, object: u32) -> Option<Self> {
        let root = model.objects()[object as usize].root?;
        let place = model.objects()[object as usize].placement_on(None)?.resting.clone();
        let joint = &model.problem.robot.joints[root.at()];
        let Source::Coordinates { q, .. } = joint.source else { return None };
        let space = &model.problem.robot.space;
        let bounds = [0, 1, 2].map(|axis| (space.lower[q + axis], space.upper[q + axis]));
        Some(Self { root, place, bounds, X_WP: joint.parent_from_joint })
    }

    fn draw_anywhere(&self, rng: &mut impl RngExt) -> Option<Pose> {
        let turn = rng.random_range(-PI..PI);
        match &self.place {
            SupportPlacement::Surfaces(lying) => {
                let object = rng.random_range(0..lying.object.len());
                let support = rng.random_range(0..lying.supports.len());
                let polygon = &lying.supports[support];
                let corners = || polygon.vertices.iter().copied();
                let (low, high) = (corners().reduce(DVec2::min)?, corners().reduce(DVec2::max)?);
                let drawn = DVec2::new(rng.random(), rng.random()) * (high - low) + low;
                let stride = 2.0 * lying.stride;
                let place = DVec3::new(0.0, drawn.x + support as f64 * stride, drawn.y + object as f64 * stride);
                let parameter = Pose::from_parts(place, exp_so3(DVec3::X * turn));
                let inside = polygon.signed_distance(drawn) < 0.0;
                placement::hold(lying, &parameter).filter(|_| inside).map(|(_, X_WO)| X_WO)
            }
            SupportPlacement::Plane { plane, frame } => {
                let [x, y, z] = self.bounds.map(|(low, high)| rng.random_range(low..=high));
                let X_PF = plane.joint_from_frame.inverse() * self.X_WP * Pose::from_translation(DVec3::new(x, y, z));
                let flat = DVec3::new(X_PF.translation.x, X_PF.translation.y, 0.0);
                let X_PF = Pose::from_parts(flat, exp_so3(DVec3::Z * turn));
                Some(plane.joint_from_frame * X_PF * frame.joint_from_frame.inverse())
            }
        }
    }

    fn is_within_bounds(&self, X_WO: &Pose) -> bool {
        let place = (self.X_WP.inverse() * *X_WO).translation.to_array();
        place.iter().zip(&self.bounds).all(|(x, (low, high))| low <= x && x <= high)
    }
}

impl Resting {
    /// Where an object may rest on what is fixed in the world; nothing where it does not.
    pub(crate) fn of_object(model: &Model, object: u32) -> Option<Self> {
        let ground = Ground::of_object(model, object)?;
        let wanted = ConstraintKind::Placement { object, on: None };
        let constraint = model.graph.constraints.iter().position(|c| c.kind == wanted)?;
        Some(Self { ground, constraint: ConstraintId(constraint as u32) })
    }

    /// The leaf parameter of a placement.
    pub(crate) fn parameter(&self, X_WO: &Pose) -> Parameter {
        Parameter { constraint: self.constraint, carrier: None, value: *X_WO }
    }

    /// The placement next to a pose: the object is laid flat onto the nearest support. `X_WJ` has room for all bodies.
    pub(crate) fn laid_down(&self, X_WO: &Pose, X_WJ: &mut [Pose]) -> Option<Pose> {
        X_WJ[self.ground.root.at()] = *X_WO;
        let (_, exact) = self.ground.place.exact(self.ground.root, X_WJ)?;
        self.ground.is_within_bounds(&exact).then_some(exact)
    }

    /// Draws a placement: some around the straight way between two, some anywhere.
    pub(crate) fn draw(&self, ends: (&Pose, &Pose), rng: &mut impl RngExt, X_WJ: &mut [Pose]) -> Option<Pose> {
        let X_WO = match rng.random::<f64>() < BETWEEN {
            true => self.draw_between(ends, rng, X_WJ)?,
            false => self.ground.draw_anywhere(rng)?,
        };
        self.ground.is_within_bounds(&X_WO).then_some(X_WO)
    }

    fn draw_between(&self, (a, b): (&Pose, &Pose), rng: &mut impl RngExt, X_WJ: &mut [Pose]) -> Option<Pose> {
        let t = rng.random::<f64>();
        let stray = ASTRAY * rng.random::<f64>().powi(2);
        let far = a.translation.distance(b.translation);
        let mut symmetric = || rng.random_range(-1.0..1.0);
        let aside = DVec3::new(symmetric(), symmetric(), symmetric()) * stray * far;
        let mut X_WO = Pose::from_parts(
            a.translation.lerp(b.translation, t) + aside,
            a.rotation.slerp(b.rotation, rng.random()).normalize(),
        );
        X_WO = self.laid_down(&X_WO, X_WJ)?;
        X_WJ[self.ground.root.at()] = X_WO;
        let turn = exp_so3(self.ground.place.normal(X_WJ) * rng.random_range(-PI..PI) * stray);
        Some(Pose::from_parts(X_WO.translation, (turn * X_WO.rotation).normalize()))
    }

    /// The direction in which the object is lifted from a placement.
    pub(crate) fn normal(&self, X_WO: &Pose, X_WJ: &mut [Pose]) -> DVec3 {
        X_WJ[self.ground.root.at()] = *X_WO;
        self.ground.place.normal(X_WJ)
    }
}
