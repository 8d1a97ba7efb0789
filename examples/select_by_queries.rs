//! Another rule of selection: `mrrt` without its set Select, and one system of queries in its place.
//!
//! The entities of the roadmap are the source: a node is a `RoadmapNode`, a leaf a `RoadmapLeaf`, and a transition has its
//! `Weight` and its `TransitionStatistics`. `Select` chooses for each candidate the node that is extended and the transition
//! that is tried. The rule here is "the least explored first": it takes the leaves with the fewest nodes in turn, a node on
//! them, and of the transitions that leave its state the one with the best success rate for its number of attempts.
//!
//! It uses counts alone, no clock and no random number, so that the same seed gives the same roadmap on any number of threads.
//!
//! Run with `cargo run --release --example select_by_queries`.

use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleCleanupPolicy;
use foliate::components::candidate::Candidate;
use foliate::components::graph::TransitionId;
use foliate::components::outcome::{Rejection, TransitionStatistics};
use foliate::components::roadmap::{NodeId, RoadmapLeaf, RoadmapNode};
use foliate::components::samples::swap_two_boxes;
use foliate::planner::outcome_name;
use foliate::schedulers::{Scheduler, mrrt::Mrrt};
use foliate::systems::exploration::entities::Weight;
use foliate::systems::planning_model::PlanningModel;
use foliate::systems::schedule::{SearchSet, StepCounter};
use foliate::{Planner, Report};

/// `mrrt` with another Select.
pub struct LeastExplored;

impl Scheduler for LeastExplored {
    fn name(&self) -> &'static str {
        "least explored"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = Mrrt.schedule(world);
        let removed =
            schedule.remove_systems_in_set(SearchSet::Select, world, ScheduleCleanupPolicy::RemoveSystemsOnly);
        debug_assert!(removed.is_ok(), "mrrt has systems in Select");
        schedule.add_systems(select.in_set(SearchSet::Select));
        schedule
    }
}

/// Chooses a node and a transition for each candidate.
fn select(
    model: Res<'_, PlanningModel>,
    step: Res<'_, StepCounter>,
    nodes: Query<'_, '_, &RoadmapNode>,
    leaves: Query<'_, '_, &RoadmapLeaf>,
    transitions: Query<'_, '_, (&TransitionId, &Weight, &TransitionStatistics)>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    // Both queries iterate in the order of ids: the n-th node is node n.
    let nodes: Vec<_> = nodes.iter().collect();
    let mut leaves: Vec<_> = leaves.iter().filter(|leaf| !leaf.nodes.is_empty()).collect();
    leaves.sort_by_key(|leaf| leaf.nodes.len());
    let mut worth = vec![0.0; model.graph.transitions.len()];
    for (id, weight, statistics) in &transitions {
        let (kept, tried) = ((statistics.reached + statistics.partial) as f64, statistics.attempts as f64);
        worth[id.at()] = weight.0 * (1.0 + kept) / (1.0 + tried).powf(1.5);
    }
    for mut candidate in &mut candidates {
        let turn = step.candidates as usize + candidate.index as usize;
        let leaf = leaves[candidate.index as usize % leaves.len()];
        let near: NodeId = leaf.nodes[turn % leaf.nodes.len()];
        let state = nodes[near.at()].state;
        let best = model.graph.leaving(state).map(|(id, _)| id).max_by(|a, b| {
            let (a, b) = (worth[a.at()], worth[b.at()]);
            a.total_cmp(&b)
        });
        match best {
            Some(transition) => {
                worth[transition.at()] *= 0.5;
                (candidate.near, candidate.transition) = (Some(near), Some(transition));
            }
            None => candidate.reject(Rejection::NoTransition),
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for seed in 1..=5 {
        let mut counts = Vec::new();
        let planners = [
            Planner::new(swap_two_boxes()?)?.scheduler(Mrrt),
            Planner::new(swap_two_boxes()?)?.scheduler(LeastExplored),
        ];
        for planner in planners {
            let answer = planner.seed(seed).solve();
            counts.push(format!("{} after {} candidates", outcome_name(&answer), Report::of(&answer).candidates));
        }
        println!("seed {seed}: mrrt {}; least explored {}", counts[0], counts[1]);
    }
    Ok(())
}
