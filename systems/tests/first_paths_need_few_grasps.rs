//! What `sequence` does once it has found a first path: stretches with needless grasps are planned again, in counted work.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::outcome::SearchOutcome;
use foliate_components::path::{Attachment, ManipulationPath};
use foliate_components::problem::Problem;
use foliate_components::samples::{boxes_on_a_table, swap_two_boxes};
use foliate_schedulers::sequence::Sequence;
use foliate_systems::search::Search;

/// Three boxes: the second starts where the third shall be.
fn three_boxes() -> Problem {
    boxes_on_a_table(&[(0.6, 0.2), (0.6, 0.0), (0.6, -0.2)], &[(0.7, 0.3), (0.75, 0.15), (0.6, 0.0)]).unwrap()
}

fn solve(problem: Problem, seed: u64, share: f64, threads: usize) -> Search {
    let settings = seeded(seed).with(|s| s.regrasp_share = share);
    let (outcome, search) = search(&model(problem), &Sequence, settings, threads);
    assert_eq!(outcome, SearchOutcome::Solved);
    search
}

/// How often anything is taken hold of.
fn grasps(path: &ManipulationPath) -> usize {
    let held = |at: usize| {
        let attachments = path.segments[at].attachments.iter();
        attachments.filter(|held| matches!(held, Attachment::Grasp { .. })).collect::<Vec<_>>()
    };
    let taken = |at: usize| held(at).into_iter().filter(|grasp| at == 0 || !held(at - 1).contains(grasp)).count();
    (0..path.segments.len()).map(taken).sum()
}

#[test]
fn a_path_keeps_no_grasp_that_another_search_can_do_without() {
    let mut saved = 0;
    for seed in 1..=600 {
        let [found, kept] = [0.0, 0.5].map(|share| solve(three_boxes(), seed, share, 1));
        let (before, after) = (grasps(&found.path().unwrap()), grasps(&kept.path().unwrap()));
        assert!((3..=before).contains(&after), "seed {seed}: {before} grasps, then {after}");
        let (few, more) = (found.counter().step, kept.counter().step);
        // No more than it says, but for two steps at least.
        assert!(more <= few + (few / 2).max(2), "seed {seed}: {few} steps, then {more}");
        assert!(before > 3 || more == few, "seed {seed}: nothing to save, and {} steps more", more - few);
        saved += before - after;
        let path = kept.path().unwrap();
        assert!(path.certificate.min_clearance.is_some_and(|c| c > 0.0));
        assert!(path.certificate.max_residual <= path.certificate.path_tolerance);
        assert!(kept.roadmap().caches_are_true());
    }
    assert!(saved > 0, "no seed had a grasp to save, so this shows nothing");
}

#[test]
fn boxes_that_change_places_have_to_be_put_aside() {
    for seed in 1..=4 {
        let [found, kept] = [0.0, 0.5].map(|share| solve(swap_two_boxes().unwrap(), seed, share, 1));
        if grasps(&found.path().unwrap()) == 3 {
            assert_eq!(found.counter(), kept.counter(), "seed {seed}");
        }
    }
}

#[test]
fn the_answer_does_not_depend_on_threads() {
    for seed in 1..=4 {
        let [one, three] = [1, 3].map(|threads| solve(three_boxes(), seed, 0.5, threads));
        assert_eq!(one.path().unwrap(), three.path().unwrap(), "seed {seed}");
        assert_eq!(one.counter(), three.counter(), "seed {seed}");
    }
}
