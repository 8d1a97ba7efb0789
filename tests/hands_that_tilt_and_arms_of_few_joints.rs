//! Promise: `foliate new` finds grasps for hands that cannot take every pose: an arm of five joints, and a mobile robot whose hand tilts
//! by 30 degrees at all times, which drives by a planar joint of its own. Their scenes solve and are proved.
#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

#[path = "common/recorded.rs"]
mod recorded;

use recorded::Folder;
use std::fmt::Write;
use std::process::{Command, Output};

fn foliate(folder: &Folder, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
    command.args(arguments).current_dir(&folder.0).arg("--no-mesh-cache").output().expect("the program runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// A link with one box: its sides, and the middle of it.
fn link(name: &str, sides: &str, middle: &str) -> String {
    let solid = format!("<origin xyz=\"{middle}\"/><geometry><box size=\"{sides}\"/></geometry>");
    format!("<link name=\"{name}\"><collision>{solid}</collision></link>\n")
}

/// A joint: kind, parent and child, origin as `xyz` and `rpy`, axis, limits.
fn joint(
    name: &str,
    kind: &str,
    (parent, child): (&str, &str),
    (xyz, rpy): (&str, &str),
    axis: &str,
    limits: [f64; 2],
) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
         <origin xyz=\"{xyz}\" rpy=\"{rpy}\"/><axis xyz=\"{axis}\"/><limit lower=\"{}\" upper=\"{}\" effort=\"1\" velocity=\"1\"/></joint>\n",
        limits[0], limits[1]
    )
}

/// A hand on a link: two fingers that slide along y and reach along x.
fn hand(on: &str, at: &str, rpy: &str) -> String {
    let mut text = link("palm", "0.03 0.12 0.03", "0.015 0 0");
    text += &joint("mount", "fixed", (on, "palm"), (at, rpy), "1 0 0", [0.0, 0.0]);
    for (name, y, axis) in [("left", "0.005", "0 1 0"), ("right", "-0.005", "0 -1 0")] {
        let finger = format!("{name}_finger");
        text += &link(&finger, "0.07 0.01 0.02", "0.035 0 0");
        text += &joint(
            &format!("{name}_jaw"),
            "prismatic",
            ("palm", &finger),
            (&format!("0.03 {y} 0"), "0 0 0"),
            axis,
            [0.0, 0.04],
        );
    }
    text
}

/// Turns about the vertical, three times about y, and about the hand's own axis.
fn five_joints() -> String {
    let mut text = String::from("<robot name=\"five\">\n");
    text += &link("base", "0.1 0.1 0.1", "0 0 0.05");
    let mut add = |name: &str, parent: &str, at: &str, axis: &str, range: f64, sides: &str, middle: &str| {
        text += &link(name, sides, middle);
        text += &joint(&format!("{name}_joint"), "revolute", (parent, name), (at, "0 0 0"), axis, [-range, range]);
    };
    add("waist", "base", "0 0 0.1", "0 0 1", 2.8, "0.06 0.06 0.06", "0 0 0.035");
    add("upper", "waist", "0 0 0.08", "0 1 0", 2.0, "0.03 0.05 0.26", "0 0 0.15");
    add("fore", "upper", "0 0 0.3", "0 1 0", 2.6, "0.22 0.04 0.03", "0.13 0 0");
    add("wrist", "fore", "0.26 0 0", "0 1 0", 2.0, "0.03 0.03 0.03", "0.03 0 0");
    add("roll", "wrist", "0.05 0 0", "1 0 0", 3.0, "0.02 0.03 0.03", "0.012 0 0");
    text + &hand("roll", "0.025 0 0", "0 0 0") + "</robot>\n"
}

/// A base that drives by a planar joint, a lift, an arm that slides out, a wrist that turns about the vertical, and a hand that looks
/// down by 30 degrees.
fn tilted() -> String {
    let mut text = String::from("<robot name=\"tilted\">\n<link name=\"floor\"/>\n");
    text += &link("base", "0.3 0.3 0.2", "0 0 0.12");
    text += &joint("drive", "planar", ("floor", "base"), ("0 0 0", "0 0 0"), "0 0 1", [0.0, 0.0]);
    text += &link("mast", "0.05 0.05 1.2", "0 0 0.6");
    text += &joint("mount_mast", "fixed", ("base", "mast"), ("-0.1 0 0.22", "0 0 0"), "1 0 0", [0.0, 0.0]);
    text += &link("lift", "0.1 0.1 0.08", "0.08 0 0");
    text += &joint("lift_joint", "prismatic", ("mast", "lift"), ("0 0 0.1", "0 0 0"), "0 0 1", [0.0, 1.0]);
    text += &link("arm", "0.4 0.05 0.05", "0.0 0 0");
    text += &joint("arm_joint", "prismatic", ("lift", "arm"), ("0.1 0 0", "0 0 0"), "1 0 0", [0.1, 0.5]);
    text += &link("wrist", "0.04 0.04 0.06", "0 0 -0.04");
    text += &joint("wrist_joint", "revolute", ("arm", "wrist"), ("0.23 0 -0.03", "0 0 0"), "0 0 1", [-1.7, 1.7]);
    text + &hand("wrist", "0.03 0 -0.05", "0 0.5236 0") + "</robot>\n"
}

/// A tapered cup as an OBJ of 16 sides, metres.
fn cup() -> String {
    let mut text = String::new();
    for (r, z) in [(0.016, 0.0), (0.02, 0.09)] {
        for i in 0..16 {
            let angle = std::f64::consts::TAU * f64::from(i) / 16.0;
            let _ = writeln!(text, "v {} {} {z}", r * angle.cos(), r * angle.sin());
        }
    }
    text += "v 0 0 0\nv 0 0 0.09\n";
    for i in 0..16 {
        let (a, b) = (i + 1, (i + 1) % 16 + 1);
        let _ = writeln!(
            text,
            "f {a} {b} {}\nf {a} {} {}\nf 33 {b} {a}\nf 34 {} {}",
            b + 16,
            b + 16,
            a + 16,
            a + 16,
            b + 16
        );
    }
    text
}

fn moves_three_objects(name: &str, robot: &str, options: &[&str]) {
    let folder = Folder::new(name);
    std::fs::write(folder.0.join("robot.urdf"), robot).expect("a model");
    std::fs::write(folder.0.join("cup.obj"), cup()).expect("a mesh");
    for object in ["box 0.04 0.04 0.1", "cylinder 0.018 0.1", "cup.obj"] {
        let new = [&["new", "s.toml", "--force", "--robot", "robot.urdf", "--object", object], options].concat();
        let output = foliate(&folder, &new);
        assert_eq!(output.status.code(), Some(0), "{object}: {}", said(&output));
        let output = foliate(&folder, &["solve", "s.toml", "--first", "--seed", "7", "--out", "s.json"]);
        assert_eq!(output.status.code(), Some(0), "{object}: {}", said(&output));
        let output = foliate(&folder, &["check", "s.json"]);
        assert_eq!(output.status.code(), Some(0), "{object}: {}", said(&output));
    }
}

#[test]
fn an_arm_of_five_joints_moves_three_objects() {
    moves_three_objects("five-joints", &five_joints(), &[]);
}

#[test]
fn a_hand_that_tilts_moves_three_objects() {
    moves_three_objects("tilted", &tilted(), &["--table", "1.2 0.8 0.75"]);
}
