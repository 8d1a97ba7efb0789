//! The systems of set Select that use the leaf heuristic: measure new leaves, and choose leaves for guided candidates.

use crate::exploration::explored::Explored;
use crate::heuristic::blocking::MoveOrder;
use crate::heuristic::leaf_heuristic::{HeuristicScratch, LeafHeuristic};
use crate::heuristic::measured_leaves::Measured;
use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::LEAST_SHARED;
use crate::runtime::random::{Purpose, draw, stream};
use crate::schedule::StepCounter;
use crate::settings::{SearchSettings, Selection};
use bevy_ecs::prelude::{Query, Res, ResMut};
use foliate_components::candidate::Candidate;
use foliate_components::graph::leaf::Leaf;
use foliate_components::graph::{ConstraintGraph, TransitionId};
use foliate_components::roadmap::TreeId;
use rand::RngExt;
use rand::seq::IndexedRandom;
use rayon::prelude::*;

/// Share of the guided candidates that start from the leaf of the largest weight where much is to be moved: with many objects near
/// leaves are few among many.
const GREEDY: f64 = 0.75;

/// Where much is to be moved the probability that a candidate is guided is raised to this power: moves that are drawn blindly lead away.
const MOSTLY: f64 = 0.15;

/// So many of the likeliest leaves of each side are asked again in a step what stands in the way from there.
const AGAIN: usize = 4;

/// Measures the leaves that the last step has reached, each against all others.
pub fn measure_leaves(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    explored: Explored<'_, '_>,
    mut order: ResMut<'_, MoveOrder>,
    mut heuristic: ResMut<'_, LeafHeuristic>,
) {
    let heuristic = &mut *heuristic;
    if heuristic.distance.grow(&model.graph) {
        heuristic.pairs.clear();
        let all = heuristic.measured.iter_mut().flat_map(|measured| &mut measured.states);
        all.for_each(|nearest| nearest.stale = nearest.known);
    }
    heuristic.follow_losses(&explored.reached);
    let trees = explored.reached.by_born_tree.len();
    heuristic.measured.resize_with(trees, Measured::default);
    heuristic.trees.resize_with(trees, Vec::new);
    heuristic.tries.resize(explored.leaves.leaves().len(), 0);
    heuristic.follow_joins(&explored);
    heuristic.follow_tries(&explored);
    for born in (0..trees as u32).map(TreeId) {
        let list = &explored.reached.by_born_tree[born.at()];
        for &leaf in &list[heuristic.measured[born.at()].known..] {
            heuristic.measure(&model.graph, &explored, settings.level, (born, leaf));
            heuristic.follow_order(
                &model,
                &explored,
                settings.level,
                &mut order,
                (explored.roadmap().tree(born), leaf),
            );
        }
    }
    for side in explored.roadmap().sides() {
        // What stands in the way changes with what the others reach.
        for _ in 0..AGAIN {
            let Some((_, leaf)) = heuristic.heaviest(side) else { break };
            if !heuristic.follow_order(&model, &explored, settings.level, &mut order, (side, leaf)) {
                break;
            }
        }
    }
}

/// Chooses for the guided candidates the leaf to extend and the leaf to aim at.
pub fn choose_leaves(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    explored: Explored<'_, '_>,
    heuristic: Res<'_, LeafHeuristic>,
    order: Res<'_, MoveOrder>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    if settings.selection != Selection::Guided {
        return;
    }
    let weigh = |tree: TreeId| {
        let states = &heuristic.trees[tree.at()];
        let drawn = states.iter().map(|state| (state, state.weight())).collect::<Vec<_>>();
        let heaviest = heuristic.heaviest(tree).filter(|_| order.is_known());
        (tree, heaviest.map(|(_, leaf)| leaf), drawn)
    };
    let trees: Vec<_> = explored.roadmap().sides().map(weigh).collect();
    let guided = settings.guided_probability.powf(if order.is_known() { MOSTLY } else { 1.0 });
    let mut pool: Vec<_> = candidates.iter_mut().filter(|c| c.is_alive() && c.near.is_none()).collect();
    pool.par_iter_mut().with_min_len(LEAST_SHARED).for_each_init(HeuristicScratch::default, |scratch, candidate| {
        let mut rng = stream(settings.seed, Purpose::HEURISTIC, step.step, candidate.index);
        if rng.random::<f64>() >= guided {
            return;
        }
        let Some((tree, heaviest, states)) = trees.choose(&mut rng) else { return };
        let drawn = draw(states, rng.random()).and_then(|leaves| leaves.draw(rng.random()));
        let Some(leaf) = heaviest.filter(|_| rng.random::<f64>() < GREEDY).or(drawn) else { return };
        candidate.tree = Some(*tree);
        candidate.leaf = Some(leaf);
        candidate.target_leaf =
            heuristic.target_leaf(&model.graph, &explored, (leaf, *tree), settings.level, &mut rng, scratch);
    });
}

impl LeafHeuristic {
    /// Takes all weight from transitions that lead from a leaf out of the corridor, where a search has one.
    pub fn stay_in_corridor(&self, graph: &ConstraintGraph, from: &Leaf, choices: &mut [(TransitionId, f64)]) {
        if let Some(corridor) = &self.corridor {
            corridor.keep(graph, &self.distance, from, choices);
        }
    }
}
