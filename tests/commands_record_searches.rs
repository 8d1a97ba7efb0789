//! Promise: `--record` of `solve` and `demo`, and `--record-failures` of `bench`, write what the search did, whatever it found, without
//! changing what the command says and how it ends.

#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

#[path = "common/recorded.rs"]
mod recorded;

use foliate::recording::Recording;
use recorded::Folder;
use std::path::Path;
use std::process::{Command, Output};

fn foliate(arguments: &[&str], folder: &Folder) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
    command.args(arguments).current_dir(&folder.0).arg("--no-mesh-cache").output().expect("the program runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn read(folder: &Folder, name: &str) -> Recording {
    Recording::read(&folder.0.join(name)).expect("a recording")
}

#[test]
fn a_solved_search_and_its_path_lie_beside_each_other() {
    let folder = Folder::new("solved");
    let solve = |seed: &str, record: &[&str]| {
        let arguments = [&["solve", "demo", "--first", "--seed", seed, "--json"], record].concat();
        let output = foliate(&arguments, &folder);
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).expect("JSON")
    };
    let with = solve("5", &["--out", "path.json", "--record", "demo.search"]);
    let without = solve("5", &[]);
    assert_eq!(with["roadmap"], without["roadmap"]);
    let recording = read(&folder, "demo.search");
    assert_eq!(with["nodes"], recording.head.counts.nodes);
    let path = foliate::path_file::save::read(&folder.0.join("path.json")).expect("a path file");
    assert_eq!(recording.head.path.segments, path.segments);
    assert_eq!(recording.head.path.scene_file, path.scene_file);
    assert!(folder.0.join("demo.models/robot.urdf").is_file(), "models of the program lie beside the recording");
}

#[test]
fn failures_are_recorded_and_end_as_ever() {
    let folder = Folder::new("failures");
    let limited = [
        "solve",
        "demo",
        "--time-limit",
        "0.05",
        "--record",
        "late.search",
        "--scheduler",
        "mrrt",
        "--candidates",
        "1",
    ];
    let output = foliate(&limited, &folder);
    // In so little time most machines find nothing; the recording tells what was answered.
    let recording = read(&folder, "late.search");
    match output.status.code() {
        Some(0) => assert_eq!(recording.head.outcome, "solved"),
        code => assert_eq!((code, recording.head.outcome.as_str()), (Some(1), "timeout"), "{}", said(&output)),
    }

    let scene = include_str!("../scenes/demo/scene.toml");
    assert!(scene.contains("box1"), "the scene has boxes");
    let infeasible = infeasible_scene(&folder, scene);
    let output = foliate(&["solve", &infeasible, "--record", "stuck.search"], &folder);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    let recording = read(&folder, "stuck.search");
    assert_eq!(recording.head.outcome, "infeasible_start");
    assert!(recording.head.findings.iter().any(|finding| finding.links.is_some()), "{:?}", recording.head.findings);
}

/// The demo with one box where the other is.
fn infeasible_scene(folder: &Folder, scene: &str) -> String {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/demo");
    for entry in std::fs::read_dir(source).expect("the scene's folder") {
        let path = entry.expect("an entry").path();
        std::fs::copy(&path, folder.0.join(path.file_name().expect("a name"))).expect("it is copied");
    }
    let mut document: toml::Table = toml::from_str(scene).expect("TOML");
    let start = document.get_mut("start").and_then(toml::Value::as_table_mut).expect("a start");
    let place = start.get("box1").expect("a box").clone();
    start.insert("box2".into(), place);
    document.insert("name".into(), "stuck".into());
    std::fs::write(folder.0.join("stuck.toml"), toml::to_string(&document).expect("TOML")).expect("it is written");
    "stuck.toml".into()
}

#[test]
fn a_place_that_cannot_be_written_is_refused_before_anything_is_searched() {
    let folder = Folder::new("place");
    for command in [&["solve", "demo"][..], &["demo"]] {
        let output = foliate(&[command, &["--record", "missing/demo.search"]].concat(), &folder);
        assert_eq!(output.status.code(), Some(2));
        assert!(said(&output).contains("missing/demo.search") && output.stdout.is_empty(), "{}", said(&output));
    }
    assert_eq!(foliate(&["solve", "demo", "--record-limit", "3"], &folder).status.code(), Some(2));
}

#[test]
fn a_bench_records_its_failures_and_counts_them() {
    let folder = Folder::new("bench");
    let stuck = infeasible_scene(&folder, include_str!("../scenes/demo/scene.toml"));
    let bench = |scenes: &[&str], out: &str| {
        let arguments = ["--seeds", "1..3", "--out", out, "--record-failures", "failed", "--threads", "2"];
        foliate(&[&["bench"], scenes, &arguments].concat(), &folder)
    };
    let output = bench(&["demo"], "good");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(said(&output).contains("0 of 0 failed solves are recorded in failed"), "{}", said(&output));
    assert_eq!(std::fs::read_dir(folder.0.join("failed")).expect("it is made").count(), 0);

    let output = bench(&["demo", &stuck], "bad");
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("3 of 3 failed solves are recorded in failed"), "{}", said(&output));
    for seed in 1..=3_u64 {
        let recording = read(&folder, &format!("failed/stuck-{seed}.search"));
        assert_eq!((recording.head.path.seed, recording.head.outcome.as_str()), (seed, "infeasible_start"));
    }
    let recordings = recordings_in(&folder.0.join("failed"));
    assert_eq!(recordings.len(), 3, "{recordings:?}");
}

/// Recordings in a folder.
fn recordings_in(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").file_name());
    names.filter_map(|name| name.into_string().ok()).filter(|name| name.ends_with(".search")).collect()
}
