//! How many grasps lie between two leaves.
//!
//! What a leaf says falls into *subjects*: each object with all that holds or carries it, each joint at rest, and the
//! stance of the robot itself. The constraint graph, restricted to one subject, is a small graph of its own (on the
//! table, in the left hand, in both, …). The distance between two leaves is the sum over the subjects of the shortest ways
//! in these graphs: an estimate that forgets that hands are needed twice and that things are in each other's way, as the
//! relaxed plans of task planners do. It costs nanoseconds and tells which of a thousand leaves are worth extending.
//!
//! The small graphs grow with the constraint graph: of a lazy one they hold what has come into being, where each change may be
//! taken back.

use crate::heuristic::leaf_distance_table::{LeafDistanceTable, Row};
use foliate_components::graph::leaf::Leaf;
use foliate_components::graph::{ConstraintGraph, ConstraintId, ConstraintKind, StateId, Transition, TransitionKind};
use std::collections::HashMap;
use std::sync::OnceLock;

/// Farther than this is as far.
const FAR: u8 = 16;

/// The subject of constraints that are about none.
const NO_SUBJECT: usize = usize::MAX;

/// Distances between the leaves of one graph.
#[derive(Clone, Debug, Default)]
pub struct GraspDistance {
    subjects: Vec<Subject>,
    numbers: HashMap<Of, usize>,
    /// By constraint: the number of its subject, or [`NO_SUBJECT`].
    subject_of: Vec<usize>,
    /// By state and subject: what the state says of it, as a number of [`Subject::situations`].
    situations: Vec<Vec<usize>>,
    /// How many transitions are known.
    transitions: usize,
}

/// What constraints are about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Of {
    Object(u32),
    Joint(u32),
    Stance,
}

/// The graph as one subject sees it.
#[derive(Clone, Debug, Default)]
struct Subject {
    situations: Vec<Situation>,
    /// By situation: those that one change leads to.
    next: Vec<Vec<usize>>,
    /// Changes from one situation to another, row by row.
    changes: Vec<u8>,
    /// Each constraint with values.
    through_lack: Vec<(ConstraintId, Lack)>,
}

/// Changes from one situation to another through one that lacks a constraint. Few rows are ever asked for, and each is found in one search of the graph:
/// all rows of all constraints would take most of the time where hands have dozens of grasps.
#[derive(Clone, Debug)]
struct Lack {
    /// By situation: whether it lacks the constraint.
    lacks: Vec<bool>,
    /// By situation from which changes are counted: the changes to every situation.
    rows: Vec<OnceLock<Vec<u8>>>,
}

/// What a state says of a subject.
#[derive(Clone, Debug)]
struct Situation {
    constraints: Vec<ConstraintId>,
    /// Those of them with values.
    foliating: Vec<ConstraintId>,
}

impl GraspDistance {
    /// Reads a graph.
    #[must_use]
    pub fn new(graph: &ConstraintGraph) -> Self {
        let mut distances = Self::default();
        distances.grow(graph);
        distances
    }

    /// Reads what has come into being in the graph since it was last read; true where that may change distances that were known.
    pub fn grow(&mut self, graph: &ConstraintGraph) -> bool {
        if self.situations.len() == graph.states.len() && self.transitions == graph.transitions.len() {
            return false;
        }
        self.number_constraints(graph);
        let count = self.subjects.len();
        let mut has_grown = vec![false; count];
        for state in &graph.states[self.situations.len()..] {
            let situations = (0..count).map(|subject| {
                let constraints: Vec<_> =
                    state.manifold.iter().copied().filter(|c| self.subject_of[c.at()] == subject).collect();
                let known = self.subjects[subject].situations.len();
                let number = self.subjects[subject].number(graph, constraints);
                has_grown[subject] |= number == known;
                number
            });
            let situations = situations.collect();
            self.situations.push(situations);
        }
        for transition in &graph.transitions[self.transitions..] {
            let (from, to) = (&self.situations[transition.from.at()], &self.situations[transition.to.at()]);
            for (number, (&a, &b)) in from.iter().zip(to).enumerate() {
                has_grown[number] |= self.subjects[number].lead(a, b);
                // What was never stood on has no transitions yet; what is taken can be set down again.
                has_grown[number] |= graph.lazy && self.subjects[number].lead(b, a);
            }
        }
        self.transitions = graph.transitions.len();
        let grown = self.subjects.iter_mut().zip(&has_grown).filter(|(_, has_grown)| **has_grown);
        grown.for_each(|(subject, _)| subject.measure());
        has_grown.contains(&true)
    }

    /// Gives new constraints their subjects; the states that are known say nothing of new subjects.
    fn number_constraints(&mut self, graph: &ConstraintGraph) {
        for constraint in &graph.constraints[self.subject_of.len()..] {
            let Some(of) = Of::constraint(graph, constraint.kind) else {
                self.subject_of.push(NO_SUBJECT);
                continue;
            };
            let next = self.numbers.len();
            let number = *self.numbers.entry(of).or_insert(next);
            self.subject_of.push(number);
        }
        for _ in self.subjects.len()..self.numbers.len() {
            let mut subject = Subject::default();
            if !self.situations.is_empty() {
                subject.number(graph, Vec::new());
                subject.measure();
            }
            self.subjects.push(subject);
        }
        self.situations.iter_mut().for_each(|row| row.resize(self.subjects.len(), 0));
    }

    /// Changes of grasp from one leaf to another.
    #[must_use]
    pub fn between(&self, graph: &ConstraintGraph, from: &Leaf, to: &Leaf) -> u16 {
        self.sum(to, from.state, |c| graph.value(from, c) == graph.value(to, c))
    }

    /// The subject that an object is, where any constraint is about it.
    pub(crate) fn subject_of_object(&self, object: u32) -> Option<usize> {
        self.numbers.get(&Of::Object(object)).copied()
    }

    /// [`Self::between`], subject by subject.
    pub(crate) fn of_each_subject(&self, graph: &ConstraintGraph, from: &Leaf, to: &Leaf) -> impl Iterator<Item = u16> {
        let ends = self.situations[from.state.at()].iter().zip(&self.situations[to.state.at()]);
        let same = |c| graph.value(from, c) == graph.value(to, c);
        self.subjects.iter().zip(ends).map(move |(subject, (&a, &b))| u16::from(subject.steps(a, b, same)))
    }

    /// Changes of grasp from where a transition leads to a leaf, where a crossed one takes the values of that leaf as far
    /// as it has them.
    #[must_use]
    pub fn after(&self, graph: &ConstraintGraph, from: &Leaf, transition: &Transition, to: &Leaf) -> u16 {
        let crossed = transition.kind == TransitionKind::Crossed;
        self.sum(to, transition.to, |c| match graph.value(from, c) {
            Some(kept) => Some(kept) == graph.value(to, c),
            None => crossed,
        })
    }

    /// What [`Self::after`] says of many transitions that leave the first leaf's state. A transition changes few subjects; only
    /// these are measured again.
    #[must_use]
    pub fn after_each<'t>(
        &self,
        graph: &ConstraintGraph,
        from: &Leaf,
        to: &Leaf,
        transitions: impl IntoIterator<Item = &'t Transition>,
    ) -> Vec<u16> {
        let values = |leaf: &Leaf| {
            let mut values = vec![None; graph.constraints.len()];
            let known = graph.state(leaf.state).foliation.iter().zip(&leaf.parameters);
            known.for_each(|(c, &parameter)| values[c.at()] = Some(parameter));
            values
        };
        let (here, there) = (values(from), values(to));
        let goals = &self.situations[to.state.at()];
        let steps = |subject: usize, situation: usize, crossed: bool| {
            let same = |c: ConstraintId| here[c.at()].map_or(crossed, |kept| Some(kept) == there[c.at()]);
            u16::from(self.subjects[subject].steps(situation, goals[subject], same))
        };
        let situations = &self.situations[from.state.at()];
        let now: Vec<u16> = situations.iter().enumerate().map(|(subject, &at)| steps(subject, at, false)).collect();
        let sum: u16 = now.iter().sum();
        let after = |transition: &Transition| {
            let crossed = transition.kind == TransitionKind::Crossed;
            let next = &self.situations[transition.to.at()];
            let changed = (0..now.len()).filter(|&subject| next[subject] != situations[subject]);
            changed.fold(sum, |sum, subject| sum - now[subject] + steps(subject, next[subject], crossed))
        };
        transitions.into_iter().map(after).collect()
    }

    /// What `between` says of all leaves of one state and all of another.
    #[must_use]
    pub(crate) fn between_states(&self, graph: &ConstraintGraph, from: StateId, to: StateId) -> LeafDistanceTable {
        let mut pair = LeafDistanceTable::default();
        let positions = |state: StateId| {
            let mut positions = vec![u16::MAX; self.subject_of.len()];
            (0u16..).zip(&graph.state(state).foliation).for_each(|(row, c)| positions[c.at()] = row);
            positions
        };
        let (rows_from, rows_to) = (positions(from), positions(to));
        let ends = self.situations[from.at()].iter().zip(&self.situations[to.at()]);
        for (subject, (&a, &b)) in self.subjects.iter().zip(ends) {
            let at = a * subject.situations.len() + b;
            let least = u16::from(subject.changes[at]);
            let shared = subject.situations[a].foliating.iter().filter(|c| subject.situations[b].foliating.contains(c));
            let mut rows: Vec<Row> = shared
                .filter_map(|&c| {
                    let known = subject.through_lack.binary_search_by_key(&c, |&(c, _)| c).ok()?;
                    let extra =
                        u16::from(subject.through_lack[known].1.changes(&subject.next, a, b)).saturating_sub(least);
                    let (from, to) = (rows_from[c.at()], rows_to[c.at()]);
                    (extra > 0).then_some(Row { from, to, extra })
                })
                .collect();
            pair.least += least;
            match rows.pop() {
                Some(row) if rows.is_empty() => pair.alone.push(row),
                Some(row) => {
                    rows.push(row);
                    pair.together.push(rows);
                }
                None => {}
            }
        }
        pair
    }

    /// Sums over the subjects; `same` says whether a constraint that holds at both ends has the same value at both.
    fn sum(&self, to: &Leaf, from: StateId, same: impl Fn(ConstraintId) -> bool) -> u16 {
        let ends = self.situations[from.at()].iter().zip(&self.situations[to.state.at()]);
        let steps = self.subjects.iter().zip(ends).map(|(subject, (&a, &b))| subject.steps(a, b, &same));
        steps.map(u16::from).sum()
    }
}

impl Of {
    /// What a constraint is about; none for what follows from what is grasped: fingers, constraints of held objects.
    fn constraint(graph: &ConstraintGraph, kind: ConstraintKind) -> Option<Self> {
        match kind {
            ConstraintKind::Grasp { handle, .. } | ConstraintKind::Pregrasp { handle, .. } => {
                let object = graph.objects.iter().position(|o| o.handles.contains(&handle));
                Some(Self::Object(object.map_or(u32::MAX, |o| o as u32)))
            }
            ConstraintKind::Placement { object, .. }
            | ConstraintKind::Preplacement { object, .. }
            | ConstraintKind::Rest { object } => Some(Self::Object(object)),
            ConstraintKind::JointRest { joint } => Some(Self::Joint(joint)),
            ConstraintKind::Finger { .. }
            | ConstraintKind::Approach { .. }
            | ConstraintKind::Lift { .. }
            | ConstraintKind::WhileHeld { .. } => None,
            ConstraintKind::Given { .. } => Some(Self::Stance),
        }
    }
}

impl Subject {
    fn number(&mut self, graph: &ConstraintGraph, constraints: Vec<ConstraintId>) -> usize {
        if let Some(known) = self.situations.iter().position(|s| s.constraints == constraints) {
            return known;
        }
        let foliating = constraints.iter().copied().filter(|&c| graph.constraint(c).foliates).collect();
        self.situations.push(Situation { constraints, foliating });
        self.next.push(Vec::new());
        self.situations.len() - 1
    }

    /// Hears that a transition leads from one situation to another; true where that is news.
    fn lead(&mut self, from: usize, to: usize) -> bool {
        let is_news = from != to && !self.next[from].contains(&to);
        if is_news {
            self.next[from].push(to);
        }
        is_news
    }

    /// Changes from one situation to another. Where both have a constraint with another value, the way leads through a
    /// situation without it: what is held must be let go to be held otherwise.
    fn steps(&self, from: usize, to: usize, same: impl Fn(ConstraintId) -> bool) -> u8 {
        let count = self.situations.len();
        let shared = |c: ConstraintId| {
            let has = |situation: usize| self.situations[situation].foliating.contains(&c);
            has(from) && has(to)
        };
        let wrong = self.through_lack.iter().filter(|&&(c, _)| shared(c) && !same(c));
        wrong.map(|(_, lack)| lack.changes(&self.next, from, to)).fold(self.changes[from * count + to], u8::max)
    }

    /// Shortest ways between all situations.
    fn measure(&mut self) {
        let count = self.situations.len();
        self.changes = (0..count).flat_map(|from| ways(&self.next, from)).collect();
        let mut foliating: Vec<ConstraintId> = self.situations.iter().flat_map(|s| s.foliating.clone()).collect();
        foliating.sort_unstable();
        foliating.dedup();
        self.through_lack = foliating.into_iter().map(|c| (c, Lack::of(&self.situations, c))).collect();
    }
}

impl Lack {
    fn of(situations: &[Situation], constraint: ConstraintId) -> Self {
        let lacks = situations.iter().map(|s| !s.foliating.contains(&constraint)).collect();
        Self { lacks, rows: vec![OnceLock::new(); situations.len()] }
    }

    /// Changes from one situation to another, through one that lacks the constraint.
    fn changes(&self, next: &[Vec<usize>], from: usize, to: usize) -> u8 {
        self.rows[from].get_or_init(|| self.ways(next, from))[to]
    }

    /// Breadth first over two copies of the graph: the first before a situation without the constraint was passed, the second from there on.
    fn ways(&self, next: &[Vec<usize>], from: usize) -> Vec<u8> {
        let count = next.len();
        let place = |s: usize, has_passed: bool| if has_passed || self.lacks[s] { count + s } else { s };
        let mut steps = vec![FAR; 2 * count];
        let mut front = vec![place(from, false)];
        steps[front[0]] = 0;
        while let Some(&first) = front.first() {
            let ahead = steps[first] + 1;
            let mut reached = Vec::new();
            for &at in &front {
                for to in next[at % count].iter().map(|&to| place(to, at >= count)) {
                    if steps[to] > ahead {
                        steps[to] = ahead;
                        reached.push(to);
                    }
                }
            }
            front = if ahead < FAR { reached } else { Vec::new() };
        }
        steps.split_off(count)
    }
}

/// Breadth first: the number of changes to every situation.
fn ways(next: &[Vec<usize>], from: usize) -> Vec<u8> {
    let mut steps = vec![FAR; next.len()];
    let mut front = vec![from];
    steps[from] = 0;
    while let Some(&first) = front.first() {
        let ahead = steps[first] + 1;
        let mut reached = Vec::new();
        for &to in front.iter().flat_map(|&s| &next[s]) {
            if steps[to] > ahead {
                steps[to] = ahead;
                reached.push(to);
            }
        }
        front = if ahead < FAR { reached } else { Vec::new() };
    }
    steps
}
