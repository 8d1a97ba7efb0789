//! What carries each object in a state: which constraint says where it is attached, and in which order the objects follow.
//!
//! Grippers may sit on objects (magnets), and surfaces on objects may carry others, so who carries whom can be a chain;
//! it must not be a circle. An object that lies somewhere is attached there. Of the grasps of any other, the first in the
//! state's order that closes no circle carries it, and further ones are rows. A grasp of a handle that is not on an
//! object's root carries nothing: the door moves, not the fridge.

use foliate_components::Pose;
use foliate_components::constraint::{Frame, Grasp, Mask, MaskError};
use foliate_components::graph::{ConstraintGraph, ConstraintId, ConstraintKind};
use foliate_components::problem::{ObjectOptions, Problem};
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, JointType, PartIndex, Robot, RootJoint};
use glam::DQuat;

/// The carriers of a state's objects.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Carriers {
    /// By object: the constraint whose value says how it is attached; none where nothing determines it wholly.
    pub of: Vec<Option<ConstraintId>>,
    /// The carried objects, a carrier before what it carries.
    pub order: Vec<usize>,
}

/// The chain of bodies that objects are attached to, while it is found out.
#[derive(Clone, Debug)]
pub struct Chain<'a> {
    robot: &'a Robot,
    /// By part: the object that it is.
    object_of_part: Vec<Option<usize>>,
    /// By object: its free-flyer.
    roots: Vec<Option<JointIndex>>,
    /// By object: the body that carries it, where something does.
    carrier: Vec<Option<Option<JointIndex>>>,
}

impl<'a> Chain<'a> {
    /// Objects that nothing carries yet.
    #[must_use]
    pub fn new(robot: &'a Robot, objects: &[ObjectOptions]) -> Self {
        let mut object_of_part = vec![None; robot.parts.len()];
        for (index, object) in objects.iter().enumerate() {
            object_of_part[object.part.at()] = Some(index);
        }
        let roots = objects.iter().map(|object| root_of(robot, object.part)).collect();
        Self { robot, object_of_part, roots, carrier: vec![None; objects.len()] }
    }

    /// The object that a body is part of.
    #[must_use]
    pub fn object_of(&self, body: Option<JointIndex>) -> Option<usize> {
        self.object_of_part[self.robot.joints[body?.at()].part.at()]
    }

    /// Whether something carries an object.
    #[must_use]
    pub fn is_carried(&self, object: usize) -> bool {
        self.carrier[object].is_some()
    }

    /// Attaches an object to a body; false, and nothing changes, where it is carried already or would carry itself.
    pub fn attach(&mut self, object: usize, body: Option<JointIndex>) -> bool {
        if self.is_carried(object) || self.hangs_on(body, object) {
            return false;
        }
        self.carrier[object] = Some(body);
        true
    }

    /// Attaches objects to the grippers that hold them by their roots, in order, those first that are held rigidly; `attached`
    /// hears the number of the grasp and the object.
    pub fn hold<'g>(
        &mut self,
        grasps: impl Iterator<Item = (usize, &'g Grasp)> + Clone,
        mut attached: impl FnMut(usize, usize),
    ) {
        for rigid in [true, false] {
            for (number, (object, grasp)) in grasps.clone().enumerate() {
                let Some(root) = self.roots.get(object).copied().flatten() else { continue };
                let fits = grasp.handle.joint == Some(root) && is_rigid(grasp, Some(root)) == rigid;
                if fits && self.attach(object, grasp.gripper.joint) {
                    attached(number, object);
                }
            }
        }
    }

    /// Whether a body is attached to an object, or is part of it.
    fn hangs_on(&self, mut body: Option<JointIndex>, object: usize) -> bool {
        // No chain is longer than there are objects.
        for _ in 0..=self.carrier.len() {
            match self.object_of(body) {
                Some(next) if next == object => return true,
                Some(next) => body = self.carrier[next].flatten(),
                None => return false,
            }
        }
        true
    }

    /// How many objects are between an object and a body that is attached to nothing.
    fn depth(&self, object: usize) -> usize {
        let below = |&object: &usize| self.object_of(self.carrier[object].flatten());
        std::iter::successors(Some(object), below).take(self.carrier.len()).count()
    }
}

impl Carriers {
    /// The carriers in a state with this manifold; `grasp` gives the documents of its grasps.
    #[must_use]
    pub fn of_manifold<'a>(
        robot: &Robot,
        graph: &ConstraintGraph,
        manifold: &[ConstraintId],
        grasp: impl Fn(ConstraintId) -> Option<&'a Grasp>,
    ) -> Self {
        let mut chain = Chain::new(robot, &graph.objects);
        let mut of = vec![None; graph.objects.len()];
        for &constraint in manifold {
            let (object, on) = match graph.constraint(constraint).kind {
                ConstraintKind::Placement { object, on } => (object as usize, on),
                ConstraintKind::Rest { object } => (object as usize, None),
                _ => continue,
            };
            if root_of(robot, graph.objects[object].part).is_some() && chain.attach(object, on) {
                of[object] = Some(constraint);
            }
        }
        let grasps = manifold.iter().filter_map(|&constraint| {
            let ConstraintKind::Grasp { handle, .. } = graph.constraint(constraint).kind else { return None };
            let object = graph.objects.iter().position(|o| o.handles.contains(&handle))?;
            Some((constraint, object, grasp(constraint)?))
        });
        let grasps: Vec<_> = grasps.collect();
        chain.hold(grasps.iter().map(|&(_, object, grasp)| (object, grasp)), |number, object| {
            let (constraint, _, grasp) = grasps[number];
            if is_rigid(grasp, root_of(robot, graph.objects[object].part)) {
                of[object] = Some(constraint);
            }
        });
        let mut order: Vec<usize> = (0..of.len()).filter(|&o| of[o].is_some()).collect();
        order.sort_by_key(|&object| chain.depth(object));
        Self { of, order }
    }
}

/// The free-flyer that moves an object; none for parts that are fixed in the world and only have joints.
#[must_use]
pub fn root_of(robot: &Robot, part: PartIndex) -> Option<JointIndex> {
    let part = &robot.parts[part.at()];
    if part.root == RootJoint::FreeFlyer { part.root_joint } else { None }
}

/// Whether a grasp determines the pose of the object with that root: the handle is on the root's body, and what the grasp
/// leaves free is frozen.
#[must_use]
pub fn is_rigid(grasp: &Grasp, root: Option<JointIndex>) -> bool {
    root.is_some() && grasp.handle.joint == root && (grasp.mask | grasp.complement) == Mask::ALL
}

/// The documents of a grasp. A handle on a link that is attached to its part's root by joints that never move is read as a
/// handle on the root.
///
/// # Errors
/// A handle whose mask makes no grasp.
pub(crate) fn grasp_of(problem: &Problem, gripper: GripperIndex, handle: HandleIndex) -> Result<Grasp, MaskError> {
    let robot = &problem.robot;
    let mut grasp = Grasp::new(robot, gripper, handle)?;
    let part = robot.links[robot.handles[handle.at()].link.at()].part;
    if let Some(root) = root_of(robot, part)
        && let Some(on_root) = seen_from(problem, grasp.handle, root)
    {
        grasp.handle = on_root;
    }
    Ok(grasp)
}

/// A frame as one of the body `root`, where only joints that never move are between them.
fn seen_from(problem: &Problem, frame: Frame, root: JointIndex) -> Option<Frame> {
    let (mut joint, mut pose) = (frame.joint?, frame.joint_from_frame);
    while joint != root {
        let record = &problem.robot.joints[joint.at()];
        let locked = problem.graph.locked.iter().find(|&&(locked, _)| locked == joint).map(|&(_, value)| value);
        let value = locked.or_else(|| record.is_immovable().then(|| record.lower[0]))?;
        let moved = match record.motion {
            JointType::Revolute { axis } => Pose::from_rotation(DQuat::from_axis_angle(axis, value)),
            JointType::Prismatic { axis } => Pose::from_translation(axis * value),
            JointType::Planar | JointType::FreeFlyer => return None,
        };
        pose = record.parent_from_joint * moved * pose;
        joint = record.parent?;
    }
    Some(Frame { joint: Some(root), joint_from_frame: pose })
}

/// Which of some joints are in one chain, by number: one of two is beyond the other.
#[must_use]
pub(crate) fn chains(robot: &Robot, joints: &[JointIndex]) -> Vec<Vec<usize>> {
    let joined = |a: JointIndex, b: JointIndex| is_beyond(robot, Some(a), b) || is_beyond(robot, Some(b), a);
    let mut chains: Vec<Vec<usize>> = Vec::new();
    for (number, joint) in joints.iter().enumerate() {
        let is_of = |chain: &[usize]| chain.iter().any(|&other| joined(*joint, joints[other]));
        let mut own: Vec<usize> = chains.extract_if(.., |chain| is_of(chain)).flatten().collect();
        own.push(number);
        chains.push(own);
    }
    chains
}

/// Whether a body is moved by a joint, directly or through others.
#[must_use]
pub fn is_beyond(robot: &Robot, body: Option<JointIndex>, joint: JointIndex) -> bool {
    std::iter::successors(body, |j| robot.joints[j.at()].parent).any(|j| j == joint)
}

/// How a solid grasp carries: the gripper's body, and the pose of the object's root in it when both frames coincide.
#[must_use]
pub fn solid_grasp(grasp: &Grasp) -> (Option<JointIndex>, Pose) {
    (grasp.gripper.joint, grasp.gripper.joint_from_frame * grasp.handle.joint_from_frame.inverse())
}

/// The pose of an object's root in its carrier, from the poses of all bodies.
#[must_use]
pub fn pose_on_carrier(object: JointIndex, carrier: Option<JointIndex>, X_WJ: &[Pose]) -> Pose {
    match carrier {
        Some(carrier) => X_WJ[carrier.at()].inverse() * X_WJ[object.at()],
        None => X_WJ[object.at()],
    }
}
