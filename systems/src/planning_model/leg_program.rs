//! The form of a compiled leg: the constraint program, its idle coordinates, and what its arguments are.
//!
//! The type is apart from `programs`, which compiles it from a model, because the model itself holds compiled legs.

use foliate_components::constraint::Frame;
use foliate_components::graph::ConstraintId;
use foliate_kernels::constrained_motion::ConstraintProgram;

/// A compiled leg, or the compiled interior of a state.
#[derive(Clone, Debug)]
pub struct LegProgram {
    /// What the kernels solve.
    pub program: ConstraintProgram,
    /// Numbers of a configuration that the target does not depend on: joints of limbs that have nothing to do with it.
    pub idle: Vec<usize>,
    /// Frames whose relative pose is determined wholly by its rows, the second's in the first.
    pub rigid: Vec<(Frame, Frame)>,
    /// What each argument after the objects' poses is.
    pub(crate) extra: Vec<Extra>,
}

/// An argument after the objects' poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Extra {
    /// The leaf's value of a constraint of the state that carries nothing.
    Hold(ConstraintId),
    /// The drawn value of this target constraint.
    Drawn(ConstraintId),
}
