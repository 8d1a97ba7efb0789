//! A manipulation problem (P0 §II-E): the hybrid robot, who may hold what and where things may lie, a start and goals.

use crate::Pose;
use crate::constraint::rests::Rests;
use crate::problem::cost::CostOptions;
use crate::problem::goal::{Goal, NamedConstraint, PartialGoal};
use crate::problem::hand::{Approach, Hand};
use crate::problem::start_tolerance::StartTolerance;
use crate::problem::timing::TimingOptions;
use crate::robot::error::CoordinateError;
use crate::robot::hybrid_robot::{DisabledPair, Robot};
use crate::robot::indices::{GripperIndex, HandleIndex, JointIndex, LinkIndex, PartIndex, SurfaceIndex};
use crate::robot::joint::CoordinateValue;

/// The usual [`Problem::projection_tolerance`], and the least.
pub const PROJECTION_TOLERANCE: f64 = 1e-6;

/// Everything that defines a problem; how it is searched is not part of it.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Name, for output.
    pub name: String,
    /// The hybrid robot.
    pub robot: Robot,
    /// What the constraint graph is built from.
    pub graph: GraphOptions,
    /// Pairs of links that are not tested for collision besides the SRDFs': the scene's `ignore`, and in parts without an SRDF
    /// usually links that one joint joins and that touch wherever it is.
    pub ignored_pairs: Vec<DisabledPair>,
    /// Minimum distances between links, metres; 0 where none is given. They do not apply to a pair that touches by grasp or placement.
    pub margins: Vec<Margin>,
    /// The start: a whole configuration.
    pub start: Vec<f64>,
    /// How far the start and the goals may be off a state: within it they are moved onto the nearest.
    pub start_tolerance: StartTolerance,
    /// Residual at which grasps, placements and other constraints count as met where a motion begins or ends, metres and radians (largest
    /// row). Searches use at least this. Robots whose axes are not exactly parallel or square meet some grasps no closer.
    pub projection_tolerance: f64,
    /// At least one goal; reaching any of them solves the problem.
    pub goals: Vec<Goal>,
    /// Poses in the world of movable objects' root links that may help on the way: each is laid onto the nearest support, and
    /// searches try to put the object down there. They are never needed and never trusted.
    pub suggestions: Vec<(PartIndex, Pose)>,
    /// How fast joints may move, and how long hands take.
    pub timing: TimingOptions,
    /// What a path costs.
    pub cost: CostOptions,
}

impl Problem {
    /// A problem with a goal; nothing is margin or left out, and timing and cost are the usual ones. The rest can be set on it.
    #[must_use]
    pub fn new(name: impl Into<String>, robot: Robot, start: Vec<f64>, goals: Vec<Goal>) -> Self {
        Self {
            name: name.into(),
            robot,
            graph: GraphOptions::default(),
            ignored_pairs: Vec::new(),
            margins: Vec::new(),
            start,
            start_tolerance: StartTolerance::default(),
            projection_tolerance: PROJECTION_TOLERANCE,
            goals,
            suggestions: Vec::new(),
            timing: TimingOptions::default(),
            cost: CostOptions::default(),
        }
    }

    /// Sets where one joint or part starts, by name; see [`Robot::set`].
    ///
    /// # Errors
    /// As [`Robot::set`].
    ///
    /// # Panics
    /// If the start is shorter than a configuration.
    pub fn set_start(&mut self, name: &str, value: impl Into<CoordinateValue>) -> Result<(), CoordinateError> {
        self.robot.set(&mut self.start, name, value)
    }

    /// A goal that says where some joints and parts shall be, by name as for [`Robot::set`], and leaves everything else free.
    ///
    /// # Errors
    /// As [`Robot::set`].
    pub fn partial_goal<'a>(
        &self,
        coordinates: impl IntoIterator<Item = (&'a str, CoordinateValue)>,
    ) -> Result<Goal, CoordinateError> {
        let mut goal = PartialGoal::default();
        let mut q = self.robot.space.neutral();
        for (name, value) in coordinates {
            self.robot.set(&mut q, name, value)?;
            let (first, joint) = self.robot.coordinates_of(name)?;
            let is_object = |o: &&ObjectOptions| {
                let root = self.robot[o.part].root_joint;
                root.is_some_and(|root| self.robot[root].name == joint.name)
            };
            match (value, self.graph.objects.iter().find(is_object)) {
                (CoordinateValue::Pose(pose), Some(object)) => goal.poses.push((object.part, pose)),
                _ => {
                    let last = first + joint.motion.configuration_size();
                    goal.coordinates.extend((first..last).map(|index| (index, q[index])));
                }
            }
        }
        Ok(Goal::Partial(goal))
    }
}

/// A minimum distance between two links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// One link.
    pub first: LinkIndex,
    /// The other.
    pub second: LinkIndex,
    /// Metres.
    pub distance: f64,
}

/// What the constraint graph is built from (P1 §II-A).
#[derive(Clone, Debug, Default)]
pub struct GraphOptions {
    /// Grippers that may hold something, in the order that names states.
    pub grippers: Vec<GripperIndex>,
    /// Objects that may be moved.
    pub objects: Vec<ObjectOptions>,
    /// Surfaces that may carry objects.
    pub supports: Vec<SurfaceIndex>,
    /// Which grasps may occur; `None` allows all (P1: the grasp–placement table).
    pub grasps: Option<Vec<(GripperIndex, HandleIndex)>>,
    /// Rules on whole states; a state is allowed if the first rule that applies to it says so. Without rules all are.
    pub rules: Vec<Rule>,
    /// Gap between an object's surface and its support, metres.
    pub placement_margin: f64,
    /// How objects with surfaces must lie on their supports. Planes have no edge: it says nothing of objects that stand on one.
    pub rests: Rests,
    /// How far an object is lifted along the support's normal before it is carried away, metres; 0 for no such waypoint.
    pub preplacement_distance: f64,
    /// Joints that never move, with their values.
    pub locked: Vec<(JointIndex, f64)>,
    /// Joints of articulated parts (doors, drawers, lids) that move only while a handle beyond them is held.
    pub resting_joints: Vec<RestingJoint>,
    /// Hands that open and close. Grippers that are not named here get theirs from the structure of the robot.
    pub hands: Vec<Hand>,
    /// How far hands open to approach.
    pub approach: Approach,
    /// How straight grippers go from a pregrasp to a grasp, and back; `None` for as they like.
    pub approach_line: Option<ApproachLine>,
    /// Grippers that go otherwise than [`Self::approach_line`] says, each once.
    pub gripper_lines: Vec<(GripperIndex, Option<ApproachLine>)>,
    /// Handles to which all grippers go so, whatever else is said of the grippers; each once.
    pub handle_lines: Vec<(HandleIndex, Option<ApproachLine>)>,
    /// How objects leave their supports and come back to them, as far as [`Self::preplacement_distance`].
    pub lift: Lift,
    /// Constraints of the problem's own; what follows names them by number. Parameter rows name slot 0.
    pub constraints: Vec<NamedConstraint>,
    /// Those of them that hold in every state: feet that stand still, balance.
    pub everywhere: Vec<u32>,
    /// Constraints that hold while a gripper holds an object. They have no parameters.
    pub while_held: Vec<WhileHeld>,
    /// States of the problem's own, such as the stances of a walking robot. Every state of the graph is one of them
    /// together with a map of grasps; without any there is one without constraints.
    pub states: Vec<WrittenState>,
    /// How the states of the problem's own follow one another.
    pub transitions: Vec<WrittenTransition>,
}

/// How far a gripper may be off the line from a pregrasp to its grasp, where the handle makes it one: it leaves no rotation free but the one
/// about the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApproachLine {
    /// Along y and along z of the handle, metres.
    pub distance: f64,
    /// Between the axes of gripper and handle, radians, as a [`Tilt`](crate::constraint::Tilt) has it.
    pub angle: f64,
}

/// How an object moves between its support and the height at which it is carried away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lift {
    /// As the joints make it.
    #[default]
    Free,
    /// On a line along the normal of the support, and without turning.
    Straight,
}

/// Constraints that hold in every state in which a gripper holds an object: it stays upright, or below a height.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WhileHeld {
    /// The object.
    pub object: PartIndex,
    /// Numbers of [`GraphOptions::constraints`].
    pub constraints: Vec<u32>,
}

/// A joint of one coordinate that moves only while a gripper holds a handle beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestingJoint {
    /// The joint.
    pub joint: JointIndex,
    /// Where it is while no handle beyond it is held.
    pub rest: JointRest,
}

/// Where a joint is while no gripper holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointRest {
    /// Wherever it was left: its value foliates the states in which it rests.
    Stays,
    /// At this value, a door that must be shut: radians or metres.
    At(f64),
}

/// A state of the problem's own.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenState {
    /// For output and errors.
    pub name: String,
    /// What holds in it besides [`GraphOptions::everywhere`]: numbers of [`GraphOptions::constraints`].
    pub constraints: Vec<u32>,
}

/// A way from one of the problem's own states to another (or the same).
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenTransition {
    /// For output and errors.
    pub name: String,
    /// Number of the state that is left.
    pub from: u32,
    /// Number of the state that is reached.
    pub to: u32,
    /// Its legs, in order; without any there is one, in `from`, that ends where all constraints of `to` hold.
    pub legs: Vec<WrittenLeg>,
}

/// A motion within one of the problem's own states, up to a waypoint.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenLeg {
    /// Number of the state in which it lies.
    pub within: u32,
    /// What holds at its end besides the constraints of the state: numbers of [`GraphOptions::constraints`].
    pub until: Vec<u32>,
    /// Whether its end is looked for near its start instead of anywhere.
    pub short: bool,
}

/// A movable object's documents.
#[derive(Clone, Debug)]
pub struct ObjectOptions {
    /// The part.
    pub part: PartIndex,
    /// Handles by which it may be held.
    pub handles: Vec<HandleIndex>,
    /// Surfaces on which it may lie.
    pub surfaces: Vec<SurfaceIndex>,
    /// A plane on which it may stand instead. Without surfaces and plane it stays where it is while no gripper holds it.
    pub plane: Option<RestingPlane>,
}

/// A placement without polygons: a frame of the object keeps its height over a plane and its z axis along the plane's
/// normal; it may slide and turn about that axis (HPP's hand-written placements: rows z, rx, ry; complement x, y, rz).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestingPlane {
    /// The plane's frame in the world; z is its normal, pointing up out of the support.
    pub world_from_plane: Pose,
    /// The frame of the object, in its root link, that coincides with a frame in the plane at rest.
    pub object_from_frame: Pose,
    /// The link whose top the plane is, fixed in the world: an object at rest touches it, so margins between the two do not
    /// apply. `None` where the object stands free.
    pub on: Option<LinkIndex>,
}

/// Says whether states may occur in which the named grippers hold the named handles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rule {
    /// For each mentioned gripper the handle that it holds in the states the rule is about; `None` for an empty hand.
    pub grasps: Vec<(GripperIndex, Option<HandleIndex>)>,
    /// Whether such states are allowed.
    pub allowed: bool,
}
