//! The contract of every scheduler: it solves the small problems, its systems are ordered where that matters, it stops
//! when told to, it answers infeasible problems without searching, and its answers are paths from start to goal.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

use bevy_ecs::prelude::{Commands, Component, Entity, IntoScheduleConfigs, Query, Schedule, With, Without, World};
use bevy_ecs::schedule::{LogLevel, ScheduleBuildError, ScheduleBuildSettings, ScheduleBuildWarning};
use common::{model, search, seeded, stop_within};
use foliate_components::candidate::Candidate;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::outcome::SearchOutcome;
use foliate_components::path::ManipulationPath;
use foliate_components::problem::{Goal, Problem};
use foliate_components::roadmap::{RoadmapLeaf, RoadmapNode, TreeId};
use foliate_components::samples::{boxes_on_a_table, move_one_box, swap_two_boxes, swap_with_crossed_foliations};
use foliate_schedulers::{Scheduler, mrrt, sequence, shipped};
use foliate_systems::events::{EventSink, SearchEvent, StopSignal};
use foliate_systems::exploration::edges::UnvalidatedByEnd;
use foliate_systems::exploration::reached_leaves::ReachedLeaves;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::schedule::{SearchSet, StepSystems};
use foliate_systems::search::Search;
use std::marker::PhantomData;

fn small_problems() -> Vec<Problem> {
    vec![
        move_one_box().unwrap(),
        swap_two_boxes().unwrap(),
        boxes_on_a_table(&[(0.6, 0.1), (0.7, 0.25)], &[(0.75, -0.1), (0.6, 0.0)]).unwrap(),
        swap_with_crossed_foliations().unwrap(),
    ]
}

/// Start to goal, every joint knot shared bit for bit.
fn assert_is_a_path(problem: &Problem, path: &ManipulationPath) {
    let knots: Vec<_> = path.segments.iter().map(|s| (&s.knots[0], s.knots.last().unwrap())).collect();
    assert_eq!(*knots[0].0, problem.start);
    for pair in knots.windows(2) {
        assert_eq!(pair[0].1, pair[1].0, "a joint knot is not shared");
    }
    let Goal::Configuration(goal) = &problem.goals[0] else { panic!("the goal is a configuration") };
    let space = &problem.robot.space;
    let off = space.distance(knots.last().unwrap().1, goal, &vec![1.0; space.dimension()]);
    assert!(off < 1e-12, "ends {off} from the goal");
    assert!(path.certificate.min_clearance.is_some_and(|c| c > 0.0));
    assert!(path.certificate.max_residual <= path.certificate.path_tolerance);
}

#[test]
fn small_problems_are_solved() {
    for scheduler in shipped() {
        for problem in small_problems() {
            let model = model(problem.clone());
            for seed in 1..=5 {
                let (outcome, search) = search(&model, scheduler.as_ref(), seeded(seed), 2);
                assert_eq!(outcome, SearchOutcome::Solved, "{} seed {seed}", scheduler.name());
                assert_is_a_path(&problem, &search.path().unwrap());
            }
        }
    }
}

/// The schedulers that are written as a list of systems, with what they add to their world.
type List = (fn() -> StepSystems, fn(&mut World));

const LISTS: [List; 2] =
    [(mrrt::step_systems, |_| ()), (sequence::scheduler::step_systems, sequence::scheduler::insert_resources)];

/// Runs a list whose systems stand in the schedule one by one, or set by set.
struct Listed {
    list: List,
    one_by_one: bool,
}

impl Scheduler for Listed {
    fn name(&self) -> &'static str {
        "listed"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let (systems, insert_resources) = self.list;
        insert_resources(world);
        if self.one_by_one { systems().expanded(true) } else { systems().schedule() }
    }
}

/// Pairs of systems whose order matters and is not given.
fn ambiguous(list: List, ordered: bool) -> usize {
    let model = model(move_one_box().unwrap());
    let mut search =
        Search::new(&model, &Listed { list, one_by_one: true }, seeded(1), stop_within(60), EventSink::default());
    let world = search.world_mut();
    let mut schedule = list.0().expanded(ordered);
    schedule.set_build_settings(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..ScheduleBuildSettings::default()
    });
    match schedule.initialize(world) {
        Ok(_) => 0,
        Err(ScheduleBuildError::Elevated(ScheduleBuildWarning::Ambiguity(conflicts))) => conflicts.0.iter().count(),
        Err(other) => panic!("{other:?}"),
    }
}

#[test]
fn the_order_of_systems_is_given_wherever_it_matters() {
    for list in LISTS {
        assert_eq!(ambiguous(list, true), 0);
        // bevy sees what the systems read and write: it finds many pairs once their order within a set is left out.
        assert!(ambiguous(list, false) > 15, "{}", ambiguous(list, false));
    }
}

#[test]
fn systems_one_by_one_find_the_same_roadmap_as_set_by_set() {
    let model = model(swap_two_boxes().unwrap());
    for (list, shipped) in LISTS.into_iter().zip([&mrrt::Mrrt as &dyn Scheduler, &sequence::Sequence]) {
        for seed in 1..=3 {
            let fingerprint =
                |scheduler: &dyn Scheduler| search(&model, scheduler, seeded(seed), 1).1.roadmap().fingerprint();
            let found = fingerprint(shipped);
            assert_eq!(fingerprint(&Listed { list, one_by_one: true }), found);
            assert_eq!(fingerprint(&Listed { list, one_by_one: false }), found);
        }
    }
}

#[test]
fn caches_are_what_the_entities_say() {
    let model = model(swap_two_boxes().unwrap());
    for scheduler in shipped() {
        let (_, mut search) = search(&model, scheduler.as_ref(), seeded(5), 1);
        assert!(search.roadmap().edges().len() > 10 && search.roadmap().caches_are_true());
        let unvalidated = UnvalidatedByEnd::rebuilt(search.world_mut());
        assert_eq!(search.world().resource::<UnvalidatedByEnd>(), &unvalidated);
        // A search side has reached a leaf as often as it has nodes there.
        let (roadmap, leaves) = (search.roadmap(), search.world().resource::<LeafIndex>());
        let mut rebuilt = ReachedLeaves::default();
        for node in roadmap.nodes() {
            rebuilt.visit(node.side, roadmap.tree(node.side), node.leaf, leaves.leaf(node.leaf));
        }
        let reached = search.world().resource::<ReachedLeaves>();
        assert_eq!(reached.by_born_tree, rebuilt.by_born_tree);
        let trees = (0..roadmap.tree_count() as u32).map(TreeId);
        trees.for_each(|tree| assert_eq!(reached.of_tree(tree), rebuilt.of_tree(tree)));
        // Candidates stand in the order of their indices, and never change their archetype.
        let mut candidates = search.world_mut().query::<&Candidate>();
        let indices: Vec<_> = candidates.iter(search.world()).map(|candidate| candidate.index).collect();
        assert_eq!(indices, (0..indices.len() as u32).collect::<Vec<_>>());
    }
}

#[test]
fn budgets_deadlines_and_tokens_end_the_search() {
    // Out of reach: only a limit ends it.
    let model = model(boxes_on_a_table(&[(0.6, 0.1)], &[(1.25, 0.0)]).unwrap());
    for scheduler in shipped() {
        let steps = seeded(1).with(|s| s.max_steps = 2);
        assert_eq!(search(&model, scheduler.as_ref(), steps, 1).0, SearchOutcome::StepLimit);
        let nodes = seeded(1).with(|s| s.max_nodes = 50);
        assert_eq!(search(&model, scheduler.as_ref(), nodes, 1).0, SearchOutcome::MemoryLimit);

        let mut late = Search::new(&model, scheduler.as_ref(), seeded(1), stop_within(0), EventSink::default());
        assert_eq!(late.run(), SearchOutcome::Timeout);
        assert!(late.path().is_none());

        let stop = StopSignal::default();
        let token = stop.token.clone();
        let mut cancelled = Search::new(&model, scheduler.as_ref(), seeded(1), stop, EventSink::default());
        token.cancel();
        assert_eq!(cancelled.run(), SearchOutcome::Cancelled);
    }
}

fn outcome_of(model: &PlanningModel, scheduler: &dyn Scheduler) -> SearchOutcome {
    search(model, scheduler, seeded(1), 1).0
}

#[test]
fn infeasible_ends_are_named_before_the_search() {
    for scheduler in shipped() {
        // Both boxes in one place.
        let overlapping = model(boxes_on_a_table(&[(0.6, 0.1), (0.6, 0.1)], &[(0.6, 0.1), (0.8, 0.1)]).unwrap());
        let SearchOutcome::InfeasibleStart(why) = outcome_of(&overlapping, scheduler.as_ref()) else { panic!() };
        let why = why.to_string();
        assert!(why.contains("box0") && why.contains("box1") && why.contains("collide"), "{why}");

        let mut floating = move_one_box().unwrap();
        let height = floating.start.len() - 5;
        floating.start[height] += 0.1;
        let SearchOutcome::InfeasibleStart(why) = outcome_of(&model(floating), scheduler.as_ref()) else { panic!() };
        let why = why.to_string();
        assert!(why.contains("place_box0"), "{why}");

        let mut outside = move_one_box().unwrap();
        outside.goals = vec![Goal::Configuration(outside.start.iter().map(|x| x + 10.0).collect())];
        let SearchOutcome::InfeasibleGoal(why) = outcome_of(&model(outside), scheduler.as_ref()) else { panic!() };
        let why = why.to_string();
        assert!(why.contains("outside ["), "{why}");
    }
}

#[test]
fn goals_may_name_only_object_poses() {
    use foliate_components::pose::pose_from_array;
    let mut problem = move_one_box().unwrap();
    let part = problem.robot.part("box0").unwrap();
    let pose = pose_from_array([0.7, -0.2, 0.031, 0.0, 0.0, 0.0, 1.0]).unwrap();
    problem.goals = vec![Goal::object_poses(vec![(part, pose)])];
    for scheduler in shipped() {
        let (outcome, search) = search(&model(problem.clone()), scheduler.as_ref(), seeded(1), 1);
        assert_eq!(outcome, SearchOutcome::Solved);
        let path = search.path().unwrap();
        let end = path.segments.last().unwrap().knots.last().unwrap();
        assert!((end[end.len() - 7] - 0.7).abs() < 1e-9 && (end[end.len() - 6] + 0.2).abs() < 1e-9);
    }
}

#[test]
fn a_host_that_does_not_read_its_events_does_not_block_the_search() {
    let model = model(swap_two_boxes().unwrap());
    for scheduler in shipped() {
        let (sink, events) = EventSink::bounded(16);
        let mut search = Search::new(&model, scheduler.as_ref(), seeded(1), stop_within(120), sink);
        assert_eq!(search.run(), SearchOutcome::Solved);
        assert!(search.world().resource::<EventSink>().dropped > 0);
        assert!(events.try_iter().count() == 16);
        // And one that reads hears of progress and of the end.
        let (sink, events) = EventSink::bounded(1 << 20);
        let mut search = Search::new(&model, scheduler.as_ref(), seeded(1), stop_within(120), sink);
        search.run();
        let heard: Vec<_> = events.try_iter().map(|told| told.event).collect();
        assert!(heard.iter().any(|e| matches!(e, SearchEvent::Progress { .. })));
        assert!(heard.iter().any(|e| matches!(e, SearchEvent::Rejected { .. })));
        assert!(matches!(heard.last(), Some(SearchEvent::Solved { .. })));
    }
}

/// A host's mark on an entity.
#[derive(Component)]
struct Mark;

/// `mrrt`, with a system that marks the first entity of a kind and so moves it to another archetype.
struct Marking<C: Component>(PhantomData<fn() -> C>);

impl<C: Component> Scheduler for Marking<C> {
    fn name(&self) -> &'static str {
        "marking"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = mrrt::Mrrt.schedule(world);
        let mark = |kind: Query<'_, '_, Entity, (With<C>, Without<Mark>)>, mut commands: Commands<'_, '_>| {
            if let Some(first) = kind.iter().next() {
                commands.entity(first).insert(Mark);
            }
        };
        schedule.add_systems(mark.after(SearchSet::Commit).before(SearchSet::Connect));
        schedule
    }
}

fn search_with_marks<C: Component>() {
    let model = model(boxes_on_a_table(&[(0.6, 0.1)], &[(1.25, 0.0)]).unwrap());
    let settings = seeded(1).with(|s| s.max_steps = 3);
    search(&model, &Marking::<C>(PhantomData), settings, 1);
}

#[test]
#[should_panic(expected = "nodes, edges and leaves keep their archetype")]
fn a_node_that_changes_its_archetype_is_noticed() {
    search_with_marks::<RoadmapNode>();
}

#[test]
#[should_panic(expected = "nodes, edges and leaves keep their archetype")]
fn a_leaf_that_changes_its_archetype_is_noticed() {
    search_with_marks::<RoadmapLeaf>();
}

#[test]
#[should_panic(expected = "candidates keep their archetype")]
fn a_candidate_that_changes_its_archetype_is_noticed() {
    search_with_marks::<Candidate>();
}
