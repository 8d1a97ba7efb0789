//! Configurations in blocks of lanes, and who of them may be near.

use crate::lanes::level::Level;
use crate::lanes::vector::F32Row;
use crate::nearest::metric::Metric;
use crate::nearest::queries::{BucketQueries, Seeker};
use crate::nearest::scan::{Bounds, CHUNK, LANES, PASS, Place, Scan, Within, width};

/// Queries that go over a bucket together: so many alternate on a chunk while it lies in the cache.
const TOGETHER: usize = 16;

/// So few configurations are measured in less time than bounds of them are found, for four queries at once on 33 rows in as
/// much. A tree of the lazy extension often has no more on a leaf.
const FEW: usize = 2;

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

    /// Has the seeker measure, for each query, every configuration whose distance to it may be at most the cutoff. Nearest
    /// blocks are not first; a chunk's most promising configuration is. Where there are but two, they are measured whatever
    /// the cutoff. Which are measured for a query does not depend on the others.
    pub fn visit_near(&self, with: (&Metric, &BucketQueries, Level), seeker: &mut impl Seeker) {
        if self.ids.len() <= FEW {
            for query in 0..with.1.len() {
                self.ids.iter().for_each(|&id| seeker.measure(query, id));
            }
            return;
        }
        for first in (0..with.1.len()).step_by(TOGETHER) {
            self.visit_together(with, first, seeker);
        }
    }

    /// The same for the queries from `first` on that go together.
    fn visit_together(
        &self,
        (metric, queries, level): (&Metric, &BucketQueries, Level),
        first: usize,
        seeker: &mut impl Seeker,
    ) {
        let together = first..queries.len().min(first + TOGETHER);
        let reach = metric.reach(&self.reach);
        let (mut roundings, mut limits) = ([0.0; TOGETHER], [0.0; TOGETHER]);
        for (index, query) in together.clone().enumerate() {
            roundings[index] = metric.rounding(reach + queries.reach(query));
            limits[index] = limit(seeker.cutoff(query), roundings[index]);
        }
        let limits = &mut limits[..together.len()];
        let mut bounds: Bounds = [[F32Row::splat(0.0); CHUNK]; PASS];
        let mut least = [0.0; PASS];
        let mut from = Place::default();
        while let Some(at) = level.run(Scan {
            shape: metric.shape(),
            rows: &self.rows,
            blocks: self.ids.len().div_ceil(LANES),
            queries: queries.rounded(together.clone()),
            limits,
            from,
            bounds: &mut bounds,
            least: &mut least,
        }) {
            let ids = &self.ids[at.chunk * CHUNK * LANES..];
            let ids = &ids[..ids.len().min(CHUNK * LANES)];
            let width = width(limits.len() - at.query);
            for (index, (bounds, &least)) in bounds.iter().zip(&least).take(width).enumerate() {
                let index = at.query + index;
                if least <= limits[index] {
                    let query = (first + index, roundings[index], &mut limits[index]);
                    visit_chunk((ids, bounds, least, level), query, seeker);
                }
            }
            from = Place { query: at.query + width, ..at };
        }
    }
}

/// Has one query's near configurations of a chunk measured, whose smallest bound is `least`.
fn visit_chunk(
    (ids, bounds, least, level): (&[u32], &[F32Row; CHUNK], f32, Level),
    (query, rounding, limit): (usize, f64, &mut f32),
    seeker: &mut impl Seeker,
) {
    let bounds = &bounds[..ids.len().div_ceil(LANES)];
    let mut measure = |id: u32, limit: &mut f32| {
        seeker.measure(query, id);
        *limit = self::limit(seeker.cutoff(query), rounding);
    };
    let mut near = [0; CHUNK];
    level.run(Within { bounds, limit: least, out: &mut near });
    let first = indices(&near).find(|&index| index < ids.len());
    if let Some(first) = first {
        measure(ids[first], limit);
    }
    level.run(Within { bounds, limit: *limit, out: &mut near });
    for index in indices(&near).take_while(|&index| index < ids.len()) {
        if Some(index) != first && bounds[index / LANES][index % LANES] <= *limit {
            measure(ids[index], limit);
        }
    }
}

/// The lanes whose bits are set, counted through all blocks.
fn indices(blocks: &[u32; CHUNK]) -> impl Iterator<Item = usize> {
    blocks.iter().enumerate().flat_map(|(block, &bits)| {
        let mut bits = bits;
        std::iter::from_fn(move || {
            let lane = bits.trailing_zeros() as usize;
            (bits != 0).then(|| {
                bits &= bits - 1;
                block * LANES + lane
            })
        })
    })
}

/// Squared bounds above this belong to distances above the cutoff.
fn limit(cutoff: f64, rounding: f64) -> f32 {
    let far = (cutoff + rounding) * (1.0 + SUMMING);
    // Numbers too small for an f32 are nothing.
    ((far * far) as f32).next_up().max(f32::MIN_POSITIVE)
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
