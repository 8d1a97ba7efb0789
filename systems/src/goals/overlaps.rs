//! Objects that overlap where a goal has them, whatever the robots do.

use crate::planning_model::model::Model;
use crate::settings::SearchSettings;
use foliate_components::problem::PartialGoal;
use foliate_components::robot::{PartKind, ShapeIndex};

/// Overlapping by less is left to the search: a grasp or placement may ask for it, metres.
const DEEP: f64 = 1e-4;
/// Most pairs that are named.
const MOST: usize = 4;

/// Pairs of objects whose poses a goal gives, or of such an object and what never moves, that are in each other there; in words.
pub(crate) fn overlapping(
    model: &Model,
    settings: &SearchSettings,
    goal: &PartialGoal,
    start: &[f64],
) -> Option<String> {
    let robot = &model.problem.robot;
    let (state, _) = model.graph.states_of_nodes().next()?;
    let mut X_WJ = model.kinematics.poses(start);
    for (part, pose) in &goal.poses {
        X_WJ[robot[*part].root_joint?.at()] = *pose;
    }
    let part_of = |shape: ShapeIndex| robot.links[robot.shapes[shape.at()].link.at()].part;
    // Joints of objects may move with the object.
    let is_fixed = |shape: ShapeIndex| {
        let (part, body) = (part_of(shape), robot.links[robot.shapes[shape.at()].link.at()].joint);
        let is_root = body == robot[part].root_joint;
        let is_given = goal.poses.iter().any(|(given, _)| *given == part) && is_root;
        is_given || robot[part].kind == PartKind::Environment
    };
    let contacts = model.all_collisions(state, &X_WJ, settings.clearance_guard);
    let words = contacts.iter().filter_map(|contact| {
        let (a, b) = model.pair_shapes(contact.pair);
        let depth = model.overlap(contact.pair, &X_WJ).filter(|_| is_fixed(a) && is_fixed(b))?;
        let (first, second) = (&robot[part_of(a)].name, &robot[part_of(b)].name);
        (depth > DEEP).then(|| format!("{first} and {second} are {:.1} mm in each other", depth * 1e3))
    });
    let words: Vec<String> = words.take(MOST).collect();
    (!words.is_empty()).then(|| words.join("; "))
}
