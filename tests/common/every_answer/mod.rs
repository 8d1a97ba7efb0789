//! What must hold for every path that a solve writes: the whole way from a scene file to a proved path, and what other
//! eyes say of it.
#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]
#![allow(dead_code, reason = "each test uses its part")]

pub mod dense;
mod goal;
pub mod posts;
pub mod solve;

use super::random_scene::RandomScene;
use foliate::check::{CheckOptions, Verdict, check};
use foliate::path_file::save;
use foliate::scene::PackagePath;
use solve::{Answer, Ended, Wanted, solve};
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

/// The scheduler of a seed.
pub fn scheduler_of(seed: u64) -> &'static str {
    ["sequence", "mrrt", "portfolio"][(seed % 3) as usize]
}

/// Solves the problem of a seed, then the same with thin posts beside what its path swept, and compares that answer with
/// everything.
pub fn examine_among_posts(seed: u64, folder: &Path) -> (RandomScene, Fate) {
    let scheduler = scheduler_of(seed);
    let (bare, answer) = match first_answer(seed, Wanted::First, folder) {
        Ok(found) => found,
        Err((scene, fate)) => return (scene, fate),
    };
    let scene = posts::among_posts(&bare, &answer);
    let file = scene.write(folder).expect("a folder for the problem");
    let fate = match solve(&file, Wanted::Timed, (scheduler, seed), 1, &folder.join("path.json")) {
        Ok(Ended::Solved(answer)) => proved(&scene, &file, scheduler, &answer),
        Ok(Ended::Infeasible(why)) => Fate::Infeasible(why),
        Ok(Ended::Refused(why)) => Fate::Refused(why),
        Ok(Ended::Unsolved) => Fate::Unsolved,
        Err(why) => Fate::Failed(why),
    };
    (scene, fate)
}

/// Draws the problem of a seed, solves it, and checks the answer in every way. All files stay in `folder`.
pub fn examine(seed: u64, folder: &Path) -> (RandomScene, Fate) {
    match first_answer(seed, Wanted::Timed, folder) {
        Ok((scene, answer)) => {
            let fate = proved(&scene, &folder.join("scene.toml"), scheduler_of(seed), &answer);
            (scene, fate)
        }
        Err(ended) => ended,
    }
}

/// The first attempt of a seed that is solved, in `folder`; or what became of all.
#[allow(clippy::result_large_err, reason = "told once, by a test that ends")]
pub fn first_answer(
    seed: u64,
    wanted: Wanted,
    folder: &Path,
) -> Result<(RandomScene, Box<Answer>), (RandomScene, Fate)> {
    let (mut attempt, mut hard) = (0, 0);
    loop {
        let scene = RandomScene::new(seed, attempt);
        let _none = std::fs::remove_dir_all(folder);
        let scene_file = scene.write(folder).expect("a folder for the problem");
        attempt += 1;
        let last = attempt == ATTEMPTS;
        match solve(&scene_file, wanted, (scheduler_of(seed), seed), 1, &folder.join("path.json")) {
            Err(error) => return Err((scene, Fate::Failed(error))),
            Ok(Ended::Solved(answer)) => return Ok((scene, answer)),
            Ok(Ended::Refused(why)) if last => return Err((scene, Fate::Refused(why))),
            Ok(Ended::Infeasible(why)) if last => return Err((scene, Fate::Infeasible(why))),
            Ok(Ended::Refused(_) | Ended::Infeasible(_)) => {}
            Ok(Ended::Unsolved) => {
                hard += 1;
                if last || hard == HARD {
                    return Err((scene, Fate::Unsolved));
                }
            }
        }
    }
}

fn proved(scene: &RandomScene, file: &Path, scheduler: &str, answer: &Answer) -> Fate {
    let wrong = prove(scene, file, scheduler, answer);
    if wrong.is_empty() { Fate::Proved } else { Fate::Failed(wrong.join("; ")) }
}

/// All that is promised of an answer; what does not hold.
fn prove(scene: &RandomScene, scene_file: &Path, scheduler: &str, answer: &Answer) -> Vec<String> {
    let again = answer.out.with_file_name("two-threads.json");
    let second = match solve(scene_file, Wanted::Timed, (scheduler, scene.seed), 2, &again) {
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
    if report.verdict() != Verdict::Proved {
        told.push(format!("verdict: {:?}", report.verdict()));
    }
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
