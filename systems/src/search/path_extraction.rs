//! From a roadmap in which start and goal are connected to the path between them.

use crate::exploration::roots::GivenRoots;
use crate::planning_model::model::{Model, PlanningModel};
use crate::planning_model::state_classification::Feasible;
use crate::search::path_clearance::{pair_counts, path_clearance};
use crate::settings::SearchSettings;
use foliate_components::graph::leaf::{Leaf, LeafId, LeafIndex};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::path::{Certificate, ManipulationPath, Segment};
use foliate_components::roadmap::{EdgeId, Motion, NodeId, Roadmap};
use foliate_components::robot::configuration::{Group, quaternion, wrap};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

/// The path from `start` to `goal` with the fewest changes from leaf to leaf, and of these the shortest (weighted length of its motions); ties by lowest node id. `None` where they
/// are not connected.
#[must_use]
pub(crate) fn extract_path(
    model: &PlanningModel,
    settings: &SearchSettings,
    (roadmap, leaves, given): (Roadmap<'_>, &LeafIndex, &GivenRoots),
    start: NodeId,
    goal: NodeId,
) -> Option<ManipulationPath> {
    let edges = shortest_route(model, roadmap, start, goal)?;
    let mut path = ManipulationPath { corrections: model.snapped.clone(), ..ManipulationPath::default() };
    let mut certificate = Certificate { path_tolerance: settings.path_tolerance, ..Certificate::default() };
    let (mut at, mut moved) = (start, 0.0_f64);
    path.segments.extend(finger_segment(model, roadmap, leaves, given, start));
    for edge in edges {
        let row = roadmap.edge(edge);
        let (forward, left) = (row.from == at, at);
        at = if forward { row.to } else { row.from };
        let motions = roadmap.motions_of(edge);
        let first = if forward { motions.first() } else { motions.last() };
        let next = first.map(|motion| leaves.leaf(motion.leaf).state);
        path.segments.extend(passed_through(model, leaves, path.segments.last(), roadmap.node(left).leaf, next));
        let mut add = |motion: &Motion| {
            let segment = segment(model, leaves, motion, forward);
            let gap = model.carrier_gap(leaves.leaf(motion.leaf), leaves, &segment.knots);
            certificate.max_residual = certificate.max_residual.max(motion.residual).max(gap.residual);
            moved = moved.max(gap.moved);
            path.segments.push(segment);
        };
        if forward {
            motions.iter().for_each(&mut add);
        } else {
            motions.iter().rev().for_each(&mut add);
        }
    }
    path.segments.extend(finger_segment(model, roadmap, leaves, given, goal).map(reversed));
    path.certificate = certificate;
    unwrap_coordinates(model, path.segments.iter_mut().flat_map(|s| &mut s.knots).map(Vec::as_mut_slice));
    path.certificate.min_clearance = proved_clearance(model, settings, &path, moved);
    path.certificate.pairs = pair_counts(model, &path);
    Some(path)
}

/// The motion of fingers from where a root was given to where its state has them.
fn finger_segment(
    model: &PlanningModel,
    roadmap: Roadmap<'_>,
    leaves: &LeafIndex,
    given: &GivenRoots,
    root: NodeId,
) -> Option<Segment> {
    let (row, size) = (roadmap.node(root), model.problem.robot.space.size());
    let given = Some(given.of(root)?.to_vec());
    let q = roadmap.configuration(root).to_vec();
    let motion = model.finger_motion(&Feasible { q, state: row.state, parameters: Vec::new(), given })?;
    let leaf = Leaf { state: motion.state, ..leaves.leaf(row.leaf).clone() };
    Some(Segment {
        transition: model.graph.loop_of(row.state)?,
        state: motion.state,
        attachments: model.attachments(&leaf, leaves),
        constraints: model.path_constraints(&leaf, leaves),
        knots: motion.knots.chunks_exact(size).map(<[f64]>::to_vec).collect(),
        timing: None,
    })
}

fn reversed(mut segment: Segment) -> Segment {
    segment.knots.reverse();
    segment
}

/// What is proved of the clearance without asking again: nodes and motions keep the guard beyond all margins. As the path is
/// written objects may be `moved` from where they were then, both of a pair. Little more than that they do not touch;
/// [`path_clearance`] says how close they come.
pub(crate) fn proved_clearance(
    model: &PlanningModel,
    settings: &SearchSettings,
    path: &ManipulationPath,
    moved: f64,
) -> Option<f64> {
    let kept = settings.clearance_guard - 2.0 * moved;
    match model.collision.counts().looked_at() {
        0 => None,
        _ if kept > 0.0 => Some(kept),
        _ => path_clearance(model, path).map(|found| found.lower),
    }
}

/// The states that motions of the path were to reach and that it leaves instead, since it travels them backwards.
pub(crate) fn reached_backwards(
    model: &PlanningModel,
    roadmap: Roadmap<'_>,
    start: NodeId,
    goal: NodeId,
) -> Vec<StateId> {
    let mut at = start;
    let mut states = Vec::new();
    for edge in shortest_route(model, roadmap, start, goal).unwrap_or_default() {
        let row = roadmap.edge(edge);
        let forward = row.from == at;
        at = if forward { row.to } else { row.from };
        if !forward {
            states.extend(roadmap.motions_of(edge).iter().map(|m| model.graph.transition(m.transition).to));
        }
    }
    states
}

fn segment(model: &PlanningModel, leaves: &LeafIndex, motion: &Motion, forward: bool) -> Segment {
    let size = model.problem.robot.space.size();
    let mut knots: Vec<Vec<f64>> = motion.knots.chunks_exact(size).map(<[f64]>::to_vec).collect();
    if !forward {
        knots.reverse();
    }
    let leaf = leaves.leaf(motion.leaf);
    let transition = in_direction(model, motion.transition, forward);
    let (attachments, constraints) = (model.attachments(leaf, leaves), model.path_constraints(leaf, leaves));
    Segment { transition, state: leaf.state, attachments, constraints, knots, timing: None }
}

/// A node's own state, where no motion beside it lies in it: what is grasped on arrival and released at once is grasped, and
/// a checker of the path needs to see it. A motion without movement.
fn passed_through(
    model: &PlanningModel,
    leaves: &LeafIndex,
    before: Option<&Segment>,
    leaf: LeafId,
    next: Option<StateId>,
) -> Option<Segment> {
    let (before, leaf) = (before?, leaves.leaf(leaf));
    let knot = before.knots.last()?;
    let passed = leaf.state != before.state && next != Some(leaf.state);
    passed.then(|| Segment {
        transition: before.transition,
        state: leaf.state,
        attachments: model.attachments(leaf, leaves),
        constraints: model.path_constraints(leaf, leaves),
        knots: vec![knot.clone(), knot.clone()],
        timing: None,
    })
}

/// The transition that a motion travels when it is traversed `forward` or backwards.
fn in_direction(model: &PlanningModel, transition: TransitionId, forward: bool) -> TransitionId {
    if forward { transition } else { model.graph.transition(transition).reverse.unwrap_or(transition) }
}

/// Makes each coordinate's number continuous along all knots of a path although roadmap nodes hold it only up to its
/// representation: unlimited angles modulo 2π, quaternions up to their sign.
pub(crate) fn unwrap_coordinates<'k>(model: &Model, knots: impl Iterator<Item = &'k mut [f64]>) {
    let factors = &model.problem.robot.space.factors;
    if factors.iter().all(|factor| factor.group == Group::Real) {
        return;
    }
    let mut last: Option<&[f64]> = None;
    for knot in knots {
        if let Some(last) = last {
            for factor in factors {
                match factor.group {
                    Group::Circle => follow_angle(last, knot, factor.q),
                    Group::Plane => follow_angle(last, knot, factor.q + 2),
                    Group::FreeFlyer => follow_sign(last, knot, factor.q),
                    Group::Real => {}
                }
            }
        }
        last = Some(knot);
    }
}

/// Unwrapping rounds; angles closer than this are one.
const SAME_ANGLE: f64 = 1e-13;

fn follow_angle(last: &[f64], knot: &mut [f64], i: usize) {
    // Where two motions meet, or an angle stands still, the number is the same bit for bit; what is added elsewhere are
    // whole turns, so that other numbers keep their bits too.
    let turn = wrap(knot[i] - last[i]);
    knot[i] = if turn.abs() < SAME_ANGLE { last[i] } else { knot[i] + TAU * ((last[i] - knot[i]) / TAU).round() };
}

fn follow_sign(last: &[f64], knot: &mut [f64], i: usize) {
    if quaternion(last, i).dot(quaternion(knot, i)) < 0.0 {
        knot[i + 3..i + 7].iter_mut().for_each(|x| *x = -*x);
    }
}

#[derive(PartialEq)]
struct Frontier {
    changes: u32,
    length: f64,
    node: NodeId,
}

impl Eq for Frontier {}

impl Ord for Frontier {
    /// Fewest changes first, then shortest, then lowest id: reversed for a max-heap.
    fn cmp(&self, other: &Self) -> Ordering {
        let changes = other.changes.cmp(&self.changes);
        changes.then(other.length.total_cmp(&self.length)).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Frontier {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The nodes of the shortest path, start and goal included; none where they are not connected.
pub(crate) fn route(model: &PlanningModel, roadmap: Roadmap<'_>, start: NodeId, goal: NodeId) -> Vec<NodeId> {
    let edges = shortest_route(model, roadmap, start, goal).unwrap_or_default();
    let beyond = |at: &mut NodeId, edge: EdgeId| {
        let row = roadmap.edge(edge);
        *at = if row.from == *at { row.to } else { row.from };
        Some(*at)
    };
    std::iter::once(start).chain(edges.into_iter().scan(start, beyond)).collect()
}

/// Dijkstra over the roadmap: of the ways with the fewest changes from leaf to leaf the shortest.
fn shortest_route(model: &PlanningModel, roadmap: Roadmap<'_>, start: NodeId, goal: NodeId) -> Option<Vec<EdgeId>> {
    let mut best = vec![(u32::MAX, f64::INFINITY); roadmap.nodes().len()];
    let mut came_by: Vec<Option<EdgeId>> = vec![None; roadmap.nodes().len()];
    let mut frontier = BinaryHeap::from([Frontier { changes: 0, length: 0.0, node: start }]);
    best[start.at()] = (0, 0.0);
    while let Some(Frontier { changes, length, node }) = frontier.pop() {
        if node == goal {
            return Some(route_back(roadmap, &came_by, start, goal));
        }
        if (changes, length) > best[node.at()] {
            continue;
        }
        for edge in roadmap.edges_at(node) {
            let row = roadmap.edge(edge);
            let next = if row.from == node { row.to } else { row.from };
            let changes = changes + u32::from(roadmap.node(node).leaf != roadmap.node(next).leaf);
            let length = length + roadmap.motions_of(edge).iter().map(|m| model.length(&m.knots)).sum::<f64>();
            if (changes, length) < best[next.at()] {
                best[next.at()] = (changes, length);
                came_by[next.at()] = Some(edge);
                frontier.push(Frontier { changes, length, node: next });
            }
        }
    }
    None
}

fn route_back(roadmap: Roadmap<'_>, came_by: &[Option<EdgeId>], start: NodeId, goal: NodeId) -> Vec<EdgeId> {
    let mut route = Vec::new();
    let mut node = goal;
    while node != start {
        let Some(edge) = came_by[node.at()] else { break };
        route.push(edge);
        let row = roadmap.edge(edge);
        node = if row.from == node { row.to } else { row.from };
    }
    route.reverse();
    route
}
