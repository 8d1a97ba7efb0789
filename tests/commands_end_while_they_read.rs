//! Time limits and signals hold while a command reads too: it ends with an outcome, soon, and leaves no half of a file behind.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

#[path = "common/skip.rs"]
mod skip;

use skip::{Needs, skipped};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// A fresh folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-reads-{name}-{}", std::process::id()));
        let _fresh = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn at(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    /// A scene with a ring of a million and a half triangles, which takes seconds to read.
    fn large_scene(&self) -> String {
        const AROUND: u32 = 1500;
        const ACROSS: u32 = 500;
        let corner = |i: u32, j: u32| {
            let at = |n: u32, of: u32| f64::from(n % of) / f64::from(of) * std::f64::consts::TAU;
            let (u, v) = (at(i, AROUND), at(j, ACROSS));
            let radius = 2.0 + 0.5 * v.cos();
            [radius * u.cos(), radius * u.sin(), 0.5 * v.sin()].map(|x| x as f32)
        };
        let mut bytes = vec![b' '; 80];
        bytes.extend((2 * AROUND * ACROSS).to_le_bytes());
        for i in 0..AROUND {
            for j in 0..ACROSS {
                let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                for triangle in [[a, b, c], [a, c, d]] {
                    bytes.extend([0; 12]);
                    triangle.as_flattened().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
                    bytes.extend([0; 2]);
                }
            }
        }
        fs::write(self.at("ring.stl"), bytes).unwrap();
        let shape = "<collision><geometry><mesh filename=\"ring.stl\"/></geometry></collision>";
        fs::write(self.at("ring.urdf"), format!("<robot name=\"ring\"><link name=\"a\">{shape}</link></robot>"))
            .unwrap();
        let text = "format = \"foliate.scene/1\"\nname = \"large\"\n[[part]]\nname = \"ring\"\nkind = \"object\"\nurdf = \"ring.urdf\"\n\
                    root_bounds = [[-1, 1], [-1, 1], [-1, 1]]\n[graph]\n[start]\nring = { xyz = [0, 0, 0] }\n\
                    [[goal]]\nconfiguration = { ring = { xyz = [0, 0, 0.5] } }\n";
        fs::write(self.at("large.toml"), text).unwrap();
        self.at("large.toml")
    }

    fn foliate(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command.env("FOLIATE_MESH_CACHE", self.at("meshes")).env("FOLIATE_MODEL_CACHE", self.at("models"));
        command
    }

    /// Files whose name says that they were not written to their end, in any folder of this one.
    fn unfinished(&self) -> Vec<PathBuf> {
        let (mut found, mut folders) = (Vec::new(), vec![self.0.clone()]);
        while let Some(folder) = folders.pop() {
            for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                if path.is_dir() {
                    folders.push(path.clone());
                }
                if path.file_name().unwrap().to_string_lossy().starts_with('.') {
                    found.push(path);
                }
            }
        }
        found
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = fs::remove_dir_all(&self.0);
    }
}

fn told(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat()
}

#[test]
fn a_time_limit_ends_the_reading_of_a_large_mesh() {
    let folder = Folder::new("limit");
    let scene = folder.large_scene();
    let (bench, motion) = (folder.at("bench"), folder.at("motion.csv"));
    fs::write(&motion, "time\n0\n1\n").unwrap();
    let commands: [(&[&str], i32, &str); 4] = [
        (&["solve", &scene, "--json"], 1, "\"outcome\":\"timeout\""),
        (&["solve", &scene], 1, "timeout after"),
        (&["bench", &scene, "--seeds", "1..3", "--out", &bench], 1, "timeout after"),
        (&["certify", &motion, "--scene", &scene], 4, "undecided: the time limit was reached"),
    ];
    for (arguments, code, says) in commands {
        for limit in ["0.05", "0.4"] {
            let started = Instant::now();
            let output = folder.foliate(arguments).args(["--time-limit", limit]).output().unwrap();
            let over = started.elapsed().as_secs_f64() - limit.parse::<f64>().unwrap();
            assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", told(&output));
            assert!(told(&output).contains(says), "{arguments:?}: {}", told(&output));
            // What a busy machine is given on top.
            assert!(over < 0.5, "{arguments:?}: {over} s beyond {limit} s");
        }
    }
    assert!(!Path::new(&bench).exists());
    assert_eq!(folder.unfinished(), Vec::<PathBuf>::new());
}

#[test]
fn the_time_to_read_counts_for_every_solve() {
    let folder = Folder::new("counts");
    // The demo takes some milliseconds to read: none are left to search, in `bench` as in `solve` and `demo`.
    let out = folder.at("bench");
    for arguments in [&["solve", "demo"][..], &["demo"], &["bench", "demo", "--seeds", "1..2", "--out", &out]] {
        let output = folder.foliate(arguments).args(["--time-limit", "0.000001"]).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {}", told(&output));
        assert!(told(&output).contains("timeout"), "{arguments:?}: {}", told(&output));
    }
}

#[test]
fn the_first_signal_ends_the_reading() {
    let folder = Folder::new("signal");
    let scene = folder.large_scene();
    let (bench, urdf) = (folder.at("bench"), folder.at("ring.urdf"));
    let commands: [(&[&str], &str); 5] = [
        (&["solve", &scene, "--json"], "\"outcome\":\"cancelled\""),
        (&["solve", &scene], "cancelled after"),
        (&["bench", &scene, "--seeds", "1..3", "--out", &bench], "cancelled after"),
        (&["inspect", &urdf], ""),
        (&["graph", &scene], ""),
    ];
    for (arguments, says) in commands {
        for name in ["INT", "TERM"] {
            let child = folder.foliate(arguments).spawn().unwrap();
            std::thread::sleep(Duration::from_millis(300));
            let asked = Instant::now();
            let sent = Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap();
            assert!(sent.success());
            let output = child.wait_with_output().unwrap();
            assert_eq!(output.status.code(), Some(130), "{arguments:?}: {}", told(&output));
            assert!(told(&output).contains(says), "{arguments:?}: {}", told(&output));
            assert!(asked.elapsed() < Duration::from_secs(2), "{arguments:?}: {:?}", asked.elapsed());
        }
    }
    assert!(!Path::new(&bench).exists());
    assert_eq!(folder.unfinished(), Vec::<PathBuf>::new());
}

/// A python that has every wheel at hand: it copies one, whose share/ holds all packages.
fn python(folder: &Folder, script: &str) -> String {
    let bin = folder.at("bin");
    fs::create_dir_all(&bin).unwrap();
    let mut wheel = ZipWriter::new(fs::File::create(folder.at("a.whl")).unwrap());
    for package in ["example-robot-data", "hpp_environments", "hpp_tutorial"] {
        for file in ["package.xml", "meshes/a.stl"] {
            let name = format!("cmeel.prefix/share/{package}/{file}");
            wheel.start_file(name, SimpleFileOptions::default()).unwrap();
            std::io::Write::write_all(&mut wheel, &vec![b'x'; 100_000]).unwrap();
        }
    }
    wheel.finish().unwrap();
    let python = Path::new(&bin).join("python3");
    fs::write(&python, format!("#!/bin/sh\nwhile [ \"$1\" != --dest ]; do shift; done\n{script}\n")).unwrap();
    fs::set_permissions(&python, fs::Permissions::from_mode(0o755)).unwrap();
    format!("{bin}:{}", std::env::var("PATH").unwrap())
}

#[test]
fn models_are_installed_whole_or_not_at_all() {
    let folder = Folder::new("install");
    let wheel = folder.at("a.whl");
    let path = python(&folder, &format!("cp '{wheel}' \"$2\""));
    let models = folder.at("models");
    let install = |path: &str| folder.foliate(&["models", "--install"]).env("PATH", path).output().unwrap();

    fs::create_dir(&models).unwrap();
    if Command::new("mount").args(["-t", "tmpfs", "-o", "size=160k", "none", &models]).status().unwrap().success() {
        let output = install(&path);
        let left = fs::read_dir(&models).unwrap().count();
        assert!(Command::new("umount").arg(&models).status().unwrap().success());
        assert_eq!((output.status.code(), left), (Some(1), 0), "{}", told(&output));
        assert!(told(&output).contains("No space left on device"), "{}", told(&output));
    } else {
        skipped(Needs::System, "models on a full disk", "mount is not allowed");
    }

    // The first signal ends a download that hangs.
    let slow = python(&folder, "exec sleep 100");
    let child = folder.foliate(&["models", "--install"]).env("PATH", &slow).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(500));
    let asked = Instant::now();
    assert!(Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", told(&output));
    assert!(asked.elapsed() < Duration::from_secs(5));
    assert_eq!(fs::read_dir(&models).unwrap().count(), 0);

    let path = python(&folder, &format!("cp '{wheel}' \"$2\""));
    let output = install(&path);
    assert_eq!(output.status.code(), Some(0), "{}", told(&output));
    assert_eq!(fs::read(Path::new(&models).join("hpp_tutorial/meshes/a.stl")).unwrap().len(), 100_000);
    assert_eq!(folder.unfinished(), Vec::<PathBuf>::new());
}
