//! Which constraints of the problem's own hold in a state.

use foliate_components::graph::ConstraintKind;
use foliate_components::problem::GraphOptions;
use foliate_components::robot::PartIndex;

/// Those of all states and of the problem's own state `written`, then those of the objects that a gripper holds (`is_held`); each once.
pub(super) fn own_constraints(
    options: &GraphOptions,
    written: usize,
    is_held: impl Fn(PartIndex) -> bool,
) -> Vec<ConstraintKind> {
    let own = options.states.get(written).map_or(&[][..], |state| &state.constraints);
    let given = options.everywhere.iter().chain(own).map(|&constraint| ConstraintKind::Given { constraint });
    let mut kinds: Vec<ConstraintKind> = Vec::new();
    for kind in given {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let held = options.while_held.iter().filter(|rule| is_held(rule.object));
    for &constraint in held.flat_map(|rule| &rule.constraints) {
        let kind = ConstraintKind::WhileHeld { constraint };
        if !kinds.contains(&kind) && !kinds.contains(&ConstraintKind::Given { constraint }) {
            kinds.push(kind);
        }
    }
    kinds
}
