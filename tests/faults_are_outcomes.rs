//! Promise: whatever fails while a search runs, the host gets an outcome, and the next search of the same planner in the same process
//! gives the answer that it would have given without the failure.
//!
//! The short form tests every seventh n; `FOLIATE_FAULTS=all cargo test --test faults_are_outcomes` at all of 1 … 1000.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

use bevy_ecs::prelude::{IntoScheduleConfigs, Schedule, World};
use foliate::batch::{Batch, Entry, Seeds, Settings};
use foliate::components::Pose;
use foliate::components::constraint::{Constraint, Curvature, Custom, Frame, Function, Gradient, Row};
use foliate::components::problem::{NamedConstraint, Problem};
use foliate::components::samples::{carry_a_box_with_its_lid, move_one_box, swap_two_boxes};
use foliate::memory::MemoryLimit;
use foliate::planner::outcome_name;
use foliate::scene::{PackagePath, Scene};
use foliate::schedulers::mrrt::Mrrt;
use foliate::schedulers::{Scheduler, default_scheduler};
use foliate::systems::schedule::SearchSet;
use foliate::systems::settings::SearchSettings;
use foliate::{NoSolution, NoSolutionReason, Planner, Report, Solution};
use glam::DVec3;
use rayon::prelude::*;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Once};
use std::time::{Duration, Instant};

const SETS: [SearchSet; 9] = [
    SearchSet::Sample,
    SearchSet::Select,
    SearchSet::Rendezvous,
    SearchSet::Project,
    SearchSet::Steer,
    SearchSet::Validate,
    SearchSet::Commit,
    SearchSet::Connect,
    SearchSet::Conclude,
];

/// Panics of these tests are expected, and say so.
fn quiet() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let loud = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            let said = panic.payload().downcast_ref::<&str>().copied().unwrap_or_default();
            if said != "a fault" {
                loud(panic);
            }
        }));
    });
}

fn numbers() -> impl Iterator<Item = u64> {
    let step = if std::env::var("FOLIATE_FAULTS").is_ok_and(|which| which == "all") { 1 } else { 7 };
    (1..=1000).step_by(step)
}

/// Where a fault strikes.
#[derive(Clone, Copy)]
enum Where {
    /// In a system of its own in that set.
    System(SearchSet),
    /// On the thread of the pool that works on the last of many items.
    Worker(SearchSet),
}

/// A scheduler with a system that fails in its n-th run.
struct Faulty {
    inner: Box<dyn Scheduler>,
    place: Where,
    nth: u64,
}

impl Scheduler for Faulty {
    fn name(&self) -> &'static str {
        "faulty"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = self.inner.schedule(world);
        let (nth, place) = (self.nth, self.place);
        let (Where::System(set) | Where::Worker(set)) = place;
        let mut runs = 0;
        schedule.add_systems(
            (move || {
                runs += 1;
                match place {
                    _ if runs != nth => {}
                    Where::System(_) => panic!("a fault"),
                    Where::Worker(_) => (0..64_u32).into_par_iter().for_each(|item| assert!(item != 63, "a fault")),
                }
            })
            .in_set(set),
        );
        schedule
    }
}

fn planner(problem: &Problem) -> Planner {
    Planner::new(problem.clone()).unwrap().first_path().time_limit(Duration::from_secs(60))
}

fn told(answer: &Result<Solution, NoSolution>) -> (&'static str, u64, Option<f64>) {
    let report = Report::of(answer);
    (outcome_name(answer), report.fingerprint, report.path_length)
}

#[test]
fn a_panic_in_any_system_is_an_outcome_and_the_next_search_is_unaffected() {
    quiet();
    type Scene = (Problem, fn() -> Box<dyn Scheduler>);
    let scenes: [Scene; 2] =
        [(swap_two_boxes().unwrap(), || Box::new(Mrrt)), (carry_a_box_with_its_lid().unwrap(), default_scheduler)];
    for (problem, scheduler) in scenes {
        let sound = planner(&problem).scheduler(Faulty { inner: scheduler(), place: Where::System(SETS[0]), nth: 0 });
        let reference = told(&sound.solve());
        let steps = Report::of(&sound.solve()).steps;
        assert_eq!(reference.0, "solved");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let mut crashes = 0;
        for number in numbers() {
            let set = SETS[number as usize % SETS.len()];
            let place = if number % 2 == 0 { Where::Worker(set) } else { Where::System(set) };
            // Numbers beyond the search's steps begin anew: every fault strikes.
            let nth = 1 + (number - 1) % (steps + 1);
            let faulty = planner(&problem).scheduler(Faulty { inner: scheduler(), place, nth });
            match pool.install(|| faulty.solve()).map_err(|none| none.reason) {
                Err(NoSolutionReason::Crashed(why)) => {
                    assert!(why.contains("a fault"), "{why}");
                    crashes += 1;
                }
                Err(reason) => panic!("{number}: {reason}"),
                Ok(_) => assert!(nth > steps, "{number}"),
            }
            if number % 11 == 0 {
                assert_eq!(told(&pool.install(|| sound.solve())), reference, "{number}");
            }
        }
        assert!(crashes > 50, "{crashes}");
        assert_eq!(told(&sound.solve()), reference);
    }
}

/// A constraint of a host's own that holds anywhere, and fails when it is asked for the n-th time.
#[derive(Debug)]
struct Failing {
    frame: Frame,
    calls: AtomicU64,
    nth: AtomicU64,
}

impl Function for Failing {
    fn name(&self) -> &str {
        "holds anywhere"
    }

    fn frames(&self) -> &[Frame] {
        std::slice::from_ref(&self.frame)
    }

    fn rows(&self) -> &[Row] {
        &[Row::Inequality]
    }

    fn value(&self, _: &[Pose], values: &mut [f64]) {
        if self.calls.fetch_add(1, Ordering::Relaxed) + 1 == self.nth.load(Ordering::Relaxed) {
            panic!("a fault");
        }
        values[0] = 1.0;
    }

    fn gradient(&self, _: &[Pose], gradients: &mut [Gradient]) {
        gradients[0] = Gradient { linear: DVec3::ZERO, angular: DVec3::ZERO };
    }

    fn curvature(&self) -> Option<Curvature> {
        Some(Curvature { lipschitz: 0.0, bend: 0.0 })
    }
}

#[test]
fn a_panic_in_the_middle_of_a_projection_is_an_outcome() {
    quiet();
    let mut problem = move_one_box().unwrap();
    let hand = problem.robot.gripper("arm/hand").unwrap();
    let hand = &problem.robot.grippers[hand.at()];
    let frame = Frame::on_link(&problem.robot, hand.link, &hand.link_from_gripper);
    let own = Arc::new(Failing { frame, calls: AtomicU64::new(0), nth: AtomicU64::new(0) });
    let constraint = NamedConstraint { name: "own".into(), constraint: Constraint::Custom(Custom(own.clone())) };
    problem.graph.everywhere.push(problem.graph.constraints.len() as u32);
    problem.graph.constraints.push(constraint);
    let planner = planner(&problem);
    let reference = told(&planner.solve());
    assert_eq!(reference.0, "solved");
    // The first solve compiles programs, which the others share. Only what each solve calls is made to fail.
    own.calls.store(0, Ordering::Relaxed);
    assert_eq!(told(&planner.solve()), reference);
    let calls = own.calls.swap(0, Ordering::Relaxed);
    assert!(calls > 100, "{calls}");
    for number in numbers().map(|number| 1 + number * calls / 1000).filter(|&number| number <= calls) {
        own.calls.store(0, Ordering::Relaxed);
        own.nth.store(number, Ordering::Relaxed);
        let threads = 1 + number as usize % 2;
        match planner.solve_on(threads) {
            Err(NoSolution { reason: NoSolutionReason::Crashed(why), .. }) => assert_eq!(why, "a fault", "{number}"),
            answer => panic!("{number} on {threads} threads: {:?}", told(&answer)),
        }
        if number % 5 == 0 {
            own.nth.store(0, Ordering::Relaxed);
            assert_eq!(told(&planner.solve()), reference, "{number}");
        }
    }
}

#[test]
fn no_listener_changes_an_answer() {
    let problem = swap_two_boxes().unwrap();
    let reference = told(&planner(&problem).solve());
    // The channel is full after 4096 events.
    let (full, unread) = planner(&problem).events();
    assert_eq!(told(&full.solve()), reference);
    assert!(!unread.is_empty());
    let (closed, receiver) = planner(&problem).events();
    drop(receiver);
    assert_eq!(told(&closed.solve()), reference);
    // Closed while the search runs.
    let (closing, receiver) = planner(&problem).events();
    let solution = std::thread::scope(|scope| {
        scope.spawn(move || drop(receiver.recv()));
        closing.solve()
    });
    assert_eq!(told(&solution), reference);
    // Full, and then solved again by the same planner.
    assert_eq!(told(&full.solve()), reference);
}

#[test]
fn a_batch_that_has_no_memory_has_its_rows() {
    let folder = std::env::temp_dir().join(format!("foliate-faults-batch-{}", std::process::id()));
    let settings = |search| Settings {
        seeds: Seeds::new(1, 6).unwrap(),
        threads: 2,
        time_limit: Duration::from_secs(60),
        search,
        improvement: None,
    };
    let entry = || Entry::of_problem(swap_two_boxes().unwrap()).unwrap();
    let run = |name: &str, search: SearchSettings, limit: u64| {
        let batch = Batch::new(vec![entry()], settings(search)).unwrap().memory_limit(MemoryLimit::bytes(limit));
        batch.run(&folder.join(name), |_| {}).unwrap()
    };
    // Each search may count some kilobytes.
    let rows = run("scarce", SearchSettings::default().with(|s| s.max_bytes = 20_000), 8 << 30);
    assert!(rows.len() == 6 && rows.iter().any(|row| row.outcome.name() == "memory_limit"));
    // The process has more than that before it begins.
    let rows = run("nothing", SearchSettings::default(), 0);
    assert!(rows.len() == 6 && rows.iter().all(|row| ["memory_limit", "solved"].contains(&row.outcome.name())));
    let rows = run("ample", SearchSettings::default(), 8 << 30);
    assert!(rows.iter().all(|row| row.is_solved()));
    let _gone = std::fs::remove_dir_all(&folder);
}

/// Whatever becomes of the n-th file of a scene, there is an error that names a file, or the scene: no panic, and nothing waits.
#[test]
fn the_nth_file_may_fail_in_any_way() {
    let folder = std::env::temp_dir().join(format!("foliate-faults-files-{}", std::process::id()));
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/demo");
    let _fresh = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let mut names: Vec<_> = std::fs::read_dir(&demo).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.retain(|name| !name.to_string_lossy().ends_with(".md"));
    names.sort();
    for name in &names {
        std::fs::copy(demo.join(name), folder.join(name)).unwrap();
    }
    let scene = folder.join("scene.toml");
    let solve = || {
        let scene = Scene::load(scene.to_str().unwrap(), &PackagePath::default()).map_err(|error| error.to_string())?;
        Ok::<_, String>(told(&planner(&scene.problem).solve()))
    };
    let reference = solve().unwrap();
    let mut refused = 0;
    for name in &names {
        let (file, aside) = (folder.join(name), folder.join("aside"));
        let content = std::fs::read(&file).unwrap();
        for kind in ["missing", "folder", "pipe", "endless", "empty", "half", "other bytes", "not readable"] {
            std::fs::rename(&file, &aside).unwrap();
            match kind {
                "folder" => std::fs::create_dir(&file).unwrap(),
                "pipe" if cfg!(unix) => {
                    let made = std::process::Command::new("mkfifo").arg(&file).status();
                    assert!(made.is_ok_and(|status| status.success()));
                }
                #[cfg(unix)]
                "endless" => std::os::unix::fs::symlink("/dev/zero", &file).unwrap(),
                "empty" => std::fs::write(&file, []).unwrap(),
                "half" => std::fs::write(&file, &content[..content.len() / 2]).unwrap(),
                "other bytes" => std::fs::write(&file, [0xff; 1000]).unwrap(),
                // Reading it fails with an error of the device, for root too.
                #[cfg(target_os = "linux")]
                "not readable" => std::os::unix::fs::symlink("/proc/self/mem", &file).unwrap(),
                _ => {}
            }
            let started = Instant::now();
            match solve() {
                Err(error) => refused += usize::from(!error.is_empty()),
                Ok(other) => assert!(kind == "half" || other.0 != "solved", "{name:?} {kind}"),
            }
            assert!(started.elapsed() < Duration::from_secs(60), "{name:?} {kind}");
            match kind {
                "folder" => std::fs::remove_dir(&file).unwrap(),
                _ => drop(std::fs::remove_file(&file)),
            }
            std::fs::rename(&aside, &file).unwrap();
        }
        assert_eq!(solve(), Ok(reference), "{name:?}");
    }
    assert!(refused >= 6 * names.len(), "{refused}");
    let _gone = std::fs::remove_dir_all(&folder);
}
