//! One system of many rows, its numbers side by side: what `ldlt` does with one number after another.
//!
//! Row i of J·Jᵀ + λ²·1 lies in lanes, and the right-hand side in the last of them, so that eliminating takes it along. With
//! a dozen rows that is several times as fast as numbers one by one.

use crate::lanes::{F64Row, Isa, Kernel, Lanes, Level};

/// Numbers of a row of lanes.
const LANES: usize = F64Row::LANES;

/// Rows that are summed up at once: what they need stays in registers.
const AT_ONCE: usize = 4;

/// Most rows: three rows of lanes, one number of which is the right-hand side.
pub(crate) const MOST_WIDE: usize = 3 * LANES - 1;

/// Working memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct WideMemory {
    /// Columns of J, filled up with zeros.
    columns: Vec<F64Row>,
    /// How many numbers of a column are not.
    filled: usize,
    /// Rows of the matrix.
    gram: Vec<F64Row>,
}

/// As [`solve_damped`](super::solve_damped), for up to [`MOST_WIDE`] rows; not for the level `scalar`, at which nothing is
/// solved.
pub(crate) fn solve_damped_wide(
    jacobian: &[f64],
    rows: usize,
    damping: f64,
    level: Level,
    memory: &mut WideMemory,
    b: &mut [f64],
) -> bool {
    match rows {
        0..LANES => level.run(Wide::<1> { jacobian, rows, damping, memory, b }),
        LANES..=15 => level.run(Wide::<2> { jacobian, rows, damping, memory, b }),
        16..=MOST_WIDE => level.run(Wide::<3> { jacobian, rows, damping, memory, b }),
        _ => false,
    }
}

/// With so many rows of lanes to a row of the matrix.
struct Wide<'a, const WIDTH: usize> {
    jacobian: &'a [f64],
    rows: usize,
    damping: f64,
    memory: &'a mut WideMemory,
    b: &'a mut [f64],
}

impl<const WIDTH: usize> Kernel for Wide<'_, WIDTH> {
    type Output = bool;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> bool {
        if !I::SIDE_BY_SIDE {
            return false;
        }
        let Self { jacobian, rows, damping, memory, b } = self;
        pack::<WIDTH>(jacobian, rows, memory);
        let columns = &memory.columns[..jacobian.len() / rows.max(1) * WIDTH];
        let gram = &mut memory.gram;
        if gram.len() < rows.next_multiple_of(AT_ONCE) * WIDTH {
            gram.resize(rows.next_multiple_of(AT_ONCE) * WIDTH, F64Row::default());
        }
        for first in (0..rows).step_by(AT_ONCE) {
            sum_up::<I, WIDTH>(isa, columns, first, gram);
        }
        for (row, (numbers, known)) in gram.chunks_exact_mut(WIDTH).zip(b.iter()).enumerate().take(rows) {
            numbers[row / LANES][row % LANES] += damping;
            numbers[WIDTH - 1][LANES - 1] = *known;
        }
        eliminate::<I, WIDTH>(isa, rows, gram) && substitute::<WIDTH>(rows, gram, b)
    }
}

/// Puts columns side by side.
#[inline(always)]
fn pack<const WIDTH: usize>(jacobian: &[f64], rows: usize, memory: &mut WideMemory) {
    let WideMemory { columns, filled, .. } = memory;
    let needed = jacobian.len() / rows.max(1) * WIDTH;
    // What lies behind the numbers of a column is zero as long as columns stay as long.
    if *filled != rows {
        columns.clear();
        *filled = rows;
    }
    if columns.len() < needed {
        columns.resize(needed, F64Row::default());
    }
    for (column, packed) in jacobian.chunks_exact(rows.max(1)).zip(columns.chunks_exact_mut(WIDTH)) {
        let (whole, rest) = column.as_chunks::<LANES>();
        for (numbers, row) in whole.iter().zip(packed.iter_mut()) {
            row.0 = *numbers;
        }
        if let Some(row) = packed.get_mut(whole.len()) {
            row.0.iter_mut().zip(rest).for_each(|(x, number)| *x = *number);
        }
    }
}

/// Some rows of J·Jᵀ, from `first` on.
#[inline(always)]
fn sum_up<I: Isa, const WIDTH: usize>(isa: I, columns: &[F64Row], first: usize, gram: &mut [F64Row]) {
    let mut sums = [[I::F64::constant(isa, 0.0); WIDTH]; AT_ONCE];
    for column in columns.chunks_exact(WIDTH) {
        let own = &column[first / LANES].0[first % LANES..][..AT_ONCE];
        for (row, sums) in sums.iter_mut().enumerate() {
            for (part, sum) in sums.iter_mut().enumerate() {
                *sum = I::F64::constant(isa, own[row]).mul_add(I::F64::load(isa, &column[part]), *sum);
            }
        }
    }
    let rows = gram[first * WIDTH..].chunks_exact_mut(WIDTH);
    for (numbers, sums) in rows.zip(&sums) {
        for (row, sum) in numbers.iter_mut().zip(sums) {
            sum.store(row);
        }
    }
}

/// Eliminates what is left of the diagonal, the right-hand side with it; false where a pivot is not positive.
#[inline(always)]
fn eliminate<I: Isa, const WIDTH: usize>(isa: I, rows: usize, gram: &mut [F64Row]) -> bool {
    for k in 0..rows {
        let (above, below) = gram.split_at_mut((k + 1) * WIDTH);
        let own = &above[k * WIDTH..];
        let pivot = own[k / LANES][k % LANES];
        // A pivot that is not a number is not positive either.
        if pivot.is_nan() || pivot <= 0.0 {
            return false;
        }
        let inverse = 1.0 / pivot;
        for (i, row) in (k + 1..rows).zip(below.chunks_exact_mut(WIDTH)) {
            let factor = own[i / LANES][i % LANES] * inverse;
            // Rows of constraints that share no joint, as of two legs, share nothing here either.
            if factor != 0.0 {
                let factor = I::F64::constant(isa, factor);
                for part in 0..WIDTH {
                    let left = I::F64::load(isa, &own[part]).neg_mul_add(factor, I::F64::load(isa, &row[part]));
                    left.store(&mut row[part]);
                }
            }
        }
    }
    true
}

/// Solves what is left, from the last row up.
#[inline(always)]
fn substitute<const WIDTH: usize>(rows: usize, gram: &[F64Row], b: &mut [f64]) -> bool {
    for k in (0..rows).rev() {
        let row = &gram[k * WIDTH..][..WIDTH];
        let mut left = row[WIDTH - 1][LANES - 1];
        for (j, x) in b.iter().enumerate().take(rows).skip(k + 1) {
            left -= row[j / LANES][j % LANES] * x;
        }
        b[k] = left / row[k / LANES][k % LANES];
    }
    true
}

#[cfg(test)]
mod tests {
    use super::{MOST_WIDE, WideMemory, solve_damped_wide};
    use crate::lanes::Level;
    use crate::linear::solve_damped;
    use rand::{RngExt, SeedableRng};

    fn levels() -> impl Iterator<Item = Level> {
        Level::available().into_iter().filter(|level| *level != Level::scalar())
    }

    #[test]
    fn numbers_side_by_side_solve_what_one_after_another_do() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let mut memory = WideMemory::default();
        for round in 0..300 {
            let (rows, width) = (rng.random_range(1..=MOST_WIDE), rng.random_range(1..40));
            let filled = if round % 2 == 0 { 1.0 } else { 0.4 };
            let mut number = || if rng.random_bool(filled) { rng.random_range(-1.0..1.0) } else { 0.0 };
            let jacobian: Vec<f64> = (0..rows * width).map(|_| number()).collect();
            let known: Vec<f64> = (0..rows).map(|_| number()).collect();
            let (mut expected, mut gram) = (known.clone(), vec![0.0; rows * rows]);
            assert!(solve_damped(&jacobian, rows, 1e-3, &mut gram, &mut expected));
            for level in levels() {
                let mut found = known.clone();
                assert!(solve_damped_wide(&jacobian, rows, 1e-3, level, &mut memory, &mut found), "{level}: {rows}");
                for (x, y) in found.iter().zip(&expected) {
                    assert!((x - y).abs() < 1e-9 * (1.0 + y.abs()), "{level}: {rows}×{width}: {x} {y}");
                }
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_noticed() {
        let mut memory = WideMemory::default();
        for level in levels() {
            for rows in [1, 7, 8, 12, 15, 16, MOST_WIDE] {
                let mut b = vec![1.0; rows];
                let mut solve = |number: f64, damping: f64| {
                    solve_damped_wide(&vec![number; rows * 3], rows, damping, level, &mut memory, &mut b)
                };
                assert!(!solve(0.0, 0.0) && !solve(f64::NAN, 1.0), "{level}: {rows}");
            }
            assert!(!solve_damped_wide(&[1.0; 72], MOST_WIDE + 1, 1.0, level, &mut memory, &mut [1.0; 24]));
        }
    }
}
