//! Once start and goal are connected: leaves out ways that leave a leaf and come back to it.
//!
//! A lazy search takes the first sequence that holds. It may put an object back where it was, or take it once more as it held it before.
//! Then the path is on one leaf before and after, and a straight motion on that leaf, where it is free, replaces what lies between.
//! Shortcuts of this kind are as old as path smoothing (Geraerts and Overmars, *Creating high-quality paths for motion planning*,
//! IJRR 2007); here both ends are nodes, so that no configuration has to be found.

use crate::exploration::edges::{Connection, Connections};
use crate::exploration::roadmap_query::roadmap_in;
use crate::exploration::roots::Roots;
use crate::exploration::writer::add_edge;
use crate::planning_model::model::PlanningModel;
use crate::search::path_extraction::route;
use crate::step::connection::connect::certify_connections;
use bevy_ecs::prelude::World;
use bevy_ecs::system::RunSystemOnce;
use foliate_components::roadmap::{NodeId, Roadmap};

/// Excursions that are left out at most, and straight motions that are tried for each.
const MOST: usize = 32;
const TRIES: usize = 8;

/// Adds an edge to the roadmap for every excursion of the path that a straight motion can replace.
pub(crate) fn leave_out_excursions(world: &mut World) {
    for _ in 0..MOST {
        let roadmap = roadmap_in(world);
        let roots = world.resource::<Roots>();
        let Some((start, goal)) = roots.start.zip(roots.reached_goal(roadmap)) else { return };
        let nodes = route(world.resource::<PlanningModel>(), roadmap, start, goal);
        let proposals = excursions(roadmap, &nodes);
        if proposals.is_empty() {
            return;
        }
        world.resource_mut::<Connections>().0 = proposals;
        if world.run_system_once(certify_connections).is_err() {
            return;
        }
        let verdicts = std::mem::take(&mut world.resource_mut::<Connections>().0);
        let free = verdicts.into_iter().find_map(|c| Some((c.from, c.to, c.verdict?.ok()?)));
        let Some((from, to, motions)) = free else { return };
        let Some(along) = motions.first().map(|motion| motion.transition) else { return };
        add_edge(world, (from, to), along, motions);
    }
}

/// Straight motions between nodes of one leaf between which the path is elsewhere, those first that leave out most nodes.
fn excursions(roadmap: Roadmap<'_>, nodes: &[NodeId]) -> Vec<Connection> {
    let leaf = |at: usize| roadmap.node(nodes[at]).leaf;
    // The last node of a visit, and the first node of a later one.
    let leaves_at = |&at: &usize| at + 1 < nodes.len() && leaf(at + 1) != leaf(at);
    let mut pairs = Vec::new();
    for from in (0..nodes.len()).filter(leaves_at) {
        let back = (from + 2..nodes.len()).filter(|&to| leaf(to) == leaf(from) && leaf(to - 1) != leaf(to));
        pairs.extend(back.map(|to| (from, to)));
    }
    pairs.sort_by_key(|&(from, to)| (std::cmp::Reverse(to - from), from));
    pairs.truncate(TRIES);
    pairs.into_iter().map(|(from, to)| Connection::between(nodes[from], nodes[to])).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]
mod tests {
    use super::*;
    use crate::events::{EventSink, StopSignal};
    use crate::exploration::writer::{Born, add_node, intern_leaf};
    use crate::planning_model::model::Model;
    use crate::search::world::{add_roots, empty_world};
    use crate::settings::SearchSettings;
    use foliate_components::graph::leaf::{Leaf, LeafIndex};
    use foliate_components::problem::Goal;
    use foliate_components::roadmap::Motion;
    use foliate_components::samples::boxes_on_a_table;
    use std::sync::Arc;

    /// A path from a start to a goal on its leaf that has the box somewhere else in between; the arm turns by so many radians.
    fn route_of(turn: f64) -> usize {
        let mut problem = boxes_on_a_table(&[(0.6, 0.15)], &[(0.6, 0.15)]).unwrap();
        let mut goal = problem.start.clone();
        goal[0] += turn;
        problem.goals = vec![Goal::Configuration(goal)];
        let model = PlanningModel(Arc::new(Model::new(problem).unwrap()));
        let mut world = empty_world(&model, SearchSettings::default(), StopSignal::default(), EventSink::default());
        add_roots(&mut world).unwrap();
        let roots = world.resource::<Roots>().clone();
        let (start, goal) = (roots.start.unwrap(), roots.goals[0]);
        let roadmap = roadmap_in(&world);
        let (q, row) = (roadmap.configuration(start).to_vec(), roadmap.node(start));
        assert_eq!(row.leaf, roadmap.node(goal).leaf);
        let (state, first, along) = (row.state, row.leaf, model.graph.loop_of(row.state).unwrap());
        let mut index = world.resource_mut::<LeafIndex>();
        let known = index.leaf(first).parameters.clone();
        let moved = known.iter().map(|&id| *index.parameter(id)).collect::<Vec<_>>();
        let parameters = moved.into_iter().map(|value| index.add_parameter(value)).collect();
        let leaf = intern_leaf(&mut world, Leaf { state, parameters });
        let node = add_node(&mut world, &q, leaf, Born::InTreeOf(start));
        let end = roadmap_in(&world).configuration(goal).to_vec();
        for (from, to, q) in [(start, node, &q), (node, goal, &end)] {
            let knots = [roadmap_in(&world).configuration(from), q].concat();
            let motion = Motion { transition: along, leg: 0, leaf, knots, clearance: 0.0, residual: 0.0 };
            add_edge(&mut world, (from, to), along, vec![motion]);
        }
        leave_out_excursions(&mut world);
        route(&model, roadmap_in(&world), start, goal).len()
    }

    #[test]
    fn a_free_straight_motion_replaces_what_lies_between() {
        assert_eq!(route_of(0.3), 2);
    }
}
