//! (J·Jᵀ + λ²·1) x = b in lanes, as the scalar `solve_damped`: another matrix in every lane.

use crate::lanes::Lanes;

/// A Jacobian column by column, of which some rows are looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneMatrix<'a, R> {
    /// The number in row r and column c is at c · `stride` + r.
    pub numbers: &'a [R],
    /// From one column to the next.
    pub stride: usize,
    /// Number of columns.
    pub width: usize,
}

/// Solves for the first rows, or those that `rows` names; the others' solution is left alone. Answers in which lanes the
/// matrix is positive definite. `b` holds one row of memory per row, `gram` is working memory of `rows.len()`².
///
/// # Panics
/// If a slice is too short.
#[inline(always)]
pub(crate) fn solve_damped_lanes<V: Lanes>(
    isa: V::Isa,
    matrix: LaneMatrix<'_, V::Row>,
    rows: &[usize],
    damping: V,
    gram: &mut [V::Row],
    b: &mut [V::Row],
) -> V::Mask {
    // With the usual sizes known to the compiler everything stays in registers.
    match *rows {
        [i, j, k] => solve_sized::<V, 3>(isa, matrix, [i, j, k], damping, b),
        [i, j, k, l, m] => solve_sized::<V, 5>(isa, matrix, [i, j, k, l, m], damping, b),
        [i, j, k, l, m, n] => solve_sized::<V, 6>(isa, matrix, [i, j, k, l, m, n], damping, b),
        _ => solve_any::<V>(isa, matrix, rows, damping, gram, b),
    }
}

#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "triangles are written by their indices")]
fn solve_sized<V: Lanes, const N: usize>(
    isa: V::Isa,
    matrix: LaneMatrix<'_, V::Row>,
    rows: [usize; N],
    damping: V,
    b: &mut [V::Row],
) -> V::Mask {
    let zero = V::constant(isa, 0.0);
    let mut a = [[zero; N]; N];
    for i in 0..N {
        a[i][i] = damping;
    }
    for column in 0..matrix.width {
        let numbers = &matrix.numbers[column * matrix.stride..][..matrix.stride];
        let mut j = [zero; N];
        for i in 0..N {
            j[i] = V::load(isa, &numbers[rows[i]]);
        }
        for i in 0..N {
            for k in 0..=i {
                a[i][k] = j[i].mul_add(j[k], a[i][k]);
            }
        }
    }
    // L·D below the diagonal until its row is done, 1/D beside it.
    let one = V::constant(isa, 1.0);
    let mut inverse = [zero; N];
    let mut positive = zero.lt(one);
    for i in 0..N {
        for k in 0..i {
            for m in 0..k {
                a[i][k] = a[i][m].neg_mul_add(a[k][m], a[i][k]);
            }
        }
        for k in 0..i {
            let scaled = a[i][k] * inverse[k];
            a[i][i] = scaled.neg_mul_add(a[i][k], a[i][i]);
            a[i][k] = scaled;
        }
        positive = positive & zero.lt(a[i][i]);
        inverse[i] = one / a[i][i];
    }
    let mut x = [zero; N];
    for i in 0..N {
        x[i] = V::load(isa, &b[rows[i]]);
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
        x[i].store(&mut b[rows[i]]);
    }
    positive
}

/// Any number of rows, in memory.
#[inline(always)]
fn solve_any<V: Lanes>(
    isa: V::Isa,
    matrix: LaneMatrix<'_, V::Row>,
    rows: &[usize],
    damping: V,
    gram: &mut [V::Row],
    b: &mut [V::Row],
) -> V::Mask {
    let n = rows.len();
    let (zero, one) = (V::constant(isa, 0.0), V::constant(isa, 1.0));
    for i in 0..n {
        for k in 0..=i {
            let mut sum = if i == k { damping } else { zero };
            for column in 0..matrix.width {
                let numbers = &matrix.numbers[column * matrix.stride..][..matrix.stride];
                sum = V::load(isa, &numbers[rows[i]]).mul_add(V::load(isa, &numbers[rows[k]]), sum);
            }
            sum.store(&mut gram[i * n + k]);
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
        let mut x = V::load(isa, &b[rows[i]]);
        for k in 0..i {
            x = V::load(isa, &gram[i * n + k]).neg_mul_add(V::load(isa, &b[rows[k]]), x);
        }
        x.store(&mut b[rows[i]]);
    }
    for i in (0..n).rev() {
        let mut x = V::load(isa, &b[rows[i]]) * V::load(isa, &gram[i * n + i]);
        for k in i + 1..n {
            x = V::load(isa, &gram[k * n + i]).neg_mul_add(V::load(isa, &b[rows[k]]), x);
        }
        x.store(&mut b[rows[i]]);
    }
    positive
}
