//! Promise: a search that keeps a log finds the same roadmap as one without; the log says when nodes and edges came, which edges were
//! refused, and of each pair that stopped candidates a configuration at which it is too close.

#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

mod common;

use bevy_ecs::system::RunSystemOnce;
use common::{model, search, seeded, stop_within};
use foliate_components::Pose;
use foliate_components::problem::Problem;
use foliate_components::roadmap::{EdgeId, Motion, NodeId, UnvalidatedEdge};
use foliate_components::samples::{boxes_on_a_table, swap_two_boxes};
use foliate_kernels::collision::{DistanceQuery, PairId, pair_clearance};
use foliate_schedulers::sequence::Sequence;
use foliate_schedulers::{Scheduler, shipped};
use foliate_systems::events::EventSink;
use foliate_systems::exploration::edges::{Connection, Connections};
use foliate_systems::exploration::roadmap_query::roadmap_in;
use foliate_systems::exploration::roots::Roots;
use foliate_systems::exploration::search_log::{MOST_COLLISIONS, RefusedEdge, SearchLog};
use foliate_systems::exploration::writer::{Born, add_node, add_unvalidated_edge};
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::Search;
use foliate_systems::step::commit::commit_connections;
use foliate_systems::step::connection::connect::certify_connections;
use glam::DVec3;

/// What motions keep beyond margins, metres.
const GUARD: f64 = 1e-5;
/// What a certificate can neither prove free nor find in collision may be so far apart, metres.
const DOUBT: f64 = 1e-4 + GUARD;

fn problems() -> [Problem; 2] {
    let boxes = boxes_on_a_table(&[(0.6, 0.15), (0.6, -0.15)], &[(0.6, -0.15), (0.6, 0.15)]);
    [swap_two_boxes(), boxes].map(|problem| problem.expect("a sample"))
}

fn both(model: &PlanningModel, scheduler: &dyn Scheduler, seed: u64) -> (Search, Search) {
    let (plain, without) = search(model, scheduler, seeded(seed), 2);
    let (logged, with) = search(model, scheduler, seeded(seed).with(|s| s.log = true), 2);
    assert_eq!(plain, logged);
    (without, with)
}

/// How far apart two shapes are.
fn clearance(model: &PlanningModel, q: &[f64], pair: PairId) -> f64 {
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    model.kinematics.forward(q, &mut X_WJ);
    pair_clearance(&model.collision, pair, &X_WJ, DistanceQuery::exact(1.0), &mut DVec3::ZERO.clone())
}

#[test]
fn the_log_changes_nothing_and_is_not_there_unless_it_is_asked_for() {
    let model = model(swap_two_boxes().expect("a sample"));
    for scheduler in shipped() {
        for seed in 1..=3 {
            let (without, with) = both(&model, scheduler.as_ref(), seed);
            assert_eq!(without.roadmap().fingerprint(), with.roadmap().fingerprint(), "{} {seed}", scheduler.name());
            assert_eq!(without.counter(), with.counter());
            assert!(!without.world().contains_resource::<SearchLog>());
            assert!(with.world().contains_resource::<SearchLog>());
        }
    }
}

#[test]
fn nodes_and_edges_come_in_the_order_of_steps() {
    let model = model(swap_two_boxes().expect("a sample"));
    for scheduler in shipped() {
        let (_, with) = both(&model, scheduler.as_ref(), 2);
        let (log, roadmap, last) = (with.world().resource::<SearchLog>(), with.roadmap(), with.counter().step);
        let nodes: Vec<u64> = (0..roadmap.nodes().len() as u32).map(|node| log.step_of_node(NodeId(node))).collect();
        let edges: Vec<u64> = (0..roadmap.edges().len() as u32).map(|edge| log.step_of_edge(EdgeId(edge))).collect();
        for steps in [&nodes, &edges] {
            assert!(steps.is_sorted() && steps.iter().all(|&step| step <= last), "{}", scheduler.name());
        }
        assert_eq!(nodes[0], 0, "the start is there before the first step");
        assert!(nodes.iter().any(|&step| step > 0) && edges[0] > 0);
        // An edge comes no sooner than its ends.
        for (row, &step) in roadmap.edges().iter().zip(&edges) {
            assert!(step >= nodes[row.from.at()].max(nodes[row.to.at()]), "{row:?}");
        }
    }
}

#[test]
fn pairs_are_too_close_where_the_log_says_so() {
    let (mut kept, mut close) = (0, 0);
    for problem in problems() {
        let model = model(problem);
        let pairs = model.collision.pairs();
        for (scheduler, seed) in shipped().iter().flat_map(|scheduler| (1..=4).map(move |seed| (scheduler, seed))) {
            let (_, mut with) = both(&model, scheduler.as_ref(), seed);
            let statistics = with.statistics();
            let log = with.world().resource::<SearchLog>();
            for (&(along, shapes), q) in log.collisions() {
                let (_, of) = statistics.iter().find(|(id, _)| *id == along).expect("it was tried");
                assert!(of.blocked_by.contains_key(&shapes), "{along:?} {shapes:?} is in no statistics");
                let pair = pairs.iter().position(|pair| (pair.first, pair.second) == shapes).expect("a pair");
                let clearance = clearance(&model, q, PairId(pair as u32));
                assert!(clearance <= DOUBT, "{} {shapes:?}: {clearance}", scheduler.name());
                close += usize::from(clearance <= GUARD);
                kept += 1;
            }
            // Every pair that stopped something has its place.
            let all: usize = statistics.iter().map(|(_, s)| s.blocked_by.len()).sum();
            assert_eq!(log.collisions().len(), all.min(MOST_COLLISIONS), "{}", scheduler.name());
        }
    }
    println!("{close} of {kept} pairs within the guard");
    assert!(kept > 40 && 10 * close >= 9 * kept, "{close} of {kept}");
}

/// Searches of samples refuse next to no edge, so that one is made here: from the start to a node beside it, through the table.
#[test]
fn a_refused_edge_is_kept_with_the_pair_that_stopped_it() {
    let model = model(boxes_on_a_table(&[(0.6, 0.15)], &[(0.6, -0.15)]).expect("a sample"));
    let settings = seeded(1).with(|s| s.log = true);
    let mut search = Search::new(&model, &Sequence, settings, stop_within(60), EventSink::default());
    let world = search.world_mut();
    let from = world.resource::<Roots>().start.expect("a start");
    let (row, q) = (*roadmap_in(world).node(from), roadmap_in(world).configuration(from).to_vec());
    let along = model.graph.loop_of(row.state).expect("a loop");
    let turned = |joint: usize, by: f64| {
        let mut q = q.clone();
        q[joint] += by;
        q
    };
    let (through, end) = (turned(1, 1.6), turned(0, 0.2));
    let to = add_node(world, &end, row.leaf, Born::AsRoot);
    let knots = [&q[..], &through, &end].concat();
    let motion = Motion { transition: along, leg: 0, leaf: row.leaf, knots, clearance: 0.0, residual: 0.0 };
    let edge = UnvalidatedEdge { from, to, transition: along, drawn: None, motions: vec![motion] };
    add_unvalidated_edge(world, edge);
    world.resource_mut::<Connections>().0 = vec![Connection::between(from, to)];
    world.run_system_once(certify_connections).expect("it runs");
    commit_connections(world);
    let log = world.resource::<SearchLog>();
    assert_eq!(log.refused(), [RefusedEdge { from, to, along, step: 0 }]);
    let ((of, shapes), at) = log.collisions().first_key_value().expect("a pair");
    assert_eq!(*of, along);
    let pair = model.collision.pairs().iter().position(|p| (p.first, p.second) == *shapes).expect("a pair");
    let clearance = clearance(&model, at, PairId(pair as u32));
    assert!(clearance <= DOUBT && at[..] != q[..], "{clearance}");
    assert_eq!(log.collisions().len(), 1);
}
