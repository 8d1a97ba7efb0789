//! Promise: damaged files are refused, never a panic. Good files are cut off at every byte, and changed at random.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

use foliate::scene::{PackagePath, Scene, UpAxis, read_model};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::path::Path;

const CHANGES: usize = 300;

/// Every beginning of a file (at most some two hundred, evenly spread), then random changes of one to four bytes.
fn damaged(good: &[u8], mut read: impl FnMut(&[u8])) {
    let stride = (good.len() / 200).max(1);
    (0..good.len()).step_by(stride).for_each(|end| read(&good[..end]));
    let mut rng = ChaCha8Rng::seed_from_u64(good.len() as u64);
    for _ in 0..CHANGES {
        let mut bad = good.to_vec();
        for _ in 0..=rng.next_u32() % 4 {
            let at = rng.next_u32() as usize % bad.len();
            match rng.next_u32() % 4 {
                0 => bad[at] = rng.next_u32() as u8,
                1 => bad[at] = b"0123456789<>/\"=-. eE[]{}"[rng.next_u32() as usize % 24],
                2 => drop(bad.remove(at)),
                _ => bad.insert(at, bad[(at * 7) % bad.len()]),
            }
            if bad.is_empty() {
                return;
            }
        }
        read(&bad);
    }
}

#[test]
fn damaged_models_and_meshes_are_refused_or_read() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let demo = |name: &str| std::fs::read(root.join("scenes/demo").join(name)).expect("the demo's files");
    let directory = std::env::temp_dir().join(format!("foliate-damaged-{}", std::process::id()));
    std::fs::create_dir_all(&directory).expect("a directory");
    let place = |name: &str| directory.join(name).to_string_lossy().into_owned();
    let read =
        |urdf: &str, srdf: Option<&str>| drop(read_model(urdf, srdf, UpAxis::AsWritten, &PackagePath::default()));

    damaged(&demo("robot.urdf"), |bad| {
        std::fs::write(place("bad.urdf"), bad).expect("written");
        read(&place("bad.urdf"), None);
    });
    for (urdf, srdf) in [("robot.urdf", "robot.srdf"), ("box.urdf", "box.srdf")] {
        std::fs::write(place(urdf), demo(urdf)).expect("written");
        damaged(&demo(srdf), |bad| {
            std::fs::write(place(srdf), bad).expect("written");
            read(&place(urdf), Some(&place(srdf)));
        });
    }
    let good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1/1 2/2/2 -1//3 4\n";
    for (name, content) in [
        ("triangle.stl", std::fs::read(root.join("tests/bad_input/triangle.stl")).expect("a mesh")),
        ("scene.obj", good.into()),
        ("count-differs.dae", std::fs::read(root.join("tests/bad_input/count-differs.dae")).expect("a mesh")),
    ] {
        let urdf = format!(
            "<robot name=\"m\"><link name=\"a\"><collision><geometry><mesh filename=\"{name}\"/></geometry></collision></link></robot>"
        );
        std::fs::write(place("mesh.urdf"), urdf).expect("written");
        damaged(&content, |bad| {
            std::fs::write(place(name), bad).expect("written");
            read(&place("mesh.urdf"), None);
        });
    }
    let _ = std::fs::remove_dir_all(&directory);
}

#[test]
fn damaged_scenes_are_refused_or_read() {
    let reference = include_str!("../docs/scene-reference.md");
    let example = reference.split("```toml\n").nth(1).and_then(|t| t.split("```").next()).expect("an example");
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    damaged(example.as_bytes(), |bad| {
        if let Ok(text) = std::str::from_utf8(bad) {
            drop(Scene::from_text("damaged", text, &directory, &PackagePath::default()));
        }
    });
}
