//! How far rows are from zero at several configurations side by side.

use crate::constrained_motion::newton::lane_jobs::fill;
use crate::constrained_motion::newton::lanes::evaluate_values;
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::constrained_motion::program::scratch::Scratch;
use crate::constrained_motion::rows::bodies;
use crate::lanes::{F64Row, Level};
use foliate_components::Pose;

/// Configurations side by side.
const LANES: usize = F64Row::LANES;

impl ConstraintProgram {
    /// As [`Self::longest_error`] of several configurations, one after the other in `configurations`; infinite where one does
    /// not fit. Programs that have a form for lanes are evaluated eight at a time at that level. Lanes place bodies to within
    /// a few nanometres of where the scalar code does, which is nothing beside the tolerance of a solve.
    pub(crate) fn longest_errors(
        &self,
        configurations: &[f64],
        arguments: &[Pose],
        level: Level,
        scratch: &mut Scratch,
        errors: &mut Vec<f64>,
    ) {
        let size = self.configuration_size().max(1);
        errors.clear();
        // Checks are not evaluated in lanes.
        let lanes = self.lanes.as_ref().filter(|_| level != Level::scalar() && self.checks.is_empty());
        let Some(lanes) = lanes else {
            let error = |q: &[f64]| self.longest_error(q, arguments, scratch).unwrap_or(f64::INFINITY);
            return errors.extend(configurations.chunks_exact(size).map(error));
        };
        let mut memory = std::mem::take(&mut scratch.probe_lanes);
        for side_by_side in configurations.chunks(LANES * size) {
            memory.prepare(lanes, size);
            let first = errors.len();
            for (lane, q) in side_by_side.chunks_exact(size).enumerate() {
                scratch.prepare(self);
                let fits = self.fits(q, arguments) && self.resolve(arguments, scratch);
                if fits {
                    bodies::run(&self.bodies.still, q, &scratch.rigid_attachments, &mut scratch.X_WJ);
                    fill(lanes, (q, arguments), scratch, lane, &mut memory);
                }
                errors.push(if fits { 0.0 } else { f64::INFINITY });
            }
            evaluate_values(lanes, level, &mut memory);
            for (lane, error) in errors[first..].iter_mut().enumerate() {
                scratch.values.iter_mut().zip(&memory.values).for_each(|(value, row)| *value = row[lane]);
                *error = error.max(self.longest_vector(&scratch.values));
            }
        }
        scratch.probe_lanes = memory;
    }
}
