//! Promise: a problem varies as it is asked to: an instance follows from seed and number alone, starts and goals can be planned for, and what was
//! refused is counted. Answers to many problems come in their order, however many there are.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

use foliate::Planner;
use foliate::batch::vary::{Instance, MovedPart, Obstacles, Rejection, Variations, Vary, Which};
use foliate::batch::{Batch, Entry, Pool, Seeds, Settings, plan_batch};
use foliate::components::problem::Goal;
use foliate::components::robot::Source;
use foliate::components::samples::move_one_box;
use foliate::scene::PackagePath;
use foliate::systems::settings::SearchSettings;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

fn demo() -> Entry {
    Entry::load("demo", &PackagePath::default()).unwrap()
}

fn vary() -> Vary {
    Vary { starts: Which::All, goals: Which::All, ..Vary::new(50, 7) }
}

fn variations(vary: Vary) -> Variations {
    Variations::new(&demo(), vary, &PackagePath::default()).unwrap()
}

/// Position of a part's free root in a configuration.
fn place(instance: &Instance, part: &str, q: &[f64]) -> [f64; 3] {
    let robot = &instance.tables.problem.robot;
    let root = robot[robot.part(part).unwrap()].root_joint.unwrap();
    let Source::Coordinates { q: first, .. } = robot.joints[root.at()].source else { panic!("a root has coordinates") };
    [q[first], q[first + 1], q[first + 2]]
}

fn goal(instance: &Instance) -> &[f64] {
    let Goal::Configuration(q) = &instance.tables.problem.goals[0] else { panic!("the demo's goal is whole") };
    q
}

#[test]
fn an_instance_follows_from_its_number() {
    let (few, many) = (variations(vary()), variations(Vary { instances: 1000, ..vary() }));
    let ends = |instance: Instance| (instance.tables.problem.start.clone(), goal(&instance).to_vec());
    let backwards: Vec<_> = (0..6).rev().map(|number| ends(few.instance(number).unwrap())).collect();
    let forwards: Vec<_> = (0..6).map(|number| ends(many.instance(number).unwrap())).collect();
    assert!(forwards.iter().eq(backwards.iter().rev()));
    assert!((1..6).all(|number| forwards[number] != forwards[0]));
    let other = variations(Vary { seed: 8, ..vary() });
    assert_ne!(ends(other.instance(0).unwrap()), forwards[0]);
}

#[test]
fn starts_and_goals_are_on_the_table_apart_and_can_be_planned_for() {
    let within = [Some((0.4, 0.7)), Some((-0.3, 0.3)), None];
    let variations = variations(Vary { within, ..vary() });
    let mut solved = 0;
    for number in 0..12 {
        let instance = variations.instance(number).unwrap();
        for q in [&instance.tables.problem.start[..], goal(&instance)] {
            let [one, two] = ["box1", "box2"].map(|part| place(&instance, part, q));
            for [x, y, z] in [one, two] {
                assert!((0.4..=0.7).contains(&x) && (-0.3..=0.3).contains(&y), "{x} {y}");
                assert!((z - 0.741).abs() < 1e-9, "{z}");
            }
            assert!((one[0] - two[0]).hypot(one[1] - two[1]) > 0.05);
        }
        let planner = instance.planner().unwrap().first_path().time_limit(Duration::from_secs(20));
        // A place may be out of reach; it is no bad start.
        match planner.solve() {
            Ok(_) => solved += 1,
            Err(none) => assert!(!none.reason.name().starts_with("infeasible_start"), "{none}"),
        }
    }
    assert!(solved >= 10, "{solved} of 12");
}

#[test]
fn what_is_not_named_stays() {
    let only = Vary { starts: Which::These(vec!["box2".into()]), ..Vary::new(1, 1) };
    let instance = variations(only).instance(0).unwrap();
    let base = demo();
    let start = &base.model().problem.start;
    assert_eq!(place(&instance, "box1", &instance.tables.problem.start), place(&instance, "box1", start));
    assert_ne!(place(&instance, "box2", &instance.tables.problem.start), place(&instance, "box2", start));
    let Goal::Configuration(before) = &base.model().problem.goals[0] else { panic!("the demo's goal is whole") };
    assert_eq!(goal(&instance), before);
}

#[test]
fn scenes_vary_too_and_are_read_back() {
    let vary = Vary {
        objects: Some((1, 2)),
        moves: vec![MovedPart {
            part: "table".into(),
            shift: [(-0.05, 0.05), (0.0, 0.0), (-0.02, 0.02)],
            turn: (-0.1, 0.1),
        }],
        obstacles: Some(Obstacles {
            count: (1, 2),
            sides: [(0.02, 0.06); 3],
            middle: [(0.4, 0.8), (-0.4, 0.4), (0.8, 1.0)],
            turn: (-1.0, 1.0),
        }),
        ..vary()
    };
    let variations = variations(vary);
    let mut objects = [0, 0];
    let mut refused = 0;
    for number in 0..10 {
        let instance = variations.instance(number).unwrap();
        let robot = &instance.tables.problem.robot;
        objects[instance.tables.problem.graph.objects.len() - 1] += 1;
        assert!(robot.part("vary_obstacle_1").is_some());
        let table = robot[robot.part("table").unwrap()].world_from_root.translation;
        assert!((0.55..=0.65).contains(&table.x) && table.z.abs() <= 0.02, "{table}");
        // The objects lie on the table where it is now.
        let name = if robot.part("box1").is_some() { "box1" } else { "box2" };
        let [_, _, z] = place(&instance, name, &instance.tables.problem.start);
        assert!((z - 0.741 - table.z).abs() < 1e-9);
        assert!(instance.text.is_some() && instance.scene.is_some());
        refused += usize::from(!instance.refused.is_empty());
    }
    assert!(objects.iter().all(|count| *count > 0), "{objects:?}");
    assert!(refused > 0, "among arms and obstacles no draw of ten was refused");
}

/// Two plates that lie on either face on a table.
const PLATES: &str = r#"
    format = "foliate.scene/1"
    name = "plates"
    [[part]]
    name = "robot"
    kind = "robot"
    urdf = "demo/robot.urdf"
    srdf = "demo/robot.srdf"
    [[part]]
    name = "table"
    kind = "environment"
    urdf = "demo/table.urdf"
    srdf = "demo/table.srdf"
    pose = { xyz = [0.6, 0.0, 0.0] }
    [[part]]
    name = "plate"
    kind = "object"
    shape = { box = [0.05, 0.05, 0.02], mass = 0.1 }
    root_bounds = [[0.2, 1.0], [-0.7, 0.7], [0.6, 1.5]]
    handles = "auto"
    surfaces = "auto"
    [graph]
    grippers = ["robot/left_hand"]
    supports = ["table/top"]
    placement_margin = 0.001
    [start]
    robot = "ready"
    plate = { xyz = [0.5, 0.1, 0.711] }
    [[goal]]
    objects = { plate = { xyz = [0.5, -0.1, 0.711] } }
"#;

#[test]
fn objects_stay_on_their_face_unless_they_may_turn_over() {
    let folder = std::env::temp_dir().join(format!("foliate-vary-faces-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("plates.toml");
    let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/demo");
    std::fs::write(&file, PLATES.replace("demo/", &format!("{}/", scenes.display()))).unwrap();
    let entry = Entry::load(file.to_str().unwrap(), &PackagePath::default()).unwrap();
    let upright = |any_face: bool| {
        let vary = Vary { any_face, ..vary() };
        let variations = Variations::new(&entry, vary, &PackagePath::default()).unwrap();
        let up = |number| {
            let instance = variations.instance(number).unwrap();
            let Goal::Partial(goal) = &instance.tables.problem.goals[0] else { panic!("its goal is a pose") };
            (goal.poses[0].1.rotation * foliate::glam::DVec3::Z).z > 0.999
        };
        (0..20).filter(|&number| up(number)).count()
    };
    assert_eq!(upright(false), 20);
    assert!(upright(true) < 20);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn draws_that_are_none_are_counted_and_end() {
    // Nowhere on the table.
    let nowhere = Vary { within: [Some((5.0, 6.0)), None, None], tries: 3, ..vary() };
    let none = variations(nowhere.clone()).instance(0).unwrap_err();
    assert_eq!((none.tries, none.refused.count(Rejection::Outside)), (3, 3 * 64));
    // An obstacle that fills the table.
    let full = Obstacles {
        count: (1, 1),
        sides: [(1.0, 1.0); 3],
        middle: [(0.6, 0.6), (0.0, 0.0), (1.2, 1.2)],
        turn: (0.0, 0.0),
    };
    let none = variations(Vary { obstacles: Some(full), tries: 2, ..Vary::new(1, 1) }).instance(0).unwrap_err();
    assert_eq!(none.refused.count(Rejection::StartCollides), 2, "{none}");

    let folder = std::env::temp_dir().join(format!("foliate-vary-none-{}", std::process::id()));
    let _fresh = std::fs::remove_dir_all(&folder);
    let settings = Settings {
        seeds: Seeds::new(1, 1).unwrap(),
        threads: 2,
        time_limit: Duration::from_secs(30),
        search: SearchSettings::default(),
        improvement: None,
    };
    let packages = PackagePath::default();
    let batch = Batch::new(vec![demo()], settings).unwrap();
    let batch = batch.vary(Vary { instances: 3, ..nowhere }, &packages).unwrap();
    let rows = batch.run(&folder, |_| {}).unwrap();
    let table = batch.table(&rows).markdown();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(rows.iter().all(|row| row.outcome.name() == "no_instance" && row.refused.to_string() == "outside=192"));
    assert_eq!(rows.iter().map(|row| row.instance).collect::<Vec<_>>(), [Some(0), Some(1), Some(2)]);
    assert!(
        rows[0].message.contains("none of 3 draws is an instance: 192 beyond an edge or bounds"),
        "{}",
        rows[0].message
    );
    assert!(table.contains("Draws that were no instance: 576 beyond an edge or bounds."), "{table}");
}

/// Runs the program; what it prints.
fn foliate(arguments: &[&str]) -> (Option<i32>, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_foliate")).args(arguments).stdin(Stdio::null()).output().unwrap();
    (done.status.code(), String::from_utf8_lossy(&[done.stdout, done.stderr].concat()).into_owned())
}

#[test]
fn paths_of_instances_are_proved_from_their_files_and_rows_do_not_depend_on_threads() {
    let folder = std::env::temp_dir().join(format!("foliate-vary-files-{}", std::process::id()));
    let _fresh = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let text = "format = \"foliate.suite/1\"\nname = \"v\"\nscenes = [\"demo\"]\nseeds = 1\n[vary]\ninstances = 4\nstarts = true\n\
                goals = true\nobjects = 1\nwithin = { x = [0.4, 0.7], y = [-0.3, 0.3] }\n";
    std::fs::write(folder.join("suite.toml"), text).unwrap();
    let bench = |out: &str, threads: &str| {
        let (code, told) = foliate(&["bench", "--suite", &at("suite.toml"), "--out", &at(out), "--threads", threads]);
        assert!(code.is_some_and(|code| code < 2), "{told}");
        let rows = std::fs::read_to_string(folder.join(out).join("results.csv")).unwrap();
        let cells = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            [&cells[..4], &cells[6..]].concat().join(",")
        };
        rows.lines().map(cells).collect::<Vec<_>>()
    };
    let one = bench("one", "1");
    assert_eq!(one, bench("two", "2"));
    let paths: Vec<PathBuf> = std::fs::read_dir(folder.join("one/paths"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    assert!(!paths.is_empty());
    for path in &paths {
        let (code, told) = foliate(&["check", path.to_str().unwrap()]);
        assert!(matches!(code, Some(0 | 3)), "{}: {told}", path.display());
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn answers_come_in_order_and_problems_are_taken_as_they_are_needed() {
    let model = Planner::new(move_one_box().unwrap()).unwrap().model().clone();
    let taken = Arc::new(AtomicUsize::new(0));
    let count = Arc::clone(&taken);
    let planners = (1..=200_u64).map(move |seed| {
        count.fetch_add(1, Ordering::SeqCst);
        Planner::from_model(model.clone()).seed(seed).first_path()
    });
    let mut alone = Vec::new();
    let mut ahead = 0;
    for (given, answer) in plan_batch(planners, 2).unwrap().enumerate() {
        ahead = ahead.max(taken.load(Ordering::SeqCst) - given);
        alone.push(answer.unwrap().report.fingerprint);
    }
    assert_eq!(alone.len(), 200);
    assert!(ahead <= 2 * 32 + 1, "{ahead} problems were taken ahead of the answers");
    let model = Planner::new(move_one_box().unwrap()).unwrap();
    let one_by_one = |seed: u64| Planner::from_model(model.model().clone()).seed(seed).first_path().solve();
    let expected: Vec<u64> = (1..=200).map(|seed| one_by_one(seed).unwrap().report.fingerprint).collect();
    assert_eq!(alone, expected);
}

#[test]
fn who_gives_up_waits_for_no_search() {
    let problem = demo().model().problem.clone();
    let planner = move |seed: u64| {
        let planner = Planner::new(problem.clone()).unwrap().seed(seed);
        if seed == 1 { planner.first_path() } else { planner.improve_time(Duration::from_secs(300)) }
    };
    let begun = std::time::Instant::now();
    let mut answers = plan_batch((1..=4).map(planner), 2).unwrap();
    assert!(answers.next().unwrap().is_ok());
    drop(answers);
    assert!(begun.elapsed() < Duration::from_secs(100), "{:?}", begun.elapsed());
    // A pool that is let go begins nothing more.
    let mut pool = Pool::new(1).unwrap();
    let begun = Arc::new(AtomicUsize::new(0));
    for _ in 0..50 {
        let begun = Arc::clone(&begun);
        pool.add(move || {
            begun.fetch_add(1, Ordering::SeqCst);
            std::thread::sleep(Duration::from_millis(20));
        });
    }
    assert_eq!(pool.take(), Some(()));
    drop(pool);
    assert!(begun.load(Ordering::SeqCst) < 50);
}
