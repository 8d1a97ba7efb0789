//! What changes of a path read, and the buffers of a thread.

use crate::improvement::changes::limbs::Limbs;
use crate::improvement::cost::{PathCost, way_along};
use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::PlanningModel;
use crate::search::path_extraction::unwrap_coordinates;
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

    /// Makes the numbers of all motions continuous.
    pub(crate) fn unwrap_angles(&self, motions: &mut [LeafMotion]) {
        let size = self.size();
        unwrap_coordinates(self.model, motions.iter_mut().flat_map(|motion| motion.knots.chunks_exact_mut(size)));
    }
}
