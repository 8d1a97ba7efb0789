//! Promise: margins are kept between all that does not touch. Boxes that rest on a plane may only be as near to the table as they
//! are where the problem says that the plane is the table's top; a hand comes near a box only to grasp it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::NoSolutionReason;
use foliate::Planner;
use foliate::components::Pose;
use foliate::components::infeasibility::Infeasibility;
use foliate::components::outcome::SearchOutcome;
use foliate::components::path::Attachment;
use foliate::components::problem::{Margin, Problem};
use foliate::components::roadmap::NodeId;
use foliate::components::robot::{LinkIndex, PartKind};
use foliate::components::samples::swap_with_crossed_foliations;
use foliate::kernels::collision::CollisionScratch;

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
    let reason = Planner::new(problem.clone()).unwrap().solve().expect_err("a refusal").reason;
    let NoSolutionReason::InfeasibleStart(Infeasibility::Collision(pairs)) = &reason else { panic!("{reason:?}") };
    assert!(pairs.iter().any(|pair| pair.to_string().contains("table")), "{reason:?}");

    let mut named = problem;
    named.graph.objects.iter_mut().for_each(|object| object.plane.as_mut().unwrap().on = Some(table));
    let path = Planner::new(named).unwrap().solve().unwrap().path;
    let rests = |on: Option<LinkIndex>| {
        let mut all = path.segments.iter().flat_map(|segment| &segment.attachments);
        all.any(|attachment| matches!(attachment, Attachment::Rest { on: there, .. } if *there == on))
    };
    assert!(rests(Some(table)) && !rests(None));
}

#[test]
fn no_search_goes_on_from_beside_what_was_not_grasped() {
    let mut problem = swap_with_crossed_foliations().unwrap();
    let robot = &problem.robot;
    let arm = robot.parts.iter().find(|part| part.kind == PartKind::Robot).unwrap();
    for object in &problem.graph.objects {
        let second = robot.parts[object.part.0 as usize].root_link;
        let keep = |first: usize| Margin { first: LinkIndex(first as u32), second, distance: 0.06 };
        problem.margins.extend(arm.links.clone().map(keep));
    }
    let planner = Planner::new(problem).unwrap().seed(3);
    let model = planner.model().clone();
    let mut search = planner.search();
    assert_eq!(search.run(), SearchOutcome::Solved);
    let (roadmap, mut scratch) = (search.roadmap(), CollisionScratch::new());
    let mut bodies = vec![Pose::identity(); model.kinematics.bodies()];
    for index in 0..roadmap.nodes().len() {
        let node = NodeId(index as u32);
        model.kinematics.forward(roadmap.configuration(node), &mut bodies);
        let near = model.first_collision(roadmap.node(node).state, &bodies, 0.0, &mut scratch);
        assert!(near.is_none(), "node {index}: {}", near.map(|c| model.pair_name(c.pair)).unwrap_or_default());
    }
}
