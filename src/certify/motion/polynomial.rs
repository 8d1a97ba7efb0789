//! Polynomials on the unit interval: values, derivatives, roots, ranges.
//!
//! Roots are found between the roots of the derivative, where the polynomial is monotone, by bisection to the last bit: no
//! root inside of the interval at which the sign changes is missed.

/// Coefficients of 1, u, … u⁵.
pub const COEFFICIENTS: usize = 6;

/// A polynomial of at most fifth degree in u ∈ [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Polynomial(pub [f64; COEFFICIENTS]);

impl Polynomial {
    /// The same value everywhere.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self([value, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// From one value to another.
    #[must_use]
    pub fn linear(from: f64, to: f64) -> Self {
        Self([from, to - from, 0.0, 0.0, 0.0, 0.0])
    }

    /// From values and slopes (per unit of u) at both ends.
    #[must_use]
    pub fn cubic(from: (f64, f64), to: (f64, f64)) -> Self {
        let rise = to.0 - from.0;
        Self([from.0, from.1, 3.0 * rise - 2.0 * from.1 - to.1, from.1 + to.1 - 2.0 * rise, 0.0, 0.0])
    }

    /// From values, slopes and second derivatives (per unit of u) at both ends.
    #[must_use]
    pub fn quintic(from: [f64; 3], to: [f64; 3]) -> Self {
        let ([p, v, a], [q, w, b]) = (from, to);
        let rise = q - p;
        Self([
            p,
            v,
            a / 2.0,
            10.0 * rise - 6.0 * v - 4.0 * w - 1.5 * a + 0.5 * b,
            -15.0 * rise + 8.0 * v + 7.0 * w + 1.5 * a - b,
            6.0 * rise - 3.0 * (v + w) - 0.5 * (a - b),
        ])
    }

    /// The value at u.
    #[must_use]
    pub fn at(&self, u: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * u + c)
    }

    /// The derivative by u.
    #[must_use]
    pub fn derivative(&self) -> Self {
        Self(std::array::from_fn(|i| self.0.get(i + 1).map_or(0.0, |c| (i + 1) as f64 * c)))
    }

    /// `factor` · p + `offset`.
    #[must_use]
    pub fn scaled(&self, factor: f64, offset: f64) -> Self {
        let mut scaled = self.0.map(|c| factor * c);
        scaled[0] += offset;
        Self(scaled)
    }

    /// The highest power with a coefficient.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.0.iter().rposition(|c| *c != 0.0).unwrap_or(0)
    }

    /// The places in [from, to] where it changes its sign or touches zero with a change of its slope's sign, ascending.
    #[must_use]
    pub fn roots(&self, from: f64, to: f64) -> Vec<f64> {
        if self.degree() == 0 {
            return Vec::new();
        }
        if self.degree() == 1 {
            let root = -self.0[0] / self.0[1];
            return if (from..=to).contains(&root) { vec![root] } else { Vec::new() };
        }
        let mut stops = vec![from];
        stops.extend(self.derivative().roots(from, to));
        stops.push(to);
        let mut roots: Vec<f64> = stops.windows(2).filter_map(|ends| self.root_between(ends[0], ends[1])).collect();
        roots.dedup();
        roots
    }

    /// The root in an interval in which it is monotone.
    fn root_between(&self, mut low: f64, mut high: f64) -> Option<f64> {
        let (at_low, at_high) = (self.at(low), self.at(high));
        if at_low == 0.0 {
            return Some(low);
        }
        if at_high == 0.0 {
            return Some(high);
        }
        if (at_low > 0.0) == (at_high > 0.0) {
            return None;
        }
        loop {
            let middle = low.midpoint(high);
            if middle <= low || middle >= high {
                return Some(middle);
            }
            if (self.at(middle) > 0.0) == (at_low > 0.0) { low = middle } else { high = middle }
        }
    }

    /// Where it can be smallest or largest in [from, to]: the ends and what is between them.
    #[must_use]
    pub fn turning_points(&self, from: f64, to: f64) -> Vec<f64> {
        let mut points = vec![from];
        if self.degree() > 1 {
            points.extend(self.derivative().roots(from, to));
        }
        points.push(to);
        points
    }

    /// The largest |p| in [from, to], rounded up.
    #[must_use]
    pub fn largest(&self, from: f64, to: f64) -> f64 {
        let largest = match self.degree() {
            0 => self.0[0].abs(),
            1 => self.at(from).abs().max(self.at(to).abs()),
            _ => self.turning_points(from, to).into_iter().map(|u| self.at(u).abs()).fold(0.0, f64::max),
        };
        // What a value near a turning point may be off by.
        largest + 1e-13 * self.0.iter().map(|c| c.abs()).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_meet_their_ends() {
        let p = Polynomial::quintic([0.3, -1.2, 2.5], [-0.7, 0.4, -3.0]);
        let (v, a) = (p.derivative(), p.derivative().derivative());
        for (found, wanted) in [
            (p.at(0.0), 0.3),
            (v.at(0.0), -1.2),
            (a.at(0.0), 2.5),
            (p.at(1.0), -0.7),
            (v.at(1.0), 0.4),
            (a.at(1.0), -3.0),
        ] {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
        let p = Polynomial::cubic((0.3, -1.2), (-0.7, 0.4));
        let v = p.derivative();
        for (found, wanted) in [(p.at(0.0), 0.3), (v.at(0.0), -1.2), (p.at(1.0), -0.7), (v.at(1.0), 0.4)] {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
    }

    #[test]
    fn roots_are_found_in_order() {
        // (u − 0.1)(u − 0.4)(u − 0.9)
        let p = Polynomial([-0.036, 0.49, -1.4, 1.0, 0.0, 0.0]);
        let roots = p.roots(0.0, 1.0);
        assert_eq!(roots.len(), 3, "{roots:?}");
        for (root, wanted) in roots.iter().zip([0.1, 0.4, 0.9]) {
            assert!((root - wanted).abs() < 1e-12, "{root}");
        }
        assert!(Polynomial::constant(0.0).roots(0.0, 1.0).is_empty());
    }

    #[test]
    fn the_largest_value_is_not_missed() {
        let p = Polynomial::cubic((0.0, 4.0), (0.0, -4.0));
        let sampled = (0..=1000).map(|i| p.at(f64::from(i) / 1000.0).abs()).fold(0.0, f64::max);
        assert!(p.largest(0.0, 1.0) >= sampled && p.largest(0.0, 1.0) < sampled + 1e-5);
        assert!(p.largest(0.0, 0.1) < 0.4);
    }
}
