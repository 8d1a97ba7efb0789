//! Promise: an improved path is certified, costs less, keeps its ends and its waypoints, and is the same on any number of threads.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]
#![allow(non_snake_case, reason = "pose names carry their frames")]

mod common;

use common::{model, seeded};
use foliate_components::graph::ConstraintKind;
use foliate_components::path::{ManipulationPath, events};
use foliate_components::problem::{Goal, JointRest, Problem};
use foliate_components::samples::{crowd, eight_arms_and_ten_boxes, move_one_box, open_a_drawer, swap_two_boxes};
use foliate_kernels::collision::CollisionScratch;
use foliate_schedulers::sequence::Sequence;
use foliate_systems::events::{CancelToken, StopSignal};
use foliate_systems::improvement::cost::{self, PathCost, path_cost};
use foliate_systems::improvement::leaf_motion::LeafMotion;
use foliate_systems::improvement::proposal::Incumbent;
use foliate_systems::improvement::{Improvement, ImprovementEnding, ImprovementSettings};
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::planning_model::state_classification::residual;
use foliate_systems::search::scheduler::Scheduler;
use foliate_systems::step::validation::certify_whole;
use foliate_systems::trajectory::timed_path;
use std::sync::Arc;

fn first_path(problem: Problem, seed: u64) -> (PlanningModel, ManipulationPath) {
    let (_, search) = common::search(&model(problem), &Sequence, seeded(seed), 1);
    (search.model().clone(), search.path().unwrap())
}

fn cost_of(model: &PlanningModel) -> Arc<dyn PathCost> {
    cost::shipped(&model.problem).into()
}

fn improvement(model: &PlanningModel, path: &ManipulationPath, seed: u64, work: u64, stop: StopSignal) -> Improvement {
    let settings = ImprovementSettings::default().with(|s| s.max_work = work);
    Improvement::new(model, path, (Arc::new(Sequence), cost_of(model)), (seeded(seed), settings), stop).unwrap()
}

/// All that a path has to be: in one piece, within bounds, certified.
fn is_sound(model: &PlanningModel, path: &ManipulationPath, first: &ManipulationPath) {
    let ends = |path: &ManipulationPath| {
        let last = path.segments.last().unwrap();
        (path.segments[0].knots[0].clone(), last.knots.last().unwrap().clone())
    };
    // A quaternion and its negative are one rotation.
    let apart = |a: &[f64], b: &[f64]| model.problem.robot.space.distance(a, b, &model.weights);
    let (ours, theirs) = (ends(path), ends(first));
    assert!(apart(&ours.0, &theirs.0) < 1e-12 && apart(&ours.1, &theirs.1) < 1e-12);
    for pair in path.segments.windows(2) {
        assert_eq!(pair[0].knots.last(), pair[1].knots.first());
    }
    let space = &model.problem.robot.space;
    let motions = LeafMotion::of_path(model, path).unwrap();
    let mut scratch = CollisionScratch::new();
    for motion in &motions {
        for q in motion.knots.chunks_exact(space.size()) {
            assert_eq!(space.first_out_of_bounds(q, 1e-9), None);
        }
        let (leaf, leaves) = motion.leaf();
        let knots: Vec<Vec<f64>> = motion.knots.chunks_exact(space.size()).map(<[f64]>::to_vec).collect();
        let gap = model.carrier_gap(&leaf, &leaves, &knots);
        assert!(gap.written <= 1e-5 && gap.residual <= path.certificate.path_tolerance, "{gap:?}");
        let along = (motion.transition, motion.state);
        let certified = certify_whole(model, &seeded(1), along, &motion.rigid_attachments, &motion.knots, &mut scratch);
        assert!(certified.is_ok(), "{certified:?}");
    }
    assert!(path.certificate.max_residual <= path.certificate.path_tolerance);
    assert!(path.certificate.min_clearance.is_some_and(|clearance| clearance > 0.0));
}

#[test]
fn improved_paths_are_certified_and_cost_less() {
    let problems = [
        move_one_box().unwrap(),
        swap_two_boxes().unwrap(),
        open_a_drawer(JointRest::Stays, 0.2).unwrap(),
        eight_arms_and_ten_boxes().unwrap(),
    ];
    let mut sums = (0.0, 0.0);
    for problem in problems {
        for seed in [1, 2] {
            let (model, first) = first_path(problem.clone(), seed);
            let mut improvement = improvement(&model, &first, seed, 1500, StopSignal::default());
            let before = improvement.cost();
            let mut last = before;
            let ending = improvement.run(|better| {
                assert!(better.cost() < last, "{}: {} after {last}", problem.name, better.cost());
                last = better.cost();
                is_sound(better.model(), &better.path(), &first);
            });
            assert_eq!(ending, ImprovementEnding::Work);
            sums = (sums.0 + before, sums.1 + improvement.cost());
            let path = improvement.path();
            let motions = LeafMotion::of_path(improvement.model(), &path).unwrap();
            let again = path_cost(cost_of(&model).as_ref(), improvement.model(), &motions);
            assert!((again - improvement.cost()).abs() < 1e-6, "{again} and {}", improvement.cost());
            assert!(events(&path).len() <= events(&first).len());
        }
    }
    assert!(sums.1 < 0.9 * sums.0, "{sums:?}");
}

/// A box that is put aside is put elsewhere.
#[test]
fn objects_are_put_down_where_that_is_cheaper() {
    let mut moves = 0;
    for seed in 1..=4 {
        let (model, first) = first_path(swap_two_boxes().unwrap(), seed);
        let only_leaves = ImprovementSettings::default().with(|s| {
            (s.replanning_share, s.limb_probability, s.waypoint_probability) = (0.0, 0.0, 0.0);
            (s.leaf_probability, s.max_work) = (1.0, 300);
        });
        let how = (Arc::new(Sequence) as Arc<dyn Scheduler>, cost_of(&model));
        let settings = (seeded(seed), only_leaves);
        let mut improvement = Improvement::new(&model, &first, how, settings, StopSignal::default()).unwrap();
        let before = improvement.cost();
        improvement.run(|better| is_sound(better.model(), &better.path(), &first));
        let changes = improvement.progress().changes;
        moves += changes.leaf_moves;
        assert_eq!(improvement.cost() < before, changes.leaf_moves > 0);
        timed_path(improvement.model(), &seeded(seed), &improvement.path()).unwrap();
    }
    assert!(moves >= 4, "{moves}");
}

/// Surfaces are often larger than the bounds of what lies on them.
#[test]
fn objects_are_put_down_within_their_bounds() {
    let mut moves = 0;
    for seed in 1..=4 {
        let (_, first) = first_path(swap_two_boxes().unwrap(), seed);
        // Bounds leave a centimetre around the places where the first path puts objects down.
        let mut problem = swap_two_boxes().unwrap();
        let size = problem.robot.space.size();
        let wide = model(problem.clone());
        for i in [size - 14, size - 13, size - 7, size - 6] {
            let resting = first.segments.iter().filter(|s| wide.graph.state(s.state).grasps.is_empty());
            let places: Vec<f64> = resting.flat_map(|s| &s.knots).map(|q| q[i]).collect();
            let (low, high) = (&mut problem.robot.space.lower[i], &mut problem.robot.space.upper[i]);
            *low = places.iter().copied().fold(f64::INFINITY, f64::min) - 0.01;
            *high = places.iter().copied().fold(f64::NEG_INFINITY, f64::max) + 0.01;
        }
        let model = model(problem);
        let only_leaves = ImprovementSettings::default().with(|s| {
            (s.replanning_share, s.limb_probability, s.waypoint_probability) = (0.0, 0.0, 0.0);
            (s.leaf_probability, s.max_work) = (1.0, 300);
        });
        let how = (Arc::new(Sequence) as Arc<dyn Scheduler>, cost_of(&model));
        let mut improvement =
            Improvement::new(&model, &first, how, (seeded(seed), only_leaves), StopSignal::default()).unwrap();
        improvement.run(|_| ());
        moves += improvement.progress().changes.leaf_moves;
        timed_path(improvement.model(), &seeded(seed), &improvement.path()).unwrap();
    }
    assert!(moves > 0);
}

#[test]
fn threads_change_nothing_and_work_gives_a_path_again() {
    let (model, first) = first_path(swap_two_boxes().unwrap(), 3);
    let run = |threads: usize, work: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut improvement = improvement(&model, &first, 5, work, StopSignal::default());
            improvement.run(|_| ());
            (improvement.path(), improvement.progress().clone())
        })
    };
    let (path, progress) = run(1, 2000);
    for threads in [2, 5] {
        assert_eq!(run(threads, 2000), (path.clone(), progress.clone()));
    }
    // What a host has seen of a run that was stopped is what the work until then gives.
    let token = CancelToken::default();
    let mut stopped =
        improvement(&model, &first, 5, u64::MAX, StopSignal { token: token.clone(), ..StopSignal::default() });
    let ending = stopped.run(|better| {
        if better.progress().work > 700 {
            token.cancel();
        }
    });
    assert_eq!(ending, ImprovementEnding::Stopped);
    let (again, counted) = run(1, stopped.progress().work);
    assert_eq!((again, counted.history), (stopped.path(), stopped.progress().history.clone()));
}

#[test]
fn what_is_undone_is_left_out() {
    let problem = move_one_box().unwrap();
    let (model, once) = first_path(problem.clone(), 1);
    // There, back, and there again: the way back is that of the reversed problem.
    let mut reversed = problem.clone();
    let Goal::Configuration(goal) = problem.goals[0].clone() else { unreachable!("the sample's goal is whole") };
    reversed.start = goal;
    reversed.goals = vec![Goal::Configuration(problem.start.clone())];
    let (_, back) = first_path(reversed, 2);
    let mut thrice = once.clone();
    thrice.segments.extend(back.segments);
    thrice.segments.extend(once.segments.clone());
    assert_eq!(events(&thrice).len(), 3 * events(&once).len());
    let mut improvement = improvement(&model, &thrice, 1, 1500, StopSignal::default());
    improvement.run(|better| is_sound(better.model(), &better.path(), &once));
    assert_eq!(events(&improvement.path()).len(), events(&once).len());
}

#[test]
fn waypoints_stay_waypoints() {
    let (model, first) = first_path(swap_two_boxes().unwrap(), 4);
    let mut improvement = improvement(&model, &first, 4, 3000, StopSignal::default());
    improvement.run(|_| ());
    let grown = improvement.model().clone();
    let size = grown.problem.robot.space.size();
    let motions = improvement.world_mut().resource::<Incumbent>().motions.clone();
    let waypoints: Vec<_> = motions.iter().filter(|motion| motion.starts_at_waypoint).collect();
    // Two boxes: each is taken and put down at least once, and one of them twice.
    assert!(waypoints.len() >= 6, "{}", waypoints.len());
    for motion in waypoints {
        let q = motion.start(size);
        let mut X_WJ = vec![foliate_components::Pose::identity(); grown.kinematics.bodies()];
        grown.kinematics.forward(q, &mut X_WJ);
        let holds = (0..grown.graph.constraints.len() as u32).map(foliate_components::graph::ConstraintId).any(|id| {
            let is_waypoint = matches!(
                grown.graph.constraint(id).kind,
                ConstraintKind::Pregrasp { .. } | ConstraintKind::Preplacement { .. }
            );
            is_waypoint && residual(&grown, id, q, &X_WJ) < 1e-5
        });
        assert!(holds, "neither a pregrasp nor a preplacement holds at a waypoint");
    }
}

#[test]
fn arms_that_do_not_need_one_another_move_at_the_same_time() {
    // Both arms have to go elsewhere, and nothing is grasped: one after the other takes twice as long.
    let mut problem = crowd(4, 2).unwrap();
    let mut goal = problem.start.clone();
    problem.robot.set(&mut goal, "arm0/w2", 1.0).unwrap();
    let mut middle = problem.start.clone();
    problem.robot.set(&mut middle, "arm0/w2", 1.0).unwrap();
    problem.robot.set(&mut goal, "arm1/w2", 1.0).unwrap();
    problem.goals = vec![Goal::Configuration(goal.clone())];
    let (model, mut path) = first_path(problem, 1);
    path.segments[0].knots = vec![path.segments[0].knots[0].clone(), middle, goal];
    path.segments.truncate(1);
    let mut improvement = improvement(&model, &path, 1, 400, StopSignal::default());
    let before = improvement.cost();
    improvement.run(|_| ());
    assert!(improvement.cost() < 0.75 * before, "{before} -> {}", improvement.cost());
}
