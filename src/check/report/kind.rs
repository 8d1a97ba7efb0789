//! Which promises there are, and how a check may end.

use serde::Serialize;

/// The promise that is broken. Names are those of the path contract's independent checker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A joint or a robot's root beyond the file's limits.
    Limit,
    /// A joint that follows a leader beyond its model's limits.
    FollowerLimit,
    /// A resting object out of its bounds.
    ObjectBounds,
    /// Consecutive segments do not share their knot bit for bit.
    SharedKnot,
    /// A quaternion that is not unit.
    QuaternionNorm,
    /// Consecutive quaternions on different sides.
    QuaternionSign,
    /// An environment's joint moves.
    EnvironmentMoves,
    /// Time runs backwards.
    Times,
    /// A coordinate is faster than its limit.
    VelocityLimit,
    /// A coordinate accelerates more than its limit.
    AccelerationLimit,
    /// A coordinate's acceleration changes faster than its limit, or jumps.
    JerkLimit,
    /// A velocity jumps from one segment to the next, or the path does not begin and end at rest.
    VelocityJump,
    /// An object that follows a carrier, or rests, is written with a velocity.
    CarriedVelocity,
    /// The events are not those of the attachments, or their times or fingers are not those of the knots.
    Event,
    /// Something moves at an event, or for less than its dwell everything stands still.
    EventMoves,
    /// A gripper, handle or surface that is not the SRDF's.
    Document,
    /// A held object is written where its gripper does not take it.
    ObjectOffCarrier,
    /// A placed object moves.
    PlacedObjectMoved,
    /// An object without an attachment moves.
    UnattachedObjectMoved,
    /// A joint of an object moves while no gripper holds what is beyond it.
    JointUnheld,
    /// A handle is not in its gripper.
    Grasp,
    /// A handle slips in its gripper.
    GraspConstancy,
    /// An object does not lie on its support.
    Placement,
    /// An object slides on its support.
    PlacementConstancy,
    /// A further constraint does not hold.
    Constraint,
    /// A constraint that this checker cannot prove.
    UncheckedConstraint,
    /// Two solids meet.
    Collision,
    /// Two solids come closer than their margin.
    Margin,
    /// A solid is inside a closed mesh.
    Enclosed,
    /// Free at every sample, but so close that no interval can be covered; or the work limit is reached.
    Undecided,
    /// The path tolerance is not in (0, 1e-3].
    PathTolerance,
    /// The certificate claims more than was measured.
    Certificate,
    /// Many small steps of an object or an unheld joint, each within its tolerance, that add up.
    Drift,
    /// A model file is not the one that the path was planned with.
    Model,
    /// Links that are said to be neighbours and are not.
    NotAdjacent,
    /// The file is not about the parts, documents, limits, margins or ignored pairs of its scene.
    Scene,
    /// The path does not begin at the scene's start.
    Start,
    /// The path does not end at a goal of the scene.
    Goal,
    /// A grasp or a support that the scene does not allow, or an attachment that differs from the scene.
    Holding,
    /// What the scene requires of a segment is not in the file, or does not hold.
    Demand,
}

/// How a check ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The path answers its scene, over the continuum.
    Proved,
    /// What the file says of itself holds; these are the reasons why that is less than an answer to a scene.
    Relative(Vec<String>),
    /// A promise is broken.
    Refused,
    /// No promise is known to be broken, and not all is proved within the limits of work, time or resolution.
    Undecided,
}

impl Verdict {
    /// One word, as `--json` has it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::Relative(_) => "relative",
            Self::Refused => "refused",
            Self::Undecided => "undecided",
        }
    }
}

/// A group of promises, for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Section {
    /// Grippers, handles and surfaces are the models'.
    Documents,
    /// Joint limits and bounds.
    Limits,
    /// Joint knots, quaternions, times, environments.
    Knots,
    /// Limits of rates, continuous velocities, events.
    Timing,
    /// Objects follow what carries them.
    Carriers,
    /// Grasps, placements, constraints.
    Residuals,
    /// No collision, margins kept.
    Clearance,
    /// The file's own claims.
    Certificate,
    /// The path answers its scene.
    Scene,
}

impl Section {
    /// All sections, in the order in which they are told.
    pub const ALL: [Self; 9] = [
        Self::Documents,
        Self::Limits,
        Self::Knots,
        Self::Timing,
        Self::Carriers,
        Self::Residuals,
        Self::Clearance,
        Self::Certificate,
        Self::Scene,
    ];

    /// One word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Documents => "documents",
            Self::Limits => "limits",
            Self::Knots => "knots",
            Self::Timing => "timing",
            Self::Carriers => "carriers",
            Self::Residuals => "residuals",
            Self::Clearance => "clearance",
            Self::Certificate => "certificate",
            Self::Scene => "scene",
        }
    }
}

impl Kind {
    /// The name in messages and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Limit => "limit",
            Self::FollowerLimit => "follower-limit",
            Self::ObjectBounds => "object-bounds",
            Self::SharedKnot => "shared-knot",
            Self::QuaternionNorm => "quaternion-norm",
            Self::QuaternionSign => "quaternion-sign",
            Self::EnvironmentMoves => "environment-moves",
            Self::Times => "times",
            Self::VelocityLimit => "velocity-limit",
            Self::AccelerationLimit => "acceleration-limit",
            Self::JerkLimit => "jerk-limit",
            Self::VelocityJump => "velocity-jump",
            Self::CarriedVelocity => "carried-velocity",
            Self::Event => "event",
            Self::EventMoves => "event-moves",
            Self::Document => "document",
            Self::ObjectOffCarrier => "object-off-carrier",
            Self::PlacedObjectMoved => "placed-object-moved",
            Self::UnattachedObjectMoved => "unattached-object-moved",
            Self::JointUnheld => "joint-unheld",
            Self::Grasp => "grasp",
            Self::GraspConstancy => "grasp-constancy",
            Self::Placement => "placement",
            Self::PlacementConstancy => "placement-constancy",
            Self::Constraint => "constraint",
            Self::UncheckedConstraint => "unchecked-constraint",
            Self::Collision => "collision",
            Self::Margin => "margin",
            Self::Enclosed => "enclosed",
            Self::Undecided => "undecided",
            Self::PathTolerance => "path-tolerance",
            Self::Certificate => "certificate",
            Self::Drift => "drift",
            Self::Model => "model",
            Self::NotAdjacent => "not-adjacent",
            Self::Scene => "scene",
            Self::Start => "start",
            Self::Goal => "goal",
            Self::Holding => "holding",
            Self::Demand => "demand",
        }
    }

    /// The group it belongs to.
    #[must_use]
    pub fn section(self) -> Section {
        match self {
            Self::Document | Self::Model | Self::NotAdjacent => Section::Documents,
            Self::Limit | Self::FollowerLimit | Self::ObjectBounds => Section::Limits,
            Self::SharedKnot | Self::QuaternionNorm | Self::QuaternionSign | Self::EnvironmentMoves | Self::Times => {
                Section::Knots
            }
            Self::VelocityLimit
            | Self::AccelerationLimit
            | Self::JerkLimit
            | Self::VelocityJump
            | Self::CarriedVelocity
            | Self::Event
            | Self::EventMoves => Section::Timing,
            Self::ObjectOffCarrier
            | Self::PlacedObjectMoved
            | Self::UnattachedObjectMoved
            | Self::JointUnheld
            | Self::Drift => Section::Carriers,
            Self::Grasp
            | Self::GraspConstancy
            | Self::Placement
            | Self::PlacementConstancy
            | Self::Constraint
            | Self::UncheckedConstraint => Section::Residuals,
            Self::Collision | Self::Margin | Self::Enclosed | Self::Undecided => Section::Clearance,
            Self::PathTolerance | Self::Certificate => Section::Certificate,
            Self::Scene | Self::Start | Self::Goal | Self::Holding | Self::Demand => Section::Scene,
        }
    }
}
