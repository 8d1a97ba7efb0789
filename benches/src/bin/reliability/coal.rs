//! Distances between random solids against coal's, which is other people's code.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::page::{Figure, quantile};
use crate::{Result, scenes};
use foliate_components::Pose;
use foliate_components::pose::pose_to_array;
use foliate_components::robot::shape::{Geometry, Mesh};
use foliate_kernels::collision::{DistanceQuery, Solid, clearance};
use glam::{DQuat, DVec3};
use rand::RngExt;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

/// Pairs of one request.
const CHUNK: usize = 5_000;
/// Beyond it the two disagree, metres: coal's GJK stops at 1e-6.
const AGREE: f64 = 1e-5;

pub(crate) fn measure(size: usize) -> Result<Figure> {
    let how = format!(
        "{size} random pairs of spheres, boxes, cylinders, capsules and closed convex meshes; where coal says that they are apart our distance is \
         compared with its own, where it says that they overlap ours has to be below {AGREE:e} m."
    );
    let mut figure = Figure::new("Distances against coal", how);
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut off = Vec::new();
    let [mut overlaps, mut disagreements] = [0_u64; 2];
    for begin in (0..size).step_by(CHUNK) {
        let pairs: Vec<_> =
            (begin..size.min(begin + CHUNK)).map(|_| [solid(&mut random), solid(&mut random)]).collect();
        let Some(theirs) = ask(&pairs)? else {
            figure.row("skipped", "python3 has no coal; FOLIATE_PYTHON names another");
            return Ok(figure);
        };
        for ([(a, X_WA), (b, X_WB)], (distance, collide)) in pairs.iter().zip(theirs) {
            let ours = clearance(
                &Solid::of(a),
                X_WA,
                &Solid::of(b),
                X_WB,
                DistanceQuery::exact(1e9),
                &mut DVec3::ZERO.clone(),
            );
            if collide {
                overlaps += 1;
                disagreements += u64::from(ours > AGREE);
            } else {
                let apart = (ours - distance).abs();
                disagreements += u64::from(apart > AGREE);
                off.push(apart);
            }
        }
        scenes::progress("coal", begin + pairs.len(), size);
    }
    off.sort_by(f64::total_cmp);
    figure.row("apart", off.len());
    figure.row("overlapping", overlaps);
    for (name, share) in [("p50", 0.5), ("p99", 0.99), ("max", 1.0)] {
        figure.row(&format!("difference, {name} (m)"), format!("{:.1e}", quantile(&off, share)));
    }
    figure.zero("disagreements", disagreements);
    Ok(figure)
}

fn solid(random: &mut ChaCha8Rng) -> (Geometry, Pose) {
    let mut length = || random.random_range(0.02..0.4);
    let (a, b, c) = (length(), length(), length());
    let geometry = match random.random_range(0..5) {
        0 => Geometry::Sphere { radius: a },
        1 => Geometry::Box { half_extents: DVec3::new(a, b, c) },
        2 => Geometry::Cylinder { radius: a, half_length: b },
        3 => Geometry::Capsule { radius: a, half_length: b },
        _ => Geometry::Mesh(Arc::new(tetrahedron(random))),
    };
    let mut number = || random.random_range(-1.0..1.0);
    let translation = DVec3::new(number(), number(), number()) * 0.6;
    let turn = DQuat::from_xyzw(number(), number(), number(), 1.1 + number()).normalize();
    (geometry, Pose::from_parts(translation, turn))
}

/// Counter-clockwise seen from outside.
fn tetrahedron(random: &mut ChaCha8Rng) -> Mesh {
    let mut corner = |along: DVec3| along * random.random_range(0.1..0.4);
    let corners = vec![corner(DVec3::ZERO), corner(DVec3::X), corner(DVec3::Y), corner(DVec3::Z)];
    Mesh::new("tetrahedron".into(), corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
}

/// What coal says of pairs: distance, and whether they collide. None where it is not there.
#[allow(clippy::type_complexity, reason = "read once")]
fn ask(pairs: &[[(Geometry, Pose); 2]]) -> Result<Option<Vec<(f64, bool)>>> {
    let python = std::env::var("FOLIATE_PYTHON").unwrap_or_else(|_| "python3".into());
    let is_there =
        Command::new(&python).args(["-c", "import coal"]).output().is_ok_and(|output| output.status.success());
    if !is_there {
        return Ok(None);
    }
    let side = |(geometry, pose): &(Geometry, Pose)| {
        let mut shape = match geometry {
            Geometry::Sphere { radius } => json!({ "shape": "sphere", "radius": radius }),
            Geometry::Box { half_extents } => json!({ "shape": "box", "size": (*half_extents * 2.0).to_array() }),
            Geometry::Cylinder { radius, half_length } => {
                json!({ "shape": "cylinder", "radius": radius, "length": 2.0 * half_length })
            }
            Geometry::Capsule { radius, half_length } => {
                json!({ "shape": "capsule", "radius": radius, "length": 2.0 * half_length })
            }
            Geometry::Mesh(mesh) => {
                let vertices: Vec<_> = mesh.vertices.iter().map(|v| v.to_array()).collect();
                json!({ "shape": "mesh", "vertices": vertices, "triangles": mesh.triangles })
            }
        };
        shape["pose"] = json!(pose_to_array(pose));
        shape
    };
    let pairs: Vec<_> = pairs.iter().map(|[a, b]| json!({ "a": side(a), "b": side(b) })).collect();
    let request = scenes::folder("coal")?.join("request.json");
    std::fs::write(&request, json!({ "pairs": pairs }).to_string())?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/independent/distances.py");
    let output = Command::new(&python).arg(script).arg(&request).output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    let answer: Value = serde_json::from_slice(&output.stdout)?;
    let results = answer["results"].as_array().ok_or("no results")?;
    let read = |r: &Value| Some((r["distance"].as_f64()?, r["collide"].as_bool()?));
    Ok(Some(results.iter().map(read).collect::<Option<_>>().ok_or("no distances")?))
}
