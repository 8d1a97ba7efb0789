//! A scene whose graph is too large to list: `foliate graph` says so and shows what surrounds the start, `foliate solve` answers,
//! and `foliate check` proves the answer.
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The demo's table with one of four two-armed robots at it and twenty boxes with a handle each: 8 grippers × 20 handles.
fn scene() -> String {
    let mut text = String::from(
        "format = \"foliate.scene/1\"\nname = \"crowd\"\ndescription = \"Four robots and twenty boxes\"\n\
         [[part]]\nname = \"table\"\nkind = \"environment\"\nurdf = \"table.urdf\"\nsrdf = \"table.srdf\"\n\
         pose = { xyz = [0.60, 0.0, 0.0] }\n",
    );
    let (mut grippers, mut locked, mut start) = (Vec::new(), String::new(), String::new());
    for robot in 0..4 {
        let _ = write!(
            text,
            "[[part]]\nname = \"robot{robot}\"\nkind = \"robot\"\nurdf = \"robot.urdf\"\nsrdf = \"robot.srdf\"\n\
             pose = {{ xyz = [0.0, {}.0, 0.0] }}\n",
            3 * robot
        );
        for side in ["left", "right"] {
            grippers.push(format!("\"robot{robot}/{side}_hand\""));
            let _ = writeln!(locked, "\"robot{robot}/{side}_finger\" = 0.032");
        }
        let _ = writeln!(start, "robot{robot} = \"ready\"");
    }
    for number in 0..20 {
        let _ = write!(
            text,
            "[[part]]\nname = \"box{number}\"\nkind = \"object\"\nurdf = \"box.urdf\"\nsrdf = \"box.srdf\"\n\
             root_bounds = [[0.2, 1.0], [-0.7, 0.7], [0.6, 1.5]]\n"
        );
        // Box 0 in front, the others in two rows behind.
        let (x, y) = match number {
            0 => (0.50, 0.10),
            _ => (0.76 + 0.08 * f64::from(number % 2), -0.54 + 0.11 * f64::from((number - 1) / 2)),
        };
        let _ = writeln!(start, "box{number} = {{ xyz = [{x:.3}, {y:.3}, 0.741] }}");
    }
    let grippers = grippers.join(", ");
    text + &format!(
        "[graph]\ngrippers = [{grippers}]\nsupports = [\"table/top\"]\nplacement_margin = 0.001\n\
         preplacement_distance = 0.05\n[locked]\n{locked}[start]\n{start}\
         [[goal]]\nconfiguration = {{ box0 = {{ xyz = [0.50, -0.10, 0.741] }} }}\n"
    )
}

fn foliate(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_foliate")).args(arguments).output().unwrap()
}

struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn a_crowd_is_shown_solved_and_proved() {
    let folder = Folder(std::env::temp_dir().join(format!("foliate-crowd-{}", std::process::id())));
    std::fs::create_dir_all(&folder.0).unwrap();
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/demo");
    for name in ["box", "robot", "table"].into_iter().flat_map(|n| [format!("{n}.urdf"), format!("{n}.srdf")]) {
        std::fs::copy(demo.join(&name), folder.0.join(&name)).unwrap();
    }
    let at = |name: &str| folder.0.join(name).to_str().unwrap().to_owned();
    let (file, path) = (at("scene.toml"), at("path.json"));
    std::fs::write(&file, scene()).unwrap();

    let shown = foliate(&["graph", &file]);
    let text = String::from_utf8(shown.stdout).unwrap();
    assert!(shown.status.success(), "{}", String::from_utf8_lossy(&shown.stderr));
    assert!(text.starts_with("more than 1000 states: the graph grows while it is searched"), "{text}");
    // The start's state, and 8 × 20 grasps.
    assert!(text.contains("161 states, "), "{}", text.lines().nth(1).unwrap());
    assert!(text.contains("robot3/right_hand grasps box19/"), "{text}");
    assert_eq!(text.matches("not expanded yet").count(), 160);

    let solved = foliate(&["solve", &file, "--seed", "1", "--time-limit", "120", "--verbose", "--out", &path]);
    let told = [solved.stdout, solved.stderr].map(|text| String::from_utf8(text).unwrap()).concat();
    assert!(solved.status.success(), "{told}");
    assert!(told.contains("as much as was needed of the graph: "), "{told}");
    let checked = foliate(&["check", &path]);
    let told = [checked.stdout, checked.stderr].map(|text| String::from_utf8(text).unwrap()).concat();
    assert!(checked.status.success(), "{told}");
}
