//! A path and its segments: configurations, what holds along them, and what was proven.

use crate::Pose;
use crate::constraint::kind::Constraint;
use crate::coverage::PairCounts;
use crate::graph::{StateId, TransitionId};
use crate::problem::start_tolerance::Correction;
use crate::robot::indices::{GripperIndex, HandleIndex, JointIndex, LinkIndex, SurfaceIndex};

/// A path from the start to a goal. Consecutive segments share the joint knot bit for bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ManipulationPath {
    /// Segments in the direction of travel.
    pub segments: Vec<Segment>,
    /// What was proven about all of them.
    pub certificate: Certificate,
    /// What of the problem's start and goals was a little off a state: the path begins and ends where it was moved.
    pub corrections: Vec<Correction>,
}

impl ManipulationPath {
    /// How long it takes, seconds; `None` for a path without times.
    #[must_use]
    pub fn duration(&self) -> Option<f64> {
        let (first, last) = (self.segments.first()?, self.segments.last()?);
        let (first, last) = (first.timing.as_ref()?, last.timing.as_ref()?);
        Some(last.times.last()? - first.times.first()?)
    }
}

/// A motion on one leaf.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// The transition that is travelled, in the direction of travel.
    pub transition: TransitionId,
    /// The state in which the motion lies.
    pub state: StateId,
    /// What holds or carries each object; the first attachment of an object is its carrier.
    pub attachments: Vec<Attachment>,
    /// What else holds along the motion: objects on a plane, joints at rest, the problem's own constraints.
    pub constraints: Vec<PathConstraint>,
    /// Whole configurations, one row per knot, at least two.
    pub knots: Vec<Vec<f64>>,
    /// When the knots are passed and how fast; `None` in a path without times. All segments of a path have it or none.
    pub timing: Option<SegmentTiming>,
}

/// Makes a segment a curve over time. From knot k to the next every coordinate is the cubic Hermite polynomial through
/// both positions and both velocities; the quaternion of a free-flyer is scaled to length 1 after that. Objects with a carrier
/// follow it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SegmentTiming {
    /// Seconds from the start of the path, one per knot, increasing. A segment begins when the one before ends.
    pub times: Vec<f64>,
    /// Derivatives of the coordinates by time, one row per knot and one number per coordinate (not per velocity coordinate: a
    /// quaternion has four). Those of objects with a carrier are 0 and have no meaning.
    pub velocities: Vec<Vec<f64>>,
}

/// A constraint that holds along a segment besides its attachments.
#[derive(Clone, Debug, PartialEq)]
pub struct PathConstraint {
    /// For output and messages.
    pub name: String,
    /// The constraint; parameter rows are measured against `argument`.
    pub constraint: Constraint,
    /// The leaf's value for the parameter rows, in the form of a solve's argument (a locked joint's value is the x of the
    /// translation); `None` where there are none.
    pub argument: Option<Pose>,
}

/// What an object is attached to during a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attachment {
    /// A gripper holds one of its handles.
    Grasp {
        /// Root joint of the object; of a part that is fixed in the world the joint that moves the held link.
        object: JointIndex,
        /// Who holds.
        gripper: GripperIndex,
        /// By which handle.
        handle: HandleIndex,
        /// Whether the object follows this attachment rigidly; further ones are certified constraints.
        carrier: bool,
    },
    /// It lies on a support.
    Contact {
        /// Root joint of the object.
        object: JointIndex,
        /// The object's surface and the number of its polygon.
        surface: (SurfaceIndex, u32),
        /// The support's surface and the number of its polygon.
        support: (SurfaceIndex, u32),
    },
    /// It has no surfaces and stays where it is.
    Rest {
        /// Root joint of the object.
        object: JointIndex,
        /// The link that it touches there, where the problem names one.
        on: Option<LinkIndex>,
    },
}

/// What is proven about a path over the continuum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Certificate {
    /// Bound that residuals must keep, metres and radians.
    pub path_tolerance: f64,
    /// Proven bound of the residual of implicit rows and of the objects' jumps at joint knots.
    pub max_residual: f64,
    /// Proven lower bound of the clearance beyond the margins, of all tested pairs, those that do not move included; metres. None
    /// where no pair was tested.
    pub min_clearance: Option<f64>,
    /// Which pairs of shapes that holds for.
    pub pairs: PairCounts,
}
