//! What lies wholly inside a closed mesh collides with it, although it touches no triangle.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{at, box_mesh, compose, cuboid, placed, random_rotation, random_vector, single, star};
use foliate_components::Pose;
use foliate_components::robot::shape::{Geometry, Mesh};
use foliate_components::robot::{PartKind, RootJoint};
use foliate_kernels::collision::solids::mesh_tree::MeshTree;
use foliate_kernels::collision::{
    CollisionScene, CollisionScratch, PairId, PairRule, PairSet, first_collision, min_clearance, pair_clearance,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// The solid angle of all triangles as seen from a point, over 4π (van Oosterom and Strackee): 1 inside, 0 outside.
fn winding_number(mesh: &Mesh, point: DVec3) -> f64 {
    let angle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.vertices[i as usize] - point);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    mesh.triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

#[test]
fn containment_agrees_with_the_winding_number() {
    let mut rng = ChaCha8Rng::seed_from_u64(41);
    let (mut inside, mut total) = (0, 0);
    for _ in 0..40 {
        let mesh = star(&mut rng, 0.5);
        assert!(mesh.closed);
        let tree = MeshTree::new(&mesh);
        for _ in 0..500 {
            let p = random_vector(&mut rng, 0.55);
            let winding = winding_number(&mesh, p);
            assert_eq!(tree.contains(p), winding > 0.5, "{p}: {winding}");
            inside += usize::from(winding > 0.5);
            total += 1;
        }
    }
    assert!(inside > total / 8 && inside < total * 7 / 8);
}

#[test]
fn points_in_line_with_edges_and_vertices_are_told_apart() {
    // Every grid point of a gridded cube is in line with edges and vertices along the axes.
    let mesh = box_mesh(DVec3::splat(0.4), 4);
    assert!(mesh.closed);
    let tree = MeshTree::new(&mesh);
    for i in -6..=6 {
        for j in -6..=6 {
            for k in -6..=6 {
                let p = DVec3::new(f64::from(i), f64::from(j), f64::from(k)) * 0.1;
                let reach = p.abs().max_element();
                if (reach - 0.4).abs() > 1e-9 {
                    assert_eq!(tree.contains(p), reach < 0.4, "{p}");
                }
            }
        }
    }
}

#[test]
fn overlapping_closed_parts_do_not_cancel_and_turned_ones_count() {
    // Two overlapping cubes as one mesh: in the overlap a ray leaves twice.
    let (one, other) = (box_mesh(DVec3::splat(0.4), 2), box_mesh(DVec3::new(0.6, 0.2, 0.2), 2));
    let shift = one.vertices.len() as u32;
    let vertices: Vec<DVec3> = one.vertices.iter().chain(&other.vertices).copied().collect();
    let triangles = one.triangles.iter().copied().chain(other.triangles.iter().map(|t| t.map(|i| i + shift)));
    let both = MeshTree::new(&Mesh::new("two".into(), vertices, triangles.collect()));
    assert!(both.is_closed());
    assert!(both.contains(DVec3::new(0.01, 0.02, 0.03)) && both.contains(DVec3::new(0.5, 0.1, 0.0)));
    assert!(!both.contains(DVec3::new(0.5, 0.3, 0.0)));
    // Triangles that face inwards bound the same solid.
    let turned = one.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert!(MeshTree::new(&Mesh::new("turned".into(), one.vertices.clone(), turned)).contains(DVec3::splat(0.1)));
}

#[test]
fn an_open_mesh_holds_nothing() {
    let mut mesh = box_mesh(DVec3::splat(0.4), 2);
    mesh.triangles.pop();
    let mesh = Mesh::new("open".into(), mesh.vertices, mesh.triangles);
    assert!(!mesh.closed && !MeshTree::new(&mesh).contains(DVec3::ZERO));
}

#[test]
fn a_box_inside_a_closed_mesh_collides() {
    let hull = single(vec![(at(0.0, 0.0, 0.3), Geometry::Mesh(Arc::new(box_mesh(DVec3::splat(0.5), 6))))]);
    let inner = [
        cuboid(0.1, 0.1, 0.1),
        Geometry::Sphere { radius: 0.05 },
        Geometry::Mesh(Arc::new(box_mesh(DVec3::splat(0.05), 1))),
    ];
    for geometry in inner {
        let object = single(vec![(at(0.02, 0.0, 0.0), geometry)]);
        let robot = compose(&[
            (&hull, placed("hull", PartKind::Environment, RootJoint::Fixed, Pose::IDENTITY)),
            (&object, placed("object", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
        ]);
        let scene = CollisionScene::new(&robot, &PairRule::default());
        let pairs = PairSet::new(&scene, &[], &[]);
        let mut scratch = CollisionScratch::new();
        let verdict = |pose: Pose, s: &mut CollisionScratch| first_collision(&scene, &[pose], &pairs, 1e-5, s);
        let inside = at(0.1, -0.1, 0.35);
        let ask = foliate_kernels::collision::DistanceQuery::exact(0.05);
        assert!(pair_clearance(&scene, PairId(0), &[inside], ask, &mut DVec3::ZERO.clone()) >= 0.05);
        assert_eq!(verdict(inside, &mut scratch).map(|c| c.clearance), Some(f64::NEG_INFINITY));
        assert_eq!(min_clearance(&scene, &[inside], pairs.moving_pairs(&scene)).unwrap().clearance, f64::NEG_INFINITY);
        assert!(verdict(at(0.48, 0.0, 0.3), &mut scratch).is_some());
        assert!(verdict(at(0.7, 0.0, 0.3), &mut scratch).is_none());
    }
}

#[test]
fn meshes_inside_each_other_are_told_whichever_is_first() {
    let mut rng = ChaCha8Rng::seed_from_u64(42);
    let (large, small) =
        (Geometry::Mesh(Arc::new(star(&mut rng, 0.5))), Geometry::Mesh(Arc::new(star(&mut rng, 0.05))));
    let models = [single(vec![(Pose::IDENTITY, large)]), single(vec![(Pose::IDENTITY, small)])];
    for [first, second] in [[0, 1], [1, 0]] {
        let robot = compose(&[
            (&models[first], placed("a", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
            (&models[second], placed("b", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
        ]);
        let scene = CollisionScene::new(&robot, &PairRule::default());
        let pairs = PairSet::new(&scene, &[], &[]);
        for _ in 0..100 {
            let shift = random_vector(&mut rng, 0.1);
            let here = Pose::from_parts(DVec3::ONE, random_rotation(&mut rng));
            let there = Pose::from_parts(DVec3::ONE + shift * rng.random_range(0.0..1.0), random_rotation(&mut rng));
            let mut scratch = CollisionScratch::new();
            assert!(first_collision(&scene, &[here, there], &pairs, 1e-5, &mut scratch).is_some());
        }
    }
}
