//! Set Rendezvous: the leaf of another tree that a crossed transition aims at (P0 §III-B, P1 §III-B).
//!
//! Only the rows that the target's foliation adds to the source's count: the released object's placement, the new grasp's
//! complement, where a door stays, where a foot stands. Leaves whose shared rows agree with the node's own come first, because reaching one of them lets the
//! trees meet at once; without any, a leaf of the target state is drawn all the same, which brings the two trees one
//! parameter closer; and where no other tree is in the target state yet, a leaf of any state that has the added rows. Among
//! those, the draw goes by how often each was reached. A guided candidate takes the leaf that it aims at.

use crate::model::PlanningModel;
use crate::random::{Purpose, draw, stream};
use crate::schedule::StepCounter;
use crate::selection::Families;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Query, Res};
use foliate_components::candidate::Candidate;
use foliate_components::graph::{ConstraintId, StateId, TransitionKind};
use foliate_components::leaf::{Leaf, LeafId, LeafIndex};
use foliate_components::outcome::Rejection;
use foliate_components::roadmap::{ComponentId, Roadmap, Visits};
use rand::RngExt;
use rayon::prelude::*;

/// A leaf that trees have reached, as the draw sees it.
struct Reached<'a> {
    leaf: &'a Leaf,
    visits: &'a Visits,
}

/// Draws for every crossed candidate the leaf to aim at.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn draw_leaves(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    roadmap: Res<'_, Roadmap>,
    families: Res<'_, Families>,
    leaves: Res<'_, LeafIndex>,
    reached: Query<'_, '_, (&LeafId, &Visits)>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    // By state, in order of leaf ids: the order of entities is not part of the promise.
    let mut by_state: Vec<Vec<(LeafId, Reached<'_>)>> = Vec::new();
    by_state.resize_with(model.graph.states.len(), Vec::new);
    for (&id, visits) in &reached {
        let leaf = leaves.leaf(id);
        by_state[leaf.state.at()].push((id, Reached { leaf, visits }));
    }
    by_state.iter_mut().for_each(|list| list.sort_unstable_by_key(|&(id, _)| id));
    let has_rows = |leaf: &Leaf, rows: &[ConstraintId]| rows.iter().all(|c| foliation(&model, leaf.state).contains(c));

    let mut pool: Vec<_> = candidates.iter_mut().filter(|c| c.is_alive()).collect();
    pool.par_iter_mut().for_each(|candidate| {
        let (Some(near), Some(transition)) = (candidate.near, candidate.transition) else { return };
        let transition = model.graph.transition(transition);
        if transition.kind != TransitionKind::Crossed {
            return;
        }
        let mut rng = stream(settings.seed, Purpose::Rendezvous, step.step, candidate.index);
        let choice = Draw {
            model: &model,
            roadmap: &roadmap,
            source: leaves.leaf(roadmap.node(near).leaf),
            tree: families.family_of(&roadmap, near),
        };
        if let Some(aim) = candidate.aim.filter(|&aim| has_rows(leaves.leaf(aim), &transition.adds)) {
            candidate.drawn = Some(aim);
            return;
        }
        let u = rng.random();
        let drawn = choice.leaf(by_state[transition.to.at()].iter(), u).or_else(|| {
            let elsewhere = by_state.iter().flatten().filter(|(_, r)| has_rows(r.leaf, &transition.adds));
            choice.leaf(elsewhere, u)
        });
        match drawn {
            Some(leaf) => candidate.drawn = Some(leaf),
            None => candidate.reject(Rejection::NoLeafToAimAt),
        }
    });
}

struct Draw<'a> {
    model: &'a PlanningModel,
    roadmap: &'a Roadmap,
    source: &'a Leaf,
    tree: ComponentId,
}

impl Draw<'_> {
    /// Draws by `u` ∈ [0, 1) among reached leaves.
    fn leaf<'r>(&self, reached: impl Iterator<Item = &'r (LeafId, Reached<'r>)> + Clone, u: f64) -> Option<LeafId> {
        let weigh = |agreeing: bool| -> Vec<(LeafId, f64)> {
            let wanted = reached.clone().filter(|(_, r)| !agreeing || self.shared_rows_agree(r.leaf));
            wanted.map(|(id, r)| (*id, self.visits_of_others(r.visits))).filter(|&(_, w)| w > 0.0).collect()
        };
        let mut choices = weigh(true);
        if choices.is_empty() {
            choices = weigh(false);
        }
        draw(&choices, u)
    }

    /// How often trees other than the candidate's have reached a leaf.
    fn visits_of_others(&self, visits: &Visits) -> f64 {
        let others = visits.by_component.iter().filter(|&&(c, _)| self.roadmap.component(c) != self.tree);
        others.map(|&(_, n)| f64::from(n)).sum()
    }

    fn shared_rows_agree(&self, target: &Leaf) -> bool {
        foliation(self.model, target.state)
            .iter()
            .zip(&target.parameters)
            .all(|(&constraint, &value)| self.model.graph.value(self.source, constraint).is_none_or(|own| own == value))
    }
}

fn foliation(model: &PlanningModel, state: StateId) -> &[ConstraintId] {
    &model.graph.state(state).foliation
}
