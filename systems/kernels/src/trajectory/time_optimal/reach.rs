//! Linear programs in two unknowns: squared path velocities at both ends of an interval.
//!
//! All constraints are strips |p x + r y| ≤ bound with bound > 0 and the box 0 ≤ x ≤ X, 0 ≤ y ≤ Y, so that x = y = 0 is feasible.

/// Relative excess of a strip that counts as rounding.
const ROUNDING: f64 = 1e-13;
/// Most strips that a program adds one after the other; each makes the optimum smaller.
const STEPS: usize = 24;

/// The largest x for which some y in [0, `end`] keeps all strips.
///
/// Strips are added one at a time, the most violated one next. The optimum of those so far violates it, so that the new optimum lies
/// on its border: a program in one unknown. Source: R. Seidel, *Small-dimensional linear programming and convex hulls made easy*, 1991.
pub(super) fn largest_start(p: &[f64], r: &[f64], bound: f64, [start, end]: [f64; 2]) -> f64 {
    let mut point = [start, end.min(start)];
    let (mut added, mut count) = ([(0.0, 0.0); STEPS], 0);
    while count < STEPS {
        let Some((worst, excess)) = most_violated(p, r, bound, point) else { break };
        let (a, b) = (p[worst], r[worst]);
        point = on_border((a, b, bound.copysign(excess)), &added[..count], bound, [start, end]);
        added[count] = (a, b);
        count += 1;
    }
    point[0].clamp(0.0, start)
}

/// The strip that a point violates most, and p x + r y.
fn most_violated(p: &[f64], r: &[f64], bound: f64, [x, y]: [f64; 2]) -> Option<(usize, f64)> {
    let mut worst = (bound * (1.0 + ROUNDING), None);
    for (j, (p, r)) in p.iter().zip(r).enumerate() {
        let value = p * x + r * y;
        if value.abs() > worst.0 {
            worst = (value.abs(), Some((j, value)));
        }
    }
    worst.1
}

/// The point with the largest x on the line p x + r y = c that lies in the box and in the strips.
fn on_border((p, r, c): (f64, f64, f64), strips: &[(f64, f64)], bound: f64, [start, end]: [f64; 2]) -> [f64; 2] {
    let by_x = r.abs() >= p.abs();
    // The line by one of the unknowns: the other one is offset + slope · t.
    let (slope, offset) = if by_x { (-p / r, c / r) } else { (-r / p, c / p) };
    let (own, other) = if by_x { (start, end) } else { (end, start) };
    let mut range = [0.0, own];
    narrow(&mut range, slope, offset, [0.0, other]);
    for &(p, r) in strips {
        let (own, other) = if by_x { (p, r) } else { (r, p) };
        narrow(&mut range, own + other * slope, other * offset, [-bound, bound]);
    }
    // Where rounding has left no point, the two ends are nearly the same.
    let t = if range[0] > range[1] {
        0.5 * (range[0] + range[1])
    } else if by_x || slope >= 0.0 {
        range[1]
    } else {
        range[0]
    };
    let other = (offset + slope * t).clamp(0.0, other);
    if by_x { [t, other] } else { [other, t] }
}

/// Narrows the range of t to where low ≤ slope · t + offset ≤ high.
fn narrow(range: &mut [f64; 2], slope: f64, offset: f64, [low, high]: [f64; 2]) {
    if slope == 0.0 {
        return;
    }
    let (a, b) = ((low - offset) / slope, (high - offset) / slope);
    range[0] = range[0].max(a.min(b));
    range[1] = range[1].min(a.max(b));
}

/// The largest y in [0, `end`] that keeps all strips with this x.
pub(super) fn largest_end(p: &[f64], r: &[f64], bound: f64, x: f64, end: f64) -> f64 {
    let mut most = end;
    for (p, r) in p.iter().zip(r) {
        // r y ≤ bound − p x, or the same turned round; 0/0 bounds nothing.
        let y = (bound - p * x * 1.0_f64.copysign(*r)) / r.abs();
        if y < most {
            most = y;
        }
    }
    most.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_point_of_a_dense_grid_is_better(strips in proptest::collection::vec((-3.0..3.0_f64, -3.0..3.0_f64), 1..20), start in 0.1..3.0_f64, end in 0.0..3.0_f64) {
            let (p, r): (Vec<f64>, Vec<f64>) = strips.into_iter().unzip();
            let keeps = |x: f64, y: f64, slack: f64| p.iter().zip(&r).all(|(p, r)| (p * x + r * y).abs() <= 1.0 + slack);
            let x = largest_start(&p, &r, 1.0, [start, end]);
            let steps = 400;
            let grid = |top: f64| (0..=steps).map(move |k| top * f64::from(k) / f64::from(steps));
            for better in grid(start).filter(|other| *other > x + 1e-9) {
                prop_assert!(grid(end).all(|y| !keeps(better, y, -1e-9)), "{x} {better}");
            }
            // Some y goes with it: the least slack over y is a convex function.
            let y = largest_end(&p, &r, 1.0, x * (1.0 - 1e-9), end);
            prop_assert!(keeps(x * (1.0 - 1e-9), y, 1e-9), "{x} {y}");
        }
    }
}
