//! The constraint graph in a recording: as many states and transitions as there is room for, those that the search has to do with
//! first.

use crate::inspection::words;
use crate::planner::recording::document::{LEFT_OUT, StateEntry, TransitionEntry};
use crate::planner::search_record::SearchRecord;
use foliate_components::graph::{ConstraintGraph, StateId, TransitionId, TransitionKind};
use foliate_components::outcome::StateStatistics;
use std::collections::{BTreeMap, BTreeSet};

/// What a row takes beside its texts, bytes: keys, numbers, quotes.
const ROW: u64 = 160;

/// States and transitions of a recording, in the order of their ids.
#[derive(Debug, Default)]
pub(crate) struct GraphRows {
    pub states: Vec<StateEntry>,
    pub transitions: Vec<TransitionEntry>,
    pub states_left_out: u64,
    pub transitions_left_out: u64,
    places_of_states: BTreeMap<u32, u32>,
    places_of_transitions: BTreeMap<u32, u32>,
}

impl GraphRows {
    /// The rows of a graph, of about so many bytes at most.
    pub fn new(graph: &ConstraintGraph, record: Option<&SearchRecord>, most_bytes: u64) -> Self {
        let of_states: BTreeMap<StateId, StateStatistics> =
            record.into_iter().flat_map(|record| record.states.iter().copied()).collect();
        let tried: BTreeSet<TransitionId> =
            record.into_iter().flat_map(|r| r.funnel.iter().map(|&(id, _)| id)).collect();
        let mut rows = Self::default();
        let mut room = most_bytes / 2;
        let mut taken: Vec<StateEntry> = Vec::new();
        let touched = touched(graph, &tried);
        let matters = |id| of_states.contains_key(&StateId(id)) || touched.contains(&StateId(id));
        for id in in_order(graph.states.len(), matters) {
            let row = state_row(graph, id, of_states.get(&StateId(id)).copied().unwrap_or_default());
            let bytes = ROW
                + (row.name.len() + row.words.len() + row.leaves_by.iter().map(|n| n.len() + 3).sum::<usize>()) as u64;
            match room.checked_sub(bytes) {
                Some(left) => {
                    room = left;
                    taken.push(row);
                }
                None => rows.states_left_out += 1,
            }
        }
        taken.sort_by_key(|row| row.id);
        rows.places_of_states = (0..).zip(&taken).map(|(place, row)| (row.id, place)).collect();
        rows.states = taken;
        rows.add_transitions(graph, &tried, most_bytes / 2 + room);
        rows
    }

    fn add_transitions(&mut self, graph: &ConstraintGraph, tried: &BTreeSet<TransitionId>, mut room: u64) {
        let mut taken: Vec<TransitionEntry> = Vec::new();
        for id in in_order(graph.transitions.len(), |id| tried.contains(&TransitionId(id))) {
            let row = self.transition_row(graph, id).and_then(|row| {
                let passed = row.waypoints.iter().map(|name| name.len() + 3).sum::<usize>();
                room = room.checked_sub(ROW + (row.name.len() + row.words.len() + passed) as u64)?;
                Some(row)
            });
            match row {
                Some(row) => taken.push(row),
                None => self.transitions_left_out += 1,
            }
        }
        taken.sort_by_key(|row| row.id);
        self.places_of_transitions = (0..).zip(&taken).map(|(place, row)| (row.id, place)).collect();
        self.transitions = taken;
    }

    /// None where the state that it leaves or reaches is left out.
    fn transition_row(&self, graph: &ConstraintGraph, id: u32) -> Option<TransitionEntry> {
        let transition = graph.transition(TransitionId(id));
        Some(TransitionEntry {
            id,
            name: transition.name.clone(),
            words: words::action(transition),
            from: *self.places_of_states.get(&transition.from.0)?,
            to: *self.places_of_states.get(&transition.to.0)?,
            kind: match transition.kind {
                TransitionKind::Loop => "loop",
                TransitionKind::Regular => "regular",
                TransitionKind::Crossed => "crossed",
            }
            .into(),
            waypoints: words::waypoints(graph, TransitionId(id)),
        })
    }

    /// The place of a state, [`LEFT_OUT`] where it has none.
    pub fn state(&self, id: u32) -> u32 {
        self.places_of_states.get(&id).copied().unwrap_or(LEFT_OUT)
    }

    /// The place of a transition, [`LEFT_OUT`] where it has none.
    pub fn transition(&self, id: u32) -> u32 {
        self.places_of_transitions.get(&id).copied().unwrap_or(LEFT_OUT)
    }
}

/// Numbers up to `count`, those first that matter.
fn in_order(count: usize, matters: impl Fn(u32) -> bool) -> Vec<u32> {
    let (mut first, others): (Vec<u32>, Vec<u32>) = (0..count as u32).partition(|&id| matters(id));
    first.extend(others);
    first
}

/// The states that transitions leave, reach or pass that were tried.
fn touched(graph: &ConstraintGraph, tried: &BTreeSet<TransitionId>) -> BTreeSet<StateId> {
    let transitions = tried.iter().map(|&id| graph.transition(id));
    transitions.flat_map(|t| [t.from, t.to].into_iter().chain(t.legs.iter().map(|leg| leg.state))).collect()
}

fn state_row(graph: &ConstraintGraph, id: u32, statistics: StateStatistics) -> StateEntry {
    let state = graph.state(StateId(id));
    let StateStatistics { nodes, leaves, extended, connections_tried, connections_made } = statistics;
    StateEntry {
        id,
        name: state.name.clone(),
        words: words::situation(&state.name),
        passed_through: state.is_passed_through(),
        leaves_by: state.foliation.iter().map(|&c| graph.constraint(c).name.clone()).collect(),
        nodes,
        leaves,
        extended,
        connections_tried,
        connections_made,
    }
}

#[cfg(test)]
impl GraphRows {
    /// Rows of which only the places of these transitions are known.
    pub(crate) fn with_transitions(ids: &[u32]) -> Self {
        Self { places_of_transitions: ids.iter().copied().zip(0..).collect(), ..Self::default() }
    }
}
