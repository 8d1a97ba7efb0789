//! Promise: the pages that `foliate view` writes open in Chromium as people would see them: ready in time, drawn, moving along the path, the
//! constraint graph lit in step, without errors and without a request to anything, light and dark, on a phone.
//!
//! Screenshots and a table of sizes and times stay in `target/pages`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

use common::skip::browser;
use foliate::scene::shipped_scenes;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

/// Megabytes that a page may have.
const SIZES: [(&str, u64); 2] = [("baxter-", 3), ("romeo-", 6)];
const PATHS: [&str; 3] = ["demo", "stack", "drawer"];
const PATHS_WITH_MODELS: [&str; 3] = ["baxter-case4", "panda-box", "romeo-placard"];

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/pages").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs the program; `codes` are the exit codes that are right.
fn foliate(arguments: &[&str], codes: &[i32]) {
    let out = Command::new(env!("CARGO_BIN_EXE_foliate")).args(arguments).output().unwrap();
    let told = String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned();
    assert!(out.status.code().is_some_and(|code| codes.contains(&code)), "{arguments:?}: {told}");
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// The page of what `arguments` name.
fn page(folder: &Path, name: &str, arguments: &[&str]) -> PathBuf {
    let page = folder.join(format!("{name}.html"));
    foliate(&[&["view"], arguments, &["-o", text(&page)]].concat(), &[0]);
    let size = std::fs::metadata(&page).unwrap().len();
    let most = SIZES.iter().find(|(robot, _)| name.starts_with(robot)).map_or(6, |(_, megabytes)| *megabytes);
    assert!(size < most * 1_000_000, "{name}: {size} bytes, {most} MB are allowed");
    page
}

/// The page of a path of a scene.
fn path_page(folder: &Path, scene: &str) -> PathBuf {
    let path = folder.join(format!("{scene}.json"));
    foliate(&["solve", scene, "--seed", "1", "--out", text(&path)], &[0]);
    page(folder, &format!("{scene}-path"), &[text(&path)])
}

/// Opens the pages in Chromium and looks at them.
fn look(folder: &Path, pages: &[PathBuf], node: (&Path, &Path), chromium: &Path) {
    let (program, modules) = node;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("viewer/test/look.mjs");
    let mut command = Command::new(program);
    command.arg(script).arg(folder).args(pages);
    command.env("NODE_PATH", std::path::absolute(modules).unwrap()).env("FOLIATE_CHROMIUM", chromium);
    let out = command.output().unwrap();
    let told = String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned();
    assert!(out.status.success(), "{told}");
    println!("{told}");
}

/// One at a time: pages that are drawn in software side by side would all be late.
static LOOKING: Mutex<()> = Mutex::new(());

/// Writes pages and looks at them, where there are node and Chromium to look with.
fn seen(test: &str, write: impl Fn(&Path) -> Vec<PathBuf>) {
    let Some((node, modules, chromium)) = browser(test) else { return };
    let _alone = LOOKING.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = folder(test);
    look(&folder, &write(&folder), (&node, &modules), &chromium);
}

#[test]
fn paths_of_small_scenes_are_seen() {
    seen("paths_of_small_scenes_are_seen", |folder| PATHS.map(|scene| path_page(folder, scene)).to_vec());
}

#[test]
fn paths_of_published_robots_are_seen() {
    let test = "paths_of_published_robots_are_seen";
    if common::published_models(test).is_none() {
        return;
    }
    seen(test, |folder| PATHS_WITH_MODELS.map(|scene| path_page(folder, scene)).to_vec());
}

#[test]
fn small_scenes_are_seen() {
    seen("small_scenes_are_seen", |folder| {
        let small = shipped_scenes().iter().filter(|scene| !scene.needs_models);
        small.map(|scene| page(folder, scene.name, &[scene.name])).collect()
    });
}

#[test]
fn scenes_of_published_robots_are_seen() {
    let test = "scenes_of_published_robots_are_seen";
    if common::published_models(test).is_none() {
        return;
    }
    seen(test, |folder| {
        let published = shipped_scenes().iter().filter(|scene| scene.needs_models);
        published.map(|scene| page(folder, scene.name, &[scene.name])).collect()
    });
}

#[test]
fn a_model_alone_is_seen() {
    seen("a_model_alone_is_seen", |folder| {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/demo");
        let (urdf, srdf) = (scene.join("robot.urdf"), scene.join("robot.srdf"));
        vec![page(folder, "model", &[text(&urdf), "--srdf", text(&srdf)])]
    });
}

#[test]
fn a_search_that_fails_is_seen() {
    seen("a_search_that_fails_is_seen", |folder| {
        let record = folder.join("search.rec");
        foliate(&["solve", "stack", "--seed", "1", "--time-limit", "0.02", "--record", text(&record)], &[0, 1]);
        vec![page(folder, "search", &[text(&record)])]
    });
}
