//! How many grasps lie between two leaves.
//!
//! What a leaf says falls into *subjects*: each object with all that holds or carries it, each joint at rest, and the
//! stance of the robot itself. The constraint graph, looked at through one subject, is a small graph of its own (on the
//! table, in the left hand, in both, …). The distance between two leaves is the sum over the subjects of the shortest ways
//! in these graphs: an estimate that forgets that hands are needed twice and that things are in each other's way, as the
//! relaxed plans of task planners do. It costs nanoseconds and tells which of a thousand leaves are worth extending.

use foliate_components::graph::{ConstraintGraph, ConstraintId, ConstraintKind, StateId, Transition, TransitionKind};
use foliate_components::leaf::{Leaf, ParameterId};
use std::collections::HashMap;

/// Farther than this is as far.
const FAR: u8 = 16;

/// Distances between the leaves of one graph.
#[derive(Clone, Debug, Default)]
pub struct GraspDistance {
    subjects: Vec<Subject>,
    /// By state and subject: what the state says of it, as a number of [`Subject::situations`].
    situations: Vec<Vec<usize>>,
}

/// The graph as one subject sees it.
#[derive(Clone, Debug, Default)]
struct Subject {
    situations: Vec<Situation>,
    /// Changes from one situation to another, row by row.
    changes: Vec<u8>,
    /// For each constraint with values: changes from one situation to another through one that lacks it, row by row.
    through_lack: Vec<(ConstraintId, Vec<u8>)>,
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
        let subject_of = subjects(graph);
        let count = subject_of.iter().max().map_or(0, |most| most + 1);
        distances.subjects.resize_with(count, Subject::default);
        for state in &graph.states {
            let situations = (0..count).map(|subject| {
                let constraints: Vec<_> =
                    state.manifold.iter().copied().filter(|c| subject_of[c.at()] == subject).collect();
                distances.subjects[subject].number(graph, constraints)
            });
            let situations = situations.collect();
            distances.situations.push(situations);
        }
        for (number, subject) in distances.subjects.iter_mut().enumerate() {
            let ends = graph
                .transitions
                .iter()
                .map(|t| (distances.situations[t.from.at()][number], distances.situations[t.to.at()][number]));
            subject.measure(ends);
        }
        distances
    }

    /// How many states it knows.
    #[must_use]
    pub fn states(&self) -> usize {
        self.situations.len()
    }

    /// Changes of grasp from one leaf to another.
    #[must_use]
    pub fn between(&self, graph: &ConstraintGraph, from: &Leaf, to: &Leaf) -> u16 {
        self.sum(to, from.state, |c| value(graph, from, c) == value(graph, to, c))
    }

    /// Changes of grasp from where a transition leads to a leaf, where a crossed one takes the values of that leaf as far
    /// as it has them.
    #[must_use]
    pub fn after(&self, graph: &ConstraintGraph, from: &Leaf, transition: &Transition, to: &Leaf) -> u16 {
        let crossed = transition.kind == TransitionKind::Crossed;
        self.sum(to, transition.to, |c| match value(graph, from, c) {
            Some(kept) => Some(kept) == value(graph, to, c),
            None => crossed,
        })
    }

    /// Sums over the subjects; `same` says whether a constraint that holds at both ends has the same value at both.
    fn sum(&self, to: &Leaf, from: StateId, same: impl Fn(ConstraintId) -> bool) -> u16 {
        let ends = self.situations[from.at()].iter().zip(&self.situations[to.state.at()]);
        let steps = self.subjects.iter().zip(ends).map(|(subject, (&a, &b))| subject.steps(a, b, &same));
        steps.map(u16::from).sum()
    }
}

/// The value that a leaf gives a constraint.
fn value(graph: &ConstraintGraph, leaf: &Leaf, constraint: ConstraintId) -> Option<ParameterId> {
    let foliation = &graph.state(leaf.state).foliation;
    foliation.iter().position(|&c| c == constraint).map(|i| leaf.parameters[i])
}

/// By constraint: the number of its subject.
fn subjects(graph: &ConstraintGraph) -> Vec<usize> {
    #[derive(PartialEq, Eq, Hash)]
    enum Of {
        Object(u32),
        Joint(u32),
        Stance,
    }
    let mut numbers: HashMap<Of, usize> = HashMap::new();
    let constraints = graph.constraints.iter().map(|constraint| match constraint.kind {
        ConstraintKind::Grasp { handle, .. } | ConstraintKind::Pregrasp { handle, .. } => {
            let object = graph.objects.iter().position(|o| o.handles.contains(&handle));
            Of::Object(object.map_or(u32::MAX, |o| o as u32))
        }
        ConstraintKind::Placement { object, .. }
        | ConstraintKind::Preplacement { object, .. }
        | ConstraintKind::Rest { object } => Of::Object(object),
        ConstraintKind::JointRest { joint } => Of::Joint(joint),
        ConstraintKind::Given { .. } => Of::Stance,
    });
    let mut next = 0;
    let mut number = |of| {
        *numbers.entry(of).or_insert_with(|| {
            next += 1;
            next - 1
        })
    };
    constraints.map(&mut number).collect()
}

impl Subject {
    fn number(&mut self, graph: &ConstraintGraph, constraints: Vec<ConstraintId>) -> usize {
        if let Some(known) = self.situations.iter().position(|s| s.constraints == constraints) {
            return known;
        }
        let foliating = constraints.iter().copied().filter(|&c| graph.constraint(c).foliates).collect();
        self.situations.push(Situation { constraints, foliating });
        self.situations.len() - 1
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
        let at = from * count + to;
        wrong.map(|(_, changes)| changes[at]).fold(self.changes[at], u8::max)
    }

    /// Shortest ways between all situations.
    fn measure(&mut self, ends: impl Iterator<Item = (usize, usize)>) {
        let count = self.situations.len();
        let mut next = vec![Vec::new(); count];
        for (from, to) in ends.filter(|(from, to)| from != to) {
            if !next[from].contains(&to) {
                next[from].push(to);
            }
        }
        self.changes = (0..count).flat_map(|from| ways(&next, from)).collect();
        let mut foliating: Vec<ConstraintId> = self.situations.iter().flat_map(|s| s.foliating.clone()).collect();
        foliating.sort_unstable();
        foliating.dedup();
        self.through_lack = foliating.into_iter().map(|c| (c, self.ways_through_lack(c))).collect();
    }

    fn ways_through_lack(&self, constraint: ConstraintId) -> Vec<u8> {
        let count = self.situations.len();
        let lacks = |&s: &usize| !self.situations[s].foliating.contains(&constraint);
        let ways = |at: usize| {
            let (from, to) = (at / count, at % count);
            let through = |s: usize| self.changes[from * count + s] + self.changes[s * count + to];
            (0..count).filter(lacks).map(through).min().unwrap_or(FAR).min(FAR)
        };
        (0..count * count).map(ways).collect()
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
