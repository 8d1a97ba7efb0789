//! Promise: a recording holds what a search did, found or not, and what stood in the way; it is the same on any number of threads, it is
//! as small as it has to be and says what it leaves out; nothing is kept unless it is asked for.

#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

#[path = "common/recorded.rs"]
mod recorded;

use foliate::components::outcome::Rejection;
use foliate::path_file::save;
use foliate::planner::EdgeKind;
use foliate::recording::Recording;
use foliate::{NoSolution, NoSolutionReason, Planner, Report, Solution};
use recorded::{Folder, demo, planner, recorded};
use std::collections::HashSet;
use std::path::Path;

type Answer = Result<Solution, NoSolution>;

/// `demo` with too few steps for it.
fn failing(scheduler: &str, seed: u64) -> Planner {
    let settings = foliate::systems::settings::SearchSettings::default().with(|s| s.max_steps = 6);
    planner(scheduler).settings(settings).seed(seed)
}

fn read_back(recording: &Recording) -> Recording {
    let bytes = recording.to_bytes().expect("numbers are finite");
    Recording::of_bytes(Path::new("memory"), &bytes).expect("it reads back")
}

/// What holds of every recording that leaves nothing out.
fn is_whole(recording: &Recording, answer: &Answer) {
    let (report, head) = (Report::of(answer), &recording.head);
    assert_eq!(*recording, read_back(recording));
    assert_eq!(head.left_out, foliate::recording::LeftOutEntry::default());
    assert_eq!((recording.nodes.len(), head.counts.nodes), (report.nodes, report.nodes as u64));
    let certified = recording.edges.kinds.iter().filter(|kind| **kind == EdgeKind::Certified).count();
    assert_eq!((certified, head.counts.edges), (report.edges, report.edges as u64));
    assert_eq!(recording.nodes.leaves.iter().collect::<HashSet<_>>().len().min(report.leaves), {
        recording.nodes.leaves.iter().collect::<HashSet<_>>().len()
    });
    assert!(recording.nodes.steps.is_sorted());
    assert!(recording.nodes.steps.iter().chain(&recording.edges.steps).all(|&step| u64::from(step) <= report.steps));
    // Rows of states count the nodes that say that they are in them.
    for (place, state) in head.states.iter().enumerate() {
        let here = recording.nodes.states.iter().filter(|&&at| at as usize == place).count();
        assert_eq!(state.nodes, here as u64, "{}", state.name);
    }
    funnel_is_the_reports(recording, report);
    let shown = recording.shown();
    assert_eq!(shown.configurations.len(), report.nodes * head.path.coordinates.len());
    let trees = recording.nodes.trees.iter().collect::<HashSet<_>>().len();
    assert_eq!(shown.joins.len(), trees - components(recording));
    assert!(shown.joins.is_sorted_by_key(|join| join.step));
}

fn funnel_is_the_reports(recording: &Recording, report: &Report) {
    assert_eq!(recording.head.funnel.len(), report.funnel.len());
    for row in &report.funnel {
        let place = recording.head.transitions.iter().position(|t| t.name == row.transition).expect("it is listed");
        let told = recording.head.funnel.iter().find(|told| told.transition as usize == place).expect("it was tried");
        let s = &row.statistics;
        assert_eq!((told.tried, told.reached, told.partial), (s.attempts, s.reached, s.partial));
        let stopped: u64 = told.rejections.iter().map(|rejection| rejection.count).sum();
        assert_eq!(told.reached + stopped, told.tried);
        assert!(told.tried >= told.projected && told.projected >= told.free && told.free >= told.reached);
        let blocked: u64 =
            s.rejections.iter().filter(|(r, _)| matches!(r, Rejection::WaypointBlocked(_))).map(|(_, n)| n).sum();
        assert_eq!(told.projected - told.free, blocked);
        let pairs: Vec<_> = told.pairs.iter().map(|p| (p.shapes[0].clone(), p.shapes[1].clone(), p.count)).collect();
        let sorted = |mut pairs: Vec<(String, String, u64)>| {
            pairs.sort();
            pairs
        };
        assert_eq!(sorted(pairs), sorted(row.blocked_by.clone()));
    }
}

/// Parts of the roadmap that certified edges and trees hold together.
fn components(recording: &Recording) -> usize {
    let mut of: Vec<u32> = recording.nodes.trees.clone();
    for edge in 0..recording.edges.len() {
        let ends = [recording.edges.from[edge], recording.edges.to[edge]].map(|node| of[node as usize]);
        if recording.edges.kinds[edge] == EdgeKind::Certified && ends[0] != ends[1] {
            of.iter_mut().filter(|tree| **tree == ends[1]).for_each(|tree| *tree = ends[0]);
        }
    }
    of.iter().collect::<HashSet<_>>().len()
}

#[test]
fn a_solved_search_is_recorded_with_its_path() {
    for scheduler in ["sequence", "mrrt", "portfolio"] {
        let answer = planner(scheduler).seed(2).record().solve();
        let recording = recorded(&answer, scheduler, 2);
        is_whole(&recording, &answer);
        let solution = answer.expect("a path");
        assert_eq!((recording.head.outcome.as_str(), &recording.head.reason), ("solved", &None));
        assert_eq!(recording.head.path.segments.len(), solution.path.segments.len());
        let shown = recording.shown();
        let root = |node: u32| shown.tree[node as usize];
        let roots = &recording.head.roots;
        assert_eq!(shown.trees[usize::from(root(roots.start.expect("a start")))], "start");
        // The tree of the goal that was reached is the start's by now.
        assert!(roots.goals.iter().any(|&goal| shown.trees[usize::from(root(goal))] == "start"), "{scheduler}");
        assert!(recording.words()[0].contains("A path was found"));
        let members = if scheduler == "portfolio" { solution.report.worlds.len() } else { 0 };
        assert_eq!(recording.head.members.len(), members);
        assert!(members == 0 || recording.words().iter().any(|words| words.contains("which answers")));
    }
}

#[test]
fn a_failed_search_is_recorded_with_what_stood_in_the_way() {
    for scheduler in ["sequence", "mrrt", "portfolio"] {
        let answer = failing(scheduler, 4).record().solve();
        let recording = recorded(&answer, scheduler, 4);
        is_whole(&recording, &answer);
        assert!(matches!(answer.expect_err("no path").reason, NoSolutionReason::StepLimit));
        assert_eq!(recording.head.outcome, "step_limit");
        assert!(recording.head.path.segments.is_empty() && !recording.head.path.parts.is_empty());
        assert!(recording.words()[0].contains("the step limit was reached"), "{:?}", recording.words());
        let shown = recording.shown();
        let pairs: Vec<_> = shown.funnel.iter().flat_map(|row| &row.pairs).collect();
        let placed = pairs.iter().filter(|pair| pair.configuration.is_some()).count();
        assert!(!pairs.is_empty() && 10 * placed >= 9 * pairs.len(), "{scheduler}: {placed} of {}", pairs.len());
        let size = recording.head.path.coordinates.len();
        assert!(pairs.iter().filter_map(|pair| pair.configuration.as_ref()).all(|q| q.len() == size));
    }
}

#[test]
fn recordings_are_the_same_on_any_number_of_threads() {
    for scheduler in ["sequence", "mrrt", "portfolio"] {
        for seed in 1..=2 {
            let bytes = |threads: usize| {
                let solved = planner(scheduler).seed(seed).record().solve_on(threads);
                let failed = failing(scheduler, seed).record().solve_on(threads);
                [solved, failed].map(|answer| recorded(&answer, scheduler, seed).to_bytes().expect("finite"))
            };
            let one = bytes(1);
            assert!(one == bytes(2) && one == bytes(5), "{scheduler} {seed}");
        }
    }
}

#[test]
fn nothing_is_kept_unless_it_is_asked_for_and_answers_are_the_same() {
    let without = planner("sequence").seed(3).solve().expect("a path");
    let with = planner("sequence").seed(3).record().solve().expect("a path");
    assert!(without.record.is_none() && with.record.is_some());
    assert_eq!(without.report.fingerprint, with.report.fingerprint);
    assert_eq!(without.path, with.path);
    let recording = recorded(&Ok(without), "sequence", 3);
    assert!(recording.nodes.is_empty() && recording.head.funnel.is_empty());
    assert_eq!(recording, read_back(&recording));
}

#[test]
fn a_file_keeps_its_limit_and_says_what_is_left_out() {
    let whole = recorded(&planner("sequence").seed(2).record().solve(), "sequence", 2);
    let size = whole.to_bytes().expect("finite").len();
    let mut seen = HashSet::new();
    for limit in [size + 1000, size * 9 / 10, size / 2, size / 3] {
        let answer = planner("sequence").seed(2).record_within(limit as u64).solve();
        let recording = recorded(&answer, "sequence", 2);
        let bytes = recording.to_bytes().expect("finite").len();
        assert!(bytes <= limit, "{bytes} of {limit}");
        let left = recording.head.left_out;
        assert_eq!(left.nodes + recording.nodes.len() as u64, recording.head.counts.nodes);
        assert_eq!(recording.nodes.trees[..], whole.nodes.trees[..recording.nodes.len()]);
        assert_eq!(left.edges + recording.edges.len() as u64, whole.edges.len() as u64);
        let configurations = recording.nodes.configurations.len();
        assert_eq!(recording.nodes.configurations[..], whole.nodes.configurations[..configurations]);
        assert_eq!(recording, read_back(&recording));
        assert_eq!(recording.left_out().is_some(), limit < size);
        let _shown = recording.shown();
        seen.insert((left.nodes > 0, left.path));
    }
    assert!(seen.contains(&(false, false)) && seen.iter().any(|left| left.0), "{seen:?}");
    // What path files say of the models is always there.
    let tiny = recorded(&planner("sequence").seed(2).record_within(1).solve(), "sequence", 2);
    assert_eq!(tiny.head.path.parts, whole.head.path.parts);
    assert!(tiny.nodes.is_empty() && tiny.head.states.is_empty() && tiny.head.left_out.path);
    assert!(tiny.left_out().expect("much").contains("the path"), "{:?}", tiny.left_out());
    assert_eq!(tiny, read_back(&tiny));
}

#[test]
fn an_infeasible_start_is_recorded_with_the_pair_that_collides() {
    let mut problem = demo().problem.clone();
    problem.set_start("robot/left_shoulder_yaw", 0.3).expect("a joint");
    let (first, second) = (problem.robot.get(&problem.start, "box1").expect("a box"), "box2");
    problem.set_start(second, first).expect("a box");
    let answer = Planner::new(problem.clone()).expect("a model").record().solve();
    let recording = recorded::recorded_of(&problem, &answer, "sequence", 1);
    assert_eq!(recording.head.outcome, "infeasible_start");
    let finding = &recording.head.findings[0];
    assert_eq!(finding.at, "start");
    assert!(
        finding.links.as_ref().is_some_and(|links| links.iter().any(|link| link.starts_with("box"))),
        "{finding:?}"
    );
    assert!(finding.value.is_some_and(|distance| distance < 0.0));
    assert_eq!(recording.head.start.as_deref(), Some(problem.start.as_slice()));
    assert!(recording.words().iter().any(|words| words.contains("collide")), "{:?}", recording.words());
    assert_eq!(recording, read_back(&recording));
}

#[test]
fn a_crash_is_recorded_without_a_roadmap() {
    struct Panics;
    impl foliate::schedulers::Scheduler for Panics {
        fn name(&self) -> &'static str {
            "panics"
        }

        fn schedule(&self, _: &mut foliate::bevy_ecs::prelude::World) -> foliate::bevy_ecs::prelude::Schedule {
            std::panic::resume_unwind(Box::new("on purpose"))
        }
    }
    let answer = Planner::new(demo().problem.clone()).expect("a model").scheduler(Panics).record().solve();
    let recording = recorded(&answer, "panics", 1);
    assert_eq!(recording.head.outcome, "crashed");
    assert!(recording.nodes.is_empty() && recording.words()[0].contains("on purpose"));
    assert_eq!(recording, read_back(&recording));
}

#[test]
fn files_are_written_whole_and_read_back() {
    let folder = Folder::new("files");
    let recording = recorded(&failing("sequence", 1).record().solve(), "sequence", 1);
    let out = folder.0.join("failed.search");
    recording.save(&out).expect("it is written");
    assert!(Recording::is_one(&out));
    assert_eq!(Recording::read(&out).expect("it reads"), recording);
    // A path file is none, and is told from one by its format.
    let path = folder.0.join("path.json");
    save::save(&recording.head.path, &path).expect("it is written");
    assert!(!Recording::is_one(&path) && !Recording::is_one(&folder.0) && !Recording::is_one(&folder.0.join("none")));
    let refused = Recording::read(&path).expect_err("a path file").to_string();
    assert!(refused.contains("`foliate.path/2`") && refused.contains("foliate.search/1"), "{refused}");
}
