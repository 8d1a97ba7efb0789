//! From a set of constraints to a program: what determines an object eliminates it, what nothing free touches becomes a
//! check, the rest are rows.

use super::blocks::{Block, ContactBlock, Kind, Part, PoseBlock};
use super::bodies::Bodies;
use super::carriage::{CarriageTemplate, Relation};
use super::hessian_bound::ResidualBound;
use super::merge::merged;
use super::program::{ConstraintProgram, LockedCoordinate, Move, WriteBack};
use crate::constraints::placement_of;
use crate::kinematics::{AttachmentTree, Kinematics};
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Locked, LockedValue, Placement, Reference, RelativePose};
use foliate_components::robot::{JointIndex, Motion, Robot, Source};

/// Why constraints make no program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum CompileError {
    #[error("constraint {constraint} names joint {joint:?}, and the robot has {joints} joints")]
    NoSuchJoint { constraint: usize, joint: JointIndex, joints: usize },
    #[error("`{0}` cannot be carried: it is not a free-flyer that hangs in the world")]
    NotAnObject(String),
    #[error("`{0}` would carry itself")]
    Cycle(String),
    #[error("`{0}` cannot be locked: it has not exactly one coordinate of its own")]
    NotLockable(String),
    #[error("constraint {0} is a placement whose supports are on several bodies, and cannot carry its object")]
    SeveralSupports(usize),
    #[error("constraint {0} is a placement without polygons")]
    EmptyPlacement(usize),
    #[error("constraint {0} is of a kind that can be checked but not solved yet")]
    NotSolved(usize),
    #[error("the kinematics were compiled for another robot")]
    OtherRobot,
}

struct Compiler<'a> {
    robot: &'a Robot,
    tree: AttachmentTree<'a>,
    carriages: Vec<CarriageTemplate>,
    locked: Vec<LockedCoordinate>,
    /// For each joint whether its coordinate is locked.
    is_locked: Vec<bool>,
    /// What remains, with the numbers by which errors and outcomes name them.
    remaining: Vec<(usize, Constraint)>,
}

impl ConstraintProgram {
    /// Compiles constraints.
    ///
    /// `carriages` say which objects follow what; `locked` joints keep their values. Then, in order, every constraint that
    /// wholly determines an object that nothing carries yet eliminates it too, unless the object would carry itself. A
    /// second relation on a carried object (two hands on one box) becomes rows. A constraint and its complement on the same
    /// frames are one constraint.
    ///
    /// Outcomes number constraints as they are given here: carriages first, then `constraints`.
    ///
    /// # Errors
    /// Joints that do not exist, carriages of what is no object or in a cycle, locked joints without exactly one coordinate.
    pub fn compile(
        robot: &Robot,
        kinematics: &Kinematics,
        constraints: &[Constraint],
        carriages: &[CarriageTemplate],
        locked: &[(JointIndex, f64)],
    ) -> Result<Self, CompileError> {
        if kinematics.bodies() != robot.joints.len() || kinematics.configuration_size() != robot.space.size() {
            return Err(CompileError::OtherRobot);
        }
        let joints = robot.joints.len();
        let mut compiler = Compiler {
            robot,
            tree: AttachmentTree::new(robot),
            carriages: Vec::new(),
            locked: Vec::new(),
            is_locked: vec![false; joints],
            remaining: Vec::new(),
        };
        for (joint, value) in locked {
            compiler.known(usize::MAX, Some(*joint))?;
            compiler.lock(Locked { joint: *joint, value: LockedValue::Fixed(*value) })?;
        }
        compiler.lock_immovable();
        for (number, template) in carriages.iter().enumerate() {
            compiler.known(number, Some(template.object))?;
            compiler.known(number, template.carrier)?;
            compiler.carry(number, template)?;
        }
        for (number, constraint) in merged(constraints) {
            let number = number + carriages.len();
            compiler.check_joints(number, &constraint)?;
            compiler.add(number, constraint)?;
        }
        Ok(compiler.finish())
    }
}

impl Compiler<'_> {
    fn known(&self, constraint: usize, joint: Option<JointIndex>) -> Result<(), CompileError> {
        let joints = self.robot.joints.len();
        match joint {
            Some(joint) if joint.at() >= joints => Err(CompileError::NoSuchJoint { constraint, joint, joints }),
            _ => Ok(()),
        }
    }

    fn check_joints(&self, number: usize, constraint: &Constraint) -> Result<(), CompileError> {
        match constraint {
            Constraint::RelativePose(pose) => {
                self.known(number, pose.a.joint)?;
                self.known(number, pose.b.joint)
            }
            Constraint::Placement(p) | Constraint::PlacementComplement(p, _) | Constraint::PlacementHold(p, _) => {
                if p.object.is_empty() || p.supports.is_empty() {
                    return Err(CompileError::EmptyPlacement(number));
                }
                p.object.iter().chain(&p.supports).try_for_each(|polygon| self.known(number, polygon.frame.joint))
            }
            Constraint::Locked(locked) => self.known(number, Some(locked.joint)),
            Constraint::CentreOfMass(_)
            | Constraint::CentreOfMassBetween(_)
            | Constraint::Distance(_)
            | Constraint::Custom(_) => Err(CompileError::NotSolved(number)),
        }
    }

    fn name(&self, joint: JointIndex) -> String {
        self.robot.joints[joint.at()].name.clone()
    }

    /// Whether the joint is the root of something that moves freely.
    fn is_object(&self, joint: JointIndex) -> bool {
        let joint = &self.robot.joints[joint.at()];
        joint.parent.is_none() && joint.motion == Motion::FreeFlyer
    }

    fn lock(&mut self, locked: Locked) -> Result<bool, CompileError> {
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
    fn lock_immovable(&mut self) {
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

    fn carry(&mut self, number: usize, template: &CarriageTemplate) -> Result<(), CompileError> {
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
            self.carriages.push(template.clone());
        } else {
            return Err(CompileError::Cycle(self.name(object)));
        }
        Ok(())
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
            .any(|object| self.is_object(object) && self.eliminate(CarriageTemplate::of_rigid(pose, object)))
    }

    fn eliminate_hold(&mut self, placement: &Placement, slot: usize) -> bool {
        let (Some(object), Some(carrier)) = (placement.object_joint(), placement.only_support()) else { return false };
        let relation = Relation::Hold { placement: placement.clone(), slot };
        self.is_object(object) && self.eliminate(CarriageTemplate { object, carrier, relation })
    }

    fn eliminate(&mut self, template: CarriageTemplate) -> bool {
        let eliminated = self.tree.hang(template.object, template.carrier);
        if eliminated {
            self.carriages.push(template);
        }
        eliminated
    }

    fn finish(mut self) -> ConstraintProgram {
        self.order_carriages();
        let variables = self.variables();
        let mut is_free = vec![false; self.robot.space.dimension()];
        variables.iter().for_each(|&v| is_free[v] = true);

        let (mut blocks, mut checks) = (Vec::new(), Vec::new());
        for (number, constraint) in &self.remaining {
            let mut block = self.block(*number, constraint, &is_free);
            if block.is_free() { blocks.push(block) } else { checks.push(block) }
        }
        let active = compress(&mut blocks, self.robot.space.dimension());
        number_rows(&mut blocks);
        let check_rows = number_rows(&mut checks);
        let decoded = number_decoded(blocks.iter_mut().chain(&mut checks));
        let objects: Vec<_> = self.carriages.iter().map(|c| c.object).collect();
        let bodies = self.bodies(&blocks, &checks, &objects, &active);
        ConstraintProgram {
            moves: self.moves(&active),
            written: objects.iter().filter_map(|&object| self.write_back(object)).collect(),
            arguments: self.arguments(),
            bound: ResidualBound::new(self.robot, &self.tree, &blocks, &is_free),
            variables,
            active,
            locked: self.locked,
            carriages: self.carriages,
            blocks,
            checks,
            check_rows,
            decoded,
            bodies,
            bodies_count: self.robot.joints.len(),
            size: self.robot.space.size(),
        }
    }

    /// Sorts carriages so that a carrier's own comes first: by how many carriages lie beneath.
    fn order_carriages(&mut self) {
        let tree = &self.tree;
        self.carriages.sort_by_key(|c| tree.chain(c.carrier).filter(|&j| tree.is_carried(j)).count());
    }

    fn variables(&self) -> Vec<usize> {
        let mut variables = Vec::new();
        for (index, joint) in self.robot.joints.iter().enumerate() {
            let Source::Coordinates { v, .. } = joint.source else { continue };
            if !self.is_locked[index] && !self.tree.is_carried(JointIndex(index as u32)) {
                variables.extend(v..v + joint.motion.velocity_size());
            }
        }
        variables.sort_unstable();
        variables
    }

    /// Columns still number velocity coordinates.
    fn block(&self, source: usize, constraint: &Constraint, is_free: &[bool]) -> Block {
        let columns = |a: &Frame, b: &Frame| self.tree.columns(a.joint, b.joint, |v| is_free[v].then_some(v));
        let contact = |placement: &Placement, part: Part| {
            let against = |s: &_| columns(s, &placement.object[0].frame);
            let columns = placement.supports.iter().map(|support| against(&support.frame)).collect();
            let kind = Kind::Contact(ContactBlock { placement: placement.clone(), part, columns, decoded: 0 });
            Block { source, first: 0, rows: part.dimension(), kind }
        };
        match constraint {
            Constraint::RelativePose(pose) => {
                let kind = Kind::Pose(PoseBlock {
                    a: placement_of(&pose.a),
                    b: placement_of(&pose.b),
                    rows: pose.rows,
                    reference: pose.reference,
                    columns: columns(&pose.a, &pose.b),
                });
                Block { source, first: 0, rows: pose.dimension(), kind }
            }
            Constraint::CentreOfMass(_)
            | Constraint::CentreOfMassBetween(_)
            | Constraint::Distance(_)
            | Constraint::Custom(_) => Block {
                source,
                first: 0,
                rows: 0,
                kind: Kind::Locked { coordinate: 0, value: LockedValue::Fixed(0.0) },
            }, // refused before
            Constraint::Placement(placement) => contact(placement, Part::Contact),
            Constraint::PlacementComplement(placement, slot) => contact(placement, Part::Complement(*slot)),
            Constraint::PlacementHold(placement, slot) => contact(placement, Part::Hold(*slot)),
            Constraint::Locked(locked) => {
                let coordinate = match self.robot.joints[locked.joint.at()].source {
                    Source::Coordinates { q, .. } => q,
                    Source::Follows { .. } => 0, // refused when it was locked
                };
                Block { source, first: 0, rows: 1, kind: Kind::Locked { coordinate, value: locked.value } }
            }
        }
    }

    fn bodies(&self, blocks: &[Block], checks: &[Block], objects: &[JointIndex], active: &[usize]) -> Bodies {
        let looked_at = blocks.iter().chain(checks).flat_map(joints_of);
        let moves = |joint: JointIndex| {
            let joint = &self.robot.joints[joint.at()];
            let (v, count) = match joint.source {
                Source::Coordinates { v, .. } => (v, joint.motion.velocity_size()),
                Source::Follows { leader, .. } => match self.robot.joints[leader.at()].source {
                    Source::Coordinates { v, .. } => (v, 1),
                    Source::Follows { .. } => return false,
                },
            };
            active.iter().any(|a| (v..v + count).contains(a))
        };
        Bodies::new(self.robot, &self.tree, looked_at, objects, moves)
    }

    fn moves(&self, active: &[usize]) -> Vec<Move> {
        let space = &self.robot.space;
        let mut moves = Vec::new();
        for joint in &self.robot.joints {
            let Source::Coordinates { q, v } = joint.source else { continue };
            let column = |v: usize| active.binary_search(&v).ok();
            let scalars = joint.motion.velocity_size().min(3);
            for k in 0..scalars {
                let Some(variable) = column(v + k) else { continue };
                let coordinate = q + k;
                let (lower, upper) = (space.lower[coordinate], space.upper[coordinate]);
                moves.push(Move::Scalar { variable, coordinate, lower, upper });
            }
            if joint.motion == Motion::FreeFlyer
                && let Some(variable) = column(v + 3)
            {
                moves.push(Move::Turn { variable, coordinate: q });
            }
        }
        moves
    }

    fn write_back(&self, object: JointIndex) -> Option<WriteBack> {
        let joint = &self.robot.joints[object.at()];
        let Source::Coordinates { q: coordinate, .. } = joint.source else { return None };
        let X_WJ = joint.parent_from_joint;
        let X_JW = (X_WJ != Pose::identity()).then(|| X_WJ.inverse());
        Some(WriteBack { object, coordinate, X_JW })
    }

    fn arguments(&self) -> usize {
        let locked = self.locked.iter().filter_map(|l| match l.value {
            LockedValue::Fixed(_) => None,
            LockedValue::Argument(slot) => Some(slot),
        });
        let remaining = self.remaining.iter().filter_map(|(_, constraint)| match constraint {
            Constraint::RelativePose(RelativePose { reference: Reference::Argument(slot), .. })
            | Constraint::PlacementComplement(_, slot)
            | Constraint::PlacementHold(_, slot)
            | Constraint::Locked(Locked { value: LockedValue::Argument(slot), .. }) => Some(*slot),
            _ => None,
        });
        let carried = self.carriages.iter().filter_map(CarriageTemplate::slot);
        locked.chain(remaining).chain(carried).max().map_or(0, |slot| slot.saturating_add(1))
    }
}

/// Numbers the velocity coordinates that columns use from zero, ascending; returns them.
fn compress(blocks: &mut [Block], dimension: usize) -> Vec<usize> {
    let mut used = vec![false; dimension];
    for column in blocks.iter_mut().flat_map(Block::columns_mut) {
        used[column.variable()] = true;
    }
    let active: Vec<usize> = (0..dimension).filter(|&v| used[v]).collect();
    for column in blocks.iter_mut().flat_map(Block::columns_mut) {
        let variable = column.variable_mut();
        // Every used coordinate is in the list.
        *variable = active.partition_point(|&v| v < *variable);
    }
    active
}

fn number_rows(blocks: &mut [Block]) -> usize {
    let mut rows = 0;
    for block in blocks {
        block.first = rows;
        rows += block.rows;
    }
    rows
}

fn number_decoded<'a>(blocks: impl Iterator<Item = &'a mut Block>) -> usize {
    let mut count = 0;
    for block in blocks {
        if let Kind::Contact(contact) = &mut block.kind
            && contact.part.slot().is_some()
        {
            contact.decoded = count;
            count += 1;
        }
    }
    count
}

fn joints_of(block: &Block) -> Vec<JointIndex> {
    match &block.kind {
        Kind::Pose(pose) => [pose.a.joint, pose.b.joint].into_iter().flatten().collect(),
        Kind::Contact(contact) => {
            let polygons = contact.placement.object.iter().chain(&contact.placement.supports);
            polygons.filter_map(|polygon| polygon.frame.joint).collect()
        }
        Kind::Locked { .. } => Vec::new(),
    }
}
