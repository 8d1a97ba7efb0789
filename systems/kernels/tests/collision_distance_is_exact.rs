//! The clearance of two solids never exceeds their distance, and falls short of it by no more than it says.

#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{box_mesh, random_geometry, random_pose};
use foliate_components::Pose;
use foliate_components::robot::shape::Geometry;
use foliate_kernels::collision::{DistanceQuery, Solid, clearance};
use glam::DVec3;
use parry3d_f64::query;
use parry3d_f64::shape::{Ball, Capsule, Cuboid, Cylinder, Shape, TriMesh};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

const KINDS: [&str; 5] = ["sphere", "box", "cylinder", "capsule", "mesh"];

/// parry's shape, and the pose that turns its axis (y) into ours (z).
fn parry(geometry: &Geometry) -> (Box<dyn Shape>, Pose) {
    let turn = Pose::from_rotation(glam::DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2));
    match geometry {
        Geometry::Sphere { radius } => (Box::new(Ball::new(*radius)), Pose::IDENTITY),
        Geometry::Box { half_extents } => (Box::new(Cuboid::new(*half_extents)), Pose::IDENTITY),
        Geometry::Cylinder { radius, half_length } => (Box::new(Cylinder::new(*half_length, *radius)), turn),
        Geometry::Capsule { radius, half_length } => (Box::new(Capsule::new_y(*half_length, *radius)), turn),
        Geometry::Mesh(mesh) => {
            let mesh = TriMesh::new(mesh.vertices.clone(), mesh.triangles.clone()).expect("a mesh");
            (Box::new(mesh), Pose::IDENTITY)
        }
    }
}

fn parry_distance(a: &Geometry, X_WA: &Pose, b: &Geometry, X_WB: &Pose) -> f64 {
    let ((a, turn_a), (b, turn_b)) = (parry(a), parry(b));
    query::distance(&(*X_WA * turn_a), &*a, &(*X_WB * turn_b), &*b).expect("a supported pair").distance
}

fn exact(a: &Geometry, X_WA: &Pose, b: &Geometry, X_WB: &Pose) -> f64 {
    clearance(&Solid::of(a), X_WA, &Solid::of(b), X_WB, DistanceQuery::exact(1e9), &mut DVec3::ZERO.clone())
}

#[test]
fn agrees_with_parry_for_all_kinds() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for (first, name) in KINDS.into_iter().enumerate() {
        for (second, other) in KINDS.into_iter().enumerate() {
            let rounds = if first == 4 || second == 4 { 60 } else { 2000 };
            let (mut apart, mut above, mut below) = (0, 0.0_f64, 0.0_f64);
            for _ in 0..rounds {
                let (a, b) = (random_geometry(&mut rng, first), random_geometry(&mut rng, second));
                let (X_WA, X_WB) = (random_pose(&mut rng, 0.4), random_pose(&mut rng, 0.4));
                let (ours, theirs) = (exact(&a, &X_WA, &b, &X_WB), parry_distance(&a, &X_WA, &b, &X_WB));
                if theirs <= 1e-9 {
                    assert!(ours < 1e-5, "{name}-{other}: parry says overlap, we say {ours}");
                    continue;
                }
                apart += 1;
                above = above.max(ours - theirs);
                below = below.max(theirs - ours);
            }
            println!("{name:9} {other:9} {apart:5} apart: at most {above:9.2e} above, {below:9.2e} below parry");
            assert!(above < 1e-9, "{name}-{other} too large by {above}");
            // parry's own distances are too large by this much: its relative tolerance is the root of 2e-15.
            assert!(below < 3e-5, "{name}-{other} too small by {below}");
        }
    }
}

/// The point of a solid closest to `p`, both in the solid's frame; written for this test alone.
fn project(geometry: &Geometry, p: DVec3) -> DVec3 {
    match geometry {
        Geometry::Sphere { radius } => p.clamp_length_max(*radius),
        Geometry::Box { half_extents } => p.clamp(-*half_extents, *half_extents),
        Geometry::Cylinder { radius, half_length } => {
            let across = p.truncate().clamp_length_max(*radius);
            across.extend(p.z.clamp(-*half_length, *half_length))
        }
        Geometry::Capsule { radius, half_length } => {
            let on_axis = DVec3::Z * p.z.clamp(-*half_length, *half_length);
            on_axis + (p - on_axis).clamp_length_max(*radius)
        }
        Geometry::Mesh(_) => unreachable!("not convex"),
    }
}

#[test]
fn is_within_a_micrometre_of_alternating_projections() {
    // Von Neumann's method: slow, sure, and always above the distance.
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    let (mut worst, mut counted) = (0.0_f64, 0);
    for round in 0..20_000 {
        let (a, b) = (random_geometry(&mut rng, round % 4), random_geometry(&mut rng, round / 4 % 4));
        let (X_WA, X_WB) = (random_pose(&mut rng, 0.4), random_pose(&mut rng, 0.4));
        let ours = exact(&a, &X_WA, &b, &X_WB);
        let X_AB = X_WA.inverse() * X_WB;
        let mut q = X_AB.translation;
        let mut upper = f64::INFINITY;
        for _ in 0..if ours > 0.0 { 2_000_000 } else { 100 } {
            let p = project(&a, q);
            q = X_AB.transform_point(project(&b, X_AB.inverse_transform_point(p)));
            let distance = p.distance(q);
            upper = distance;
            if upper - ours < 1.5e-6 {
                break;
            }
        }
        assert!(ours <= upper, "{ours} is above {upper}");
        // Between sets that overlap the method may take for ever.
        if ours > 0.0 {
            counted += 1;
            worst = worst.max(upper - ours);
        }
    }
    println!("{counted} pairs apart: at most {worst:.2e} below alternating projections");
    assert!(worst < 2e-6, "{worst}");
}

#[test]
fn an_answer_that_is_not_enough_is_nearly_exact() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for round in 0..4000 {
        let (a, b) = (random_geometry(&mut rng, round % 5), random_geometry(&mut rng, round / 5 % 5));
        let (X_WA, X_WB) = (random_pose(&mut rng, 0.4), random_pose(&mut rng, 0.4));
        let truth = exact(&a, &X_WA, &b, &X_WB);
        let needed = 0.1;
        let ask = DistanceQuery { relative: 0.1, ..DistanceQuery::exact(needed) };
        let mut hint = DVec3::ZERO;
        for _ in 0..2 {
            let found = clearance(&Solid::of(&a), &X_WA, &Solid::of(&b), &X_WB, ask, &mut hint);
            assert!(found <= truth.max(0.0) + 2e-6);
            if truth > 0.0 {
                assert!(found >= needed || found >= 0.9 * truth - 2e-6, "{found} of {truth}");
            } else {
                assert!(found <= 0.0);
            }
            // With a floor: enough, or above the floor, or exact.
            let ask = DistanceQuery { floor: 0.01, ..DistanceQuery::exact(needed) };
            let found = clearance(&Solid::of(&a), &X_WA, &Solid::of(&b), &X_WB, ask, &mut hint);
            assert!(found <= truth.max(0.0) + 2e-6);
            assert!(found >= 0.01 || found >= truth.min(0.01) - 2e-6, "{found} of {truth}");
            assert!(found >= needed || truth < needed + 2e-6, "{found} of {truth}");
        }
    }
}

#[test]
fn a_box_is_the_same_as_a_mesh() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    for round in 0..1500 {
        let half = DVec3::new(0.2, 0.1, 0.3);
        let (solid, mesh) = (Geometry::Box { half_extents: half }, Geometry::Mesh(Arc::new(box_mesh(half, 5))));
        let other = random_geometry(&mut rng, round % 5);
        let (X_WA, X_WB) = (random_pose(&mut rng, 0.5), random_pose(&mut rng, 0.5));
        let (as_box, as_mesh) = (exact(&solid, &X_WA, &other, &X_WB), exact(&mesh, &X_WA, &other, &X_WB));
        if as_box > 0.0 {
            assert!((as_box - as_mesh).abs() < 3e-6, "{as_box} {as_mesh}");
            assert!((as_mesh - exact(&other, &X_WB, &mesh, &X_WA)).abs() < 3e-6);
        }
    }
}

#[test]
fn what_is_not_a_number_collides() {
    let ball = Solid::of(&Geometry::Sphere { radius: 0.1 });
    let cuboid = Solid::of(&Geometry::Box { half_extents: DVec3::ONE });
    let mesh = Solid::of(&Geometry::Mesh(Arc::new(box_mesh(DVec3::ONE, 2))));
    let far = Pose::from_translation(DVec3::X * 9.0);
    for bad in [f64::NAN, f64::INFINITY] {
        let lost = Pose::from_translation(DVec3::new(bad, 0.0, 0.0));
        for a in [&ball, &cuboid, &mesh] {
            for b in [&ball, &cuboid, &mesh] {
                for (p, q) in [(&far, &lost), (&lost, &far), (&lost, &lost)] {
                    assert!(clearance(a, p, b, q, DistanceQuery::exact(0.1), &mut DVec3::ZERO.clone()) < 0.0);
                }
            }
        }
    }
    let broken = Solid::of(&Geometry::Box { half_extents: DVec3::NAN });
    assert!(
        clearance(&broken, &far, &cuboid, &Pose::IDENTITY, DistanceQuery::exact(0.1), &mut DVec3::ZERO.clone()) <= 0.0
    );
}
