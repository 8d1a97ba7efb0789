//! Promise 3: same seed, same binary, same roadmap and path, bit for bit, with any number of threads.
//!
//! The fingerprint covers the containers in their order (nodes, edges, leaves, knots), not only their numbers: order is
//! where scheduling would leak. A budget of steps makes unsolved searches comparable too.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::samples::{
    boxes_on_a_table, hold_a_lid_by_a_magnet, make_a_step, open_a_box_and_move_it, put_a_lid_on_a_box, swap_two_boxes,
};
use foliate_schedulers::shipped;
use foliate_systems::settings::Selection;

#[test]
fn roadmap_and_path_do_not_depend_on_threads() {
    let model = model(swap_two_boxes().unwrap());
    for scheduler in shipped() {
        for seed in 1..=3 {
            let (outcome, one) = search(&model, scheduler.as_ref(), seeded(seed), 1);
            for threads in [2, 3, 8] {
                let (other, many) = search(&model, scheduler.as_ref(), seeded(seed), threads);
                assert_eq!(outcome, other);
                assert_eq!(one.roadmap().fingerprint(), many.roadmap().fingerprint(), "{threads} threads, seed {seed}");
                assert_eq!(one.path(), many.path());
            }
        }
    }
}

#[test]
fn nor_do_they_where_the_graph_is_not_only_grasps() {
    let problems = [make_a_step(), open_a_box_and_move_it(), hold_a_lid_by_a_magnet(), put_a_lid_on_a_box()];
    for problem in problems {
        let model = model(problem.unwrap());
        for scheduler in shipped() {
            let settings = seeded(2).with(|s| s.max_steps = 12);
            let (outcome, one) = search(&model, scheduler.as_ref(), settings.clone(), 1);
            let (other, many) = search(&model, scheduler.as_ref(), settings, 3);
            assert_eq!(outcome, other);
            let (name, problem) = (scheduler.name(), &model.problem.name);
            assert_eq!(one.roadmap().fingerprint(), many.roadmap().fingerprint(), "{name}: {problem}");
            assert_eq!(one.path(), many.path());
        }
    }
}

#[test]
fn unsolved_searches_agree_too_under_every_selection() {
    // A goal on which both boxes would overlap is refused; one out of the arm's reach is not found.
    let model = model(boxes_on_a_table(&[(0.6, 0.1)], &[(1.25, 0.0)]).unwrap());
    for selection in [Selection::Guided, Selection::LeafFirst, Selection::StateFirst, Selection::Nearest] {
        let settings = seeded(5).with(|s| (s.max_steps, s.selection) = (4, selection));
        for scheduler in shipped() {
            let (_, one) = search(&model, scheduler.as_ref(), settings.clone(), 1);
            let (_, two) = search(&model, scheduler.as_ref(), settings.clone(), 2);
            let name = (scheduler.name(), selection);
            assert_eq!(one.roadmap().fingerprint(), two.roadmap().fingerprint(), "{name:?}");
            assert!(one.roadmap().nodes().len() > 10, "{name:?} explored nothing");
        }
    }
}

#[test]
fn different_seeds_give_different_roadmaps() {
    let model = model(swap_two_boxes().unwrap());
    let scheduler = foliate_schedulers::mrrt::Mrrt;
    let (_, one) = search(&model, &scheduler, seeded(1), 1);
    let (_, two) = search(&model, &scheduler, seeded(2), 1);
    assert_ne!(one.roadmap().fingerprint(), two.roadmap().fingerprint());
}
