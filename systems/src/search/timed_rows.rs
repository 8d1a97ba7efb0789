//! A segment's knots, velocities and times as kernels read them: numbers end to end.

use foliate_components::path::Segment;
use foliate_kernels::curve::HermiteCurve;

/// The rows of a segment with times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimedRows {
    knots: Vec<f64>,
    velocities: Vec<f64>,
    times: Vec<f64>,
}

impl TimedRows {
    /// `None` of a segment without times.
    #[must_use]
    pub fn of(segment: &Segment) -> Option<Self> {
        let timing = segment.timing.as_ref()?;
        let (knots, velocities) = (segment.knots.concat(), timing.velocities.concat());
        Some(Self { knots, velocities, times: timing.times.clone() })
    }

    /// The curve through them.
    #[must_use]
    pub fn curve(&self) -> HermiteCurve<'_> {
        HermiteCurve { knots: &self.knots, velocities: &self.velocities, times: &self.times }
    }
}
