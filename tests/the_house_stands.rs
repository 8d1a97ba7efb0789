//! The layout is a promise too: layers, and what is absent from them (ARCHITECTURE.md).

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// All Rust files below a folder, tests aside.
fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap().map(Result::unwrap) {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                found.push((path, text));
            }
        }
    }
    assert!(!found.is_empty(), "{folder} has no sources");
    found
}

fn assert_absent(folder: &str, words: &[&str], except: &[&str]) {
    for (path, text) in sources(folder) {
        if except.iter().any(|e| path.ends_with(e)) {
            continue;
        }
        for (number, line) in text.lines().enumerate().filter(|(_, l)| !l.trim_start().starts_with("//")) {
            for word in words {
                assert!(!line.contains(word), "{}:{}: `{word}`", path.display(), number + 1);
            }
        }
    }
}

#[test]
fn only_the_outer_ring_opens_files() {
    for folder in ["components/src", "systems/src", "systems/kernels/src", "systems/schedulers/src"] {
        assert_absent(folder, &["std::fs", "File::open", "std::net", "std::process"], &[]);
    }
}

#[test]
fn only_one_file_writes_the_roadmap() {
    let writes = [".push_node(", ".push_edge(", "spawn(RoadmapLeaf"];
    assert_absent("systems/src", &writes, &["exploration/writer.rs", "exploration/roadmap_query.rs"]);
    assert_absent("systems/schedulers/src", &writes, &[]);
}

/// A proof that shares code with the search shares its mistakes.
#[test]
fn the_checker_shares_no_code_with_the_search() {
    // Its tests hold it against the search.
    assert_absent("src/check", &["foliate_systems", "foliate_kernels", "parry"], &["distance/tests.rs"]);
}

#[test]
fn clocks_do_not_reach_the_search() {
    // The deadline is checked in one place; nothing else may know the time.
    assert_absent("systems/src", &["Instant::now", "SystemTime"], &["events.rs"]);
    assert_absent("systems/schedulers/src", &["Instant", "SystemTime"], &[]);
    assert_absent("systems/kernels/src", &["Instant", "SystemTime"], &[]);
    assert_absent("components/src", &["Instant", "SystemTime"], &[]);
}

/// Outside `lanes/` no file names a set of instructions, or the crate that provides them.
#[test]
fn only_the_lanes_know_instruction_sets() {
    let sets = [
        "fearless_simd",
        "avx",
        "Avx",
        "sse2",
        "Sse2",
        "sse4",
        "Sse4",
        "neon",
        "Neon",
        "target_feature",
        "core::arch",
        "std::arch",
    ];
    for folder in ["components/src", "systems/src", "systems/schedulers/src", "src", "benches", "examples"] {
        assert_absent(folder, &sets, &[]);
    }
    for folder in ["collision", "constrained_motion", "constraints", "kinematics", "linear", "nearest"] {
        assert_absent(&format!("systems/kernels/src/{folder}"), &sets, &[]);
    }
}

#[test]
fn the_kernels_build_without_bevy() {
    let output = Command::new(env!("CARGO"))
        .args([
            "tree",
            "--offline",
            "--locked",
            "--edges",
            "normal",
            "--package",
            "foliate_kernels",
            "--prefix",
            "none",
        ])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let tree = String::from_utf8(output.stdout).unwrap();
    assert!(tree.contains("foliate_components"), "the tree is not that of the kernels:\n{tree}");
    for absent in ["bevy", "rayon", "clap", "serde_json", "urdf-rs"] {
        assert!(!tree.lines().any(|l| l.starts_with(absent)), "the kernels depend on {absent}");
    }
}

/// Each set of features compiles no crate that it does not need.
#[test]
fn features_bring_only_what_they_need() {
    let files = ["roxmltree", "toml ", "serde_json", "sha2"];
    let command_line = ["clap", "indicatif", "mimalloc", "signal-hook", "nix"];
    let export = ["mcap", "zip"];
    let view = ["dagre", "miniz_oxide"];
    let report = ["plotters", "plotters-svg"];
    let sets: [(&str, Vec<&str>, Vec<&str>); 7] = [
        ("", vec!["bevy_ecs", "glam"], [files.as_slice(), &command_line, &export, &["urdf-rs"]].concat()),
        ("check", files.to_vec(), [command_line.as_slice(), &export, &report, &view, &["urdf-rs"]].concat()),
        (
            "report",
            [files.as_slice(), &report].concat(),
            [command_line.as_slice(), &export, &view, &["font-kit", "image", "urdf-rs"]].concat(),
        ),
        (
            "export",
            [files.as_slice(), &export].concat(),
            [command_line.as_slice(), &["urdf-rs", "zstd", "lz4"]].concat(),
        ),
        ("view", [files.as_slice(), &view].concat(), [command_line.as_slice(), &export, &["urdf-rs"]].concat()),
        ("cli", [command_line.as_slice(), &export, &report, &view].concat(), vec!["urdf-rs"]),
        ("urdf-rs", vec!["urdf-rs"], [command_line.as_slice(), &export].concat()),
    ];
    for (features, present, absent) in sets {
        let output = Command::new(env!("CARGO"))
            .args(["tree", "--offline", "--locked", "--edges", "normal,no-proc-macro", "--package", "foliate"])
            .args(["--prefix", "none", "--no-default-features", "--features", features])
            .current_dir(root())
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let tree = String::from_utf8(output.stdout).unwrap();
        let has = |name: &&str| tree.lines().any(|line| line.starts_with(*name));
        assert!(present.iter().all(has), "`{features}` brings not all of {present:?}");
        assert!(!absent.iter().any(has), "`{features}` brings one of {absent:?}");
    }
}

/// A folder that ARCHITECTURE.md does not mention is hard to find: every folder, and every file at the top of a crate.
#[test]
fn the_architecture_page_names_every_folder() {
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let is_part_of_word = |c: char| c.is_alphanumeric() || c == '_';
    let words: HashSet<&str> = page.split(|c: char| !is_part_of_word(c)).collect();
    let mut missing = Vec::new();
    for folder in ["components/src", "systems/src", "systems/kernels/src", "systems/schedulers/src", "src"] {
        name_folders(&root().join(folder), true, &mut |path, name| {
            if !["lib", "main", "mod"].contains(&name) && !words.contains(name) {
                missing.push(path.to_owned());
            }
        });
    }
    assert!(missing.is_empty(), "ARCHITECTURE.md does not mention {missing:#?}");
}

/// Calls `named` with each folder below, and each file at the top.
fn name_folders(folder: &Path, at_top: bool, named: &mut dyn FnMut(&Path, &str)) {
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let path = entry.path();
        if path.is_dir() || at_top {
            named(&path, &path.file_stem().unwrap().to_string_lossy());
        }
        if path.is_dir() {
            name_folders(&path, false, named);
        }
    }
}
