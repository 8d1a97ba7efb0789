//! What must hold for every path that a solve writes: the whole way from a scene file to a proved path, and what other
//! eyes say of it.
#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]
#![allow(dead_code, reason = "each test uses its part")]

pub mod dense;
mod goal;
pub mod solve;

use super::random_scene::RandomScene;
use foliate::check::{CheckOptions, check};
use foliate::path_file::save;
use foliate::scene::PackagePath;
use solve::{Answer, Ended, solve};
use std::path::Path;

/// What became of a seed.
#[derive(Clone, Debug, PartialEq)]
pub enum Fate {
    /// A path was written, and everything holds.
    Proved,
    /// No path within the steps.
    Unsolved,
    /// Every attempt starts or ends where nothing may be.
    Infeasible(String),
    /// The scene is refused.
    Refused(String),
    /// A path was written, and something does not hold; or the program broke.
    Failed(String),
}

/// Attempts at a start and a goal that are free.
const ATTEMPTS: u64 = 40;

/// Draws the problem of a seed, solves it, and holds the answer against everything. All files stay in `folder`.
pub fn examine(seed: u64, folder: &Path) -> (RandomScene, Fate) {
    let scheduler = ["sequence", "mrrt", "portfolio"][(seed % 3) as usize];
    let mut attempt = 0;
    loop {
        let scene = RandomScene::new(seed, attempt);
        let _none = std::fs::remove_dir_all(folder);
        let scene_file = scene.write(folder).expect("a folder for the problem");
        let out = folder.join("path.json");
        let last = attempt + 1 == ATTEMPTS;
        let fate = match solve(&scene_file, scheduler, seed, 1, &out) {
            Err(error) => Fate::Failed(error),
            Ok(Ended::Refused(why)) if last => Fate::Refused(why),
            Ok(Ended::Infeasible(why)) if last => Fate::Infeasible(why),
            Ok(Ended::Refused(_) | Ended::Infeasible(_)) => {
                attempt += 1;
                continue;
            }
            Ok(Ended::Unsolved) => Fate::Unsolved,
            Ok(Ended::Solved(answer)) => match prove(&scene, &scene_file, scheduler, &answer) {
                Ok(()) => Fate::Proved,
                Err(why) => Fate::Failed(why),
            },
        };
        return (scene, fate);
    }
}

/// All that is promised of an answer.
fn prove(scene: &RandomScene, scene_file: &Path, scheduler: &str, answer: &Answer) -> Result<(), String> {
    checked(answer)?;
    goal::answers(scene, answer)?;
    dense::sampled(answer)?;
    let again = answer.out.with_file_name("two-threads.json");
    match solve(scene_file, scheduler, scene.seed, 2, &again)? {
        Ended::Solved(second) if second.bytes == answer.bytes => Ok(()),
        Ended::Solved(_) => Err("two-threads: another file than one thread".into()),
        _ => Err("two-threads: no answer where one thread has one".into()),
    }
}

/// Reads the path file again and proves it, as `foliate check` does.
fn checked(answer: &Answer) -> Result<(), String> {
    let file = save::read(&answer.out).map_err(|e| format!("check: cannot read: {e}"))?;
    let base = answer.out.parent().expect("a folder");
    let report = check(&file, base, &PackagePath::only(&[]), &CheckOptions::default())
        .map_err(|e| format!("check: cannot check: {e}"))?;
    if let Some(violation) = report.violations.first() {
        return Err(format!("check: {violation}"));
    }
    match (file.certificate.min_clearance, &report.min_clearance) {
        (Some(claim), Some(measured)) if claim > measured.value + 1e-9 => {
            Err(format!("claim: {claim:e} is claimed, {:e} measured at {}", measured.value, measured.subject))
        }
        (Some(claim), None) => Err(format!("claim: {claim:e} is claimed, no pair is measured")),
        (None, Some(measured)) => Err(format!("claim: nothing is claimed, {:e} is measured", measured.value)),
        _ => Ok(()),
    }
}
