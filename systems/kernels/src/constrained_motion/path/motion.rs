//! The entry points: one motion on its leaf, or many.
//!
//! Motions of one program are followed side by side, one per lane ([`project_motions`]): what is solved next to a motion does not
//! change it. A motion alone ([`project_motion`]) is solved in scalar code, which is then faster; its evaluations between two
//! knots are side by side all the same.

use crate::constrained_motion::newton::scalar::project;
use crate::constrained_motion::path::constrained_path::{ConstrainedPath, MotionScratch, PathMemory};
use crate::constrained_motion::path::lane_motion::follow_in_lanes;
use crate::constrained_motion::path::settings::{MotionEnd, MotionJob, MotionSettings};
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use foliate_components::Pose;
use foliate_components::robot::configuration::ConfigurationSpace;

/// Appends to `knots` the motion from `from` towards `to` on the leaf of `arguments`: whole configurations, one after the
/// other, the first of them `from`. Between two knots the residual stays below the path tolerance, by the bound on second
/// derivatives; a motion that stops early is valid as far as it goes.
///
/// Without implicit rows the motion is its two ends. The last knot is `to` bit for bit, but for whole turns of unlimited
/// angles and signs of quaternions, which follow the motion.
pub fn project_motion(
    program: &ConstraintProgram,
    space: &ConfigurationSpace,
    ends: (&[f64], &[f64]),
    arguments: &[Pose],
    settings: &MotionSettings,
    scratch: &mut MotionScratch,
    knots: &mut Vec<f64>,
) -> MotionEnd {
    let MotionScratch { tools, paths } = scratch;
    if paths.is_empty() {
        paths.push(PathMemory::default());
    }
    let Some(memory) = paths.first_mut() else { return MotionEnd::NotOnLeaf };
    let mut path = ConstrainedPath { program, space, arguments, settings, memory, tools };
    if !path.begin(ends, knots) {
        return MotionEnd::NotOnLeaf;
    }
    loop {
        if let Some(end) = path.propose(knots) {
            return end;
        }
        let q = &mut path.memory.next;
        let is_solved = project(program, q, arguments, &settings.solve, &mut path.tools.solve).is_converged();
        path.judge(is_solved, knots);
    }
}

/// Keeps motions on their leaves, as [`project_motion`] does: one motion per lane, the next from the queue as soon as one has
/// ended. What becomes of a motion depends on nothing but itself, the settings and the level: not on how many there are, nor in
/// what order they come. (In lanes last bits differ from those of a motion that is projected alone.)
///
/// Programs that have no form for lanes, and all of them at the level `scalar`, are followed one motion after another.
pub fn project_motions(
    program: &ConstraintProgram,
    space: &ConfigurationSpace,
    jobs: &mut [MotionJob<'_>],
    settings: &MotionSettings,
    scratch: &mut MotionScratch,
) {
    match program.solved().lanes_at(settings.solve.level) {
        Some(lanes) => follow_in_lanes(program, lanes, space, jobs, settings, scratch),
        None => {
            for job in jobs {
                job.end = project_motion(program, space, job.ends, job.arguments, settings, scratch, job.knots);
            }
        }
    }
}
