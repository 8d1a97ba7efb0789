//! Signals end a command with what it has; files are written whole or not at all, and what is no file is never replaced; who
//! cannot write says so with exit code 2.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

#[path = "common/skip.rs"]
mod skip;

use skip::{Needs, skipped};
use std::fs;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A fresh folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-survives-{name}-{}", std::process::id()));
        let _fresh = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// All names in it, sorted.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<_> = entries.collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = fs::remove_dir_all(&self.0);
    }
}

fn foliate(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn told(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat()
}

/// A command of the system, where it is there and allowed.
fn system(command: &str, arguments: &[&str]) -> bool {
    Command::new(command).args(arguments).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}

fn signal(child: &Child, name: &str) {
    assert!(system("kill", &["-s", name, &child.id().to_string()]));
}

/// The demo, with a goal that no arm reaches: a search that does not end by itself.
fn endless(folder: &Folder) -> String {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/demo");
    for entry in fs::read_dir(&demo).unwrap().map(Result::unwrap) {
        fs::copy(entry.path(), folder.at(entry.file_name().to_str().unwrap())).unwrap();
    }
    let text = fs::read_to_string(demo.join("scene.toml")).unwrap();
    let (head, _) = text.split_once("[[goal]]").unwrap();
    let text = format!("{head}[[goal]]\nconfiguration = {{ box1 = {{ xyz = [0.87, 0.57, 0.741] }} }}\n");
    let scene = folder.at("endless.toml");
    fs::write(&scene, text.replace("\"demo\"", "\"endless\"")).unwrap();
    scene.to_str().unwrap().to_owned()
}

#[test]
fn an_interrupted_solve_tells_its_outcome_and_its_funnel() {
    let folder = Folder::new("solve");
    let scene = endless(&folder);
    for (name, json) in [("INT", true), ("TERM", true), ("INT", false)] {
        let mut arguments = vec!["solve", &scene, "--time-limit", "100", "--verbose"];
        arguments.extend(json.then_some("--json"));
        let child = foliate(&arguments).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(1500));
        let asked = Instant::now();
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert!(asked.elapsed() < Duration::from_secs(5), "{:?}", asked.elapsed());
        assert_eq!(output.status.code(), Some(130), "{}", told(&output));
        if json {
            let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!(answer["outcome"], "cancelled");
            assert!(!answer["funnel"].as_array().unwrap().is_empty());
        } else {
            let text = told(&output);
            assert!(text.contains("endless: cancelled in ") && text.contains("funnel (candidates"), "{text}");
        }
    }
}

#[test]
fn an_interrupted_bench_has_its_table_and_goes_on_to_the_same_rows() {
    let folder = Folder::new("bench");
    let scene = endless(&folder);
    let bench = |out: &Path, seeds: &str, more: &[&str]| {
        let mut command = foliate(&["bench", "demo", &scene, "--time-limit", "0.4", "--seeds", seeds, "--out"]);
        command.arg(out).args(more);
        command
    };
    let (whole, cut) = (folder.at("whole"), folder.at("cut"));
    let uninterrupted = bench(&whole, "1..8", &[]).output().unwrap();
    // The endless scene is never solved.
    assert_eq!(uninterrupted.status.code(), Some(1), "{}", told(&uninterrupted));

    let child = bench(&cut, "1..8", &[]).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(60);
    let rows = |out: &Path| fs::read_to_string(out.join("results.csv")).unwrap_or_default().lines().count();
    // What takes longest comes first, once a row of each scene is there.
    while rows(&cut) < 5 && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(5));
    }
    signal(&child, "INT");
    let output = child.wait_with_output().unwrap();
    let text = told(&output);
    assert_eq!(output.status.code(), Some(130), "{text}");
    assert!(text.contains("| demo | 1/1 |") && text.contains("of 16 solves; --resume goes on"), "{text}");
    assert!(fs::read_to_string(cut.join("table.md")).unwrap().contains("| demo | 1/1 |"));
    // A head, a row of the demo, and the others.
    let done = rows(&cut);
    assert!((5..10).contains(&done), "{done}");

    // A line that was cut off, and a path that is missing: both are solved again.
    let results = fs::read_to_string(cut.join("results.csv")).unwrap();
    fs::write(cut.join("results.csv"), &results[..results.len() - 20]).unwrap();
    fs::remove_file(cut.join("paths/demo-1.json")).unwrap();
    let resumed = bench(&cut, "1..8", &["--resume", "--threads", "2"]).output().unwrap();
    assert_eq!(resumed.status.code(), Some(1), "{}", told(&resumed));
    let lines = |start: &str| String::from_utf8_lossy(&resumed.stderr).lines().filter(|l| l.starts_with(start)).count();
    assert_eq!((lines("demo "), lines("endless ")), (8, 8 - (done - 3)), "{}", told(&resumed));
    // Of a scene that ends by its clock, the work depends on the clock.
    let kept = |out: &Path| -> Vec<String> {
        let text = fs::read_to_string(out.join("results.csv")).unwrap();
        let without_times = |line: &str| {
            let cells: Vec<_> = line.split(',').collect();
            let shown = if cells[0] == "demo" { 6..16 } else { 0..0 };
            [cells[..4].join(","), cells[shown].join(",")].join(",")
        };
        text.lines().map(without_times).collect()
    };
    assert_eq!(kept(&whole), kept(&cut));
    for seed in 1..=8 {
        let path = |out: &Path| fs::read(out.join(format!("paths/demo-{seed}.json"))).unwrap();
        assert!(path(&whole) == path(&cut), "seed {seed}");
    }

    // Other seeds are another batch, and so is another scene of the same name.
    let other = bench(&cut, "1..9", &["--resume"]).output().unwrap();
    assert_eq!(other.status.code(), Some(2));
    assert!(told(&other).contains("were made with seeds = 1..8, now it is 1..9"), "{}", told(&other));
    let text = fs::read_to_string(&scene).unwrap();
    fs::write(&scene, text.replace("0.57", "0.56")).unwrap();
    let other = bench(&cut, "1..8", &["--resume"]).output().unwrap();
    assert_eq!(other.status.code(), Some(2));
    assert!(told(&other).contains("were made with scene endless = "), "{}", told(&other));
}

#[test]
fn a_second_signal_ends_the_process() {
    let folder = Folder::new("twice");
    // No process reads the pipe: the first signal stops the search, and then the process waits to write.
    let scene = endless(&folder);
    let fifo = folder.at("pipe");
    if !system("mkfifo", &[fifo.to_str().unwrap()]) {
        skipped(Needs::System, "a_second_signal_ends_the_process", "mkfifo is not there");
        return;
    }
    let mut child = foliate(&["solve", "demo", "--out", fifo.to_str().unwrap()]).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    assert!(child.try_wait().unwrap().is_none(), "it waits for a reader");
    signal(&child, "INT");
    std::thread::sleep(Duration::from_millis(200));
    signal(&child, "INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    drop(scene);
}

#[test]
fn what_is_no_file_is_written_to_and_not_replaced() {
    let folder = Folder::new("devices");
    let solve = |out: &Path| foliate(&["solve", "demo", "--json", "--out", out.to_str().unwrap()]).output().unwrap();
    let null = folder.at("null");
    if system("mknod", &[null.to_str().unwrap(), "c", "1", "3"]) {
        let output = solve(&null);
        assert!(output.status.success(), "{}", told(&output));
        assert!(fs::metadata(&null).unwrap().file_type().is_char_device());
        let link = folder.at("link");
        symlink(&null, &link).unwrap();
        assert!(solve(&link).status.success());
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(folder.names(), ["link", "null"], "no models lie beside a device");
        fs::remove_file(&link).unwrap();
        fs::remove_file(&null).unwrap();
    } else {
        skipped(Needs::System, "what_is_no_file_is_written_to (a device of its own)", "mknod is not allowed");
    }
    for (device, code) in [("/dev/null", 0), ("/dev/full", 2)] {
        let output = solve(Path::new(device));
        assert_eq!(output.status.code(), Some(code), "{}", told(&output));
        assert!(fs::metadata(device).unwrap().file_type().is_char_device());
    }
    assert!(!Path::new("/dev/null.models").exists() && !Path::new("/dev/full.models").exists());
    let output = foliate(&["solve", "demo", "--out", "/dev/stdout"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("{\"format\":\"foliate.path/2\"") && text.contains("\ndemo: solved in "), "{text}");

    let fifo = folder.at("pipe");
    if system("mkfifo", &[fifo.to_str().unwrap()]) {
        let reader = std::thread::spawn({
            let fifo = fifo.clone();
            move || fs::read_to_string(fifo).unwrap()
        });
        assert!(solve(&fifo).status.success());
        assert!(fs::metadata(&fifo).unwrap().file_type().is_fifo());
        assert!(reader.join().unwrap().starts_with("{\"format\":\"foliate.path/2\""));
    }
    let output = solve(&folder.0);
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    assert!(told(&output).contains("directory"), "{}", told(&output));
    let nowhere = folder.at("nowhere");
    symlink(folder.at("missing"), &nowhere).unwrap();
    assert_eq!(solve(&nowhere).status.code(), Some(2));
    assert!(fs::symlink_metadata(&nowhere).unwrap().is_symlink());
}

#[test]
fn a_file_keeps_its_permissions_and_a_link_its_place() {
    let folder = Folder::new("links");
    let (file, link) = (folder.at("path.json"), folder.at("link.json"));
    fs::write(&file, "old").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).unwrap();
    symlink("path.json", &link).unwrap();
    assert!(foliate(&["solve", "demo", "--out", link.to_str().unwrap()]).status().unwrap().success());
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::metadata(&file).unwrap().mode() & 0o777, 0o600);
    assert!(foliate(&["check", link.to_str().unwrap()]).status().unwrap().success());
    fs::set_permissions(&file, fs::Permissions::from_mode(0o400)).unwrap();
    let output = foliate(&["solve", "demo", "--out", file.to_str().unwrap()]).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "a file that may not be written is not replaced");
    let output = foliate(&["solve", "demo", "--out", folder.at("no/path.json").to_str().unwrap()]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn six_processes_may_have_one_out() {
    let folder = Folder::new("race");
    let out = folder.at("path.json");
    let path = out.to_str().unwrap();
    let rounds = 4;
    let writers: Vec<_> = (0..6)
        .map(|seed: u32| {
            let path = path.to_owned();
            std::thread::spawn(move || {
                for round in 0..rounds {
                    let seed = (seed + 6 * round).to_string();
                    let output = foliate(&["solve", "demo", "--seed", &seed, "--out", &path]).output().unwrap();
                    assert!(output.status.success(), "{}", told(&output));
                }
            })
        })
        .collect();
    let mut reads = 0;
    while writers.iter().any(|writer| !writer.is_finished()) {
        if let Ok(text) = fs::read_to_string(&out) {
            assert!(serde_json::from_str::<serde_json::Value>(&text).is_ok(), "half of a file was seen");
            reads += 1;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    writers.into_iter().for_each(|writer| writer.join().unwrap());
    assert!(reads > 10);
    assert_eq!(folder.names(), ["path.json", "path.models"]);
    assert!(foliate(&["check", path]).status().unwrap().success());
}

#[test]
fn output_that_cannot_be_written_is_an_error_of_every_command() {
    let folder = Folder::new("full");
    let path = folder.at("path.json");
    let path = path.to_str().unwrap();
    assert!(foliate(&["solve", "demo", "--out", path]).status().unwrap().success());
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/demo/robot.urdf");
    let bench = folder.at("bench");
    let commands: [&[&str]; 11] = [
        &["solve", "demo", "--json"],
        &["solve", "demo"],
        &["demo"],
        &["graph", "demo"],
        &["graph", "demo", "--dot"],
        &["check", path],
        &["check", path, "--json"],
        &["scenes"],
        &["inspect", robot.to_str().unwrap()],
        &["--help"],
        &["bench", "demo", "--seeds", "1..2", "--out", bench.to_str().unwrap()],
    ];
    for arguments in commands {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = foliate(arguments).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(told(&output).contains("error: standard output: "), "{arguments:?}: {}", told(&output));
        // Who has read enough is no error, and changes no verdict.
        let _fresh = fs::remove_dir_all(&bench);
        let mut child = foliate(arguments).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", told(&output));
        assert!(!told(&output).contains("error"), "{arguments:?}: {}", told(&output));
        let _fresh = fs::remove_dir_all(&bench);
    }
}

#[test]
fn a_full_disk_leaves_whole_rows_and_no_stray_files() {
    let folder = Folder::new("disk");
    let disk = folder.at("disk");
    fs::create_dir(&disk).unwrap();
    let at = disk.to_str().unwrap();
    if !system("mount", &["-t", "tmpfs", "-o", "size=128k", "none", at]) {
        skipped(Needs::System, "a_full_disk_leaves_whole_rows_and_no_stray_files", "mount is not allowed");
        return;
    }
    let out = disk.join("bench");
    let output = foliate(&["bench", "demo", "--seeds", "1..60", "--out", out.to_str().unwrap()]).output().unwrap();
    let results = fs::read_to_string(out.join("results.csv")).unwrap();
    let stray: Vec<_> = fs::read_dir(out.join("paths")).unwrap().map(|e| e.unwrap().file_name()).collect();
    let single = foliate(&["solve", "demo", "--out", disk.join("a.json").to_str().unwrap()]).output().unwrap();
    let unfinished = stray.iter().filter(|name| name.to_string_lossy().contains("unfinished")).count();
    let left = disk.join("a.json").exists();
    assert!(system("umount", &[at]));
    assert_ne!(output.status.code(), Some(0), "{}", told(&output));
    assert!(told(&output).contains("No space left on device"), "{}", told(&output));
    assert!(results.ends_with('\n') && results.lines().count() > 1, "{results}");
    assert!(results.lines().all(|line| line.split(',').count() >= 16), "{results}");
    assert_eq!(unfinished, 0);
    assert_eq!((single.status.code(), left), (Some(2), false), "{}", told(&single));
}

#[test]
fn a_limit_of_file_sizes_is_an_error_and_takes_half_rows_back() {
    let folder = Folder::new("ulimit");
    let out = folder.at("bench");
    // A kilobyte: the head and a few rows of results.csv fit, no path does.
    let script = "ulimit -f 1; exec \"$0\" \"$@\"";
    let program = env!("CARGO_BIN_EXE_foliate");
    let run = |arguments: &[&str]| Command::new("bash").args(["-c", script, program]).args(arguments).output().unwrap();
    let output = run(&["bench", "demo", "--seeds", "1..30", "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    assert!(told(&output).contains("File too large"), "{}", told(&output));
    let results = fs::read_to_string(out.join("results.csv")).unwrap();
    assert!(results.ends_with('\n') && (2..30).contains(&results.lines().count()), "{results}");
    let output = run(&["solve", "demo", "--out", folder.at("path.json").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    assert!(
        !folder.names().iter().any(|name| name == "path.json" || name.contains("unfinished")),
        "{:?}",
        folder.names()
    );
    // The rows that could not be finished are solved once there is room.
    let resumed = foliate(&["bench", "demo", "--seeds", "1..30", "--resume", "--out", out.to_str().unwrap()]);
    let mut resumed = resumed;
    let output = resumed.output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", told(&output));
    assert!(told(&output).contains("| demo | 30/30 |"), "{}", told(&output));
}

#[test]
fn a_folder_that_may_not_be_written_is_an_error() {
    // Root may write everywhere; a file system of the kernel's own refuses even it.
    for place in ["/proc/foliate.json", "/sys/foliate.json"] {
        if !Path::new(place).parent().unwrap().is_dir() {
            continue;
        }
        let output = foliate(&["solve", "demo", "--out", place]).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", told(&output));
        assert!(told(&output).contains("error: /"), "{}", told(&output));
    }
}
