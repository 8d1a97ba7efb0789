//! Promise: a path with times keeps its limits of velocity, acceleration and jerk, stands still where hands take and let go, is in one
//! piece, and is certified as the curve that it is.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, seeded};
use foliate_components::path::{ManipulationPath, Segment, events};
use foliate_components::problem::{JointRest, Problem, RateLimits};
use foliate_components::samples::{move_one_box, open_a_drawer, swap_two_boxes};
use foliate_kernels::trajectory::{Limits, Spline, acceleration_jump, peak_rates};
use foliate_schedulers::sequence::Sequence;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::timed_certificate::{TimedScratch, certify_timed_path};
use foliate_systems::trajectory::timed_path;

fn timed(problem: Problem, seed: u64) -> (PlanningModel, ManipulationPath) {
    let (_, search) = common::search(&model(problem), &Sequence, seeded(seed), 1);
    let (model, first) = (search.model().clone(), search.path().unwrap());
    let path = timed_path(&model, &seeded(seed), &first).unwrap();
    certify_timed_path(&model, &seeded(seed), &path, &mut TimedScratch::default()).unwrap();
    (model, path)
}

/// The curve of a whole path.
fn curve(path: &ManipulationPath) -> Spline {
    let mut curve = Spline::new(path.segments[0].knots[0].len());
    for segment in &path.segments {
        let timing = segment.timing.as_ref().unwrap();
        for ((time, knot), velocity) in timing.times.iter().zip(&segment.knots).zip(&timing.velocities) {
            if curve.parameters().last().is_none_or(|last| time > last) {
                curve.push(*time, knot, velocity);
            }
        }
    }
    curve
}

/// Limits of the joints of robots, which come before the numbers of objects.
fn limits_of_robots(problem: &Problem) -> RateLimits {
    let mut limits = RateLimits::of(&problem.robot, &problem.timing);
    let robots = problem.robot.joints.iter().filter(|joint| !joint.name.ends_with("root_joint")).count();
    for limit in [&mut limits.velocity, &mut limits.acceleration, &mut limits.jerk] {
        limit[robots..].fill(f64::INFINITY);
    }
    limits
}

#[test]
fn limits_hold_and_the_robot_stands_still_at_events() {
    for (jerk_ramp, problem) in [
        (0.0, swap_two_boxes().unwrap()),
        (0.1, swap_two_boxes().unwrap()),
        (0.0, open_a_drawer(JointRest::Stays, 0.2).unwrap()),
    ] {
        for seed in [1, 2, 3] {
            let mut problem = problem.clone();
            problem.timing.jerk_ramp = jerk_ramp;
            let (model, path) = timed(problem, seed);
            let limits = limits_of_robots(&model.problem);
            let limits = Limits::from(&limits);
            let curve = curve(&path);
            let peaks = peak_rates(&curve, limits);
            assert!(peaks.keep_limits(1e-9), "{peaks:?}");
            if jerk_ramp > 0.0 {
                assert!(peaks.jerk.share <= 1.0 + 1e-9, "{peaks:?}");
                assert!(acceleration_jump(&curve, limits.acceleration).share < 1e-6);
            }
            let used = peaks.velocity.share.max(peaks.acceleration.share);
            assert!(used > 0.99, "time is wasted: {used}");
            for pair in path.segments.windows(2) {
                let (before, after) = (pair[0].timing.as_ref().unwrap(), pair[1].timing.as_ref().unwrap());
                assert_eq!(pair[0].knots.last(), pair[1].knots.first());
                assert_eq!(before.times.last(), after.times.first());
                assert_eq!(before.velocities.last(), after.velocities.first());
            }
            let found = events(&path);
            assert!(found.len() >= 2);
            for event in found {
                assert!(event.dwell >= model.problem.timing.dwell - 1e-12, "{event:?}");
                let at = path.segments[event.segment].timing.as_ref().unwrap();
                assert!(at.velocities[0].iter().all(|v| *v == 0.0));
            }
        }
    }
}

#[test]
fn bounded_jerk_takes_longer() {
    let duration = |jerk_ramp: f64| {
        let mut problem = swap_two_boxes().unwrap();
        problem.timing.jerk_ramp = jerk_ramp;
        timed(problem, 1).1.duration().unwrap()
    };
    let (none, some, more) = (duration(0.0), duration(0.05), duration(0.2));
    assert!(none < some && some < more, "{none} {some} {more}");
}

/// Two hands that hold one object have it in two places, which differ by what projections leave. A path that takes a box and lets go of
/// it at once stands for both.
#[test]
fn an_object_that_changes_hands_at_once_has_both_dwells() {
    let (_, search) = common::search(&model(move_one_box().unwrap()), &Sequence, seeded(1), 1);
    let (model, first) = (search.model().clone(), search.path().unwrap());
    let held = |segment: &Segment| !model.graph.state(segment.state).grasps.is_empty();
    let grasp = first.segments.iter().position(held).unwrap();
    let approach = &first.segments[grasp - 1];
    let reverse = model.graph.transition(approach.transition).reverse.unwrap();
    let object = approach.knots[0].len() - 7;
    let moved =
        |knot: &Vec<f64>| knot.iter().enumerate().map(|(i, x)| if i == object { x + 3e-9 } else { *x }).collect();
    let still = vec![first.segments[grasp].knots[0].clone(), moved(&first.segments[grasp].knots[0])];
    let still = Segment { knots: still, ..first.segments[grasp].clone() };
    let back: Vec<Vec<f64>> = approach.knots.iter().rev().map(moved).collect();
    let back = Segment { transition: reverse, knots: back, ..approach.clone() };
    let segments = vec![approach.clone(), still, back];
    let path = timed_path(&model, &seeded(1), &ManipulationPath { segments, ..first.clone() }).unwrap();
    let dwells: Vec<f64> = events(&path).iter().map(|event| event.dwell).collect();
    assert_eq!(dwells.len(), 2);
    assert!(dwells.iter().all(|dwell| (dwell - model.problem.timing.dwell).abs() < 1e-9), "{dwells:?}");
}
