//! A path that Foliate writes is certified as it is checked: both prove it, and both find a knot that was moved into something.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/written.rs"]
mod written;

use foliate::Planner;
use foliate::certify::formats::{ReadOptions, read};
use foliate::certify::{Certifier, CertifyOptions, CertifyReport, Verdict};
use foliate::check::{CheckOptions, Kind, check};
use foliate::kernels::collision::CollisionScratch;
use foliate::path_file::{PathFile, save};
use foliate::scene::{PackagePath, Scene};
use foliate::systems::settings::SearchSettings;
use std::path::Path;
use written::written;

/// A planned path of an embedded scene, with the models beside it.
fn planned(scene: &str, seed: u64, file: &Path) -> PathFile {
    let scene = Scene::load(scene, &PackagePath::only(&[])).unwrap();
    let settings = SearchSettings::default().with(|s| s.seed = seed);
    // Knots will be put in between: only a path without times takes them.
    let planner = Planner::new(scene.problem.clone()).unwrap().settings(settings).first_path();
    let solution = planner.solve().unwrap();
    written(&scene, &solution.model.graph, &solution.path, file)
}

fn certified(scene: &str, file: &Path) -> CertifyReport {
    let scene = Scene::load(scene, &PackagePath::only(&[])).unwrap();
    let certifier = Certifier::new(&scene.problem, &[]).unwrap();
    let motion = read(file, certifier.robot(), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    certifier.certify(&motion, &CertifyOptions::default(), &mut CollisionScratch::new()).unwrap()
}

/// What the checker finds.
fn found(file: &PathFile, folder: &Path) -> Vec<Kind> {
    let report = check(file, folder, &PackagePath::only(&[]), &CheckOptions::default()).unwrap();
    report.violations.iter().map(|v| v.kind).collect()
}

#[test]
fn both_prove_what_is_planned_and_both_find_what_is_spoiled() {
    let folder = std::env::temp_dir().join(format!("foliate-certify-check-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (mut spoiled, mut compared) = (0, 0);
    for (scene, seed) in [("demo", 1), ("demo", 2), ("stack", 1), ("stack", 2)] {
        let file = folder.join(format!("{scene}-{seed}.json"));
        let path = planned(scene, seed, &file);
        save::save(&path, &file).unwrap();
        assert_eq!(found(&path, &folder), [], "{scene} {seed}");
        let report = certified(scene, &file);
        assert!(report.passed(), "{scene} {seed}: {report:?}");
        assert!(report.pairs.tested > 100, "{scene}: {:?}", report.pairs);
        // A knot in the middle of a segment that leans far over: often into something.
        let joint = path.coordinates.iter().position(|c| c == "robot/left_shoulder_pitch").unwrap();
        for segment in 0..path.segments.len() {
            let mut bent = path.clone();
            let knots = &mut bent.segments[segment].knots;
            let mut middle = knots[0].clone();
            middle[joint] += 0.9;
            knots.insert(1, middle);
            save::save(&bent, &file).unwrap();
            let (contact, found) = (certified(scene, &file).verdict == Verdict::Contact, found(&bent, &folder));
            let collides = found.iter().any(|kind| matches!(kind, Kind::Collision | Kind::Enclosed));
            assert!(contact || !collides, "{scene} {seed} {segment}: {found:?}");
            // A checker that finds an object off its carrier, or a joint off its limits, need not look for collisions as well.
            if found.iter().all(|kind| matches!(kind, Kind::Collision | Kind::Enclosed)) {
                assert_eq!(contact, collides, "{scene} {seed} {segment}");
                compared += 1;
            }
            spoiled += usize::from(contact);
        }
    }
    assert!(spoiled > 10 && compared > 5, "{spoiled} collide, {compared} are compared");
    std::fs::remove_dir_all(&folder).unwrap();
}
