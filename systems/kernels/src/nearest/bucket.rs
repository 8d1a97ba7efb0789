//! Configurations in blocks of lanes, and who of them may be near.

use super::metric::{Metric, Shape};
use super::scan::{CHUNK, Scan};
use crate::lanes::{F32Row, Level};

/// Lanes of a block.
const LANES: usize = 16;

/// Relative error of a sum of squares in lanes, with room to spare for some hundred rows.
const SUMMING: f64 = 1e-4;

/// Configurations, rounded, sixteen to a block.
#[derive(Clone, Debug, Default)]
pub struct Bucket {
    ids: Vec<u32>,
    /// Rows of block after block.
    rows: Vec<F32Row>,
    /// By row: the largest number in it.
    reach: Vec<f64>,
    numbers: Vec<f64>,
}

/// A configuration whose neighbours are looked for, rounded once for any number of buckets.
#[derive(Clone, Debug, Default)]
pub struct BucketQuery {
    numbers: Vec<f64>,
    rounded: Vec<f32>,
    shape: Shape,
}

impl BucketQuery {
    /// Prepares a configuration.
    #[must_use]
    pub fn new(metric: &Metric, q: &[f64]) -> Self {
        let mut query = Self { shape: metric.shape(), ..Self::default() };
        query.set(metric, q);
        query
    }

    /// Prepares another configuration of the same metric.
    pub fn set(&mut self, metric: &Metric, q: &[f64]) {
        metric.write(q, &mut self.numbers);
        self.rounded.clear();
        self.rounded.extend(self.numbers.iter().map(|&x| x as f32));
    }
}

impl Bucket {
    /// How many configurations.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Memory that it holds, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.ids.capacity() * size_of::<u32>()
            + self.rows.capacity() * size_of::<F32Row>()
            + (self.reach.capacity() + self.numbers.capacity()) * size_of::<f64>()
    }

    /// Adds a configuration. All of a bucket are of one metric.
    pub fn push(&mut self, metric: &Metric, id: u32, q: &[f64]) {
        let (size, lane) = (metric.rows(), self.ids.len() % LANES);
        self.ids.push(id);
        self.reach.resize(size, 0.0);
        metric.write(q, &mut self.numbers);
        if lane == 0 {
            // What is not there is infinitely far.
            self.rows.resize(self.rows.len() + size, F32Row::splat(f32::INFINITY));
        }
        let start = self.rows.len() - size;
        for (index, &number) in self.numbers.iter().enumerate() {
            self.reach[index] = self.reach[index].max(number.abs());
            self.rows[start + index][lane] = number as f32;
        }
    }

    /// Calls `measure` for every configuration whose distance to the query may be at most `cutoff`, which `measure`
    /// may lower as it finds near ones: it answers the cutoff from then on. Nearest blocks are not first; a chunk's most
    /// promising configuration is.
    pub fn visit_near(
        &self,
        (metric, query, level): (&Metric, &BucketQuery, Level),
        mut cutoff: f64,
        mut measure: impl FnMut(u32) -> f64,
    ) {
        let size = metric.rows();
        let reach = self.reach.iter().zip(&query.numbers).map(|(a, b)| a + b.abs());
        let rounding = metric.rounding(reach);
        let mut limit = limit(cutoff, rounding);
        let mut bounds = [F32Row::splat(0.0); CHUNK];
        for (number, ids) in self.ids.chunks(CHUNK * LANES).enumerate() {
            let out = &mut bounds[..ids.len().div_ceil(LANES)];
            let rows = &self.rows[number * CHUNK * size..][..out.len() * size];
            let least = level.run(Scan { shape: &query.shape, rows, query: &query.rounded, out });
            if least > limit {
                continue;
            }
            let bound = |index: usize| bounds[index / LANES][index % LANES];
            let first = (0..ids.len()).find(|&index| bound(index) <= least);
            let others = (0..ids.len()).filter(|&index| Some(index) != first);
            for index in first.into_iter().chain(others) {
                if bound(index) <= limit {
                    let lower = measure(ids[index]);
                    if lower < cutoff {
                        cutoff = lower;
                        limit = self::limit(cutoff, rounding);
                    }
                }
            }
        }
    }
}

/// Squared bounds above this belong to distances above the cutoff.
fn limit(cutoff: f64, rounding: f64) -> f32 {
    let far = (cutoff + rounding) * (1.0 + SUMMING);
    // Numbers too small for an f32 are nothing.
    ((far * far) as f32).next_up().max(f32::MIN_POSITIVE)
}

/// The id of the configuration nearest to the query in some buckets, as `distance` measures it; ties go to the lowest id.
pub fn nearest<'b>(
    with: (&Metric, &BucketQuery, Level),
    buckets: impl Iterator<Item = &'b Bucket>,
    mut distance: impl FnMut(u32) -> f64,
) -> Option<u32> {
    let mut best: Option<(f64, u32)> = None;
    for bucket in buckets {
        let cutoff = best.map_or(f64::INFINITY, |(d, _)| d);
        bucket.visit_near(with, cutoff, |id| {
            let d = distance(id);
            if best.is_none_or(|(least, first)| d.total_cmp(&least).then(id.cmp(&first)).is_lt()) {
                best = Some((d, id));
            }
            best.map_or(f64::INFINITY, |(d, _)| d)
        });
    }
    best.map(|(_, id)| id)
}
