//! Promise: help lists what a user sets; options that change how a search works are shown by `--help-search` alone, and work as ever.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use std::process::Command;

fn run(arguments: &[&str]) -> (Option<i32>, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_foliate")).args(arguments).output().unwrap();
    (done.status.code(), String::from_utf8(done.stdout).unwrap())
}

/// Options of the search itself.
const INTERNALS: [&str; 5] = ["--candidates", "--selection", "--loop-weight", "--scheduler", "--simd"];

#[test]
fn internals_are_shown_where_they_are_asked_for() {
    for command in ["solve", "demo", "bench"] {
        for help in ["-h", "--help"] {
            let (code, text) = run(&[command, help]);
            assert_eq!(code, Some(0));
            assert!(text.contains("--time-limit") && text.contains("--help-search"), "{text}");
            assert!(INTERNALS.iter().all(|option| !text.contains(option)), "{command} {help}:\n{text}");
        }
        let (code, text) = run(&[command, "--help-search"]);
        assert_eq!(code, Some(0));
        assert!(INTERNALS.iter().all(|option| text.contains(option)), "{command}:\n{text}");
        assert!(!text.contains("--time-limit"), "{text}");
    }
}

#[test]
fn what_a_solve_writes_comes_first() {
    let (_, text) = run(&["solve", "--help"]);
    let place = |option: &str| text.find(option).unwrap_or_else(|| panic!("{option}:\n{text}"));
    assert!(place("--out") < place("--time-limit") && place("--time-limit") < place("--threads"), "{text}");
}

#[test]
fn hidden_options_are_read() {
    let (code, _) =
        run(&["solve", "demo", "--first", "--scheduler", "mrrt", "--candidates", "8", "--selection", "leaf-first"]);
    assert_eq!(code, Some(0));
    assert_eq!(run(&["solve", "demo", "--selection", "sideways"]).0, Some(2));
}
