//! The story of a portfolio: members search one problem alternately, exchange what they have reached, and one answers.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use bevy_ecs::prelude::*;
use common::{Unconnected, model, search, seeded, stop_within};
use foliate_components::outcome::SearchOutcome;
use foliate_components::samples::{boxes_on_a_table, eight_arms_and_ten_boxes, swap_two_boxes};
use foliate_schedulers::portfolio::{Member, MemberCounts};
use foliate_schedulers::{Scheduler, mrrt::Mrrt, portfolio::Portfolio};
use foliate_systems::events::EventSink;
use foliate_systems::schedule::{SearchSet, empty_schedule};
use foliate_systems::search::Search;
use foliate_systems::settings::Selection;
use foliate_systems::step::connection::connect::{certify_connections, propose_connections};
use foliate_systems::step::{commit, conclusion};

/// Three searches from the first round on, so that every round has something to tell.
fn trio() -> Portfolio {
    let leaf_first = Member::new(Mrrt).tuned(|settings| settings.selection = Selection::LeafFirst);
    Portfolio { members: vec![Member::new(Mrrt), leaf_first, Member::new(Mrrt)], quantum: 32 }
}

fn counts(search: &Search) -> MemberCounts {
    search.world().resource::<MemberCounts>().clone()
}

#[test]
fn a_portfolio_of_one_searches_as_that_one() {
    let model = model(swap_two_boxes().unwrap());
    let alone = search(&model, &Mrrt, seeded(4), 1).1;
    let portfolio = Portfolio { members: vec![Member::new(Mrrt)], quantum: 32 };
    let (outcome, one) = search(&model, &portfolio, seeded(4), 1);
    assert_eq!(outcome, SearchOutcome::Solved);
    assert_eq!(one.roadmap().fingerprint(), alone.roadmap().fingerprint());
    assert_eq!(one.path(), alone.path());
    assert_eq!(one.counter(), alone.counter());
}

#[test]
fn the_answer_does_not_depend_on_threads() {
    let model = model(swap_two_boxes().unwrap());
    for seed in 1..=4 {
        let (outcome, one) = search(&model, &trio(), seeded(seed), 1);
        assert_eq!(outcome, SearchOutcome::Solved);
        for threads in [2, 8] {
            let (other, many) = search(&model, &trio(), seeded(seed), threads);
            assert_eq!(outcome, other);
            assert_eq!(one.roadmap().fingerprint(), many.roadmap().fingerprint(), "{threads} threads, seed {seed}");
            assert_eq!(one.path(), many.path());
            assert_eq!(counts(&one).0, counts(&many).0, "{threads} threads, seed {seed}");
        }
    }
}

/// Extends nothing: whatever it has, others have told it.
struct Listener;

impl Scheduler for Listener {
    fn name(&self) -> &'static str {
        "listener"
    }

    fn schedule(&self, _world: &mut World) -> Schedule {
        let mut schedule = empty_schedule();
        schedule.add_systems((
            (propose_connections, certify_connections, commit::commit_connections).chain().in_set(SearchSet::Connect),
            conclusion::conclude.in_set(SearchSet::Conclude),
        ));
        schedule
    }
}

#[test]
fn what_one_member_reaches_the_others_can_use() {
    let problem = swap_two_boxes().unwrap();
    let model = model(problem.clone());
    let members = vec![Member::new(Listener), Member::new(Unconnected), Member::new(Unconnected)];
    let portfolio = Portfolio { members, quantum: 32 };
    for seed in 1..=3 {
        let (outcome, search) = search(&model, &portfolio, seeded(seed), 1);
        assert_eq!(outcome, SearchOutcome::Solved);
        let answers: Vec<_> = counts(&search).0.iter().map(|world| (world.scheduler, world.answers)).collect();
        assert_eq!(answers, [("listener", true), ("unconnected", false), ("unconnected", false)]);
        assert_eq!(search.counter().candidates, 0);
        let path = search.path().unwrap();
        assert!(path.segments.len() > 4 && path.segments[0].knots[0] == problem.start);
        assert!(path.certificate.min_clearance.is_some_and(|c| c > 0.0));
    }
}

#[test]
fn a_member_that_enters_late_gets_what_is_known() {
    // Out of reach: only a limit ends it.
    let model = model(boxes_on_a_table(&[(0.6, 0.1)], &[(1.25, 0.0)]).unwrap());
    let portfolio =
        Portfolio { members: vec![Member::new(Mrrt).entering(0), Member::new(Listener).entering(3)], quantum: 64 };
    let mut search = Search::new(&model, &portfolio, seeded(1), stop_within(60), EventSink::default());
    for _ in 0..3 {
        assert_eq!(search.step(), None);
    }
    let portfolio_members = |search: &Search| {
        let portfolio_members = search.world().resource::<foliate_schedulers::portfolio::PortfolioMembers>();
        portfolio_members.searches().map(|search| search.roadmap().nodes().len()).collect::<Vec<_>>()
    };
    assert_eq!(portfolio_members(&search).len(), 1);
    search.step();
    let nodes = portfolio_members(&search);
    assert!(nodes[1] > 10 && nodes[1] <= nodes[0], "{nodes:?}");
}

#[test]
fn budgets_hold_for_all_members_together() {
    let model = model(boxes_on_a_table(&[(0.6, 0.1)], &[(1.25, 0.0)]).unwrap());
    let settings = seeded(1).with(|s| s.max_nodes = 300);
    let mut limited = Search::new(&model, &trio(), settings, stop_within(60), EventSink::default());
    let mut most = 0;
    while limited.step().is_none() {
        let portfolio_members = limited.world().resource::<foliate_schedulers::portfolio::PortfolioMembers>();
        most = portfolio_members.searches().map(|search| search.roadmap().nodes().len()).sum();
    }
    assert_eq!(limited.ending(), Some(&SearchOutcome::MemoryLimit));
    assert!((100..300).contains(&most), "{most}");

    let (outcome, stepped) = search(&model, &trio(), seeded(1).with(|s| s.max_steps = 9), 2);
    assert_eq!(outcome, SearchOutcome::StepLimit);
    // Three members, at most two steps each in a round.
    let steps: u64 = counts(&stepped).0.iter().map(|world| world.counter.step).sum();
    assert!((9..15).contains(&steps), "{steps}");
}

#[test]
fn where_graphs_are_lazy_members_exchange_nothing() {
    let model = model(eight_arms_and_ten_boxes().unwrap());
    assert!(model.graph.lazy);
    let settings = seeded(1).with(|s| s.max_steps = 12);
    let (outcome, one) = search(&model, &trio(), settings.clone(), 1);
    let (other, two) = search(&model, &trio(), settings, 2);
    assert_eq!((outcome, one.roadmap().fingerprint()), (other, two.roadmap().fingerprint()));
    assert!(one.roadmap().nodes().len() > 1);
}
