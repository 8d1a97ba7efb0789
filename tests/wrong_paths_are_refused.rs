//! The check must be able to refuse: paths of random problems, spoiled in a random place, and shown to be wrong by how they
//! were spoiled or by dense samples, are refused with the right reason.
//!
//! `FOLIATE_PROBLEMS=1000 cargo test --release --test wrong_paths_are_refused -- --nocapture` is the long run.

#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

#[path = "common/every_answer/mod.rs"]
mod every_answer;
#[path = "common/random_scene/mod.rs"]
mod random_scene;
#[path = "common/spoil/mod.rs"]
mod spoil;

use every_answer::first_answer;
use every_answer::solve::Wanted;
use foliate::check::{CheckOptions, CheckReport, SceneChoice, check};
use foliate::scene::PackagePath;
use spoil::{SPOILERS, Spoiled, without_times};
use std::collections::BTreeMap;
use std::path::Path;

/// Problems whose answers are spoiled where nothing else is wished for.
const PROBLEMS: u64 = 150;

fn report(folder: &Path, spoiled: &Spoiled) -> CheckReport {
    let scene = if spoiled.alone { SceneChoice::Nothing } else { SceneChoice::Named };
    let options = CheckOptions { scene, ..CheckOptions::default() };
    check(&spoiled.file, folder, &PackagePath::only(&[]), &options).expect("a spoiled path is still a path file")
}

#[test]
fn a_path_that_is_spoiled_anywhere_is_refused() {
    let wanted = std::env::var("FOLIATE_PROBLEMS").ok().map(|n| n.parse().expect("a number"));
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("spoiled-{}", std::process::id()));
    let (mut counts, mut wrong) = (BTreeMap::<&str, usize>::new(), Vec::new());
    for seed in 0..wanted.unwrap_or(PROBLEMS) {
        let folder = root.join("problem");
        let Ok((scene, mut answer)) = first_answer(seed, Wanted::First, &folder) else { continue };
        without_times(&mut answer.file);
        for (name, spoiler) in SPOILERS {
            let mut draw = random_scene::draw::Draw::new(seed, 500);
            let Some(spoiled) = spoiler(&mut draw, &scene, &answer, &folder) else { continue };
            *counts.entry(name).or_default() += 1;
            let report = report(&folder, &spoiled);
            if !report.violations.iter().any(|v| spoiled.kinds.contains(&v.kind)) {
                let found: Vec<String> = report.violations.iter().map(ToString::to_string).collect();
                wrong.push(format!("seed {seed}, {name}: {}; found {found:?}", spoiled.how));
            }
        }
    }
    eprintln!("spoiled paths by kind: {counts:?}");
    let _gone = std::fs::remove_dir_all(root);
    assert!(wrong.is_empty(), "{} spoiled paths are not refused: {wrong:#?}", wrong.len());
    for (name, _) in SPOILERS {
        assert!(counts.contains_key(name), "nothing was spoiled by `{name}`");
    }
}
