//! Constraints of a host's own.

use super::{Frame, Row};
use crate::Pose;
use glam::DVec3;
use std::fmt::Debug;
use std::sync::Arc;

/// A constraint that a host writes itself: a function of the poses of some frames.
///
/// The planner finds how joints move the frames; the function only says how its rows change when a frame moves. What the
/// certificate needs to know of the function between two knots are two bounds ([`Self::curvature`]).
pub trait Function: Debug + Send + Sync {
    /// Name, for messages and path files.
    fn name(&self) -> &str;

    /// The frames that it depends on; the same on every call.
    fn frames(&self) -> &[Frame];

    /// What is asked of each row; the same on every call, without parameters.
    fn rows(&self) -> &[Row];

    /// Writes the rows; `X_WF` are the poses of the frames in the world, in the order of [`Self::frames`].
    #[allow(non_snake_case, reason = "X_AB notation")]
    fn value(&self, X_WF: &[Pose], values: &mut [f64]);

    /// Writes for row r and frame f the gradient with respect to the velocity of the frame's origin (per metre) and to its
    /// angular velocity (per radian), both in the world, at index `r · frames + f`.
    #[allow(non_snake_case, reason = "X_AB notation")]
    fn gradient(&self, X_WF: &[Pose], gradients: &mut [Gradient]);

    /// Bounds on how a row bends, over all poses that a motion may take: see [`Curvature`]. `None` where there is none; then
    /// motions on the constraint cannot be certified and are refused.
    fn curvature(&self) -> Option<Curvature>;
}

/// How a row changes with one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gradient {
    /// Per metre that the frame's origin moves, in world axes.
    pub linear: DVec3,
    /// Per radian that the frame turns, in world axes.
    pub angular: DVec3,
}

/// With v the sum over the frames of the speeds of their origins plus their angular speeds (m/s + rad/s), and a the sum of
/// the lengths of the corresponding accelerations, the second derivative of any row along a motion is at most
/// `lipschitz · a + bend · v²`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// Largest length of any gradient.
    pub lipschitz: f64,
    /// Largest second derivative of the function itself.
    pub bend: f64,
}

/// A shared function; two are equal where they are the same object.
#[derive(Clone, Debug)]
pub struct Custom(pub Arc<dyn Function>);

impl PartialEq for Custom {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
