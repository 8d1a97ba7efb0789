//! A roadmap node takes at most 120 bytes beside its configuration, and the search knows what nodes and edges take: a budget
//! in bytes must stop it before the machine does.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;
#[path = "../../tests/common/skip.rs"]
mod skip;

use bevy_ecs::prelude::World;
use common::{model, seeded, stop_within};
use foliate_components::candidate::{Candidate, CandidateArena, LegParameter, PlannedLeg};
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::roadmap::{NodeId, RoadmapStore};
use foliate_components::samples::swap_two_boxes;
use foliate_schedulers::mrrt::Mrrt;
use foliate_systems::events::EventSink;
use foliate_systems::exploration::entities::NewNodes;
use foliate_systems::exploration::neighbours::Neighbours;
use foliate_systems::exploration::roadmap_query::roadmap_in;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::Search;
use foliate_systems::step::commit::commit_extensions;
use skip::{Needs, skipped};

/// Gives every candidate a node on the start's leaf, a little off the start, at the end of an edge without motions.
fn add_nodes(world: &mut World) {
    let model = world.resource::<PlanningModel>().clone();
    let (start, leaf) = {
        let roadmap = roadmap_in(world);
        (roadmap.configuration(NodeId(0)).to_vec(), roadmap.node(NodeId(0)).leaf)
    };
    let leaf = world.resource::<LeafIndex>().leaf(leaf).clone();
    let transition = model.graph.loop_of(leaf.state);
    let mut serial = roadmap_in(world).nodes().len();
    let mut query = world.query::<&mut Candidate>();
    let mut indices = Vec::new();
    for mut candidate in query.iter_mut(world) {
        (candidate.near, candidate.transition) = (Some(NodeId(0)), transition);
        indices.push(candidate.index as usize);
    }
    let mut arena = world.resource_mut::<CandidateArena>();
    for index in indices {
        let mut knots = start.clone();
        knots[0] += serial as f64 * 1e-7;
        serial += 1;
        let parameters = leaf.parameters.iter().map(|&p| LegParameter::Known(p)).collect();
        let (clearance, residual) = (0.0, 0.0);
        arena.legs[index] = vec![PlannedLeg { leg: 0, state: leaf.state, parameters, knots, clearance, residual }];
        arena.complete[index] = true;
    }
    commit_extensions(world);
    world.resource_mut::<NewNodes>().0.clear();
}

/// Bytes of this process in memory; nothing where the system does not tell.
fn resident() -> Option<usize> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(pages.split(' ').nth(1)?.parse::<usize>().ok()? * 4096)
}

#[test]
fn a_hundred_thousand_nodes_take_what_the_roadmap_says() {
    let model = model(swap_two_boxes().unwrap());
    let mut search = Search::new(&model, &Mrrt, seeded(1), stop_within(600), EventSink::default());
    let world = search.world_mut();
    while roadmap_in(world).nodes().len() < 1000 {
        add_nodes(world);
    }
    let taken = |world: &World| {
        let roadmap = roadmap_in(world);
        let configurations = roadmap.nodes().len() * roadmap.configuration_size() * size_of::<f64>();
        configurations + world.resource::<Neighbours>().bytes()
    };
    let (nodes, before, apart) = (roadmap_in(world).nodes().len(), resident(), taken(world));
    while roadmap_in(world).nodes().len() < 101_000 {
        add_nodes(world);
    }
    let new = roadmap_in(world).nodes().len() - nodes;
    let expected = RoadmapStore::NODE_BYTES + RoadmapStore::EDGE_BYTES;
    const { assert!(RoadmapStore::NODE_BYTES <= 120 && RoadmapStore::EDGE_BYTES <= 120) };
    let (Some(before), Some(after)) = (before, resident()) else {
        skipped(Needs::System, "nodes_are_small", "this system does not say how much memory is in use");
        return;
    };
    let measured = ((after - before) as f64 - (taken(world) - apart) as f64) / new as f64;
    println!("{measured:.0} bytes for a node and its edge, of which the roadmap expects {expected}");
    let share = measured / expected as f64;
    assert!((0.8..1.25).contains(&share), "{measured:.0} bytes for a node and its edge instead of {expected}");
}
