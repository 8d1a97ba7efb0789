//! Lower bounds of squared distances, sixteen at a time, of several queries to a pass over the blocks.

use super::metric::Shape;
use crate::lanes::{F32Row, Isa, Kernel, Lanes, Mask};

/// Lanes of a block.
pub(super) const LANES: usize = F32Row::LANES;

/// Blocks whose bounds are kept at once: on the stack, and soon enough for a near one to spare what follows.
pub(super) const CHUNK: usize = 16;

/// Queries that share one reading of a block: their sums stay in registers, also where there are but sixteen of those.
pub(super) const PASS: usize = 4;

/// Bounds of one pass over one chunk: by query, by block.
pub(super) type Bounds = [[F32Row; CHUNK]; PASS];

/// How many of the queries that are left share the next pass.
#[inline(always)]
pub(super) fn width(left: usize) -> usize {
    left.min(PASS)
}

/// Where a pass over a chunk takes place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    pub chunk: usize,
    /// The first query of the pass.
    pub query: usize,
}

/// Goes on from a place, chunk after chunk and in each pass after pass, up to the first at which a query's smallest bound is
/// within its limit; answers where that is.
pub(super) struct Scan<'a> {
    pub shape: &'a Shape,
    /// Rows of block after block.
    pub rows: &'a [F32Row],
    /// Number of blocks.
    pub blocks: usize,
    /// One number per row and query, those of a pass side by side.
    pub queries: &'a [f32],
    /// By query: squared bounds above this belong to what is too far.
    pub limits: &'a [f32],
    pub from: Place,
    /// Of the pass that is answered.
    pub bounds: &'a mut Bounds,
    /// The same, by query: the smallest.
    pub least: &'a mut [f32; PASS],
}

impl Kernel for Scan<'_> {
    type Output = Option<Place>;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> Option<Place> {
        let size = self.shape.rows();
        let mut at = self.from;
        while at.chunk * CHUNK < self.blocks {
            let end = self.blocks.min((at.chunk + 1) * CHUNK);
            let rows = &self.rows[at.chunk * CHUNK * size..end * size];
            let blocks = end - at.chunk * CHUNK;
            while at.query < self.limits.len() {
                let width = width(self.limits.len() - at.query);
                let queries = &self.queries[at.query * size..(at.query + width) * size];
                match width {
                    1 => pass::<I, 1>(isa, (self.shape, rows, blocks), queries, self.bounds, self.least),
                    2 => pass::<I, 2>(isa, (self.shape, rows, blocks), queries, self.bounds, self.least),
                    3 => pass::<I, 3>(isa, (self.shape, rows, blocks), queries, self.bounds, self.least),
                    _ => pass::<I, PASS>(isa, (self.shape, rows, blocks), queries, self.bounds, self.least),
                }
                for index in 0..width {
                    if self.least[index] <= self.limits[at.query + index] {
                        return Some(at);
                    }
                }
                at.query += width;
            }
            at = Place { chunk: at.chunk + 1, query: 0 };
        }
        None
    }
}

/// θ² of a rotation by θ as a series in the squared chord c² = 4 sin²(θ/4) between unit quaternions, c² ≤ 2: that of
/// 16 asin²(c/2), all of whose terms are positive, so that what is left out makes it smaller.
const SERIES: [f32; 6] = [4.0, 1.0 / 3.0, 2.0 / 45.0, 1.0 / 140.0, 8.0 / 6300.0, 8.0 / 33264.0];

/// Bounds between `Q` configurations and the blocks of a chunk.
// Long: one pass over the rows of a block; its parts would share all of its sums.
#[inline(always)]
fn pass<I: Isa, const Q: usize>(
    isa: I,
    (shape, rows, blocks): (&Shape, &[F32Row], usize),
    queries: &[f32],
    bounds: &mut Bounds,
    smallest: &mut [f32; PASS],
) {
    let (size, straight, turns) = (shape.rows(), shape.straight, shape.turns.len());
    let (queries, _) = queries.as_chunks::<Q>();
    let mut least = [I::F32::splat(isa, f32::INFINITY); Q];
    for block in 0..blocks {
        let rows = &rows[block * size..(block + 1) * size];
        let mut sums = [I::F32::splat(isa, 0.0); Q];
        for (row, q) in rows[..straight].iter().zip(&queries[..straight]) {
            let x = I::F32::load(isa, row);
            for index in 0..Q {
                let d = x - q[index];
                sums[index] = d.mul_add(d, sums[index]);
            }
        }
        let turning = straight..straight + turns;
        for ((row, q), &turn) in rows[turning.clone()].iter().zip(&queries[turning]).zip(&shape.turns) {
            let x = I::F32::load(isa, row);
            for index in 0..Q {
                let d = (x - q[index]).abs();
                let d = d.min(I::F32::splat(isa, turn) - d);
                sums[index] = d.mul_add(d, sums[index]);
            }
        }
        let mut at = straight + turns;
        for &weight in &shape.rotations {
            let mut same = [I::F32::splat(isa, 0.0); Q];
            let mut other = [I::F32::splat(isa, 0.0); Q];
            for (row, q) in rows[at..at + 4].iter().zip(&queries[at..at + 4]) {
                let x = I::F32::load(isa, row);
                for index in 0..Q {
                    let (minus, plus) = (x - q[index], x + q[index]);
                    same[index] = minus.mul_add(minus, same[index]);
                    other[index] = plus.mul_add(plus, other[index]);
                }
            }
            for index in 0..Q {
                // A quaternion and its negative are one rotation.
                let chord = same[index].min(other[index]);
                let mut series = I::F32::splat(isa, SERIES[5]);
                for coefficient in [SERIES[4], SERIES[3], SERIES[2], SERIES[1], SERIES[0]] {
                    series = series.mul_add(chord, I::F32::splat(isa, coefficient));
                }
                sums[index] = (series * chord).mul_add(I::F32::splat(isa, weight), sums[index]);
            }
            at += 4;
        }
        for index in 0..Q {
            least[index] = least[index].min(sums[index]);
            sums[index].store(&mut bounds[index][block]);
        }
    }
    for index in 0..Q {
        smallest[index] = least[index].least();
    }
}

/// Which lanes of some blocks have bounds within a limit, as bits.
pub(super) struct Within<'a> {
    pub bounds: &'a [F32Row],
    pub limit: f32,
    /// By block, lane 0 the lowest bit.
    pub out: &'a mut [u32],
}

impl Kernel for Within<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        let limit = I::F32::splat(isa, self.limit);
        for (bounds, out) in self.bounds.iter().zip(self.out) {
            *out = I::F32::load(isa, bounds).le(limit).bits();
        }
    }
}
