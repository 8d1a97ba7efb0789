//! How a quaternion turns whose four numbers are cubics and are scaled to length 1.
//!
//! With c the four numbers and r = c / |c|, the angular velocity in the body's frame is ω = 2 Im(c̄ ċ) / |c|², so
//! |ω| ≤ 2|ċ|/|c|. Its derivative is ω̇ = 2 Im(c̄ c̈)/|c|² − 2 (c·ċ) ω/|c|², and the parts of ċ along c and across it are legs of
//! one right triangle, so |ω̇| ≤ 2|c̈|/|c| + 2|ċ|²/|c|². Two quaternions c and c + e are an angle of at most asin(|e|/|c|)
//! apart, and the rotations twice that.

use crate::curve::cubic::Cubic;
use glam::{DQuat, DVec3};
use std::f64::consts::PI;

/// How a quaternion turns within an interval of half width h; rates are per h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turning {
    /// At most this far is any rotation of the interval from the one at its middle, radians.
    pub angle: f64,
    /// The angular velocity at the middle, in the body's frame.
    pub spin: DVec3,
    /// At least the largest angular speed in the interval.
    pub rate: f64,
    /// At least the largest angular acceleration in the interval.
    pub bend: f64,
}

fn norm(of: [f64; 4]) -> f64 {
    of.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl Turning {
    /// Of the quaternion of these cubics (x, y, z, w), within h to either side of t.
    pub(crate) fn of(cubics: &[Cubic; 4], t: f64, h: f64) -> Self {
        let here = cubics.map(|cubic| cubic.about(t));
        if here.iter().all(Cubic::is_constant) {
            return Self { angle: 0.0, spin: DVec3::ZERO, rate: 0.0, bend: 0.0 };
        }
        let (value, slope) = (here.map(|p| p.0[0]), here.map(|p| p.0[1]));
        let length = norm(value);
        let away = norm(here.map(|p| p.farthest(h)));
        let nearest = length - away;
        let product = DQuat::from_array(value).conjugate() * DQuat::from_array(slope);
        let spin = product.xyz() * (2.0 * h / (length * length));
        let angle = turned(away, length);
        let (speed, acceleration) = (norm(here.map(|p| p.fastest(h))) * h, norm(here.map(|p| p.most_bent(h))) * h * h);
        // Compared so that NaN bounds nothing.
        let is_bounded = nearest > 0.0;
        let (rate, bend) = match is_bounded {
            true => (2.0 * speed / nearest, 2.0 * acceleration / nearest + 2.0 * (speed / nearest).powi(2)),
            false => (f64::INFINITY, f64::INFINITY),
        };
        Self { angle, spin, rate, bend }
    }

    /// At most this far is any rotation of a piece from those at its two ends, radians.
    pub(crate) fn over(cubics: &[Cubic; 4]) -> f64 {
        if cubics.iter().all(Cubic::is_constant) {
            return 0.0;
        }
        let away = norm(cubics.map(|p| {
            let (low, high) = p.range();
            high - low
        }));
        turned(away, norm(cubics.map(|p| p.at(0.0))).min(norm(cubics.map(|p| p.at(1.0)))))
    }
}

/// The angle between two rotations whose quaternions are `away` from each other, the one of them `length` long.
fn turned(away: f64, length: f64) -> f64 {
    // No two rotations are more than half a turn apart. Compared so that NaN is no bound.
    if away >= 0.0 && length > 0.0 { 2.0 * (away / length).min(1.0).asin() } else { PI }
}

/// How short a quaternion may become between two knots.
const SHORTEST: f64 = 0.1;
/// How often a piece is halved to show that.
const HALVINGS: u32 = 10;

/// Whether a quaternion's numbers are never so small together that its direction is lost.
pub(crate) fn keeps_away_from_zero(cubics: &[Cubic; 4]) -> bool {
    fn within(cubics: &[Cubic; 4], t: f64, h: f64, halvings: u32) -> bool {
        let here = cubics.map(|cubic| cubic.about(t));
        let length = norm(here.map(|p| p.0[0]));
        if length < SHORTEST {
            return false;
        }
        let is_far = length - norm(here.map(|p| p.farthest(h))) >= SHORTEST;
        let half = |side: f64| within(cubics, t + side * 0.5 * h, 0.5 * h, halvings - 1);
        is_far || (halvings > 0 && half(-1.0) && half(1.0))
    }
    within(cubics, 0.5, 0.5, HALVINGS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::pose::log_so3;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn at(cubics: &[Cubic; 4], u: f64) -> DQuat {
        DQuat::from_array(cubics.map(|p| p.at(u))).normalize()
    }

    /// Angular velocity in the body's frame, by differences.
    fn measured(cubics: &[Cubic; 4], u: f64) -> DVec3 {
        let step = 1e-5;
        let (a, b) = (at(cubics, u - step), at(cubics, u + step));
        log_so3(a.conjugate() * b) / (2.0 * step)
    }

    #[test]
    fn bounds_hold_and_are_close() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut ratios: Vec<[f64; 3]> = Vec::new();
        for _ in 0..300 {
            let mut unit = || DQuat::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0))).normalize();
            let (from, to) = (unit(), unit());
            let to = if from.dot(to) < 0.0 { -to } else { to };
            let mut slope = || rng.random_range(-0.5..0.5);
            let ends: [_; 4] = std::array::from_fn(|i| ((from.to_array()[i], slope()), (to.to_array()[i], slope())));
            let cubics = ends.map(|(from, to)| Cubic::hermite(from, to));
            assert!(keeps_away_from_zero(&cubics));
            let h = 0.25 * 0.5_f64.powi(rng.random_range(0..5));
            let t = rng.random_range(h..=1.0 - h);
            let bound = Turning::of(&cubics, t, h);
            assert!((measured(&cubics, t) * h).distance(bound.spin) < 1e-6);
            let mut most = [0.0_f64; 3];
            for i in -50..=50 {
                let u = t + h * f64::from(i) / 50.0;
                let angle = log_so3(at(&cubics, t).conjugate() * at(&cubics, u)).length();
                let bend = (measured(&cubics, u + 1e-4) - measured(&cubics, u - 1e-4)) / 2e-4;
                let found = [angle, measured(&cubics, u).length() * h, bend.length() * h * h];
                (0..3).for_each(|k| most[k] = most[k].max(found[k]));
            }
            let bounds = [bound.angle, bound.rate, bound.bend];
            assert!((0..3).all(|k| bounds[k] >= most[k] - 1e-6), "{bounds:?} {most:?}");
            ratios.push(std::array::from_fn(|k| bounds[k] / most[k]));
        }
        for k in 0..2 {
            ratios.sort_by(|a, b| a[k].total_cmp(&b[k]));
            assert!(ratios[ratios.len() / 2][k] < 2.0, "{k}: {}", ratios[ratios.len() / 2][k]);
        }
    }

    #[test]
    fn a_quaternion_that_vanishes_is_no_rotation() {
        let through = |from: f64, to: f64| Cubic::hermite((from, 0.0), (to, 0.0));
        let flat = through(0.0, 0.0);
        assert!(!keeps_away_from_zero(&[through(1.0, -1.0), flat, flat, flat]));
        assert!(keeps_away_from_zero(&[through(1.0, -1.0), through(0.3, 0.3), flat, flat]));
    }
}
