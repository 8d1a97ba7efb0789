//! Hands that open and close: which joints are the fingers of a gripper, and how far they open.

use crate::robot::indices::{GripperIndex, JointIndex};

/// A hand that opens and closes. Its fingers are no joints to be planned: they have one opening in every state, and move only in
/// short motions of their own, while the rest of the robot stands still.
///
/// A gripper without an entry gets one where it has finger joints ([`fingers`](crate::path::fingers())) and none of them is locked. Which
/// of their bounds is the open one follows from a configuration of the robot that is called `open`, or else from the geometry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hand {
    /// Its grippers: frames that the same fingers close on. Usually one.
    pub grippers: Vec<GripperIndex>,
    /// Its fingers; none where the joints are to be planned as those of an arm.
    pub fingers: Vec<Finger>,
}

/// How far hands open to approach what they are to grasp, and where they let go of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Approach {
    /// Wide open.
    #[default]
    Wide,
    /// As far as the grasp needs, and no farther: the fingers stay off the body of the handle all along the way from the pregrasp to
    /// the grasp. Where a grasp has no pregrasp its hand opens wide.
    AsNeeded {
        /// How far they stay off, metres.
        clearance: f64,
    },
}

/// A joint of one coordinate that opens and closes a hand. All fingers of a hand move together, in proportion to their ranges, until one
/// touches something: then the joints of its chain stand still, and the others go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finger {
    /// The joint.
    pub joint: JointIndex,
    /// Its value where the hand is wide open, metres or radians.
    pub open: f64,
    /// Its value where the hand is shut.
    pub closed: f64,
    /// Its value while the hand is empty and travels. `None`: as at the start of the problem; where the hand holds something there,
    /// and where it has a grasp without a pregrasp, wide open.
    pub travel: Option<f64>,
}

impl Finger {
    /// The value at `share` of the way from open to shut.
    #[must_use]
    pub fn at(&self, share: f64) -> f64 {
        self.open + share * (self.closed - self.open)
    }
}

impl Hand {
    /// The values of the fingers at `share` of the way from open to shut.
    pub fn at(&self, share: f64) -> impl Iterator<Item = f64> + '_ {
        self.fingers.iter().map(move |finger| finger.at(share))
    }

    /// Whether the hand travels wide open.
    #[must_use]
    pub fn travels_open(&self) -> bool {
        self.fingers.iter().all(|finger| finger.travel.is_none_or(|travel| travel == finger.open))
    }
}
