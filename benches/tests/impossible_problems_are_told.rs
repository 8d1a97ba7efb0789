//! Generated problems without a solution are recognised, by their cause; those that have a solution are never called impossible.
//! `cargo run --profile dist -p foliate_benches --bin feasibility` does the same with thousands.

#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

use foliate_benches::feasibility::impossible::{self, Cause};
use foliate_benches::feasibility::solvable::{self, Task};
use foliate_benches::feasibility::verdict::{Verdict, doubts, told};
use std::time::Duration;

/// Verdicts come after counted work; this only ends what is never told. Tests are compiled for speed in part alone.
const LIMIT: Duration = Duration::from_secs(30);

/// Four problems of a cause: each is told with these words, by proof or not as `is_proof` says, where it says so.
fn are_told(cause: Cause, is_proof: Option<bool>, words: &[&str]) {
    for seed in 1..=4 {
        let (was_proved, why) = match told(impossible::scene(cause, seed).problem(), seed, LIMIT).verdict {
            Verdict::Proved(why) => (true, why),
            Verdict::Likely(why) => (false, why),
            other => panic!("{} {seed}: {other:?}", cause.name()),
        };
        assert!(is_proof.is_none_or(|is_proof| is_proof == was_proved), "{} {seed}: {why}", cause.name());
        assert!(words.iter().any(|words| why.contains(words)), "{} {seed}: {why}", cause.name());
    }
}

#[test]
fn boxes_and_tables_beyond_the_arm_are_out_of_reach() {
    let words = ["out of reach where it starts", "no hand can hold it where it starts"];
    are_told(Cause::StartTooFar, None, &words);
    let words = ["out of reach where the goal has it", "no hand can hold it where the goal has it"];
    are_told(Cause::GoalTooFar, None, &words);
    are_told(Cause::SurfaceTooFar, None, &words);
}

#[test]
fn hands_that_cannot_hold_are_proved() {
    are_told(Cause::TooWide, Some(true), &["however far the hand opens"]);
    are_told(Cause::NoGripper, Some(true), &["nothing can hold it"]);
    are_told(Cause::NoHandle, Some(true), &["no gripper may hold it"]);
    are_told(Cause::HeldForEver, Some(true), &["no gripper may hold it in any state that can be reached"]);
}

#[test]
fn what_blocks_every_grasp_is_named() {
    are_told(Cause::TooTight, Some(false), &["likely blocked where it starts: wall"]);
    are_told(Cause::WalledIn, Some(false), &["likely blocked where it starts: wall"]);
    are_told(Cause::GoalWalledIn, Some(false), &["likely blocked where the goal has it: wall"]);
}

#[test]
fn goals_in_each_other_are_proved() {
    are_told(Cause::GoalsOverlap, Some(true), &["mm in each other", "mm deep"]);
}

#[test]
fn grasps_that_start_and_goal_do_not_share_are_told() {
    are_told(Cause::NoCommonGrasp, Some(false), &["likely no grasp takes `box0` from start to goal"]);
}

#[test]
fn solvable_problems_are_never_called_impossible() {
    for (task, seed) in Task::ALL.into_iter().flat_map(|task| (1..=4).map(move |seed| (task, seed))) {
        let problem = solvable::scene(task, seed).problem();
        let verdict = told(problem.clone(), seed, LIMIT).verdict;
        assert_eq!(verdict, Verdict::Solved, "{} {seed}", task.name());
        assert_eq!(doubts(problem, seed), Vec::<String>::new(), "{} {seed}", task.name());
    }
}
