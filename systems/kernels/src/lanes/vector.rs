//! Vectors of lanes, their masks, and the rows of memory from which they are loaded.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Deref, DerefMut, Div, Index, IndexMut, Mul, Neg, Not, Sub, SubAssign};

/// Proof that a set of instructions is there, and the vectors that use it.
pub trait Isa: Copy + Debug + Send + Sync + 'static {
    /// Eight numbers to finish with and to store.
    type F64: Lanes<Isa = Self, Scalar = f64, Row = F64Row>;
    /// Sixteen numbers for bounds, neighbours and first iterations.
    type F32: Lanes<Isa = Self, Scalar = f32, Row = F32Row>;
    /// Whether lanes are worked on side by side. Where they are not, a kernel that has a better scalar counterpart need not
    /// be compiled.
    const SIDE_BY_SIDE: bool;
}

impl<S: Simd> Isa for S {
    type F64 = f64x8<S>;
    type F32 = f32x16<S>;
    const SIDE_BY_SIDE: bool = true;
}

/// What one lane holds.
pub trait Scalar: Copy + Debug + Default + PartialOrd + Send + Sync + 'static {
    /// Difference between one and the next larger number; what tolerances scale with.
    const EPSILON: Self;
    /// Largest finite number.
    const MAX: Self;
    /// Rounded from the number with twice the digits.
    fn of(x: f64) -> Self;
    /// The same number with as many digits as there are.
    fn to_f64(self) -> f64;
}

impl Scalar for f64 {
    const EPSILON: Self = Self::EPSILON;
    const MAX: Self = Self::MAX;
    #[inline(always)]
    fn of(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
}

impl Scalar for f32 {
    const EPSILON: Self = Self::EPSILON;
    const MAX: Self = Self::MAX;
    #[inline(always)]
    fn of(x: f64) -> Self {
        x as Self
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

/// One quantity of every lane: 64 bytes on a 64-byte border.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Row<T, const N: usize>(pub [T; N]);

/// One quantity of eight lanes.
pub type F64Row = Row<f64, 8>;
/// One quantity of sixteen lanes.
pub type F32Row = Row<f32, 16>;

impl<T: Copy, const N: usize> Row<T, N> {
    /// How many numbers.
    pub const LANES: usize = N;

    /// The same number in every lane.
    #[must_use]
    pub fn splat(x: T) -> Self {
        Self([x; N])
    }
}

impl<T: Copy + Default, const N: usize> Default for Row<T, N> {
    fn default() -> Self {
        Self([T::default(); N])
    }
}

impl<T, const N: usize> Index<usize> for Row<T, N> {
    type Output = T;
    #[inline(always)]
    fn index(&self, lane: usize) -> &T {
        &self.0[lane]
    }
}

impl<T, const N: usize> IndexMut<usize> for Row<T, N> {
    #[inline(always)]
    fn index_mut(&mut self, lane: usize) -> &mut T {
        &mut self.0[lane]
    }
}

impl<T, const N: usize> Deref for Row<T, N> {
    type Target = [T; N];
    #[inline(always)]
    fn deref(&self) -> &[T; N] {
        &self.0
    }
}

impl<T, const N: usize> DerefMut for Row<T, N> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T; N] {
        &mut self.0
    }
}

/// What each lane answers to a comparison.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> + Send + Sync + 'static
{
    /// The sets of instructions.
    type Isa: Isa;
    /// The lanes whose bit is set, lane 0 the lowest.
    fn from_bits(isa: Self::Isa, bits: u32) -> Self;
    /// The lanes as bits, lane 0 the lowest.
    fn bits(self) -> u32;
    /// Whether any lane is set.
    fn any(self) -> bool;
    /// Whether every lane is set.
    fn all(self) -> bool;
}

/// Several numbers, on which arithmetic works side by side.
///
/// Where a number is not one, `min` and `max` answer either operand, and comparisons are false.
pub trait Lanes:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + Add<Self::Scalar, Output = Self>
    + Sub<Self::Scalar, Output = Self>
    + Mul<Self::Scalar, Output = Self>
    + Send
    + Sync
    + 'static
{
    /// The set of instructions.
    type Isa: Isa;
    /// What one lane holds.
    type Scalar: Scalar;
    /// What comparisons answer.
    type Mask: Mask<Isa = Self::Isa>;
    /// One quantity in memory.
    type Row: Copy
        + Debug
        + Default
        + PartialEq
        + Send
        + Sync
        + Index<usize, Output = Self::Scalar>
        + IndexMut<usize, Output = Self::Scalar>;
    /// Number of lanes.
    const COUNT: usize;

    /// The set of instructions.
    fn isa(self) -> Self::Isa;
    /// The same number in every lane.
    fn splat(isa: Self::Isa, x: Self::Scalar) -> Self;
    /// The same number in every lane, rounded where lanes have fewer digits.
    #[inline(always)]
    fn constant(isa: Self::Isa, x: f64) -> Self {
        Self::splat(isa, Self::Scalar::of(x))
    }
    /// From memory.
    fn load(isa: Self::Isa, row: &Self::Row) -> Self;
    /// To memory.
    fn store(self, row: &mut Self::Row);
    /// self · b + c, fused where the level has that.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// self · b − c, fused where the level has that.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// c − self · b, fused where the level has that.
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        (-self).mul_add(b, c)
    }
    /// The smaller.
    fn min(self, other: Self) -> Self;
    /// The larger.
    fn max(self, other: Self) -> Self;
    /// Without its sign.
    fn abs(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// With the sign of another number.
    fn copysign(self, sign: Self) -> Self;
    /// Whether self < other.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether self ≤ other.
    fn le(self, other: Self) -> Self::Mask;
    /// Where the mask is set `yes`, elsewhere `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The smallest of the lanes.
    fn least(self) -> Self::Scalar;
    /// The largest of the lanes.
    fn most(self) -> Self::Scalar;
}

macro_rules! lanes {
    ($vector:ident, $scalar:ty, $count:literal) => {
        impl<S: Simd> Lanes for $vector<S> {
            type Isa = S;
            type Scalar = $scalar;
            type Mask = <Self as SimdBase<S>>::Mask;
            type Row = Row<$scalar, $count>;
            const COUNT: usize = $count;

            #[inline(always)]
            fn isa(self) -> S {
                self.simd
            }
            #[inline(always)]
            fn splat(isa: S, x: $scalar) -> Self {
                <Self as SimdBase<S>>::splat(isa, x)
            }
            #[inline(always)]
            fn load(isa: S, row: &Self::Row) -> Self {
                <Self as SimdBase<S>>::load_array_ref(isa, &row.0)
            }
            #[inline(always)]
            fn store(self, row: &mut Self::Row) {
                <Self as SimdBase<S>>::store_array(self, &mut row.0);
            }
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                SimdFloat::mul_add(self, b, c)
            }
            #[inline(always)]
            fn mul_sub(self, b: Self, c: Self) -> Self {
                SimdFloat::mul_sub(self, b, c)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                <Self as SimdBase<S>>::min(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                <Self as SimdBase<S>>::max(self, other)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <Self as SimdBase<S>>::abs(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                SimdFloat::copysign(self, sign)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                <Self as SimdBase<S>>::simd_lt(self, other)
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                <Self as SimdBase<S>>::simd_le(self, other)
            }
            #[inline(always)]
            fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                Select::select(mask, yes, no)
            }
            #[inline(always)]
            fn least(self) -> $scalar {
                <Self as SimdBase<S>>::reduce_min(self)
            }
            #[inline(always)]
            fn most(self) -> $scalar {
                <Self as SimdBase<S>>::reduce_max(self)
            }
        }
    };
}

lanes!(f64x8, f64, 8);
lanes!(f32x16, f32, 16);

macro_rules! mask {
    ($mask:ident) => {
        impl<S: Simd> Mask for fearless_simd::$mask<S> {
            type Isa = S;
            #[inline(always)]
            fn from_bits(isa: S, bits: u32) -> Self {
                <Self as SimdMask<S>>::from_bitmask(isa, u64::from(bits))
            }
            #[inline(always)]
            fn bits(self) -> u32 {
                <Self as SimdMask<S>>::to_bitmask(self) as u32
            }
            #[inline(always)]
            fn any(self) -> bool {
                <Self as SimdMask<S>>::any_true(self)
            }
            #[inline(always)]
            fn all(self) -> bool {
                <Self as SimdMask<S>>::all_true(self)
            }
        }
    };
}

mask!(mask64x8);
mask!(mask32x16);
