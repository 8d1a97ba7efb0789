//! Promise: margins are kept between all that does not touch: boxes that rest on a plane may only be as near to the table as they
//! are where the problem says that the plane is the table's top.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::Planner;
use foliate::components::outcome::SearchOutcome;
use foliate::components::path::Attachment;
use foliate::components::problem::{Margin, Problem};
use foliate::components::robot::{LinkIndex, PartKind};
use foliate::components::sample_problems::swap_with_crossed_foliations;

/// Boxes that stand 1 mm above a table and keep 20 mm from it; the table's link.
fn boxes_near_a_table() -> (Problem, LinkIndex) {
    let mut problem = swap_with_crossed_foliations().unwrap();
    let robot = &problem.robot;
    let table = robot.parts.iter().find(|part| part.kind == PartKind::Environment).unwrap().root_link;
    for object in &problem.graph.objects {
        let second = robot.parts[object.part.0 as usize].root_link;
        problem.margins.push(Margin { first: table, second, distance: 0.02 });
    }
    (problem, table)
}

#[test]
fn what_rests_on_a_plane_touches_only_what_the_plane_is_the_top_of() {
    let (problem, table) = boxes_near_a_table();
    let outcome = Planner::new(problem.clone()).unwrap().solve().outcome;
    assert!(matches!(&outcome, SearchOutcome::InfeasibleStart(why) if why.contains("table")), "{outcome:?}");

    let mut named = problem;
    named.graph.objects.iter_mut().for_each(|object| object.plane.as_mut().unwrap().on = Some(table));
    let solution = Planner::new(named).unwrap().solve();
    assert_eq!(solution.outcome, SearchOutcome::Solved);
    let path = solution.path.unwrap();
    let rests = |on: Option<LinkIndex>| {
        let mut all = path.segments.iter().flat_map(|segment| &segment.attachments);
        all.any(|attachment| matches!(attachment, Attachment::Rest { on: there, .. } if *there == on))
    };
    assert!(rests(Some(table)) && !rests(None));
}
