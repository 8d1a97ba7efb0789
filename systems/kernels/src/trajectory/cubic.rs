//! One coordinate between two knots: a cubic polynomial in Hermite form, and its extremes in closed form.

/// The cubic polynomial over [0, `width`] through both positions and both derivatives. The parameter may be a length or a time; the
/// names here are those of a curve over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    /// Position at both ends.
    pub positions: [f64; 2],
    /// Derivative by the parameter at both ends.
    pub velocities: [f64; 2],
    /// Length of the parameter interval, above 0.
    pub width: f64,
}

impl Cubic {
    /// Position at `u` in [0, 1].
    #[inline]
    #[must_use]
    pub fn position(&self, u: f64) -> f64 {
        let ([q0, q1], [v0, v1]) = (self.positions, self.velocities);
        let w = 1.0 - u;
        // The nearer end is kept exactly.
        let between =
            if u <= 0.5 { q0 + (q1 - q0) * u * u * (3.0 - 2.0 * u) } else { q1 - (q1 - q0) * w * w * (3.0 - 2.0 * w) };
        between + self.width * u * w * (v0 * w - v1 * u)
    }

    /// Derivative by the parameter at `u` in [0, 1].
    #[inline]
    #[must_use]
    pub fn velocity(&self, u: f64) -> f64 {
        let [v0, v1] = self.velocities;
        let [a0, a1] = self.accelerations();
        if u <= 0.5 {
            v0 + self.width * u * (a0 + 0.5 * (a1 - a0) * u)
        } else {
            let w = 1.0 - u;
            v1 - self.width * w * (a1 - 0.5 * (a1 - a0) * w)
        }
    }

    /// Second derivative by the parameter at both ends; between them it is linear.
    #[inline]
    #[must_use]
    pub fn accelerations(&self) -> [f64; 2] {
        let ([q0, q1], [v0, v1]) = (self.positions, self.velocities);
        let mean = (q1 - q0) / self.width;
        let (d0, d1) = (mean - v0, mean - v1);
        [(4.0 * d0 + 2.0 * d1) / self.width, -(2.0 * d0 + 4.0 * d1) / self.width]
    }

    /// Second derivative by the parameter at `u` in [0, 1].
    #[inline]
    #[must_use]
    pub fn acceleration(&self, u: f64) -> f64 {
        let [a0, a1] = self.accelerations();
        a0 + (a1 - a0) * u
    }

    /// Third derivative by the parameter, a constant.
    #[inline]
    #[must_use]
    pub fn jerk(&self) -> f64 {
        let [a0, a1] = self.accelerations();
        (a1 - a0) / self.width
    }

    /// Least and greatest position.
    #[must_use]
    pub fn position_range(&self) -> [f64; 2] {
        let [q0, q1] = self.positions;
        let mut range = [q0.min(q1), q0.max(q1)];
        for u in self.turning_points().into_iter().flatten() {
            let q = self.position(u);
            range = [range[0].min(q), range[1].max(q)];
        }
        range
    }

    /// Least and greatest velocity.
    #[inline]
    #[must_use]
    pub fn velocity_range(&self) -> [f64; 2] {
        let [v0, v1] = self.velocities;
        let range = [v0.min(v1), v0.max(v1)];
        let [a0, a1] = self.accelerations();
        if a0 * a1 >= 0.0 {
            return range;
        }
        let between = v0 + 0.5 * self.width * a0 * (a0 / (a0 - a1));
        [range[0].min(between), range[1].max(between)]
    }

    /// Largest magnitude of the velocity.
    #[inline]
    #[must_use]
    pub fn top_velocity(&self) -> f64 {
        let [low, high] = self.velocity_range();
        high.max(-low)
    }

    /// Largest magnitude of the acceleration.
    #[inline]
    #[must_use]
    pub fn top_acceleration(&self) -> f64 {
        let [a0, a1] = self.accelerations();
        a0.abs().max(a1.abs())
    }

    /// Where between the ends the velocity is 0, as `u` in (0, 1).
    fn turning_points(&self) -> [Option<f64>; 2] {
        let [a0, a1] = self.accelerations();
        // velocity / width = c + b u + a u²
        let (a, b, c) = (0.5 * (a1 - a0), a0, self.velocities[0] / self.width);
        let square = b * b - 4.0 * a * c;
        // Not a number counts as none: positions that are not finite have no range.
        if square.is_nan() || square < 0.0 {
            return [None, None];
        }
        let twice = -(b + square.sqrt().copysign(b));
        let inside = |u: f64| (u > 0.0 && u < 1.0).then_some(u);
        [inside(2.0 * c / twice), inside(0.5 * twice / a)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cubic() -> impl Strategy<Value = Cubic> {
        ([-3.0..3.0, -3.0..3.0_f64], [-4.0..4.0, -4.0..4.0_f64], 0.01..3.0_f64)
            .prop_map(|(positions, velocities, width)| Cubic { positions, velocities, width })
    }

    proptest! {
        #[test]
        fn derivatives_are_those_of_the_position(cubic in cubic(), u in 0.01..0.99_f64) {
            let step = 1e-5;
            let difference = |f: &dyn Fn(f64) -> f64| (f(u + step) - f(u - step)) / (2.0 * step * cubic.width);
            let scale = cubic.top_acceleration() + cubic.top_velocity() + 1.0;
            prop_assert!((difference(&|u| cubic.position(u)) - cubic.velocity(u)).abs() < 1e-6 * scale / cubic.width);
            prop_assert!((difference(&|u| cubic.velocity(u)) - cubic.acceleration(u)).abs() < 1e-6 * scale / cubic.width);
            prop_assert!((difference(&|u| cubic.acceleration(u)) - cubic.jerk()).abs() < 1e-6 * scale / cubic.width);
        }

        #[test]
        fn extremes_are_reached_and_not_passed(cubic in cubic()) {
            let samples = |f: &dyn Fn(f64) -> f64| {
                (0..=2000).map(|k| f(f64::from(k) / 2000.0)).fold([f64::INFINITY, f64::NEG_INFINITY], |r, v| [r[0].min(v), r[1].max(v)])
            };
            let agree = |found: [f64; 2], sampled: [f64; 2], slack: f64| {
                found[0] <= sampled[0] + 1e-12 && found[1] >= sampled[1] - 1e-12
                    && found[0] >= sampled[0] - slack && found[1] <= sampled[1] + slack
            };
            // Half a step away from an extreme a value differs by its second derivative times (step/2)²/2.
            let step = cubic.width / 2000.0;
            let slack = |second: f64| second * step * step / 8.0 + 1e-11;
            prop_assert!(agree(cubic.position_range(), samples(&|u| cubic.position(u)), slack(cubic.top_acceleration())));
            prop_assert!(agree(cubic.velocity_range(), samples(&|u| cubic.velocity(u)), slack(cubic.jerk().abs())));
            let [low, high] = samples(&|u| cubic.acceleration(u));
            prop_assert!((cubic.top_acceleration() - high.max(-low)).abs() < 1e-9);
        }
    }

    #[test]
    fn ends_are_exact() {
        let cubic = Cubic { positions: [0.1, 0.7], velocities: [0.3, -0.9], width: 0.37 };
        assert_eq!([cubic.position(0.0), cubic.position(1.0)], cubic.positions);
        assert_eq!([cubic.velocity(0.0), cubic.velocity(1.0)], cubic.velocities);
    }

    #[test]
    fn a_straight_line_has_no_turning_point() {
        let still = Cubic { positions: [1.0, 1.0], velocities: [0.0, 0.0], width: 2.0 };
        assert_eq!(
            (still.position_range(), still.velocity_range(), still.top_acceleration()),
            ([1.0, 1.0], [0.0, 0.0], 0.0)
        );
        let line = Cubic { positions: [1.0, 3.0], velocities: [1.0, 1.0], width: 2.0 };
        assert_eq!(
            (line.position_range(), line.velocity_range(), line.top_acceleration()),
            ([1.0, 3.0], [1.0, 1.0], 0.0)
        );
    }
}
