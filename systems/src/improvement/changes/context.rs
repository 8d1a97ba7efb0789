//! What changes of a path read, and the buffers of a thread.

use crate::improvement::changes::limbs::Limbs;
use crate::improvement::cost::{PathCost, way_along};
use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::PlanningModel;
use crate::search::path_extraction::unwrap_coordinates;
use crate::search::timed_certificate::object_numbers;
use crate::settings::SearchSettings;
use foliate_components::Pose;
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
const ROUNDING: f64 = 1e-12;

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
        let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
        kinematics.forward(q, &mut X_WJ);
        kinematics.carry(q, rigid_attachments, &mut X_WJ);
        kinematics.write_back(rigid_attachments, &X_WJ, q);
    }

    /// Whether all coordinates of a motion are within their bounds, but for objects that something carries. Motions are straight between
    /// knots, and dense where they are not.
    pub(crate) fn is_within_bounds(&self, motion: &LeafMotion) -> bool {
        let space = &self.model.problem.robot.space;
        let objects = object_numbers(self.model);
        let is_within = |q: &[f64]| {
            (0..space.size()).all(|i| {
                let is_in = q[i] >= space.lower[i] - ROUNDING && q[i] <= space.upper[i] + ROUNDING;
                is_in || objects.iter().any(|numbers| numbers.contains(&i))
            })
        };
        motion.knots.chunks_exact(space.size()).all(is_within)
    }

    /// Makes the numbers of all motions continuous.
    pub(crate) fn unwrap_angles(&self, motions: &mut [LeafMotion]) {
        let size = self.size();
        unwrap_coordinates(self.model, motions.iter_mut().flat_map(|motion| motion.knots.chunks_exact_mut(size)));
    }
}
