//! Promise: forward kinematics of published robots agrees with pinocchio to 1e-9 on random configurations.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

use foliate::components::pose::pose_from_array;
use foliate::components::robot::{PartKind, PartPlacement, Robot, RootJoint};
use foliate::components::{Pose, pose};
use foliate::kernels::kinematics::Kinematics;
use foliate::scene::{PackagePath, UpAxis, coordinate_names, read_model};
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Robot, root, and how mimic joints are read.
const ROBOTS: [(&str, RootJoint, bool); 10] = [
    ("baxter_description/urdf/baxter.urdf", RootJoint::Fixed, true),
    ("baxter_description/urdf/baxter.urdf", RootJoint::Fixed, false),
    ("romeo_description/urdf/romeo.urdf", RootJoint::FreeFlyer, true),
    ("romeo_description/urdf/romeo.urdf", RootJoint::FreeFlyer, false),
    ("pr2_description/urdf/pr2.urdf", RootJoint::Planar, true),
    ("talos_data/robots/talos_full_v2.urdf", RootJoint::FreeFlyer, true),
    ("ur_description/urdf/ur3_gripper.urdf", RootJoint::Fixed, true),
    ("ur_description/urdf/ur5_robot.urdf", RootJoint::Fixed, true),
    ("ur_description/urdf/ur10_robot.urdf", RootJoint::Fixed, true),
    ("panda_description/urdf/panda.urdf", RootJoint::Fixed, true),
];
const CONFIGURATIONS: usize = 25;

#[test]
fn link_poses_are_pinocchios() {
    let test = "link_poses_are_pinocchios";
    let Some(packages) = common::published_models(test) else { return };
    let Some(python) = common::skip::python_with("pinocchio, coal, numpy", test) else { return };
    for (file, root, follows) in ROBOTS {
        let urdf = format!("package://example-robot-data/robots/{file}");
        let robot = robot(&urdf, root, follows, &packages);
        let configurations = configurations(&robot);
        let poses = pinocchio(&python, &urdf, root, follows, &packages, &named(&robot, &configurations));
        let worst = compare(&robot, &configurations, &poses);
        assert!(worst.0 < 1e-9, "{file} ({root:?}, follows: {follows}): {} is off by {:.1e}", worst.1, worst.0);
    }
}

fn script() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/independent/kinematics.py")
}

fn robot(urdf: &str, root: RootJoint, mimic_follows: bool, packages: &PackagePath) -> Robot {
    let read = read_model(urdf, None, UpAxis::AsWritten, packages).unwrap_or_else(|e| panic!("{e}"));
    let placement = PartPlacement {
        name: "robot".into(),
        kind: PartKind::Robot,
        root,
        world_from_root: Pose::identity(),
        mimic_follows,
        root_bounds: Vec::new(),
        joint_bounds: Vec::new(),
    };
    Robot::compose(&[(&read.model, placement)]).unwrap_or_else(|e| panic!("{e}"))
}

/// Random configurations, within bounds where there are any.
fn configurations(robot: &Robot) -> Vec<Vec<f64>> {
    use rand_chacha::rand_core::SeedableRng;
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2);
    let draw = |_| {
        let mut q = robot.space.neutral();
        robot.space.random(&mut rng, &mut q);
        q
    };
    (0..CONFIGURATIONS).map(draw).collect()
}

fn named(robot: &Robot, configurations: &[Vec<f64>]) -> Vec<Value> {
    let names = coordinate_names(robot);
    let short = |name: &str| name.strip_prefix("robot/").unwrap_or(name).to_owned();
    configurations.iter().map(|q| names.iter().map(|n| short(n)).zip(q.iter().map(|x| json!(x))).collect()).collect()
}

fn pinocchio(
    python: &Path,
    urdf: &str,
    root: RootJoint,
    follows: bool,
    packages: &PackagePath,
    configurations: &[Value],
) -> Vec<Value> {
    let directory = packages.find("example-robot-data").expect("the package is at hand");
    let root = match root {
        RootJoint::Fixed => "fixed",
        RootJoint::FreeFlyer => "freeflyer",
        RootJoint::Planar => "planar",
    };
    let request = json!({
        "urdf": urdf, "package_path": [directory.parent()], "root": root,
        "mimic": if follows { "follow" } else { "free" }, "configurations": configurations, "links": [],
    });
    let mut child = Command::new(python)
        .arg(script())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("python runs");
    let mut input = child.stdin.take().expect("piped");
    input.write_all(request.to_string().as_bytes()).expect("the script reads its request");
    drop(input);
    let output = child.wait_with_output().expect("the script ends");
    assert!(output.status.success(), "{urdf}: {}", String::from_utf8_lossy(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).expect("the answer is JSON");
    answer["poses"].as_array().expect("poses").clone()
}

/// The largest difference of a position (m) or rotation (rad), and its link.
fn compare(robot: &Robot, configurations: &[Vec<f64>], poses: &[Value]) -> (f64, String) {
    let kinematics = Kinematics::new(robot);
    let mut bodies = vec![Pose::identity(); kinematics.bodies()];
    let mut worst = (0.0, String::new());
    assert_eq!(configurations.len(), poses.len());
    for (q, poses) in configurations.iter().zip(poses) {
        kinematics.forward(q, &mut bodies);
        assert_eq!(poses.as_object().map(serde_json::Map::len), Some(robot.links.len()));
        for link in &robot.links {
            let ours = link.joint.map_or(link.joint_from_link, |j| bodies[j.at()] * link.joint_from_link);
            let numbers: Vec<f64> = poses[&link.name["robot/".len()..]]
                .as_array()
                .map(|v| v.iter().filter_map(Value::as_f64).collect())
                .unwrap_or_default();
            let theirs = <[f64; 7]>::try_from(numbers).ok().and_then(pose_from_array).expect("a pose");
            let turn = pose::log_so3(ours.rotation.conjugate() * theirs.rotation).length();
            let difference = ours.translation.distance(theirs.translation).max(turn);
            if difference > worst.0 {
                worst = (difference, link.name.clone());
            }
        }
    }
    worst
}
