//! Promise: a host gets along with the prelude: names instead of places in a vector, a path or a typed reason, events that tell
//! their solve, and types that may go to any thread.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

use foliate::components::samples::{move_one_box, swap_two_boxes};
use foliate::glam::DVec3;
use foliate::prelude::*;
use std::error::Error as _;
use std::fmt::Debug;
use std::time::Duration;

#[test]
fn a_start_and_a_goal_are_set_by_name() {
    let mut problem = move_one_box().unwrap();
    problem.set_start("arm/w2", 0.3).unwrap();
    let CoordinateValue::Pose(start) = problem.robot.get(&problem.start, "box0").unwrap() else { panic!("no pose") };
    let place = Pose::from_parts(start.translation + DVec3::new(0.05, -0.1, 0.0), start.rotation);
    problem.goals = vec![problem.partial_goal([("box0", place.into()), ("arm/w2", (-0.4).into())]).unwrap()];

    let planner = Planner::new(problem).unwrap().seed(1).time_limit(Duration::from_secs(60));
    let solution = planner.solve().unwrap();
    let robot = &planner.model().problem.robot;
    let (first, last) =
        (&solution.path.segments[0].knots[0], solution.path.segments.last().unwrap().knots.last().unwrap());
    assert_eq!(robot.get(first, "arm/w2").unwrap(), CoordinateValue::Number(0.3));
    let CoordinateValue::Number(turn) = robot.get(last, "arm/w2").unwrap() else { panic!("no number") };
    assert!((turn + 0.4).abs() < 1e-6, "{turn}");
    for name in ["box0", "box0/root_joint"] {
        let CoordinateValue::Pose(end) = robot.get(last, name).unwrap() else { panic!("no pose") };
        assert!((end.translation - place.translation).length() < 1e-6, "{name} is at {end:?}");
    }
    assert!(solution.certificate().min_clearance.is_some_and(|clearance| clearance > 0.0));
}

#[test]
fn a_name_that_does_not_fit_is_refused_and_changes_nothing() {
    let mut problem = move_one_box().unwrap();
    let before = problem.start.clone();
    let mut refused = |name: &str, value: CoordinateValue| problem.set_start(name, value).unwrap_err();
    assert_eq!(refused("arm/w9", 0.0.into()), CoordinateError::Unknown("arm/w9".into()));
    assert_eq!(refused("arm/w2", f64::NAN.into()), CoordinateError::NotFinite("arm/w2".into()));
    let mut turned = Pose::identity();
    turned.rotation = foliate::glam::DQuat::from_xyzw(0.0, 0.0, 0.0, 1.1);
    assert_eq!(refused("box0", turned.into()), CoordinateError::NoRotation("box0".into()));
    turned.rotation.w = f64::INFINITY;
    assert_eq!(refused("box0", turned.into()), CoordinateError::NotFinite("box0".into()));
    assert_eq!(refused("arm", Pose::identity().into()), CoordinateError::FixedRoot("arm".into()));
    assert_eq!(refused("arm/w2", Pose::identity().into()).to_string(), "`arm/w2` takes a number");
    assert_eq!(refused("box0", [0.0; 3].into()).to_string(), "`box0` takes a pose");
    assert_eq!(problem.start, before);
}

#[test]
fn no_solution_says_why() {
    let stuck = |problem: Problem| Planner::new(problem).unwrap().solve().unwrap_err();

    let mut outside = move_one_box().unwrap();
    outside.set_start("arm/w2", 9.0).unwrap();
    let none = stuck(outside);
    let NoSolutionReason::InfeasibleStart(Infeasibility::OutOfBounds { coordinate, value, .. }) = &none.reason else {
        panic!("{none}");
    };
    assert_eq!((coordinate.as_str(), *value), ("arm/w2", 9.0));
    // As an error it has the reason as its source, also behind the error of the whole library.
    assert!(none.source().unwrap().to_string().starts_with("arm/w2 = 9 is outside ["));
    assert!(Error::from(none).source().unwrap().is::<Infeasibility>());

    let mut overlapping = swap_two_boxes().unwrap();
    let first = overlapping.robot.get(&overlapping.start, "box0").unwrap();
    overlapping.set_start("box1", first).unwrap();
    let none = stuck(overlapping);
    let NoSolutionReason::InfeasibleStart(Infeasibility::Collision(pairs)) = &none.reason else { panic!("{none}") };
    assert!(pairs.iter().any(|pair| pair.links.0.starts_with("box0/") && pair.links.1.starts_with("box1/")));

    let mut without = move_one_box().unwrap();
    without.goals.clear();
    assert!(matches!(stuck(without).reason, NoSolutionReason::InfeasibleGoal(Infeasibility::NoGoal)));

    let planner = Planner::new(swap_two_boxes().unwrap()).unwrap();
    planner.cancel_token().cancel();
    assert!(matches!(planner.solve().unwrap_err().reason, NoSolutionReason::Cancelled));
    let limited = |settings| Planner::new(swap_two_boxes().unwrap()).unwrap().settings(settings).solve().unwrap_err();
    let none = limited(SearchSettings::default().with(|s| s.max_steps = 1));
    assert!(matches!(none.reason, NoSolutionReason::StepLimit) && none.report.steps == 1);
    let none = limited(SearchSettings::default().with(|s| s.max_nodes = 1));
    assert!(matches!(none.reason, NoSolutionReason::MemoryLimit), "{none}");
}

#[test]
fn events_tell_of_which_solve_they_are() {
    let (planner, events) = Planner::new(move_one_box().unwrap()).unwrap().events();
    let solves = std::thread::scope(|scope| {
        let running = [1, 2].map(|threads| {
            scope.spawn({
                let planner = &planner;
                move || planner.solve_on(threads).unwrap().report.solve
            })
        });
        running.map(|solve| solve.join().unwrap())
    });
    assert_ne!(solves[0], solves[1]);
    let heard: Vec<_> = events.try_iter().collect();
    for solve in solves {
        let own: Vec<_> = heard.iter().filter(|told| told.solve == solve).collect();
        assert!(own.len() > 1 && matches!(own.last().unwrap().event, SearchEvent::Solved { .. }), "{solve}: {own:?}");
    }
    assert!(heard.iter().all(|told| solves.contains(&told.solve)));
}

#[test]
fn types_of_the_prelude_may_go_to_any_thread_and_can_be_printed() {
    fn shared<T: Send + Sync + Debug>() {}
    shared::<Planner>();
    shared::<Solution>();
    shared::<NoSolution>();
    shared::<NoSolutionReason>();
    shared::<Infeasibility>();
    shared::<Report>();
    shared::<Scene>();
    shared::<SceneError>();
    shared::<PackagePath>();
    shared::<Problem>();
    shared::<Goal>();
    shared::<PartialGoal>();
    shared::<Path>();
    shared::<Certificate>();
    shared::<SearchSettings>();
    shared::<CancelToken>();
    shared::<MemoryLimit>();
    shared::<SolveEvent>();
    shared::<CoordinateValue>();
    shared::<CoordinateError>();
    shared::<Error>();
    shared::<Pose>();
}

#[test]
fn an_error_of_reading_has_the_error_that_it_was_made_of() {
    let packages = PackagePath::default();
    let missing = Scene::from_file("no/such/scene.toml", &packages).err().map(Error::from);
    let kind = missing.as_ref().and_then(|error| error.source()?.downcast_ref::<std::io::Error>()).map(|io| io.kind());
    assert_eq!(kind, Some(std::io::ErrorKind::NotFound), "{missing:?}");
    let malformed = Scene::from_text("text", "name = [", std::path::Path::new("."), &packages).err();
    let source = malformed.as_ref().and_then(|error| error.source()).map(ToString::to_string);
    assert!(source.is_some_and(|source| source.contains("TOML")), "{malformed:?}");
    assert_eq!(malformed, malformed.clone(), "errors can be compared");
}

#[test]
fn a_time_limit_ends_an_improvement_and_keeps_its_path() {
    let planner = Planner::new(swap_two_boxes().unwrap()).unwrap().improve_time(Duration::from_secs(600));
    let started = std::time::Instant::now();
    let solution = planner.time_limit(Duration::from_millis(300)).solve().unwrap();
    assert!(started.elapsed() < Duration::from_secs(30), "{:?}", started.elapsed());
    assert!(solution.report.improvement.is_some_and(|improvement| improvement.stopped));
    assert!(solution.path.duration().is_some());
}
