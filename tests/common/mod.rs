//! What several tests share: where published models are, and how a test says that it was skipped.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]
#![allow(dead_code, reason = "each test uses its part")]

pub mod skip;
pub mod timed;

use foliate::scene::PackagePath;
use skip::{Needs, skipped};
use std::path::{Path, PathBuf};

/// The packages that `foliate models --install` fetches.
pub const PACKAGES: [&str; 3] = ["example-robot-data", "hpp_environments", "hpp_tutorial"];

/// The search list, where it leads to all published packages; otherwise says that the test is skipped.
pub fn published_models(test: &str) -> Option<PackagePath> {
    let path = PackagePath::from_environment(&[]);
    match PACKAGES.iter().find(|p| path.find(p).is_none()) {
        Some(missing) => {
            skipped(Needs::Models, test, &format!("package {missing} is not at hand (foliate models --install)"));
            None
        }
        None => Some(path),
    }
}

/// Files below a directory whose names end so, sorted.
pub fn files_below(directory: &Path, ending: &str) -> Vec<PathBuf> {
    let (mut found, mut stack) = (Vec::new(), vec![directory.to_owned()]);
    while let Some(directory) = stack.pop() {
        for entry in std::fs::read_dir(&directory).into_iter().flatten().flatten() {
            match entry.file_type() {
                Ok(kind) if kind.is_dir() => stack.push(entry.path()),
                Ok(kind) if kind.is_file() && entry.file_name().to_string_lossy().ends_with(ending) => {
                    found.push(entry.path());
                }
                _ => {}
            }
        }
    }
    found.sort();
    found
}
