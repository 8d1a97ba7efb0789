//! Set Rendezvous: the leaf of another tree that a crossed transition aims at (P0 §III-B, P1 §III-B).
//!
//! Only the rows that the target's foliation adds to the source's count: the released object's placement, the new grasp's
//! complement, where a door stays, where a foot stands. Leaves whose shared rows agree with the node's own come first, because reaching one of them lets the
//! trees meet at once; without any, a leaf of the target state is drawn all the same, which brings the two trees one
//! parameter closer; and where no other tree is in the target state yet, a leaf of any state that has the added rows. Among
//! those, the draw goes by how often each was reached. A guided candidate takes the leaf that it aims at.

use crate::model::PlanningModel;
use crate::parallel::LEAST_SHARED;
use crate::random::{Purpose, draw, stream};
use crate::reached_leaves::LeafColumns;
use crate::schedule::StepCounter;
use crate::selection::Explored;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Query, Res};
use foliate_components::candidate::Candidate;
use foliate_components::graph::{ConstraintId, StateId, Transition, TransitionKind};
use foliate_components::leaf::{Leaf, LeafId, ParameterId};
use foliate_components::outcome::Rejection;
use foliate_components::roadmap::ComponentId;
use rand::RngExt;
use rayon::prelude::*;

/// Draws for every crossed candidate the leaf to aim at.
pub fn draw_leaves(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    explored: Explored<'_>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let crossed = |candidate: &Candidate| {
        let transition = candidate.transition.map(|id| model.graph.transition(id));
        transition.filter(|t| candidate.is_alive() && t.kind == TransitionKind::Crossed)
    };
    let mut pool: Vec<_> = candidates.iter_mut().filter_map(|c| crossed(&c).map(|t| (c, t))).collect();
    pool.par_iter_mut().with_min_len(2 * LEAST_SHARED).for_each(|(candidate, transition)| {
        let Some(near) = candidate.near else { return };
        if let Some(aim) = candidate.aim.filter(|&aim| has_added(&model, explored.leaves.leaf(aim).state, transition)) {
            candidate.drawn = Some(aim);
            return;
        }
        let mut rng = stream(settings.seed, Purpose::Rendezvous, step.step, candidate.index);
        let choice = Draw {
            model: &model,
            explored: &explored,
            source: explored.leaves.leaf(explored.roadmap.node(near).leaf),
            tree: explored.families.family_of(&explored.roadmap, near),
        };
        let u = rng.random();
        let drawn = choice.leaf(|state| state == transition.to, u);
        match drawn.or_else(|| choice.leaf(|state| has_added(&model, state, transition), u)) {
            Some(leaf) => candidate.drawn = Some(leaf),
            None => candidate.reject(Rejection::NoLeafToAimAt),
        }
    });
}

/// Whether the leaves of a state have a value for all that a transition adds.
fn has_added(model: &PlanningModel, state: StateId, transition: &Transition) -> bool {
    transition.adds.iter().all(|c| foliation(model, state).contains(c))
}

struct Draw<'a> {
    model: &'a PlanningModel,
    explored: &'a Explored<'a>,
    source: &'a Leaf,
    tree: ComponentId,
}

impl Draw<'_> {
    /// Draws by `u` ∈ [0, 1) among the leaves of some states that other trees have reached.
    fn leaf(&self, wanted: impl Fn(StateId) -> bool, u: f64) -> Option<LeafId> {
        let mut leaves = self.reached_by_others(&wanted, true);
        if leaves.is_empty() {
            leaves = self.reached_by_others(&wanted, false);
        }
        let choices: Vec<_> = leaves.iter().map(|&(_, leaf, visits)| (leaf, visits)).collect();
        draw(&choices, u)
    }

    /// The leaves of some states that trees other than the candidate's have reached, by state and id, and how often: all, or
    /// those whose shared rows agree with the source's.
    fn reached_by_others(&self, wanted: impl Fn(StateId) -> bool, agreeing: bool) -> Vec<(StateId, LeafId, f64)> {
        let mut leaves = Vec::new();
        for (born, list) in (0u32..).map(ComponentId).zip(&self.explored.reached.by_component) {
            if self.explored.roadmap.component(born) == self.tree {
                continue;
            }
            for columns in self.explored.reached.columns_of(born).iter().filter(|columns| wanted(columns.state)) {
                let shared = if agreeing { self.shared_rows(columns) } else { Vec::new() };
                let agrees = |&(index, _): &(usize, &u32)| shared.iter().all(|&(column, own)| column[index] == own);
                let places = columns.places.iter().enumerate().filter(agrees);
                let entry = |(index, &place): (usize, &u32)| {
                    (columns.state, list[place as usize], f64::from(columns.visits[index]))
                };
                leaves.extend(places.map(entry));
            }
        }
        leaves.sort_by_key(|&(state, leaf, _)| (state, leaf));
        leaves.dedup_by(|next, kept| {
            let same = next.1 == kept.1;
            kept.2 += if same { next.2 } else { 0.0 };
            same
        });
        leaves
    }

    /// The values that the source has too, with the source's own.
    fn shared_rows<'c>(&self, columns: &'c LeafColumns) -> Vec<(&'c [ParameterId], ParameterId)> {
        let rows = foliation(self.model, columns.state).iter().zip(&columns.parameters);
        rows.filter_map(|(&c, column)| Some((column.as_slice(), self.model.graph.value(self.source, c)?))).collect()
    }
}

fn foliation(model: &PlanningModel, state: StateId) -> &[ConstraintId] {
    &model.graph.state(state).foliation
}
