//! The last stage of compilation: from what the elimination leaves to a `ConstraintProgram`.
//!
//! Each remaining constraint becomes a block of rows, or a check if no free coordinate changes it. The stage also makes the
//! table of bodies, the moves of coordinates, the residual bound and the form for lanes. For a robot that stands on a foot it
//! makes a second program, in which the foot determines the root.

use crate::constrained_motion::bounds::residual_bound::ResidualBound;
use crate::constrained_motion::lane_rows::form::LaneProgram;
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::constrained_motion::program::elimination::Compiler;
use crate::constrained_motion::program::numbering::{
    compress, foot_of, joints_of, number_decoded, number_rows, velocities_of,
};
use crate::constrained_motion::rows::blocks::{Block, ContactBlock, Kind, Part, PoseBlock};
use crate::constrained_motion::rows::bodies::Bodies;
use crate::constrained_motion::rows::coordinates::{Move, StandingRoot, WriteBack};
use crate::constrained_motion::rows::rigid_attachment::AttachmentTemplate;
use crate::constraints::centre_of_mass::MassColumns;
use crate::constraints::com_between;
use crate::constraints::com_between::StanceColumns;
use crate::constraints::custom::FunctionColumns;
use crate::constraints::rows_out::placement_of;
use foliate_components::Pose;
use foliate_components::constraint::{
    CentreOfMass, Constraint, Frame, Locked, LockedValue, Masses, Placement, Reference, RelativePose,
};
use foliate_components::robot::{JointIndex, JointType, Source};
use glam::DVec3;

impl Compiler<'_> {
    pub(crate) fn finish(mut self) -> ConstraintProgram {
        self.order_attachments();
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
            self.rigid_attachments.push(AttachmentTemplate::of_rigid(&pose, foot));
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
        let objects: Vec<_> = self.rigid_attachments.iter().map(|c| c.object).collect();
        let bodies = self.bodies(&blocks, &checks, &objects, &active);
        let moving = bodies.moving_bodies();
        let checks_move = checks.iter().flat_map(joints_of).any(|joint| moving.contains(&joint.at()));
        let moves = self.moves(&active);
        let root = self.standing_root();
        let lanes = LaneProgram::new(self.robot, &bodies, &blocks, &moves, active.len());
        ConstraintProgram {
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
            rigid_attachments: self.rigid_attachments.clone(),
            blocks,
            checks,
            check_rows,
            checks_move,
            decoded,
            moments,
            bodies,
            bodies_count: self.robot.joints.len(),
            size: self.robot.space.size(),
        }
    }

    /// Sorts rigid attachments so that a carrier's own comes first: by the number of attachments below.
    fn order_attachments(&mut self) {
        let tree = &self.tree;
        self.rigid_attachments.sort_by_key(|c| tree.chain(c.carrier).filter(|&j| tree.is_carried(j)).count());
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
        let balanced = |balance: &CentreOfMass| {
            let masses = masses(&balance.masses, balance.frame.joint);
            let kind = Kind::Balance { balance: balance.clone(), masses };
            Block { source, first: 0, rows: balance.rows.len(), kind }
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
            Constraint::CentreOfMass(balance) => balanced(balance),
            Constraint::Tilt(tilt) => balanced(&tilt.as_weighted_sum()),
            Constraint::Region(region) => balanced(&region.as_weighted_sum()),
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
            if joint.motion == JointType::FreeFlyer
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
        if joint.motion != JointType::FreeFlyer {
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
        let carried = self.rigid_attachments.iter().filter_map(AttachmentTemplate::slot);
        locked.chain(remaining).chain(carried).max().map_or(0, |slot| slot.saturating_add(1))
    }
}
