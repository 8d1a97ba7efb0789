//! Parts of transitions that a whole graph and a lazy one build alike: loops, legs, the reverse of a transition, and which
//! constraint a waypoint leads to.

use foliate_components::graph::{
    ConstraintGraph, ConstraintId, ConstraintKind, Leg, StateId, Transition, TransitionId, TransitionKind,
};
use foliate_components::robot::{GripperIndex, HandleIndex};

/// A grasp that is made or released between two states.
#[derive(Clone, Copy)]
pub(crate) struct Change {
    pub(crate) gripper: GripperIndex,
    pub(crate) handle: HandleIndex,
    /// State without the grasp.
    pub(crate) without: StateId,
    /// State with the grasp.
    pub(crate) with: StateId,
}

/// The motions of a state, of which `here` is short for its name.
pub(crate) fn loop_transition(state: StateId, here: &str) -> Transition {
    let name = format!("Loop | {here}");
    let leg = Leg { name: name.clone(), state, target: Vec::new(), drawn: Vec::new(), short: false };
    Transition {
        name,
        from: state,
        to: state,
        kind: TransitionKind::Loop,
        weight: 1.0,
        legs: vec![leg],
        adds: Vec::new(),
        reverse: None,
    }
}

pub(crate) fn reverse_of(graph: &ConstraintGraph, id: TransitionId, transition: &Transition) -> Option<TransitionId> {
    if transition.kind == TransitionKind::Loop {
        return Some(id);
    }
    let back = |t: &Transition| t.kind == TransitionKind::Regular && t.to == transition.from;
    let same = |t: &Transition| t.legs.iter().map(|l| l.state).eq(transition.legs.iter().rev().map(|l| l.state));
    let mut first = None;
    for (id, candidate) in graph.leaving(transition.to).filter(|(_, t)| back(t)) {
        if same(candidate) {
            return Some(id);
        }
        first = first.or(Some(id));
    }
    first
}

pub(crate) fn leg(name: &str, number: &str, state: StateId, target: Vec<ConstraintId>, short: bool) -> Leg {
    Leg { name: format!("{name}_{number}"), state, target, drawn: Vec::new(), short }
}

/// The constraint whose value a waypoint's constraint leads to.
#[must_use]
pub(crate) fn led_to(kind: ConstraintKind) -> ConstraintKind {
    match kind {
        ConstraintKind::Preplacement { object, on } => ConstraintKind::Placement { object, on },
        ConstraintKind::Pregrasp { gripper, handle } => ConstraintKind::Grasp { gripper, handle },
        other => other,
    }
}
