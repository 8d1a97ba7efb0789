//! One piece of a path between two knots: numbers and orientations, with their derivatives by time.

use glam::DQuat;

/// How a path goes from knot to knot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Every coordinate is the cubic Hermite polynomial in time through both positions and both velocities; the quaternion of a
    /// free-flyer is scaled to length 1 after that.
    #[default]
    Hermite,
    /// Straight at constant velocity; free-flyers turn on the quaternion geodesic.
    Linear,
}

/// A number and its first and second derivatives by time.
pub(crate) type Derivatives = [f64; 3];

/// A place between two knots.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece<'a> {
    /// The knots.
    pub from: &'a [f64],
    pub to: &'a [f64],
    /// Velocities at the knots; none where the piece is straight.
    pub velocities: Option<(&'a [f64], &'a [f64])>,
    /// Seconds from knot to knot; 0 where they are one.
    pub duration: f64,
    /// Share of the way in time, in [0, 1].
    pub u: f64,
}

impl Piece<'_> {
    /// A coordinate as it stands. At a knot its number is the knot's, bit for bit.
    pub fn number(&self, i: usize) -> Derivatives {
        let (a, b, h, u) = (self.from[i], self.to[i], self.duration, self.u);
        if h <= 0.0 {
            return [b, 0.0, 0.0];
        }
        let by = b - a;
        let [value, rate, acceleration] = match self.velocities {
            None => [a + u * by, by / h, 0.0],
            Some((v, w)) => {
                let (v, w) = (v[i] * h, w[i] * h);
                let value = a + u * u * (3.0 - 2.0 * u) * by + u * (1.0 - u) * ((1.0 - u) * v - u * w);
                let rate = 6.0 * u * (1.0 - u) * by + (1.0 - u) * (1.0 - 3.0 * u) * v + u * (3.0 * u - 2.0) * w;
                let acceleration = 6.0 * (1.0 - 2.0 * u) * by + (6.0 * u - 4.0) * v + (6.0 * u - 2.0) * w;
                [value, rate / h, acceleration / (h * h)]
            }
        };
        let value = if u >= 1.0 { b } else { value };
        [value, rate, acceleration]
    }

    /// The unit quaternion whose numbers begin at `i`, number by number.
    pub fn quaternion(&self, i: usize) -> [Derivatives; 4] {
        match self.velocities {
            Some(_) => scaled([0, 1, 2, 3].map(|n| self.number(i + n))),
            None => self.geodesic(i),
        }
    }

    /// From one orientation to the other at constant velocity; the signs of the quaternions are kept.
    fn geodesic(&self, i: usize) -> [Derivatives; 4] {
        let read = |q: &[f64]| DQuat::from_xyzw(q[i], q[i + 1], q[i + 2], q[i + 3]).normalize();
        let (a, b) = (read(self.from), read(self.to));
        let (h, u) = (self.duration, self.u);
        // Half of the angle between them, in [0, π].
        let angle = 2.0 * (a - b).length().atan2((a + b).length());
        let sine = angle.sin();
        let (value, rate) = match sine < 1e-9 || h <= 0.0 {
            true => ((a * (1.0 - u) + b * u).normalize(), DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
            false => {
                let (from, to) = (((1.0 - u) * angle).sin() / sine, (u * angle).sin() / sine);
                let (away, near) = (-((1.0 - u) * angle).cos() / sine, (u * angle).cos() / sine);
                (a * from + b * to, (a * away + b * near) * (angle / h))
            }
        };
        let turning = if h > 0.0 { angle / h } else { 0.0 };
        let (value, rate) = (value.to_array(), rate.to_array());
        std::array::from_fn(|n| [value[n], rate[n], -turning * turning * value[n]])
    }
}

/// Four numbers scaled to length 1: with p = n·u and |u| = 1 the rates are u̇ = (ṗ − u (u·ṗ)) / n, and so on.
fn scaled(p: [Derivatives; 4]) -> [Derivatives; 4] {
    let dot = |a: usize, b: usize, x: &[Derivatives; 4], y: &[Derivatives; 4]| -> f64 {
        x.iter().zip(y).map(|(x, y)| x[a] * y[b]).sum()
    };
    let length = dot(0, 0, &p, &p).sqrt();
    let growth = dot(0, 1, &p, &p) / length;
    let growing = (dot(1, 1, &p, &p) + dot(0, 2, &p, &p) - growth * growth) / length;
    p.map(|[value, rate, acceleration]| {
        let unit = value / length;
        let unit_rate = (rate - growth * unit) / length;
        [unit, unit_rate, (acceleration - 2.0 * growth * unit_rate - growing * unit) / length]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece<'a>(knots: &'a [Vec<f64>; 2], velocities: Option<&'a [Vec<f64>; 2]>, u: f64) -> Piece<'a> {
        let velocities = velocities.map(|[v, w]| (v.as_slice(), w.as_slice()));
        Piece { from: &knots[0], to: &knots[1], velocities, duration: 0.7, u }
    }

    /// Derivatives against differences of the values, and unit length.
    fn is_consistent(at: &dyn Fn(f64) -> [Derivatives; 4]) {
        let step = 1e-5;
        for u in [0.1, 0.35, 0.8] {
            let (before, here, after) = (at(u - step), at(u), at(u + step));
            let length: f64 = here.iter().map(|x| x[0] * x[0]).sum();
            assert!((length - 1.0).abs() < 1e-14, "{length}");
            for n in 0..4 {
                let h = step * 0.7;
                let rate = (after[n][0] - before[n][0]) / (2.0 * h);
                let acceleration = (after[n][0] - 2.0 * here[n][0] + before[n][0]) / (h * h);
                assert!((rate - here[n][1]).abs() < 1e-7, "{u} {n}: {rate} {}", here[n][1]);
                assert!((acceleration - here[n][2]).abs() < 1e-3, "{u} {n}: {acceleration} {}", here[n][2]);
            }
        }
    }

    #[test]
    fn numbers_pass_both_knots_at_both_velocities() {
        let (knots, velocities) = ([vec![0.3], vec![-1.1]], [vec![2.0], vec![-0.5]]);
        let at = |u: f64| piece(&knots, Some(&velocities), u).number(0);
        assert_eq!((at(0.0)[0], at(1.0)[0]), (0.3, -1.1));
        assert!((at(0.0)[1] - 2.0).abs() < 1e-14 && (at(1.0)[1] + 0.5).abs() < 1e-14);
        let step = 1e-5;
        for u in [0.2, 0.5, 0.9] {
            let rate = (at(u + step)[0] - at(u - step)[0]) / (2.0 * step * 0.7);
            let acceleration = (at(u + step)[1] - at(u - step)[1]) / (2.0 * step * 0.7);
            assert!((rate - at(u)[1]).abs() < 1e-8 && (acceleration - at(u)[2]).abs() < 1e-7, "{u}");
        }
    }

    #[test]
    fn orientations_have_length_one_and_their_own_derivatives() {
        let unit = |q: [f64; 4]| DQuat::from_array(q).normalize().to_array().to_vec();
        let knots = [unit([0.1, -0.3, 0.2, 0.9]), unit([0.5, 0.1, -0.4, 0.6])];
        let velocities = [vec![0.4, -0.2, 0.1, 0.3], vec![-0.5, 0.2, 0.7, 0.1]];
        is_consistent(&|u| piece(&knots, Some(&velocities), u).quaternion(0));
        is_consistent(&|u| piece(&knots, None, u).quaternion(0));
    }

    #[test]
    fn a_piece_without_duration_stands_where_it_ends() {
        let knots = [vec![1.0], vec![2.0]];
        let still = Piece { duration: 0.0, ..piece(&knots, None, 0.0) };
        assert_eq!(still.number(0), [2.0, 0.0, 0.0]);
    }
}
