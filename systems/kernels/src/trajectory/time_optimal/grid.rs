//! The numbers of a path at the grid points, and what they say about squared path velocities.
//!
//! With the path velocity ṡ and x = ṡ², the acceleration of a coordinate is q′ u + q″ x, where u = s̈. Over an interval of width Δ the path
//! acceleration u is constant, so that x goes linearly from x₀ to x₁ and u = (x₁ − x₀) / (2 Δ).
//!
//! What counts is not this acceleration but that of the cubic Hermite curve over time through the grid points, with the derivatives q′ ṡ
//! there. With c = √x₀, d = √x₁ and the mean derivative m = (q₁ − q₀) / Δ the interval takes h = 2 Δ / (c + d), and the accelerations at its
//! ends are
//!
//! a₀ = (c + d) ((3 m − 4 q₀′) c + (3 m − 2 q₁′) d) / (2 Δ), a₁ = (c + d) ((2 q₀′ − 3 m) c + (4 q₁′ − 3 m) d) / (2 Δ).
//!
//! They are homogeneous of degree 1 in x₀ and x₁, so that their linearisation at a profile has no constant term and is exact there:
//! strips |p x₀ + r x₁| ≤ limit. At c = d they are q′ u + q″ x up to O(Δ²).

use crate::trajectory::spline::Spline;
use crate::trajectory::time_optimal::counted::Counted;
use crate::trajectory::time_optimal::layout::Interval;

/// Numbers by grid point (`of_node`) and by interval. Rows have one number per counted coordinate.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    /// The numbers of a row.
    counted: usize,
    /// Positions and derivatives by the parameter at the grid points.
    pub positions: Vec<f64>,
    pub tangents: Vec<f64>,
    /// Largest squared path velocity at a grid point by the velocity limits.
    pub top: Vec<f64>,
    /// By interval the strips of both ends, divided by the acceleration limit: coefficients of the squared path velocity at the
    /// start and at the end of the interval.
    pub p: Vec<f64>,
    pub r: Vec<f64>,
    /// By interval: the largest path acceleration where it is straight.
    pub straight: Vec<Option<f64>>,
    /// Widths of the intervals.
    pub widths: Vec<f64>,
}

impl Grid {
    /// Evaluates the path at the grid points. `cap` bounds squared path velocities that nothing else bounds.
    pub fn evaluate(&mut self, path: &Spline, counted: &Counted, intervals: &[Interval], cap: f64) {
        self.counted = counted.len();
        for numbers in
            [&mut self.positions, &mut self.tangents, &mut self.top, &mut self.p, &mut self.r, &mut self.widths]
        {
            numbers.clear();
        }
        self.straight.clear();
        let Some(first) = intervals.first() else { return };
        self.node(path, counted, first.piece, first.ends[0], cap);
        for (k, interval) in intervals.iter().enumerate() {
            let last = if interval.straight { path.locate(interval.ends[1]).0 } else { interval.piece };
            self.node(path, counted, last, interval.ends[1], cap);
            self.widths.push(interval.width());
            self.strips(counted, interval, k);
        }
    }

    /// Bounds the path velocity on an interval.
    pub fn lower(&mut self, interval: usize, ceiling: f64) {
        for top in &mut self.top[interval..interval + 2] {
            *top = top.min(ceiling * ceiling);
        }
    }

    fn node(&mut self, path: &Spline, counted: &Counted, piece: usize, parameter: f64, cap: f64) {
        let u = ((parameter - path.parameters()[piece]) / path.width(piece)).clamp(0.0, 1.0);
        let mut share = 0.0_f64;
        for (coordinate, by_velocity) in counted.coordinates.iter().zip(&counted.by_velocity) {
            let cubic = path.cubic(piece, *coordinate);
            let tangent = cubic.velocity(u);
            self.positions.push(cubic.position(u));
            self.tangents.push(tangent);
            share = share.max(tangent.abs() * by_velocity);
        }
        // The largest path velocity is 1 / share; where nothing moves there is none.
        self.top.push(cap.min(1.0 / (share * share)));
    }

    fn strips(&mut self, counted: &Counted, interval: &Interval, k: usize) {
        let n = self.counted;
        let tangents = |end: usize| (k + end) * n;
        if interval.straight {
            let share = |j: usize| {
                let tangent = self.tangents[tangents(0) + j].abs().max(self.tangents[tangents(1) + j].abs());
                tangent * counted.by_acceleration[j]
            };
            self.straight.push(Some(1.0 / (0..n).map(share).fold(0.0, f64::max)));
            self.p.resize(self.p.len() + 2 * n, 0.0);
            self.r.resize(self.r.len() + 2 * n, 0.0);
            return;
        }
        self.straight.push(None);
        self.p.resize(self.p.len() + 2 * n, 0.0);
        self.r.resize(self.r.len() + 2 * n, 0.0);
    }

    /// Writes the strips of the curved intervals, linearised at a profile; without one, where both ends are equally fast.
    pub fn linearise(&mut self, counted: &Counted, squares: &[f64], slower: &[f64]) {
        let n = self.counted;
        for k in 0..self.intervals() {
            if self.straight[k].is_some() {
                continue;
            }
            let ratio = if squares.is_empty() { 1.0 } else { (squares[k + 1] / squares[k]).sqrt() };
            // At a rest a coefficient is multiplied by 0.
            let ratios = if ratio > 1e-3 && ratio < 1e3 { [ratio, 1.0 / ratio] } else { [0.0; 2] };
            let by_width = 0.5 / (self.widths[k] * slower[k]);
            let by_mean = 2.0 * by_width;
            let at = k * n;
            let (t0, t1) = self.tangents[at..at + 2 * n].split_at(n);
            let (q0, q1) = self.positions[at..at + 2 * n].split_at(n);
            let (p0, p1) = self.p[2 * at..2 * at + 2 * n].split_at_mut(n);
            let (r0, r1) = self.r[2 * at..2 * at + 2 * n].split_at_mut(n);
            for j in 0..n {
                let mean = (q1[j] - q0[j]) * by_mean;
                let scale = by_width * counted.by_acceleration[j];
                let (d0, d1) = (mean - t0[j], mean - t1[j]);
                let (a, b) = (3.0 * d0 - t0[j], 2.0 * d1 + mean);
                let half = 0.5 * (a + b);
                (p0[j], r0[j]) = (scale * (a + half * ratios[0]), scale * (b + half * ratios[1]));
                let (a, b) = (-2.0 * d0 - mean, t1[j] - 3.0 * d1);
                let half = 0.5 * (a + b);
                (p1[j], r1[j]) = (scale * (a + half * ratios[0]), scale * (b + half * ratios[1]));
            }
        }
    }

    /// Coefficients of an interval's strips.
    pub fn strips_of(&self, interval: usize) -> (&[f64], &[f64]) {
        let range = 2 * self.counted * interval..2 * self.counted * (interval + 1);
        (&self.p[range.clone()], &self.r[range])
    }

    /// How many intervals there are.
    pub fn intervals(&self) -> usize {
        self.widths.len()
    }
}
