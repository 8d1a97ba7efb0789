//! Set Connect: new nodes against nodes on the same leaf in other trees (P1 Alg. 3).
//!
//! P1's line 7 asks whether both configurations lie on one leaf of the transition between them; here that is equality of
//! leaf ids, and the transition is the loop of their state. (Across states Alg. 3 would have to invent waypoints; a crossed
//! extension does that on purpose, with a leaf it has chosen.)

use crate::commit::NewNodes;
use crate::errands::Errands;
use crate::events::StopSignal;
use crate::foreseen::{Foreseen, Prospect};
use crate::model::PlanningModel;
use crate::neighbours::Neighbours;
use crate::parallel::each;
use crate::passages::Passages;
use crate::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use crate::{steering, validation};
use bevy_ecs::prelude::{Local, Res, ResMut, Resource};
use foliate_components::Pose;
use foliate_components::graph::leaf::{LeafId, LeafIndex};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::roadmap::{Motion, NodeId, Roadmap};
use foliate_components::robot::ShapeIndex;
use foliate_kernels::collision::CollisionScratch;
use foliate_kernels::constrained_motion::MotionScratch;
use foliate_kernels::kinematics::Carriage;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A motion that would join two trees.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// A new node, or the one that a passage leads from.
    pub from: NodeId,
    /// A node in another tree: on the same leaf, or the one that the passage leads to.
    pub to: NodeId,
    /// What became of it, once that is known.
    pub verdict: Option<Verdict>,
}

/// The certified motions of a connection, end to end, or what is in the way.
pub type Verdict = Result<Vec<Motion>, Obstacle>;

/// Why two nodes are not joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Obstacle {
    /// Number of the leg that is not free.
    pub leg: u32,
    /// The pair of shapes that stopped it, where one did.
    pub blocked_by: Option<(ShapeIndex, ShapeIndex)>,
}

impl Connection {
    /// A proposal.
    #[must_use]
    pub fn between(from: NodeId, to: NodeId) -> Self {
        Self { from, to, verdict: None }
    }

    /// Whether it is certified.
    #[must_use]
    pub fn is_certified(&self) -> bool {
        matches!(self.verdict, Some(Ok(_)))
    }
}

/// Buffers of one thread.
pub(crate) type ConnectionScratch = (CollisionScratch, MotionScratch);

/// The connections of this step, in order of proposal.
#[derive(Clone, Debug, Default, Resource)]
pub struct Connections(pub Vec<Connection>);

/// Pairs every new node with the nearest nodes of its leaf in each other tree.
pub fn propose_connections(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    roadmap: Res<'_, Roadmap>,
    neighbours: Res<'_, Neighbours>,
    mut new: ResMut<'_, NewNodes>,
    mut connections: ResMut<'_, Connections>,
) {
    let new = std::mem::take(&mut new.0);
    let pairs = neighbours.of_other_trees(&model, &roadmap, &new, settings.connect_neighbours);
    connections.0.clear();
    connections.0.extend(pairs.into_iter().map(|(from, to)| Connection::between(from, to)));
}

/// Steers and certifies the proposals; whole or not at all. Of those that would join the same two trees all behind the
/// first that is certified are left out: its edge makes them needless. Threads for which none is left go on with what is
/// foreseen.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn certify_connections(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    roadmap: Res<'_, Roadmap>,
    leaves: Res<'_, LeafIndex>,
    passages: Res<'_, Passages>,
    foreseen: Res<'_, Foreseen>,
    errands: Res<'_, Errands>,
    mut connections: ResMut<'_, Connections>,
    buffers: Local<'_, ScratchPool<ConnectionScratch>>,
) {
    let buffers = &*buffers;
    let bridges = Bridges::new(&connections.0, &roadmap);
    // In order: what stands in front makes what is behind needless. What another thread is at already comes last, so that
    // nobody waits for it who could do something else.
    let mut proposals: Vec<_> = connections.0.iter_mut().enumerate().collect();
    proposals.sort_by_key(|(_, c)| foreseen.of(c.from, c.to).is_some_and(Prospect::is_under_way));
    let left = AtomicUsize::new(proposals.len());
    each(
        &mut proposals,
        || buffers.borrow(),
        |scratch, (index, connection)| {
            let index = *index;
            if left.fetch_sub(1, Ordering::Relaxed) == 1 {
                foreseen.release(&errands);
            }
            if !stop.is_raised() && !bridges.is_needless(index) {
                let ends = (connection.from, connection.to);
                connection.verdict = match foreseen.of(ends.0, ends.1) {
                    Some(prospect) => Some(prospect.certify(scratch)),
                    None => Attempt::new(&model, (&roadmap, &leaves, &passages), ends)
                        .map(|attempt| attempt.certify(&model, &settings, scratch)),
                };
                if connection.is_certified() {
                    bridges.build(index);
                }
            }
        },
    );
    // What other threads have certified behind the first is no part of the answer.
    let needless = connections.0.iter_mut().enumerate().filter(|&(index, _)| bridges.is_needless(index));
    needless.for_each(|(_, connection)| connection.verdict = None);
}

/// For every two trees the first proposal that has joined them. It is the same whatever the threads do: a proposal is left
/// out only where one in front of it was certified.
struct Bridges {
    /// By proposal: which two trees, as an index into `first`.
    trees: Vec<usize>,
    first: Vec<AtomicUsize>,
}

impl Bridges {
    fn new(proposals: &[Connection], roadmap: &Roadmap) -> Self {
        let joined = |proposal: &Connection| {
            let (a, b) = (roadmap.component_of(proposal.from), roadmap.component_of(proposal.to));
            (a.min(b), a.max(b))
        };
        let joined: Vec<_> = proposals.iter().map(joined).collect();
        let mut pairs = joined.clone();
        pairs.sort_unstable();
        pairs.dedup();
        let trees = joined.iter().map(|pair| pairs.partition_point(|p| p < pair)).collect();
        Self { trees, first: pairs.iter().map(|_| AtomicUsize::new(usize::MAX)).collect() }
    }

    fn is_needless(&self, proposal: usize) -> bool {
        self.first[self.trees[proposal]].load(Ordering::Relaxed) < proposal
    }

    fn build(&self, proposal: usize) {
        self.first[self.trees[proposal]].fetch_min(proposal, Ordering::Relaxed);
    }
}

/// What is to be tried between two nodes, with all that it takes: whoever certifies it needs no world.
pub(crate) enum Attempt {
    /// The straight motion between two nodes of one leaf.
    Straight(Straight),
    /// The motions of a passage.
    Passage(Vec<(Motion, StateId, Vec<Carriage>)>),
}

/// A motion to be steered and certified within a leaf.
pub(crate) struct Straight {
    transition: TransitionId,
    state: StateId,
    leaf: LeafId,
    carriages: Vec<Carriage>,
    /// Right-hand sides of the rows that are left on the leaf.
    arguments: Vec<Pose>,
    ends: (Vec<f64>, Vec<f64>),
}

impl Attempt {
    /// `None` where there is no passage, nor any motion within the leaf.
    pub(crate) fn new(
        model: &PlanningModel,
        (roadmap, leaves, passages): (&Roadmap, &LeafIndex, &Passages),
        (from, to): (NodeId, NodeId),
    ) -> Option<Self> {
        if let Some(passage) = passages.between(from, to) {
            let with_carriages = |motion: &Motion| {
                let leaf = leaves.leaf(motion.leaf);
                (motion.clone(), leaf.state, model.carriages_of_leaf(leaf, leaves))
            };
            return Some(Self::Passage(passage.motions.iter().map(with_carriages).collect()));
        }
        let row = roadmap.node(from);
        let leaf = leaves.leaf(row.leaf);
        Some(Self::Straight(Straight {
            transition: model.graph.loop_of(row.state)?,
            state: row.state,
            leaf: row.leaf,
            carriages: model.carriages_of_leaf(leaf, leaves),
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
            Self::Passage(motions) => motions
                .iter()
                .map(|(motion, state, carriages)| {
                    let (transition, knots) = (motion.transition, &motion.knots);
                    validation::certify_whole(model, settings, (transition, *state), carriages, knots, collision)
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
        let (carriages, knots) = (&self.carriages, steered.knots);
        let along = (self.transition, self.state);
        let clearance =
            validation::certify_whole(model, settings, along, carriages, &knots, collision).map_err(obstacle)?;
        let residual = steered.residual;
        Ok(Motion { transition: self.transition, leg: 0, leaf: self.leaf, knots, clearance, residual })
    }
}
