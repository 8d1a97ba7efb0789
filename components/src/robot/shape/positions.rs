//! Which points are at one place: numbers by position, without trust in where the points come from.

use glam::DVec3;
use std::collections::HashMap;
use std::hash::{BuildHasher, Hasher, RandomState};

/// Numbers of positions, equal bit for bit but for the sign of zeros.
///
/// Answers never depend on the hashes. Their keys are drawn anew for each index, since the files that are read may be hostile:
/// no file can contain one whose positions all fall into one place of the table.
#[derive(Clone, Debug)]
pub struct Positions {
    known: HashMap<[u64; 3], u32, Keys>,
}

impl Positions {
    /// Of nothing yet, with room for about `count` positions.
    #[must_use]
    pub fn with_capacity(count: usize) -> Self {
        Self { known: HashMap::with_capacity_and_hasher(count, Keys::default()) }
    }

    /// The number under which the position is known; from now on that is `next` where it was not.
    #[inline]
    pub fn number(&mut self, position: DVec3, next: u32) -> u32 {
        *self.known.entry(bits(position)).or_insert(next)
    }

    /// The number under which the position is known.
    #[inline]
    #[must_use]
    pub fn get(&self, position: DVec3) -> Option<u32> {
        self.known.get(&bits(position)).copied()
    }
}

#[inline]
fn bits(position: DVec3) -> [u64; 3] {
    // Adding zero makes −0 and 0 the same.
    position.to_array().map(|c| (c + 0.0).to_bits())
}

/// For every point the first one that is at its position.
#[must_use]
pub fn first_at_position(points: &[DVec3]) -> Vec<u32> {
    let mut positions = Positions::with_capacity(points.len());
    points.iter().enumerate().map(|(i, &p)| positions.number(p, i as u32)).collect()
}

/// Makes hashers with keys of their own.
#[derive(Clone, Debug)]
struct Keys([u64; 2]);

impl Default for Keys {
    fn default() -> Self {
        let random = RandomState::new();
        Self([random.hash_one(0_u8), random.hash_one(1_u8)])
    }
}

impl BuildHasher for Keys {
    type Hasher = Folded;

    fn build_hasher(&self) -> Folded {
        Folded { state: self.0[0], key: self.0[1] }
    }
}

/// Multiplies words to twice their length and folds the halves: a third of the time of the standard hasher on 24 bytes.
struct Folded {
    state: u64,
    key: u64,
}

impl Hasher for Folded {
    #[inline]
    fn write(&mut self, bytes: &[u8]) {
        for word in bytes.chunks(8) {
            let mut padded = [0; 8];
            padded[..word.len()].copy_from_slice(word);
            self.write_u64(u64::from_le_bytes(padded));
        }
    }

    #[inline]
    fn write_u64(&mut self, word: u64) {
        let product = u128::from(self.state ^ word) * u128::from(self.key | 1);
        self.state = (product as u64) ^ ((product >> 64) as u64) ^ self.key;
    }

    fn write_usize(&mut self, _: usize) {
        // How many words follow is always the same.
    }

    fn finish(&self) -> u64 {
        // The table uses the lowest and the highest bits.
        let product = u128::from(self.state) * 0x9e37_79b9_7f4a_7c15;
        (product as u64) ^ ((product >> 64) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_has_the_number_of_the_first_at_its_position() {
        let points = [DVec3::X, DVec3::Y, DVec3::new(1.0, -0.0, 0.0), DVec3::ZERO, -DVec3::ZERO, DVec3::Y];
        assert_eq!(first_at_position(&points), [0, 1, 0, 3, 3, 1]);
    }

    #[test]
    fn positions_that_differ_in_one_bit_are_two() {
        let near = f64::from_bits(1.0_f64.to_bits() + 1);
        assert_eq!(first_at_position(&[DVec3::splat(1.0), DVec3::new(1.0, 1.0, near)]), [0, 1]);
        // Coordinates in other places are other positions.
        let permuted = [[1.0, 2.0, 3.0], [2.0, 1.0, 3.0], [3.0, 2.0, 1.0]].map(DVec3::from_array);
        assert_eq!(first_at_position(&permuted), [0, 1, 2]);
    }

    #[test]
    fn many_regular_positions_do_not_share_hashes() {
        let keys = Keys::default();
        let grid = (0..40_u32).flat_map(|x| (0..40_u32).flat_map(move |y| (0..40_u32).map(move |z| [x, y, z])));
        let mut low: Vec<u64> =
            grid.map(|p| keys.hash_one(p.map(|c| (f64::from(c) * 0.5).to_bits())) % 65536).collect();
        low.sort_unstable();
        low.dedup();
        // 64000 balls into 65536 urns leave 62 % of these filled with something.
        assert!(low.len() > 38_000, "{} places of 65536", low.len());
    }
}
