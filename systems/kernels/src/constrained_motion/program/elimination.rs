//! The state of the compiler, and the elimination of objects and locked joints.
//!
//! A constraint that wholly determines an object makes it follow its carrier; a locked joint is no variable. Everything else
//! remains for `assembly`. A rigid relation of two objects that nothing carries yet waits until one of them is carried.

use crate::constrained_motion::program::error::CompileError;
use crate::constrained_motion::rows::coordinates::LockedCoordinate;
use crate::constrained_motion::rows::rigid_attachment::{AttachmentTemplate, Relation};
use crate::kinematics::attachment_tree::AttachmentTree;
use foliate_components::constraint::{Constraint, Frame, Locked, LockedValue, Placement, RelativePose};
use foliate_components::robot::{Robot, Source};

pub(crate) struct Compiler<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) tree: AttachmentTree,
    pub(crate) rigid_attachments: Vec<AttachmentTemplate>,
    pub(crate) locked: Vec<LockedCoordinate>,
    /// For each joint whether its coordinate is locked.
    pub(crate) is_locked: Vec<bool>,
    /// What remains, with the numbers by which errors and outcomes name them.
    pub(crate) remaining: Vec<(usize, Constraint)>,
}

impl Compiler<'_> {
    pub(crate) fn lock(&mut self, locked: Locked) -> Result<bool, CompileError> {
        let joint = &self.robot.joints[locked.joint.at()];
        let (Source::Coordinates { q, .. }, 1) = (joint.source, joint.motion.configuration_size()) else {
            return Err(CompileError::NotLockable(self.name(locked.joint)));
        };
        let new = !std::mem::replace(&mut self.is_locked[locked.joint.at()], true);
        if new {
            self.locked.push(LockedCoordinate { coordinate: q, value: locked.value });
        }
        Ok(new)
    }

    /// A joint between equal bounds is no variable.
    pub(crate) fn lock_immovable(&mut self) {
        for (index, joint) in self.robot.joints.iter().enumerate() {
            let Source::Coordinates { q, .. } = joint.source else { continue };
            if joint.is_immovable() && !self.is_locked[index] {
                self.is_locked[index] = true;
                let stands =
                    |(i, &low): (usize, &f64)| LockedCoordinate { coordinate: q + i, value: LockedValue::Fixed(low) };
                self.locked.extend(joint.lower.iter().enumerate().map(stands));
            }
        }
    }

    pub(crate) fn carry(&mut self, number: usize, template: &AttachmentTemplate) -> Result<(), CompileError> {
        let object = template.object;
        if !self.is_object(object) {
            return Err(CompileError::NotAnObject(self.name(object)));
        }
        if let Relation::Hold { placement, .. } = &template.relation
            && placement.only_support() != Some(template.carrier)
        {
            return Err(CompileError::SeveralSupports(number));
        }
        if self.tree.is_carried(object) {
            let constraint = template.as_constraint();
            self.check_joints(number, &constraint)?;
            self.remaining.push((number, constraint));
        } else if self.tree.hang(object, template.carrier) {
            self.rigid_attachments.push(template.clone());
        } else {
            return Err(CompileError::Cycle(self.name(object)));
        }
        Ok(())
    }

    /// Adds constraints in order, except that a rigid relation of two objects waits until one of them is carried, or
    /// nothing else is left: of a hand, a box and its lid the box follows the hand and the lid the box, in whatever order
    /// they are named.
    pub(crate) fn add_all(&mut self, mut waiting: Vec<(usize, Constraint)>) -> Result<(), CompileError> {
        while !waiting.is_empty() {
            let before = waiting.len();
            let mut later = Vec::new();
            for (number, constraint) in waiting {
                if self.floats(&constraint) {
                    later.push((number, constraint));
                } else {
                    self.add(number, constraint)?;
                }
            }
            if later.len() == before {
                let (number, constraint) = later.remove(0);
                self.add(number, constraint)?;
            }
            waiting = later;
        }
        // The order of rows is that of the input.
        self.remaining.sort_by_key(|(number, _)| *number);
        Ok(())
    }

    /// Whether a constraint fixes two objects to each other that nothing carries yet.
    fn floats(&self, constraint: &Constraint) -> bool {
        let free = |frame: &Frame| frame.joint.is_some_and(|j| self.is_object(j) && !self.tree.is_carried(j));
        matches!(constraint, Constraint::RelativePose(pose) if pose.is_rigid() && free(&pose.a) && free(&pose.b))
    }

    fn add(&mut self, number: usize, constraint: Constraint) -> Result<(), CompileError> {
        if let Constraint::Locked(locked) = constraint
            && self.lock(locked)?
        {
            return Ok(());
        }
        let eliminated = match &constraint {
            Constraint::RelativePose(pose) if pose.dimension() == 0 => true,
            Constraint::RelativePose(pose) if pose.is_rigid() => self.eliminate_rigid(pose),
            Constraint::PlacementHold(placement, slot) => self.eliminate_hold(placement, *slot),
            _ => false,
        };
        if !eliminated {
            self.remaining.push((number, constraint));
        }
        Ok(())
    }

    fn eliminate_rigid(&mut self, pose: &RelativePose) -> bool {
        [pose.b.joint, pose.a.joint]
            .into_iter()
            .flatten()
            .any(|object| self.is_object(object) && self.eliminate(AttachmentTemplate::of_rigid(pose, object)))
    }

    fn eliminate_hold(&mut self, placement: &Placement, slot: usize) -> bool {
        let (Some(object), Some(carrier)) = (placement.object_joint(), placement.only_support()) else { return false };
        let relation = Relation::Hold { placement: placement.clone(), slot };
        self.is_object(object) && self.eliminate(AttachmentTemplate { object, carrier, relation })
    }

    fn eliminate(&mut self, template: AttachmentTemplate) -> bool {
        let eliminated = self.tree.hang(template.object, template.carrier);
        if eliminated {
            self.rigid_attachments.push(template);
        }
        eliminated
    }
}
