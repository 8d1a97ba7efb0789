//! Transitions: families of motions from one state to another, each leg on one leaf.

use super::{ConstraintId, StateId};

/// Index of a transition in [`crate::graph::constraint_graph::ConstraintGraph::transitions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct TransitionId(pub u32);

impl TransitionId {
    /// The index, for slices.
    #[must_use]
    pub fn at(self) -> usize {
        self.0 as usize
    }
}

/// How a transition chooses its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TransitionKind {
    /// Stays in its state and on its leaf.
    Loop,
    /// Reaches whatever leaf of the target projection leads to (P1 Alg. 2).
    Regular,
    /// Aims at a leaf that another component has reached (P1 §III-B, P0 §III-B).
    Crossed,
}

/// An edge of the constraint graph, with the waypoints it passes (P0 §III-C).
#[derive(Clone, Debug, PartialEq)]
pub struct Transition {
    /// `g > h | …` for a grasp, `g < h | …` for a release, `Loop | …`; `_ls` marks a crossed one (HPP's names).
    pub name: String,
    /// State it leaves.
    pub from: StateId,
    /// State it reaches.
    pub to: StateId,
    /// How it chooses its target.
    pub kind: TransitionKind,
    /// Relative probability of being chosen among the transitions that leave `from` (P0 Alg. 1 line 6).
    pub weight: f64,
    /// What is traversed, in order; at least one leg.
    pub legs: Vec<Leg>,
    /// Foliating constraints of `to` that `from` does not have: the rows whose values are new at arrival, and that a
    /// crossed transition draws.
    pub adds: Vec<ConstraintId>,
    /// The transition whose motions are these, reversed; none while the state that it would leave is not expanded.
    pub reverse: Option<super::TransitionId>,
}

/// A motion on one leaf, from one waypoint to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// The transition's name and the numbers of the waypoints, as HPP numbers inner edges (`…_01`).
    pub name: String,
    /// State in which the motion lies: its leaf is kept along the leg.
    pub state: StateId,
    /// What holds at the end of the leg besides the state's own manifold (pre-grasp, grasp, placement, …).
    pub target: Vec<ConstraintId>,
    /// Constraints of `target` whose right-hand side is drawn, on a crossed transition.
    pub drawn: Vec<ConstraintId>,
    /// Whether the projection starts from the leg's own start instead of a random configuration.
    pub short: bool,
}

impl Transition {
    /// About how many bytes it takes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let ids = |ids: &[ConstraintId]| size_of_val(ids);
        let leg = |leg: &Leg| size_of::<Leg>() + leg.name.len() + ids(&leg.target) + ids(&leg.drawn);
        let legs: usize = self.legs.iter().map(leg).sum();
        (size_of::<Self>() + self.name.len() + legs + ids(&self.adds)) as u64
    }
}
