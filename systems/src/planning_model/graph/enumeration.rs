//! Builds the constraint graph of a problem: P1 Algorithm 1, with the waypoints of P0 §III-C.
//!
//! A state is one of the problem's own states (one without constraints, where there are none), an injective map from some
//! grippers to handles, and for every object that nothing holds the body on which it lies (or it stays where it is, when it
//! has no surfaces). A transition adds or takes away one grasp, or goes from one of the problem's own states to another.
//! Between two states lie waypoints, see `legs`.

use crate::planning_model::graph::attachment_order::Chain;
use crate::planning_model::graph::builder::{Builder, Census};
use crate::planning_model::graph::checks::{GraphError, MOST_SETS, MOST_STATES, check};
use crate::planning_model::graph::states::state_keys::{Documents, Grasps, StateKey, StateKeys, grasp_sets, handles};
use crate::planning_model::graph::transitions::{Change, led_to, loop_transition, reverse_of};
use foliate_components::graph::{
    ConstraintGraph, ConstraintId, ConstraintKind, Fingers, Leg, StateId, Transition, TransitionKind,
};
use foliate_components::problem::{Problem, WrittenTransition};

/// Builds all states, transitions and crossed transitions.
///
/// # Errors
/// See [`GraphError`]; [`GraphError::TooManyStates`] where the graph can only grow while it is searched.
pub fn build_constraint_graph(problem: &Problem) -> Result<ConstraintGraph, GraphError> {
    check(problem)?;
    let documents = Documents::new(problem)?;
    let mut graph = ConstraintGraph::new(problem.graph.objects.clone());
    let mut census = Census::default();
    let mut builder =
        Builder { state_keys: StateKeys::new(problem, &documents), graph: &mut graph, census: &mut census };
    let too_many = || GraphError::TooManyStates {
        grippers: problem.graph.grippers.len(),
        handles: handles(&problem.graph).count(),
    };
    for grasps in grasp_sets(&problem.graph, |_, _| true, MOST_SETS).ok_or_else(too_many)? {
        builder.make_states(&grasps).ok_or_else(too_many)?;
    }
    if builder.graph.states.is_empty() {
        return Err(GraphError::NothingAllowed);
    }
    // Making transitions adds states that are only passed through.
    for state in 0..builder.graph.states.len() as u32 {
        builder.make_transitions(StateId(state));
    }
    builder.link_reverses();
    Ok(graph)
}

impl Builder<'_> {
    /// P1 Algorithm 1, MAKESTATE, for each of the problem's own states and each way to lie; `None` where the graph gets too
    /// large to be whole.
    fn make_states(&mut self, grasps: &Grasps) -> Option<()> {
        let ways = self.state_keys.ways_to_lie(grasps, |_, _| true, MOST_STATES)?;
        for written in 0..self.state_keys.options.states.len().max(1) {
            for lying in &ways {
                if self.graph.states.len() >= MOST_STATES {
                    return None;
                }
                let (grasps, lying) = (grasps.clone(), lying.clone());
                self.make_state(StateKey { written, grasps, lying, fingers: Fingers::Still });
            }
        }
        Some(())
    }

    /// P1 Algorithm 1, lines 11-16 and MAKETRANSITIONS: all that leaves a state.
    pub fn make_transitions(&mut self, state: StateId) {
        let here = self.state_keys.abbreviation(&self.census.state_keys[state.at()]);
        let mut leaving = vec![loop_transition(state, &here)];
        self.let_fingers_move(state);
        for change in self.changes_at(state) {
            leaving.extend(self.transitions_of(state, &here, change));
        }
        for written in &self.state_keys.options.transitions {
            leaving.extend(self.written_transitions(state, &here, written));
        }
        // Loops explore the leaf that a tree is on; one in eight extensions is enough.
        let others: f64 = leaving[1..].iter().map(|t| t.weight).sum();
        leaving[0].weight = if others > 0.0 { others / 7.0 } else { 1.0 };
        self.graph.add_leaving(state, leaving);
    }

    /// Every grasp that can be made or released from a state, with every way to lie of what is let go.
    fn changes_at(&mut self, state: StateId) -> Vec<Change> {
        let (state_keys, key) = (self.state_keys, self.key(state));
        let held = state_keys.held(&key.grasps);
        let mut changes = Vec::new();
        for &gripper in &state_keys.options.grippers {
            if let Some(&(_, handle)) = key.grasps.iter().find(|&&(g, _)| g == gripper) {
                let fewer: Grasps = key.grasps.iter().copied().filter(|&(g, _)| g != gripper).collect();
                let without = self.states_with((&key, &held), &fewer);
                changes.extend(without.into_iter().map(|without| Change { gripper, handle, without, with: state }));
                continue;
            }
            for handle in handles(state_keys.options) {
                let more = state_keys.sorted_with(&key.grasps, gripper, handle);
                if !state_keys.are_allowed(&more) {
                    continue;
                }
                let with = self.states_with((&key, &held), &more);
                changes.extend(with.into_iter().map(|with| Change { gripper, handle, without: state, with }));
            }
        }
        changes
    }

    /// The states with other grasps in which what lies in `key` and lies still, lies where it did; with what is held in it.
    fn states_with(&mut self, (key, before): (&StateKey, &Chain<'_>), grasps: &Grasps) -> Vec<StateId> {
        let lies_there = |object: usize, body| before.is_carried(object) || key.lying[object] == body;
        let ways = self.state_keys.ways_to_lie(grasps, lies_there, MOST_STATES).unwrap_or_default();
        let key = |lying| StateKey { written: key.written, grasps: grasps.clone(), lying, fingers: Fingers::Still };
        ways.into_iter().filter_map(|lying| self.state(key(lying))).collect()
    }

    /// The regular transition of a change as seen from `from`, and its crossed twin where the target's foliation adds rows.
    fn transitions_of(&mut self, from: StateId, here: &str, change: Change) -> Vec<Transition> {
        let grasping = from == change.without;
        let (to, sign) = if grasping { (change.with, '>') } else { (change.without, '<') };
        let robot = self.state_keys.robot;
        let (gripper, handle) = (&robot.grippers[change.gripper.at()].name, &robot.handles[change.handle.at()].name);
        let name = match self.state_keys.lying_name(&self.key(change.without), Some(&self.key(change.with))) {
            lying if lying.is_empty() || grasping => format!("{gripper} {sign} {handle} | {here}"),
            lying => format!("{gripper} {sign} {handle}, {} | {here}", lying.join(", ")),
        };
        let legs = if grasping { self.grasping_legs(&name, change) } else { self.releasing_legs(&name, change) };
        self.with_twin(name, from, to, legs)
    }

    /// A transition of the problem's own with the grasps of a state, and its crossed twin.
    fn written_transitions(&mut self, from: StateId, here: &str, written: &WrittenTransition) -> Vec<Transition> {
        let key = self.key(from);
        if key.written != written.from as usize {
            return Vec::new();
        }
        let mut at = |number: u32| self.state(StateKey { written: number as usize, ..StateKey::clone(&key) });
        let (Some(to), Some(within)) =
            (at(written.to), written.legs.iter().map(|leg| at(leg.within)).collect::<Option<Vec<_>>>())
        else {
            return Vec::new();
        };
        let name = format!("{} | {here}", written.name);
        let mut legs: Vec<Leg> = Vec::new();
        for (number, (leg, &state)) in written.legs.iter().zip(&within).enumerate() {
            let until = leg.until.iter().map(|&constraint| self.constraint(ConstraintKind::Given { constraint }));
            let target: Vec<ConstraintId> = until.collect();
            let name = format!("{name}_{number}{}", number + 1);
            legs.push(Leg { name, state, target, drawn: Vec::new(), short: leg.short });
        }
        if legs.is_empty() {
            let name = format!("{name}_01");
            legs.push(Leg { name, state: from, target: Vec::new(), drawn: Vec::new(), short: false });
        }
        // Where a leg ends, the next one's state must hold.
        for number in 0..legs.len() {
            let next = legs.get(number + 1).map_or(to, |leg| leg.state);
            let here = &self.graph.state(legs[number].state).manifold;
            let mut target: Vec<_> = legs[number].target.iter().copied().filter(|c| !here.contains(c)).collect();
            for constraint in self.difference(next, legs[number].state) {
                if !target.contains(&constraint) {
                    target.push(constraint);
                }
            }
            legs[number].target = target;
        }
        self.with_twin(name, from, to, legs)
    }

    /// A regular transition, and its crossed twin where the target's foliation has rows to aim at.
    fn with_twin(&self, name: String, from: StateId, to: StateId, legs: Vec<Leg>) -> Vec<Transition> {
        let source = &self.graph.state(from).foliation;
        let adds: Vec<_> = self.graph.state(to).foliation.iter().copied().filter(|c| !source.contains(c)).collect();
        let kind = TransitionKind::Regular;
        let regular = Transition { name, from, to, kind, weight: 1.0, legs, adds: adds.clone(), reverse: None };
        if adds.is_empty() {
            return vec![regular];
        }
        let crossed = self.crossed_twin(&regular, adds);
        // Rows that hold at the start already cannot be aimed at.
        if crossed.legs.iter().all(|leg| leg.drawn.is_empty()) {
            return vec![regular];
        }
        vec![regular, crossed]
    }

    /// P1 §III-B: the same legs, with the added rows' right-hand sides drawn from the leaves of other trees.
    fn crossed_twin(&self, regular: &Transition, adds: Vec<ConstraintId>) -> Transition {
        let mut crossed = Transition {
            name: format!("{}_ls", regular.name),
            kind: TransitionKind::Crossed,
            adds: adds.clone(),
            ..regular.clone()
        };
        for leg in &mut crossed.legs {
            if let Some(number) = leg.name.strip_prefix(&regular.name) {
                leg.name = format!("{}{number}", crossed.name);
            }
            leg.drawn = leg.target.iter().copied().filter(|&c| self.leads_to(c, &adds)).collect();
        }
        crossed
    }

    /// Whether a constraint of a waypoint can already carry the drawn value of one of `adds`.
    fn leads_to(&self, target: ConstraintId, adds: &[ConstraintId]) -> bool {
        let wanted = led_to(self.graph.constraint(target).kind);
        adds.iter().any(|&added| self.graph.constraint(added).kind == wanted)
    }

    /// A motion travelled backwards is one of a transition back: where there are several, the one with the same legs.
    fn link_reverses(&mut self) {
        for state in 0..self.graph.states.len() as u32 {
            self.link_reverses_of(StateId(state), |_| true);
        }
    }

    /// Likewise, for the transitions between a state and its neighbours, both ways.
    pub fn link_reverses_around(&mut self, state: StateId) {
        self.link_reverses_of(state, |_| true);
        let mut neighbours: Vec<_> = self.graph.leaving(state).map(|(_, t)| t.to).filter(|&to| to != state).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        for neighbour in neighbours {
            self.link_reverses_of(neighbour, |t| t.to == state);
        }
    }

    fn link_reverses_of(&mut self, state: StateId, which: impl Fn(&Transition) -> bool) {
        let graph = &*self.graph;
        let wanted = graph.leaving(state).filter(|(_, t)| which(t));
        let reverses: Vec<_> = wanted.map(|(id, t)| (id, reverse_of(graph, id, t))).collect();
        for (id, reverse) in reverses {
            self.graph.transitions[id.at()].reverse = reverse;
        }
    }
}
