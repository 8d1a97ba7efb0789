//! One connection to be certified: a straight motion on a leaf, or the motions of an unvalidated edge.
//!
//! It holds copies of all that it needs, so that a thread can certify it without the world.

use crate::exploration::edges::{Obstacle, UnvalidatedEdges, Verdict};
use crate::planning_model::model::PlanningModel;
use crate::settings::SearchSettings;
use crate::step::{steering, validation};
use foliate_components::Pose;
use foliate_components::graph::leaf::{LeafId, LeafIndex};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::roadmap::{Motion, NodeId, Roadmap};
use foliate_kernels::collision::CollisionScratch;
use foliate_kernels::constrained_motion::MotionScratch;
use foliate_kernels::kinematics::RigidAttachment;

/// Buffers of one thread.
pub(crate) type ConnectionScratch = (CollisionScratch, MotionScratch);

/// What is to be tried between two nodes, with all that it takes: whoever certifies it needs no world.
pub(crate) enum Attempt {
    /// The straight motion between two nodes of one leaf.
    Straight(Straight),
    /// The motions of an unvalidated edge.
    UnvalidatedEdge(Vec<(Motion, StateId, Vec<RigidAttachment>)>),
}

/// A motion to be steered and certified within a leaf.
pub(crate) struct Straight {
    transition: TransitionId,
    state: StateId,
    leaf: LeafId,
    rigid_attachments: Vec<RigidAttachment>,
    /// Right-hand sides of the rows that are left on the leaf.
    arguments: Vec<Pose>,
    ends: (Vec<f64>, Vec<f64>),
}

impl Attempt {
    /// `None` where there is no unvalidated edge, nor any motion within the leaf.
    pub(crate) fn new(
        model: &PlanningModel,
        (roadmap, leaves, unvalidated_edges): (Roadmap<'_>, &LeafIndex, &UnvalidatedEdges<'_, '_>),
        (from, to): (NodeId, NodeId),
    ) -> Option<Self> {
        if let Some(unvalidated_edge) = unvalidated_edges.between(from, to) {
            let with_attachments = |motion: &Motion| {
                let leaf = leaves.leaf(motion.leaf);
                (motion.clone(), leaf.state, model.attachments_of_leaf(leaf, leaves))
            };
            return Some(Self::UnvalidatedEdge(unvalidated_edge.motions.iter().map(with_attachments).collect()));
        }
        let row = roadmap.node(from);
        let leaf = leaves.leaf(row.leaf);
        Some(Self::Straight(Straight {
            transition: model.graph.loop_of(row.state)?,
            state: row.state,
            leaf: row.leaf,
            rigid_attachments: model.attachments_of_leaf(leaf, leaves),
            arguments: steering::arguments_on(model, leaf, leaves)?,
            ends: (roadmap.configuration(from).to_vec(), roadmap.configuration(to).to_vec()),
        }))
    }

    /// The certified motions, whole or not at all.
    pub(crate) fn certify(
        &self,
        model: &PlanningModel,
        settings: &SearchSettings,
        (collision, motion): &mut ConnectionScratch,
    ) -> Verdict {
        collision.set_level(settings.level);
        match self {
            Self::Straight(straight) => {
                straight.certify(model, settings, (collision, motion)).map(|motion| vec![motion])
            }
            Self::UnvalidatedEdge(motions) => motions
                .iter()
                .map(|(motion, state, rigid_attachments)| {
                    let (transition, knots) = (motion.transition, &motion.knots);
                    validation::certify_whole(
                        model,
                        settings,
                        (transition, *state),
                        rigid_attachments,
                        knots,
                        collision,
                    )
                    .map(|clearance| Motion { clearance, ..motion.clone() })
                    .map_err(|blocked_by| Obstacle { leg: motion.leg, blocked_by })
                })
                .collect(),
        }
    }
}

impl Straight {
    fn certify(
        &self,
        model: &PlanningModel,
        settings: &SearchSettings,
        (collision, motion): (&mut CollisionScratch, &mut MotionScratch),
    ) -> Result<Motion, Obstacle> {
        let ends = (&*self.ends.0, &*self.ends.1);
        let obstacle = |blocked_by| Obstacle { leg: 0, blocked_by };
        let steered = steering::steer_whole(model, settings, self.state, &self.arguments, ends, motion)
            .ok_or_else(|| obstacle(None))?;
        let (rigid_attachments, knots) = (&self.rigid_attachments, steered.knots);
        let along = (self.transition, self.state);
        let clearance = validation::certify_whole(model, settings, along, rigid_attachments, &knots, collision)
            .map_err(obstacle)?;
        let residual = steered.residual;
        Ok(Motion { transition: self.transition, leg: 0, leaf: self.leaf, knots, clearance, residual })
    }
}
