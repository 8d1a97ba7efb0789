//! One cubic polynomial, its extremes, and how far it moves within an interval.

/// p(u) = a + b u + c u² + d u³, as [a, b, c, d].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cubic(pub [f64; 4]);

impl Cubic {
    /// The polynomial on u ∈ [0, 1] through two values, with a slope per unit of u at each.
    #[must_use]
    #[inline]
    pub fn hermite(from: (f64, f64), to: (f64, f64)) -> Self {
        let rise = to.0 - from.0;
        Self([from.0, from.1, 3.0 * rise - 2.0 * from.1 - to.1, from.1 + to.1 - 2.0 * rise])
    }

    /// p(u).
    #[must_use]
    #[inline]
    pub fn at(&self, u: f64) -> f64 {
        let [a, b, c, d] = self.0;
        a + u * (b + u * (c + u * d))
    }

    /// The same polynomial as a function of u − t.
    #[must_use]
    #[inline]
    pub fn about(&self, t: f64) -> Self {
        let [_, b, c, d] = self.0;
        Self([self.at(t), b + t * (2.0 * c + 3.0 * t * d), c + 3.0 * t * d, d])
    }

    /// `factor` · p + `offset`.
    #[must_use]
    #[inline]
    pub fn scaled(&self, factor: f64, offset: f64) -> Self {
        let [a, b, c, d] = self.0;
        Self([factor * a + offset, factor * b, factor * c, factor * d])
    }

    /// At least |p(u) − p(0)| for |u| ≤ h; exact where p is monotone there.
    #[must_use]
    #[inline]
    pub fn farthest(&self, h: f64) -> f64 {
        let [_, b, c, d] = self.0;
        let (linear, bent, cubic) = (b.abs(), c.abs() * h, d * h * h);
        if linear >= 2.0 * bent + 3.0 * cubic.abs() {
            return h * ((b + cubic).abs() + bent);
        }
        h * (linear + bent + cubic.abs())
    }

    /// At least |p′(u)| for |u| ≤ h.
    #[must_use]
    #[inline]
    pub fn fastest(&self, h: f64) -> f64 {
        let [_, b, c, d] = self.0;
        b.abs() + h * (2.0 * c.abs() + 3.0 * h * d.abs())
    }

    /// At least |p″(u)| for |u| ≤ h; exact.
    #[must_use]
    #[inline]
    pub fn most_bent(&self, h: f64) -> f64 {
        2.0 * self.0[2].abs() + 6.0 * h * self.0[3].abs()
    }

    /// The least and the largest value on [0, 1].
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        let [a, b, c, d] = self.0;
        let end = self.at(1.0);
        let (mut low, mut high) = (a.min(end), a.max(end));
        // p′ = b + 2c u + 3d u², without the cancellation of the usual formula.
        let root = (c * c - 3.0 * b * d).sqrt();
        let sum = -(c + root.copysign(c));
        for u in [sum / (3.0 * d), b / sum] {
            // Compared so that NaN, of no root or of 0 / 0, is left out.
            if u > 0.0 && u < 1.0 {
                let value = self.at(u);
                (low, high) = (low.min(value), high.max(value));
            }
        }
        (low, high)
    }

    /// Whether it is the same value everywhere.
    #[must_use]
    #[inline]
    pub fn is_constant(&self) -> bool {
        self.0[1..] == [0.0; 3]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn drawn(rng: &mut ChaCha8Rng) -> Cubic {
        let degree = rng.random_range(1..=4);
        let mut number = || rng.random_range(-2.0..2.0) * 10.0_f64.powi(rng.random_range(-3..2));
        Cubic(std::array::from_fn(|power| if power <= degree { number() } else { 0.0 }))
    }

    #[test]
    fn it_passes_its_ends() {
        let p = Cubic::hermite((0.3, -1.2), (-0.7, 0.4));
        let slope = |t: f64| p.about(t).0[1];
        for (found, wanted) in [(p.at(0.0), 0.3), (slope(0.0), -1.2), (p.at(1.0), -0.7), (slope(1.0), 0.4)] {
            assert!((found - wanted).abs() < 1e-14, "{found} {wanted}");
        }
    }

    #[test]
    fn extremes_are_those_of_dense_samples() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..2000 {
            let p = drawn(&mut rng);
            let (low, high) = p.range();
            let values = (0..=1000).map(|i| p.at(f64::from(i) / 1000.0));
            let (least, most) = values.fold((f64::MAX, f64::MIN), |(l, m), v| (l.min(v), m.max(v)));
            let size: f64 = p.0.iter().map(|x| x.abs()).sum();
            assert!(low <= least && high >= most, "{p:?}");
            assert!(least - low < 1e-5 * size && high - most < 1e-5 * size, "{p:?}");
        }
    }

    #[test]
    fn bounds_within_an_interval_hold_and_are_close() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut loosest = [0.0_f64; 3];
        for _ in 0..2000 {
            let (p, t, h) = (drawn(&mut rng), rng.random_range(0.0..1.0), 10.0_f64.powf(rng.random_range(-4.0..0.0)));
            let here = p.about(t);
            let mut most = [0.0_f64; 3];
            for i in -500..=500 {
                let around = p.about(t + h * f64::from(i) / 500.0);
                let found = [here.0[0] - around.0[0], around.0[1], 2.0 * around.0[2]];
                (0..3).for_each(|k| most[k] = most[k].max(found[k].abs()));
            }
            let bounds = [here.farthest(h), here.fastest(h), here.most_bent(h)];
            let size: f64 = p.0.iter().map(|x| x.abs()).sum();
            for k in 0..3 {
                assert!(bounds[k] >= most[k] - 1e-13 * size, "{k}: {} < {} of {p:?}", bounds[k], most[k]);
                if most[k] > 1e-9 * size {
                    loosest[k] = loosest[k].max(bounds[k] / most[k]);
                }
            }
        }
        assert!(loosest[0] < 8.0 && loosest[1] < 4.0 && loosest[2] < 1.001, "{loosest:?}");
    }
}
