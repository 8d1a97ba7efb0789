//! Where a path may end: a whole configuration, or what is asked of any.

use crate::Pose;
use crate::constraint::kind::Constraint;
use crate::robot::indices::{GripperIndex, HandleIndex, PartIndex, SurfaceIndex};

/// Where to end.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// A whole configuration.
    Configuration(Vec<f64>),
    /// Every configuration, in any state of the graph, in which these requirements hold.
    Partial(PartialGoal),
}

/// The requirements of a goal; everything else is free. All of them hold in every goal.
///
/// Nothing is left in a hand that was not asked for: a gripper of a robot holds an object in the end only if `hands` or `held` say so, or
/// if the goal gives the object a place (a pose, a coordinate, a constraint) at which it rests on nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartialGoal {
    /// Poses of these movable objects' root links in the world.
    pub poses: Vec<(PartIndex, Pose)>,
    /// Numbers of a configuration, by index: metres or radians. Of a quaternion all four are named or none.
    pub coordinates: Vec<(usize, f64)>,
    /// Constraints: a hand at a place, an object upright. Rows that are parameters require nothing of a goal.
    pub constraints: Vec<NamedConstraint>,
    /// Movable objects that lie on one of these supports, held by nothing.
    pub lying: Vec<(PartIndex, Vec<SurfaceIndex>)>,
    /// Numbers of a configuration that are near a value: index, value, how far off at most; metres or radians.
    pub near: Vec<(usize, f64, f64)>,
    /// What these grippers hold.
    pub hands: Vec<(GripperIndex, Holding)>,
    /// Objects that a gripper holds, whichever.
    pub held: Vec<PartIndex>,
    /// What grippers of robots may hold of which nothing is said.
    pub other_hands: OtherHands,
}

/// A constraint with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedConstraint {
    /// For output and errors.
    pub name: String,
    /// What it requires.
    pub constraint: Constraint,
}

/// What a gripper holds in a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holding {
    /// Nothing.
    Nothing,
    /// Whatever there is, or nothing.
    Anything,
    /// This object, by any handle.
    Object(PartIndex),
    /// This handle.
    Handle(HandleIndex),
}

/// What hands may hold of which a goal says nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OtherHands {
    /// Only what the goal asks for.
    #[default]
    AsAsked,
    /// Whatever there is.
    Anything,
}

impl Goal {
    /// Only where objects shall be: poses of their root links in the world.
    #[must_use]
    pub fn object_poses(poses: Vec<(PartIndex, Pose)>) -> Self {
        Self::Partial(PartialGoal { poses, ..PartialGoal::default() })
    }
}

impl Default for Goal {
    fn default() -> Self {
        Self::Partial(PartialGoal::default())
    }
}
