//! One connection, certified: the motions of an unvalidated edge, or the straight motion between two nodes of a leaf.

use crate::exploration::edges::{Obstacle, UnvalidatedEdges, Verdict};
use crate::planning_model::model::PlanningModel;
use crate::settings::SearchSettings;
use crate::step::{steering, validation};
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::roadmap::{Motion, NodeId, Roadmap, UnvalidatedEdge};
use foliate_kernels::collision::CollisionScratch;
use foliate_kernels::constrained_motion::MotionScratch;

/// Buffers of one thread.
pub(crate) type ConnectionScratch = (CollisionScratch, MotionScratch);

/// What the attempts of a step read.
pub(crate) struct Attempts<'a> {
    pub(crate) model: &'a PlanningModel,
    pub(crate) settings: &'a SearchSettings,
    pub(crate) roadmap: Roadmap<'a>,
    pub(crate) leaves: &'a LeafIndex,
    pub(crate) unvalidated_edges: &'a UnvalidatedEdges<'a, 'a>,
}

impl Attempts<'_> {
    /// The certified motions between two nodes, whole or not at all. Where there is no unvalidated edge, nor any motion
    /// within the leaf, they are blocked.
    pub(crate) fn certify(&self, from: NodeId, to: NodeId, scratch: &mut ConnectionScratch) -> Verdict {
        scratch.0.set_level(self.settings.level);
        match self.unvalidated_edges.between(from, to) {
            Some(edge) => self.certify_unvalidated(edge, &mut scratch.0),
            None => self.certify_straight(from, to, scratch).unwrap_or(Err(Obstacle { leg: 0, blocked_by: None })),
        }
    }

    fn certify_unvalidated(&self, edge: &UnvalidatedEdge, collision: &mut CollisionScratch) -> Verdict {
        let Self { model, settings, leaves, .. } = *self;
        let certify = |motion: &Motion| {
            let leaf = leaves.leaf(motion.leaf);
            let (along, rigid_attachments) = ((motion.transition, leaf.state), model.attachments_of_leaf(leaf, leaves));
            validation::certify_whole(model, settings, along, &rigid_attachments, &motion.knots, collision)
                .map(|clearance| Motion { clearance, ..motion.clone() })
                .map_err(|blocked_by| Obstacle { leg: motion.leg, blocked_by })
        };
        edge.motions.iter().map(certify).collect()
    }

    fn certify_straight(
        &self,
        from: NodeId,
        to: NodeId,
        (collision, motion): &mut ConnectionScratch,
    ) -> Option<Verdict> {
        let Self { model, settings, roadmap, leaves, .. } = *self;
        let row = roadmap.node(from);
        let (transition, leaf) = (model.graph.loop_of(row.state)?, leaves.leaf(row.leaf));
        let arguments = steering::arguments_on(model, leaf, leaves)?;
        let ends = (roadmap.configuration(from), roadmap.configuration(to));
        let obstacle = |blocked_by| Obstacle { leg: 0, blocked_by };
        let mut certify = || {
            let steered = steering::steer_whole(model, settings, row.state, &arguments, ends, motion)
                .ok_or_else(|| obstacle(None))?;
            let (along, rigid_attachments) = ((transition, row.state), model.attachments_of_leaf(leaf, leaves));
            let clearance =
                validation::certify_whole(model, settings, along, &rigid_attachments, &steered.knots, collision)
                    .map_err(obstacle)?;
            let (knots, residual) = (steered.knots, steered.residual);
            Ok(vec![Motion { transition, leg: 0, leaf: row.leaf, knots, clearance, residual }])
        };
        Some(certify())
    }
}
