//! Forward kinematics of only those bodies that a program needs, in the order of the attachment tree.

use crate::kinematics::joint_table::JointCoordinates;
use crate::kinematics::{AttachmentTree, RigidAttachment, Standing};
use foliate_components::Pose;
use foliate_components::robot::configuration::quaternion;
use foliate_components::robot::{Joint, JointIndex, JointType, Robot};
use glam::{DQuat, DVec3, DVec4};

/// Steps of forward kinematics in three groups.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bodies {
    /// Bodies that rows depend on and no variable moves: once per solve.
    pub still: Vec<Step>,
    /// Bodies that rows depend on and variables move: once per iteration.
    pub moving: Vec<Step>,
    /// Bodies that only say where eliminated objects are: once, after the solve.
    pub closing: Vec<Step>,
}

/// One body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    body: usize,
    /// The body from which this one is found.
    parent: Option<usize>,
    kind: Kind,
    /// Whether the motion is that of `parent` in `body`: on the way from a foot to the root.
    is_inverse: bool,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Rotation by the joint's value. The quaternion of the body in its parent is
    /// cos(half angle) · `base` + sin(half angle) · `base` ⊗ axis: two scaled vectors instead of a quaternion product.
    Turn { coordinates: JointCoordinates, translation: DVec3, base: DVec4, turned: DVec4 },
    /// Translation along `axis`, given in the parent.
    Slide { coordinates: JointCoordinates, X_PJ: Pose, axis: DVec3 },
    /// x, y, θ.
    Planar { coordinate: usize, X_PJ: Pose },
    /// Position and quaternion.
    FreeFlyer { coordinate: usize, X_PJ: Pose },
    /// Follows its carrier: index among the solve's rigid attachments.
    Carried(usize),
}

impl Bodies {
    /// Collects the bodies that carry `looked_at` and the `objects` (in dependency order), sorted into groups by what
    /// `moves` (joints whose own coordinates are variables of the solve).
    pub(crate) fn new(
        robot: &Robot,
        tree: &AttachmentTree,
        looked_at: impl IntoIterator<Item = JointIndex>,
        objects: &[JointIndex],
        moves: impl Fn(JointIndex) -> bool,
    ) -> Self {
        let mut bodies = Self::default();
        let mut done = vec![false; robot.joints.len()];
        // Between a foot and its root: whether the body moves.
        let mut leg = vec![None; robot.joints.len()];
        if let Some(Standing { foot, .. }) = tree.standing() {
            bodies.stand(robot, tree, foot, objects, &moves, &mut leg);
            done = leg.iter().map(Option::is_some).collect();
        }
        let mut visit = |joint: JointIndex, closing: bool, bodies: &mut Self| {
            let line: Vec<_> = tree.line(joint).collect();
            let mut is_moving = false;
            for &body in line.iter().rev() {
                is_moving = match leg[body.at()] {
                    Some(leg_moves) => leg_moves,
                    None => is_moving || !tree.is_carried(body) && moves(body),
                };
                if std::mem::replace(&mut done[body.at()], true) {
                    continue;
                }
                let step = Step::new(robot, tree, body, objects);
                match (closing, is_moving) {
                    (true, _) => bodies.closing.push(step),
                    (false, true) => bodies.moving.push(step),
                    (false, false) => bodies.still.push(step),
                }
            }
        };
        for joint in looked_at {
            visit(joint, false, &mut bodies);
        }
        for &object in objects {
            visit(object, true, &mut bodies);
        }
        bodies
    }

    /// From the foot, whose pose its attachment gives, back to the root.
    fn stand(
        &mut self,
        robot: &Robot,
        tree: &AttachmentTree,
        foot: JointIndex,
        objects: &[JointIndex],
        moves: &impl Fn(JointIndex) -> bool,
        leg: &mut [Option<bool>],
    ) {
        leg[foot.at()] = Some(false);
        self.still.push(Step { parent: None, ..Step::new(robot, tree, foot, objects) });
        let mut is_moving = false;
        for body in tree.line(foot) {
            let Some(parent) = tree.parent(body) else { return };
            is_moving |= moves(body);
            leg[parent.at()] = Some(is_moving);
            let kind = Kind::of_joint(robot, &robot.joints[body.at()]);
            let step = Step { body: parent.at(), parent: Some(body.at()), kind, is_inverse: true };
            if is_moving { self.moving.push(step) } else { self.still.push(step) }
        }
    }
}

impl Bodies {
    /// The bodies that variables move and rows depend on, inner ones first.
    pub(crate) fn moving_bodies(&self) -> Vec<usize> {
        self.moving.iter().map(|step| step.body).collect()
    }

    /// How each of these is found.
    pub(crate) fn moving_tree(&self) -> impl Iterator<Item = MovingBody> + '_ {
        self.moving.iter().map(|step| MovingBody {
            from: step.parent,
            by: match (step.kind, step.parent) {
                (Kind::Carried(rigid_attachment), _) => Found::Carried(rigid_attachment),
                (_, Some(moved)) if step.is_inverse => Found::BackOver(moved),
                _ => Found::ByJoint(step.body),
            },
        })
    }
}

/// A body that variables move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovingBody {
    /// The body from which it is found; `None` for the world.
    pub from: Option<usize>,
    pub by: Found,
}

/// How a body is found from another.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Found {
    /// This joint moves it.
    ByJoint(usize),
    /// This joint is mounted on it, and moves the body from which it is found.
    BackOver(usize),
    /// It is carried: index among the rigid attachments.
    Carried(usize),
}

impl Step {
    fn new(robot: &Robot, tree: &AttachmentTree, index: JointIndex, objects: &[JointIndex]) -> Self {
        let joint = &robot.joints[index.at()];
        let kind = match objects.iter().position(|&o| o == index) {
            Some(rigid_attachment) => Kind::Carried(rigid_attachment),
            None => Kind::of_joint(robot, joint),
        };
        Self { body: index.at(), parent: tree.parent(index).map(JointIndex::at), kind, is_inverse: false }
    }

    #[inline]
    fn in_parent(&self, q: &[f64], rigid_attachments: &[RigidAttachment]) -> Pose {
        match self.kind {
            Kind::Turn { coordinates, translation, base, turned } => {
                let (sine, cosine) = (0.5 * coordinates.value(q)).sin_cos();
                Pose::from_parts(translation, DQuat::from_vec4(base * cosine + turned * sine))
            }
            Kind::Slide { coordinates, X_PJ, axis } => {
                let along = axis * coordinates.value(q);
                Pose::from_parts(X_PJ.translation + along, X_PJ.rotation)
            }
            Kind::Planar { coordinate: i, X_PJ } => {
                X_PJ * Pose::from_parts(DVec3::new(q[i], q[i + 1], 0.0), DQuat::from_rotation_z(q[i + 2]))
            }
            Kind::FreeFlyer { coordinate: i, X_PJ } => {
                X_PJ * Pose::from_parts(DVec3::new(q[i], q[i + 1], q[i + 2]), quaternion(q, i))
            }
            Kind::Carried(rigid_attachment) => rigid_attachments[rigid_attachment].X_CO,
        }
    }
}

impl Kind {
    fn of_joint(robot: &Robot, joint: &Joint) -> Self {
        let coordinates = JointCoordinates::of(robot, joint);
        let coordinate = coordinates.q;
        let X_PJ = joint.parent_from_joint;
        match joint.motion {
            JointType::Revolute { axis } => {
                let base = X_PJ.rotation;
                let turned = base * DQuat::from_xyzw(axis.x, axis.y, axis.z, 0.0);
                let (base, turned) = (DVec4::from(base), DVec4::from(turned));
                Self::Turn { coordinates, translation: X_PJ.translation, base, turned }
            }
            JointType::Prismatic { axis } => Self::Slide { coordinates, X_PJ, axis: X_PJ.rotation * axis },
            JointType::Planar => Self::Planar { coordinate, X_PJ },
            JointType::FreeFlyer => Self::FreeFlyer { coordinate, X_PJ },
        }
    }
}

/// Fills the poses of the steps' bodies.
pub(crate) fn run(steps: &[Step], q: &[f64], rigid_attachments: &[RigidAttachment], X_WJ: &mut [Pose]) {
    for step in steps {
        let X_PB = step.in_parent(q, rigid_attachments);
        let X_PB = if step.is_inverse { X_PB.inverse() } else { X_PB };
        X_WJ[step.body] = match step.parent {
            Some(parent) => X_WJ[parent] * X_PB,
            None => X_PB,
        };
    }
}
