//! Promise: `foliate new` finds grasps for hands that cannot take every pose: an arm of five joints with two jaws or with one that turns, or with
//! axes that are a little off, a
//! mobile robot whose hand tilts by 30 degrees at all times, which drives by a planar joint of its own, and one that has to drive to where
//! its telescope reaches. Their scenes solve and are proved.
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

/// A hand on a link: a jaw that turns about z against one that is fixed. Half open it stands across the way of the object.
fn single_jaw(on: &str, at: &str) -> String {
    let mut text = link("palm", "0.03 0.05 0.03", "0.015 0.005 0");
    text += &joint("mount", "fixed", (on, "palm"), (at, "0 0 0"), "1 0 0", [0.0, 0.0]);
    text += &link("fixed_jaw", "0.1 0.008 0.02", "0.05 -0.004 0");
    text += &joint("fixed", "fixed", ("palm", "fixed_jaw"), ("0.03 0 0", "0 0 0"), "1 0 0", [0.0, 0.0]);
    text += &link("moving_jaw", "0.095 0.008 0.02", "0.05 -0.015 0");
    text + &joint("jaw", "revolute", ("palm", "moving_jaw"), ("0.032 0.02 0", "0 0 0"), "0 0 1", [-0.1, 1.7])
}

/// Turns about the vertical, three times about y, and about the hand's own axis. By `off` (roll, pitch, yaw) two of the axes are off.
fn five_joints(hand: &str, off: &str) -> String {
    let mut text = String::from("<robot name=\"five\">\n");
    text += &link("base", "0.1 0.1 0.1", "0 0 0.05");
    let mut add = |name: &str, parent: &str, at: &str, axis: &str, range: f64, sides: &str, middle: &str| {
        text += &link(name, sides, middle);
        let turn = if ["fore", "roll"].contains(&name) { off } else { "0 0 0" };
        text += &joint(&format!("{name}_joint"), "revolute", (parent, name), (at, turn), axis, [-range, range]);
    };
    add("waist", "base", "0 0 0.1", "0 0 1", 2.8, "0.06 0.06 0.06", "0 0 0.035");
    add("upper", "waist", "0 0 0.08", "0 1 0", 2.0, "0.03 0.05 0.26", "0 0 0.15");
    add("fore", "upper", "0 0 0.3", "0 1 0", 2.6, "0.22 0.04 0.03", "0.13 0 0");
    add("wrist", "fore", "0.26 0 0", "0 1 0", 2.0, "0.03 0.03 0.03", "0.03 0 0");
    add("roll", "wrist", "0.05 0 0", "1 0 0", 3.0, "0.02 0.03 0.03", "0.012 0 0");
    text + hand + "</robot>\n"
}

/// A base that has to drive (`--drives`): a mast and a lift, a telescope of four tubes to the side, and a wrist of three joints.
fn telescope() -> String {
    let mut text = String::from("<robot name=\"telescope\">\n");
    text += &link("base", "0.3 0.3 0.2", "0 0 0.12");
    text += &link("mast", "0.05 0.05 1.2", "0 0 0.6");
    text += &joint("mount_mast", "fixed", ("base", "mast"), ("-0.1 0.1 0.22", "0 0 0"), "1 0 0", [0.0, 0.0]);
    text += &link("lift", "0.1 0.1 0.08", "0.08 0 0");
    text += &joint("lift_joint", "prismatic", ("mast", "lift"), ("0 0 0.1", "0 0 0"), "0 0 1", [0.0, 1.0]);
    let mut carrier = String::from("lift");
    for (number, at) in [(4, "0.13 -0.06 0"), (3, "0 -0.01 0"), (2, "0 -0.01 0"), (1, "0 -0.01 0")] {
        let tube = format!("tube_{number}");
        let side = format!("{} 0.26 {}", 0.01 * f64::from(number + 1), 0.01 * f64::from(number + 1));
        text += &link(&tube, &side, "0 0 0");
        let bounds = if number == 4 { [0.0, 0.001] } else { [0.0, 0.13] };
        text += &joint(&format!("{tube}_joint"), "prismatic", (&carrier, &tube), (at, "0 0 0"), "0 -1 0", bounds);
        carrier = tube;
    }
    text += &link("yaw", "0.03 0.03 0.04", "0 0 -0.02");
    text += &joint("yaw_joint", "revolute", (&carrier, "yaw"), ("0 -0.15 -0.02", "0 0 0"), "0 0 1", [-1.75, 4.0]);
    text += &link("pitch", "0.03 0.02 0.02", "0.02 0 0");
    text += &joint("pitch_joint", "revolute", ("yaw", "pitch"), ("0 0 -0.05", "0 0 0"), "0 1 0", [-0.6, 1.57]);
    text += &link("roll", "0.02 0.03 0.03", "0.01 0 0");
    text += &joint("roll_joint", "revolute", ("pitch", "roll"), ("0.04 0 0", "0 0 0"), "1 0 0", [-3.0, 3.0]);
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
    moves(name, robot, options, &["box 0.04 0.04 0.1", "cylinder 0.018 0.1", "cup.obj"]);
}

fn moves(name: &str, robot: &str, options: &[&str], objects: &[&str]) {
    let folder = Folder::new(name);
    std::fs::write(folder.0.join("robot.urdf"), robot).expect("a model");
    std::fs::write(folder.0.join("cup.obj"), cup()).expect("a mesh");
    for object in objects {
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
    moves_three_objects("five-joints", &five_joints(&hand("roll", "0.025 0 0", "0 0 0"), "0 0 0"), &[]);
}

#[test]
fn an_arm_whose_axes_are_a_little_off_says_how_exactly_it_takes_objects() {
    let name = "off-axes";
    let robot = five_joints(&hand("roll", "0.025 0 0", "0 0 0"), "4e-6 0 4e-6");
    moves(name, &robot, &[], &["box 0.04 0.04 0.1"]);
    let exact = five_joints(&hand("roll", "0.025 0 0", "0 0 0"), "0 0 0");
    for (robot, is_off) in [(robot, true), (exact, false)] {
        let folder = Folder::new("off-axes-again");
        std::fs::write(folder.0.join("robot.urdf"), robot).expect("a model");
        let output = foliate(&folder, &["new", "s.toml", "--robot", "robot.urdf", "--object", "box 0.04 0.04 0.1"]);
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        let scene = std::fs::read_to_string(folder.0.join("s.toml")).expect("a scene");
        assert_eq!(scene.contains("\nprojection_tolerance = 5e-6\n"), is_off, "{scene}");
        // What paths could not keep is refused.
        let scene = format!("projection_tolerance = 1e-3\n{}", scene.replace("\nprojection_tolerance = 5e-6\n", "\n"));
        std::fs::write(folder.0.join("s.toml"), scene).expect("a scene");
        let output = foliate(&folder, &["solve", "s.toml"]);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        let words = ["s.toml", "projection_tolerance", "1e-3 is not between 1e-6 and 5e-6"];
        assert!(words.iter().all(|word| said(&output).contains(word)), "{}", said(&output));
    }
}

#[test]
fn a_jaw_that_turns_against_a_fixed_one_opens_as_wide_as_a_box_needs() {
    moves("single-jaw", &five_joints(&single_jaw("roll", "0.025 0 0"), "0 0 0"), &[], &["box 0.04 0.04 0.1"]);
}

#[test]
fn a_base_that_has_to_drive_moves_three_objects() {
    moves_three_objects("telescope", &telescope(), &["--drives"]);
}

#[test]
fn a_hand_that_tilts_moves_three_objects() {
    moves_three_objects("tilted", &tilted(), &["--table", "1.2 0.8 0.75"]);
}

#[test]
fn what_meets_nothing_stays_at_its_default_and_tubes_slide_in_one_another() {
    // A head on the mast, and a post that the lift meets where it is lowest.
    let mut more = link("head", "0.1 0.05 0.05", "0.05 0 0");
    more += &joint("head_joint", "revolute", ("mast", "head"), ("0 0 1.3", "0 0 0"), "0 0 1", [-2.0, 2.0]);
    more += &link("post", "0.1 0.1 0.1", "0 0 0");
    more += &joint("mount_post", "fixed", ("base", "post"), ("0 0.1 0.32", "0 0 0"), "1 0 0", [0.0, 0.0]);
    let folder = Folder::new("telescope-at-rest");
    std::fs::write(folder.0.join("robot.urdf"), telescope().replace("</robot>", &(more + "</robot>")))
        .expect("a model");
    let new = ["new", "s.toml", "--robot", "robot.urdf", "--object", "box 0.04 0.04 0.1", "--drives"];
    let output = foliate(&folder, &new);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let scene = std::fs::read_to_string(folder.0.join("s.toml")).expect("a scene");
    assert!(scene.contains("[\"tube_4\", \"tube_2\"], # telescope: "), "{scene}");
    assert!(scene.contains("\n\"robot/head_joint\" = 0.0\n"), "{scene}");
    assert!(!scene.contains("\n\"robot/lift_joint\" = 0.0\n"), "{scene}");
}
