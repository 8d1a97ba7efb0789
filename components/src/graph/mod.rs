//! The constraint graph and what foliates it: states, transitions, the constraints that they share, and leaves.

pub(crate) mod constraint;
pub mod constraint_graph;
pub mod leaf;
pub(crate) mod state;
pub(crate) mod transition;

pub use crate::graph::constraint::{ConstraintId, ConstraintKind, GraphConstraint, Opening};
pub use crate::graph::constraint_graph::ConstraintGraph;
pub use crate::graph::state::{Fingers, State, StateId};
pub use crate::graph::transition::{Leg, Transition, TransitionId, TransitionKind};
