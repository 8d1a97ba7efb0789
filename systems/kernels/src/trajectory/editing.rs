//! Splines are cut, joined, turned round and stretched.

use crate::trajectory::spline::{Spline, SplineError};

impl Spline {
    /// Cuts the piece on which a parameter lies into two that are the same curve, and returns the number of the knot there. At a
    /// knot, and beyond an end, nothing changes.
    ///
    /// # Panics
    /// If there are fewer than two knots.
    pub fn cut(&mut self, parameter: f64) -> usize {
        let (piece, u) = self.locate(parameter);
        let at = |knot: usize| self.parameters[knot];
        if parameter <= at(piece) || u <= 0.0 {
            return piece;
        }
        if parameter >= at(piece + 1) || u >= 1.0 {
            return piece + 1;
        }
        let knot = piece + 1;
        for coordinate in 0..self.size {
            let of = self.cubic(piece, coordinate);
            self.knots.push(of.position(u));
            self.velocities.push(of.velocity(u));
        }
        self.knots[knot * self.size..].rotate_right(self.size);
        self.velocities[knot * self.size..].rotate_right(self.size);
        self.parameters.insert(knot, parameter);
        knot
    }

    /// The part from one parameter to another, with the same parameters. Beyond an end the part ends there.
    ///
    /// # Panics
    /// If there are fewer than two knots, or if the part has no length.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        let from = from.max(self.parameters[0]);
        let to = to.min(self.parameters[self.len() - 1]);
        assert!(from < to, "a part from {from} to {to} has no length");
        let mut part = Self::new(self.size);
        part.push_point(from, self, self.locate(from), 1.0);
        for knot in 0..self.len() {
            if self.parameters[knot] > from && self.parameters[knot] < to {
                part.push(self.parameters[knot], self.knot(knot), self.velocity(knot));
            }
        }
        part.push_point(to, self, self.locate(to), 1.0);
        part
    }

    /// Appends another spline, whose parameters are shifted so that it begins at the end of this one. Its first knot is left out.
    ///
    /// # Errors
    /// It has another size, or it begins more than `tolerance` away in a position or a derivative. Then nothing has changed.
    pub fn append(&mut self, other: &Self, tolerance: f64) -> Result<(), SplineError> {
        if other.size != self.size {
            return Err(SplineError::Lengths);
        }
        if self.is_empty() || other.is_empty() {
            self.parameters.extend_from_slice(&other.parameters);
            self.knots.extend_from_slice(&other.knots);
            self.velocities.extend_from_slice(&other.velocities);
            return Ok(());
        }
        let last = self.len() - 1;
        for coordinate in 0..self.size {
            let apart = (self.knot(last)[coordinate] - other.knot(0)[coordinate]).abs();
            let slower = (self.velocity(last)[coordinate] - other.velocity(0)[coordinate]).abs();
            if !(apart <= tolerance && slower <= tolerance) {
                return Err(SplineError::Apart { coordinate });
            }
        }
        let (end, start) = (self.parameters[last], other.parameters[0]);
        self.parameters.extend(other.parameters[1..].iter().map(|p| end + (p - start)));
        self.knots.extend_from_slice(&other.knots[self.size..]);
        self.velocities.extend_from_slice(&other.velocities[self.size..]);
        Ok(())
    }

    /// Turns the curve round: the same points from the last to the first, over the same parameters.
    pub fn reverse(&mut self) {
        let (Some(&first), Some(&last)) = (self.parameters.first(), self.parameters.last()) else { return };
        self.parameters.reverse();
        self.parameters.iter_mut().for_each(|p| *p = first + (last - *p));
        for rows in [&mut self.knots, &mut self.velocities] {
            rows.reverse();
            rows.chunks_exact_mut(self.size.max(1)).for_each(<[f64]>::reverse);
        }
        self.velocities.iter_mut().for_each(|v| *v = -*v);
    }

    /// Multiplies the parameter, counted from the first knot, by a factor above 0: with 2 the curve takes twice as long.
    pub fn stretch(&mut self, factor: f64) {
        let Some(&first) = self.parameters.first() else { return };
        self.parameters.iter_mut().for_each(|p| *p = first + (*p - first) * factor);
        self.velocities.iter_mut().for_each(|v| *v /= factor);
    }

    /// Adds a number to all parameters.
    pub fn shift(&mut self, by: f64) {
        self.parameters.iter_mut().for_each(|p| *p += by);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> Spline {
        Spline::from_parts(
            2,
            vec![1.0, 1.5, 3.0],
            vec![0.0, 1.0, 0.5, -1.0, 2.0, 0.25],
            vec![1.0, 0.0, 0.5, 0.75, -2.0, 0.0],
        )
        .unwrap()
    }

    fn same(one: &Spline, other: &Spline, of: impl Fn(f64) -> f64) {
        let (mut a, mut b) = ([0.0; 2], [0.0; 2]);
        for k in 0..=300 {
            let p = one.parameters()[0] + one.extent() * f64::from(k) / 300.0;
            one.position(p, &mut a);
            other.position(of(p), &mut b);
            assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12), "{p}: {a:?} {b:?}");
        }
    }

    #[test]
    fn cuts_and_parts_are_the_same_curve() {
        let whole = curve();
        let mut cut = whole.clone();
        assert_eq!(cut.cut(2.2), 2);
        assert_eq!(cut.cut(1.1), 1);
        assert_eq!([cut.cut(1.0), cut.cut(0.0), cut.cut(1.1), cut.cut(3.0), cut.cut(9.0)], [0, 0, 1, 4, 4]);
        assert_eq!(cut.len(), 5);
        cut.check().unwrap();
        same(&whole, &cut, |p| p);
        let part = whole.part(1.2, 2.9);
        assert_eq!(part.len(), 3);
        same(&part, &whole, |p| p);
        let mut joined = whole.part(1.0, 1.7);
        joined.append(&whole.part(1.7, 3.0), 1e-12).unwrap();
        same(&whole, &joined, |p| p);
        assert_eq!(joined.append(&whole, 1e-12), Err(SplineError::Apart { coordinate: 0 }));
    }

    #[test]
    fn a_curve_is_turned_round_and_stretched() {
        let mut turned = curve();
        turned.reverse();
        same(&curve(), &turned, |p| 4.0 - p);
        turned.reverse();
        assert_eq!(turned, curve());
        turned.stretch(2.0);
        turned.shift(1.0);
        same(&curve(), &turned, |p| 2.0 + (p - 1.0) * 2.0);
        assert_eq!(turned.velocity(0), [0.5, 0.0]);
    }
}
