//! Counter-based random streams: one per (seed, step, candidate), whatever thread asks.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// What a stream is for; streams of different purposes never overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Purpose(u64);

impl Purpose {
    /// Drawing q_rand.
    pub const SAMPLE: Self = Self(1);
    /// Choosing node and transition.
    pub const SELECT: Self = Self(2);
    /// Drawing the leaf to aim at.
    pub const RENDEZVOUS: Self = Self(3);
    /// Which idle coordinates keep still.
    pub const STILL: Self = Self(4);
    /// Configurations for goals that name only object poses.
    pub const GOAL: Self = Self(5);
    /// Choosing leaves to extend and to aim at.
    pub const HEURISTIC: Self = Self(6);
    /// Configurations towards which the trees of a blocked motion grow.
    pub const JOIN: Self = Self(7);
    /// How far from the near node the search for the waypoints of a lazy extension starts.
    pub const LAZY_EXTENSION: Self = Self(8);

    /// Drawing placements of objects that are worth aiming at.
    pub const PLACEMENT: Self = Self(10);
    /// Choosing among such placements.
    pub const AIM: Self = Self(11);

    /// Planning stretches of a first path again.
    pub const REGRASP: Self = Self(12);

    /// Drawing changes of a path that is to become better.
    pub const IMPROVE: Self = Self(9);

    /// Finding out why no hand reaches an object.
    pub const REACH: Self = Self(13);

    /// A purpose of a host's own scheduler.
    #[must_use]
    pub const fn of_host(number: u32) -> Self {
        Self(1 << 32 | number as u64)
    }
}

/// The stream of a candidate in a step. ChaCha's streams are provably independent; setting one up costs about 0.2 µs.
#[must_use]
pub fn stream(seed: u64, purpose: Purpose, step: u64, candidate: u32) -> ChaCha8Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&purpose.0.to_le_bytes());
    key[16..24].copy_from_slice(&step.to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(u64::from(candidate));
    rng
}

/// Draws in proportion to the weights by `u` ∈ [0, 1); nothing where none is positive.
#[must_use]
pub fn draw<T: Copy>(choices: &[(T, f64)], u: f64) -> Option<T> {
    let mut left = u * choices.iter().map(|&(_, weight)| weight).sum::<f64>();
    let drawn = choices.iter().find(|&&(_, weight)| {
        left -= weight;
        left < 0.0
    });
    // Rounding may leave a rest behind the last one.
    drawn.or_else(|| choices.iter().rfind(|&&(_, weight)| weight > 0.0)).map(|&(choice, _)| choice)
}

#[cfg(test)]
mod tests {
    use super::draw;

    #[test]
    fn what_has_no_weight_is_never_drawn() {
        let choices = [('a', 0.0), ('b', 1.0), ('c', 0.0), ('d', 3.0), ('e', 0.0)];
        let drawn = [0.0, 0.24, 0.26, 0.99, 1.0].map(|u| draw(&choices, u));
        assert_eq!(drawn, ['b', 'b', 'd', 'd', 'd'].map(Some));
        assert_eq!(draw(&[('a', 0.0)], 0.5), None);
        assert_eq!(draw::<char>(&[], 0.5), None);
    }
}
