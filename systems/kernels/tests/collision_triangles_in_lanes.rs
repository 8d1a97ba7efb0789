//! Distances of meshes, eight boxes and eight triangles at a time, are those of asking GJK for every triangle, and the same
//! bit for bit at every level.

#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{box_mesh, random_geometry, random_pose, random_vector, star};
use foliate_components::Pose;
use foliate_components::robot::shape::Mesh;
use foliate_kernels::collision::convex::{Convex, Core};
use foliate_kernels::collision::solids::mesh_tree::MeshTree;
use foliate_kernels::collision::{DistanceQuery, Solid, clearance};
use foliate_kernels::lanes::Level;
use glam::DVec3;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// What GJK is allowed to fall short of a distance, twice.
const TOLERANCE: f64 = 2.5e-6;

fn corners(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    mesh.triangles.iter().map(|t| t.map(|i| mesh.vertices[i as usize])).collect()
}

fn triangle(t: [DVec3; 3]) -> Solid {
    Solid::Convex(Convex { core: Core::Triangle(t), radius: 0.0 })
}

/// A surface of `count` triangles anywhere: some as long as needles, some points, some in the planes of others.
fn soup(rng: &mut ChaCha8Rng, count: u32, size: f64) -> Mesh {
    let mut vertices = Vec::new();
    for number in 0..count {
        let a = random_vector(rng, size);
        let (b, c) = (a + random_vector(rng, 0.3 * size), a + random_vector(rng, 0.3 * size));
        vertices.extend(match number % 7 {
            0 => [a, a + (b - a) * 1e-9, c],
            1 => [a, a, c],
            2 => [a, a, a],
            3 => [a, b, a.midpoint(b)],
            4 => [a, a + DVec3::X * 0.1, a + DVec3::Y * 0.1],
            _ => [a, b, c],
        });
    }
    Mesh::new("soup".into(), vertices, (0..count).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect())
}

fn some_mesh(rng: &mut ChaCha8Rng, kind: u32) -> Mesh {
    match kind % 4 {
        0 => soup(rng, 1 + kind % 9, 0.2),
        1 => soup(rng, 90, 0.2),
        2 => star(rng, 0.2),
        _ => box_mesh(DVec3::new(0.1, 0.15, 0.2), 3),
    }
}

fn mesh_solid(mesh: &Mesh, level: Level) -> Solid {
    Solid::Mesh(Arc::new(MeshTree::new(mesh).computed_at(level)))
}

/// The smallest of all pairs, by GJK alone.
fn one_by_one(a: &[Solid], X_WA: &Pose, b: &[Solid], X_WB: &Pose) -> f64 {
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
    let distance =
        |(a, b): (&Solid, &Solid)| clearance(a, X_WA, b, X_WB, DistanceQuery::exact(1e9), &mut DVec3::ZERO.clone());
    pairs.map(distance).fold(f64::INFINITY, f64::min)
}

/// Rungs of an ask, from tight to all that matters.
fn asks(rng: &mut impl Rng, truth: f64) -> [DistanceQuery; 4] {
    let around = truth.abs() * rng.random_range(0.5..1.5) + 1e-3;
    [
        DistanceQuery::exact(1e9),
        DistanceQuery::exact(around),
        DistanceQuery { floor: 0.5 * around, ..DistanceQuery::exact(around) },
        DistanceQuery { floor: 0.7 * around, ground: 1e-3, ..DistanceQuery::exact(2.0 * around) },
    ]
}

fn holds(found: f64, truth: f64, ask: DistanceQuery) {
    assert!(found <= truth.max(0.0) + TOLERANCE, "{found} is above {truth}");
    if truth <= 0.0 {
        assert!(found <= 0.0, "{found} where they meet");
    }
    let enough = found >= ask.needed
        || (found >= ask.floor && truth < ask.needed + TOLERANCE)
        || (found >= ask.ground && truth < ask.floor + TOLERANCE)
        || found >= truth - TOLERANCE;
    assert!(enough || truth <= 0.0, "{found} of {truth} says too little for {ask:?}");
}

#[test]
fn two_meshes_are_as_far_apart_as_their_closest_triangles() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let (mut apart, mut meeting) = (0, 0);
    for round in 0..60 {
        let (a, b) = (some_mesh(&mut rng, round), some_mesh(&mut rng, round / 4 + 1));
        let (first, second): (Vec<_>, Vec<_>) =
            (corners(&a).into_iter().map(triangle).collect(), corners(&b).into_iter().map(triangle).collect());
        let (X_WA, X_WB) = (random_pose(&mut rng, 0.22), random_pose(&mut rng, 0.22));
        let truth = one_by_one(&first, &X_WA, &second, &X_WB);
        if truth > 0.0 {
            apart += 1
        } else {
            meeting += 1
        }
        for ask in asks(&mut rng, truth) {
            let mut hint = DVec3::ZERO;
            // The second time with what the first has learned.
            for _ in 0..2 {
                let level = Level::detected();
                let (a, b) = (mesh_solid(&a, level), mesh_solid(&b, level));
                holds(clearance(&a, &X_WA, &b, &X_WB, ask, &mut hint), truth, ask);
            }
        }
    }
    assert!(apart > 15 && meeting > 15, "{apart} apart, {meeting} meeting");
}

#[test]
fn a_mesh_is_as_far_from_a_solid_as_its_closest_triangle() {
    let mut rng = ChaCha8Rng::seed_from_u64(32);
    let mut apart = 0;
    for round in 0..240_u32 {
        let mesh = some_mesh(&mut rng, round);
        let solid = Solid::of(&random_geometry(&mut rng, round as usize / 4 % 4));
        let triangles: Vec<_> = corners(&mesh).into_iter().map(triangle).collect();
        let (X_WM, X_WS) = (random_pose(&mut rng, 0.4), random_pose(&mut rng, 0.4));
        let truth = one_by_one(&triangles, &X_WM, std::slice::from_ref(&solid), &X_WS);
        apart += u32::from(truth > 0.0);
        let mesh = mesh_solid(&mesh, Level::detected());
        for ask in asks(&mut rng, truth) {
            let mut hint = DVec3::ZERO;
            for _ in 0..2 {
                holds(clearance(&mesh, &X_WM, &solid, &X_WS, ask, &mut hint), truth, ask);
                holds(clearance(&solid, &X_WS, &mesh, &X_WM, ask, &mut DVec3::ZERO.clone()), truth, ask);
            }
        }
    }
    assert!(apart > 80, "{apart} apart");
}

#[test]
fn flat_triangles_are_as_far_as_their_edges() {
    let mut rng = ChaCha8Rng::seed_from_u64(35);
    let ball = Solid::Convex(Convex { core: Core::Point, radius: 0.0 });
    for round in 0..3000 {
        let (a, c) = (random_vector(&mut rng, 0.3), random_vector(&mut rng, 0.3));
        let b = [a, c, a.midpoint(c), a + (c - a) * 1e-12][round % 4];
        let at = random_vector(&mut rng, 0.3);
        let truth = at.distance(a + (c - a) * ((at - a).dot(c - a) / (c - a).length_squared()).clamp(0.0, 1.0));
        let flat = triangle([[a, b, c], [b, c, a], [c, a, b]][round % 3]);
        let found = clearance(
            &flat,
            &Pose::IDENTITY,
            &ball,
            &Pose::from_translation(at),
            DistanceQuery::exact(1e9),
            &mut DVec3::ZERO.clone(),
        );
        assert!((found - truth).abs() < 1e-9, "{found} of {truth}");
    }
}

#[test]
fn levels_agree_bit_for_bit() {
    let mut rng = ChaCha8Rng::seed_from_u64(33);
    for round in 0..40_u32 {
        let (a, b) = (some_mesh(&mut rng, round), some_mesh(&mut rng, round / 4 + 1));
        let solid = Solid::of(&random_geometry(&mut rng, round as usize % 4));
        let (X_WA, X_WB) = (random_pose(&mut rng, 0.4), random_pose(&mut rng, 0.4));
        let ask = asks(&mut rng, 0.1)[round as usize % 4];
        let answers: Vec<_> = Level::available()
            .into_iter()
            .map(|level| {
                let (a, b) = (mesh_solid(&a, level), mesh_solid(&b, level));
                let mut hints = [DVec3::ZERO; 2];
                let meshes = clearance(&a, &X_WA, &b, &X_WB, ask, &mut hints[0]);
                let convex = clearance(&a, &X_WA, &solid, &X_WB, ask, &mut hints[1]);
                ([meshes, convex].map(f64::to_bits), hints.map(|n| n.to_array().map(f64::to_bits)))
            })
            .collect();
        assert!(answers.iter().all(|answer| *answer == answers[0]), "round {round}: {answers:x?}");
    }
}

#[test]
fn a_triangle_without_numbers_collides_wherever_it_stands() {
    let mut rng = ChaCha8Rng::seed_from_u64(34);
    for spoilt in 0..20_u32 {
        let mut mesh = soup(&mut rng, 20, 0.2);
        mesh.vertices[(3 * spoilt) as usize][(spoilt % 3) as usize] = [f64::NAN, f64::INFINITY][(spoilt % 2) as usize];
        let (mesh, other) = (mesh_solid(&mesh, Level::detected()), mesh_solid(&star(&mut rng, 0.2), Level::detected()));
        let far = Pose::from_translation(DVec3::new(5.0, 0.0, 0.0));
        for solid in [other, Solid::of(&random_geometry(&mut rng, spoilt as usize % 4))] {
            let found =
                clearance(&mesh, &Pose::IDENTITY, &solid, &far, DistanceQuery::exact(0.01), &mut DVec3::ZERO.clone());
            assert!(found <= 0.0, "{found}");
        }
    }
}
