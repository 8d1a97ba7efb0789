//! Arrays of numbers, one after the other.

use crate::view::document::Offset;

/// Arrays, little-endian, each at a multiple of four bytes.
#[derive(Clone, Debug, Default)]
pub struct Blob {
    bytes: Vec<u8>,
}

impl Blob {
    /// All bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Adds 32-bit floating-point numbers.
    pub fn floats(&mut self, numbers: impl IntoIterator<Item = f32>) -> Offset {
        self.array(numbers.into_iter().map(f32::to_le_bytes))
    }

    /// Adds 16-bit numbers.
    pub fn shorts(&mut self, numbers: impl IntoIterator<Item = u16>) -> Offset {
        self.array(numbers.into_iter().map(u16::to_le_bytes))
    }

    /// Adds 32-bit numbers.
    pub fn words(&mut self, numbers: impl IntoIterator<Item = u32>) -> Offset {
        self.array(numbers.into_iter().map(u32::to_le_bytes))
    }

    fn array<const N: usize>(&mut self, numbers: impl Iterator<Item = [u8; N]>) -> Offset {
        let start = self.bytes.len();
        numbers.for_each(|number| self.bytes.extend(number));
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        start
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_array_begins_where_a_float_may() {
        let mut blob = Blob::default();
        assert_eq!(blob.shorts([1, 2, 3]), 0);
        assert_eq!(blob.floats([1.0]), 8);
        assert_eq!(blob.words([7]), 12);
        assert_eq!(blob.bytes(), [1, 0, 2, 0, 3, 0, 0, 0, 0, 0, 0x80, 0x3f, 7, 0, 0, 0]);
    }
}
