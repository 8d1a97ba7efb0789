//! The start and the goals of a problem are moved onto the states that are nearest to them, and what is moved is reported.

use crate::planning_model::graph::snapping::correction::{Corrected, poses_apart};
use crate::planning_model::graph::snapping::nearby::{Nearby, ON, Reach};
use crate::planning_model::graph::states::state_keys::StateKey;
use crate::planning_model::graph::support_placement::{PlacementOnSupport, SupportPlacement};
use foliate_components::Pose;
use foliate_components::pose::{pose_from_array, pose_to_array};
use foliate_components::problem::{Correction, Goal, Holding, Moved, PartialGoal, Problem};
use foliate_components::robot::{JointIndex, JointType, PartIndex, Robot, Source};
use foliate_kernels::constraints::placement;
use foliate_kernels::kinematics::Kinematics;

/// Most of a joint's range by which it may be outside, besides the tolerance.
const OF_RANGE: f64 = 1e-3;

/// Moves the start and the goals of a problem that are within [`Problem::start_tolerance`] of a state onto the nearest, and says what
/// was moved. What lies in a state already, and what is farther off, stays as it is.
pub(crate) fn snap(problem: &mut Problem, kinematics: &Kinematics) -> Vec<Correction> {
    let fits = |q: &[f64]| q.len() == problem.robot.space.size() && q.iter().all(|x| x.is_finite());
    if problem.start_tolerance.is_none() || !fits(&problem.start) {
        return Vec::new();
    }
    let mut corrections = Vec::new();
    let mut start = problem.start.clone();
    clamp(problem, None, &mut start, &mut corrections);
    let mut goals = problem.goals.clone();
    for (number, goal) in goals.iter_mut().enumerate() {
        match goal {
            Goal::Configuration(q) if fits(q) => clamp(problem, Some(number), q, &mut corrections),
            _ => {}
        }
    }
    if let Some(nearby) = Nearby::new(problem, kinematics) {
        nearby.snap_all(None, &mut start, &mut corrections);
        for (number, goal) in goals.iter_mut().enumerate() {
            match goal {
                Goal::Configuration(q) if fits(q) => nearby.snap_all(Some(number), q, &mut corrections),
                Goal::Configuration(_) => {}
                Goal::Partial(partial) => nearby.snap_poses(number, &start, partial, &mut corrections),
            }
        }
    }
    problem.start = start;
    problem.goals = goals;
    corrections
}

/// Moves joints that are a little outside their bounds to them.
fn clamp(problem: &Problem, goal: Option<usize>, q: &mut [f64], corrections: &mut Vec<Correction>) {
    let (robot, tolerance) = (&problem.robot, problem.start_tolerance);
    for (index, joint) in (0u32..).map(JointIndex).zip(&robot.joints) {
        let Source::Coordinates { q: at, .. } = joint.source else { continue };
        let is_locked = problem.graph.locked.iter().any(|(locked, _)| *locked == index);
        if joint.motion.configuration_size() != 1 || is_locked {
            continue;
        }
        let (low, high, value) = (robot.space.lower[at], robot.space.upper[at], q[at]);
        let inside = value.clamp(low.min(high), high.max(low));
        let off = (inside - value).abs();
        let turns = matches!(joint.motion, JointType::Revolute { .. });
        let size = if turns { (0.0, off) } else { (off, 0.0) };
        if off > 0.0 && off <= OF_RANGE * (high - low) && tolerance.share(size.0, size.1) <= 1.0 {
            q[at] = inside;
            let onto = format!("it is within its bounds, [{low}, {high}]");
            let moved = (joint.name.clone(), Moved::Joint(index, inside));
            corrections.push(Correction::new(goal, moved, onto, size));
        }
    }
}

impl Nearby<'_> {
    /// Moves one configuration onto the nearest state, unless it lies in one or in reach of none.
    fn snap_all(&self, goal: Option<usize>, q: &mut Vec<f64>, corrections: &mut Vec<Correction>) {
        let X_WJ = self.poses(q);
        if self.is_on_one(q, &X_WJ) {
            return;
        }
        if let Some((state, corrected)) = self.nearest(q, &X_WJ, 1.0) {
            corrections.extend(self.told(goal, &state, &corrected));
            *q = corrected.q;
        }
    }

    /// The state that takes the smallest correction of at most `factor` times the tolerance; of two that take the same that in which
    /// more is held.
    pub(super) fn nearest(&self, q: &[f64], X_WJ: &[Pose], factor: f64) -> Option<(StateKey, Corrected)> {
        let states = self.states(X_WJ, Reach::Within(factor))?;
        let corrected = states.into_iter().filter_map(|state| {
            let corrected = self.corrected(&state, q, factor)?;
            Some((state, corrected))
        });
        corrected.min_by(|(a, x), (b, y)| x.cost.total_cmp(&y.cost).then(b.grasps.len().cmp(&a.grasps.len())))
    }

    /// What was moved, and why.
    pub(super) fn told(&self, goal: Option<usize>, state: &StateKey, corrected: &Corrected) -> Vec<Correction> {
        let X_WJ = self.poses(&corrected.q);
        let robot = &self.problem.robot;
        let told = |&(joint, distance, angle): &(JointIndex, f64, f64)| {
            let record = &robot.joints[joint.at()];
            let object = self.roots().find(|(_, root)| *root == joint).map(|(object, _)| object);
            let (name, moved, onto) = match (object, record.source) {
                (Some(object), _) => {
                    let part = self.problem.graph.objects[object].part;
                    let moved = Moved::Object(part, X_WJ[joint.at()]);
                    (robot[part].name.clone(), moved, self.holds(state, object, &X_WJ))
                }
                (None, Source::Coordinates { q, .. }) if record.motion.configuration_size() == 1 => {
                    let moved = Moved::Joint(joint, corrected.q[q]);
                    (record.name.clone(), moved, self.held_by(state))
                }
                (None, _) => (record.name.clone(), Moved::Root(joint), self.held_by(state)),
            };
            Correction::new(goal, (name, moved), onto, (distance, angle))
        };
        corrected.moved.iter().map(told).collect()
    }

    /// What keeps an object in a state, in words.
    fn holds(&self, state: &StateKey, object: usize, X_WJ: &[Pose]) -> String {
        let (robot, options) = (&self.problem.robot, &self.problem.graph);
        let holding: Vec<String> = state
            .grasps
            .iter()
            .filter(|(_, handle)| options.objects[object].handles.contains(handle))
            .map(|(gripper, handle)| {
                format!("{} holds {}", robot.grippers[gripper.at()].name, robot.handles[handle.at()].name)
            })
            .collect();
        match (holding.is_empty(), self.place(object as u32, state.lying[object])) {
            (false, _) => holding.join(" and "),
            (true, Some(place)) => lies(robot, place, X_WJ),
            (true, None) => "it stays where it is".into(),
        }
    }

    /// Who holds what, in words: why joints have to move.
    fn held_by(&self, state: &StateKey) -> String {
        let robot = &self.problem.robot;
        let holds = state.grasps.iter().map(|(gripper, handle)| {
            format!("{} holds {}", robot.grippers[gripper.at()].name, robot.handles[handle.at()].name)
        });
        let holds: Vec<String> = holds.collect();
        if holds.is_empty() { "all joints stand where their state has them".into() } else { holds.join(" and ") }
    }

    /// Moves the objects that a goal names by their poses onto supports: those that are fixed in the world, and those of objects that
    /// the goal names too. Nothing else is known to stand anywhere.
    fn snap_poses(&self, number: usize, start: &[f64], partial: &mut PartialGoal, corrections: &mut Vec<Correction>) {
        let robot = &self.problem.robot;
        let named: Vec<(usize, JointIndex)> = self
            .roots()
            .filter(|(object, _)| partial.poses.iter().any(|(part, _)| *part == self.part(*object)))
            .filter(|(object, _)| !self.is_held(partial, *object))
            .collect();
        let first = |root: JointIndex| match robot.joints[root.at()].source {
            Source::Coordinates { q, .. } => Some(q),
            Source::Follows { .. } => None,
        };
        let mut q = start.to_vec();
        for (part, pose) in &partial.poses {
            let root = named.iter().find(|(object, _)| self.part(*object) == *part);
            if !pose.is_finite() {
                return;
            }
            if let Some(at) = root.and_then(|(_, root)| first(*root)) {
                q[at..at + 7].copy_from_slice(&pose_to_array(pose));
            }
        }
        let given = q.clone();
        let mut onto: Vec<Option<String>> = vec![None; named.len()];
        // What lies on an object is moved after it, whichever is named first.
        for _ in 0..named.len().min(2) {
            for (at, &(object, root)) in named.iter().enumerate() {
                let is_known = |place: &PlacementOnSupport| {
                    place.on.is_none_or(|body| named.iter().any(|(_, root)| *root == body))
                };
                if let Some((there, words)) = self.laid(object, root, &q, &is_known) {
                    (q, onto[at]) = (there, Some(words));
                }
            }
        }
        for (&(object, root), onto) in named.iter().zip(onto) {
            let (Some(onto), Some(at)) = (onto, first(root)) else { continue };
            let read = |q: &[f64]| q[at..at + 7].try_into().ok().and_then(pose_from_array);
            let (Some(from), Some(to)) = (read(&given), read(&q)) else { continue };
            let (distance, angle) = poses_apart(&from, &to);
            let part = self.part(object);
            if self.problem.start_tolerance.share(distance, angle) > 1.0 + 1e-9 {
                continue;
            }
            partial.poses.iter_mut().filter(|(named, _)| *named == part).for_each(|(_, pose)| *pose = to);
            let moved = (robot[part].name.clone(), Moved::Object(part, to));
            corrections.push(Correction::new(Some(number), moved, onto, (distance, angle)));
        }
    }

    /// Whether a goal wants an object in a hand.
    fn is_held(&self, partial: &PartialGoal, object: usize) -> bool {
        let (part, handles) = (self.part(object), &self.problem.graph.objects[object].handles);
        let wants = |holding: &Holding| match holding {
            Holding::Object(wanted) => *wanted == part,
            Holding::Handle(handle) => handles.contains(handle),
            Holding::Nothing | Holding::Anything => false,
        };
        partial.held.contains(&part) || partial.hands.iter().any(|(_, holding)| wants(holding))
    }

    fn part(&self, object: usize) -> PartIndex {
        self.problem.graph.objects[object].part
    }

    /// A configuration with one object on the nearest of its supports that are known, and where it then lies; `None` where it lies
    /// on one already, or none is in reach.
    fn laid(
        &self,
        object: usize,
        root: JointIndex,
        q: &[f64],
        is_known: &dyn Fn(&PlacementOnSupport) -> bool,
    ) -> Option<(Vec<f64>, String)> {
        let X_WJ = self.poses(q);
        let known = || self.resting(object).iter().filter(|place| is_known(place));
        if known().any(|place| place.resting.residual(0.0, &X_WJ) <= ON) {
            return None;
        }
        let laid = known().filter_map(|place| {
            let mut over = q.to_vec();
            self.slide(object, Some(place), &mut over);
            let there = self.solved(&[place.resting.constraint(0.0)], &over, &|joint| joint == root)?;
            let there_poses = self.poses(&there);
            let (distance, angle) = poses_apart(&X_WJ[root.at()], &there_poses[root.at()]);
            let share = self.share(distance, angle);
            (share <= 1.0).then(|| (share, there, lies(&self.problem.robot, place, &there_poses)))
        });
        laid.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, there, words)| (there, words))
    }
}

/// On what an object lies, in words.
fn lies(robot: &Robot, place: &PlacementOnSupport, X_WJ: &[Pose]) -> String {
    match &place.resting {
        SupportPlacement::Surfaces(lying) => {
            let mut number = placement::contact(lying, X_WJ).support;
            for surface in &place.supports {
                let surface = &robot.surfaces[surface.at()];
                match number.checked_sub(surface.polygons.len()) {
                    None => return format!("it lies on {}", surface.name),
                    Some(left) => number = left,
                }
            }
            "it lies on its support".into()
        }
        SupportPlacement::Plane { .. } => match place.touches {
            Some(link) => format!("it stands on {}", robot.links[link.at()].name),
            None => "it stands on its plane".into(),
        },
    }
}
