//! Which states a configuration is near to: what holds in each of them is off by little.

use crate::planning_model::graph::states::state_keys::{Documents, StateKey, StateKeys, grasp_sets};
use crate::planning_model::graph::support_placement::{PlacementOnSupport, SupportPlacement};
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Locked, LockedValue, RelativePose};
use foliate_components::graph::{ConstraintKind, Fingers};
use foliate_components::problem::{JointRest, Problem};
use foliate_components::robot::JointIndex;
use foliate_kernels::constraints::{self, placement, placement_of, relative_pose};
use foliate_kernels::kinematics::Kinematics;

/// Off by less than this a constraint holds, metres and radians: what classification asks.
pub(super) const ON: f64 = 1e-4;
/// Most states that are compared.
const MOST: usize = 256;

/// How near a state has to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Reach {
    /// Its constraints hold.
    On,
    /// Each is off by at most so many times the tolerance.
    Within(f64),
}

/// A problem, to be asked for the states near a configuration.
#[derive(Clone, Debug)]
pub(super) struct Nearby<'a> {
    pub problem: &'a Problem,
    pub kinematics: &'a Kinematics,
    documents: Documents,
    /// By object: where it may rest, by body.
    resting: Vec<Vec<PlacementOnSupport>>,
}

impl<'a> Nearby<'a> {
    /// `None` where the documents make no graph, which is told where the model is built.
    pub fn new(problem: &'a Problem, kinematics: &'a Kinematics) -> Option<Self> {
        let documents = Documents::new(problem).ok()?;
        let (robot, options) = (&problem.robot, &problem.graph);
        let resting = options.objects.iter().map(|object| PlacementOnSupport::of_object(robot, options, object));
        Some(Self { problem, kinematics, documents, resting: resting.collect::<Result<_, _>>().ok()? })
    }

    pub fn state_keys(&self) -> StateKeys<'_> {
        StateKeys::new(self.problem, &self.documents)
    }

    /// Where the bodies are.
    pub fn poses(&self, q: &[f64]) -> Vec<Pose> {
        self.kinematics.poses(q)
    }

    /// The root that moves an object, and its number among the objects.
    pub fn roots(&self) -> impl Iterator<Item = (usize, JointIndex)> + '_ {
        let keys = self.state_keys();
        (0..self.problem.graph.objects.len()).filter_map(move |object| Some((object, keys.root(object)?)))
    }

    /// Where an object may rest.
    pub fn resting(&self, object: usize) -> &[PlacementOnSupport] {
        &self.resting[object]
    }

    pub fn place(&self, object: u32, on: Option<JointIndex>) -> Option<&PlacementOnSupport> {
        self.resting[object as usize].iter().find(|place| place.on == on)
    }

    /// The states in reach, those with fewer grasps first; `None` where there are too many to compare.
    pub fn states(&self, X_WJ: &[Pose], reach: Reach) -> Option<Vec<StateKey>> {
        let (keys, options) = (self.state_keys(), &self.problem.graph);
        let grasped = |gripper, handle| self.is_near(ConstraintKind::Grasp { gripper, handle }, X_WJ, reach);
        let lies =
            |object: usize, on| self.is_near(ConstraintKind::Placement { object: object as u32, on }, X_WJ, reach);
        let mut found = Vec::new();
        for grasps in grasp_sets(options, grasped, MOST)? {
            for lying in keys.ways_to_lie(&grasps, lies, MOST)? {
                let state = |written| StateKey {
                    written,
                    grasps: grasps.clone(),
                    lying: lying.clone(),
                    fingers: Fingers::Still,
                };
                found.extend((0..options.states.len().max(1)).map(state));
                if found.len() > MOST {
                    return None;
                }
            }
        }
        Some(found)
    }

    /// What holds in a state, fingers aside: hands may be open as far as they like where a path begins and ends.
    pub fn manifold(&self, state: &StateKey) -> Vec<ConstraintKind> {
        let mut manifold = self.state_keys().manifold(state);
        manifold.retain(|kind| !matches!(kind, ConstraintKind::Finger { .. }));
        manifold
    }

    /// Whether a configuration lies in a state.
    pub fn is_on_one(&self, q: &[f64], X_WJ: &[Pose]) -> bool {
        let holds = |kind: &ConstraintKind| self.residual(*kind, q, X_WJ) <= ON;
        let states = self.states(X_WJ, Reach::On);
        states.is_some_and(|states| states.iter().any(|state| self.manifold(state).iter().all(holds)))
    }

    /// What a constraint of the graph asks, parameters aside; `None` where nothing.
    pub fn constraint(&self, kind: ConstraintKind) -> Option<Constraint> {
        let options = &self.problem.graph;
        match kind {
            ConstraintKind::Grasp { gripper, handle } => {
                Some(Constraint::RelativePose(self.documents.grasps.get(&(gripper, handle))?.constraint()))
            }
            ConstraintKind::Placement { object, on } => Some(self.place(object, on)?.resting.constraint(0.0)),
            ConstraintKind::JointRest { joint } => {
                let resting = options.resting_joints.get(joint as usize)?;
                let JointRest::At(value) = resting.rest else { return None };
                Some(Constraint::Locked(Locked { joint: resting.joint, value: LockedValue::Fixed(value) }))
            }
            ConstraintKind::Given { constraint } | ConstraintKind::WhileHeld { constraint } => {
                options.constraints.get(constraint as usize)?.constraint.without_parameters()
            }
            _ => None,
        }
    }

    /// The largest row of a constraint's error, metres and radians.
    pub fn residual(&self, kind: ConstraintKind, q: &[f64], X_WJ: &[Pose]) -> f64 {
        match kind {
            ConstraintKind::Placement { object, on } => {
                self.place(object, on).map_or(f64::INFINITY, |place| place.resting.residual(0.0, X_WJ))
            }
            kind => {
                let given = self.constraint(kind);
                given.map_or(0.0, |given| constraints::residual(&self.problem.robot, &given, q, X_WJ))
            }
        }
    }

    /// Whether a grasp or a placement is in reach. What is in reach by this may turn out not to be: whether a correction is within
    /// the tolerance is measured at the object's root, and known once it is made.
    pub fn is_near(&self, kind: ConstraintKind, X_WJ: &[Pose], reach: Reach) -> bool {
        let Reach::Within(factor) = reach else { return self.residual(kind, &[], X_WJ) <= ON };
        let Some((distance, angle, lever)) = self.off(kind, X_WJ) else { return false };
        let most = self.problem.start_tolerance;
        let (farthest, turn) = (factor * most.distance.max(ON), factor * most.angle.max(ON));
        // A turn about the root moves a frame that is a lever away from it.
        angle <= turn && distance <= farthest + lever * turn
    }

    /// How far a grasp or a placement is off, metres and radians, and how far the frame that is compared is from the object's root,
    /// metres.
    fn off(&self, kind: ConstraintKind, X_WJ: &[Pose]) -> Option<(f64, f64, f64)> {
        match kind {
            ConstraintKind::Grasp { gripper, handle } => {
                let grasp = self.documents.grasps.get(&(gripper, handle))?;
                let (distance, angle) = rows_off(&grasp.constraint(), X_WJ);
                Some((distance, angle, grasp.handle.joint_from_frame.translation.length()))
            }
            ConstraintKind::Placement { object, on } => match &self.place(object, on)?.resting {
                SupportPlacement::Surfaces(lying) => {
                    let contact = placement::contact(lying, X_WJ);
                    let [x, _, _, turn_y, turn_z] = placement::value(lying, contact, X_WJ);
                    let lever = lying.object[contact.object].frame.joint_from_frame.translation.length();
                    let aside = placement::aside(lying, contact, X_WJ);
                    Some((x.hypot(aside), turn_y.hypot(turn_z), lever))
                }
                plane @ SupportPlacement::Plane { frame, .. } => {
                    let Constraint::RelativePose(pose) = plane.constraint(0.0) else { return None };
                    let (distance, angle) = rows_off(&pose, X_WJ);
                    Some((distance, angle, frame.joint_from_frame.translation.length()))
                }
            },
            _ => None,
        }
    }
}

/// How far the rows that a relative pose holds are off: metres and radians.
fn rows_off(pose: &RelativePose, X_WJ: &[Pose]) -> (f64, f64) {
    let (a, b) = (placement_of(&pose.a), placement_of(&pose.b));
    let value = relative_pose::value(&a, &b, &Pose::identity(), X_WJ);
    let held = |rows: std::ops::Range<usize>| {
        let squares = rows.filter(|&row| pose.rows[row].is_some()).map(|row| value[row] * value[row]);
        squares.sum::<f64>().sqrt()
    };
    (held(0..3), held(3..6))
}
