//! States and transitions in plain words.
//!
//! Names of transitions are those of HPP (`robot/hand > box/top | f`). Files and JSON keep them; text shows what they mean.

use foliate_components::graph::{State, Transition, TransitionKind};
use foliate_components::robot::{GripperIndex, HandleIndex, Robot};

/// Who holds what in a state: `robot/hand holds box/top`, with the name of the problem's own state in front, where it is one.
#[must_use]
pub fn situation(state: &State, robot: &Robot, written: Option<&str>) -> String {
    let hold = |&(gripper, handle): &(GripperIndex, HandleIndex)| {
        format!("{} holds {}", robot.grippers[gripper.at()].name, robot.handles[handle.at()].name)
    };
    let holds: Vec<String> = state.grasps.iter().map(hold).collect();
    let held = if holds.is_empty() { "nothing is held".to_owned() } else { holds.join(", ") };
    written.map_or_else(|| held.clone(), |name| format!("{name}: {held}"))
}

/// What a transition does: `robot/hand grasps box/top`.
#[must_use]
pub fn action(transition: &Transition) -> String {
    if transition.kind == TransitionKind::Loop {
        return "stays in its state".into();
    }
    let name = transition.name.split_once(" | ").map_or(transition.name.as_str(), |(name, _)| name);
    let action = match (name.split_once(" > "), name.split_once(" < ")) {
        (Some((gripper, handle)), _) => format!("{gripper} grasps {handle}"),
        (None, Some((gripper, handle))) => format!("{gripper} releases {handle}"),
        (None, None) => name.to_owned(),
    };
    match transition.kind {
        TransitionKind::Crossed => action + ", onto a leaf of another tree",
        TransitionKind::Loop | TransitionKind::Regular => action,
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
}
