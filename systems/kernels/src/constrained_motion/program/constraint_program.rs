//! A compiled set of constraints.

use crate::constrained_motion::bounds::residual_bound::ResidualBound;
use crate::constrained_motion::lane_rows::form::LaneProgram;
use crate::constrained_motion::program::scratch::Scratch;
use crate::constrained_motion::rows::blocks::{Block, Inputs, Kind, locked_value};
use crate::constrained_motion::rows::bodies;
use crate::constrained_motion::rows::bodies::Bodies;
use crate::constrained_motion::rows::coordinates::{LockedCoordinate, Move, StandingRoot, WriteBack, largest};
use crate::constrained_motion::rows::rigid_attachment::AttachmentTemplate;
use crate::constraints::placement;
use crate::kinematics::forward::RigidAttachment;
use crate::lanes::level::Level;
use foliate_components::Pose;
use glam::DVec3;

/// Constraints in the form in which they are solved: eliminated objects, locked coordinates, and a small Newton problem
/// in those free coordinates that its rows depend on. Immutable; leaf parameters are arguments of each solve.
#[derive(Clone, Debug)]
pub struct ConstraintProgram {
    /// Free velocity coordinates: joints neither locked nor eliminated.
    pub(crate) variables: Vec<usize>,
    /// Those of them that rows depend on: the columns of the Newton problem.
    pub(crate) active: Vec<usize>,
    /// How the active variables move a configuration.
    pub(crate) moves: Vec<Move>,
    pub(crate) locked: Vec<LockedCoordinate>,
    /// In dependency order: a carrier's own attachment comes first.
    pub(crate) rigid_attachments: Vec<AttachmentTemplate>,
    /// How each carried object is written into a configuration, as `rigid_attachments`.
    pub(crate) written: Vec<WriteBack>,
    pub(crate) blocks: Vec<Block>,
    /// Constraints that no variable touches.
    pub(crate) checks: Vec<Block>,
    pub(crate) check_rows: usize,
    /// Whether a check compares bodies that variables move together.
    pub(crate) checks_move: bool,
    pub(crate) decoded: usize,
    /// Moments of masses that one block works with, at most.
    pub(crate) moments: usize,
    pub(crate) bodies: Bodies,
    pub(crate) bodies_count: usize,
    pub(crate) arguments: usize,
    pub(crate) size: usize,
    pub(crate) bound: ResidualBound,
    /// The same for lanes, where every part has a form for them.
    pub(crate) lanes: Option<LaneProgram>,
    /// The same with a free-flying robot's root eliminated, where a foot of it stands in the world: what is solved. Rows
    /// and bounds are those of the robot as written, for that is what moves.
    pub(crate) standing: Option<Box<ConstraintProgram>>,
    /// The root that a foot puts in its place; only in a program that is another one's `standing`.
    pub(crate) root: Option<StandingRoot>,
}

/// How far a configuration is from satisfying a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Largest row of the implicit constraints and checks, with eliminated objects where their carriers take them; m, rad.
    pub rows: f64,
    /// Largest component of the difference between eliminated objects' poses in the configuration and where their
    /// carriers take them; m, rad.
    pub objects: f64,
}

impl ConstraintProgram {
    /// Free velocity coordinates: those of joints that are neither locked nor eliminated, in ascending order.
    #[must_use]
    pub fn variables(&self) -> &[usize] {
        &self.variables
    }

    /// The free velocity coordinates that rows depend on, in ascending order; a solve changes no other.
    #[must_use]
    pub fn active(&self) -> &[usize] {
        &self.active
    }

    /// Number of implicit rows: the equations of the Newton problem.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.blocks.iter().map(|block| block.rows).sum()
    }

    /// Whether many problems of this program are solved side by side in lanes; otherwise one after another.
    #[must_use]
    pub fn is_for_lanes(&self) -> bool {
        self.solved().lanes.as_ref().is_some_and(|lanes| !lanes.turns_roots)
    }

    /// The form in which lanes of a level solve it, where there are any.
    pub(crate) fn lanes_at(&self, level: Level) -> Option<&LaneProgram> {
        self.lanes.as_ref().filter(|lanes| !lanes.turns_roots && level != Level::scalar())
    }

    /// Variables and rows of the Newton problem that a solve works on: without the root of a robot that stands on a foot,
    /// and without the foot's rows.
    #[must_use]
    pub fn equations(&self) -> (usize, usize) {
        let solved = self.solved();
        (solved.active.len(), solved.rows())
    }

    /// The program in the form in which it is solved.
    pub(crate) fn solved(&self) -> &Self {
        self.standing.as_deref().unwrap_or(self)
    }

    /// Number of constraints that no variable touches.
    #[must_use]
    pub fn checks(&self) -> usize {
        self.checks.len()
    }

    /// Eliminated objects, in dependency order.
    #[must_use]
    pub fn rigid_attachments(&self) -> &[AttachmentTemplate] {
        &self.rigid_attachments
    }

    /// How many arguments a solve needs: one more than the largest slot that is named.
    #[must_use]
    pub fn arguments(&self) -> usize {
        self.arguments
    }

    /// Length of a configuration.
    #[must_use]
    pub fn configuration_size(&self) -> usize {
        self.size
    }

    /// The bound on how far the rows leave zero between two knots.
    #[must_use]
    pub fn residual_bound(&self) -> &ResidualBound {
        &self.bound
    }

    /// The rigid attachments with their poses taken from the arguments, for
    /// [`Kinematics::carry`](crate::kinematics::forward::Kinematics::carry). Returns false where an argument is missing or
    /// names polygons that its placement does not have; `out` is then incomplete.
    pub fn resolve_attachments(&self, arguments: &[Pose], out: &mut Vec<RigidAttachment>) -> bool {
        out.clear();
        out.extend(self.rigid_attachments.iter().map_while(|template| template.resolve(arguments)));
        out.len() == self.rigid_attachments.len()
    }

    /// How far `q` is from satisfying the program; `None` where configuration or arguments do not fit it.
    ///
    /// Locked joints count among the rows.
    #[must_use]
    pub fn deviation(&self, q: &[f64], arguments: &[Pose], scratch: &mut Scratch) -> Option<Deviation> {
        let implicit = self.residual(q, arguments, scratch)?;
        let lock = |l: &LockedCoordinate| (q[l.coordinate] - locked_value(l.value, arguments)).abs();
        let rows = self.locked.iter().map(lock).fold(implicit, f64::max);
        let objects = self.written.iter().map(|w| w.distance(q, &scratch.X_WJ)).fold(0.0, f64::max);
        Some(Deviation { rows, objects })
    }

    /// The largest implicit row or check at `q`, with eliminated objects where their carriers take them; `None` where
    /// configuration or arguments do not fit the program. Objects and locked joints in `q` are not compared.
    #[must_use]
    pub fn residual(&self, q: &[f64], arguments: &[Pose], scratch: &mut Scratch) -> Option<f64> {
        let checks = self.measure_all(q, arguments, scratch)?;
        Some(checks.max(largest(scratch.values[..self.rows()].iter().copied())))
    }

    /// As [`Self::residual`], but of what is one vector (a translation, a rotation, what a balance asks) the length, which is
    /// what the bound on second derivatives bounds and what is claimed of a motion.
    pub(crate) fn longest_error(&self, q: &[f64], arguments: &[Pose], scratch: &mut Scratch) -> Option<f64> {
        let checks = self.measure_all(q, arguments, scratch)?;
        Some(self.longest_vector(&scratch.values).max(checks * 3.0_f64.sqrt()))
    }

    /// The longest of the vectors that the values of all implicit rows make; infinite where one of them is not a number.
    pub(crate) fn longest_vector(&self, values: &[f64]) -> f64 {
        let squared = |rows: &[f64]| rows.iter().map(|e| e * e).sum::<f64>();
        let of_block = |block: &Block| {
            let (first, second) = values[block.first..block.first + block.rows].split_at(block.translations());
            [squared(first), squared(second)]
        };
        largest(self.blocks.iter().flat_map(of_block)).sqrt()
    }

    /// Writes the values of all implicit rows, and returns the largest of the checks.
    fn measure_all(&self, q: &[f64], arguments: &[Pose], scratch: &mut Scratch) -> Option<f64> {
        if !self.fits(q, arguments) {
            return None;
        }
        scratch.prepare(self);
        if !self.resolve(arguments, scratch) {
            return None;
        }
        for steps in [&self.bodies.still, &self.bodies.moving, &self.bodies.closing] {
            bodies::run(steps, q, &scratch.rigid_attachments, &mut scratch.X_WJ);
        }
        let checks = self.failed_check(q, arguments, 0.0, scratch).1;
        let Scratch { X_WJ, decoded, memory, values, .. } = scratch;
        for block in &self.blocks {
            block.linearise(Inputs { q, arguments, decoded, X_WJ }, memory, values, &mut [], 0);
        }
        Some(checks)
    }

    /// Whether every row is one and the same smooth function everywhere: with a placement that does not keep to its leaf's
    /// polygons another pair may be in contact elsewhere.
    pub(crate) fn is_smooth(&self) -> bool {
        !self.blocks.iter().any(|block| matches!(&block.kind, Kind::Contact(contact) if contact.part.slot().is_none()))
    }

    /// Whether sizes fit and every number is finite.
    pub(crate) fn fits(&self, q: &[f64], arguments: &[Pose]) -> bool {
        q.len() == self.size
            && arguments.len() >= self.arguments
            && q.iter().all(|x| x.is_finite())
            && arguments[..self.arguments].iter().all(Pose::is_finite)
    }

    /// Reads the arguments: rigid attachments and placements' parameters.
    pub(crate) fn resolve(&self, arguments: &[Pose], scratch: &mut Scratch) -> bool {
        if !self.resolve_attachments(arguments, &mut scratch.rigid_attachments) {
            return false;
        }
        scratch.decoded.clear();
        for block in self.blocks.iter().chain(&self.checks) {
            let Kind::Contact(contact) = &block.kind else { continue };
            let Some(slot) = contact.part.slot() else { continue };
            let Some(decoded) = placement::decode(&contact.placement, &arguments[slot]) else { return false };
            scratch.decoded.push(decoded);
        }
        scratch.decoded.len() == self.decoded
    }

    /// Values and Jacobian of the implicit rows at the current poses; returns the largest absolute value.
    pub(crate) fn evaluate(&self, q: &[f64], arguments: &[Pose], scratch: &mut Scratch) -> f64 {
        let (rows, width) = (self.rows(), self.active.len());
        let Scratch { X_WJ, decoded, memory, values, jacobian, .. } = scratch;
        jacobian[..rows * width].fill(0.0);
        for block in &self.blocks {
            block.linearise(Inputs { q, arguments, decoded, X_WJ }, memory, values, jacobian, rows);
        }
        largest(values[..rows].iter().copied())
    }

    /// The first check whose residual is above the tolerance, and the largest residual so far.
    pub(crate) fn failed_check(
        &self,
        q: &[f64],
        arguments: &[Pose],
        tolerance: f64,
        scratch: &mut Scratch,
    ) -> (Option<usize>, f64) {
        let (mut failed, mut worst) = (None, 0.0_f64);
        let Scratch { X_WJ, decoded, memory, values, .. } = scratch;
        for check in &self.checks {
            check.linearise(Inputs { q, arguments, decoded, X_WJ }, memory, values, &mut [], 0);
            let residual = largest(values[check.first..check.first + check.rows].iter().copied());
            worst = worst.max(residual);
            if failed.is_none() && residual > tolerance {
                failed = Some(check.source);
            }
        }
        (failed, worst)
    }

    /// Writes eliminated objects where their carriers take them. The numbers depend on nothing but the free coordinates
    /// and the arguments: the same leaf gives the same object pose, bit for bit.
    pub(crate) fn close(&self, q: &mut [f64], scratch: &mut Scratch) {
        bodies::run(&self.bodies.closing, q, &scratch.rigid_attachments, &mut scratch.X_WJ);
        for write in &self.written {
            write.write(&scratch.X_WJ, q);
        }
        if let Some(root) = &self.root {
            root.write(&scratch.X_WJ, q);
        }
    }

    /// Whether a root that a foot has put in its place is within its bounds.
    pub(crate) fn root_is_within(&self, q: &[f64]) -> bool {
        self.root.is_none_or(|root| root.is_within(q))
    }
}

impl Scratch {
    /// Makes room for a program; allocates only where an earlier one needed less.
    pub(crate) fn prepare(&mut self, program: &ConstraintProgram) {
        let (rows, width) = (program.rows().max(program.check_rows), program.active.len());
        grow(&mut self.X_WJ, program.bodies_count, Pose::identity());
        grow(&mut self.values, rows, 0.0);
        grow(&mut self.jacobian, rows * width, 0.0);
        grow(&mut self.memory.moments, program.moments, DVec3::ZERO);
        grow(&mut self.gram, rows * rows, 0.0);
        grow(&mut self.multipliers, rows, 0.0);
        grow(&mut self.step, width, 0.0);
        grow(&mut self.frozen, width, false);
    }
}

fn grow<T: Clone>(items: &mut Vec<T>, length: usize, fill: T) {
    if items.len() < length {
        items.resize(length, fill);
    }
}

#[cfg(test)]
mod tests {
    use crate::constrained_motion::rows::coordinates::largest;

    #[test]
    fn what_is_not_a_number_hides_behind_nothing() {
        for values in [[f64::NAN, 1.0, 2.0], [1.0, f64::NAN, 2.0], [1.0, 2.0, f64::NAN]] {
            assert_eq!(largest(values), f64::INFINITY);
        }
        assert_eq!(largest([1.0, -3.0, 2.0]), 3.0);
        assert_eq!(largest([]), 0.0);
    }
}
