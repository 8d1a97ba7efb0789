//! What changes of a path read, and the buffers of a thread.

use crate::improvement::changes::limbs::Limbs;
use crate::improvement::cost::{PathCost, way_along};
use crate::improvement::leaf_motion::{LeafMotion, moves_fingers};
use crate::planning_model::model::PlanningModel;
use crate::search::path_extraction::unwrap_coordinates;
use crate::search::timed_certificate::{object_numbers, resting_out_of_bounds};
use crate::settings::SearchSettings;
use crate::step::validation::certify_whole;
use foliate_kernels::collision::CollisionScratch;
use foliate_kernels::constrained_motion::{MotionScratch, Scratch};
use foliate_kernels::kinematics::RigidAttachment;

/// What every change reads.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub model: &'a PlanningModel,
    pub settings: &'a SearchSettings,
    /// As `settings`, with the clearance that shortcuts keep.
    pub with_room: &'a SearchSettings,
    pub cost: &'a dyn PathCost,
    pub limbs: &'a Limbs,
}

/// Buffers of one thread.
#[derive(Debug, Default)]
pub struct ImprovementScratch {
    pub(crate) collision: CollisionScratch,
    pub(crate) motion: MotionScratch,
    pub(crate) solve: Scratch,
}

/// How far beyond its bounds a coordinate may be: rounding, radians and metres.
const ROUNDING: f64 = 1e-9;

impl Context<'_> {
    /// Length of a configuration.
    pub(crate) fn size(&self) -> usize {
        self.model.problem.robot.space.size()
    }

    /// The way along some configurations.
    pub(crate) fn way(&self, knots: &[&[f64]]) -> f64 {
        way_along(self.cost, self.model, knots.iter().copied())
    }

    /// Writes carried objects of a configuration where their carriers take them.
    pub(crate) fn carry(&self, rigid_attachments: &[RigidAttachment], q: &mut [f64]) {
        let kinematics = &self.model.kinematics;
        let mut X_WJ = kinematics.poses(q);
        kinematics.carry(q, rigid_attachments, &mut X_WJ);
        kinematics.write_back(rigid_attachments, &X_WJ, q);
    }

    /// Whether joints and roots of robots are within their bounds at all knots of some motions, objects that no hand holds where a motion
    /// begins and ends, and fingers move alone. Motions are straight between knots, or dense.
    pub(crate) fn are_within_bounds(&self, motions: &[LeafMotion]) -> bool {
        let space = &self.model.problem.robot.space;
        let objects = object_numbers(self.model);
        let of_robots: Vec<usize> =
            (0..space.size()).filter(|i| !objects.iter().any(|numbers| numbers.contains(i))).collect();
        let is_in = |q: &[f64], i: usize| q[i] >= space.lower[i] - ROUNDING && q[i] <= space.upper[i] + ROUNDING;
        motions.iter().all(|motion| {
            let rest = [motion.start(space.size()), motion.end(space.size())];
            motion.knots.chunks_exact(space.size()).all(|q| of_robots.iter().all(|&i| is_in(q, i)))
                && self.moves_fingers_alone(motion)
                && rest.iter().all(|q| resting_out_of_bounds(self.model, motion.state, q, ROUNDING).is_none())
        })
    }

    /// Whether nothing else of the robot moves while fingers do.
    fn moves_fingers_alone(&self, motion: &LeafMotion) -> bool {
        if !moves_fingers(motion) {
            return true;
        }
        let (size, objects) = (self.size(), object_numbers(self.model));
        let fingers: Vec<usize> = self.model.moving_fingers(motion.fingers).collect();
        let stands = |i: &usize| !fingers.contains(i) && objects.iter().all(|numbers| !numbers.contains(i));
        let start = motion.start(size);
        motion.knots.chunks_exact(size).all(|q| (0..size).filter(stands).all(|i| q[i] == start[i]))
    }

    /// Whether a motion is certified to be free of collisions, with the search's own clearance.
    pub(crate) fn is_free(&self, motion: &LeafMotion, collision: &mut CollisionScratch) -> bool {
        let (along, attachments) = ((motion.transition, motion.state), &motion.rigid_attachments);
        certify_whole(self.model, self.settings, along, attachments, &motion.knots, collision).is_ok()
    }

    /// Makes the numbers of all motions continuous.
    pub(crate) fn unwrap_angles(&self, motions: &mut [LeafMotion]) {
        let size = self.size();
        unwrap_coordinates(self.model, motions.iter_mut().flat_map(|motion| motion.knots.chunks_exact_mut(size)));
    }
}
