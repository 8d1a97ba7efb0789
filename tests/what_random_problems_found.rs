//! What random problems have found (`every_answer_is_proved.rs`), each as the smallest scene in which solve and check
//! disagreed.

#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

#[path = "common/written.rs"]
mod written;

use foliate::Planner;
use foliate::check::{CheckOptions, Verdict, check};
use foliate::path_file::save;
use foliate::scene::{PackagePath, Scene};
use std::path::{Path, PathBuf};
use written::written;

/// A folder of this test's own, removed at its end.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

/// A slide whose carriage turns, and what is written on its links.
fn slide(rigid_attachment: &str, wheel: &str) -> String {
    format!(
        r#"<robot name="slide"><link name="rail"/>
        <joint name="along" type="prismatic"><parent link="rail"/><child link="carriage"/><axis xyz="1 0 0"/>
        <limit lower="0" upper="1" velocity="1" effort="1"/></joint><link name="carriage">{rigid_attachment}</link>
        <joint name="turn" type="revolute"><parent link="carriage"/><child link="wheel"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="1" velocity="1" effort="1"/></joint><link name="wheel">{wheel}</link></robot>"#
    )
}

fn shape(geometry: &str) -> String {
    format!("<collision><geometry>{geometry}</geometry></collision>")
}

/// The verdict on a path of the slide from one end to the other, in a scene with more parts and keys of the slide's.
fn verdict(name: &str, files: &[(&str, &str)], keys: &str, parts: &str) -> (Verdict, Vec<String>) {
    let folder = Folder(Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("found-{name}-{}", std::process::id())));
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let scene = format!(
        "format = \"foliate.scene/1\"\nname = \"{name}\"\n[[part]]\nname = \"slide\"\nkind = \"robot\"\nurdf = \"slide.urdf\"\n\
         {keys}\n{parts}\n[graph]\n[start]\n\"slide/along\" = 0.0\n[[goal]]\nconfiguration = {{ \"slide/along\" = 1.0 }}\n"
    );
    for (name, content) in files.iter().chain(&[("scene.toml", scene.as_str())]) {
        std::fs::write(folder.0.join(name), content).expect("a file");
    }
    let scene = Scene::load(&folder.0.join("scene.toml").to_string_lossy(), &PackagePath::only(&[])).expect("a scene");
    let planner = Planner::new(scene.problem.clone()).expect("a problem");
    let solution = planner.solve_on(1).expect("the way is free");
    let out = folder.0.join("path.json");
    let path = solution.path;
    save::save(&written(&scene, &solution.model.graph, &path, &out), &out).expect("a path file");
    let file = save::read(&out).expect("a path file");
    let report = check(&file, &folder.0, &PackagePath::only(&[]), &CheckOptions::default()).expect("a path");
    (report.verdict(), report.violations.iter().map(ToString::to_string).collect())
}

const BALL: &str = r#"<sphere radius="0.05"/>"#;

/// The leaf and the frame of a door that stands still are one body to both.
#[test]
fn pairs_within_an_environment_are_counted_alike_wherever_its_joints_stand() {
    let door = r#"<robot name="door"><link name="frame"><collision><geometry><box size="0.1 0.1 1"/></geometry></collision></link>
        <joint name="hinge" type="revolute"><origin xyz="0.1 0 0"/><parent link="frame"/><child link="leaf"/><axis xyz="0 0 1"/>
        <limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
        <link name="leaf"><collision><origin xyz="0.3 0 0"/><geometry><box size="0.5 0.02 1"/></geometry></collision></link></robot>"#;
    let parts = "[[part]]\nname = \"door\"\nkind = \"environment\"\nurdf = \"door.urdf\"\nvalues = { hinge = 1.2 }\n\
                 pose = { xyz = [0.5, 2.0, 0.0] }";
    let robot = slide(&shape(BALL), "");
    let found = verdict("door", &[("slide.urdf", &robot), ("door.urdf", door)], "", parts);
    assert_eq!(found, (Verdict::Proved, Vec::new()));
}

/// A pair that is one of neighbours and ignored by name is counted once, for the same reason.
#[test]
fn a_pair_that_is_left_out_twice_is_counted_alike() {
    let robot = slide(&shape(BALL), &shape(BALL));
    let keys = "ignore = [\"adjacent\", [\"wheel\", \"carriage\"]]";
    assert_eq!(verdict("twice", &[("slide.urdf", &robot)], keys, "").1, Vec::<String>::new());
}

/// What lies inside a closed mesh touches it as a neighbour, though no surfaces meet.
#[test]
fn neighbours_may_lie_inside_each_other() {
    let tetrahedron = "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
    let robot = slide(&shape(r#"<mesh filename="hull.obj"/>"#), &shape(BALL));
    let found = verdict("inside", &[("slide.urdf", &robot), ("hull.obj", tetrahedron)], "", "");
    assert_eq!(found, (Verdict::Proved, Vec::new()));
}
