//! Configurations whose neighbours are looked for in the same buckets, and the nearest of each.

use super::bucket::{Bucket, Seeker};
use super::metric::Metric;
use super::scan::width;
use crate::lanes::Level;
use std::ops::Range;

/// Configurations whose neighbours are looked for, rounded once for any number of buckets.
#[derive(Clone, Debug, Default)]
pub struct BucketQueries {
    rows: usize,
    /// Row after row of the queries that share a pass, side by side; pass after pass.
    rounded: Vec<f32>,
    /// By query: what [`Metric::reach`] says of it.
    reach: Vec<f64>,
    numbers: Vec<f64>,
}

impl BucketQueries {
    /// Prepares configurations.
    #[must_use]
    pub fn new<'q>(metric: &Metric, configurations: impl ExactSizeIterator<Item = &'q [f64]>) -> Self {
        let mut queries = Self::default();
        queries.set(metric, configurations);
        queries
    }

    /// Prepares others instead, in the same memory.
    pub fn set<'q>(&mut self, metric: &Metric, configurations: impl ExactSizeIterator<Item = &'q [f64]>) {
        let count = configurations.len();
        self.rows = metric.rows();
        self.reach.clear();
        self.rounded.clear();
        self.rounded.resize(count * self.rows, 0.0);
        let mut pass = 0..width(count);
        for (index, q) in (0..count).zip(configurations) {
            if index == pass.end {
                pass = index..index + width(count - index);
            }
            metric.write(q, &mut self.numbers);
            self.reach.push(metric.reach(&self.numbers));
            let rows = self.rounded[pass.start * self.rows..pass.end * self.rows].chunks_exact_mut(pass.len());
            rows.zip(&self.numbers).for_each(|(row, &number)| row[index - pass.start] = number as f32);
        }
    }

    /// How many.
    #[must_use]
    pub fn len(&self) -> usize {
        self.reach.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.reach.is_empty()
    }

    pub(super) fn reach(&self, query: usize) -> f64 {
        self.reach[query]
    }

    /// The numbers of whole passes.
    pub(super) fn rounded(&self, queries: Range<usize>) -> &[f32] {
        &self.rounded[queries.start * self.rows..queries.end * self.rows]
    }
}

/// Of each query, by its number: the nearest configuration of some buckets and how far it is, as `distance` measures it; ties
/// go to the lowest id. `best` is overwritten.
pub fn nearest<'b>(
    with: (&Metric, &BucketQueries, Level),
    buckets: impl Iterator<Item = &'b Bucket>,
    distance: impl FnMut(usize, u32) -> f64,
    best: &mut Vec<Option<(f64, u32)>>,
) {
    best.clear();
    best.resize(with.1.len(), None);
    let mut seeker = Nearest { best, distance };
    buckets.for_each(|bucket| bucket.visit_near(with, &mut seeker));
}

struct Nearest<'a, D> {
    best: &'a mut [Option<(f64, u32)>],
    distance: D,
}

impl<D: FnMut(usize, u32) -> f64> Seeker for Nearest<'_, D> {
    fn cutoff(&self, query: usize) -> f64 {
        self.best[query].map_or(f64::INFINITY, |(d, _)| d)
    }

    fn measure(&mut self, query: usize, id: u32) {
        let d = (self.distance)(query, id);
        let best = &mut self.best[query];
        if best.is_none_or(|(least, first)| d.total_cmp(&least).then(id.cmp(&first)).is_lt()) {
            *best = Some((d, id));
        }
    }
}
