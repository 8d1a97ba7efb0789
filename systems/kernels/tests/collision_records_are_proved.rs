//! What was found about a mesh before spares a tree the search, changes nothing of it, and is never believed.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{box_mesh, random_vector, star};
use foliate_components::robot::shape::Mesh;
use foliate_components::robot::shape::mesh_record::MeshRecord;
use foliate_kernels::collision::solids::mesh_record::{proves, record};
use foliate_kernels::collision::solids::mesh_tree::MeshTree;
use glam::DVec3;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A surface of triangles anywhere, each with vertices of its own, every third of which is where another is.
fn soup(rng: &mut ChaCha8Rng, count: u32) -> Mesh {
    let mut vertices: Vec<DVec3> = Vec::new();
    for number in 0..3 * count {
        let known = vertices.get(rng.random_range(0..=number as usize)).copied();
        vertices.push(known.filter(|_| number % 3 == 0).unwrap_or_else(|| random_vector(rng, 0.3)));
    }
    Mesh::new("soup".into(), vertices, (0..count).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect())
}

fn some_mesh(rng: &mut ChaCha8Rng, kind: u32) -> Mesh {
    match kind % 5 {
        0 => soup(rng, 1 + kind % 11),
        1 => soup(rng, 150),
        2 => star(rng, 0.2),
        // Many vertices on one plane, and signs of zeros that differ.
        3 => {
            let mesh = box_mesh(DVec3::new(0.1, 0.15, 0.2), 4);
            let vertices = mesh.vertices.iter().map(|v| *v - DVec3::new(0.1, 0.15, 0.0)).collect();
            Mesh::new("box".into(), vertices, mesh.triangles)
        }
        _ => {
            let (mut first, other) = (star(rng, 0.1), star(rng, 0.05));
            let count = first.vertices.len() as u32;
            first.vertices.extend(other.vertices.iter().map(|v| *v + DVec3::X));
            first.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + count)));
            Mesh::new("two".into(), first.vertices, first.triangles)
        }
    }
}

fn with(mesh: &Mesh, record: MeshRecord) -> Mesh {
    Mesh { record: Some(record), ..mesh.clone() }
}

/// Every number of a tree, signs of zeros too.
fn written(mesh: &Mesh) -> String {
    format!("{:?}", MeshTree::new(mesh))
}

#[test]
fn a_tree_from_a_record_is_that_from_nothing_bit_for_bit() {
    let mut rng = ChaCha8Rng::seed_from_u64(71);
    for round in 0..60 {
        let mesh = some_mesh(&mut rng, round);
        let found = record(&mesh).expect("a mesh that is as it should be");
        assert!(proves(&mesh, &found));
        assert_eq!(written(&with(&mesh, found)), written(&mesh), "round {round}");
    }
}

#[test]
fn another_record_that_holds_gives_another_tree_of_the_same_triangles() {
    let mut rng = ChaCha8Rng::seed_from_u64(72);
    let mesh = star(&mut rng, 0.3);
    let mut other = record(&mesh).unwrap();
    other.order.reverse();
    other.slack *= 2.0;
    assert!(proves(&mesh, &other));
    let other = with(&mesh, other);
    // So the record is what the tree is built from.
    assert_ne!(written(&other), written(&mesh));
    let (one, other) = (MeshTree::new(&mesh), MeshTree::new(&other));
    for _ in 0..2000 {
        let p = random_vector(&mut rng, 0.4);
        assert_eq!(one.contains(p), other.contains(p), "{p}");
    }
}

type Forgery = fn(&mut MeshRecord);

const FORGERIES: &[(&str, Forgery)] = &[
    ("no slack", |r| r.slack = 0.0),
    ("less slack", |r| r.slack *= 0.9),
    ("negative slack", |r| r.slack = -1.0),
    ("slack that is no number", |r| r.slack = f64::NAN),
    ("slack without end", |r| r.slack = f64::INFINITY),
    ("a triangle twice", |r| r.order[1] = r.order[0]),
    ("a triangle too few", |r| r.order.truncate(r.order.len() - 1)),
    ("a triangle too many", |r| r.order.push(0)),
    ("a triangle that does not exist", |r| r.order[3] = u32::MAX),
    ("no hull", |r| r.hull.clear()),
    ("points that do not exist", |r| r.hull[0] = u32::MAX),
    ("too many points", |r| r.hull.resize(129, 0)),
    ("a hull of one point", |r| r.hull.iter_mut().for_each(|i| *i = 0)),
    ("a point too few", |r| r.hull.truncate(r.hull.len() - 1)),
    ("near nothing", |r| r.near.clear()),
    ("near what does not exist", |r| r.near[2] = [255; 4]),
    ("near something else", |r| r.near.iter_mut().for_each(|near| *near = [0; 4])),
    ("a vertex too many", |r| r.near.push([0; 4])),
    ("vertices at one place that are not", |r| r.same.iter_mut().for_each(|i| *i = 0)),
    ("vertices at the places of later ones", |r| r.same[0] = 5),
    ("vertices that do not exist", |r| r.same[1] = u32::MAX),
    ("places of too few vertices", |r| r.same.truncate(r.same.len() - 1)),
];

#[test]
fn a_forged_record_is_as_none() {
    let mut rng = ChaCha8Rng::seed_from_u64(73);
    for mesh in [soup(&mut rng, 200), soup(&mut rng, 60)] {
        let (truth, plain) = (record(&mesh).unwrap(), written(&mesh));
        assert!(!truth.same.is_empty());
        for (what, forge) in FORGERIES {
            let mut forged = truth.clone();
            forge(&mut forged);
            assert!(!proves(&mesh, &forged), "{what} is believed");
            assert_eq!(written(&with(&mesh, forged)), plain, "{what} changes the tree");
        }
    }
}

#[test]
fn a_record_of_another_mesh_is_as_none() {
    let mut rng = ChaCha8Rng::seed_from_u64(74);
    let (one, other) = (star(&mut rng, 0.3), star(&mut rng, 0.3));
    // The same numbers of everything; only the vertices differ.
    let record = record(&other).unwrap();
    assert!(!proves(&one, &record));
    assert_eq!(written(&with(&one, record)), written(&one));
}

/// Whether the vertices lie within the slack of the hull of the points, in many directions.
fn holds(mesh: &Mesh, record: &MeshRecord, rng: &mut impl Rng) -> bool {
    (0..100).all(|_| {
        let d = DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0))).normalize_or(DVec3::X);
        let most = |points: &mut dyn Iterator<Item = DVec3>| points.map(|p| p.dot(d)).fold(f64::NEG_INFINITY, f64::max);
        let all = most(&mut mesh.vertices.iter().copied());
        all <= most(&mut record.hull.iter().map(|&i| mesh.vertices[i as usize])) + record.slack
    })
}

#[test]
fn whatever_is_accepted_holds() {
    let mut rng = ChaCha8Rng::seed_from_u64(75);
    let (mut accepted, mut refused) = (0, 0);
    for round in 0..3000_u32 {
        let mesh = some_mesh(&mut rng, round);
        let mut forged = record(&mesh).unwrap();
        for _ in 0..rng.random_range(1..4) {
            match rng.random_range(0..4) {
                0 => forged.slack *= rng.random_range(0.0..3.0),
                1 => {
                    let at = rng.random_range(0..forged.hull.len());
                    forged.hull[at] = rng.random_range(0..mesh.vertices.len() as u32);
                }
                2 => {
                    let at = rng.random_range(0..forged.near.len());
                    forged.near[at][rng.random_range(0..4)] = rng.random_range(0..forged.hull.len() as u8);
                }
                _ => {
                    let at = rng.random_range(0..forged.order.len());
                    forged.order[at] = rng.random_range(0..mesh.triangles.len() as u32);
                }
            }
        }
        if proves(&mesh, &forged) {
            accepted += 1;
            assert!(holds(&mesh, &forged, &mut rng), "round {round}");
        } else {
            refused += 1;
        }
    }
    assert!(accepted > 200 && refused > 200, "{accepted} accepted, {refused} refused");
}

#[test]
fn of_meshes_without_numbers_nothing_is_recorded() {
    let mut rng = ChaCha8Rng::seed_from_u64(76);
    let whole = soup(&mut rng, 20);
    let mut spoilt = whole.clone();
    spoilt.vertices[7].y = f64::NAN;
    let mut beyond = whole.clone();
    beyond.triangles[3][1] = 1_000_000;
    let found = record(&whole).unwrap();
    for mesh in [spoilt, beyond, Mesh::default()] {
        assert!(record(&mesh).is_none());
        assert!(!proves(&mesh, &found));
        assert_eq!(written(&with(&mesh, found.clone())), written(&mesh));
    }
}

/// A change of what is found has to change the version, or trees would depend on whether a record was there.
#[test]
fn a_record_of_this_version_is_what_it_was() {
    // Coordinates that are the same on every machine.
    let mut state = 1_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 16) / 65536.0
    };
    let vertices: Vec<DVec3> = (0..300).map(|_| DVec3::new(next(), next(), next())).collect();
    let mesh = Mesh::new("fixed".into(), vertices, (0..100).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect());
    let written = format!("{:?}", record(&mesh).unwrap());
    let sum =
        written.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |sum, b| (sum ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
    assert_eq!(
        (MeshRecord::VERSION, sum),
        (1, 17_544_553_505_870_994_388),
        "another record: count MeshRecord::VERSION up and write both here"
    );
}
