//! What lanes leave out is never the nearest: on random spaces with every kind of root the answer is that of measuring all,
//! ties to the lowest id included, at every level of this machine, for one query and for many that share their passes.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate_components::Pose;
use foliate_components::robot::configuration::ConfigurationSpace;
use foliate_components::robot::{Joint, JointType, PartIndex, Source};
use foliate_kernels::lanes::Level;
use foliate_kernels::nearest::{Bucket, BucketQueries, Metric, Seeker, nearest};
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
            0 => (JointType::Revolute { axis: DVec3::Z }, 3.0),
            1 => (JointType::Revolute { axis: DVec3::Z }, f64::INFINITY),
            2 => (JointType::Prismatic { axis: DVec3::Z }, 50.0),
            3 => (JointType::Planar, 10.0),
            _ => (JointType::FreeFlyer, 2.0),
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
            use foliate_components::robot::configuration::Group;
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

/// The nearest of several configurations and how far they are, asked together.
fn together<'b>(
    (space, weights, metric): (&ConfigurationSpace, &[f64], &Metric),
    (all, queries): (&[Vec<f64>], &[Vec<f64>]),
    buckets: impl Iterator<Item = &'b Bucket>,
    level: Level,
) -> Vec<Option<(f64, u32)>> {
    let prepared = BucketQueries::new(metric, queries.iter().map(Vec::as_slice));
    assert_eq!((prepared.len(), prepared.is_empty()), (queries.len(), queries.is_empty()));
    // What lay there is overwritten.
    let mut best = vec![Some((0.0, 7)); 3];
    let exact = |query: usize, id: u32| space.distance(&queries[query], &all[id as usize], weights);
    nearest((metric, &prepared, level), buckets, exact, &mut best);
    best
}

#[test]
fn lanes_find_the_nearest_of_all() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for _ in 0..60 {
        let (space, weights) = random_space(&mut rng);
        let metric = Metric::new(&space, &weights);
        let count = *[1, 15, 16, 17, 300, 2500].get(rng.random_range(0..6)).unwrap();
        let all = crowd(&space, &mut rng, count);
        // Two buckets, which take ids by their own rules: the lowest may stand in the later one. Nothing is in the third.
        let mut buckets = [Bucket::default(), Bucket::default(), Bucket::default()];
        for (id, q) in (0..).zip(&all) {
            buckets[usize::from(rng.random_bool(0.3))].push(&metric, id, q);
        }
        buckets.rotate_right(rng.random_range(0..3));
        // Many are of the crowd, so that there are ties at no distance at all.
        let mut queries = crowd(&space, &mut rng, 20);
        queries.extend(all.iter().take(20).cloned());
        let scalar = |query: &Vec<f64>| {
            let exact = |id: u32| (space.distance(query, &all[id as usize], &weights), id);
            (0..count as u32).map(exact).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
        };
        let scalar: Vec<_> = queries.iter().map(scalar).collect();
        for level in Level::available() {
            let of =
                |queries: &[Vec<f64>]| together((&space, &weights, &metric), (&all, queries), buckets.iter(), level);
            // Fewer than a pass, a pass, more than go together, and all of those left over.
            for size in [1, 2, 3, 4, 5, 7, 17, 40] {
                let found: Vec<_> = queries.chunks(size).flat_map(of).collect();
                assert_eq!(found, scalar, "{size} at a time, {}", level.name());
            }
        }
    }
}

#[test]
fn nothing_is_nearest_where_there_is_nothing() {
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    let (space, weights) = random_space(&mut rng);
    let metric = Metric::new(&space, &weights);
    let queries = crowd(&space, &mut rng, 6);
    let buckets = [Bucket::default(), Bucket::default()];
    for level in Level::available() {
        let of = |queries: &[Vec<f64>], buckets: &[Bucket]| {
            together((&space, &weights, &metric), (&[], queries), buckets.iter(), level)
        };
        assert_eq!(of(&queries, &buckets), [None; 6]);
        assert_eq!(of(&queries, &[]), [None; 6]);
        assert_eq!(of(&[], &buckets), []);
    }
}

/// Keeps what it is asked to measure.
struct Seen<'a> {
    cutoffs: &'a [f64],
    ids: Vec<Vec<u32>>,
    /// Number of a query, and what its cutoff falls to at the first look.
    falls: Option<(usize, f64)>,
}

impl<'a> Seen<'a> {
    fn nothing(cutoffs: &'a [f64]) -> Self {
        Self { cutoffs, ids: vec![Vec::new(); cutoffs.len()], falls: None }
    }
}

impl Seeker for Seen<'_> {
    fn cutoff(&self, query: usize) -> f64 {
        match self.falls {
            Some((falling, cutoff)) if falling == query && !self.ids[query].is_empty() => cutoff,
            _ => self.cutoffs[query],
        }
    }

    fn measure(&mut self, query: usize, id: u32) {
        self.ids[query].push(id);
    }
}

#[test]
fn queries_that_share_a_pass_keep_their_own_cutoffs() {
    let mut rng = ChaCha8Rng::seed_from_u64(15);
    for _ in 0..20 {
        let (space, weights) = random_space(&mut rng);
        let metric = Metric::new(&space, &weights);
        let all = crowd(&space, &mut rng, 700);
        let mut bucket = Bucket::default();
        (0..).zip(&all).for_each(|(id, q)| bucket.push(&metric, id, q));
        let cutoffs: Vec<_> = (0..21).map(|query| [0.0, 1e-6, f64::INFINITY, 0.1, 2.0][query % 5]).collect();
        let slices = || all[..cutoffs.len()].iter().map(Vec::as_slice);
        for level in Level::available() {
            let mut many = Seen { falls: Some((2, 0.0)), ..Seen::nothing(&cutoffs) };
            bucket.visit_near((&metric, &BucketQueries::new(&metric, slices()), level), &mut many);
            for (query, q) in slices().enumerate() {
                let falls = (query == 2).then_some((0, 0.0));
                let mut one = Seen { falls, ..Seen::nothing(&cutoffs[query..=query]) };
                bucket.visit_near((&metric, &BucketQueries::new(&metric, [q].into_iter()), level), &mut one);
                assert_eq!(many.ids[query], one.ids[0], "{}", level.name());
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
    for size in [1, 10] {
        let mut measured = 0;
        for queries in all[..50].chunks(size) {
            let prepared = BucketQueries::new(&metric, queries.iter().map(Vec::as_slice));
            let mut best = Vec::new();
            let exact = |query: usize, id: u32| {
                measured += 1;
                space.distance(&queries[query], &all[id as usize], &weights)
            };
            nearest((&metric, &prepared, Level::detected()), [&bucket].into_iter(), exact, &mut best);
            assert!(best.iter().all(Option::is_some));
        }
        assert!(measured < 50 * 100, "{measured} of a million distances measured, {size} at a time");
    }
}

#[test]
fn a_query_for_several_gets_all_within_the_cutoff() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    for _ in 0..20 {
        let (space, weights) = random_space(&mut rng);
        let metric = Metric::new(&space, &weights);
        let all = crowd(&space, &mut rng, 700);
        let mut bucket = Bucket::default();
        (0..).zip(&all).for_each(|(id, q)| bucket.push(&metric, id, q));
        let cutoffs = [0.0, 1e-6, 0.1, 2.0, 0.0];
        let queries = [3, 3, 3, 3, 5].map(|index: usize| all[index].as_slice());
        let mut seen = Seen::nothing(&cutoffs);
        let prepared = BucketQueries::new(&metric, queries.into_iter());
        bucket.visit_near((&metric, &prepared, Level::detected()), &mut seen);
        for ((q, &cutoff), seen) in queries.into_iter().zip(&cutoffs).zip(&mut seen.ids) {
            let exact = |id: u32| space.distance(q, &all[id as usize], &weights);
            seen.sort_unstable();
            assert!(seen.windows(2).all(|pair| pair[0] < pair[1]), "measured twice");
            let within = (0..700).filter(|&id| exact(id) <= cutoff);
            within.for_each(|id| assert!(seen.binary_search(&id).is_ok(), "{id} at {}", exact(id)));
        }
    }
}
