//! Set Connect: new nodes against nodes on the same leaf in other trees (P1 Alg. 3).
//!
//! P1's line 7 asks whether both configurations lie on one leaf of the transition between them; here that is equality of
//! leaf ids, and the transition is the loop of their state. (Across states Alg. 3 would have to invent waypoints; a crossed
//! extension does that on purpose, with a leaf it has chosen.)

use crate::commit::NewNodes;
use crate::events::StopSignal;
use crate::model::PlanningModel;
use crate::neighbours::Neighbours;
use crate::parallel::each;
use crate::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use crate::{steering, validation};
use bevy_ecs::prelude::{Local, Res, ResMut, Resource};
use foliate_components::leaf::LeafIndex;
use foliate_components::roadmap::{Motion, NodeId, Roadmap};
use foliate_kernels::collision::CollisionScratch;
use foliate_kernels::projection::MotionScratch;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A motion that would join two trees.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// A new node.
    pub from: NodeId,
    /// A node on the same leaf in another tree.
    pub to: NodeId,
    /// The certified motion between them, once there is one.
    pub certified: Option<Motion>,
}

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
    let proposals: Vec<Vec<Connection>> = std::mem::take(&mut new.0)
        .par_iter()
        .map(|&node| {
            let nodes = neighbours.of_other_trees(&model, &roadmap, node, settings.connect_neighbours);
            nodes.into_iter().map(|to| Connection { from: node, to, certified: None }).collect()
        })
        .collect();
    connections.0 = proposals.into_iter().flatten().collect();
}

/// Steers and certifies the proposals; whole or not at all. Of those that would join the same two trees all behind the
/// first that is certified are left out: its edge makes them needless.
pub fn certify_connections(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    roadmap: Res<'_, Roadmap>,
    leaves: Res<'_, LeafIndex>,
    mut connections: ResMut<'_, Connections>,
    buffers: Local<'_, ScratchPool<(CollisionScratch, MotionScratch)>>,
) {
    let buffers = &*buffers;
    let bridges = Bridges::new(&connections.0, &roadmap);
    // In order: what stands in front makes what is behind needless.
    let mut proposals: Vec<_> = connections.0.iter_mut().enumerate().collect();
    each(
        &mut proposals,
        || buffers.borrow(),
        |scratch, (index, connection)| {
            let index = *index;
            scratch.0.set_level(settings.level);
            if !stop.is_raised() && !bridges.is_needless(index) {
                connection.certified = connect(&model, &settings, &roadmap, &leaves, connection, scratch);
                if connection.certified.is_some() {
                    bridges.build(index);
                }
            }
        },
    );
    // What other threads have certified behind the first is no part of the answer.
    let needless = connections.0.iter_mut().enumerate().filter(|&(index, _)| bridges.is_needless(index));
    needless.for_each(|(_, connection)| connection.certified = None);
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

fn connect(
    model: &PlanningModel,
    settings: &SearchSettings,
    roadmap: &Roadmap,
    leaves: &LeafIndex,
    connection: &Connection,
    (collision, motion): &mut (CollisionScratch, MotionScratch),
) -> Option<Motion> {
    let row = roadmap.node(connection.from);
    let transition = model.graph.loop_of(row.state)?;
    let leaf = leaves.leaf(row.leaf);
    let carriages = model.carriages_of_leaf(leaf, leaves);
    let ends = (roadmap.configuration(connection.from), roadmap.configuration(connection.to));
    let steered = steering::steer_whole(model, settings, leaf, leaves, ends, motion)?;
    let clearance =
        validation::certify_whole(model, settings, transition, row.state, &carriages, &steered.knots, collision)?;
    Some(Motion { transition, leg: 0, leaf: row.leaf, knots: steered.knots, clearance, residual: steered.residual })
}
