//! Which states and transitions are shown, and what they are called.

use crate::inspection::words::{self, ShortNames};
use crate::view::document::graph::{GraphEntry, StateEntry, TransitionEntry, TransitionKindEntry};
use crate::view::graph::bundles::Drawing;
use crate::view::graph::layout::{Placed, place};
use crate::view::graph::lines::LOOP;
use foliate_components::graph::{ConstraintGraph, StateId, Transition, TransitionId, TransitionKind};
use std::collections::{BTreeMap, HashMap, VecDeque};

/// Most states of one picture.
pub const MOST_STATES: usize = 100;
/// Up to so many states lines carry words.
const LABELLED: usize = 9;
/// Size of a letter and of a line of text.
const LETTER: f64 = 6.6;
const ROW: f64 = 15.0;
/// Room around the text of a box.
const PADDING: f64 = 9.0;

/// What a picture shows.
#[derive(Clone, Debug)]
pub struct PictureOptions {
    /// Whether waypoints are boxes of their own; otherwise they are only listed.
    pub waypoints: bool,
    /// Most states.
    pub most_states: usize,
    /// The states that matter; of a graph that is too large those are shown that are near to these.
    pub around: Vec<StateId>,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self { waypoints: false, most_states: MOST_STATES, around: Vec::new() }
    }
}

/// A picture of a constraint graph.
#[must_use]
pub fn picture(graph: &ConstraintGraph, names: &ShortNames, options: &PictureOptions) -> GraphEntry {
    let (shown, left_out) = chosen(graph, options);
    let places: HashMap<StateId, usize> = shown.iter().enumerate().map(|(place, &state)| (state, place)).collect();
    let mut entries: Vec<StateEntry> = shown.iter().map(|&state| state_entry(graph, state, names)).collect();
    let transitions: Vec<(TransitionId, &Transition)> = (0..)
        .map(TransitionId)
        .zip(&graph.transitions)
        .filter(|(_, t)| places.contains_key(&t.from) && places.contains_key(&t.to))
        .collect();
    let mut drawing = Drawing::default();
    drawing.boxes.extend(entries.iter().map(|entry| size(&entry.lines)));
    let mut loops = vec![0; shown.len()];
    let depth = depths(graph, &shown, &places);
    let labelled = shown.len() <= LABELLED;
    for &(id, transition) in transitions.iter().filter(|(_, t)| t.from != t.to) {
        let (from, to) = (places[&transition.from], places[&transition.to]);
        let down = (depth[from], from) < (depth[to], to);
        let key = (from.min(to), from.max(to), subject(&transition.name));
        let bundle = drawing.bundles.entry(key).or_default();
        if down { bundle.down.push(id) } else { bundle.up.push(id) }
    }
    let words = |id: TransitionId| names.transition(&graph.transition(id).name);
    drawing.add_lines(&depth, |bundle| {
        let first = bundle.down.first().or(bundle.up.first()).copied();
        let words = first.filter(|_| labelled).map(words).unwrap_or_default();
        let waypoints = first.filter(|_| options.waypoints).map(|id| words::waypoints(graph, id)).unwrap_or_default();
        let is_down = !bundle.down.is_empty();
        (words, if is_down { waypoints } else { waypoints.into_iter().rev().collect() })
    });
    let [width, height] = place(&mut drawing.boxes, &mut drawing.lines);
    for (entry, placed) in entries.iter_mut().zip(&drawing.boxes) {
        (entry.x, entry.y) = (placed.x - 0.5 * placed.w, placed.y - 0.5 * placed.h + 2.0 * LOOP);
        (entry.w, entry.h) = (placed.w, placed.h - 2.0 * LOOP);
    }
    // Loops and lines begin at the boxes that are seen.
    let seen = |(placed, entry): (&Placed, &StateEntry)| Placed { h: entry.h, y: entry.y + 0.5 * entry.h, ..*placed };
    let states: Vec<Placed> = drawing.boxes.iter().zip(&entries).map(seen).collect();
    drawing.boxes[..states.len()].copy_from_slice(&states);
    let mut entry = |&(id, transition): &(TransitionId, &Transition)| {
        let (from, to) = (places[&transition.from], places[&transition.to]);
        let points = drawing.points(id, from, to, loops[from]);
        loops[from] += usize::from(from == to);
        TransitionEntry {
            id: id.0,
            from,
            to,
            name: transition.name.clone(),
            words: names.transition(&transition.name),
            kind: kind(transition.kind),
            points,
            tried: None,
            succeeded: None,
            waypoints: words::waypoints(graph, id),
        }
    };
    let transitions = transitions.iter().map(&mut entry).collect();
    GraphEntry { width, height, left_out, states: entries, transitions, marks: drawing.marks() }
}

fn kind(kind: TransitionKind) -> TransitionKindEntry {
    match kind {
        TransitionKind::Loop => TransitionKindEntry::Loop,
        TransitionKind::Regular => TransitionKindEntry::Regular,
        TransitionKind::Crossed => TransitionKindEntry::Crossed,
    }
}

/// The states that are shown, by id; and what is left out.
fn chosen(graph: &ConstraintGraph, options: &PictureOptions) -> (Vec<StateId>, Option<String>) {
    let all: Vec<StateId> = graph.states_of_nodes().map(|(id, _)| id).collect();
    let lazy = if graph.lazy { "the graph grows while it is searched; " } else { "" };
    if all.len() <= options.most_states {
        let left_out = graph.lazy.then(|| format!("{lazy}{} states have come into being", all.len()));
        return (all, left_out);
    }
    let mut neighbours: BTreeMap<StateId, Vec<StateId>> = BTreeMap::new();
    for transition in &graph.transitions {
        neighbours.entry(transition.from).or_default().push(transition.to);
        neighbours.entry(transition.to).or_default().push(transition.from);
    }
    let first = if options.around.is_empty() { &all[..1] } else { &options.around };
    let (mut shown, mut queue) = (Vec::new(), VecDeque::new());
    let mut seen: std::collections::HashSet<StateId> = std::collections::HashSet::new();
    queue.extend(first.iter().copied().filter(|&state| seen.insert(state)));
    while let Some(state) = queue.pop_front() {
        if shown.len() == options.most_states {
            break;
        }
        shown.push(state);
        let near = neighbours.get(&state).into_iter().flatten().copied();
        queue.extend(near.filter(|&state| seen.insert(state)));
    }
    shown.retain(|&state| !graph.state(state).is_passed_through());
    shown.sort_unstable();
    let what = if options.around.is_empty() { "the first state" } else { "what is looked at" };
    let left_out = format!("{lazy}{} of {} states are shown: those that are nearest to {what}", shown.len(), all.len());
    (shown, Some(left_out))
}

fn state_entry(graph: &ConstraintGraph, id: StateId, names: &ShortNames) -> StateEntry {
    let state = graph.state(id);
    let lines = names.state(&state.name);
    StateEntry {
        id: id.0,
        name: state.name.clone(),
        words: lines.join(", "),
        x: 0.0,
        y: 0.0,
        w: 0.0,
        h: 0.0,
        passed_through: state.is_passed_through(),
        lines,
    }
}

/// The box of some lines of text, with room for loops above it.
fn size(lines: &[String]) -> Placed {
    let longest = lines.iter().map(|line| line.chars().count()).max().unwrap_or(0);
    let w = (longest as f64 * LETTER + 2.0 * PADDING).max(4.0 * LOOP + 24.0);
    Placed { w, h: lines.len() as f64 * ROW + 2.0 * PADDING + 2.0 * LOOP, ..Placed::default() }
}

/// By shown state how many transitions it is from the one with the fewest grasps.
fn depths(graph: &ConstraintGraph, shown: &[StateId], places: &HashMap<StateId, usize>) -> Vec<usize> {
    let mut neighbours = vec![Vec::new(); shown.len()];
    for transition in &graph.transitions {
        if let (Some(&from), Some(&to)) = (places.get(&transition.from), places.get(&transition.to)) {
            neighbours[from].push(to);
            neighbours[to].push(from);
        }
    }
    let mut order: Vec<usize> = (0..shown.len()).collect();
    order.sort_by_key(|&place| (graph.state(shown[place]).grasps.len(), place));
    let mut depth = vec![usize::MAX; shown.len()];
    for first in order {
        if depth[first] != usize::MAX {
            continue;
        }
        depth[first] = 0;
        let mut queue = VecDeque::from([first]);
        while let Some(place) = queue.pop_front() {
            for &next in &neighbours[place] {
                if depth[next] == usize::MAX {
                    depth[next] = depth[place] + 1;
                    queue.push_back(next);
                }
            }
        }
    }
    depth
}

/// What a transition is about, whichever way it goes: gripper and handle.
fn subject(name: &str) -> String {
    let bare = name.split_once(" | ").map_or(name, |(bare, _)| bare);
    let bare = bare.split_once(", ").map_or(bare, |(bare, _)| bare);
    bare.replace(" < ", " > ")
}
