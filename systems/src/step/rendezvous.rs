//! Set Rendezvous: the leaf of another tree that a crossed transition aims at (P0 §III-B, P1 §III-B).
//!
//! Only the rows that the target's foliation adds to the source's count: the released object's placement, the new grasp's
//! complement, where a door stays, where a foot stands. Leaves whose shared rows agree with the node's own come first,
//! because reaching one of them lets the trees meet at once; without any, a leaf of the target state is drawn all the same,
//! which brings the two trees one
//! parameter closer; and where no other tree is in the target state yet, a leaf of any state that has the added rows. Among
//! those, the draw goes by how often each was reached. A guided candidate takes the leaf that it aims at.

use crate::exploration::explored::Explored;
use crate::exploration::visited_leaves::draw_by_visits;
use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::LEAST_SHARED;
use crate::runtime::random::{Purpose, stream};
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Query, Res};
use foliate_components::candidate::Candidate;
use foliate_components::graph::leaf::{Leaf, LeafId, ParameterId};
use foliate_components::graph::{ConstraintId, StateId, Transition, TransitionKind};
use foliate_components::outcome::Rejection;
use foliate_components::roadmap::TreeId;
use foliate_kernels::lanes::Level;
use rand::RngExt;
use rayon::prelude::*;

/// Draws for every crossed candidate the leaf to aim at.
pub fn draw_leaves(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    explored: Explored<'_, '_>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let crossed = |candidate: &Candidate| {
        let transition = candidate.transition.map(|id| model.graph.transition(id));
        transition.filter(|t| candidate.is_alive() && t.kind == TransitionKind::Crossed)
    };
    let mut pool: Vec<_> = candidates.iter_mut().filter_map(|c| crossed(&c).map(|t| (c, t))).collect();
    pool.par_iter_mut().with_min_len(2 * LEAST_SHARED).for_each(|(candidate, transition)| {
        let Some(near) = candidate.near else { return };
        if let Some(target_leaf) = candidate
            .target_leaf
            .filter(|&target_leaf| has_added(&model, explored.leaves.leaf(target_leaf).state, transition))
        {
            candidate.drawn = Some(target_leaf);
            return;
        }
        let mut rng = stream(settings.seed, Purpose::RENDEZVOUS, step.step, candidate.index);
        let choice = Draw {
            model: &model,
            explored: &explored,
            source: explored.leaves.leaf(explored.roadmap().node(near).leaf),
            tree: explored.roadmap().side_of(near),
            level: settings.level,
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
    explored: &'a Explored<'a, 'a>,
    source: &'a Leaf,
    tree: TreeId,
    level: Level,
}

impl Draw<'_> {
    /// Draws by `u` ∈ [0, 1) among the leaves of some states that trees other than the candidate's have reached: those whose
    /// shared rows agree with the source's, or all where there are none.
    fn leaf(&self, wanted: impl Fn(StateId) -> bool, u: f64) -> Option<LeafId> {
        let states = || self.explored.reached.visited().iter().filter(|visited| wanted(visited.state));
        let all = || states().map(|visited| (visited.state, visited.reached_by_others(self.tree)));
        let agreeing: Vec<_> = all().filter_map(|(state, choices)| choices.with(self.shared_rows(state))).collect();
        draw_by_visits(self.level, &agreeing, u).or_else(|| {
            let all: Vec<_> = all().map(|(_, choices)| choices).collect();
            draw_by_visits(self.level, &all, u)
        })
    }

    /// The values that the source has too, by position in the foliation of a state, with the source's own.
    fn shared_rows(&self, state: StateId) -> impl Iterator<Item = (usize, ParameterId)> {
        let rows = foliation(self.model, state).iter().enumerate();
        rows.filter_map(|(row, &c)| Some((row, self.model.graph.value(self.source, c)?)))
    }
}

fn foliation(model: &PlanningModel, state: StateId) -> &[ConstraintId] {
    &model.graph.state(state).foliation
}
