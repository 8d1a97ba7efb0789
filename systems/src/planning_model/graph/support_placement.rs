//! How an object rests while no gripper holds it: polygons on polygons (P0 §II-C.1), or a frame on a plane.
//!
//! Supports are grouped by the body that carries them, because the object is attached to that body while it lies there.

use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Placement, PlacementError, Reference, RelativePose, Row};
use foliate_components::infeasibility::OffSupport;
use foliate_components::pose::{exp_so3, log_so3};
use foliate_components::problem::{GraphOptions, ObjectOptions};
use foliate_components::robot::{JointIndex, LinkIndex, Robot, SurfaceIndex};
use foliate_kernels::constraints::{placement, placement_of, relative_pose};
use glam::DVec3;
use std::collections::HashMap;

/// What an object may rest on.
#[derive(Clone, Debug)]
pub enum SupportPlacement {
    /// Its surfaces on supports.
    Surfaces(Placement),
    /// A frame of it on a plane: rows z, rx, ry are zero; x, y, rz are the leaf's.
    Plane {
        /// The plane in the world.
        plane: Frame,
        /// The object's frame.
        frame: Frame,
    },
}

/// What an object may rest on, on one body.
#[derive(Clone, Debug)]
pub struct PlacementOnSupport {
    /// The body; `None` for what is fixed in the world.
    pub on: Option<JointIndex>,
    /// The supports on it; empty for a plane.
    pub supports: Vec<SurfaceIndex>,
    /// What a plane is the top of, where the problem says so: the object touches it.
    pub touches: Option<LinkIndex>,
    /// How the object rests there.
    pub resting: SupportPlacement,
}

/// See [`lift_lines`].
pub(crate) type LiftLines = HashMap<(u32, Option<JointIndex>), RelativePose>;

/// The bodies that may carry an object, with their supports: what is fixed in the world first, others in the order in
/// which their supports are named. An object's own surfaces do not carry it.
#[must_use]
pub(crate) fn carrying_bodies(
    robot: &Robot,
    options: &GraphOptions,
    object: &ObjectOptions,
) -> Vec<(Option<JointIndex>, Vec<SurfaceIndex>)> {
    if object.plane.is_some() {
        return vec![(None, Vec::new())];
    }
    let mut bodies: Vec<(Option<JointIndex>, Vec<SurfaceIndex>)> = Vec::new();
    if object.surfaces.is_empty() {
        return bodies;
    }
    for &support in &options.supports {
        let link = &robot.links[robot.surfaces[support.at()].link.at()];
        if link.part == object.part {
            continue;
        }
        match bodies.iter_mut().find(|(body, _)| *body == link.joint) {
            Some((_, supports)) => supports.push(support),
            None => bodies.push((link.joint, vec![support])),
        }
    }
    // Stable: among bodies that move the order stays.
    bodies.sort_by_key(|(body, _)| body.is_some());
    bodies
}

/// What holds along straight lifts, by object and body that carries it; see [`GraphOptions::lift_line`].
#[must_use]
pub(crate) fn lift_lines(robot: &Robot, options: &GraphOptions) -> LiftLines {
    let of_object = |(number, object): (u32, &ObjectOptions)| {
        let bodies: Vec<_> = carrying_bodies(robot, options, object).into_iter().map(|(on, _)| on).collect();
        let line = move |on| Some(((number, on), options.lift_line(robot, number as usize, on)?));
        bodies.into_iter().filter_map(line)
    };
    (0u32..).zip(&options.objects).flat_map(of_object).collect()
}

impl PlacementOnSupport {
    /// Reads an object's documents; empty where it has neither surfaces nor a plane.
    ///
    /// # Errors
    /// Surfaces that make no placement.
    pub fn of_object(
        robot: &Robot,
        options: &GraphOptions,
        object: &ObjectOptions,
    ) -> Result<Vec<Self>, PlacementError> {
        if let Some(plane) = &object.plane {
            let root = robot.parts[object.part.at()].root_link;
            let frame = Frame::on_link(robot, root, &plane.object_from_frame);
            let resting = SupportPlacement::Plane { plane: Frame::world(plane.world_from_plane), frame };
            return Ok(vec![Self { on: None, supports: Vec::new(), touches: plane.on, resting }]);
        }
        let place = |(on, supports): (Option<JointIndex>, Vec<SurfaceIndex>)| {
            let placement = Placement::new(robot, &object.surfaces, &supports, options.placement_margin)?;
            let centre = robot.body_centre(object.part, placement.object_joint()).map(|(centre, _)| centre);
            let placement = placement.resting(options.rests, centre)?;
            Ok(Self { on, supports, touches: None, resting: SupportPlacement::Surfaces(placement) })
        };
        carrying_bodies(robot, options, object).into_iter().map(place).collect()
    }
}

impl SupportPlacement {
    /// The constraint to rest, or to be lifted by `lift` metres along the support's normal.
    #[must_use]
    pub fn constraint(&self, lift: f64) -> Constraint {
        match self {
            Self::Surfaces(placement) => Constraint::Placement(placement.lifted(lift)),
            Self::Plane { plane, frame } => Constraint::RelativePose(on_plane(plane, frame, lift)),
        }
    }

    /// The largest row of the constraint's error where the bodies are, metres and radians.
    #[must_use]
    pub fn residual(&self, lift: f64, X_WJ: &[Pose]) -> f64 {
        match self {
            Self::Surfaces(placement) => {
                let lifted = placement.lifted(lift);
                let value = placement::value(&lifted, placement::contact(&lifted, X_WJ), X_WJ);
                value.iter().map(|v| v.abs()).fold(0.0, f64::max)
            }
            Self::Plane { plane, frame } => relative_pose_residual(&on_plane(plane, frame, lift), X_WJ),
        }
    }

    /// How far the object is off the polygons that are nearest to contact; `None` on a plane.
    #[must_use]
    pub fn off(&self, X_WJ: &[Pose]) -> Option<OffSupport> {
        let Self::Surfaces(lying) = self else { return None };
        let contact = placement::contact(lying, X_WJ);
        let [x, ..] = placement::value(lying, contact, X_WJ);
        let tilt = (placement::pose(lying, contact, X_WJ).rotation * DVec3::X).angle_between(DVec3::X);
        // x points into the support.
        Some(OffSupport::new(-x, placement::aside(lying, contact, X_WJ), tilt, lying.rests))
    }

    /// Where exactly the object rests, given poses at which it does to within a projection's tolerance: its carrier, and
    /// its root's pose in it.
    #[must_use]
    pub fn exact(&self, root: JointIndex, X_WJ: &[Pose]) -> Option<(Option<JointIndex>, Pose)> {
        match self {
            Self::Surfaces(lying) => {
                let (contact, X_CO) = placement::hold(lying, &placement::parameter(lying, X_WJ))?;
                Some((lying.supports[contact.support].frame.joint, X_CO))
            }
            Self::Plane { plane, frame } => {
                let X_WP = plane.joint_from_frame;
                let X_PF = X_WP.inverse() * X_WJ[root.at()] * frame.joint_from_frame;
                let yaw = log_so3(X_PF.rotation).z;
                let flat = DVec3::new(X_PF.translation.x, X_PF.translation.y, 0.0);
                let X_PF = Pose::from_parts(flat, exp_so3(DVec3::Z * yaw));
                Some((None, X_WP * X_PF * frame.joint_from_frame.inverse()))
            }
        }
    }

    /// The unit normal, pointing out, of what carries the object where the bodies are; in the carrier's joint frame.
    #[must_use]
    pub fn normal(&self, X_WJ: &[Pose]) -> DVec3 {
        match self {
            Self::Surfaces(lying) => {
                let contact = placement::contact(lying, X_WJ);
                // A support's x points into it.
                -(lying.supports[contact.support].frame.joint_from_frame.rotation * DVec3::X)
            }
            Self::Plane { plane, .. } => plane.joint_from_frame.rotation * DVec3::Z,
        }
    }
}

fn on_plane(plane: &Frame, frame: &Frame, lift: f64) -> RelativePose {
    let zero = Some(Row::Zero);
    RelativePose {
        a: plane.then(&Pose::from_translation(DVec3::Z * lift)),
        b: *frame,
        rows: [None, None, zero, zero, zero, None],
        reference: Reference::Identity,
    }
}

/// The largest held row of a relative pose's error, metres and radians.
#[must_use]
pub(crate) fn relative_pose_residual(constraint: &RelativePose, X_WJ: &[Pose]) -> f64 {
    let (a, b) = (placement_of(&constraint.a), placement_of(&constraint.b));
    let value = relative_pose::value(&a, &b, &Pose::identity(), X_WJ);
    let held = value.iter().zip(&constraint.rows).filter(|(_, row)| row.is_some());
    held.map(|(v, _)| v.abs()).fold(0.0, f64::max)
}
