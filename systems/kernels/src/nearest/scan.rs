//! Lower bounds of squared distances, sixteen at a time.

use super::metric::Shape;
use crate::lanes::{F32Row, Isa, Kernel, Lanes};

/// Blocks whose bounds are kept at once: on the stack, and soon enough for a near one to spare what follows.
pub(super) const CHUNK: usize = 64;

/// Bounds between one configuration and up to [`CHUNK`] blocks of them; answers the smallest.
pub(super) struct Scan<'a> {
    pub shape: &'a Shape,
    /// Rows of block after block.
    pub rows: &'a [F32Row],
    /// One number per row.
    pub query: &'a [f32],
    /// By block.
    pub out: &'a mut [F32Row],
}

/// θ² of a rotation by θ as a series in the squared chord c² = 4 sin²(θ/4) between unit quaternions, c² ≤ 2: that of
/// 16 asin²(c/2), all of whose terms are positive, so that what is left out makes it smaller.
const SERIES: [f32; 6] = [4.0, 1.0 / 3.0, 2.0 / 45.0, 1.0 / 140.0, 8.0 / 6300.0, 8.0 / 33264.0];

impl Kernel for Scan<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> f32 {
        let size = self.query.len();
        let mut least = I::F32::splat(isa, f32::INFINITY);
        let (straight, turns) = (self.shape.straight, self.shape.turns.len());
        for (block, out) in self.out.iter_mut().enumerate() {
            let rows = &self.rows[block * size..(block + 1) * size];
            let mut sum = I::F32::splat(isa, 0.0);
            for (row, &q) in rows[..straight].iter().zip(&self.query[..straight]) {
                let d = I::F32::load(isa, row) - q;
                sum = d.mul_add(d, sum);
            }
            for index in 0..turns {
                let at = straight + index;
                let d = (I::F32::load(isa, &rows[at]) - self.query[at]).abs();
                let d = d.min(I::F32::splat(isa, self.shape.turns[index]) - d);
                sum = d.mul_add(d, sum);
            }
            let mut at = straight + turns;
            for &weight in &self.shape.rotations {
                let (mut same, mut other) = (I::F32::splat(isa, 0.0), I::F32::splat(isa, 0.0));
                for (row, &q) in rows[at..at + 4].iter().zip(&self.query[at..at + 4]) {
                    let x = I::F32::load(isa, row);
                    let (minus, plus) = (x - q, x + q);
                    same = minus.mul_add(minus, same);
                    other = plus.mul_add(plus, other);
                }
                // A quaternion and its negative are one rotation.
                let chord = same.min(other);
                let mut series = I::F32::splat(isa, SERIES[5]);
                for coefficient in [SERIES[4], SERIES[3], SERIES[2], SERIES[1], SERIES[0]] {
                    series = series.mul_add(chord, I::F32::splat(isa, coefficient));
                }
                sum = (series * chord).mul_add(I::F32::splat(isa, weight), sum);
                at += 4;
            }
            least = least.min(sum);
            sum.store(out);
        }
        least.least()
    }
}
