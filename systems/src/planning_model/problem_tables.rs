//! Tables that follow from a problem without its constraint graph: kinematics, solids and pairs, weights, locked joints.
//!
//! They take long to build (bounds of large meshes) and are apart from the model so that any number of models can share
//! them.

use crate::events::StopSignal;
use crate::planning_model::graph::snapping::snap;
use crate::planning_model::graph::support_placement::{LiftLines, lift_lines};
use crate::planning_model::hands;
use crate::planning_model::hands::FingerShares;
use foliate_components::constraint::{Constraint, Grasp, Locked, LockedValue};
use foliate_components::coverage::LeftOutPair;
use foliate_components::graph::{ConstraintKind, Opening};
use foliate_components::problem::{Approach, Correction, Goal, JointRest, Problem};
use foliate_components::robot::{JointIndex, JointType, LinkIndex, PartKind, Robot, Source};
use foliate_kernels::collision::{CollisionScene, PairRule, PairSet};
use foliate_kernels::kinematics::Kinematics;

/// What a problem says whatever of its graph is there: nearly all of it follows from the files of its models, and it is what takes
/// long. Any number of models may share it.
#[derive(Debug)]
pub struct ProblemTables {
    /// The problem; its start and goals moved onto the nearest states, as `snapped` says.
    pub problem: Problem,
    /// What of the start and the goals was a little off and was moved.
    pub snapped: Vec<Correction>,
    /// Forward kinematics.
    pub kinematics: Kinematics,
    /// Solids and pairs.
    pub collision: CollisionScene,
    /// Metres per unit of each velocity coordinate: how far the unit moves the farthest point that it moves.
    pub weights: Vec<f64>,
    /// Values that the locked joints keep, by configuration index.
    pub(crate) locked: Vec<(usize, f64)>,
    /// Numbers of the joints on which neither a grasp, a support, a constraint nor a goal depends: a head, a laser. They matter only where
    /// they are in the way.
    pub(crate) uninvolved: Vec<usize>,
    /// All joints that never move.
    still: Vec<JointIndex>,
    /// Every pair, for verdicts.
    pub(crate) all_pairs: PairSet,
    /// Where the fingers of a hand are that holds a handle, found when it is first asked for.
    pub(crate) closed: FingerShares,
    /// Where they are that approach a handle as far open as they need.
    pub(crate) ready: FingerShares,
    /// Lifts that are straight.
    lifts: LiftLines,
}

impl ProblemTables {
    /// Builds them: bounds of all shapes first.
    #[must_use]
    pub fn new(problem: Problem) -> Self {
        let still = locked_joints(&problem);
        let collision = CollisionScene::new(&problem.robot, &pair_rule(&problem, &still));
        Self::on_scene(problem, still, collision)
    }

    /// As [`Self::new`]; none once the signal is raised: to build the bounds of large meshes takes long.
    #[must_use]
    pub fn new_until(problem: Problem, stop: &StopSignal) -> Option<Self> {
        let still = locked_joints(&problem);
        let rule = pair_rule(&problem, &still);
        let collision = CollisionScene::new_while(&problem.robot, &rule, &|| !stop.is_raised())?;
        Some(Self::on_scene(problem, still, collision))
    }

    /// Those of the same problem with another start and other goals. What takes long is taken over.
    #[must_use]
    pub fn with_ends(&self, start: Vec<f64>, goals: Vec<Goal>) -> Self {
        let problem = Problem { start, goals, ..self.problem.clone() };
        Self::on_scene(problem, self.still.clone(), self.collision.clone())
    }

    fn on_scene(mut problem: Problem, still: Vec<JointIndex>, collision: CollisionScene) -> Self {
        let kinematics = Kinematics::new(&problem.robot);
        let snapped = snap(&mut problem, &kinematics);
        problem.graph.hands = hands::complete(&problem, &still, &kinematics, &collision);
        let [closed, ready] = [hands::shares(&problem), hands::shares(&problem)];
        let robot = &problem.robot;
        Self {
            snapped,
            closed,
            ready,
            lifts: lift_lines(&problem.robot, &problem.graph),
            uninvolved: uninvolved_joints(&problem),
            kinematics,
            weights: coordinate_weights(robot),
            locked: locked_coordinates(&problem),
            all_pairs: PairSet::new(&collision, &[], &[]),
            collision,
            still,
            problem,
        }
    }

    /// The pairs of shapes that are never tested, with the reason.
    #[must_use]
    pub fn left_out(&self) -> Vec<LeftOutPair> {
        self.collision.left_out(&self.problem.robot, &pair_rule(&self.problem, &self.still))
    }

    /// Where the fingers of a hand are in a configuration.
    pub fn finger_coordinates(&self, hand: u32) -> impl Iterator<Item = usize> + '_ {
        let fingers = self.problem.graph.hands.get(hand as usize).into_iter().flat_map(|hand| &hand.fingers);
        fingers.filter_map(|finger| hands::coordinate(&self.problem.robot, finger.joint))
    }

    /// The value of a finger at an opening of its hand; `None` of a hand, finger or grasp that the problem does not have.
    #[must_use]
    pub fn finger_value(&self, hand: u32, finger: u32, opening: Opening) -> Option<f64> {
        let hand = self.problem.graph.hands.get(hand as usize)?;
        let record = hand.fingers.get(finger as usize)?;
        let tables = (&self.problem, &self.kinematics, &self.collision);
        match opening {
            Opening::Travel => record.travel,
            Opening::Wide => Some(record.open),
            Opening::Closed { gripper, handle } => {
                let closing = || hands::closing(tables, hand, (gripper, handle));
                let shares = self.closed.get(&(gripper, handle))?.get_or_init(closing);
                Some(record.at(*shares.get(finger as usize)?))
            }
            Opening::Ready { gripper, handle } => {
                let Approach::AsNeeded { clearance } = self.problem.graph.approach else { return Some(record.open) };
                let ready = || hands::ready(tables, hand, (gripper, handle), clearance);
                let shares = self.ready.get(&(gripper, handle))?.get_or_init(ready);
                Some(record.at(*shares.get(finger as usize)?))
            }
        }
    }

    /// A constraint of the problem's own, or a joint's rest, as kernels know it; parameter rows name slot 0.
    #[must_use]
    pub fn constraint_of(&self, kind: ConstraintKind) -> Option<Constraint> {
        let options = &self.problem.graph;
        match kind {
            ConstraintKind::Given { constraint } | ConstraintKind::WhileHeld { constraint } => {
                options.constraints.get(constraint as usize).map(|given| given.constraint.clone())
            }
            ConstraintKind::Approach { gripper, handle, bound } => {
                let line = options.line_to(gripper, handle)?;
                let grasp = Grasp::new(&self.problem.robot, gripper, handle).ok()?;
                grasp.approach(bound, line.distance, line.angle)
            }
            ConstraintKind::Lift { object, on } => self.lifts.get(&(object, on)).copied().map(Constraint::RelativePose),
            ConstraintKind::JointRest { joint } => options.resting_joints.get(joint as usize).map(|resting| {
                let value = match resting.rest {
                    JointRest::Stays => LockedValue::Argument(0),
                    JointRest::At(value) => LockedValue::Fixed(value),
                };
                Constraint::Locked(Locked { joint: resting.joint, value })
            }),
            ConstraintKind::Finger { hand, finger, opening } => {
                let joint = options.hands.get(hand as usize)?.fingers.get(finger as usize)?.joint;
                let value = LockedValue::Fixed(self.finger_value(hand, finger, opening)?);
                Some(Constraint::Locked(Locked { joint, value }))
            }
            _ => None,
        }
    }
}

/// Which pairs are tested: as the problem says, which names neighbours too.
fn pair_rule<'a>(problem: &'a Problem, still: &'a [JointIndex]) -> PairRule<'a> {
    PairRule { ignored: &problem.ignored_pairs, margins: &problem.margins, locked: still }
}

/// See [`ProblemTables::uninvolved`]. None in a problem that moves no objects and has no constraints: there the motion is all.
fn uninvolved_joints(problem: &Problem) -> Vec<usize> {
    let (robot, options) = (&problem.robot, &problem.graph);
    let joints = &robot.joints;
    let link_of = |link: LinkIndex| robot.links[link.at()].joint;
    let grippers = options.grippers.iter().map(|gripper| link_of(robot.grippers[gripper.at()].link));
    let supports = options.supports.iter().map(|support| link_of(robot.surfaces[support.at()].link));
    let constraints = options.constraints.iter().flat_map(|given| given.constraint.bodies());
    let partial = problem.goals.iter().filter_map(|goal| match goal {
        Goal::Partial(goal) => Some(goal),
        Goal::Configuration(_) => None,
    });
    let goals = partial.flat_map(|goal| &goal.constraints).flat_map(|given| given.constraint.bodies());
    if options.grippers.is_empty() && options.constraints.is_empty() {
        return Vec::new();
    }
    let mut is_involved = vec![false; joints.len()];
    for body in grippers.chain(supports).chain(constraints).chain(goals) {
        for joint in std::iter::successors(body, |body| joints[body.at()].parent) {
            is_involved[joint.at()] = true;
            if let Source::Follows { leader, .. } = joints[joint.at()].source {
                is_involved[leader.at()] = true;
            }
        }
    }
    let is_wanted_elsewhere = |q: usize| {
        problem.goals.iter().any(|goal| match goal {
            Goal::Configuration(goal) => goal.get(q) != problem.start.get(q),
            Goal::Partial(goal) => {
                let near = goal.near.iter().map(|&(index, ..)| index);
                goal.coordinates.iter().map(|&(index, _)| index).chain(near).any(|index| index == q)
            }
        })
    };
    let of_robots = joints.iter().enumerate().filter(|(index, joint)| {
        !is_involved[*index] && robot.parts[joint.part.at()].kind == PartKind::Robot && !joint.is_immovable()
    });
    let numbers = of_robots.filter_map(|(_, joint)| match joint.source {
        Source::Coordinates { q, .. } if joint.motion.configuration_size() == 1 => Some(q),
        _ => None,
    });
    numbers.filter(|&q| !is_wanted_elsewhere(q)).collect()
}

/// Joints that never move: those that the problem locks, and those between equal bounds.
fn locked_joints(problem: &Problem) -> Vec<JointIndex> {
    let all = (0..problem.robot.joints.len() as u32).map(JointIndex);
    let named = |joint: JointIndex| problem.graph.locked.iter().any(|&(locked, _)| locked == joint);
    all.filter(|&joint| named(joint) || problem.robot.joints[joint.at()].is_immovable()).collect()
}

fn locked_coordinates(problem: &Problem) -> Vec<(usize, f64)> {
    let coordinate = |&(joint, value): &(JointIndex, f64)| match problem.robot.joints[joint.at()].source {
        Source::Coordinates { q, .. } => Some((q, value)),
        Source::Follows { .. } => None,
    };
    problem.graph.locked.iter().filter_map(coordinate).collect()
}

/// For each velocity coordinate the reach of what it moves: chain lengths beyond the joint plus the radius of the shapes,
/// at least a centimetre; 1 for translations.
fn coordinate_weights(robot: &Robot) -> Vec<f64> {
    let mut reach = vec![0.01_f64; robot.joints.len()];
    for shape in &robot.shapes {
        let Some(joint) = robot.links[shape.link.at()].joint else { continue };
        let far = shape.joint_from_shape.translation.length() + shape.geometry.radius_about_origin();
        reach[joint.at()] = reach[joint.at()].max(far);
    }
    // Children stand behind their parents, so one backward pass reaches the roots.
    for index in (0..robot.joints.len()).rev() {
        let joint = &robot.joints[index];
        if let Some(parent) = joint.parent {
            let beyond = reach[index] + joint.parent_from_joint.translation.length();
            reach[parent.at()] = reach[parent.at()].max(beyond);
        }
    }
    let mut weights = vec![1.0; robot.space.dimension()];
    for (joint, reach) in robot.joints.iter().zip(reach) {
        use foliate_components::robot::JointType;
        let Source::Coordinates { v, .. } = joint.source else { continue };
        match joint.motion {
            JointType::Revolute { .. } => weights[v] = reach,
            JointType::Prismatic { .. } => {}
            JointType::Planar => weights[v + 2] = reach,
            JointType::FreeFlyer => weights[v + 3..v + 6].fill(reach),
        }
    }
    weights
}

/// A root, or a planar or floating joint of a model, that moves along an axis without bounds.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{joint}` moves along {axis} without bounds ([{}, {}]): give it bounds (in a scene `root_bounds`; of a joint inside a model `joint_bounds`), or lock it", bounds.0, bounds.1)]
#[non_exhaustive]
pub struct UnboundedRoot {
    /// The root joint.
    pub joint: String,
    /// `x`, `y` or `z`.
    pub axis: &'static str,
    /// Its bounds, metres.
    pub bounds: (f64, f64),
}

/// Why configurations cannot be drawn evenly: a root that moves along an axis without bounds. There is no uniform draw from
/// all of space, and a guess about the reach of a mobile base would be wrong somewhere.
///
/// # Errors
/// The root and the axis.
pub(crate) fn bounded_roots(robot: &Robot) -> Result<(), UnboundedRoot> {
    for joint in &robot.joints {
        let axes: &[&'static str] = match joint.motion {
            JointType::Planar => &["x", "y"],
            JointType::FreeFlyer => &["x", "y", "z"],
            JointType::Revolute { .. } | JointType::Prismatic { .. } => continue,
        };
        for (axis, (low, high)) in axes.iter().zip(joint.lower.iter().zip(&joint.upper)) {
            if !(low.is_finite() && high.is_finite()) {
                let bounds = (*low, *high);
                return Err(UnboundedRoot { joint: joint.name.clone(), axis, bounds });
            }
        }
    }
    Ok(())
}
