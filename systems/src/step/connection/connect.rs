//! The systems of set Connect: propose connections of new nodes, and certify them in parallel.

use crate::events::StopSignal;
use crate::exploration::edges::{Connection, Connections, UnvalidatedEdges};
use crate::exploration::entities::NewNodes;
use crate::exploration::neighbours::index::Neighbours;
use crate::exploration::roadmap_query::RoadmapQuery;
use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::each;
use crate::runtime::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use crate::step::connection::attempt::{Attempts, ConnectionScratch};
use bevy_ecs::prelude::{Local, Res, ResMut};
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::roadmap::Roadmap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pairs every new node with the nearest nodes of its leaf in each other tree.
pub fn propose_connections(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    roadmap: RoadmapQuery<'_, '_>,
    neighbours: Res<'_, Neighbours>,
    mut new: ResMut<'_, NewNodes>,
    mut connections: ResMut<'_, Connections>,
) {
    let roadmap = roadmap.view();
    let new = std::mem::take(&mut new.0);
    let pairs = neighbours.of_other_trees(&model, roadmap, &new, settings.connect_neighbours);
    connections.0.clear();
    connections.0.extend(pairs.into_iter().map(|(from, to)| Connection::between(from, to)));
}

/// Steers and certifies the proposals; whole or not at all. Of those that would join the same two trees all behind the
/// first that is certified are left out: its edge makes them needless.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn certify_connections(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    roadmap: RoadmapQuery<'_, '_>,
    leaves: Res<'_, LeafIndex>,
    unvalidated_edges: UnvalidatedEdges<'_, '_>,
    mut connections: ResMut<'_, Connections>,
    buffers: Local<'_, ScratchPool<ConnectionScratch>>,
) {
    let roadmap = roadmap.view();
    let buffers = &*buffers;
    let bridges = Bridges::new(&connections.0, roadmap);
    let attempts = Attempts {
        model: &model,
        settings: &settings,
        roadmap,
        leaves: &leaves,
        unvalidated_edges: &unvalidated_edges,
    };
    // In order: a proposal that is certified makes those behind it needless.
    let mut proposals: Vec<_> = connections.0.iter_mut().enumerate().collect();
    each(
        &mut proposals,
        || buffers.borrow(),
        |scratch, (index, connection)| {
            if !stop.is_raised() && !bridges.is_needless(*index) {
                if connection.verdict.is_none() {
                    connection.verdict = Some(attempts.certify(connection.from, connection.to, scratch));
                }
                if connection.is_certified() {
                    bridges.build(*index);
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
    fn new(proposals: &[Connection], roadmap: Roadmap<'_>) -> Self {
        let joined = |proposal: &Connection| {
            let (a, b) = (roadmap.tree_of(proposal.from), roadmap.tree_of(proposal.to));
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
