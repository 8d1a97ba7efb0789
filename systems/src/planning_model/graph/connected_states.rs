//! Which states a path from a state may pass.

use foliate_components::graph::{ConstraintGraph, State, StateId};

/// By state, whether transitions between states that `may_pass` accepts join it to a state. They count in either direction, since trees
/// grow from goals too. A state that is only passed through counts where a transition between such states passes it.
///
/// Of a lazy graph it knows only what has come into being.
#[must_use]
pub fn connected_states(graph: &ConstraintGraph, from: StateId, may_pass: impl Fn(&State) -> bool) -> Vec<bool> {
    let is_open: Vec<bool> = graph.states.iter().map(may_pass).collect();
    let ways = || {
        let passes = |state: StateId| is_open[state.at()];
        graph.transitions.iter().filter(move |transition| {
            passes(transition.from) && passes(transition.to) && transition.legs.iter().all(|leg| passes(leg.state))
        })
    };
    let mut near = vec![Vec::new(); graph.states.len()];
    for way in ways().filter(|way| way.from != way.to) {
        near[way.from.at()].push(way.to);
        near[way.to.at()].push(way.from);
    }
    let mut is_connected = vec![false; graph.states.len()];
    let mut left = vec![from];
    while let Some(state) = left.pop() {
        if !std::mem::replace(&mut is_connected[state.at()], true) {
            left.extend(near[state.at()].iter().copied());
        }
    }
    let is_node = is_connected.clone();
    for way in ways().filter(|way| is_node[way.from.at()]) {
        way.legs.iter().for_each(|leg| is_connected[leg.state.at()] = true);
    }
    is_connected
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::graph::{Fingers, Leg, Transition, TransitionKind};

    fn graph(states: u32, transitions: &[(u32, u32, u32)]) -> ConstraintGraph {
        let mut graph = ConstraintGraph::new(Vec::new());
        for number in 0..states {
            let (manifold, foliation) = (Vec::new(), Vec::new());
            let name = number.to_string();
            let (grasps, fingers) = (Vec::new(), Fingers::Still);
            graph.add_state(State { name, written: None, grasps, fingers, manifold, foliation, priority: 0 });
        }
        for &(from, to, passed) in transitions {
            let state = StateId(passed);
            let leg = Leg { name: String::new(), state, target: Vec::new(), drawn: Vec::new(), short: false };
            graph.transitions.push(Transition {
                name: format!("{from} to {to}"),
                from: StateId(from),
                to: StateId(to),
                kind: TransitionKind::Regular,
                weight: 1.0,
                legs: vec![leg],
                adds: Vec::new(),
                reverse: None,
            });
        }
        graph.index();
        graph
    }

    #[test]
    fn transitions_join_in_both_directions_and_what_is_closed_joins_nothing() {
        let graph = graph(5, &[(1, 0, 1), (1, 2, 4), (3, 3, 3)]);
        assert_eq!(connected_states(&graph, StateId(0), |_| true), [true, true, true, false, true]);
        let without = |closed: &str| connected_states(&graph, StateId(0), |state| state.name != closed);
        assert_eq!(without("1"), [true, false, false, false, false]);
        assert_eq!(without("4"), [true, true, false, false, false]);
    }
}
