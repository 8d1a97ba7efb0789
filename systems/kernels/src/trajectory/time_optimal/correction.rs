//! What the curve does between the grid points, and how limits are tightened where it exceeds them.

use crate::trajectory::time_optimal::counted::Counted;
use crate::trajectory::time_optimal::grid::Grid;
use crate::trajectory::time_optimal::passes::Profile;

/// The largest shares of velocity and acceleration limits on a curved interval, and by which factor it should take longer so that its
/// velocity has no peak above the limit.
pub(super) fn shares(counted: &Counted, grid: &Grid, profile: &Profile, interval: usize) -> [f64; 3] {
    let (n, at) = (counted.len(), interval * counted.len());
    let (c, d) = (profile.squares[interval].sqrt(), profile.squares[interval + 1].sqrt());
    let rate = 0.5 * (c + d) / (grid.widths[interval] * profile.slower[interval]);
    let (t0, t1) = grid.tangents[at..at + 2 * n].split_at(n);
    let (q0, q1) = grid.positions[at..at + 2 * n].split_at(n);
    let [mut velocity, mut acceleration, mut slower] = [0.0_f64; 3];
    for j in 0..n {
        let by_velocity = counted.by_velocity[j];
        let (v0, v1) = (t0[j] * c * by_velocity, t1[j] * d * by_velocity);
        let mean = (q1[j] - q0[j]) * rate * by_velocity;
        let (d0, d1) = (mean - v0, mean - v1);
        // Changes of the velocity over the interval if the accelerations at its ends lasted.
        let (a0, a1) = (4.0 * d0 + 2.0 * d1, -(2.0 * d0 + 4.0 * d1));
        velocity = velocity.max(v0.abs()).max(v1.abs());
        if a0 * a1 < 0.0 && v0.abs() + 0.5 * a0.abs() > 1.0 {
            let u = a0 / (a0 - a1);
            let peak = (v0 + 0.5 * a0 * u).abs();
            // How much the peak falls when the interval takes longer.
            let weight = 6.0 * u * (1.0 - u) * mean.abs();
            if weight > 0.6 {
                slower = slower.max((peak - 1.0) / weight);
            } else {
                velocity = velocity.max(peak);
            }
        }
    }
    for j in 0..n {
        let (v0, v1) = (t0[j] * c, t1[j] * d);
        let mean = (q1[j] - q0[j]) * rate;
        let (d0, d1) = (mean - v0, mean - v1);
        let top = (4.0 * d0 + 2.0 * d1).abs().max((2.0 * d0 + 4.0 * d1).abs());
        acceleration = acceleration.max(top * rate * counted.by_acceleration[j]);
    }
    [velocity, acceleration, slower]
}

/// Looks at all curved intervals. Returns by how much limits are exceeded: the factor by which the whole curve would have to be slowed
/// down.
pub(super) fn measure(counted: &Counted, grid: &Grid, profile: &Profile, found: &mut Vec<[f64; 3]>) -> f64 {
    let mut stretch = 1.0_f64;
    found.clear();
    for k in 0..grid.intervals() {
        let shares = if grid.straight[k].is_some() { [0.0; 3] } else { shares(counted, grid, profile, k) };
        let [velocity, acceleration, slower] = shares;
        stretch = stretch.max(velocity).max(acceleration.sqrt()).max(1.0 + slower);
        found.push(shares);
    }
    stretch
}

/// Tightens limits where [`measure`] has found that the curve exceeds them.
pub(super) fn tighten(found: &[[f64; 3]], profile: &mut Profile) {
    for (k, &[velocity, acceleration, slower]) in found.iter().enumerate() {
        if acceleration > 1.0 {
            profile.acceleration_share[k] /= acceleration;
        }
        if velocity > 1.0 {
            for node in [k, k + 1] {
                profile.velocity_share[node] /= velocity * velocity;
            }
        }
        profile.slower[k] *= 1.0 + slower;
    }
}
