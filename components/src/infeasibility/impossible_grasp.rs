//! Grasps that geometry rules out, and their words.

use std::fmt;

/// Most grasps that a message explains.
const MOST_GRASPS: usize = 3;

/// Where an object is that no hand can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectPlace {
    /// Where it starts.
    Start,
    /// Where goals have it.
    Goal,
}

impl ObjectPlace {
    /// The place in words: `where it starts`, `where the goal has it`.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Start => "where it starts",
            Self::Goal => "where the goal has it",
        }
    }
}

/// A grasp that geometry rules out.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ImpossibleGrasp {
    /// Name of the gripper.
    pub gripper: String,
    /// Name of the handle.
    pub handle: String,
    /// What rules it out.
    pub why: RuledOut,
}

impl ImpossibleGrasp {
    /// A gripper, a handle, and what rules out the grasp.
    #[must_use]
    pub fn new(gripper: String, handle: String, why: RuledOut) -> Self {
        Self { gripper, handle, why }
    }
}

/// What rules out a grasp.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RuledOut {
    /// The handle is farther from the robot's first joint than the gripper can ever be.
    TooFar {
        /// The joint.
        joint: String,
        /// How far the handle is from it at least, metres.
        distance: f64,
        /// How far the gripper can be from it at most, metres.
        longest: f64,
    },
    /// With the handle in the gripper the hand overlaps the object, however far it opens.
    HandInObject {
        /// Names of the shapes: of the hand, of the object.
        shapes: (String, String),
        /// How deep they overlap, metres.
        depth: f64,
    },
}

impl fmt::Display for ImpossibleGrasp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { gripper, handle, why } = self;
        match why {
            RuledOut::TooFar { joint, distance, longest } => write!(
                f,
                "{handle} is {distance:.2} m from {joint}, and {gripper} is never more than {longest:.2} m from it"
            ),
            RuledOut::HandInObject { shapes: (hand, object), depth } => write!(
                f,
                "with {handle} in {gripper}, {hand} and {object} overlap by {:.1} mm, however far the hand opens",
                depth * 1e3
            ),
        }
    }
}

/// The first grasps, and how many more there are.
pub(super) fn tell_grasps(grasps: &[ImpossibleGrasp], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let told: Vec<String> = grasps.iter().take(MOST_GRASPS).map(ImpossibleGrasp::to_string).collect();
    f.write_str(&told.join("; "))?;
    match grasps.len().checked_sub(MOST_GRASPS) {
        Some(more) if more > 0 => write!(f, "; and likewise {more} grasps more"),
        _ => Ok(()),
    }
}
