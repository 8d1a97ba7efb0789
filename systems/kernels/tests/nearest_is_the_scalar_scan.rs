//! What lanes leave out is never the nearest: on random spaces with every kind of root the answer is that of measuring all,
//! ties to the lowest id included, at every level of this machine.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate_components::Pose;
use foliate_components::configuration::ConfigurationSpace;
use foliate_components::robot::{Joint, Motion, PartIndex, Source};
use foliate_kernels::lanes::Level;
use foliate_kernels::nearest::{Bucket, BucketQuery, Metric, nearest};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// A few joints of kinds drawn at random, with weights of which some are nothing.
fn random_space(rng: &mut ChaCha8Rng) -> (ConfigurationSpace, Vec<f64>) {
    let (mut q, mut v) = (0, 0);
    let mut joints = Vec::new();
    let mut weights = Vec::new();
    for _ in 0..rng.random_range(1..8) {
        let (motion, bound) = match rng.random_range(0..5) {
            0 => (Motion::Revolute { axis: DVec3::Z }, 3.0),
            1 => (Motion::Revolute { axis: DVec3::Z }, f64::INFINITY),
            2 => (Motion::Prismatic { axis: DVec3::Z }, 50.0),
            3 => (Motion::Planar, 10.0),
            _ => (Motion::FreeFlyer, 2.0),
        };
        let (size, dimension) = (motion.configuration_size(), motion.velocity_size());
        let weight = if rng.random_bool(0.2) { 0.0 } else { rng.random_range(0.01..3.0) };
        weights.extend((0..dimension).map(|_| weight));
        joints.push(Joint {
            name: String::from("joint"),
            part: PartIndex(0),
            parent: None,
            parent_from_joint: Pose::identity(),
            motion,
            source: Source::Coordinates { q, v },
            lower: vec![-bound; size],
            upper: vec![bound; size],
            velocity_limit: None,
        });
        (q, v) = (q + size, v + dimension);
    }
    (ConfigurationSpace::of_joints(&joints), weights)
}

/// Configurations of which many are near one another, some equal, with angles on other turns and quaternions negated.
fn crowd(space: &ConfigurationSpace, rng: &mut ChaCha8Rng, count: usize) -> Vec<Vec<f64>> {
    let mut all: Vec<Vec<f64>> = Vec::new();
    for index in 0..count {
        let mut q = space.neutral();
        if index > 0 && rng.random_bool(0.6) {
            let near = all[rng.random_range(0..index)].clone();
            let size = if rng.random_bool(0.2) { 0.0 } else { 10_f64.powf(rng.random_range(-9.0..-1.0)) };
            let by: Vec<f64> = (0..space.dimension()).map(|_| size * rng.random_range(-1.0..1.0)).collect();
            space.integrate(&near, &by, &mut q);
        } else {
            space.random(rng, &mut q);
        }
        for f in &space.factors {
            use foliate_components::configuration::Group;
            match f.group {
                Group::Circle => q[f.q] += TAU * f64::from(rng.random_range(-3..=3)),
                Group::Plane => q[f.q + 2] += TAU * f64::from(rng.random_range(-3..=3)),
                Group::FreeFlyer if rng.random_bool(0.5) => q[f.q + 3..f.q + 7].iter_mut().for_each(|x| *x = -*x),
                Group::FreeFlyer | Group::Real => {}
            }
        }
        all.push(q);
    }
    all
}

#[test]
fn lanes_find_the_nearest_of_all() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for _ in 0..60 {
        let (space, weights) = random_space(&mut rng);
        let metric = Metric::new(&space, &weights);
        let count = *[1, 15, 16, 17, 300, 2500].get(rng.random_range(0..6)).unwrap();
        let all = crowd(&space, &mut rng, count);
        // Two buckets, to which ids go in turns of their own: the lowest may stand in the later one.
        let mut buckets = [Bucket::default(), Bucket::default()];
        for (id, q) in (0..).zip(&all) {
            buckets[usize::from(rng.random_bool(0.3))].push(&metric, id, q);
        }
        for query in crowd(&space, &mut rng, 20).iter().chain(all.iter().take(20)) {
            let exact = |id: u32| space.distance(query, &all[id as usize], &weights);
            let scalar = (0..count as u32).min_by(|&a, &b| exact(a).total_cmp(&exact(b)).then(a.cmp(&b)));
            for level in Level::available() {
                let prepared = BucketQuery::new(&metric, query);
                assert_eq!(nearest((&metric, &prepared, level), buckets.iter(), exact), scalar, "{}", level.name());
            }
        }
    }
}

#[test]
fn most_of_a_crowd_is_never_measured() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let (space, weights) = std::iter::repeat_with(|| random_space(&mut rng)).find(|(s, _)| s.dimension() > 12).unwrap();
    let metric = Metric::new(&space, &weights);
    let mut bucket = Bucket::default();
    let all: Vec<_> = (0..20_000).map(|_| crowd(&space, &mut rng, 1).remove(0)).collect();
    (0..).zip(&all).for_each(|(id, q)| bucket.push(&metric, id, q));
    let mut measured = 0;
    for query in all.iter().take(50) {
        let prepared = BucketQuery::new(&metric, query);
        let found = nearest((&metric, &prepared, Level::detected()), [&bucket].into_iter(), |id| {
            measured += 1;
            space.distance(query, &all[id as usize], &weights)
        });
        assert!(found.is_some());
    }
    assert!(measured < 50 * 100, "{measured} of a million distances measured");
}

#[test]
fn whoever_asks_for_several_gets_all_within_the_cutoff() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    for _ in 0..20 {
        let (space, weights) = random_space(&mut rng);
        let metric = Metric::new(&space, &weights);
        let all = crowd(&space, &mut rng, 700);
        let mut bucket = Bucket::default();
        (0..).zip(&all).for_each(|(id, q)| bucket.push(&metric, id, q));
        let exact = |id: u32| space.distance(&all[3], &all[id as usize], &weights);
        for cutoff in [0.0, 1e-6, 0.1, 2.0] {
            let mut seen = Vec::new();
            let prepared = BucketQuery::new(&metric, &all[3]);
            bucket.visit_near((&metric, &prepared, Level::detected()), cutoff, |id| {
                seen.push(id);
                cutoff
            });
            seen.sort_unstable();
            let within = (0..700).filter(|&id| exact(id) <= cutoff);
            within.for_each(|id| assert!(seen.binary_search(&id).is_ok(), "{id} at {}", exact(id)));
        }
    }
}
