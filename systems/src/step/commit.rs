//! Set Commit, and the end of Connect: what was certified becomes nodes and edges, by `exploration::writer`. Serial, in candidate
//! order.

use crate::exploration::edges::{Connection, Connections, Obstacle};
use crate::exploration::entities::{EntityTable, NewNodes};
use crate::exploration::memory::Compiled;
use crate::exploration::roadmap_query::roadmap_in;
use crate::exploration::roots::Roots;
use crate::exploration::search_log::{RefusedEdge, SearchLog, note_collision};
use crate::exploration::writer::{
    Born, add_edge, add_node, add_unvalidated_edge, count_in, intern_leaf, take_unvalidated_edge, validate_edge,
};
use crate::planning_model::model::PlanningModel;
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use crate::step::validation::{carried, certify_or_find};
use bevy_ecs::prelude::{Mut, World};
use foliate_components::candidate::{Candidate, CandidateArena, CommitAs, LegParameter, PlannedLeg};
use foliate_components::graph::leaf::{Leaf, LeafId, LeafIndex, ParameterId};
use foliate_components::graph::{ConstraintId, TransitionId};
use foliate_components::outcome::{Rejection, TransitionStatistics};
use foliate_components::roadmap::{Motion, NodeId, RoadmapStore, UnvalidatedEdge};
use foliate_kernels::collision::CollisionScratch;

/// Turns what is certified of each candidate into a node and an edge, and counts how each ended.
pub fn commit_extensions(world: &mut World) {
    world.resource_scope(|world, mut arena: Mut<'_, CandidateArena>| {
        let entities = world.resource::<EntityTable>().candidates.clone();
        let mut new_nodes = Vec::new();
        for entity in entities {
            let Some(candidate) = world.get::<Candidate>(entity).cloned() else { continue };
            let index = candidate.index as usize;
            let legs = std::mem::take(&mut arena.legs[index]);
            count(world, &candidate, !legs.is_empty(), arena.complete[index]);
            if let (Some(near), Some(transition), false) = (candidate.near, candidate.transition, legs.is_empty()) {
                match candidate.commit_as {
                    CommitAs::Extension => new_nodes.push(add_extension(world, near, transition, legs)),
                    CommitAs::DetachedTrees => {
                        new_nodes.extend(add_detached_trees(world, (near, transition, candidate.drawn), legs));
                    }
                }
            }
        }
        // Roots stand in the list before the first step.
        world.resource_mut::<NewNodes>().0.extend(new_nodes);
    });
    let pool = world.resource::<EntityTable>().candidates.len() as u64;
    let mut counter = world.resource_mut::<StepCounter>();
    counter.step += 1;
    counter.candidates += pool;
}

/// Adds the edges of certified connections whose ends still lie in different trees, in the order of proposal. An unvalidated edge
/// of which something is known now becomes a validated one or is despawned.
pub fn commit_connections(world: &mut World) {
    let proposals = std::mem::take(&mut world.resource_mut::<Connections>().0);
    world.resource_mut::<StepCounter>().connections += proposals.len() as u64;
    for Connection { from, to, verdict } in proposals {
        let roadmap = roadmap_in(world);
        let state = roadmap.node(from).state;
        let apart = roadmap.tree_of(from) != roadmap.tree_of(to);
        let unvalidated = verdict.as_ref().and_then(|_| take_unvalidated_edge(world, (from, to)));
        let Some((entity, edge)) = unvalidated else {
            count_in(world, state, |s| s.connections_tried += 1);
            if let (Some(Ok(motions)), true) = (verdict, apart) {
                let Some(along) = motions.first().map(|motion| motion.transition) else { continue };
                add_edge(world, (from, to), along, motions);
                count_in(world, state, |s| s.connections_made += 1);
            }
            continue;
        };
        match verdict {
            Some(Ok(motions)) if apart => {
                validate_edge(world, entity, (from, to), edge.transition, motions);
            }
            verdict => {
                world.despawn(entity);
                if let Some(Err(obstacle)) = verdict {
                    log_refused(world, &edge, obstacle);
                    count_obstacle(world, &edge, obstacle);
                }
            }
        }
    }
}

/// Keeps a refused edge in the log, where the search has one, and of a pair that is new there the configuration at which it was found
/// too close: the motion is certified once more for it.
fn log_refused(world: &mut World, edge: &UnvalidatedEdge, obstacle: Obstacle) {
    let step = world.resource::<StepCounter>().step;
    let Some(mut log) = world.get_resource_mut::<SearchLog>() else { return };
    log.note_refused(RefusedEdge { from: edge.from, to: edge.to, along: edge.transition, step });
    let Some(pair) = obstacle.blocked_by.map(|pair| (edge.transition, pair)).filter(|&pair| log.wants(pair)) else {
        return;
    };
    let (model, settings) = (world.resource::<PlanningModel>(), world.resource::<SearchSettings>());
    let leaves = world.resource::<LeafIndex>();
    let find = |motion: &Motion| {
        let leaf = leaves.leaf(motion.leaf);
        let (along, attachments) = ((motion.transition, leaf.state), model.attachments_of_leaf(leaf, leaves));
        let mut scratch = CollisionScratch::default();
        scratch.set_level(settings.level);
        let found = certify_or_find(model, settings, along, &attachments, &motion.knots, &mut scratch).err()?;
        found.at.map(|q| carried(model, &attachments, q))
    };
    if let Some(q) = edge.motions.iter().find(|motion| motion.leg == obstacle.leg).and_then(find) {
        note_collision(world, pair, &q);
    }
}

/// An extension that was counted as having reached its target has not done so after all.
fn count_obstacle(world: &mut World, edge: &UnvalidatedEdge, obstacle: Obstacle) {
    let entity = world.resource::<EntityTable>().transitions[edge.transition.at()];
    let side = side_of(world, edge.from);
    if let Some(mut statistics) = world.get_mut::<TransitionStatistics>(entity) {
        let reason = Rejection::MotionBlocked(obstacle.leg as u8);
        statistics.reached = statistics.reached.saturating_sub(1);
        statistics.count_rejection(reason, obstacle.blocked_by);
        let side = &mut statistics.sides[side];
        side.reached = side.reached.saturating_sub(1);
        side.in_collision += 1;
    }
}

/// Place of a node's search side in [`TransitionStatistics::sides`].
fn side_of(world: &World, node: NodeId) -> usize {
    let (roadmap, start) = (roadmap_in(world), world.resource::<Roots>().start);
    usize::from(start.is_none_or(|start| roadmap.node(start).side != roadmap.node(node).side))
}

pub(crate) fn count(world: &mut World, candidate: &Candidate, kept: bool, complete: bool) {
    if let Some(near) = candidate.near {
        let state = roadmap_in(world).node(near).state;
        count_in(world, state, |s| s.extended += 1);
    }
    let Some(transition) = candidate.transition else { return };
    let entity = world.resource::<EntityTable>().transitions[transition.at()];
    let side = candidate.near.map(|near| side_of(world, near));
    let Some(mut statistics) = world.get_mut::<TransitionStatistics>(entity) else { return };
    statistics.attempts += 1;
    let is_first = statistics.attempts == 1;
    match (kept, complete) {
        (true, true) => statistics.reached += 1,
        (true, false) => statistics.partial += 1,
        (false, _) => {}
    }
    if let Some(reason) = candidate.rejected {
        statistics.count_rejection(reason, candidate.blocked_by);
    }
    if let Some(side) = side {
        let stopped = candidate.rejected.unwrap_or(Rejection::NoProgress);
        statistics.sides[side].count((!(kept && complete)).then_some(stopped));
    }
    if let (Some(pair), Some(q)) = (candidate.blocked_by, &candidate.blocked_at) {
        note_collision(world, (transition, pair), q);
    }
    if is_first {
        world.resource_scope(|world, mut compiled: Mut<'_, Compiled>| {
            compiled.note(world.resource::<PlanningModel>(), transition);
        });
    }
}

/// Adds what is left of a transition whose first leg was left out: where that leg ends is the root of a tree on the search
/// side of `near`, and so is the node that the other legs lead to. The motions between the two are an unvalidated edge. Where
/// no leg moves, the second node is an extension of the first. Returns the second node.
fn add_detached_trees(
    world: &mut World,
    (near, transition, drawn): (NodeId, TransitionId, Option<LeafId>),
    mut legs: Vec<PlannedLeg>,
) -> Option<NodeId> {
    let behind = legs.split_off(1);
    let [first] = &*legs else { return None };
    let known = |parameter: &LegParameter| match parameter {
        LegParameter::Known(id) => Some(*id),
        LegParameter::Fresh(_) => None,
    };
    // It lies on the leaf of `near`, of which everything is known.
    let parameters = first.parameters.iter().map(known).collect::<Option<_>>()?;
    let size = world.resource::<RoadmapStore>().configuration_size();
    let leaf = intern_leaf(world, Leaf { state: first.state, parameters });
    let from = add_node(world, &first.knots[first.knots.len() - size..], leaf, Born::OnSideOf(near));
    if behind.iter().all(|leg| leg.knots.len() <= size) {
        return Some(add_extension(world, from, transition, behind));
    }
    let (motions, end) = intern_legs(world, transition, behind);
    let (q, leaf) = end?;
    let to = add_node(world, &q, leaf, Born::OnSideOf(near));
    add_unvalidated_edge(world, UnvalidatedEdge { from, to, transition, drawn, motions });
    Some(to)
}

fn add_extension(world: &mut World, near: NodeId, transition: TransitionId, legs: Vec<PlannedLeg>) -> NodeId {
    let (motions, end) = intern_legs(world, transition, legs);
    let Some((q, leaf)) = end else { return near };
    let node = add_node(world, &q, leaf, Born::InTreeOf(near));
    add_edge(world, (near, node), transition, motions);
    node
}

/// The motions of a transition's legs, and where the last one ends: its configuration and leaf. What they have found is interned.
fn intern_legs(
    world: &mut World,
    transition: TransitionId,
    legs: Vec<PlannedLeg>,
) -> (Vec<Motion>, Option<(Vec<f64>, LeafId)>) {
    let mut fresh = Vec::new();
    let size = world.resource::<RoadmapStore>().configuration_size();
    let mut motions = Vec::with_capacity(legs.len());
    let mut end = None;
    for leg in legs {
        let parameters = intern_parameters(world, &leg.parameters, &mut fresh);
        let q = leg.knots[leg.knots.len() - size..].to_vec();
        let leaf = intern_leaf(world, Leaf { state: leg.state, parameters });
        if leg.knots.len() > size {
            motions.push(Motion {
                transition,
                leg: leg.leg,
                leaf,
                knots: leg.knots,
                clearance: leg.clearance,
                residual: leg.residual,
            });
        }
        end = Some((q, leaf));
    }
    (motions, end)
}

/// Ids of a leg's parameters; what the candidate has found is interned once, however many legs carry it.
fn intern_parameters(
    world: &mut World,
    parameters: &[LegParameter],
    fresh: &mut Vec<(ConstraintId, ParameterId)>,
) -> Box<[ParameterId]> {
    let mut index = world.resource_mut::<LeafIndex>();
    let mut intern = |parameter: &LegParameter| match parameter {
        LegParameter::Known(id) => *id,
        LegParameter::Fresh(value) => {
            if let Some(&(_, id)) = fresh.iter().find(|(constraint, _)| *constraint == value.constraint) {
                return id;
            }
            let id = index.add_parameter(*value);
            fresh.push((value.constraint, id));
            id
        }
    };
    parameters.iter().map(&mut intern).collect()
}
