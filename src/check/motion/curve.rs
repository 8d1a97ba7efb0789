//! What a coordinate does between two knots: a cubic polynomial, of which everything is known in closed form.
//!
//! With velocities it is the cubic Hermite polynomial through both positions and both velocities, without it is linear. The
//! parameter s goes from 0 at one knot to 1 at the next. A quaternion is four such polynomials, scaled to length 1.

use crate::path_file::document::SegmentEntry;
use glam::{DQuat, DVec4};

/// start + first s + second s² + third s³, for s from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cubic {
    pub start: f64,
    pub end: f64,
    pub first: f64,
    pub second: f64,
    pub third: f64,
}

impl Cubic {
    /// From values and derivatives by s at both ends.
    pub(crate) fn hermite([start, end]: [f64; 2], [leaves, arrives]: [f64; 2]) -> Self {
        let by = end - start;
        Self {
            start,
            end,
            first: leaves,
            second: 3.0 * by - 2.0 * leaves - arrives,
            third: leaves + arrives - 2.0 * by,
        }
    }

    /// What a column does from a knot to the next.
    pub(crate) fn of(segment: &SegmentEntry, column: usize, knot: usize) -> Self {
        Self::between(&segment.knots, timed(segment), column, knot)
    }

    /// As [`Self::of`], with the segment taken apart.
    pub(crate) fn between(knots: &[Vec<f64>], timed: Option<Timed<'_>>, column: usize, knot: usize) -> Self {
        let next = (knot + 1).min(knots.len() - 1);
        let ends = [knots[knot][column], knots[next][column]];
        match timed {
            None => Self { start: ends[0], end: ends[1], first: ends[1] - ends[0], second: 0.0, third: 0.0 },
            Some(Timed { times, velocities }) => {
                let duration = times[next] - times[knot];
                Self::hermite(ends, [knot, next].map(|k| duration * velocities[k][column]))
            }
        }
    }

    pub(crate) fn at(&self, s: f64) -> f64 {
        if s == 1.0 {
            return self.end;
        }
        self.start + s * (self.first + s * (self.second + s * self.third))
    }

    /// Where the first derivative is zero.
    fn turns(&self) -> impl Iterator<Item = f64> + use<> {
        let (a, b, c) = (3.0 * self.third, self.second, self.first);
        let root = b * b - a * c;
        // Of both solutions the one without cancellation, and the other one from the product of both.
        let large = -(b + root.max(0.0).sqrt().copysign(b));
        [large / a, c / large].into_iter().filter(move |s| root >= 0.0 && *s > 0.0 && *s < 1.0)
    }

    /// The least and the greatest value.
    pub(crate) fn range(&self) -> (f64, f64) {
        let ends = (self.start.min(self.end), self.start.max(self.end));
        if self.second == 0.0 && self.third == 0.0 {
            return ends;
        }
        self.turns().map(|s| self.at(s)).fold(ends, |(low, high), value| (low.min(value), high.max(value)))
    }

    /// The largest value of the first derivative by s: at an end, or where the second one is zero.
    pub(crate) fn fastest(&self) -> f64 {
        let ends = self.first.abs().max((self.first + 2.0 * self.second + 3.0 * self.third).abs());
        let crest = -self.second / (3.0 * self.third);
        if crest > 0.0 && crest < 1.0 { ends.max((self.first + self.second * crest).abs()) } else { ends }
    }

    /// The second derivative by s at both ends; between them it is linear.
    pub(crate) fn bends(&self) -> [f64; 2] {
        [2.0 * self.second, 2.0 * self.second + 6.0 * self.third]
    }

    /// The largest value of the second derivative by s.
    pub(crate) fn most_bent(&self) -> f64 {
        let [start, end] = self.bends();
        start.abs().max(end.abs())
    }
}

/// What makes the knots of a segment a curve over time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Timed<'s> {
    pub times: &'s [f64],
    pub velocities: &'s [Vec<f64>],
}

/// Times and velocities of a segment that has both.
pub(crate) fn timed(segment: &SegmentEntry) -> Option<Timed<'_>> {
    let (times, velocities) = (segment.times.as_deref()?, segment.velocities.as_deref()?);
    Some(Timed { times, velocities })
}

/// Halvings of a curve of quaternions until its distance from zero is taken from its control points.
const HALVINGS: u32 = 6;
/// Extremes of an entry of a quaternion are told to within this.
const EXACT: f64 = 1e-11;
/// Most places at which an entry is evaluated for its extremes.
const MOST: usize = 20_000;

/// A quaternion x y z w whose numbers are cubic polynomials and are scaled to length 1.
pub(crate) struct Turning(pub [Cubic; 4]);

impl Turning {
    fn numbers(&self, s: f64) -> DVec4 {
        DVec4::from_array(self.0.map(|cubic| cubic.at(s)))
    }

    pub(crate) fn at(&self, s: f64) -> DQuat {
        DQuat::from_vec4(self.numbers(s)).normalize()
    }

    /// A lower bound of the length of the four numbers before they are scaled: the curve stays in the convex hull of its control
    /// points, also after it is cut in halves.
    pub(crate) fn shortest(&self) -> f64 {
        let of = |pick: fn(&Cubic) -> f64| DVec4::from_array(self.0.each_ref().map(pick));
        let points = [
            of(|c| c.start),
            of(|c| c.start + c.first / 3.0),
            of(|c| c.start + (2.0 * c.first + c.second) / 3.0),
            of(|c| c.end),
        ];
        shortest_of(points, HALVINGS)
    }

    /// Bounds of the angular velocity and the angular acceleration by s. The unit quaternion u = Q/|Q| has u' = PQ'/|Q| with P the
    /// projection across u, so ω = 2|PQ'|/|Q|; P u″ = PQ″/|Q| − 2 (u·Q')PQ'/|Q|², and |(u·Q')PQ'| ≤ ½|Q'|².
    pub(crate) fn spin(&self) -> (f64, f64) {
        let length = self.shortest().max(0.1);
        let norm = |numbers: [f64; 4]| DVec4::from_array(numbers).length();
        let control = [0, 1, 2].map(|i| {
            norm(self.0.each_ref().map(|c| match i {
                0 => c.first,
                1 => c.first + c.second,
                _ => c.first + 2.0 * c.second + 3.0 * c.third,
            }))
        });
        let fastest = control.into_iter().fold(0.0, f64::max).min(norm(self.0.each_ref().map(Cubic::fastest)));
        let bent = [0, 1].map(|end| norm(self.0.each_ref().map(|c| c.bends()[end]))).into_iter().fold(0.0, f64::max);
        let share = fastest / length;
        (2.0 * share, 2.0 * bent / length + 2.0 * share * share)
    }

    /// Bounds of the least and the greatest value of an entry of the unit quaternion.
    pub(crate) fn range(&self, entry: usize) -> (f64, f64) {
        let (spin, swing) = self.spin();
        let bent = 0.5 * swing + 0.25 * spin * spin;
        let greatest = |sign: f64| {
            let value = |s: f64| sign * self.at(s).to_array()[entry];
            let mut open = vec![(0.0, value(0.0), 1.0, value(1.0))];
            let (mut best, mut bound, mut places) = (open[0].1.max(open[0].3), f64::NEG_INFINITY, 0);
            while let Some((low, at_low, high, at_high)) = open.pop() {
                let share: f64 = high - low;
                let most = at_low.max(at_high) + bent * share * share / 8.0;
                places += 1;
                if most <= best + EXACT || places > MOST {
                    bound = bound.max(most);
                    continue;
                }
                let middle = 0.5 * (low + high);
                let at_middle = value(middle);
                best = best.max(at_middle);
                open.extend([(low, at_low, middle, at_middle), (middle, at_middle, high, at_high)]);
            }
            bound
        };
        (-greatest(-1.0), greatest(1.0))
    }
}

/// How near zero a Bézier curve comes at least.
fn shortest_of(points: [DVec4; 4], halvings: u32) -> f64 {
    let along = points.iter().sum::<DVec4>().normalize_or_zero();
    let bound = points.iter().map(|p| p.dot(along)).fold(f64::INFINITY, f64::min);
    let ends = points[0].length().min(points[3].length());
    if halvings == 0 || bound >= 0.99 * ends {
        return bound;
    }
    let [a, b, c, d] = points;
    let middle = |x: DVec4, y: DVec4| 0.5 * (x + y);
    let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
    let (abc, bcd) = (middle(ab, bc), middle(bc, cd));
    let half = middle(abc, bcd);
    shortest_of([a, ab, abc, half], halvings - 1).min(shortest_of([half, bcd, cd, d], halvings - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between -1 and 1 that look random (a linear congruential generator).
    fn numbers() -> impl Iterator<Item = f64> {
        let mut state = 7_u64;
        std::iter::from_fn(move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            Some((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
        })
    }

    fn drawn(numbers: &mut impl Iterator<Item = f64>) -> Cubic {
        let mut next = || numbers.next().unwrap_or_default();
        Cubic::hermite([next(), next()], [3.0 * next(), 3.0 * next()])
    }

    #[test]
    fn extremes_are_those_of_fine_samples() {
        let mut numbers = numbers();
        for _ in 0..500 {
            let cubic = drawn(&mut numbers);
            let places = (0..=2000).map(|i| f64::from(i) / 2000.0);
            let (low, high) =
                places.clone().map(|s| cubic.at(s)).fold((9.0_f64, -9.0_f64), |(l, h), x| (l.min(x), h.max(x)));
            let found = cubic.range();
            assert!(found.0 <= low + 1e-12 && found.1 >= high - 1e-12, "{cubic:?}");
            assert!((found.0 - low).abs() < 1e-5 && (found.1 - high).abs() < 1e-5, "{cubic:?}");
            let slope = |s: f64| cubic.first + 2.0 * cubic.second * s + 3.0 * cubic.third * s * s;
            let fastest = places.map(|s| slope(s).abs()).fold(0.0, f64::max);
            assert!(cubic.fastest() >= fastest - 1e-12 && cubic.fastest() < fastest + 1e-5, "{cubic:?}");
        }
    }

    #[test]
    fn a_hermite_polynomial_passes_its_knots_as_fast_as_it_should() {
        let cubic = Cubic::hermite([0.25, -0.5], [2.0, -1.0]);
        assert_eq!((cubic.at(0.0), cubic.at(1.0), cubic.first), (0.25, -0.5, 2.0));
        assert!((cubic.first + 2.0 * cubic.second + 3.0 * cubic.third + 1.0).abs() < 1e-15);
        assert_eq!(Cubic::hermite([0.3, 0.3], [0.0, 0.0]).range(), (0.3, 0.3));
    }

    #[test]
    fn quaternions_turn_no_faster_than_the_bound() {
        let mut numbers = numbers();
        let mut tightest = [0.0_f64; 2];
        for _ in 0..300 {
            let mut turning = Turning([0; 4].map(|_| drawn(&mut numbers)));
            // A short way from a unit quaternion to another.
            let start = DVec4::from_array(turning.0.map(|c| c.start)).normalize();
            let size = 0.3 * numbers.next().unwrap_or_default();
            turning.0.iter_mut().zip(start.to_array()).for_each(|(c, from)| {
                *c = Cubic::hermite([from, from + size * c.end], [size * c.first, size * c.first]);
            });
            let (spin, swing) = turning.spin();
            let step = 1e-3;
            let turn = |s: f64| turning.at(s);
            // The rotation vector from one place to the next, by s.
            let speed = |s: f64| 2.0 * (turn(s + step) * turn(s).conjugate()).xyz() / step;
            let mut shortest = f64::INFINITY;
            for place in 0..998 {
                let s = f64::from(place) * step;
                shortest = shortest.min(turning.numbers(s).length());
                let (fast, swung) = (speed(s).length(), (speed(s + step) - speed(s)).length() / step);
                assert!(fast <= spin + 1e-6 && swung <= swing + 1e-4, "{fast} {spin} {swung} {swing}");
                tightest = [tightest[0].max(fast / spin), tightest[1].max(swung / swing)];
            }
            assert!(turning.shortest() <= shortest && turning.shortest() > 0.97 * shortest - 0.01);
            let (low, high) = turning.range(1);
            let sampled = (0..=1000).map(|i| turn(f64::from(i) * step).y);
            let (least, most) = sampled.fold((2.0_f64, -2.0_f64), |(l, h), y| (l.min(y), h.max(y)));
            assert!(
                low <= least && high >= most && least - low < 1e-5 && high - most < 1e-5,
                "{low} {least} {high} {most}"
            );
        }
        assert!(tightest.iter().all(|share| *share > 0.8), "bounds should not be this loose: {tightest:?}");
    }
}
