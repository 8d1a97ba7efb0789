//! Steps of damped least squares in lanes: −Jᵀ(J·Jᵀ + λ²·1)⁻¹ e, another Jacobian in every lane.
//!
//! The same numbers as the scalar `solve_damped` and the product behind it. With the usual sizes known to the compiler the
//! matrix stays in registers from its first product to the multipliers; that takes loops with a constant number of turns,
//! and eliminations that are written out one by one.

use crate::lanes::{Lanes, Mask};

/// A Jacobian column by column, with what it is solved for.
#[derive(Debug)]
pub(crate) struct LaneSystem<'a, R> {
    /// The number in row r and column c is at c · `values.len()` + r. What is taken for zero may be zero afterwards.
    pub jacobian: &'a mut [R],
    /// The error of each row.
    pub values: &'a [R],
    /// For each column the lanes (bits) in which it is taken for zero.
    pub frozen: &'a [u32],
}

/// Which rows of a Jacobian are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rows {
    Every,
    /// The first, fourth and fifth of five, where the others are zero in value and Jacobian.
    ThreeOfFive,
}

/// Writes the step, one row of memory per column. Answers in which lanes the matrix is positive definite; elsewhere the step
/// means nothing. `gram` and `multipliers` are working memory of the number of rows, squared and as it is.
///
/// # Panics
/// If a slice is too short.
#[inline(always)]
pub(crate) fn damped_step_lanes<V: Lanes>(
    isa: V::Isa,
    system: LaneSystem<'_, V::Row>,
    rows: Rows,
    damping: V,
    (gram, multipliers): (&mut [V::Row], &mut [V::Row]),
    step: &mut [V::Row],
) -> V::Mask {
    match (rows, system.values.len()) {
        (Rows::ThreeOfFive, 5) => sized::<V, 5, 3>(isa, system, [0, 3, 4], damping, step),
        (_, 3) => sized::<V, 3, 3>(isa, system, [0, 1, 2], damping, step),
        (_, 5) => sized::<V, 5, 5>(isa, system, [0, 1, 2, 3, 4], damping, step),
        (_, 6) => sized::<V, 6, 6>(isa, system, [0, 1, 2, 3, 4, 5], damping, step),
        _ => any_size::<V>(isa, system, damping, gram, multipliers, step),
    }
}

/// N of R rows.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "triangles are written by their indices")]
fn sized<V: Lanes, const R: usize, const N: usize>(
    isa: V::Isa,
    system: LaneSystem<'_, V::Row>,
    rows: [usize; N],
    damping: V,
    step: &mut [V::Row],
) -> V::Mask {
    let zero = V::constant(isa, 0.0);
    let (columns, _) = system.jacobian.as_chunks::<R>();
    let values = &system.values[..R];
    let mut a = [[zero; N]; N];
    for i in 0..N {
        a[i][i] = damping;
    }
    for (numbers, frozen) in columns.iter().zip(system.frozen) {
        let frozen = <V::Mask as Mask>::from_bits(isa, *frozen);
        let mut j = [zero; N];
        for i in 0..N {
            j[i] = V::select(frozen, zero, V::load(isa, &numbers[rows[i]]));
        }
        for i in 0..N {
            for k in 0..=i {
                a[i][k] = j[i].mul_add(j[k], a[i][k]);
            }
        }
    }
    let mut inverse = [zero; N];
    let mut positive = zero.lt(V::constant(isa, 1.0));
    eliminate::<V, N>(isa, 0, &mut a, &mut inverse, &mut positive);
    eliminate::<V, N>(isa, 1, &mut a, &mut inverse, &mut positive);
    eliminate::<V, N>(isa, 2, &mut a, &mut inverse, &mut positive);
    eliminate::<V, N>(isa, 3, &mut a, &mut inverse, &mut positive);
    eliminate::<V, N>(isa, 4, &mut a, &mut inverse, &mut positive);
    eliminate::<V, N>(isa, 5, &mut a, &mut inverse, &mut positive);
    let mut x = [zero; N];
    for i in 0..N {
        x[i] = V::load(isa, &values[rows[i]]);
    }
    for i in 0..N {
        for k in 0..i {
            x[i] = a[i][k].neg_mul_add(x[k], x[i]);
        }
    }
    for i in 0..N {
        x[i] = x[i] * inverse[i];
    }
    for i in (0..N).rev() {
        for k in i + 1..N {
            x[i] = a[k][i].neg_mul_add(x[k], x[i]);
        }
    }
    for ((numbers, frozen), out) in columns.iter().zip(system.frozen).zip(step) {
        let mut sum = zero;
        for i in 0..N {
            sum = V::load(isa, &numbers[rows[i]]).neg_mul_add(x[i], sum);
        }
        V::select(<V::Mask as Mask>::from_bits(isa, *frozen), zero, sum).store(out);
    }
    positive
}

/// Takes row and column `k` out of what is right of and below them; there is L then, and 1/D in `inverse`. Each number sees
/// the products that it would see row by row, in the same order.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "triangles are written by their indices")]
fn eliminate<V: Lanes, const N: usize>(
    isa: V::Isa,
    k: usize,
    a: &mut [[V; N]; N],
    inverse: &mut [V; N],
    positive: &mut V::Mask,
) {
    if k >= N {
        return;
    }
    *positive = *positive & V::constant(isa, 0.0).lt(a[k][k]);
    inverse[k] = V::constant(isa, 1.0) / a[k][k];
    for j in k + 1..N {
        let scaled = a[j][k] * inverse[k];
        a[j][j] = scaled.neg_mul_add(a[j][k], a[j][j]);
        for i in j + 1..N {
            a[i][j] = a[i][k].neg_mul_add(scaled, a[i][j]);
        }
        a[j][k] = scaled;
    }
}

/// Rows come in threes; nine sums leave room in the registers for what is summed up, and each number loaded serves three.
const TILE: usize = 3;

/// Writes the products of rows `i`.. with rows `k`.. of n, A × B of them.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "tiles are written by their indices")]
fn products<V: Lanes, const A: usize, const B: usize>(
    isa: V::Isa,
    jacobian: &[V::Row],
    (n, i, k): (usize, usize, usize),
    damping: V,
    gram: &mut [V::Row],
) {
    let mut sums = [[V::constant(isa, 0.0); B]; A];
    for a in 0..A {
        for b in 0..B {
            if i + a == k + b {
                sums[a][b] = damping;
            }
        }
    }
    for numbers in jacobian.chunks_exact(n) {
        let (left, right) = (&numbers[i..][..A], &numbers[k..][..B]);
        for a in 0..A {
            let number = V::load(isa, &left[a]);
            for b in 0..B {
                sums[a][b] = number.mul_add(V::load(isa, &right[b]), sums[a][b]);
            }
        }
    }
    for a in 0..A {
        for b in 0..B {
            sums[a][b].store(&mut gram[(i + a) * n + k + b]);
        }
    }
}

/// Any number of rows, in memory.
// Long: factorisation and both substitutions read the same rows; each would need all arguments again.
#[inline(always)]
fn any_size<V: Lanes>(
    isa: V::Isa,
    system: LaneSystem<'_, V::Row>,
    damping: V,
    gram: &mut [V::Row],
    b: &mut [V::Row],
    step: &mut [V::Row],
) -> V::Mask {
    let n = system.values.len();
    if n == 0 {
        return V::constant(isa, 0.0).lt(V::constant(isa, 1.0));
    }
    let (zero, one) = (V::constant(isa, 0.0), V::constant(isa, 1.0));
    for (numbers, frozen) in system.jacobian.chunks_exact_mut(n).zip(system.frozen).filter(|(_, frozen)| **frozen != 0)
    {
        let frozen = <V::Mask as Mask>::from_bits(isa, *frozen);
        for number in numbers {
            V::select(frozen, zero, V::load(isa, number)).store(number);
        }
    }
    let jacobian = &*system.jacobian;
    let whole = n - n % TILE;
    for i in (0..whole).step_by(TILE) {
        for k in (0..=i).step_by(TILE) {
            products::<V, TILE, TILE>(isa, jacobian, (n, i, k), damping, gram);
        }
    }
    for i in whole..n {
        for k in (0..whole).step_by(TILE) {
            products::<V, 1, TILE>(isa, jacobian, (n, i, k), damping, gram);
        }
        for k in whole..=i {
            products::<V, 1, 1>(isa, jacobian, (n, i, k), damping, gram);
        }
    }
    let mut positive = zero.lt(one);
    for i in 0..n {
        for k in 0..i {
            let mut sum = V::load(isa, &gram[i * n + k]);
            for m in 0..k {
                sum = V::load(isa, &gram[i * n + m]).neg_mul_add(V::load(isa, &gram[k * n + m]), sum);
            }
            sum.store(&mut gram[i * n + k]);
        }
        let mut pivot = V::load(isa, &gram[i * n + i]);
        for k in 0..i {
            let unscaled = V::load(isa, &gram[i * n + k]);
            // The diagonal holds 1/D of the rows that are done.
            let scaled = unscaled * V::load(isa, &gram[k * n + k]);
            pivot = scaled.neg_mul_add(unscaled, pivot);
            scaled.store(&mut gram[i * n + k]);
        }
        positive = positive & zero.lt(pivot);
        (one / pivot).store(&mut gram[i * n + i]);
    }
    for i in 0..n {
        let mut x = V::load(isa, &system.values[i]);
        for k in 0..i {
            x = V::load(isa, &gram[i * n + k]).neg_mul_add(V::load(isa, &b[k]), x);
        }
        x.store(&mut b[i]);
    }
    for i in (0..n).rev() {
        let mut x = V::load(isa, &b[i]) * V::load(isa, &gram[i * n + i]);
        for k in i + 1..n {
            x = V::load(isa, &gram[k * n + i]).neg_mul_add(V::load(isa, &b[k]), x);
        }
        x.store(&mut b[i]);
    }
    for ((numbers, frozen), out) in jacobian.chunks_exact(n).zip(system.frozen).zip(step) {
        let mut sum = zero;
        for (number, x) in numbers.iter().zip(&*b) {
            sum = V::load(isa, number).neg_mul_add(V::load(isa, x), sum);
        }
        V::select(<V::Mask as Mask>::from_bits(isa, *frozen), zero, sum).store(out);
    }
    positive
}

#[cfg(test)]
mod tests {
    use super::{LaneSystem, Rows, damped_step_lanes};
    use crate::lanes::{F32Row, F64Row, Isa, Kernel, Lanes, Level, Mask, Scalar};
    use crate::linear::solve_damped;
    use std::ops::IndexMut;

    const WIDTH: usize = 7;
    const DAMPING: f64 = 1e-3;

    /// Numbers within ±1, another for every row, column and lane.
    fn number(row: usize, column: usize, lane: usize) -> f64 {
        ((row * 131 + column * 17 + lane * 7 + 3) as f64 * 0.618_034).fract() * 2.0 - 1.0
    }

    /// Rows 1 and 2 of five are zero where only three are used.
    fn entry(rows: Rows, row: usize, column: usize, lane: usize) -> f64 {
        if rows == Rows::ThreeOfFive && (row == 1 || row == 2) { 0.0 } else { number(row, column, lane) }
    }

    fn frozen(column: usize) -> u32 {
        [0, 0b1010_0110_1001_0011, 0, u32::MAX, 1, 0, 0b10][column]
    }

    struct Step<'a, R> {
        rows: Rows,
        jacobian: &'a mut [R],
        values: &'a [R],
        step: &'a mut [R],
    }

    impl<R: Copy + Default> Step<'_, R> {
        #[inline(always)]
        fn find<V: Lanes<Row = R>>(self, isa: V::Isa) -> u32 {
            let frozen: [u32; WIDTH] = std::array::from_fn(frozen);
            let system = LaneSystem { jacobian: self.jacobian, values: self.values, frozen: &frozen };
            let (mut gram, mut multipliers) = ([R::default(); 64], [R::default(); 8]);
            let damping = V::constant(isa, DAMPING);
            damped_step_lanes::<V>(isa, system, self.rows, damping, (&mut gram, &mut multipliers), self.step).bits()
        }
    }

    impl Kernel for Step<'_, F64Row> {
        type Output = u32;
        #[inline(always)]
        fn run<I: Isa>(self, isa: I) -> u32 {
            if I::SIDE_BY_SIDE { self.find::<I::F64>(isa) } else { 0 }
        }
    }

    impl Kernel for Step<'_, F32Row> {
        type Output = u32;
        #[inline(always)]
        fn run<I: Isa>(self, isa: I) -> u32 {
            if I::SIDE_BY_SIDE { self.find::<I::F32>(isa) } else { 0 }
        }
    }

    fn filled<R: Copy + Default + IndexMut<usize>>(
        lanes: usize,
        count: usize,
        of: impl Fn(usize, usize) -> f64,
    ) -> Vec<R>
    where
        R::Output: Scalar,
    {
        let mut rows = vec![R::default(); count];
        for (k, row) in rows.iter_mut().enumerate() {
            for lane in 0..lanes {
                row[lane] = Scalar::of(of(k, lane));
            }
        }
        rows
    }

    fn found<R: Copy + Default + IndexMut<usize>>(
        level: Level,
        lanes: usize,
        count: usize,
        zero: Rows,
        rows: Rows,
    ) -> Vec<R>
    where
        R::Output: Scalar,
        for<'a> Step<'a, R>: Kernel<Output = u32>,
    {
        let mut jacobian = filled(lanes, count * WIDTH, |k, lane| entry(zero, k % count, k / count, lane));
        let values = filled(lanes, count, |row, lane| entry(zero, row, WIDTH, lane));
        let mut step = vec![R::default(); WIDTH];
        let positive = level.run(Step { rows, jacobian: &mut jacobian, values: &values, step: &mut step });
        assert_eq!(positive, (1 << lanes) - 1);
        step
    }

    fn agrees<R: Copy + Default + IndexMut<usize>>(level: Level, lanes: usize, count: usize, rows: Rows, within: f64)
    where
        R::Output: Scalar,
        for<'a> Step<'a, R>: Kernel<Output = u32>,
    {
        let step: Vec<R> = found(level, lanes, count, rows, rows);
        for lane in 0..lanes {
            let at = |row, column| if frozen(column) >> lane & 1 == 1 { 0.0 } else { entry(rows, row, column, lane) };
            let jacobian: Vec<f64> = (0..count * WIDTH).map(|k| at(k % count, k / count)).collect();
            let mut y: Vec<f64> = (0..count).map(|row| entry(rows, row, WIDTH, lane)).collect();
            assert!(solve_damped(&jacobian, count, DAMPING, &mut vec![0.0; count * count], &mut y));
            for (column, step) in step.iter().enumerate() {
                let expected = -jacobian[column * count..][..count].iter().zip(&y).map(|(j, y)| j * y).sum::<f64>();
                let found = step[lane].to_f64();
                assert!((found - expected).abs() <= within, "{level}, {count} rows, {rows:?}: {found} {expected}");
                assert!(frozen(column) >> lane & 1 == 0 || found == 0.0);
            }
        }
    }

    #[test]
    fn steps_in_lanes_are_those_of_the_scalar_code() {
        for level in Level::available().into_iter().filter(|level| *level != Level::scalar()) {
            // Three, five and six rows have code of their own.
            for count in 1..=8 {
                agrees::<F64Row>(level, 8, count, Rows::Every, 1e-10);
                agrees::<F32Row>(level, 16, count, Rows::Every, 2e-2);
            }
            agrees::<F64Row>(level, 8, 5, Rows::ThreeOfFive, 1e-10);
            agrees::<F32Row>(level, 16, 5, Rows::ThreeOfFive, 2e-2);
        }
    }

    #[test]
    fn leaving_out_rows_of_zeros_changes_no_bit() {
        for level in Level::available().into_iter().filter(|level| *level != Level::scalar()) {
            let of = |rows| -> Vec<F64Row> { found(level, 8, 5, Rows::ThreeOfFive, rows) };
            assert_eq!(of(Rows::ThreeOfFive), of(Rows::Every));
            let of = |rows| -> Vec<F32Row> { found(level, 16, 5, Rows::ThreeOfFive, rows) };
            assert_eq!(of(Rows::ThreeOfFive), of(Rows::Every));
        }
    }
}
