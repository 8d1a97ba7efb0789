//! A load from the mesh cache reads each file of a mesh and each entry once, and no model twice for the sums that a scene notes.
//!
//! The only test of its process: what the process reads is counted by the operating system.
#![cfg(target_os = "linux")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use foliate::scene::{MeshCache, PackagePath, Scene};
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// Bytes that this process has read so far.
fn bytes_read() -> u64 {
    let counts = std::fs::read_to_string("/proc/self/io").unwrap();
    counts.lines().find_map(|line| line.strip_prefix("rchar: ")).unwrap().parse().unwrap()
}

#[test]
fn a_load_from_the_cache_reads_every_file_once() {
    let folder = std::env::temp_dir().join(format!("foliate-once-{}", std::process::id()));
    let _none = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    // A grid of 100 000 triangles over a wavy ground, as text of some megabytes.
    let mut obj = String::new();
    for i in 0..224_u32 {
        for j in 0..224_u32 {
            writeln!(obj, "v {} {} {}", f64::from(i) * 0.01, f64::from(j) * 0.01, f64::from((i * i + j) % 17) * 1e-3)
                .unwrap();
        }
    }
    for i in 0..223 {
        for j in 1..224 {
            let a = i * 224 + j;
            writeln!(obj, "f {a} {} {}\nf {} {} {}", a + 1, a + 224, a + 1, a + 225, a + 224).unwrap();
        }
    }
    let urdf = "<robot name=\"g\"><link name=\"a\"><collision><geometry><mesh filename=\"g.obj\"/></geometry></collision></link></robot>";
    std::fs::write(folder.join("g.obj"), &obj).unwrap();
    std::fs::write(folder.join("g.urdf"), urdf).unwrap();
    let slider = "<robot name=\"s\"><link name=\"a\"/><link name=\"b\"/><joint name=\"x\" type=\"prismatic\"><parent link=\"a\"/>\
                  <child link=\"b\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>";
    std::fs::write(folder.join("s.urdf"), slider).unwrap();
    let sum = |text: &str| Sha256::digest(text).iter().map(|b| format!("{b:02x}")).collect::<String>();
    let scene = format!(
        "format = \"foliate.scene/1\"\nname = \"once\"\n\
         [[part]]\nname = \"ground\"\nkind = \"environment\"\nurdf = \"g.urdf\"\n\
         [[part]]\nname = \"again\"\nkind = \"environment\"\nurdf = \"g.urdf\"\npose = [9, 0, 0, 0, 0, 0, 1]\n\
         [[part]]\nname = \"s\"\nkind = \"robot\"\nurdf = \"s.urdf\"\n\
         [sha256]\n\"g.obj\" = \"{}\"\n\"g.urdf\" = \"{}\"\n[start]\n\"s/x\" = 0.0\n[[goal]]\n[goal.configuration]\n\"s/x\" = 1.0\n",
        sum(&obj),
        sum(urdf)
    );
    let cache = MeshCache::in_directory(folder.join("cache"));
    let packages = PackagePath::default().with_mesh_cache(cache);
    let load = || {
        let before = bytes_read();
        match Scene::from_text("once", &scene, &folder, &packages) {
            Ok(scene) => {
                let expected = ["not closed", "no collision shapes"];
                let told = |w: &foliate::scene::SceneError| expected.iter().any(|words| w.message.contains(words));
                assert!(scene.warnings.iter().all(told), "{:?}", scene.warnings)
            }
            Err(error) => panic!("{error}"),
        }
        bytes_read() - before
    };
    let first = load();
    let entry = common::files_below(&folder.join("cache"), ".mesh")[0].metadata().unwrap().len();
    let again = load();
    let _gone = std::fs::remove_dir_all(&folder);
    let mesh = obj.len() as u64;
    assert!(mesh > 3_000_000 && entry > 500_000);
    let slightly = 20_000;
    assert!((mesh..mesh + slightly).contains(&first), "{first} bytes for a file of {mesh}");
    assert!((mesh + entry..mesh + entry + slightly).contains(&again), "{again} bytes for {mesh} and {entry}");
}
