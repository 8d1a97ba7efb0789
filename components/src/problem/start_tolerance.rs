//! How far a start or a goal may be off the states of the constraint graph, and what is corrected of it.
//!
//! Cameras give poses to a few millimetres, models are exact to less, and constraints hold to far less. A start that is within the
//! tolerance of a state is moved onto it; every correction is reported.

use crate::Pose;
use crate::pose::pose_to_array;
use crate::robot::indices::{JointIndex, PartIndex};
use std::fmt;

/// How far an object's root, or a joint, may be moved so that a configuration lies in a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartTolerance {
    /// Of an object the way of its root link's origin, of a prismatic joint the way: metres.
    pub distance: f64,
    /// Of an object the angle of the turn, of a revolute joint the angle: radians.
    pub angle: f64,
}

impl Default for StartTolerance {
    /// 5 mm and 2 degrees.
    fn default() -> Self {
        Self { distance: 0.005, angle: 2.0_f64.to_radians() }
    }
}

impl StartTolerance {
    /// Nothing is moved.
    #[must_use]
    pub fn none() -> Self {
        Self { distance: 0.0, angle: 0.0 }
    }

    /// Whether nothing may be moved at all.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.distance <= 0.0 && self.angle <= 0.0
    }

    /// How large a motion is against the tolerance: the larger of both shares, at most 1 where it is within.
    #[must_use]
    pub fn share(&self, distance: f64, angle: f64) -> f64 {
        let of = |value: f64, most: f64| match (value > 0.0, most > 0.0) {
            (false, _) => 0.0,
            (true, true) => value / most,
            (true, false) => f64::INFINITY,
        };
        of(distance, self.distance).max(of(angle, self.angle))
    }
}

impl fmt::Display for StartTolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Rounded so that 2 degrees in radians are 2 degrees.
        let degrees = (self.angle.to_degrees() * 1e6).round() / 1e6;
        write!(f, "{} mm and {degrees} degrees", (self.distance * 1e9).round() / 1e6)
    }
}

/// Something of a start or a goal that is moved, or would have to be moved, so that it lies in a state.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Correction {
    /// Number of the goal; `None` for the start.
    pub goal: Option<usize>,
    /// Name of the object or joint.
    pub name: String,
    /// What it is, and where it then is.
    pub moved: Moved,
    /// What holds there, in words: `it lies on table/top`.
    pub onto: String,
    /// How far it is moved: an object's root origin, a prismatic joint, the origin of a robot's root. Metres.
    pub distance: f64,
    /// By which angle it is turned, radians.
    pub angle: f64,
}

/// What a [`Correction`] moves, and where it then is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Moved {
    /// An object, by its root link's pose in the world.
    Object(PartIndex, Pose),
    /// A joint with one coordinate: radians or metres.
    Joint(JointIndex, f64),
    /// The root of a robot, planar or free.
    Root(JointIndex),
}

impl Correction {
    /// A correction of the start (`None`) or of a goal: name, what is moved where, what holds there, metres and radians.
    #[must_use]
    pub fn new(
        goal: Option<usize>,
        (name, moved): (String, Moved),
        onto: String,
        (distance, angle): (f64, f64),
    ) -> Self {
        Self { goal, name, moved, onto, distance, angle }
    }

    /// `0.30 mm and 0.00 degrees`.
    #[must_use]
    pub fn size(&self) -> String {
        let (way, turn) = (self.distance * 1e3, self.angle.to_degrees());
        match self.moved {
            Moved::Joint(..) if self.distance > 0.0 => format!("{way:.3} mm"),
            Moved::Joint(..) => format!("{turn:.3} degrees"),
            Moved::Object(..) | Moved::Root(_) => format!("{way:.2} mm and {turn:.2} degrees"),
        }
    }

    /// What it is about and how far that is off, without where it then is: `` `box` is 12.00 mm and 0.00 degrees from where it lies on table/top``.
    #[must_use]
    pub fn to_words(&self) -> String {
        format!("`{}` is {} from where {}", self.name, self.size(), self.onto)
    }

    /// Where it then is, as a scene file says it.
    #[must_use]
    pub fn target(&self) -> Option<String> {
        match self.moved {
            Moved::Object(_, pose) => {
                let numbers = pose_to_array(&pose).map(|x| format!("{}", (x * 1e6).round() / 1e6 + 0.0));
                Some(format!("{} = [{}]", self.name, numbers.join(", ")))
            }
            Moved::Joint(_, value) => Some(format!("\"{}\" = {}", self.name, (value * 1e6).round() / 1e6 + 0.0)),
            Moved::Root(_) => None,
        }
    }
}

impl fmt::Display for Correction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.goal {
            None => f.write_str("the start")?,
            Some(goal) => write!(f, "goal {goal}")?,
        }
        write!(f, " has `{}` {} from where {}: it is moved there", self.name, self.size(), self.onto)
    }
}
