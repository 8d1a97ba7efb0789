//! Configurations whose neighbours are looked for in the same buckets, and the nearest of each.

use crate::nearest::metric::Metric;
use crate::nearest::scan::width;
use std::ops::Range;

/// Who looks for near configurations: says how far, and measures exactly what may be within that.
pub trait Seeker {
    /// The distance beyond which nothing is wanted by a query, by its number. It may fall whenever something is measured.
    fn cutoff(&self, query: usize) -> f64;

    /// Measures a configuration that may be within the cutoff of a query.
    fn measure(&mut self, query: usize, id: u32);
}

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

    pub(crate) fn reach(&self, query: usize) -> f64 {
        self.reach[query]
    }

    /// The numbers of whole passes.
    pub(crate) fn rounded(&self, queries: Range<usize>) -> &[f32] {
        &self.rounded[queries.start * self.rows..queries.end * self.rows]
    }
}
