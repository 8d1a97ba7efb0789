//! The constraints that states and waypoints share, named as HPP names them.

use crate::constraint::ApproachBound;
use crate::robot::indices::{GripperIndex, HandleIndex, JointIndex};

/// Index of a constraint in [`crate::graph::constraint_graph::ConstraintGraph::constraints`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ConstraintId(pub u32);

impl ConstraintId {
    /// The index, for slices.
    #[must_use]
    pub fn at(self) -> usize {
        self.0 as usize
    }
}

/// A named constraint.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphConstraint {
    /// `g grasps h`, `place_o`, …
    pub name: String,
    /// What it requires.
    pub kind: ConstraintKind,
    /// Whether it has rows that are right-hand sides: the complement that foliates the states it holds in (P0 eq. 5, 9).
    pub foliates: bool,
}

/// How far a hand is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Opening {
    /// As it travels while it is empty.
    Travel,
    /// Wide open, beside what it is to grasp.
    Wide,
    /// As wide as a grasp needs, beside what it is to grasp.
    Ready {
        /// Who is to hold.
        gripper: GripperIndex,
        /// What is to be held.
        handle: HandleIndex,
    },
    /// Closed on a handle: until fingers nearly touch the body of the handle.
    Closed {
        /// Who holds.
        gripper: GripperIndex,
        /// What is held.
        handle: HandleIndex,
    },
}

/// What a constraint requires. Objects are indices into [`crate::graph::constraint_graph::ConstraintGraph::objects`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ConstraintKind {
    /// The handle sits in the gripper, up to the handle's mask.
    Grasp {
        /// Who holds.
        gripper: GripperIndex,
        /// What is held.
        handle: HandleIndex,
    },
    /// The gripper stands back along its own x axis by the sum of both clearances.
    Pregrasp {
        /// Who approaches.
        gripper: GripperIndex,
        /// What is approached.
        handle: HandleIndex,
    },
    /// One of the object's surfaces lies on a support of one body, the margin above it.
    Placement {
        /// The object.
        object: u32,
        /// The body whose supports carry it: another object, a drawer, a tray; `None` for those fixed in the world.
        on: Option<JointIndex>,
    },
    /// As a placement, lifted by the pre-placement distance along the support's normal.
    Preplacement {
        /// The object.
        object: u32,
        /// The body whose supports are to carry it.
        on: Option<JointIndex>,
    },
    /// An object without surfaces stays where it is while no gripper holds it (HPP: locked joints as placement complement).
    Rest {
        /// The object.
        object: u32,
    },
    /// A joint of an articulated part stays where it is, or is at its rest, while no handle beyond it is held.
    JointRest {
        /// Number in [`crate::problem::GraphOptions::resting_joints`].
        joint: u32,
    },
    /// A finger of a hand has the value that belongs to an opening of the hand.
    Finger {
        /// Number in [`crate::problem::GraphOptions::hands`].
        hand: u32,
        /// Number in [`crate::problem::Hand::fingers`].
        finger: u32,
        /// How far the hand is open.
        opening: Opening,
    },
    /// The gripper is on the line from the pregrasp to the grasp, and turned as it is there, as far as
    /// [`GraphOptions::line_to`](crate::problem::GraphOptions::line_to) asks.
    Approach {
        /// Who approaches.
        gripper: GripperIndex,
        /// What is approached.
        handle: HandleIndex,
        /// Which of it.
        bound: ApproachBound,
    },
    /// The object keeps its pose against the body on which it lies, but for its height: a straight lift.
    Lift {
        /// The object.
        object: u32,
        /// The body whose supports carry it.
        on: Option<JointIndex>,
    },
    /// A constraint of the problem's own.
    Given {
        /// Number in [`crate::problem::GraphOptions::constraints`].
        constraint: u32,
    },
    /// A constraint of the problem's own that holds because a gripper holds an object.
    WhileHeld {
        /// Number in [`crate::problem::GraphOptions::constraints`].
        constraint: u32,
    },
}
