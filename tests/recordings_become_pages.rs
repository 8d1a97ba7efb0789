//! Promise: the page of a recording shows the roadmap, the funnel with the pairs that collided, what is wrong with an infeasible start, and
//! the path; it needs nothing but the recording and the models that it names.

#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/recorded.rs"]
mod recorded;

use foliate::components::robot::CoordinateValue;
use foliate::path_file::{LoadedPath, PathContext, save};
use foliate::recording::Recording;
use foliate::scene::PackagePath;
use foliate::view::{Document, Page, PageKind, ViewOptions, Visuals, WhereEntry, page_of_recording};
use foliate::{NoSolution, Planner, Solution};
use recorded::{Folder, demo, planner};
use std::path::Path;

/// Saves the recording of an answer and makes a page of the file.
fn page(
    folder: &Folder,
    problem: &foliate::prelude::Problem,
    answer: &Result<Solution, NoSolution>,
) -> (Recording, Page) {
    let graph = match answer {
        Ok(solution) => &solution.model.graph,
        Err(none) => &none.model.graph,
    };
    let out = folder.0.join("search.search");
    let models = save::model_names(demo(), &out).expect("names");
    let context = PathContext { problem, graph, models: &models, seed: 4, scheduler: "mrrt", simd: "any" };
    Recording::of(&context, answer).save(&out).expect("it is written");
    let recording = Recording::read(&out).expect("it reads");
    let packages = PackagePath::default();
    let path = LoadedPath::of_file(&recording.head.path, &folder.0, &packages).expect("models");
    let visuals = Visuals::of_path(&path, &packages).expect("models");
    let page = page_of_recording(&recording, &path, &visuals, &ViewOptions::default()).expect("a page");
    (recording, page)
}

fn words(page: &Page, offset: usize, count: usize) -> Vec<u32> {
    let bytes = &page.blob.bytes()[offset..][..4 * count];
    bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

fn floats(page: &Page, offset: usize, count: usize) -> Vec<f32> {
    words(page, offset, count).into_iter().map(f32::from_bits).collect()
}

/// What holds of every page of a recording that is shown whole.
fn shows(recording: &Recording, page: &Page) {
    let document: &Document = &page.document;
    let search = document.search.as_ref().expect("a search");
    assert_eq!((document.kind, search.count), (PageKind::Search, recording.nodes.len()));
    assert_eq!(search.outcome, recording.head.outcome);
    assert_eq!(words(page, search.step, search.count), recording.nodes.steps);
    let ends = words(page, search.edges, 2 * search.edge_count);
    assert!(ends.iter().all(|&node| (node as usize) < search.count));
    assert_eq!(search.edge_count, recording.head.counts.edges as usize);
    assert!(words(page, search.edge_step, search.edge_count).is_sorted());
    // Each coordinate of the page has the number that the recording has for its name.
    let (size, width) = (document.coordinates.len(), recording.head.width);
    let nodes = floats(page, search.nodes, search.count * size);
    for (place, name) in document.coordinates.iter().enumerate() {
        let column = recording.head.path.coordinates.iter().position(|other| other == name).expect("it is named");
        for node in 0..search.count {
            assert_eq!(nodes[node * size + place], recording.nodes.configurations[node * width + column], "{name}");
        }
    }
    let graph = document.graph.as_ref().expect("a graph");
    let states = words(page, search.state, search.count.div_ceil(2));
    for node in 0..search.count {
        let place = (states[node / 2] >> (16 * (node % 2)) & 0xffff) as usize;
        let recorded = &recording.head.states[recording.nodes.states[node] as usize];
        assert_eq!((graph.states[place].id, &graph.states[place].name), (recorded.id, &recorded.name));
    }
    for row in &recording.head.funnel {
        let transition = &recording.head.transitions[row.transition as usize];
        let shown = graph.transitions.iter().find(|shown| shown.id == transition.id).expect("it is shown");
        assert_eq!(
            (shown.name.as_str(), shown.tried, shown.succeeded),
            (transition.name.as_str(), Some(row.tried), Some(row.reached))
        );
        assert_eq!(shown.waypoints, transition.waypoints);
    }
    let html = page.html().expect("a page");
    assert!(html.starts_with("<!") && html.len() < 4 << 20);
}

#[test]
fn a_failed_search_shows_its_roadmap_its_funnel_and_what_collided() {
    let folder = Folder::new("page-failed");
    let settings = foliate::systems::settings::SearchSettings::default().with(|s| s.max_steps = 8);
    let answer = planner("mrrt").settings(settings).seed(4).record().solve();
    assert!(answer.is_err());
    let (recording, page) = page(&folder, &demo().problem, &answer);
    shows(&recording, &page);
    let document = &page.document;
    assert!(document.path.is_none() && document.start.as_deref() == Some(demo().problem.start.as_slice()));
    let search = document.search.as_ref().expect("a search");
    assert_eq!(search.funnel.len(), recording.head.funnel.len());
    let pairs: Vec<_> = search.funnel.iter().flat_map(|row| &row.pairs).collect();
    assert_eq!(pairs.len(), recording.head.funnel.iter().map(|row| row.pairs.len()).sum::<usize>());
    assert!(pairs.len() > 3 && pairs.iter().all(|pair| pair.links.iter().all(|&link| link < document.links.len())));
    assert!(
        pairs.iter().all(|pair| pair.configuration.as_ref().is_some_and(|q| q.len() == document.coordinates.len()))
    );
    assert!(search.words.iter().any(|words| words.contains("the step limit was reached")), "{:?}", search.words);
}

#[test]
fn a_solved_search_shows_its_path_too() {
    let folder = Folder::new("page-solved");
    let answer = planner("mrrt").seed(4).record().solve();
    let (recording, page) = page(&folder, &demo().problem, &answer);
    shows(&recording, &page);
    let path = page.document.path.as_ref().expect("a path");
    assert_eq!(path.segments.len(), recording.head.path.segments.len());
}

#[test]
fn an_infeasible_start_shows_the_pair_that_collides() {
    let folder = Folder::new("page-infeasible");
    let mut problem = demo().problem.clone();
    let place = problem.robot.get(&problem.start, "box1").expect("a box");
    problem.set_start("box2", place).expect("a box");
    let answer = Planner::new(problem.clone()).expect("a model").record().solve();
    let (recording, page) = page(&folder, &problem, &answer);
    let document = &page.document;
    assert_eq!(document.collisions.len(), recording.head.findings.len());
    let collision = &document.collisions[0];
    assert_eq!(collision.configuration, WhereEntry::Named("start"));
    let names = collision.links.map(|link| document.links[link].name.as_str());
    assert!(names.iter().all(|name| name.starts_with("box")), "{names:?}");
    assert!(collision.depth.is_some_and(|depth| depth > 0.0) && collision.point.is_some(), "{collision:?}");
    assert_eq!(document.search.as_ref().map(|search| search.count), Some(0));
}

#[test]
fn an_infeasible_bound_shows_its_number() {
    let folder = Folder::new("page-bound");
    let mut problem = demo().problem.clone();
    problem.set_start("robot/left_shoulder_yaw", 9.0).expect("a joint");
    let answer = Planner::new(problem.clone()).expect("a model").record().solve();
    let (_, page) = page(&folder, &problem, &answer);
    let violation = &page.document.violations[0];
    assert_eq!(violation.value, Some(9.0));
    assert!(violation.limit.is_some_and(|limit| limit < 9.0) && violation.joint.is_some());
    assert!(violation.words.contains("robot/left_shoulder_yaw"), "{}", violation.words);
}

/// Two boxes in the air: the first 30 cm above its place, the second 20 cm.
#[test]
fn objects_that_lie_in_no_state_show_the_way_to_where_they_would_have_to_be() {
    let folder = Folder::new("page-misplaced");
    let mut problem = demo().problem.clone();
    let start = problem.start.clone();
    for (name, lift) in [("box1", 0.3), ("box2", 0.2)] {
        let Some(CoordinateValue::Pose(mut pose)) = problem.robot.get(&start, name).ok() else { panic!("a pose") };
        pose.translation.z += lift;
        problem.set_start(name, pose).expect("a box");
    }
    let answer = Planner::new(problem.clone()).expect("a model").record().solve();
    let (_, page) = page(&folder, &problem, &answer);
    let violations = &page.document.violations;
    assert_eq!(violations.len(), 2, "{violations:?}");
    assert!(violations[0].words.contains("Nearest: `box1` is 300.00 mm"), "{}", violations[0].words);
    assert!(violations[1].words.contains("`box2` is 200.00 mm"), "{}", violations[1].words);
    for (violation, (name, lift)) in violations.iter().zip([("box1", 0.3), ("box2", 0.2)]) {
        let [here, there] = violation.points.expect("a way");
        let off = [0, 1, 2].map(|axis| there[axis] - here[axis]);
        assert!(off[0].abs() < 1e-6 && off[1].abs() < 1e-6 && (off[2] + lift).abs() < 1e-6, "{off:?}");
        assert!(violation.angle.is_some_and(|angle| angle < 1e-6));
        let links = violation.links.as_ref().expect("links");
        assert!(links.iter().all(|&link| page.document.links[link].name.starts_with(name)), "{links:?}");
    }
}

#[test]
fn the_program_tells_a_recording_from_a_scene_and_a_path() {
    let folder = Folder::new("page-program");
    let run = |arguments: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_foliate"));
        command.args(arguments).current_dir(&folder.0).output().expect("the program runs")
    };
    let solved = run(&["solve", "demo", "--first", "--record", "demo.search"]);
    assert_eq!(solved.status.code(), Some(0));
    let viewed = run(&["view", "demo.search", "-o", "page.html"]);
    assert_eq!(viewed.status.code(), Some(0), "{}", String::from_utf8_lossy(&viewed.stderr));
    assert!(std::fs::read_to_string(folder.0.join("page.html")).expect("a page").starts_with("<!"));
    // Cut off behind its head it is refused, whatever it is called.
    let bytes = std::fs::read(folder.0.join("demo.search")).expect("a recording");
    std::fs::write(folder.0.join("cut.json"), &bytes[..bytes.len() - 9]).expect("it is written");
    let refused = run(&["view", "cut.json", "-o", "none.html"]);
    let told = String::from_utf8_lossy(&refused.stderr);
    assert!(refused.status.code() == Some(2) && told.contains("are announced"), "{told}");
    assert!(!Path::new(&folder.0.join("none.html")).exists());
}
