//! Hulls of meshes are never farther apart than the meshes, along the direction that they name; what is certified with them
//! is free.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{at, box_mesh, compose, joint, link, placed, random_geometry, random_pose, single, star};
use foliate_components::Pose;
use foliate_components::robot::model::{JointKind, Model};
use foliate_components::robot::shape::{Geometry, Mesh};
use foliate_components::robot::{PartKind, Robot, RootJoint};
use foliate_kernels::collision::distance::hull_distance::{hull_distance, hull_gap};
use foliate_kernels::collision::{
    CertificateSettings, CollisionScene, CollisionScratch, DistanceQuery, MotionVerdict, PairRule, PairSet, Solid,
    certify_motion, clearance, pair_clearance,
};
use foliate_kernels::kinematics::Kinematics;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

fn vertices(geometry: &Geometry) -> &[DVec3] {
    match geometry {
        Geometry::Mesh(mesh) => &mesh.vertices,
        _ => &[],
    }
}

#[test]
fn hulls_are_never_farther_apart_than_what_is_in_them() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut apart, mut overlaps) = (0, 0);
    for round in 0..3000 {
        let (a, b) = (random_geometry(&mut rng, 4), random_geometry(&mut rng, round % 5));
        let (X_WA, X_WB) = (random_pose(&mut rng, 0.6), random_pose(&mut rng, 0.6));
        let (one, other) = (Solid::of(&a), Solid::of(&b));
        let mut n = DVec3::ZERO;
        let hulls = hull_distance(&one, &X_WA, &other, &X_WB, DistanceQuery::exact(1e9), &mut n);
        let truth = clearance(&one, &X_WA, &other, &X_WB, DistanceQuery::exact(1e9), &mut DVec3::ZERO.clone());
        if hulls <= 0.0 {
            overlaps += 1;
            continue;
        }
        apart += 1;
        assert!(hulls <= truth + 2e-6, "hulls {hulls} m apart, solids {truth} m");
        assert!((n.length() - 1.0).abs() < 1e-12);
        let gap = |n: DVec3| hull_gap(&one, &X_WA, &other, &X_WB, n);
        assert!((gap(n) - hulls).abs() < 1e-9, "{} m along the direction, not {hulls}", gap(n));
        let another = random_pose(&mut rng, 0.6).rotation * DVec3::X;
        assert!(gap(another) <= hulls + 2e-6, "{} m along another direction", gap(another));
        if round % 5 == 4 {
            let nearest = vertices(&a).iter().map(|p| n.dot(X_WA.transform_point(*p))).fold(f64::INFINITY, f64::min);
            let farthest = vertices(&b).iter().map(|p| n.dot(X_WB.transform_point(*p))).fold(-f64::INFINITY, f64::max);
            assert!(nearest - farthest >= hulls, "{} along the direction, not {hulls}", nearest - farthest);
        }
    }
    assert!(apart > 500 && overlaps > 100, "{apart} apart, {overlaps} not");
}

#[test]
fn hulls_of_convex_meshes_lose_little() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    for n in [1, 4, 12] {
        let h = DVec3::new(0.3, 0.1, 0.05);
        let (a, b) = (Geometry::Mesh(Arc::new(box_mesh(h, n))), Geometry::Mesh(Arc::new(ball(0.2))));
        let (a, b) = (Solid::of(&a), Solid::of(&b));
        for _ in 0..200 {
            let (X_WA, X_WB) = (random_pose(&mut rng, 1.0), random_pose(&mut rng, 1.0));
            let truth = clearance(&a, &X_WA, &b, &X_WB, DistanceQuery::exact(1e9), &mut DVec3::ZERO.clone());
            if truth > 0.02 {
                let hulls = hull_distance(&a, &X_WA, &b, &X_WB, DistanceQuery::exact(1e9), &mut DVec3::ZERO.clone());
                assert!(hulls >= truth - 0.01, "hulls {hulls} m apart, solids {truth} m");
            }
        }
    }
}

/// A ball of 40 · 80 vertices: more than a hull keeps.
fn ball(radius: f64) -> Mesh {
    let (rows, columns) = (40_u32, 80_u32);
    let mut vertices = Vec::new();
    for row in 0..=rows {
        let polar = std::f64::consts::PI * f64::from(row) / f64::from(rows);
        for column in 0..columns {
            let turn = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
            vertices.push(DVec3::new(polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos()) * radius);
        }
    }
    let id = |row: u32, column: u32| row * columns + column % columns;
    let quads = (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c)));
    let triangles = quads
        .flat_map(|(r, c)| [[id(r, c), id(r + 1, c), id(r + 1, c + 1)], [id(r, c), id(r + 1, c + 1), id(r, c + 1)]]);
    let triangles = triangles.collect();
    Mesh::new("ball".into(), vertices, triangles)
}

#[test]
fn hostile_meshes_have_no_hull() {
    let good = Solid::of(&Geometry::Mesh(Arc::new(ball(0.1))));
    let corner = DVec3::new(0.0, 0.0, f64::NAN);
    let broken = Mesh::new("broken".into(), vec![DVec3::ZERO, DVec3::X, corner], vec![[0, 1, 2]]);
    let empty = Mesh::new("empty".into(), Vec::new(), Vec::new());
    let far = at(5.0, 0.0, 0.0);
    for mesh in [broken, empty] {
        let solid = Solid::of(&Geometry::Mesh(Arc::new(mesh)));
        let found =
            hull_distance(&good, &Pose::IDENTITY, &solid, &far, DistanceQuery::exact(0.1), &mut DVec3::ZERO.clone());
        assert!(found < 0.0, "{found}");
    }
    let nowhere = at(f64::NAN, 0.0, 0.0);
    let found =
        hull_distance(&good, &Pose::IDENTITY, &good, &nowhere, DistanceQuery::exact(0.1), &mut DVec3::ZERO.clone());
    assert!(found < 0.0, "{found}");
}

/// Three crumpled links on revolute joints before a crumpled rock and a ball.
fn arm(rng: &mut ChaCha8Rng) -> Robot {
    let mut mesh = |radius: f64| Geometry::Mesh(Arc::new(star(rng, radius)));
    let mut model = Model { name: "arm".into(), ..Model::default() };
    model.links.push(link("base", vec![(Pose::IDENTITY, mesh(0.12))]));
    for (number, axis) in [DVec3::Z, DVec3::Y, DVec3::X, DVec3::Y].into_iter().enumerate() {
        model.links.push(link(&format!("link{number}"), vec![(at(0.2, 0.0, 0.0), mesh(0.1))]));
        let pose = at(if number == 0 { 0.1 } else { 0.35 }, 0.0, 0.0);
        model.joints.push(joint(&format!("j{number}"), JointKind::Revolute, number, number + 1, pose, axis));
    }
    let rock = single(vec![(Pose::IDENTITY, mesh(0.2))]);
    let drop = single(vec![(Pose::IDENTITY, Geometry::Sphere { radius: 0.1 })]);
    compose(&[
        (&model, placed("arm", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY)),
        (&rock, placed("rock", PartKind::Environment, RootJoint::Fixed, at(0.5, 0.6, 0.0))),
        (&drop, placed("drop", PartKind::Environment, RootJoint::Fixed, at(0.6, -0.4, 0.3))),
    ])
}

#[test]
fn dense_sampling_finds_nothing_in_what_hulls_certify() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let robot = arm(&mut rng);
    let scene = CollisionScene::new(&robot, &PairRule::default());
    let (kinematics, pairs) = (Kinematics::new(&robot), PairSet::new(&scene, &[], &[]));
    let mut scratch = CollisionScratch::new();
    let settings = CertificateSettings::default();
    let mut X_WJ = vec![Pose::IDENTITY; kinematics.bodies()];
    let (size, samples) = (robot.space.size(), 300);
    let mut least = |q: &[f64]| {
        kinematics.forward(q, &mut X_WJ);
        let of = |id| pair_clearance(&scene, id, &X_WJ, DistanceQuery::exact(0.05), &mut DVec3::ZERO.clone());
        pairs.moving_pairs(&scene).map(of).fold(f64::INFINITY, f64::min)
    };
    let (mut free, mut cut) = (0, 0);
    for round in 0..400 {
        let mut random = || (0..size).map(|_| rng.random_range(-1.8..1.8)).collect::<Vec<f64>>();
        let (a, other) = (random(), random());
        if least(&a) < 1e-4 {
            continue;
        }
        let reach = [0.1, 0.4, 1.0][round % 3];
        let b: Vec<f64> = a.iter().zip(&other).map(|(a, b)| a + reach * (b - a)).collect();
        let verdict = certify_motion(&scene, &kinematics, &[], &a, &b, &pairs, &settings, &mut scratch);
        let (proved, bound) = match verdict {
            MotionVerdict::Free { min_clearance_lower_bound } => (1.0, min_clearance_lower_bound),
            MotionVerdict::FreeUntil { t, .. } => (t, 0.0),
        };
        let mut q = vec![0.0; size];
        let mut hit = false;
        for i in 0..=samples {
            let t = f64::from(i) / f64::from(samples);
            robot.space.interpolate(&a, &b, t, &mut q);
            let clearance = least(&q);
            if t <= proved {
                assert!(clearance > 0.0 && clearance >= bound.min(0.05) - 2e-6, "{clearance} at {t}, proved {bound}");
            }
            hit |= clearance <= 0.02;
        }
        free += usize::from(proved >= 1.0);
        cut += usize::from(proved < 1.0);
        assert!(proved >= 1.0 || hit, "refused, but no sample is near anything");
    }
    assert!(free > 50 && cut > 50, "{free} free, {cut} cut");
}
