//! Distances agree with coal's, where Python has it (`pip install coal`); skipped, and said so, where it has not.
//! `FOLIATE_PYTHON` names another interpreter than `python3`.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;
#[path = "../../../tests/common/skip.rs"]
mod skip;

use collision_models::{random_geometry, random_pose};
use foliate_components::Pose;
use foliate_components::pose::pose_to_array;
use foliate_components::robot::shape::Geometry;
use foliate_kernels::collision::{DistanceQuery, Solid, clearance};
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Stdio};

/// Reads pairs, one solid per line: kind, numbers, pose; writes a distance for each pair.
const SCRIPT: &str = r#"
import sys
import numpy as np, coal

def shape(kind, v):
    if kind == "sphere": return coal.Sphere(v[0])
    if kind == "box": return coal.Box(2 * v[0], 2 * v[1], 2 * v[2])
    if kind == "cylinder": return coal.Cylinder(v[0], 2 * v[1])
    if kind == "capsule": return coal.Capsule(v[0], 2 * v[1])
    mesh = coal.BVHModelOBBRSS()
    corners = np.array(v).reshape(-1, 3)
    count = len(corners) // 3
    triangles = coal.StdVec_Triangle()
    for i in range(count): triangles.append(coal.Triangle(3 * i, 3 * i + 1, 3 * i + 2))
    vertices = coal.StdVec_Vec3s()
    for p in corners: vertices.append(p)
    mesh.beginModel(count, 3 * count)
    mesh.addSubModel(vertices, triangles)
    mesh.endModel()
    return mesh

def solid(line):
    words = line.split()
    v = [float(w) for w in words[1:]]
    x, y, z, qx, qy, qz, qw = v[-7:]
    return shape(words[0], v[:-7]), coal.Transform3s(coal.Quaternion(qw, qx, qy, qz) if hasattr(coal, "Quaternion") else quaternion(qx, qy, qz, qw), np.array([x, y, z]))

def quaternion(x, y, z, w):
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])

lines = sys.stdin.read().splitlines()
for i in range(0, len(lines), 2):
    (a, ma), (b, mb) = solid(lines[i]), solid(lines[i + 1])
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    request.enable_signed_distance = False
    hit = coal.CollisionResult()
    coal.collide(a, ma, b, mb, coal.CollisionRequest(), hit)
    print(0.0 if hit.isCollision() else coal.distance(a, ma, b, mb, request, result))
"#;

fn line(geometry: &Geometry, pose: &Pose) -> String {
    let mut text = geometry.kind().to_string();
    let mut add = |x: f64| write!(text, " {x:?}").unwrap();
    match geometry {
        Geometry::Sphere { radius } => add(*radius),
        Geometry::Box { half_extents } => half_extents.to_array().into_iter().for_each(&mut add),
        Geometry::Cylinder { radius, half_length } | Geometry::Capsule { radius, half_length } => {
            add(*radius);
            add(*half_length);
        }
        Geometry::Mesh(mesh) => {
            let corners = mesh.triangles.iter().flatten().flat_map(|&i| mesh.vertices[i as usize].to_array());
            corners.for_each(&mut add);
        }
    }
    pose_to_array(pose).into_iter().for_each(add);
    text
}

fn ask_coal(input: &str) -> Option<Vec<f64>> {
    let python = skip::python_with("coal", "collision_agrees_with_coal")?;
    let mut child =
        Command::new(&python).args(["-c", SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let text = input.to_string();
    let writer = std::thread::spawn(move || stdin.write_all(text.as_bytes()));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    assert!(output.status.success(), "coal's script failed");
    Some(String::from_utf8(output.stdout).unwrap().lines().map(|l| l.parse().unwrap()).collect())
}

#[test]
fn distances_of_all_kinds() {
    let mut rng = ChaCha8Rng::seed_from_u64(51);
    let mut pairs = Vec::new();
    for round in 0..2500 {
        let (a, b) = (random_geometry(&mut rng, round % 5), random_geometry(&mut rng, round / 5 % 5));
        pairs.push((a, random_pose(&mut rng, 0.4), b, random_pose(&mut rng, 0.4)));
    }
    let mut input = String::new();
    for (a, X_WA, b, X_WB) in &pairs {
        writeln!(input, "{}\n{}", line(a, X_WA), line(b, X_WB)).unwrap();
    }
    let Some(theirs) = ask_coal(&input) else { return };
    assert_eq!(theirs.len(), pairs.len());
    let (mut apart, mut hits, mut above, mut below) = (0, 0, 0.0_f64, 0.0_f64);
    for ((a, X_WA, b, X_WB), theirs) in pairs.iter().zip(theirs) {
        let ours =
            clearance(&Solid::of(a), X_WA, &Solid::of(b), X_WB, DistanceQuery::exact(1e9), &mut DVec3::ZERO.clone());
        if theirs <= 0.0 {
            hits += 1;
            assert!(ours < 1e-5, "{a:?} {b:?}: coal says overlap, we say {ours}");
        } else {
            apart += 1;
            above = above.max(ours - theirs);
            below = below.max(theirs - ours);
        }
    }
    println!("{apart} pairs apart, {hits} overlapping: at most {above:.2e} above, {below:.2e} below coal");
    // coal's GJK stops at 1e-6.
    assert!(above < 5e-6 && below < 5e-6, "{above} above, {below} below");
}
