//! The leaves that lie on short ways between two leaves.

use crate::heuristic::grasp_distance::GraspDistance;
use foliate_components::graph::leaf::Leaf;
use foliate_components::graph::{ConstraintGraph, TransitionId};

/// The leaves on ways from one leaf to another with at most so many changes of grasp, by [`GraspDistance`].
#[derive(Clone, Debug)]
pub(crate) struct Corridor {
    pub from: Leaf,
    pub to: Leaf,
    pub most: u16,
}

impl Corridor {
    /// Takes all weight from transitions that lead from a leaf out of the corridor.
    pub fn keep(
        &self,
        graph: &ConstraintGraph,
        distance: &GraspDistance,
        from: &Leaf,
        choices: &mut [(TransitionId, f64)],
    ) {
        let after =
            |end: &Leaf| distance.after_each(graph, from, end, choices.iter().map(|&(id, _)| graph.transition(id)));
        let (back, ahead) = (after(&self.from), after(&self.to));
        for ((_, weight), (back, ahead)) in choices.iter_mut().zip(back.into_iter().zip(ahead)) {
            if back + ahead > self.most {
                *weight = 0.0;
            }
        }
    }
}
