//! Sums of squared distances to planes (Garland and Heckbert, *Surface simplification using quadric error metrics*, 1997).

use glam::DVec3;
use std::ops::{Add, AddAssign};

/// p ↦ Σ w (n·p + d)², for planes with weights: pᵀA p + 2 b·p + c.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Quadric {
    /// xx xy xz yy yz zz.
    a: [f64; 6],
    b: DVec3,
    c: f64,
    /// Σ w.
    weight: f64,
}

impl Quadric {
    /// One plane with unit normal `n` through `p`.
    pub fn plane(n: DVec3, p: DVec3, weight: f64) -> Self {
        let d = -n.dot(p);
        let a = [n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z].map(|x| weight * x);
        Self { a, b: n * (weight * d), c: weight * d * d, weight }
    }

    /// The mean of the squared distances of a point, by their weights, at least 0.
    pub fn mean_at(&self, p: DVec3) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        let squares = xx * p.x * p.x + yy * p.y * p.y + zz * p.z * p.z;
        let products = xy * p.x * p.y + xz * p.x * p.z + yz * p.y * p.z;
        let sum = squares + 2.0 * products + 2.0 * self.b.dot(p) + self.c;
        if self.weight > 0.0 { (sum / self.weight).max(0.0) } else { 0.0 }
    }
}

impl Add for Quadric {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            a: std::array::from_fn(|i| self.a[i] + other.a[i]),
            b: self.b + other.b,
            c: self.c + other.c,
            weight: self.weight + other.weight,
        }
    }
}

impl AddAssign for Quadric {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quadric_has_the_mean_of_squared_distances() {
        let quadric = Quadric::plane(DVec3::X, DVec3::new(1.0, 5.0, -2.0), 2.0)
            + Quadric::plane(DVec3::Z, DVec3::new(0.0, 0.0, 0.5), 3.0);
        assert!((quadric.mean_at(DVec3::new(3.0, 9.0, 1.5)) - (2.0 * 4.0 + 3.0) / 5.0).abs() < 1e-12);
        assert!(quadric.mean_at(DVec3::new(1.0, 7.0, 0.5)) < 1e-12);
    }
}
