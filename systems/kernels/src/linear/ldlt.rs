//! Damped normal equations (J·Jᵀ + λ²·1) x = b through LDLᵀ.
//!
//! A singular value decomposition costs 15 to 90 times as much at these sizes; with damping the matrix is positive
//! definite, and what rank loss there is shows in the pivots.

/// Solves (J·Jᵀ + `damping`·1) x = b for J given column by column, `rows` numbers each; `b` becomes the solution. False
/// where the matrix is not positive definite. `gram` is working memory of `rows`² numbers.
///
/// # Panics
/// If a slice is too short.
#[must_use]
pub fn solve_damped(jacobian: &[f64], rows: usize, damping: f64, gram: &mut [f64], b: &mut [f64]) -> bool {
    // With the usual sizes known to the compiler the loops unroll.
    match rows {
        3 => solve_damped_sized(jacobian, 3, damping, gram, b),
        5 => solve_damped_sized(jacobian, 5, damping, gram, b),
        6 => solve_damped_sized(jacobian, 6, damping, gram, b),
        _ => solve_damped_of_many(jacobian, rows, damping, gram, b),
    }
}

/// With many rows: the upper triangle is eliminated row by row, so that whatever lies behind a number is worked on side by
/// side. A sum along a row would wait for itself at every number.
fn solve_damped_of_many(jacobian: &[f64], rows: usize, damping: f64, gram: &mut [f64], b: &mut [f64]) -> bool {
    upper_gram(jacobian, rows, damping, gram);
    let (gram, b) = (&mut gram[..rows * rows], &mut b[..rows]);
    for k in 0..rows {
        let (above, below) = gram.split_at_mut((k + 1) * rows);
        let pivot_row = &above[k * rows..];
        let pivot = pivot_row[k];
        // A pivot that is not a number is not positive either.
        if pivot.is_nan() || pivot <= 0.0 {
            return false;
        }
        let known = b[k];
        for (i, row) in (k + 1..rows).zip(below.chunks_exact_mut(rows)) {
            let factor = pivot_row[i] / pivot;
            // Rows of constraints that share no joint, as of two legs, share nothing here either.
            if factor != 0.0 {
                row[i..].iter_mut().zip(&pivot_row[i..]).for_each(|(x, p)| *x -= factor * p);
                b[i] -= factor * known;
            }
        }
    }
    for k in (0..rows).rev() {
        let row = &gram[k * rows..][..rows];
        let known: f64 = row[k + 1..].iter().zip(&b[k + 1..]).map(|(u, x)| u * x).sum();
        b[k] = (b[k] - known) / row[k];
    }
    true
}

/// As [`damped_gram`], and fills the upper triangle alone. With many rows most columns have few numbers that are not zero:
/// a leg moves its own foot, not the other.
fn upper_gram(jacobian: &[f64], rows: usize, damping: f64, gram: &mut [f64]) {
    let gram = &mut gram[..rows * rows];
    gram.fill(0.0);
    for column in jacobian.chunks_exact(rows.max(1)) {
        for (i, &a) in column.iter().enumerate().filter(|&(_, &a)| a != 0.0) {
            gram[i * rows + i..(i + 1) * rows].iter_mut().zip(&column[i..]).for_each(|(sum, b)| *sum += a * b);
        }
    }
    gram.iter_mut().step_by(rows + 1).for_each(|d| *d += damping);
}

#[inline(always)]
fn solve_damped_sized(jacobian: &[f64], rows: usize, damping: f64, gram: &mut [f64], b: &mut [f64]) -> bool {
    damped_gram(jacobian, rows, damping, gram);
    if factor(gram, rows) <= 0.0 {
        return false;
    }
    solve(gram, rows, b);
    true
}

/// A = J·Jᵀ + `damping`·1 for J given column by column, `rows` numbers each; only the lower triangle of A is meaningful.
///
/// # Panics
/// If a slice is too short.
#[inline(always)]
pub fn damped_gram(jacobian: &[f64], rows: usize, damping: f64, gram: &mut [f64]) {
    let gram = &mut gram[..rows * rows];
    gram.fill(0.0);
    if rows == 0 {
        return;
    }
    for column in jacobian.chunks_exact(rows) {
        for (a, sums) in column.iter().zip(gram.chunks_exact_mut(rows)) {
            for (b, sum) in column.iter().zip(sums) {
                *sum += a * b;
            }
        }
    }
    gram.iter_mut().step_by(rows + 1).for_each(|d| *d += damping);
}

/// Factors the lower triangle of a symmetric positive definite matrix in place: unit lower L below the diagonal, D on it.
/// Returns the smallest pivot; where that is not positive the matrix was not positive definite and must not be solved with.
///
/// # Panics
/// If the slice is shorter than `size`².
#[inline(always)]
pub fn factor(matrix: &mut [f64], size: usize) -> f64 {
    let mut smallest = f64::INFINITY;
    for i in 0..size {
        let (above, rest) = matrix.split_at_mut(i * size);
        let row = &mut rest[..size];
        let mut pivot = row[i];
        for k in 0..i {
            let other = &above[k * size..k * size + k];
            // row[k] still lacks the division by D_k: it is L_ik · D_k.
            let mut sum = row[k];
            for (a, b) in row[..k].iter().zip(other) {
                sum -= a * b;
            }
            row[k] = sum;
        }
        for k in 0..i {
            let scaled = row[k] / above[k * size + k];
            pivot -= scaled * row[k];
            row[k] = scaled;
        }
        row[i] = pivot;
        // A pivot that is not a number must not hide behind `min`.
        if pivot.is_nan() || pivot <= 0.0 {
            return pivot.min(0.0);
        }
        smallest = smallest.min(pivot);
    }
    smallest
}

/// Solves with a matrix that [`factor`] has factored; `b` becomes the solution.
///
/// # Panics
/// If a slice is too short.
#[inline(always)]
pub fn solve(factored: &[f64], size: usize, b: &mut [f64]) {
    for i in 0..size {
        let row = &factored[i * size..i * size + i];
        let known: f64 = row.iter().zip(&b[..i]).map(|(l, x)| l * x).sum();
        b[i] -= known;
    }
    for i in 0..size {
        b[i] /= factored[i * size + i];
    }
    for i in (0..size).rev() {
        for k in i + 1..size {
            b[i] -= factored[k * size + i] * b[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn solving_agrees_with_nalgebra(
            (rows, width) in (1usize..22, 1usize..24),
            numbers in prop::collection::vec(-1.0..1.0f64, 22 * 24 + 22),
            zeros in 0usize..3,
        ) {
            let damping = 1e-3;
            // Every second or third number is zero, or none is.
            let is_zero = |i: usize| zeros > 0 && i.is_multiple_of(zeros + 1);
            let kept: Vec<f64> =
                numbers.iter().enumerate().map(|(i, &x)| if is_zero(i) { 0.0 } else { x }).collect();
            let jacobian = &kept[..rows * width];
            let mut b = numbers[22 * 24..22 * 24 + rows].to_vec();
            let mut gram = vec![0.0; rows * rows];
            let j = nalgebra::DMatrix::from_column_slice(rows, width, jacobian);
            let a = &j * j.transpose() + nalgebra::DMatrix::identity(rows, rows) * damping;
            let expected = a.lu().solve(&nalgebra::DVector::from_vec(b.clone())).unwrap();
            prop_assert!(solve_damped(jacobian, rows, damping, &mut gram, &mut b));
            for (x, y) in b.iter().zip(expected.iter()) {
                prop_assert!((x - y).abs() < 1e-9 * (1.0 + y.abs()), "{x} {y}");
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_noticed() {
        for rows in [6, 9] {
            let (mut gram, mut b) = (vec![0.0; rows * rows], vec![1.0; rows]);
            assert!(!solve_damped(&vec![0.0; rows * 3], rows, 0.0, &mut gram, &mut b), "{rows}");
            assert!(!solve_damped(&vec![f64::NAN; rows * 3], rows, 1.0, &mut gram, &mut b), "{rows}");
        }
        assert!(factor(&mut [1.0, 0.0, 2.0, 1.0], 2) <= 0.0);
        assert!(factor(&mut [f64::NAN], 1) <= 0.0);
    }
}
