//! The fastest motion along a straight interval: up to three phases of constant path acceleration.

/// A straight interval and the squared path velocities at its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Straight {
    /// Squared path velocities at the start and at the end.
    pub ends: [f64; 2],
    /// Its length.
    pub width: f64,
    /// The largest squared path velocity.
    pub top: f64,
    /// The largest path acceleration.
    pub most: f64,
}

impl Straight {
    /// The squared path velocity at which speeding up and slowing down meet.
    pub fn free(&self) -> f64 {
        0.5 * (self.ends[0] + self.ends[1]) + self.most * self.width
    }

    /// How long the first and the last phase are, and the squared path velocity between them. A phase that would take less than
    /// `shortest` seconds is drawn out to that or left out, which costs a time of second order.
    pub fn phases(&self, shortest: f64) -> [f64; 3] {
        let [x, y] = self.ends;
        let high = x.max(y);
        let exact = |square: f64, end: f64| 0.5 * (square - end).max(0.0) / self.most;
        let seconds = |square: f64, end: f64| (square.sqrt() - end.sqrt()).max(0.0) / self.most;
        let is_long = |square: f64| high == 0.0 || seconds(square, x).min(seconds(square, y)) >= shortest;
        let drawn_out = |square: f64, end: f64| {
            let mean = 0.5 * (square.sqrt() + end.sqrt());
            if square > end { mean * seconds(square, end).max(shortest) } else { 0.0 }
        };
        let free = self.free();
        if free <= self.top {
            if free > high && is_long(free) {
                return [exact(free, x), exact(free, y), free];
            }
        } else {
            let highest = self.top.max(high);
            let ramps = [drawn_out(highest, x), drawn_out(highest, y)];
            if self.width - ramps[0] - ramps[1] >= shortest * highest.sqrt() {
                return [ramps[0], ramps[1], highest];
            }
            // Slower, so that the phase between the ramps takes the shortest time.
            let half = 0.5 * self.most * shortest;
            let lower = ((half * half + free).sqrt() - half).powi(2);
            if lower > high && lower <= highest && is_long(lower) {
                return [exact(lower, x), exact(lower, y), lower];
            }
        }
        let ramps = [drawn_out(high, x), drawn_out(high, y)];
        if self.width - ramps[0] - ramps[1] >= shortest * high.sqrt() {
            return [ramps[0], ramps[1], high];
        }
        // One phase from end to end.
        if x < y { [self.width, 0.0, y] } else { [0.0, self.width, x] }
    }
}
