//! A path with times is proved as the curves that it is: what the searches find, with times, is proved; what bulges is refused, with the
//! place and the reason.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;
#[path = "../../tests/common/timed.rs"]
mod timed;

use common::{model, search, seeded};
use foliate_components::outcome::SearchOutcome;
use foliate_components::path::ManipulationPath;
use foliate_components::problem::{JointRest, Problem};
use foliate_components::robot::ComposeError;
use foliate_components::samples;
use foliate_schedulers::shipped;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::path_clearance::path_clearance;
use foliate_systems::search::timed_certificate::{TimedFaultKind, TimedScratch, certify_timed_path};
use foliate_systems::settings::SearchSettings;
use std::time::Instant;

type Sample = (&'static str, fn() -> Result<Problem, ComposeError>);

const SAMPLES: [Sample; 7] = [
    ("swap", samples::swap_two_boxes),
    ("crossed", samples::swap_with_crossed_foliations),
    ("drawer", || samples::open_a_drawer(JointRest::Stays, 0.2)),
    ("lid", samples::put_a_lid_on_a_box),
    ("carry", samples::carry_a_box_with_its_lid),
    ("level", samples::move_one_box_with_a_level_hand),
    ("step", samples::make_a_step),
];

/// A path that a search finds, with times.
fn solved(problem: Problem, seed: u64) -> (PlanningModel, ManipulationPath) {
    let model = model(problem);
    let (outcome, search) = search(&model, &*shipped::default_scheduler(), seeded(seed), 1);
    assert_eq!(outcome, SearchOutcome::Solved);
    // A lazy graph grows in a model of the search's own.
    let (model, mut path) = (search.model().clone(), search.path().unwrap());
    timed::rest_to_rest(&model.problem, &mut path);
    (model, path)
}

#[test]
fn what_searches_find_is_proved_with_times() {
    let mut scratch = TimedScratch::default();
    for (name, problem) in SAMPLES {
        let (model, path) = solved(problem().unwrap(), 1);
        let begin = Instant::now();
        let certificate = certify_timed_path(&model, &SearchSettings::default(), &path, &mut scratch);
        let took = begin.elapsed();
        let certificate = certificate.unwrap_or_else(|fault| panic!("{name}: {fault:?}"));
        let pieces: usize = path.segments.iter().map(|s| s.knots.len() - 1).sum();
        println!("{name}: {} segments, {pieces} pieces, {took:?}, {certificate:?}", path.segments.len());
        assert!(certificate.max_residual <= certificate.path_tolerance);
        assert!(certificate.min_clearance.unwrap() > 0.0);
        assert_eq!(certificate.pairs, path.certificate.pairs);
        // Where a path without times comes closest the same path with times does: it goes the same way.
        let mut untimed = path.clone();
        untimed.segments.iter_mut().for_each(|segment| segment.timing = None);
        let [with, without] = [&path, &untimed].map(|path| path_clearance(&model, path).unwrap().lower);
        assert!(with >= certificate.min_clearance.unwrap() - 1e-9, "{name}: {with}");
        assert!(
            (with - without).abs() <= 0.12 * without.max(with) + 1e-4,
            "{name}: {with} with times, {without} without"
        );
    }
}

/// The number of a segment in which a robot moves, and of a piece in which a coordinate of its moves most.
fn moving(model: &PlanningModel, path: &ManipulationPath) -> (usize, usize, usize) {
    let space = &model.problem.robot.space;
    let mut most = (0.0, (0, 0, 0));
    for (number, segment) in path.segments.iter().enumerate() {
        for (piece, pair) in segment.knots.windows(2).enumerate() {
            for factor in &space.factors {
                let by = (pair[1][factor.q] - pair[0][factor.q]).abs();
                if model.robot_weights[factor.v] > 0.0 && by > most.0 {
                    most = (by, (number, piece, factor.q));
                }
            }
        }
    }
    most.1
}

#[test]
fn what_bulges_is_refused_where_it_does() {
    let (model, path) = solved(samples::swap_two_boxes().unwrap(), 1);
    let (settings, mut scratch) = (SearchSettings::default(), TimedScratch::default());
    let mut refused = |path: &ManipulationPath| certify_timed_path(&model, &settings, path, &mut scratch).unwrap_err();
    let (segment, piece, coordinate) = moving(&model, &path);
    let mut untimed = path.clone();
    untimed.segments[segment].timing = None;
    let fault = refused(&untimed);
    assert_eq!((fault.segment, fault.kind), (segment, TimedFaultKind::Unsound));
    // A joint that swings far beyond its limits between two knots.
    let mut wild = path.clone();
    let timing = wild.segments[segment].timing.as_mut().unwrap();
    timing.velocities[piece][coordinate] = 1e3;
    timing.velocities[piece + 1][coordinate] = -1e3;
    if piece > 0 || segment > 0 {
        // The velocity has to be continuous, where the segment begins too: only the piece's end is left for that.
        let timing = wild.segments[segment].timing.as_mut().unwrap();
        timing.velocities[piece][coordinate] = 0.0;
    }
    let fault = refused(&wild);
    assert!(matches!(fault.kind, TimedFaultKind::Limit { .. } | TimedFaultKind::Gap), "{fault:?}");
    // A box that is written where its carrier does not take it.
    let mut moved = path.clone();
    let object = model.objects()[0].root.unwrap();
    let foliate_components::robot::Source::Coordinates { q, .. } = model.problem.robot.joints[object.at()].source
    else {
        panic!("a box has coordinates");
    };
    let last = moved.segments.len() - 1;
    moved.segments[last].knots.last_mut().unwrap()[q + 2] += 1e-3;
    let fault = refused(&moved);
    assert!(matches!(fault.kind, TimedFaultKind::OffCarrier(by) if (by - 1e-3).abs() < 1e-6), "{fault:?}");
    // Times that do not go on.
    let mut late = path.clone();
    let next = late.segments[1].timing.as_mut().unwrap();
    next.times.iter_mut().for_each(|time| *time += 0.5);
    assert_eq!(refused(&late).kind, TimedFaultKind::Gap);
}

#[test]
fn what_bulges_into_something_is_refused_although_its_knots_are_free() {
    let (model, path) = solved(samples::swap_two_boxes().unwrap(), 1);
    let settings = SearchSettings::default();
    let mut scratch = TimedScratch::default();
    let size = model.problem.robot.space.size();
    let (mut collisions, mut limits, mut free) = (0, 0, 0);
    for (number, segment) in path.segments.iter().enumerate() {
        for piece in 0..segment.knots.len() - 1 {
            for coordinate in 0..size {
                let mut bent = path.clone();
                let timing = bent.segments[number].timing.as_mut().unwrap();
                let duration = timing.times[piece + 1] - timing.times[piece];
                if segment.knots[piece][coordinate] == segment.knots[piece + 1][coordinate] {
                    continue;
                }
                // Out by 0.3 and back, with a knot in the middle that stays: continuous with both neighbours at rest.
                let middle: Vec<f64> =
                    (0..size).map(|i| segment.knots[piece][i].midpoint(segment.knots[piece + 1][i])).collect();
                let mut swing: Vec<f64> =
                    (0..size).map(|i| (segment.knots[piece + 1][i] - segment.knots[piece][i]) / duration).collect();
                swing[coordinate] += 4.0 / duration;
                timing.times.insert(piece + 1, timing.times[piece] + 0.5 * duration);
                timing.velocities.insert(piece + 1, swing);
                bent.segments[number].knots.insert(piece + 1, middle);
                match certify_timed_path(&model, &settings, &bent, &mut scratch)
                    .map_err(|fault| (fault.segment, fault.kind))
                {
                    Ok(_) => free += 1,
                    Err((_, TimedFaultKind::Limit { .. })) => limits += 1,
                    Err((at, TimedFaultKind::Collision(_))) => {
                        collisions += 1;
                        assert_eq!(at, number);
                    }
                    Err((at, TimedFaultKind::OffCarrier(_))) => assert_eq!(at, number),
                    Err(other) => panic!("{other:?}"),
                }
            }
        }
    }
    println!("{collisions} collide, {limits} exceed limits, {free} are free");
    assert!(collisions > 0 && free > 0);
}
