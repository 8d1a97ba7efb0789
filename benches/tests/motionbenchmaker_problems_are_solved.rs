//! A file in the form of MotionBenchMaker's problems is read, or refused with the place; its problems become scenes and are solved.

#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

use flate2::Compression;
use flate2::write::GzEncoder;
use foliate::check::{CheckOptions, Verdict, check};
use foliate::scene::PackagePath;
use foliate_benches::motionbenchmaker::file::{ProblemSets, Shape};
use foliate_benches::motionbenchmaker::scene::{RobotFiles, SceneWriter};
use foliate_benches::motionbenchmaker::table::quantile;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// An arm of two joints in a plane, 0.8 m long, and a finger that opens by 4 cm. The goal of the second problem is in a box.
const PROBLEMS: &str = r#"{"robot": "planar", "quaternions": "x y z w", "sets": {"few": [
 {"index": 1, "start": {"a": 0.0, "b": 0.0, "finger": 0.065, "wheel": 1.0}, "goal": {"a": 1.5, "b": 0.50000001}, "obstacles": [
  {"name": "ball", "type": "sphere", "radius": 0.1, "xyz": [-0.9, 0.0, 0.0], "quaternion": [0, 0, 0, 1]},
  {"name": "post", "type": "cylinder", "length": 0.5, "radius": 0.05, "xyz": [0.6, 0.6, 0.0], "quaternion": [0, 0, 0, 1]}]},
 {"index": 2, "start": {"a": 0.0, "b": 0.0, "finger": 0.01}, "goal": {"a": 1.5, "b": 0.0}, "obstacles": [
  {"name": "a \"wall\"", "type": "box", "size": [0.2, 0.2, 0.2], "xyz": [0.0, 0.5, 0.0],
   "quaternion": [0, 0, 0.7071067811865476, 0.7071067811865476]}]}]}}"#;

const URDF: &str = r#"<robot name="planar"><link name="base"/>
<link name="upper"><collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.02 0.02"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.02 0.02"/></geometry></collision></link>
<link name="tip"/>
<joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
 <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="b" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>
 <limit lower="-0.5" upper="0.5" effort="1" velocity="1"/></joint>
<joint name="finger" type="prismatic"><parent link="lower"/><child link="tip"/><axis xyz="0 1 0"/>
 <limit lower="0" upper="0.04" effort="1" velocity="1"/></joint></robot>"#;

/// A folder of a test's own, which goes with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-mbm-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a temporary folder");
        std::fs::write(path.join("planar.urdf"), URDF).expect("a file");
        std::fs::write(path.join("few.json"), PROBLEMS).expect("a file");
        Self(path)
    }

    fn file(&self, name: &str) -> String {
        self.0.join(name).to_string_lossy().into_owned()
    }

    /// Runs the program on `few.json`.
    fn run(&self, options: &[&str]) -> Output {
        let program = env!("CARGO_BIN_EXE_motionbenchmaker");
        Command::new(program).arg(self.file("few.json")).args(options).output().expect("the program starts")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn refusal(from: &str, to: &str) -> String {
    let text = PROBLEMS.replace(from, to);
    assert_ne!(text, PROBLEMS, "nothing was changed");
    ProblemSets::parse(&text).expect_err("a file that is wrong")
}

#[test]
fn a_file_is_read_as_it_is_and_compressed() {
    let folder = Folder::new("read");
    let mut gzip = GzEncoder::new(Vec::new(), Compression::fast());
    gzip.write_all(PROBLEMS.as_bytes()).expect("memory");
    std::fs::write(folder.0.join("few.json.gz"), gzip.finish().expect("memory")).expect("a file");
    for name in ["few.json", "few.json.gz"] {
        let sets = ProblemSets::read(&folder.0.join(name)).expect("a sound file");
        assert_eq!(sets.robot, "planar");
        let problems = &sets.sets["few"];
        assert_eq!(problems.iter().map(|p| p.index).collect::<Vec<_>>(), [1, 2]);
        assert_eq!(problems[0].start["finger"], 0.065);
        assert_eq!(problems[0].goal.len(), 2);
        assert!(matches!(problems[0].obstacles[0].shape, Shape::Sphere { radius: 0.1 }));
        assert!(matches!(problems[0].obstacles[1].shape, Shape::Cylinder { length: 0.5, radius: 0.05 }));
        assert!(matches!(problems[1].obstacles[0].shape, Shape::Box { size: [0.2, 0.2, 0.2] }));
    }
}

#[test]
fn the_form_that_the_readme_shows_is_read() {
    let readme = include_str!("../README.md");
    let (_, block) = readme.split_once("```json\n").expect("an example");
    let (text, _) = block.split_once("```").expect("the end of the example");
    let sets = ProblemSets::parse(text).expect("the example is sound");
    assert_eq!(sets.sets["cage"][0].obstacles.len(), 3);
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let cases = [
        ("\"sphere\"", "\"cone\"", vec!["cone", "line 3"]),
        ("\"radius\": 0.1", "\"radius\": -0.1", vec!["set `few`, problem 1", "obstacle `ball`", "above 0"]),
        ("[0, 0, 0, 1]},\n", "[0, 0, 0, 2]},\n", vec!["problem 1", "`ball`", "the length of `quaternion` is 2"]),
        ("\"b\": 0.50000001", "\"c\": 0.5", vec!["problem 1", "`goal` has joint `c`, `start` has not"]),
        ("{\"a\": 1.5, \"b\": 0.0}", "{}", vec!["problem 2", "`goal` names no joint"]),
        ("\"index\": 2", "\"index\": 1", vec!["problem 1", "two problems of this index"]),
        ("x y z w", "w x y z", vec!["w x y z", "only \"x y z w\" is read"]),
        ("\"obstacles\": [\n", "\"solids\": [\n", vec!["missing field `obstacles`", "line"]),
        ("{\"a\": 0.0, \"b\": 0.0, \"finger\": 0.01}", "{\"a\": \"0\"}", vec!["expected f64", "line 5"]),
        ("]}}", "", vec!["EOF", "line"]),
    ];
    for (from, to, words) in cases {
        let error = refusal(from, to);
        assert!(words.iter().all(|word| error.contains(word)), "{from} -> {to}: {error}");
    }
    let error = ProblemSets::parse(r#"{"robot": "planar", "sets": {"none": []}}"#).expect_err("no problem");
    assert!(error.contains("has no problems"), "{error}");
    let error = ProblemSets::read(Path::new("nowhere.json")).expect_err("no file");
    assert!(error.starts_with("nowhere.json: "), "{error}");
    let folder = Folder::new("wrong");
    std::fs::write(folder.0.join("plain.json.gz"), PROBLEMS).expect("a file");
    let error = ProblemSets::read(&folder.0.join("plain.json.gz")).expect_err("not compressed");
    assert!(error.contains("plain.json.gz") && error.contains("gzip"), "{error}");
}

#[test]
fn joints_that_are_not_planned_are_locked_within_their_bounds() {
    let folder = Folder::new("scene");
    let files = RobotFiles { urdf: folder.file("planar.urdf"), srdf: None };
    let writer = SceneWriter::new(files, &PackagePath::only(&[])).expect("a robot");
    let sets = ProblemSets::parse(PROBLEMS).expect("a sound file");
    let problem = &sets.sets["few"][0];
    let written = writer.write(problem, "one", &folder.0).expect("a scene");
    assert_eq!(written.left_out, ["wheel"]);
    assert_eq!(written.moved, [("finger".to_owned(), 0.065), ("b".to_owned(), 0.50000001)]);
    let text = std::fs::read_to_string(&written.path).expect("the scene");
    assert!(text.contains("[locked]\n\"robot/finger\" = 0.04\n"), "{text}");
    assert!(text.contains("[goal.configuration]\n\"robot/a\" = 1.5\n\"robot/b\" = 0.5\n"), "{text}");
    let mut problem = problem.clone();
    problem.goal.insert("elbow".into(), 0.0);
    let error = writer.write(&problem, "one", &folder.0).expect_err("no such joint");
    assert!(error.contains("one: the robot has no joint `elbow`; it has a, b, finger"), "{error}");
}

#[test]
fn problems_are_solved_and_collisions_of_goals_are_told() {
    let folder = Folder::new("solve");
    let (urdf, csv) = (folder.file("planar.urdf"), folder.file("rows.csv"));
    let output = folder.run(&["--urdf", &urdf, "--check", "--seeds", "1..2", "--csv", &csv]);
    let (told, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{told}{errors}");
    assert!(told.contains("\n| few | 4 | 0 | 2 | 2 | 0 | 2 | 2 | "), "{told}");
    assert!(told.contains("finger (1 times)") && told.contains("wheel (1 times)"), "{told}");
    assert!(errors.contains("few 2 seed 1: infeasible_goal") && errors.contains("obstacles"), "{errors}");
    let rows = std::fs::read_to_string(&csv).expect("rows");
    let solved = |index: &str| rows.lines().filter(|row| row.starts_with(index) && row.contains(",solved,")).count();
    assert_eq!((rows.lines().count(), solved("few,1,"), solved("few,2,")), (5, 2, 0), "{rows}");
}

#[test]
fn paths_are_written_with_their_scenes() {
    let folder = Folder::new("paths");
    let (urdf, paths) = (folder.file("planar.urdf"), folder.0.join("paths"));
    let output = folder.run(&["--urdf", &urdf, "--paths", &paths.to_string_lossy()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let packages = PackagePath::only(&[]).with_readable([&folder.0]);
    let path = foliate::path_file::save::read(&paths.join("few-0001-1.json"));
    let options = CheckOptions::default();
    let report = check(&path.expect("a path file"), &paths, &packages, &options).expect("its models are there");
    assert!(matches!(report.verdict(), Verdict::Proved), "{:?}", report.violations);
}

#[test]
fn the_program_refuses_what_it_cannot_do() {
    let folder = Folder::new("options");
    let urdf = folder.file("planar.urdf");
    let cases: [(&[&str], &str); 6] = [
        (&[], "no description of the robot `planar` is known; give it by --urdf"),
        (&["--urdf", &urdf, "--sets", "many"], "--sets many: the file has few"),
        (&["--every", "0"], "--every 0: is no number above 0"),
        (&["--seeds", "3..1"], "--seeds 3..1: `3..1` is no range"),
        (&["--time-limit"], "--time-limit wants a value"),
        (&["--fast", "1"], "there is no option `--fast`"),
    ];
    for (options, words) in cases {
        let output = folder.run(options);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains(words), "{options:?}: {errors}");
    }
}

#[test]
fn quantiles_are_values_that_occur() {
    let values: Vec<f64> = (1..=100).map(f64::from).collect();
    assert_eq!([0.5, 0.95, 1.0].map(|part| quantile(&values, part)), [Some(50.0), Some(95.0), Some(100.0)]);
    assert_eq!(quantile(&[3.0], 0.95), Some(3.0));
    assert_eq!(quantile(&[], 0.5), None);
}
