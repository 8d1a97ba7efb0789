//! The two passes of TOPP-RA over the grid.
//!
//! Source: H. Pham and Q.-C. Pham, *A new approach to time-optimal path parameterization based on reachability analysis*, IEEE
//! Transactions on Robotics 34 (3), 2018. Controllable sets are here intervals that begin at 0, because standing still is always
//! allowed. Constraints hold at both ends of each interval.

use crate::trajectory::time_optimal::grid::Grid;
use crate::trajectory::time_optimal::reach::{largest_end, largest_start};

/// Squared path velocities, and how much the limits are tightened.
#[derive(Clone, Debug, Default)]
pub(super) struct Profile {
    /// By grid point: the largest squared path velocity from which the end can be reached.
    controllable: Vec<f64>,
    /// By grid point: the squared path velocity.
    pub squares: Vec<f64>,
    /// By grid point: factor of the velocity limits, squared.
    pub velocity_share: Vec<f64>,
    /// By interval: factor of the acceleration limits.
    pub acceleration_share: Vec<f64>,
    /// By interval: how much longer it takes than at constant path acceleration.
    pub slower: Vec<f64>,
}

impl Profile {
    /// Limits count whole.
    pub fn begin(&mut self, grid: &Grid) {
        self.velocity_share.clear();
        self.velocity_share.resize(grid.intervals() + 1, 1.0);
        self.slower.clear();
        self.slower.resize(grid.intervals(), 1.0);
        self.acceleration_share.clear();
        self.acceleration_share.resize(grid.intervals(), 1.0);
    }

    /// Finds the fastest profile from rest to rest.
    pub fn solve(&mut self, grid: &Grid) {
        let count = grid.intervals();
        let top = |k: usize| grid.top[k] * self.velocity_share[k];
        self.controllable.clear();
        self.controllable.resize(count + 1, 0.0);
        for k in (0..count).rev() {
            let (share, next) = (self.acceleration_share[k], self.controllable[k + 1]);
            self.controllable[k] = match grid.straight[k] {
                Some(most) => top(k).min(next + 2.0 * share * most * grid.widths[k]),
                None => {
                    let (p, r) = grid.strips_of(k);
                    largest_start(p, r, share, [top(k), next])
                }
            };
        }
        self.squares.clear();
        self.squares.push(0.0);
        for k in 0..count {
            let (share, next, x) = (self.acceleration_share[k], self.controllable[k + 1], self.squares[k]);
            self.squares.push(match grid.straight[k] {
                Some(most) => next.min(x + 2.0 * share * most * grid.widths[k]),
                None => {
                    let (p, r) = grid.strips_of(k);
                    largest_end(p, r, share, x, next)
                }
            });
        }
    }
}
