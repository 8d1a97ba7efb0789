//! Promise: whatever a file holds, a model's or a scene's, reading it ends within 2 s and 200 MB with exit code 2 and a message
//! that names file, line and element.
//!
//! `bad_input/expected.tsv` says for each file where the message points. Files too large to keep are written here.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]
#![cfg(target_os = "linux")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const SECONDS: u64 = 2;
const KILOBYTES: u64 = 200_000;

struct Told {
    code: Option<i32>,
    message: String,
    time: Duration,
}

fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input")
}

/// Runs `foliate inspect`, of a scene `foliate graph`, with bounded memory; what runs longer than it may is ended.
fn read(file: &Path, srdf: Option<&Path>) -> Told {
    let start = Instant::now();
    let mut command = Command::new("sh");
    command.arg("-c").arg(format!("ulimit -v {KILOBYTES}; exec \"$@\"")).arg("sh").arg(env!("CARGO_BIN_EXE_foliate"));
    let reader = if file.extension().is_some_and(|kind| kind == "toml") { "graph" } else { "inspect" };
    command.arg(reader).arg(file).arg("--package-path").arg(directory().parent().expect("tests/"));
    if let Some(srdf) = srdf {
        command.arg("--srdf").arg(srdf);
    }
    // What is read in tests is not kept for the user.
    let kept = std::env::temp_dir().join(format!("foliate-bad-input-kept-{}", std::process::id()));
    command.env("FOLIATE_MESH_CACHE", &kept);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("sh runs");
    while child.try_wait().expect("the child is ours").is_none() {
        if start.elapsed() > Duration::from_secs(SECONDS) {
            child.kill().expect("the child is ours");
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let time = start.elapsed();
    let output = child.wait_with_output().expect("the child is ours");
    Told { code: output.status.code(), message: String::from_utf8_lossy(&output.stderr).into_owned(), time }
}

/// What is wrong with how a refusal was told, if anything.
fn fault(told: &Told, place: &str, element: &str, says: &str) -> Option<String> {
    let message = &told.message;
    let shown: String = message.chars().take(300).collect();
    let points = message.contains(&format!("/{place}: {element}")) || message.contains(&format!("/{place}:"));
    let problem = match () {
        () if told.time > Duration::from_secs(SECONDS) => format!("took {:?}", told.time),
        () if told.code != Some(2) => format!("ended with {:?}", told.code),
        () if message.contains("panicked") => "panicked".into(),
        () if message.len() > 2000 => format!("said {} bytes", message.len()),
        () if !points => format!("does not point to {place}"),
        () if !message.contains(element) => format!("does not name {element}"),
        () if !message.contains(says) => format!("does not say {says}"),
        () => return None,
    };
    Some(format!("{problem}: {shown}"))
}

#[test]
fn every_bad_file_is_refused_quickly_with_file_line_and_element() {
    let directory = directory();
    let expected = std::fs::read_to_string(directory.join("expected.tsv")).expect("expected.tsv");
    let (mut faults, mut files) = (String::new(), 0);
    for line in expected.lines().filter(|l| !l.starts_with('#')) {
        let [file, srdf, place, element, says] = line.split('\t').collect::<Vec<_>>()[..] else {
            panic!("expected.tsv: {line}");
        };
        let srdf = (!srdf.is_empty()).then(|| directory.join(srdf));
        let told = read(&directory.join(file), srdf.as_deref());
        if let Some(fault) = fault(&told, place, element, says) {
            let _ = writeln!(faults, "{file} {place}: {fault}");
        }
        files += 1;
    }
    assert!(files >= 60, "{files} files");
    assert!(faults.is_empty(), "\n{faults}");
}

/// A directory for files that a test writes, removed when it ends.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a directory for scratch files");
        Self(path)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, content).expect("scratch files can be written");
        path
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn deep_wide_and_long_files_are_refused_before_they_cost_anything() {
    let scratch = Scratch::new("large");
    let repeat =
        |before: &str, middle: &str, times: usize, after: &str| format!("{before}{}{after}", middle.repeat(times));
    let robot = "<robot name=\"r\">";
    let mut attributes = String::from("<robot name=\"r\"\n");
    let mut namespaces = String::from("<robot name=\"r\"");
    let mut links = format!("{robot}\n");
    for i in 0..100_000 {
        let _ = write!(attributes, " a{i}=\"\"");
        let _ = write!(links, "<link name=\"l{i}\"/>");
        if i < 100 {
            let _ = write!(namespaces, " xmlns:n{i}=\"u{i}\"");
        }
    }
    let cases: Vec<(&str, String, &str)> = vec![
        ("deep.urdf", repeat(robot, "<a>", 100_000, ""), "deeper"),
        (
            "deep-and-closed.urdf",
            format!("{robot}{}{}</robot>", "<a>".repeat(100_000), "</a>".repeat(100_000)),
            "deeper",
        ),
        ("many-elements.urdf", repeat(robot, "<a/>", 3_000_000, "</robot>"), "more elements"),
        ("many-attributes.urdf", attributes + "/>", "attributes"),
        ("many-namespaces.urdf", namespaces + "/>", "namespaces"),
        ("many-links.urdf", links + "</robot>", "links"),
        (
            "long-name.urdf",
            format!("{robot}<link name=\"{0}\"/><link name=\"{0}\"/></robot>", "x".repeat(1_000_000)),
            "exists already",
        ),
        (
            "long-vector.urdf",
            format!(
                "{robot}<link name=\"a\"><collision><origin xyz=\"{}\"/><geometry><sphere radius=\"1\"/></geometry></collision></link></robot>",
                "1 ".repeat(2_000_000)
            ),
            "3 numbers",
        ),
        ("long-comment.urdf", format!("{robot}<!--{}", "x".repeat(10_000_000)), "never closed"),
        ("open-quotes.urdf", repeat(robot, "<a b=\"", 500_000, ""), ""),
        ("too-large.urdf", repeat(robot, " ", 40_000_000, "</robot>"), "bytes"),
    ];
    let mut faults = String::new();
    for (name, content, says) in cases {
        let path = scratch.write(name, content);
        if let Some(fault) = fault(&read(&path, None), name, "", says) {
            let _ = writeln!(faults, "{name}: {fault}");
        }
    }
    assert!(faults.is_empty(), "\n{faults}");
}

#[test]
fn large_meshes_are_refused_before_they_are_read() {
    let scratch = Scratch::new("meshes");
    let mut declared = vec![0; 80];
    declared.extend(4_000_000_000_u32.to_le_bytes());
    declared.extend(vec![0; 1_000_000]);
    let mut faces = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\nf");
    faces.push_str(&" 1 2 3".repeat(500_000));
    // 2^20 copies of one triangle by nodes that instance each other.
    let mut nodes = String::new();
    for i in 0..20 {
        let _ = writeln!(
            nodes,
            "<node id=\"n{i}\"><instance_node url=\"#n{0}\"/><instance_node url=\"#n{0}\"/></node>",
            i + 1
        );
    }
    let unfolding = format!(
        "<COLLADA><library_visual_scenes><visual_scene id=\"s\">{nodes}<node id=\"n20\"/></visual_scene>\
         </library_visual_scenes></COLLADA>"
    );
    let sparse = scratch.0.join("sparse.stl");
    std::fs::File::create(&sparse).and_then(|f| f.set_len(1 << 40)).expect("a sparse file");
    let cases: Vec<(&str, Option<Vec<u8>>, &str)> = vec![
        ("declared.stl", Some(declared), "declares 4000000000 triangles"),
        ("face.obj", Some(faces.into_bytes()), "corners"),
        ("unfolding.dae", Some(unfolding.into_bytes()), "too many nodes"),
        ("deep.dae", Some(format!("<COLLADA>{}", "<node>".repeat(100_000)).into_bytes()), "deeper"),
        ("sparse.stl", None, "bytes"),
    ];
    let mut faults = String::new();
    for (name, content, says) in cases {
        content.into_iter().for_each(|c| drop(scratch.write(name, c)));
        let urdf = format!(
            "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"{name}\"/></geometry></collision></link></robot>"
        );
        let urdf = scratch.write(&format!("{name}.urdf"), urdf);
        if let Some(fault) = fault(&read(&urdf, None), name, "", says) {
            let _ = writeln!(faults, "{name}: {fault}");
        }
    }
    assert!(faults.is_empty(), "\n{faults}");
}

#[test]
fn links_and_pipes_are_not_followed_out_of_a_package() {
    let scratch = Scratch::new("links");
    let package = scratch.0.join("package");
    std::fs::create_dir_all(&package).expect("a package");
    let mesh = scratch.write("elsewhere.stl", "solid s\nendsolid s\n");
    std::os::unix::fs::symlink(mesh, package.join("out.stl")).expect("a link");
    let made = Command::new("mkfifo").arg(package.join("pipe.stl")).status();
    let mut cases = vec![("out.stl", "outside of the directories that may be read")];
    if made.is_ok_and(|s| s.success()) {
        cases.push(("pipe.stl", "not a regular file"));
    }
    for (name, says) in cases {
        let urdf = format!(
            "<robot name=\"r\">\n<link name=\"a\"><collision><geometry><mesh filename=\"{name}\"/></geometry></collision></link></robot>"
        );
        std::fs::write(package.join("model.urdf"), urdf).expect("a model");
        let told = read(&package.join("model.urdf"), None);
        let place = if name == "out.stl" { "model.urdf:2" } else { name };
        assert_eq!(fault(&told, place, "", says), None);
    }
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let told = read(Path::new("/no/such/model.urdf"), None);
    assert_eq!((told.code, told.message.contains("/no/such/model.urdf")), (Some(2), true), "{}", told.message);
}
