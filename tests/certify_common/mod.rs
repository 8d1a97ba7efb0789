//! Small scenes in which motions are certified: a ball on a slider, an arm in a plane, a box to carry.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]
#![allow(dead_code, reason = "each test uses its part")]

use foliate::certify::{
    Certifier, CertifyOptions, CertifyReport, Interpolation, Motion, Point, Turns, find_coordinate,
};
use foliate::components::problem::Problem;
use foliate::kernels::collision::CollisionScratch;
use foliate::scene::{PackagePath, Scene};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A folder of this test's own.
pub fn folder() -> PathBuf {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("foliate-certify-{}-{number}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

pub fn link(name: &str, geometry: &str, at: [f64; 3]) -> String {
    let [x, y, z] = at;
    let mass = r#"<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    let collision = match geometry {
        "" => String::new(),
        g => format!(r#"<collision><origin xyz="{x} {y} {z}"/><geometry>{g}</geometry></collision>"#),
    };
    format!(r#"<link name="{name}">{mass}{collision}</link>"#)
}

pub fn ball(radius: f64) -> String {
    format!(r#"<sphere radius="{radius}"/>"#)
}

pub fn cuboid(x: f64, y: f64, z: f64) -> String {
    format!(r#"<box size="{x} {y} {z}"/>"#)
}

/// A joint of a type about or along an axis, at x in its parent, within ±4, at most 2 per second.
pub fn joint(name: &str, kind: &str, axis: &str, parent: &str, child: &str, x: f64) -> String {
    let limit = if kind == "continuous" { "" } else { r#"lower="-4" upper="4""# };
    format!(
        r#"<joint name="{name}" type="{kind}"><origin xyz="{x} 0 0"/><axis xyz="{axis}"/><parent link="{parent}"/>
        <child link="{child}"/><limit {limit} effort="1" velocity="2"/></joint>"#
    )
}

/// A scene of parts (name, kind, further lines of the table, URDF), from its start on; what stands before that is the scene's own.
pub fn scene(parts: &[(&str, &str, &str, String)], rest: &str) -> Problem {
    let folder = folder();
    let (head, rest) = rest.split_at(rest.find("[start]").expect("a start"));
    let mut text = format!("format = \"foliate.scene/1\"\nname = \"test\"\n{head}");
    for (name, kind, more, urdf) in parts {
        let file = folder.join(format!("{name}.urdf"));
        std::fs::write(&file, format!(r#"<robot name="{name}">{urdf}</robot>"#)).expect("a model");
        text.push_str(&format!("[[part]]\nname = \"{name}\"\nkind = \"{kind}\"\nurdf = \"{name}.urdf\"\n{more}\n"));
    }
    text.push_str(rest);
    let scene = Scene::from_text("test", &text, &folder, &PackagePath::only(&[])).unwrap_or_else(|e| panic!("{e}"));
    std::fs::remove_dir_all(&folder).expect("the folder goes");
    scene.problem
}

/// A ball of radius 0.1 slides along x; a wall of half a metre begins at x = 1.
pub fn slider() -> Problem {
    let robot = link("base", "", [0.0; 3])
        + &link("ball", &ball(0.1), [0.0; 3])
        + &joint("slide", "prismatic", "1 0 0", "base", "ball", 0.0);
    let wall = link("wall", &cuboid(0.5, 4.0, 4.0), [1.25, 0.0, 0.0]);
    scene(
        &[("robot", "robot", "", robot), ("wall", "environment", "", wall)],
        "[start]\n\"robot/slide\" = 0.0\n[[goal]]\nconfiguration = { \"robot/slide\" = 0.5 }\n",
    )
}

/// A ball of radius 0.05 at the end of an arm of a metre that turns about z; another one where the arm is at one radian.
pub fn arm(margins: &str) -> Problem {
    let robot = link("base", "", [0.0; 3])
        + &link("arm", &ball(0.05), [1.0, 0.0, 0.0])
        + &joint("turn", "revolute", "0 0 1", "base", "arm", 0.0);
    let post = link("post", &ball(0.05), [1.0_f64.cos(), 1.0_f64.sin(), 0.0]);
    scene(
        &[("robot", "robot", "", robot), ("post", "environment", "", post)],
        &format!("{margins}[start]\n\"robot/turn\" = 0.0\n[[goal]]\nconfiguration = {{ \"robot/turn\" = 0.5 }}\n"),
    )
}

pub fn point(time: f64, positions: &[f64]) -> Point {
    Point { time: Some(time), positions: positions.to_vec(), ..Point::default() }
}

/// A motion of joints by name.
pub fn motion(problem: &Problem, joints: &[&str], points: &[Point], how: Interpolation) -> Motion {
    let robot = &problem.robot;
    let coordinates = joints.iter().map(|name| find_coordinate(robot, name).expect("a joint")).collect();
    Motion::through(robot, coordinates, points, how, Turns::Format).unwrap_or_else(|e| panic!("{e:?}"))
}

pub fn certify(problem: &Problem, motion: &Motion, options: &CertifyOptions) -> CertifyReport {
    let certifier = Certifier::new(problem, &[]).expect("a certifier");
    certifier.certify(motion, options, &mut CollisionScratch::new()).expect("a report")
}
