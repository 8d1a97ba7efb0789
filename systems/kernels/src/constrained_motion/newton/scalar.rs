//! Damped Gauss–Newton on the free coordinates, with saturation at joint limits.

use crate::constrained_motion::newton::settings::{Outcome, Settings};
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::constrained_motion::program::scratch::Scratch;
use crate::constrained_motion::rows::blocks::locked_value;
use crate::constrained_motion::rows::bodies;
use crate::constrained_motion::rows::coordinates::{Move, largest};
use crate::lanes::level::Level;
use crate::linear::{ldlt, wide_ldlt};
use foliate_components::Pose;
use foliate_components::pose::exp_so3;
use foliate_components::robot::configuration::quaternion;
use glam::DVec3;
use std::ops::RangeInclusive;

/// Systems of so many rows are solved with their numbers side by side.
const WIDE: RangeInclusive<usize> = 7..=wide_ldlt::MOST_WIDE;

/// Moves `q` onto the program's constraints, with the leaf parameters `arguments`.
///
/// Coordinates that no row depends on keep their values; locked ones get theirs; free ones end within their bounds exactly.
/// Eliminated objects are written where their carriers take them (their own bounds are not checked), the root of a robot
/// that stands on a foot where that foot puts it (its bounds are checked in the end). Where the outcome is not
/// `Converged`, `q` holds the last iterate, and objects and such a root are stale.
#[must_use]
pub fn project(
    program: &ConstraintProgram,
    q: &mut [f64],
    arguments: &[Pose],
    settings: &Settings,
    scratch: &mut Scratch,
) -> Outcome {
    if !program.fits(q, arguments) {
        return Outcome::Malformed;
    }
    let program = program.solved();
    if let Some(outcome) = program.begin(q, arguments, settings, scratch) {
        return outcome;
    }
    let outcome = program.iterate(q, arguments, settings, scratch);
    if outcome.is_converged() {
        program.close(q, scratch);
        if !program.root_is_within(q) {
            return Outcome::RootOutOfBounds;
        }
    }
    outcome
}

impl ConstraintProgram {
    /// Reads the arguments, locks and clamps coordinates, finds the bodies that do not move and asks the checks. What is said
    /// here ends the solve.
    pub(crate) fn begin(
        &self,
        q: &mut [f64],
        arguments: &[Pose],
        settings: &Settings,
        scratch: &mut Scratch,
    ) -> Option<Outcome> {
        if !self.fits(q, arguments) {
            return Some(Outcome::Malformed);
        }
        scratch.prepare(self);
        if !self.resolve(arguments, scratch) {
            return Some(Outcome::Malformed);
        }
        for lock in &self.locked {
            q[lock.coordinate] = locked_value(lock.value, arguments);
        }
        self.clamp(q);
        bodies::run(&self.bodies.still, q, &scratch.rigid_attachments, &mut scratch.X_WJ);
        if self.checks_move {
            bodies::run(&self.bodies.moving, q, &scratch.rigid_attachments, &mut scratch.X_WJ);
        }
        let (failed, residual) = self.failed_check(q, arguments, settings.tolerance, scratch);
        failed.map(|constraint| Outcome::Contradicted { constraint, residual })
    }

    fn iterate(&self, q: &mut [f64], arguments: &[Pose], settings: &Settings, scratch: &mut Scratch) -> Outcome {
        let rows = self.rows();
        let mut best = f64::INFINITY;
        let mut since_halved = 0;
        for iterations in 0..=settings.iterations {
            bodies::run(&self.bodies.moving, q, &scratch.rigid_attachments, &mut scratch.X_WJ);
            let residual = self.evaluate(q, arguments, scratch);
            if residual <= settings.tolerance {
                return Outcome::Converged { iterations, residual };
            }
            let squared: f64 = scratch.values[..rows].iter().map(|e| e * e).sum();
            since_halved += 1;
            if squared <= 0.5 * best {
                (best, since_halved) = (squared, 0);
            }
            if since_halved >= settings.patience || !squared.is_finite() {
                return Outcome::Stagnated { iterations, residual };
            }
            if iterations == settings.iterations {
                return Outcome::LimitReached { residual };
            }
            if !self.newton_step(q, squared, settings, scratch) {
                return Outcome::Stagnated { iterations, residual };
            }
        }
        Outcome::Malformed // not reached: the last round returns
    }

    /// One step; false where nothing can move.
    fn newton_step(&self, q: &mut [f64], squared: f64, settings: &Settings, scratch: &mut Scratch) -> bool {
        let damping = settings.damping * squared + settings.damping_floor;
        scratch.frozen[..self.active.len()].fill(false);
        self.freeze_by_gradient(q, scratch);
        // A coordinate at its bound that the step would push out is frozen too, and the step taken again without it.
        for _ in 0..3 {
            if !self.solve_step(damping, settings.level, scratch) {
                return false;
            }
            if !self.freeze_by_step(q, scratch) {
                break;
            }
        }
        let most = largest(scratch.step[..self.active.len()].iter().copied());
        if most <= 1e-14 || most == f64::INFINITY {
            return false;
        }
        let scale = if most > settings.step_limit { settings.step_limit / most } else { 1.0 };
        self.integrate(q, scale, &scratch.step);
        true
    }

    /// Solves (J·Jᵀ + λ²) y = e, step = −Jᵀ·y.
    fn solve_step(&self, damping: f64, level: Level, scratch: &mut Scratch) -> bool {
        let (rows, width) = (self.rows(), self.active.len());
        let Scratch { values, jacobian, gram, wide, multipliers, step, .. } = scratch;
        multipliers[..rows].copy_from_slice(&values[..rows]);
        let jacobian = &jacobian[..rows * width];
        let is_solved = if level != Level::scalar() && WIDE.contains(&rows) {
            wide_ldlt::solve_damped_wide(jacobian, rows, damping, level, wide, &mut multipliers[..rows])
        } else {
            ldlt::solve_damped(jacobian, rows, damping, gram, multipliers)
        };
        if !is_solved {
            return false;
        }
        for (s, column) in step.iter_mut().zip(jacobian.chunks_exact(rows.max(1))) {
            *s = -column.iter().zip(&multipliers[..rows]).map(|(j, y)| j * y).sum::<f64>();
        }
        true
    }

    /// Freezes coordinates at a bound that the gradient of ½|e|² pushes outward: their columns become zero.
    fn freeze_by_gradient(&self, q: &[f64], scratch: &mut Scratch) {
        let rows = self.rows();
        for change in &self.moves {
            let Some((variable, side)) = change.at_bound(q) else { continue };
            let column = &scratch.jacobian[variable * rows..][..rows];
            let gradient: f64 = column.iter().zip(&scratch.values).map(|(j, e)| j * e).sum();
            if side * -gradient > 0.0 {
                freeze(variable, rows, scratch);
            }
        }
    }

    /// Freezes coordinates at a bound that the step pushes outward; whether there were any.
    fn freeze_by_step(&self, q: &[f64], scratch: &mut Scratch) -> bool {
        let rows = self.rows();
        let mut any = false;
        for change in &self.moves {
            let Some((variable, side)) = change.at_bound(q) else { continue };
            if !scratch.frozen[variable] && side * scratch.step[variable] > 0.0 {
                freeze(variable, rows, scratch);
                any = true;
            }
        }
        any
    }

    fn integrate(&self, q: &mut [f64], scale: f64, step: &[f64]) {
        for change in &self.moves {
            match *change {
                Move::Scalar { variable, coordinate, lower, upper } => {
                    q[coordinate] = (q[coordinate] + scale * step[variable]).max(lower).min(upper);
                }
                Move::Turn { variable: v, coordinate } => {
                    let turn = DVec3::new(step[v], step[v + 1], step[v + 2]) * scale;
                    let r = (quaternion(q, coordinate) * exp_so3(turn)).normalize();
                    q[coordinate + 3..coordinate + 7].copy_from_slice(&[r.x, r.y, r.z, r.w]);
                }
            }
        }
    }

    fn clamp(&self, q: &mut [f64]) {
        for change in &self.moves {
            if let Move::Scalar { coordinate, lower, upper, .. } = *change {
                q[coordinate] = q[coordinate].max(lower).min(upper);
            }
        }
    }
}

fn freeze(variable: usize, rows: usize, scratch: &mut Scratch) {
    scratch.frozen[variable] = true;
    scratch.jacobian[variable * rows..][..rows].fill(0.0);
}
