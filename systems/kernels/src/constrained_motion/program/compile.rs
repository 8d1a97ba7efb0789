//! From a set of constraints to a program: what determines an object eliminates it, what nothing free touches becomes a
//! check, the rest are rows.

use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::constrained_motion::program::elimination::Compiler;
use crate::constrained_motion::program::error::CompileError;
use crate::constrained_motion::rows::merge::merged;
use crate::constrained_motion::rows::rigid_attachment::AttachmentTemplate;
use crate::kinematics::attachment_tree::AttachmentTree;
use crate::kinematics::forward::Kinematics;
use foliate_components::constraint::{Constraint, Locked, LockedValue};
use foliate_components::robot::{JointIndex, Robot};

impl ConstraintProgram {
    /// Compiles constraints.
    ///
    /// `rigid_attachments` say which objects follow what; `locked` joints keep their values. Then, in order, every constraint that
    /// wholly determines an object that nothing carries yet eliminates it too, unless the object would carry itself;
    /// constraints between two objects come after those that carry one of them. A
    /// second relation on a carried object (two hands on one box) becomes rows. A constraint and its complement on the same
    /// frames are one constraint.
    ///
    /// Where a free-flying robot stands on a foot (six equations between the world and a body of it), a solve eliminates its
    /// root: that goes where the foot and the leg's joints put it, and what rows see moves with the joints between them and
    /// that foot. The program's variables and rows, and what bounds them along a motion, stay those of the robot as written.
    ///
    /// Outcomes number constraints as they are given here: rigid attachments first, then `constraints`.
    ///
    /// # Errors
    /// Joints that do not exist, rigid attachments of what is no object or in a cycle, locked joints without exactly one coordinate.
    pub fn compile(
        robot: &Robot,
        kinematics: &Kinematics,
        constraints: &[Constraint],
        rigid_attachments: &[AttachmentTemplate],
        locked: &[(JointIndex, f64)],
    ) -> Result<Self, CompileError> {
        if kinematics.bodies() != robot.joints.len() || kinematics.configuration_size() != robot.space.size() {
            return Err(CompileError::OtherRobot);
        }
        let joints = robot.joints.len();
        let mut compiler = Compiler {
            robot,
            tree: AttachmentTree::new(robot),
            rigid_attachments: Vec::new(),
            locked: Vec::new(),
            is_locked: vec![false; joints],
            remaining: Vec::new(),
        };
        for (joint, value) in locked {
            compiler.known(usize::MAX, Some(*joint))?;
            compiler.lock(Locked { joint: *joint, value: LockedValue::Fixed(*value) })?;
        }
        compiler.lock_immovable();
        for (number, template) in rigid_attachments.iter().enumerate() {
            compiler.known(number, Some(template.object))?;
            compiler.known(number, template.carrier)?;
            compiler.carry(number, template)?;
        }
        let mut waiting = Vec::new();
        for (number, constraint) in merged(constraints) {
            let number = number + rigid_attachments.len();
            compiler.check_joints(number, &constraint)?;
            waiting.push((number, constraint));
        }
        compiler.add_all(waiting)?;
        Ok(compiler.finish())
    }
}
