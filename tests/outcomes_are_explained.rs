//! `docs/outcomes.md` explains the name of every outcome and the words of every rejection.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::components::infeasibility::{Infeasibility, ObjectPlace};
use foliate::components::outcome::{Rejection, SearchOutcome};
use foliate::systems::goals::impossible::hindrance::{Hindrance, OutOfReach, Shortfall};

#[test]
fn every_outcome_and_every_rejection_has_a_row() {
    let page = include_str!("../docs/outcomes.md");
    let outcomes = [
        SearchOutcome::Solved,
        SearchOutcome::Timeout,
        SearchOutcome::StepLimit,
        SearchOutcome::Cancelled,
        SearchOutcome::MemoryLimit,
        SearchOutcome::InfeasibleStart(Infeasibility::NoGoal),
        SearchOutcome::InfeasibleGoal(Infeasibility::NoGoal),
        SearchOutcome::Crashed(String::new()),
    ];
    let rejections = [
        Rejection::NoNode,
        Rejection::NoTransition,
        Rejection::NoLeafToAimAt,
        Rejection::ProjectionFailed(0),
        Rejection::OutOfBounds(0),
        Rejection::WaypointBlocked(0),
        Rejection::SteeringFailed(0),
        Rejection::MotionBlocked(0),
        Rejection::NoProgress,
        Rejection::Stopped,
        Rejection::LeftOut,
    ];
    let words = outcomes.iter().map(SearchOutcome::name).chain(rejections.iter().map(|reason| reason.describe()));
    for word in words {
        assert!(page.contains(&format!("\n| `{word}` |")), "docs/outcomes.md has no row for `{word}`");
    }
}

#[test]
fn the_words_of_infeasible_goals_are_those_of_the_page() {
    let page = include_str!("../docs/outcomes.md");
    for (has_grippers, words) in [(false, "nothing can hold it"), (true, "no gripper may hold it")] {
        let why = Infeasibility::ObjectNeverMoves { object: "box".into(), distance: 0.2, angle: 0.0, has_grippers };
        assert!(why.to_string().contains(words), "{why}");
        assert!(page.contains(&format!("| `{words}` |")), "{words}");
    }
}

#[test]
fn the_words_of_proofs_and_of_what_is_likely_are_those_of_the_page() {
    let page = include_str!("../docs/outcomes.md");
    let apart = Infeasibility::GoalStateApart { start: "free".into(), goal: "hand grasps box".into() };
    let no_grasp = |place| Infeasibility::NoGraspPossible { object: "box".into(), place, grasps: Vec::new() };
    let starts = no_grasp(ObjectPlace::Start).to_string();
    let ends = no_grasp(ObjectPlace::Goal).to_string();
    let (gripper, handle, at_limits) = ("hand".to_owned(), "box/top".to_owned(), Vec::new());
    let shortfall = Shortfall::Distance(0.1);
    let far = Hindrance::OutOfReach(OutOfReach { gripper, handle, shortfall, at_limits }).sentence("box", "there");
    let (object, gripper) = ("box".to_owned(), "hand".to_owned());
    let held = Infeasibility::NeverPutDown { object, gripper, too_small: vec!["shelf/top".into()] };
    for (told, words) in [
        (apart.to_string(), "no transitions lead"),
        (held.to_string(), "it can be put down nowhere"),
        (starts, "no hand can hold it where it starts"),
        (ends, "no hand can hold it where the goal has it"),
        (far, "likely out of reach"),
    ] {
        assert!(told.contains(words), "{told}");
        assert!(page.contains(&format!("`{words}`")), "{words}");
    }
}
