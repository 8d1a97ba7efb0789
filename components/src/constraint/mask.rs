//! Which of the six components of a relative pose a constraint uses.

use std::ops::{BitOr, Not};

/// Flags for tx ty tz rx ry rz: translation, then rotation vector (the order of SRDF masks).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Mask(pub [bool; 6]);

/// Why a mask makes no grasp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MaskError {
    /// One rotation row alone says nothing geometric: which rotations satisfy it depends on the other two.
    #[error("a mask may constrain three, two or no rotations, not exactly one")]
    OneRotation,
}

impl Mask {
    /// All six components.
    pub const ALL: Self = Self([true; 6]);
    /// No component.
    pub const NONE: Self = Self([false; 6]);

    /// How many components are set.
    #[must_use]
    pub fn count(self) -> usize {
        self.0.iter().filter(|&&b| b).count()
    }

    /// How many rotation components are set.
    #[must_use]
    pub fn rotations(self) -> usize {
        self.0[3..].iter().filter(|&&b| b).count()
    }

    /// The mask itself where a grasp may have it (HPP's rule: three, two or no rotations).
    ///
    /// # Errors
    /// Exactly one rotation.
    pub fn of_grasp(self) -> Result<Self, MaskError> {
        if self.rotations() == 1 { Err(MaskError::OneRotation) } else { Ok(self) }
    }
}

impl Not for Mask {
    type Output = Self;
    fn not(self) -> Self {
        Self(self.0.map(|b| !b))
    }
}

impl BitOr for Mask {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] || other.0[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grasp_may_leave_one_or_three_rotations_free_but_not_two() {
        let axial = Mask([true, true, true, true, true, false]);
        assert_eq!(axial.of_grasp(), Ok(axial));
        assert_eq!((axial.count(), axial.rotations()), (5, 2));
        assert_eq!(Mask([true, true, true, false, false, false]).of_grasp().map(Mask::rotations), Ok(0));
        assert_eq!(Mask([true, true, true, false, true, false]).of_grasp(), Err(MaskError::OneRotation));
        assert_eq!(axial | !axial, Mask::ALL);
    }
}
