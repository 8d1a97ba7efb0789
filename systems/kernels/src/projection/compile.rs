//! From a set of constraints to a program: what determines an object eliminates it, what nothing free touches becomes a
//! check, the rest are rows.

use super::blocks::{Block, ContactBlock, Kind, Part, PoseBlock};
use super::bodies::Bodies;
use super::carriage::{CarriageTemplate, Relation};
use super::hessian_bound::ResidualBound;
use super::lane_program::LaneProgram;
use super::merge::merged;
use super::program::{ConstraintProgram, LockedCoordinate, Move, StandingRoot, WriteBack};
use crate::constraints::centre_of_mass::MassColumns;
use crate::constraints::com_between::{self, StanceColumns};
use crate::constraints::custom::FunctionColumns;
use crate::constraints::placement_of;
use crate::kinematics::{AttachmentTree, Kinematics};
use foliate_components::Pose;
use foliate_components::constraint::{
    BodyMass, CentreOfMass, Constraint, Frame, Locked, LockedValue, Masses, Placement, PlaneRow, Reference,
    RelativePose, Row,
};
use foliate_components::robot::{JointIndex, Motion, Robot, Source};
use glam::DVec3;

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
    #[error("constraint {constraint} makes no sense: {problem}")]
    Malformed { constraint: usize, problem: &'static str },
    #[error("the kinematics were compiled for another robot")]
    OtherRobot,
}

/// More rows than any balance needs; what a solve works with grows with their square.
const MOST_ROWS: usize = 64;

fn fits_rows(rows: usize) -> Option<&'static str> {
    match rows {
        0 => Some("it has no rows"),
        1..=MOST_ROWS => None,
        _ => Some("it has more than 64 rows"),
    }
}

fn fit(constraint: usize, problem: Option<&'static str>) -> Result<(), CompileError> {
    problem.map_or(Ok(()), |problem| Err(CompileError::Malformed { constraint, problem }))
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
    /// wholly determines an object that nothing carries yet eliminates it too, unless the object would carry itself;
    /// constraints between two objects come after those that carry one of them. A
    /// second relation on a carried object (two hands on one box) becomes rows. A constraint and its complement on the same
    /// frames are one constraint.
    ///
    /// Where a free-flying robot stands on a foot (six equations between the world and a body of it), a solve eliminates its
    /// root: that goes where the foot and the leg's joints put it, and what rows see moves with the joints between them and
    /// that foot. The program's variables and rows, and what bounds them along a motion, stay those of the robot as written.
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
        let mut waiting = Vec::new();
        for (number, constraint) in merged(constraints) {
            let number = number + carriages.len();
            compiler.check_joints(number, &constraint)?;
            waiting.push((number, constraint));
        }
        compiler.add_all(waiting)?;
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
            Constraint::CentreOfMass(balance) => {
                self.known(number, balance.frame.joint)?;
                self.masses_known(number, &balance.masses)?;
                fit(number, fits_rows(balance.rows.len()))?;
                let straight =
                    |plane: &PlaneRow| (plane.normal.length() - 1.0).abs() < 1e-9 && plane.offset.is_finite();
                fit(number, (!balance.rows.iter().all(straight)).then_some("a normal is not a unit vector"))
            }
            Constraint::CentreOfMassBetween(balance) => {
                self.known(number, balance.first.joint)?;
                self.known(number, balance.second.joint)?;
                self.masses_known(number, &balance.masses)?;
                fit(number, balance.height.filter(|h| !h.is_finite()).map(|_| "the height is not a finite number"))
            }
            Constraint::Distance(distance) => {
                self.known(number, distance.a.joint)?;
                self.known(number, distance.b.joint)?;
                let positive = distance.length.is_finite() && distance.length > 0.0;
                fit(number, (!positive).then_some("the distance is not a positive number"))?;
                fit(number, (distance.row == Row::Parameter).then_some("a distance is no parameter"))
            }
            Constraint::Custom(own) => {
                own.0.frames().iter().try_for_each(|frame| self.known(number, frame.joint))?;
                fit(number, fits_rows(own.0.rows().len()))?;
                fit(number, own.0.rows().contains(&Row::Parameter).then_some("a function has no parameters"))
            }
        }
    }

    fn masses_known(&self, number: usize, masses: &Masses) -> Result<(), CompileError> {
        masses.bodies().iter().try_for_each(|heavy| self.known(number, heavy.body))?;
        let weighs = |heavy: &BodyMass| heavy.mass > 0.0 && heavy.mass.is_finite() && heavy.center.is_finite();
        let sound = masses.bodies().iter().all(weighs) && masses.total().is_finite();
        fit(number, (!sound).then_some("a mass is not a positive number at a finite place"))
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

    /// Adds constraints in order, except that a rigid relation of two objects waits until one of them is carried, or
    /// nothing else is left: of a hand, a box and its lid the box follows the hand and the lid the box, in whatever order
    /// they are named.
    fn add_all(&mut self, mut waiting: Vec<(usize, Constraint)>) -> Result<(), CompileError> {
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
        let mut program = self.program();
        if self.stand() {
            program.standing = Some(Box::new(self.program()));
        }
        program
    }

    /// Makes a foot carry the world, by the first constraint that says where one stands; whether there is one.
    fn stand(&mut self) -> bool {
        let feet = self.remaining.iter().enumerate().find_map(|(at, (_, constraint))| Some((at, foot_of(constraint)?)));
        let Some((at, (pose, foot))) = feet else { return false };
        let Some(root) = self.tree.line(foot).last().filter(|root| !self.is_locked[root.at()]) else { return false };
        let stands = self.tree.stand_on(foot) == Some(root);
        if stands {
            self.remaining.remove(at);
            self.carriages.push(CarriageTemplate::of_rigid(&pose, foot));
        }
        stands
    }

    fn program(&self) -> ConstraintProgram {
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
        let moments = blocks.iter().chain(&checks).map(Block::moments).max().unwrap_or(0);
        let objects: Vec<_> = self.carriages.iter().map(|c| c.object).collect();
        let bodies = self.bodies(&blocks, &checks, &objects, &active);
        let moves = self.moves(&active);
        let root = self.standing_root();
        let lanes = LaneProgram::new(self.robot, &bodies, &blocks, &moves, active.len());
        // Tables of seeds are of hands of robots whose root stays where it is.
        let seeded = lanes.as_ref().filter(|_| root.is_none());
        ConstraintProgram {
            hand: seeded.and_then(|lanes| lanes.hand(&bodies.moving_bodies(), self.robot)),
            lanes,
            moves,
            written: objects.iter().filter_map(|&object| self.write_back(object)).collect(),
            arguments: self.arguments(),
            bound: self.bound(&blocks, &is_free),
            standing: None,
            root,
            variables,
            active,
            locked: self.locked.clone(),
            carriages: self.carriages.clone(),
            blocks,
            checks,
            check_rows,
            decoded,
            moments,
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
        let masses = |masses: &Masses, from: Option<JointIndex>| {
            let moves = |joint| velocities_of(self.robot, joint).any(|v| is_free[v]);
            MassColumns::new(&self.tree, from, masses, moves, |v| is_free[v].then_some(v))
        };
        let world = Frame::world(Pose::identity());
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
            Constraint::CentreOfMass(balance) => {
                let masses = masses(&balance.masses, balance.frame.joint);
                let kind = Kind::Balance { balance: balance.clone(), masses };
                Block { source, first: 0, rows: balance.rows.len(), kind }
            }
            Constraint::CentreOfMassBetween(balance) => {
                let feet = [&balance.first, &balance.second].map(|foot| columns(&world, foot));
                let columns = Box::new(StanceColumns { masses: masses(&balance.masses, None), feet });
                let kind = Kind::BalanceBetween { balance: balance.clone(), columns };
                Block { source, first: 0, rows: com_between::dimension(balance), kind }
            }
            Constraint::Distance(distance) => {
                let kind = Kind::Distance { distance: *distance, columns: columns(&distance.a, &distance.b) };
                Block { source, first: 0, rows: 1, kind }
            }
            Constraint::Custom(own) => {
                let function = FunctionColumns::new(own, |frame| columns(&world, frame));
                Block { source, first: 0, rows: function.rows().len(), kind: Kind::Custom(function) }
            }
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
        let moves = |joint: JointIndex| velocities_of(self.robot, joint).any(|v| active.binary_search(&v).is_ok());
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

    /// Of the robot as written: what stands is solved, not moved along.
    fn bound(&self, blocks: &[Block], is_free: &[bool]) -> ResidualBound {
        match self.tree.standing() {
            None => ResidualBound::new(self.robot, &self.tree, blocks, is_free),
            Some(_) => ResidualBound::default(),
        }
    }

    /// The root that a foot puts in its place.
    fn standing_root(&self) -> Option<StandingRoot> {
        let write = self.write_back(self.tree.standing()?.root)?;
        let bounds = |bounds: &[f64]| DVec3::from_slice(&bounds[write.coordinate..write.coordinate + 3]);
        let space = &self.robot.space;
        Some(StandingRoot { write, lower: bounds(&space.lower), upper: bounds(&space.upper) })
    }

    fn write_back(&self, object: JointIndex) -> Option<WriteBack> {
        let joint = &self.robot.joints[object.at()];
        if joint.motion != Motion::FreeFlyer {
            return None; // a foot: its root is written, not its own joint
        }
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
            | Constraint::CentreOfMass(CentreOfMass { reference: Reference::Argument(slot), .. })
            | Constraint::PlacementComplement(_, slot)
            | Constraint::PlacementHold(_, slot)
            | Constraint::Locked(Locked { value: LockedValue::Argument(slot), .. }) => Some(*slot),
            _ => None,
        });
        let carried = self.carriages.iter().filter_map(CarriageTemplate::slot);
        locked.chain(remaining).chain(carried).max().map_or(0, |slot| slot.saturating_add(1))
    }
}

/// The body that a constraint puts in its place in the world, with what says so.
fn foot_of(constraint: &Constraint) -> Option<(RelativePose, JointIndex)> {
    let Constraint::RelativePose(pose) = constraint else { return None };
    match (pose.a.joint, pose.b.joint) {
        (None, Some(foot)) | (Some(foot), None) if pose.is_rigid() => Some((*pose, foot)),
        _ => None,
    }
}

/// The velocity coordinates that move a joint: its own, or its leader's.
fn velocities_of(robot: &Robot, joint: JointIndex) -> std::ops::Range<usize> {
    let joint = &robot.joints[joint.at()];
    match joint.source {
        Source::Coordinates { v, .. } => v..v + joint.motion.velocity_size(),
        Source::Follows { leader, .. } => match robot.joints[leader.at()].source {
            Source::Coordinates { v, .. } => v..v + 1,
            Source::Follows { .. } => 0..0, // composing a robot resolves chains of followers
        },
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
        Kind::Balance { balance, .. } => with_masses(&balance.masses, [&balance.frame]),
        Kind::BalanceBetween { balance, .. } => with_masses(&balance.masses, [&balance.first, &balance.second]),
        Kind::Distance { distance, .. } => [distance.a.joint, distance.b.joint].into_iter().flatten().collect(),
        Kind::Custom(function) => function.frames().iter().filter_map(|frame| frame.joint).collect(),
        Kind::Locked { .. } => Vec::new(),
    }
}

fn with_masses<'a>(masses: &Masses, frames: impl IntoIterator<Item = &'a Frame>) -> Vec<JointIndex> {
    let heavy = masses.bodies().iter().filter_map(|heavy| heavy.body);
    heavy.chain(frames.into_iter().filter_map(|frame| frame.joint)).collect()
}
