//! How far apart two configurations are, in seconds at full speed.

/// The length of a straight motion: the time that it takes at the velocity limits, without acceleration. It is the largest
/// |bᵢ − aᵢ| / velocityᵢ; coordinates without a velocity limit do not count.
///
/// # Panics
/// If `b` or `velocity` is shorter than `a`.
#[must_use]
pub fn time_at_full_speed(a: &[f64], b: &[f64], velocity: &[f64]) -> f64 {
    let of = |i: usize| {
        let by = (b[i] - a[i]).abs();
        // A limit of 0 is kept by standing still.
        if by == 0.0 || velocity[i] == f64::INFINITY { 0.0 } else { by / velocity[i] }
    };
    (0..a.len()).map(of).fold(0.0, f64::max)
}
