//! A joint that keeps its value.

/// q − value; radians or metres. Angles are not wrapped: a locked coordinate is the number itself.
#[must_use]
pub fn value(coordinate: f64, locked_at: f64) -> f64 {
    coordinate - locked_at
}

/// d(value)/dq.
#[must_use]
pub fn jacobian() -> f64 {
    1.0
}
