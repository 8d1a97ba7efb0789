//! Parts of a polyline.

/// Lanes of a block.
pub(crate) const LANES: usize = 16;
/// Numbers of a pose: columns of the rotation, then the translation.
pub(crate) const POSE: usize = 12;

/// Intervals are not halved more often than this.
const DEEPEST: u32 = 48;

/// Part of a polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    /// From knot `first` to knot `last`; where that is one piece, the part of it below.
    first: u32,
    last: u32,
    /// [k, k + 1] · 2^−depth.
    k: u64,
    depth: u32,
}

/// Where an interval is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sample {
    /// At a knot, as the middle of a span.
    Knot { first: u32, middle: u32, last: u32 },
    /// At a parameter of a piece, as the middle of an interval of twice that half width.
    Inside { piece: u32, t: f64, half_width: f64 },
}

impl Interval {
    /// One knot, and nothing to either side of it.
    pub(crate) fn knot(knot: u32) -> Self {
        Self { first: knot, last: knot, k: 0, depth: 0 }
    }

    pub(crate) fn whole(pieces: u32) -> Self {
        Self { first: 0, last: pieces, k: 0, depth: 0 }
    }

    fn is_span(self) -> bool {
        self.last - self.first != 1
    }

    /// Where it begins, in pieces.
    pub(crate) fn left(self) -> f64 {
        f64::from(self.first) + self.k as f64 * 0.5_f64.powi(self.depth as i32)
    }

    /// Whether another interval begins where this one ends.
    pub(crate) fn is_followed_by(self, next: Self) -> bool {
        let end =
            if self.is_span() || self.k + 1 == 1 << self.depth { (self.last, 0) } else { (self.first, self.k + 1) };
        // Both as multiples of the shortest part that there is.
        end.0 == next.first && end.1 << (DEEPEST - self.depth) == next.k << (DEEPEST - next.depth)
    }

    /// Where the sample is, in pieces.
    pub(crate) fn middle(self) -> f64 {
        match self.sample() {
            Sample::Knot { middle, .. } => f64::from(middle),
            Sample::Inside { piece, t, .. } => f64::from(piece) + t,
        }
    }

    pub(crate) fn sample(self) -> Sample {
        if self.is_span() {
            let middle = self.first.midpoint(self.last);
            return Sample::Knot { first: self.first, middle, last: self.last };
        }
        let width = 0.5_f64.powi(self.depth as i32);
        Sample::Inside { piece: self.first, t: (self.k as f64 + 0.5) * width, half_width: 0.5 * width }
    }

    /// Its halves; none where it is as short as intervals get.
    pub(crate) fn halves(self) -> Option<[Self; 2]> {
        if self.is_span() {
            let middle = self.first.midpoint(self.last);
            return Some([Self { last: middle, ..self }, Self { first: middle, ..self }]);
        }
        let half = |side| Self { k: 2 * self.k + side, depth: self.depth + 1, ..self };
        (self.depth < DEEPEST).then(|| [half(0), half(1)])
    }
}
