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
/// Attempts that may be too hard.
const HARD: u64 = 3;

/// Draws the problem of a seed, solves it, and holds the answer against everything. All files stay in `folder`.
pub fn examine(seed: u64, folder: &Path) -> (RandomScene, Fate) {
    let scheduler = ["sequence", "mrrt", "portfolio"][(seed % 3) as usize];
    let (mut attempt, mut hard) = (0, 0);
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
            Ok(Ended::Unsolved) => {
                hard += 1;
                attempt += 1;
                if last || hard == HARD {
                    return (scene, Fate::Unsolved);
                }
                continue;
            }
            Ok(Ended::Solved(answer)) => {
                let wrong = prove(&scene, &scene_file, scheduler, &answer);
                if wrong.is_empty() { Fate::Proved } else { Fate::Failed(wrong.join("; ")) }
            }
        };
        return (scene, fate);
    }
}

/// All that is promised of an answer; what does not hold.
fn prove(scene: &RandomScene, scene_file: &Path, scheduler: &str, answer: &Answer) -> Vec<String> {
    let again = answer.out.with_file_name("two-threads.json");
    let second = match solve(scene_file, scheduler, scene.seed, 2, &again) {
        Ok(Ended::Solved(second)) if second.bytes == answer.bytes => Ok(()),
        Ok(Ended::Solved(_)) => Err("two-threads: another file than one thread".into()),
        Ok(_) => Err("two-threads: no answer where one thread has one".into()),
        Err(why) => Err(why),
    };
    let found = [checked(answer), goal::answers(scene, answer), dense::sampled(answer), second];
    found.into_iter().filter_map(Result::err).collect()
}

/// Reads the path file again and proves it, as `foliate check` does. Of each kind of violation the first is told.
fn checked(answer: &Answer) -> Result<(), String> {
    let file = save::read(&answer.out).map_err(|e| format!("check: cannot read: {e}"))?;
    let base = answer.out.parent().expect("a folder");
    let report = check(&file, base, &PackagePath::only(&[]), &CheckOptions::default())
        .map_err(|e| format!("check: cannot check: {e}"))?;
    let mut told: Vec<String> = Vec::new();
    for (index, violation) in report.violations.iter().enumerate() {
        if !report.violations[..index].iter().any(|earlier| earlier.kind == violation.kind) {
            told.push(format!("check: {violation}"));
        }
    }
    match (file.certificate.min_clearance, &report.min_clearance) {
        (Some(claim), Some(measured)) if claim > measured.value + 1e-9 => {
            told.push(format!("claim: {claim:e} is claimed, {:e} measured at {}", measured.value, measured.subject));
        }
        (Some(claim), None) => told.push(format!("claim: {claim:e} is claimed, no pair is measured")),
        (None, Some(measured)) => told.push(format!("claim: nothing is claimed, {:e} is measured", measured.value)),
        _ => {}
    }
    if told.is_empty() { Ok(()) } else { Err(told.join("; ")) }
}
