//! States, transitions and what is held, in plain words.
//!
//! Names of transitions are those of HPP (`robot/hand > box/top | f`). Files and JSON keep them; text shows what they mean.

use foliate_components::graph::{
    ConstraintGraph, ConstraintId, ConstraintKind, Opening, Transition, TransitionId, TransitionKind,
};
use foliate_components::robot::Robot;
use std::collections::{HashMap, HashSet};

/// Who holds what in a state, by the whole names: `robot/hand holds box/top, what else its name says`.
#[must_use]
pub fn situation(name: &str) -> String {
    ShortNames::default().state(name).join(", ")
}

/// What a transition does: `robot/hand grasps box/top`.
#[must_use]
pub fn action(transition: &Transition) -> String {
    if transition.kind == TransitionKind::Loop {
        return "stays in its state".into();
    }
    let action = change(&transition.name).unwrap_or_else(|| bare(&transition.name).to_owned());
    match transition.kind {
        TransitionKind::Crossed => action + ", onto a leaf of another tree",
        TransitionKind::Loop | TransitionKind::Regular => action,
    }
}

/// The name without what tells it from others of its kind.
fn bare(name: &str) -> &str {
    name.split_once(" | ").map_or(name, |(name, _)| name)
}

fn change(name: &str) -> Option<String> {
    let name = bare(name);
    match (name.split_once(" > "), name.split_once(" < ")) {
        (Some((gripper, handle)), _) => Some(format!("{gripper} grasps {handle}")),
        (None, Some((gripper, handle))) => Some(format!("{gripper} releases {handle}")),
        (None, None) => None,
    }
}

/// Short names of grippers, and of handles by what they are on, as far as nothing else is called so.
#[derive(Clone, Debug, Default)]
pub struct ShortNames(HashMap<String, String>);

impl ShortNames {
    /// The names of a robot's grippers and of the handles that the states of a graph grasp.
    ///
    /// A gripper loses its part where no other gripper has its own name; a handle that is the only one of its part is called as the part.
    #[must_use]
    pub fn of(robot: &Robot, graph: &ConstraintGraph) -> Self {
        let held = graph.states.iter().flat_map(|state| state.name.split(" : "));
        let held: HashSet<&str> = held.filter_map(|piece| Some(piece.split_once(" grasps ")?.1)).collect();
        let own = |name: &str| name.split_once('/').map_or(name, |(_, own)| own).to_owned();
        let part = |name: &str| name.split('/').next().unwrap_or_default().to_owned();
        let mut grippers: HashMap<String, usize> = HashMap::new();
        robot.grippers.iter().for_each(|gripper| *grippers.entry(own(&gripper.name)).or_default() += 1);
        let mut handles: HashMap<String, usize> = HashMap::new();
        let grasped = || robot.handles.iter().filter(|handle| held.contains(handle.name.as_str()));
        grasped().for_each(|handle| *handles.entry(part(&handle.name)).or_default() += 1);
        let mut short = HashMap::new();
        for gripper in robot.grippers.iter().filter(|gripper| grippers[&own(&gripper.name)] == 1) {
            short.insert(gripper.name.clone(), own(&gripper.name));
        }
        for handle in grasped().filter(|handle| handles[&part(&handle.name)] == 1) {
            short.insert(handle.name.clone(), part(&handle.name));
        }
        Self(short)
    }

    /// The short name of a gripper or a handle.
    #[must_use]
    pub fn of_name<'a>(&'a self, name: &'a str) -> &'a str {
        self.0.get(name).map_or(name, String::as_str)
    }

    /// What a state is, line by line: `left_hand holds box1`.
    #[must_use]
    pub fn state(&self, name: &str) -> Vec<String> {
        name.split(" : ").map(|piece| self.piece(piece)).collect()
    }

    fn piece(&self, piece: &str) -> String {
        match piece.split_once(" grasps ") {
            Some((gripper, handle)) => format!("{} holds {}", self.of_name(gripper), self.of_name(handle)),
            None if piece == "free" => "nothing is held".into(),
            None => piece.to_owned(),
        }
    }

    /// What a transition does, by its name in files: `left_hand grasps box1`, `left_hand releases box1, box1 on lid`.
    #[must_use]
    pub fn transition(&self, name: &str) -> String {
        let plain = bare(name);
        if plain.starts_with("Loop") {
            return "moves within the state".into();
        }
        for (sign, verb) in [(" > ", "grasps"), (" < ", "releases")] {
            if let Some((gripper, rest)) = plain.split_once(sign) {
                let (handle, more) = rest.split_once(", ").map_or((rest, ""), |(handle, more)| (handle, more));
                let more = if more.is_empty() { String::new() } else { format!(", {more}") };
                return format!("{} {verb} {}{more}", self.of_name(gripper), self.of_name(handle));
            }
        }
        plain.to_owned()
    }
}

/// What a transition passes: where its legs end, but for the last.
#[must_use]
pub fn waypoints(graph: &ConstraintGraph, id: TransitionId) -> Vec<String> {
    let legs = &graph.transition(id).legs;
    let what = |constraints: &[ConstraintId]| {
        let kinds: Vec<ConstraintKind> = constraints.iter().map(|&c| graph.constraint(c).kind).collect();
        let word = |kind: &ConstraintKind| match kind {
            ConstraintKind::Pregrasp { .. } => Some((0, "before the grasp".to_owned())),
            ConstraintKind::Preplacement { .. } => Some((1, "over the place".to_owned())),
            ConstraintKind::Grasp { .. } => Some((2, "at the grasp".to_owned())),
            ConstraintKind::Placement { .. } => Some((3, "at the place".to_owned())),
            ConstraintKind::Finger { opening, .. } => Some((4, opening_words(*opening).to_owned())),
            ConstraintKind::Given { .. }
            | ConstraintKind::Approach { .. }
            | ConstraintKind::Lift { .. }
            | ConstraintKind::WhileHeld { .. }
            | ConstraintKind::Rest { .. }
            | ConstraintKind::JointRest { .. } => None,
        };
        let best = kinds.iter().filter_map(word).min();
        let own = || constraints.first().map(|&c| graph.constraint(c).name.clone());
        best.map(|(_, word)| word).or_else(own).unwrap_or_else(|| "waypoint".into())
    };
    let inner = legs.len().saturating_sub(1);
    legs[..inner].iter().map(|leg| what(&leg.target)).collect()
}

fn opening_words(opening: Opening) -> &'static str {
    match opening {
        Opening::Travel => "hand as it travels",
        Opening::Wide | Opening::Ready { .. } => "hand open",
        Opening::Closed { .. } => "hand closed",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::graph::StateId;

    fn transition(name: &str, kind: TransitionKind) -> Transition {
        let (from, to) = (StateId(0), StateId(1));
        Transition { name: name.into(), from, to, kind, weight: 1.0, legs: Vec::new(), adds: Vec::new(), reverse: None }
    }

    #[test]
    fn names_of_transitions_become_plain_words() {
        let cases = [
            ("Loop | 0-1", TransitionKind::Loop, "stays in its state"),
            ("r/hand > box/top | f", TransitionKind::Regular, "r/hand grasps box/top"),
            ("r/hand < box/top, box on tray | 0-1", TransitionKind::Regular, "r/hand releases box/top, box on tray"),
            (
                "r/hand < box/top | 0-1_ls",
                TransitionKind::Crossed,
                "r/hand releases box/top, onto a leaf of another tree",
            ),
            ("step | left", TransitionKind::Regular, "step"),
        ];
        for (name, kind, words) in cases {
            assert_eq!(action(&transition(name, kind)), words);
        }
    }

    #[test]
    fn names_are_short_where_that_is_clear() {
        let names = ShortNames(HashMap::from([
            ("r/hand".to_owned(), "hand".to_owned()),
            ("box/top".to_owned(), "box".to_owned()),
        ]));
        assert_eq!(
            names.state("r/hand grasps box/top : s/hand grasps lid/a"),
            ["hand holds box", "s/hand holds lid/a"]
        );
        assert_eq!(names.state("free"), ["nothing is held"]);
        assert_eq!(situation("r/hand grasps box/top : lid on box"), "r/hand holds box/top, lid on box");
        assert_eq!(names.transition("r/hand < box/top, box on tray | 0-1"), "hand releases box, box on tray");
        assert_eq!(names.transition("r/hand > box/top | f_12"), "hand grasps box");
        assert_eq!(names.transition("Loop | f"), "moves within the state");
    }
}
