//! Objects that a start or a goal has a little off their support are moved onto it: models and measurements are exact to fractions
//! of a millimetre, and constraints to far less.
//!
//! An object is moved along the normal of its support and tilted, not along it; by so little that no corner of the polygon that
//! touches moves by more than a millimetre. What is farther off stays where it is, and is refused by the constraint that it breaks.

use crate::planning_model::graph::attachment_order::{grasp_of, root_of};
use crate::planning_model::graph::support_placement::{PlacementOnSupport, SupportPlacement, relative_pose_residual};
use foliate_components::Pose;
use foliate_components::infeasibility::OffSupport;
use foliate_components::pose::pose_to_array;
use foliate_components::problem::{Goal, ObjectOptions, Problem};
use foliate_components::robot::{JointIndex, PartIndex, Source};
use foliate_kernels::constraints::placement;
use foliate_kernels::kinematics::Kinematics;
use glam::DVec3;
use std::fmt;

/// Off by less than this an object is on its support, metres and radians.
const ON: f64 = 1e-4;
/// Most that a corner is moved, metres, up to rounding.
const FARTHEST: f64 = 1e-3 + 1e-9;
/// Most that an object is tilted, radians.
const MOST_TILT: f64 = 1e-2;

/// An object that was moved onto its support.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Snapped {
    /// Number of the goal; `None` for the start.
    pub goal: Option<usize>,
    /// The object.
    pub object: PartIndex,
    /// Its name.
    pub name: String,
    /// How far off its support it was.
    pub off: OffSupport,
}

impl fmt::Display for Snapped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.goal {
            None => f.write_str("the start")?,
            Some(goal) => write!(f, "goal {goal}")?,
        }
        write!(f, " has `{}` {}: it is moved onto it", self.name, self.off)
    }
}

/// Moves the objects of the start and the goals that are a little off their support onto it, and says which.
///
/// A goal of poses is moved onto what is fixed in the world, for nothing else is known to stand anywhere.
pub(crate) fn snap(problem: &mut Problem, kinematics: &Kinematics) -> Vec<Snapped> {
    let lying: Vec<Lying> = problem.graph.objects.iter().filter_map(|object| Lying::of(problem, object)).collect();
    let mut snapped = Vec::new();
    if lying.is_empty() || problem.start.len() != problem.robot.space.size() {
        return snapped;
    }
    let mut start = problem.start.clone();
    snap_all(problem, kinematics, &lying, None, &mut start, &mut snapped);
    let mut goals = problem.goals.clone();
    for (number, goal) in goals.iter_mut().enumerate() {
        match goal {
            Goal::Configuration(q) if q.len() == problem.robot.space.size() => {
                snap_all(problem, kinematics, &lying, Some(number), q, &mut snapped);
            }
            Goal::Configuration(_) => {}
            Goal::Partial(partial) => {
                let mut X_WJ = poses(kinematics, &start);
                for (part, pose) in &mut partial.poses {
                    let Some(object) = lying.iter().find(|object| object.part == *part) else { continue };
                    X_WJ[object.root.at()] = *pose;
                    if let Some((off, moved)) = object.moved(&X_WJ, &|place| place.on.is_none()) {
                        *pose = moved;
                        snapped.push(object.told(problem, Some(number), off));
                    }
                }
            }
        }
    }
    problem.start = start;
    problem.goals = goals;
    snapped
}

/// Moves what lies a little off its support in one configuration.
fn snap_all(
    problem: &Problem,
    kinematics: &Kinematics,
    lying: &[Lying],
    goal: Option<usize>,
    q: &mut [f64],
    snapped: &mut Vec<Snapped>,
) {
    if q.iter().any(|x| !x.is_finite()) {
        return;
    }
    // What lies on an object is moved after it, whichever is named first.
    for _ in 0..lying.len().min(2) {
        for object in lying {
            let X_WJ = poses(kinematics, q);
            if object.is_held(problem, &X_WJ) {
                continue;
            }
            let Some((off, moved)) = object.moved(&X_WJ, &|_| true) else { continue };
            let Source::Coordinates { q: first, .. } = problem.robot[object.root].source else { continue };
            q[first..first + 7].copy_from_slice(&pose_to_array(&moved));
            snapped.push(object.told(problem, goal, off));
        }
    }
}

fn poses(kinematics: &Kinematics, q: &[f64]) -> Vec<Pose> {
    let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
    kinematics.forward(q, &mut X_WJ);
    X_WJ
}

/// An object that lies on surfaces.
struct Lying {
    part: PartIndex,
    root: JointIndex,
    resting: Vec<PlacementOnSupport>,
    options: ObjectOptions,
}

impl Lying {
    fn of(problem: &Problem, object: &ObjectOptions) -> Option<Self> {
        let root = root_of(&problem.robot, object.part)?;
        // What makes no placement is told where the model is built.
        let resting = PlacementOnSupport::of_object(&problem.robot, &problem.graph, object).ok()?;
        let on_root = |place: &PlacementOnSupport| match &place.resting {
            SupportPlacement::Surfaces(lying) => lying.object_joint() == Some(root),
            SupportPlacement::Plane { .. } => false,
        };
        let resting: Vec<_> = resting.into_iter().filter(on_root).collect();
        (!resting.is_empty()).then(|| Self { part: object.part, root, resting, options: object.clone() })
    }

    fn told(&self, problem: &Problem, goal: Option<usize>, off: OffSupport) -> Snapped {
        Snapped { goal, object: self.part, name: problem.robot[self.part].name.clone(), off }
    }

    /// Whether a gripper holds it: then it is where the hand has it.
    fn is_held(&self, problem: &Problem, X_WJ: &[Pose]) -> bool {
        let grippers = problem.graph.grippers.iter();
        let mut pairs = grippers.flat_map(|&gripper| self.options.handles.iter().map(move |&handle| (gripper, handle)));
        pairs.any(|(gripper, handle)| {
            grasp_of(problem, gripper, handle)
                .is_ok_and(|grasp| relative_pose_residual(&grasp.constraint(), X_WJ) <= ON)
        })
    }

    /// How far off the nearest support it is, and its pose on it; `None` where it lies on one, or is too far off all of them.
    fn moved(&self, X_WJ: &[Pose], may: &dyn Fn(&PlacementOnSupport) -> bool) -> Option<(OffSupport, Pose)> {
        let places = self.resting.iter().filter(|place| may(place));
        let off = places.map(|place| (place.resting.residual(0.0, X_WJ), place));
        let (residual, place) = off.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let SupportPlacement::Surfaces(lying) = &place.resting else { return None };
        let contact = placement::contact(lying, X_WJ);
        let off = place.resting.off(X_WJ)?;
        if residual <= ON || !contact.inside || off.tilt > MOST_TILT {
            return None;
        }
        let (carrier, X_CO) = place.resting.exact(self.root, X_WJ)?;
        let moved = carrier.map_or(Pose::identity(), |carrier| X_WJ[carrier.at()]) * X_CO;
        let polygon = &lying.object[contact.object];
        let farthest = polygon.vertices.iter().map(|vertex| {
            let corner = polygon.frame.joint_from_frame.transform_point(DVec3::new(0.0, vertex.x, vertex.y));
            moved.transform_point(corner).distance(X_WJ[self.root.at()].transform_point(corner))
        });
        (farthest.fold(0.0, f64::max) <= FARTHEST).then_some((off, moved))
    }
}
