//! Times in the forms of other programs.

/// Seconds as whole seconds and nanoseconds, rounded to the nearest nanosecond; from 0 on.
pub(super) fn nanoseconds(seconds: f64) -> u64 {
    (seconds.max(0.0) * 1e9).round() as u64
}

/// Whole seconds, and the nanoseconds beyond them.
pub(super) fn split(nanoseconds: u64) -> (u64, u64) {
    (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000)
}
