//! A search that is no tree per root: a lazy PRM over leaves (after Bohlin and Kavraki, *Path planning using lazy PRM*, 2000).
//!
//! Sampling adds milestones: configurations that are free and lie on a leaf, without the motion that leads there. They come in two
//! kinds, both by `CommitAs::DetachedTrees`. A loop of a state gives a milestone somewhere else on the leaf. A transition to
//! another state gives two milestones, one where it leaves the leaf and one where it arrives, with an unvalidated edge between.
//!
//! Connect searches the shortest path from the start to a goal over three kinds of edges: validated ones, unvalidated ones, and
//! straight motions between milestones of one leaf that were not tried. It proposes those of the path that are not validated.
//! What is not free is never proposed again, so that the next shortest path avoids it.
//!
//! Run with `cargo run --release --example lazy_prm`.

use bevy_ecs::prelude::*;
use foliate::components::candidate::{Candidate, CommitAs};
use foliate::components::graph::{TransitionId, TransitionKind};
use foliate::components::outcome::Rejection;
use foliate::components::roadmap::{NodeId, Roadmap, RoadmapLeaf, UnvalidatedEdge};
use foliate::components::samples::swap_two_boxes;
use foliate::planner::outcome_name;
use foliate::schedulers::Scheduler;
use foliate::systems::exploration::edges::{Connection, Connections};
use foliate::systems::exploration::entities::{NewNodes, TransitionWeights};
use foliate::systems::exploration::roadmap_query::RoadmapQuery;
use foliate::systems::exploration::roots::Roots;
use foliate::systems::goals::systems::draw_more_goals;
use foliate::systems::planning_model::PlanningModel;
use foliate::systems::runtime::random::{Purpose, draw, stream};
use foliate::systems::schedule::{SearchSet, StepCounter, empty_schedule};
use foliate::systems::settings::SearchSettings;
use foliate::systems::step::commit::{commit_connections, commit_extensions};
use foliate::systems::step::conclusion::{conclude, report_feedback, report_progress, report_solution};
use foliate::systems::step::connection::connect::certify_connections;
use foliate::systems::step::lazy_extension::{drop_cut_short, leave_out_first_legs};
use foliate::systems::step::projection::project::project_waypoints;
use foliate::systems::step::rendezvous::draw_leaves;
use foliate::systems::step::sampling::{reset_candidates, sample_configurations};
use foliate::systems::step::selection::gather_weights;
use foliate::systems::step::steering::steer_legs;
use foliate::systems::step::validation::certify_legs;
use foliate::systems::step::waypoints::check_waypoints;
use foliate::{Planner, Report};
use rand::RngExt;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// Share of the candidates that add a milestone on a leaf; the others add a transition.
const ON_THE_LEAF: f64 = 0.4;

/// A milestone is tried against so many of its leaf, the nearest ones.
const NEIGHBOURS: usize = 8;

/// Paths that are tried in one step at most.
const PATHS: usize = 12;

/// The scheduler.
pub struct LazyPrm;

/// Pairs of milestones between which the motion is not free.
#[derive(Default, Resource)]
struct Refuted(BTreeSet<(NodeId, NodeId)>);

/// The systems of Connect, which run until no path is left.
#[derive(Default, Resource)]
struct Validation(Schedule);

impl Scheduler for LazyPrm {
    fn name(&self) -> &'static str {
        "lazy PRM"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        world.init_resource::<Refuted>();
        let mut validation = Schedule::default();
        validation.add_systems((propose_path, certify_connections, remember_refuted, commit_connections).chain());
        world.insert_resource(Validation(validation));
        let mut schedule = empty_schedule();
        schedule.add_systems((
            (reset_candidates, sample_configurations).chain().in_set(SearchSet::Sample),
            (gather_weights, choose_milestones).chain().in_set(SearchSet::Select),
            draw_leaves.in_set(SearchSet::Rendezvous),
            (project_waypoints, leave_out_first_legs).chain().in_set(SearchSet::Project),
            (check_waypoints, steer_legs, drop_cut_short).chain().in_set(SearchSet::Steer),
            certify_legs.in_set(SearchSet::Validate),
            (commit_extensions, draw_more_goals).chain().in_set(SearchSet::Commit),
            validate_paths.in_set(SearchSet::Connect),
            (conclude, report_progress, report_feedback, report_solution).chain().in_set(SearchSet::Conclude),
        ));
        schedule
    }
}

/// Draws for each candidate a state, a leaf of it, a milestone there, and a transition.
fn choose_milestones(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    weights: Res<'_, TransitionWeights>,
    leaves: Query<'_, '_, &RoadmapLeaf>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let mut by_state: BTreeMap<_, Vec<&RoadmapLeaf>> = BTreeMap::new();
    for leaf in leaves.iter().filter(|leaf| !leaf.nodes.is_empty()) {
        by_state.entry(leaf.state).or_default().push(leaf);
    }
    let states: Vec<_> = by_state.into_iter().collect();
    for mut candidate in &mut candidates {
        let mut rng = stream(settings.seed, Purpose::SELECT, step.step, candidate.index);
        let (state, leaves) = &states[rng.random_range(0..states.len())];
        let leaf = leaves[rng.random_range(0..leaves.len())];
        let near = leaf.nodes[rng.random_range(0..leaf.nodes.len())];
        let is_loop = |id: TransitionId| model.graph.transition(id).kind == TransitionKind::Loop;
        let on_the_leaf = rng.random::<f64>() < ON_THE_LEAF;
        let choices: Vec<_> = (model.graph.leaving(*state).map(|(id, _)| id))
            .filter(|&id| is_loop(id) == on_the_leaf)
            .map(|id| (id, weights.0[id.at()]))
            .collect();
        let Some(transition) = draw(&choices, rng.random()) else {
            candidate.reject(Rejection::NoTransition);
            continue;
        };
        (candidate.near, candidate.transition) = (Some(near), Some(transition));
        // A first leg that is short, or on another leaf, is certified with the rest.
        let first = model.graph.transition(transition).legs.first();
        if first.is_some_and(|leg| leg.state == *state && !leg.short) {
            candidate.commit_as = CommitAs::DetachedTrees;
        }
    }
}

/// Proposes, certifies and commits paths one after another, until one is valid or none is left.
fn validate_paths(world: &mut World) {
    world.resource_mut::<NewNodes>().0.clear();
    world.resource_scope(|world, mut validation: Mut<'_, Validation>| {
        for _ in 0..PATHS {
            let before = world.resource::<StepCounter>().connections;
            validation.0.run(world);
            if world.resource::<StepCounter>().connections == before {
                break;
            }
        }
    });
}

/// Proposes what is not validated on the shortest path.
fn propose_path(
    model: Res<'_, PlanningModel>,
    roadmap: RoadmapQuery<'_, '_>,
    roots: Res<'_, Roots>,
    refuted: Res<'_, Refuted>,
    unvalidated: Query<'_, '_, &UnvalidatedEdge>,
    mut connections: ResMut<'_, Connections>,
) {
    let roadmap = roadmap.view();
    let mut leads: BTreeMap<NodeId, Vec<(NodeId, f64)>> = BTreeMap::new();
    for edge in &unvalidated {
        let length = edge.motions.iter().map(|motion| model.length(&motion.knots)).sum();
        leads.entry(edge.from).or_default().push((edge.to, length));
        leads.entry(edge.to).or_default().push((edge.from, length));
    }
    leads.values_mut().for_each(|list| list.sort_by_key(|(node, _)| *node));
    connections.0.clear();
    let neighbours = |node| neighbours(&model, roadmap, &refuted, &leads, node);
    let Some(path) = shortest_path(&roots, roadmap, neighbours) else { return };
    for (from, to) in path {
        if roadmap.tree_of(from) != roadmap.tree_of(to) {
            // An unvalidated edge is proposed in its own direction.
            let backwards = unvalidated.iter().any(|edge| (edge.to, edge.from) == (from, to));
            let (from, to) = if backwards { (to, from) } else { (from, to) };
            connections.0.push(Connection::between(from, to));
        }
    }
}

/// Where a milestone may lead, with the cost: nothing along validated edges, else the length of the motion.
fn neighbours(
    model: &PlanningModel,
    roadmap: Roadmap<'_>,
    refuted: &Refuted,
    leads: &BTreeMap<NodeId, Vec<(NodeId, f64)>>,
    node: NodeId,
) -> Vec<(NodeId, f64)> {
    let mut all = Vec::new();
    for edge in roadmap.edges_at(node).map(|edge| roadmap.edge(edge)) {
        all.push((if edge.from == node { edge.to } else { edge.from }, 0.0));
    }
    all.extend(leads.get(&node).into_iter().flatten());
    let space = &model.problem.robot.space;
    let q = roadmap.configuration(node);
    let open = |&other: &NodeId| {
        roadmap.tree_of(other) != roadmap.tree_of(node) && !refuted.0.contains(&(node.min(other), node.max(other)))
    };
    let others = roadmap.nodes_on(roadmap.node(node).leaf).iter().copied().filter(open);
    let far = |other| (other, 0.1 + space.distance(q, roadmap.configuration(other), &model.robot_weights));
    let mut straight: Vec<(NodeId, f64)> = others.map(far).collect();
    straight.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    straight.truncate(NEIGHBOURS);
    all.extend(straight);
    all
}

/// Dijkstra's algorithm; ties go to the lower id.
fn shortest_path(
    roots: &Roots,
    roadmap: Roadmap<'_>,
    neighbours: impl Fn(NodeId) -> Vec<(NodeId, f64)>,
) -> Option<Vec<(NodeId, NodeId)>> {
    let start = roots.start?;
    let mut best = vec![f64::INFINITY; roadmap.nodes().len()];
    let mut came_from: Vec<Option<NodeId>> = vec![None; best.len()];
    // Costs are not negative, so that their bits are in their order.
    let mut open = BinaryHeap::from([Reverse((0.0_f64.to_bits(), start))]);
    best[start.at()] = 0.0;
    while let Some(Reverse((bits, node))) = open.pop() {
        let cost = f64::from_bits(bits);
        if roots.goals.contains(&node) {
            let back = std::iter::successors(Some(node), |node| came_from[node.at()]);
            let nodes: Vec<_> = back.collect();
            return Some(nodes.windows(2).rev().map(|pair| (pair[1], pair[0])).collect());
        }
        if cost > best[node.at()] {
            continue;
        }
        for (next, step) in neighbours(node) {
            if cost + step < best[next.at()] {
                best[next.at()] = cost + step;
                came_from[next.at()] = Some(node);
                open.push(Reverse(((cost + step).to_bits(), next)));
            }
        }
    }
    None
}

/// Remembers the straight motions that are not free. An unvalidated edge that is not free is despawned by Commit.
fn remember_refuted(connections: Res<'_, Connections>, mut refuted: ResMut<'_, Refuted>) {
    for connection in connections.0.iter().filter(|connection| matches!(connection.verdict, Some(Err(_)))) {
        let (a, b) = (connection.from, connection.to);
        refuted.0.insert((a.min(b), a.max(b)));
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for seed in 1..=5 {
        let answer = Planner::new(swap_two_boxes()?)?.scheduler(LazyPrm).seed(seed).solve();
        let report = Report::of(&answer);
        let (milestones, edges) = (report.nodes, report.edges);
        println!("seed {seed}: {}, {milestones} milestones, {edges} validated edges", outcome_name(&answer));
    }
    Ok(())
}
