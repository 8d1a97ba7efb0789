//! Constraints as data: what they relate and which of their rows are zero, parameters or inequalities.
//!
//! Right-hand sides are never stored here: a row that depends on one names the *slot* of the argument list in which a
//! solve finds it. Every argument is a pose (a locked joint's value travels as the x of a translation).

mod grasp;
mod locked;
mod mask;
mod placement;
mod relative_pose;
mod row;

pub use grasp::Grasp;
pub use locked::{Locked, LockedValue};
pub use mask::{Mask, MaskError};
pub use placement::{Placement, PlacementError, Polygon, Side};
pub use relative_pose::{Frame, Reference, RelativePose};
pub use row::{Row, Rows, parameter_of, rows};

/// One constraint of a state or a transition.
#[derive(Clone, Debug, PartialEq)]
pub enum Constraint {
    /// Two frames in a relative pose: grasps, pre-grasps, feet on the ground, anything rigid.
    RelativePose(RelativePose),
    /// An object lies on a support (the five rows P_f = 0); which polygons touch is found at each evaluation.
    Placement(Placement),
    /// The rows P̄_f equal the leaf parameter in the slot; the parameter says which polygons touch.
    PlacementComplement(Placement, usize),
    /// Both: the object lies on the polygon and at the place that the leaf parameter in the slot says.
    PlacementHold(Placement, usize),
    /// A joint keeps its value.
    Locked(Locked),
}
