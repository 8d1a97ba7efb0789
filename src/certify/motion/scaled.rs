//! A quaternion whose four numbers follow cubic polynomials and are scaled to length 1.

use crate::certify::motion::polynomial::Polynomial;
use glam::{DQuat, DVec4};

/// The least length of the numbers before they are scaled.
const SHORTEST: f64 = 0.25;

/// The numbers x y z w, and a lower bound of their length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaled {
    numbers: [Polynomial; 4],
    shortest: f64,
}

impl Scaled {
    /// None where all of them go straight.
    pub(crate) fn of(numbers: [Polynomial; 4]) -> Option<Self> {
        numbers.iter().any(|p| p.degree() > 1).then(|| Self { numbers, shortest: shortest(&numbers) })
    }

    /// Whether the numbers come so near zero that the rotation has no bounded speed.
    pub(crate) fn is_near_zero(&self) -> bool {
        // Compared so that NaN is near.
        let is_far = self.shortest >= SHORTEST;
        !is_far
    }

    pub(crate) fn at(&self, u: f64) -> DQuat {
        DQuat::from_array(self.numbers.map(|p| p.at(u))).normalize()
    }

    /// Upper bounds of the angular velocity and the angular acceleration by u. With the unit quaternion Q/|Q| they are
    /// 2|Q′|/|Q| and 2|Q″|/|Q| + 2|Q′|²/|Q|².
    pub(crate) fn rates(&self, from: f64, to: f64) -> (f64, f64) {
        let norm = |order: fn(&Polynomial) -> Polynomial| {
            DVec4::from_array(self.numbers.map(|p| order(&p).largest(from, to))).length() / self.shortest
        };
        let first = norm(Polynomial::derivative);
        let second = norm(|p| p.derivative().derivative());
        (2.0 * first, 2.0 * second + 2.0 * first * first)
    }
}

/// The curve stays in the convex hull of its Bézier control points.
fn shortest(numbers: &[Polynomial; 4]) -> f64 {
    let point =
        |of: fn([f64; 4]) -> f64| DVec4::from_array(numbers.map(|Polynomial([a, b, c, d, ..])| of([a, b, c, d])));
    let points = [
        point(|[a, ..]| a),
        point(|[a, b, ..]| a + b / 3.0),
        point(|[a, b, c, _]| a + (2.0 * b + c) / 3.0),
        point(|[a, b, c, d]| a + b + c + d),
    ];
    let along = points.iter().sum::<DVec4>().normalize_or_zero();
    points.iter().map(|p| p.dot(along)).fold(f64::INFINITY, f64::min)
}
