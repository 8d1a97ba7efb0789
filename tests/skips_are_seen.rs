//! Promise: a test that is skipped says so, although it passes and the harness swallows what passing tests print.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

#[path = "common/skip.rs"]
mod skip;

use std::process::Command;

#[test]
#[ignore = "run by the test below, in a process of its own"]
fn one_that_is_skipped() {
    skip::skipped(skip::Needs::System, "one_that_is_skipped", "it is an example");
    assert!(skip::python_with("no_such_module_of_python", "one that needs Python").is_none());
}

#[test]
fn a_skipped_test_is_seen_and_counted() {
    let file = std::env::temp_dir().join(format!("foliate-skipped-{}.txt", std::process::id()));
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "one_that_is_skipped", "--include-ignored"])
        .env("FOLIATE_SKIPPED_TESTS", &file)
        .output()
        .unwrap();
    assert!(output.status.success());
    let seen = String::from_utf8(output.stderr).unwrap();
    assert!(seen.contains("SKIPPED one_that_is_skipped: it is an example"), "{seen}");
    let counted = std::fs::read_to_string(&file).unwrap();
    std::fs::remove_file(&file).unwrap();
    let kinds: Vec<_> = counted.lines().map(|line| line.split('\t').next().unwrap()).collect();
    assert_eq!(kinds, ["system", "python"], "{counted}");
}
