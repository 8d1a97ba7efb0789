//! How a test says that it is skipped, so that people see it. Tests of other packages include this file by its path.
#![allow(dead_code, reason = "each test uses its part")]

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What a skipped test would need.
#[derive(Clone, Copy, Debug)]
pub enum Needs {
    /// Published robot models (`foliate models --install`).
    Models,
    /// Python packages: pinocchio, coal.
    Python,
    /// Something that this system does not have or allow: mounting, devices.
    System,
}

/// Says that a test is skipped. The line goes past the harness, which swallows what a passing test prints; and to the file that
/// `FOLIATE_SKIPPED_TESTS` names, for a summary at the end of a run.
pub fn skipped(needs: Needs, test: &str, why: &str) {
    let mut stderr = std::io::stderr();
    let _seen = writeln!(stderr, "SKIPPED {test}: {why}");
    let Some(file) = std::env::var_os("FOLIATE_SKIPPED_TESTS") else { return };
    let open = std::fs::File::options().create(true).append(true).open(&file);
    let line = format!("{}\t{test}: {why}\n", format!("{needs:?}").to_lowercase());
    // A summary without this line would say too little: better no run at all.
    assert!(open.is_ok_and(|mut file| file.write_all(line.as_bytes()).is_ok()), "{} is not written", file.display());
}

/// The interpreter that has these Python modules: `FOLIATE_PYTHON`, or `python3`. Without them it says that the test is skipped.
pub fn python_with(modules: &str, test: &str) -> Option<PathBuf> {
    let python = std::env::var_os("FOLIATE_PYTHON").map_or(PathBuf::from("python3"), PathBuf::from);
    if imports(&python, modules) {
        return Some(python);
    }
    let why = format!("{} has no {modules} (pip install pin coal numpy)", python.display());
    skipped(Needs::Python, test, &why);
    None
}

fn imports(python: &Path, modules: &str) -> bool {
    Command::new(python).args(["-c", &format!("import {modules}")]).output().is_ok_and(|o| o.status.success())
}
