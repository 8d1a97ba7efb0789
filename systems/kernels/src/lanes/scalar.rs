//! The level that every machine has: lanes one after another.
//!
//! Every operation is a small function of its own that is never inlined. A kernel of a thousand operations on arrays that
//! were inlined would be ten thousand instructions, on which compilers spend minutes; a call per operation costs no more
//! than the arithmetic in it.

use super::vector::{F32Row, F64Row, Isa, Lanes, Mask, Row};
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub, SubAssign};

/// Needs no instructions that a processor might lack.
#[derive(Clone, Copy, Debug)]
pub(super) struct Portable;

impl Isa for Portable {
    type F64 = Eight;
    type F32 = Sixteen;
    const SIDE_BY_SIDE: bool = false;
}

/// Which lanes are set, one bit each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bits<const N: usize>(u32);

impl<const N: usize> Bits<N> {
    const ALL: u32 = (1 << N) - 1;
}

impl<const N: usize> BitAnd for Bits<N> {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl<const N: usize> BitOr for Bits<N> {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl<const N: usize> Not for Bits<N> {
    type Output = Self;
    fn not(self) -> Self {
        Self(!self.0 & Self::ALL)
    }
}

impl<const N: usize> Mask for Bits<N> {
    type Isa = Portable;
    fn from_bits(_: Portable, bits: u32) -> Self {
        Self(bits & Self::ALL)
    }
    fn bits(self) -> u32 {
        self.0
    }
    fn any(self) -> bool {
        self.0 != 0
    }
    fn all(self) -> bool {
        self.0 == Self::ALL
    }
}

/// Defines out-of-line operations: `name(lanes…) = expression of one lane`.
macro_rules! lane_by_lane {
    ($vector:ident, $count:literal; $($name:ident($($x:ident),+) = $body:expr;)*) => {
        $(
            #[inline(never)]
            pub(super) fn $name($($x: $vector),+) -> $vector {
                let mut out = [0.0; $count];
                for (lane, out) in out.iter_mut().enumerate() {
                    $(let $x = $x.0.0[lane];)+
                    *out = $body;
                }
                $vector(Row(out))
            }
        )*
    };
}

macro_rules! vector {
    ($vector:ident, $scalar:ty, $count:literal, $row:ty, $ops:ident) => {
        /// The lanes of one quantity.
        #[derive(Clone, Copy, Debug)]
        pub(super) struct $vector($row);

        mod $ops {
            use super::{Bits, $vector};
            use crate::lanes::vector::Row;

            lane_by_lane! {
                $vector, $count;
                add(a, b) = a + b;
                sub(a, b) = a - b;
                mul(a, b) = a * b;
                div(a, b) = a / b;
                mul_add(a, b, c) = a * b + c;
                mul_sub(a, b, c) = a * b - c;
                neg_mul_add(a, b, c) = c - a * b;
                min(a, b) = if a < b { a } else { b };
                max(a, b) = if a > b { a } else { b };
                negated(a) = -a;
                abs(a) = a.abs();
                sqrt(a) = a.sqrt();
                copysign(a, b) = a.copysign(b);
            }

            #[inline(never)]
            pub(super) fn lt(a: $vector, b: $vector) -> Bits<$count> {
                let mut bits = 0;
                for lane in 0..$count {
                    bits |= u32::from(a.0.0[lane] < b.0.0[lane]) << lane;
                }
                Bits(bits)
            }

            #[inline(never)]
            pub(super) fn le(a: $vector, b: $vector) -> Bits<$count> {
                let mut bits = 0;
                for lane in 0..$count {
                    bits |= u32::from(a.0.0[lane] <= b.0.0[lane]) << lane;
                }
                Bits(bits)
            }

            #[inline(never)]
            pub(super) fn select(mask: Bits<$count>, yes: $vector, no: $vector) -> $vector {
                let mut out = no.0.0;
                for (lane, out) in out.iter_mut().enumerate() {
                    if mask.0 >> lane & 1 == 1 {
                        *out = yes.0.0[lane];
                    }
                }
                $vector(Row(out))
            }
        }

        vector!(@operator $vector, $ops, Add, add);
        vector!(@operator $vector, $ops, Sub, sub);
        vector!(@operator $vector, $ops, Mul, mul);
        vector!(@operator $vector, $ops, Div, div);
        vector!(@by_scalar $vector, $scalar, Add, add);
        vector!(@by_scalar $vector, $scalar, Sub, sub);
        vector!(@by_scalar $vector, $scalar, Mul, mul);

        impl Neg for $vector {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                $ops::negated(self)
            }
        }

        impl AddAssign for $vector {
            #[inline]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl SubAssign for $vector {
            #[inline]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }

        impl Lanes for $vector {
            type Isa = Portable;
            type Scalar = $scalar;
            type Mask = Bits<$count>;
            type Row = $row;
            const COUNT: usize = $count;

            #[inline]
            fn isa(self) -> Portable {
                Portable
            }
            #[inline]
            fn splat(_: Portable, x: $scalar) -> Self {
                Self(Row::splat(x))
            }
            #[inline]
            fn load(_: Portable, row: &$row) -> Self {
                Self(*row)
            }
            #[inline]
            fn store(self, row: &mut $row) {
                *row = self.0;
            }
            #[inline]
            fn mul_add(self, b: Self, c: Self) -> Self {
                $ops::mul_add(self, b, c)
            }
            #[inline]
            fn mul_sub(self, b: Self, c: Self) -> Self {
                $ops::mul_sub(self, b, c)
            }
            #[inline]
            fn neg_mul_add(self, b: Self, c: Self) -> Self {
                $ops::neg_mul_add(self, b, c)
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                $ops::min(self, other)
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                $ops::max(self, other)
            }
            #[inline]
            fn abs(self) -> Self {
                $ops::abs(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                $ops::sqrt(self)
            }
            #[inline]
            fn copysign(self, sign: Self) -> Self {
                $ops::copysign(self, sign)
            }
            #[inline]
            fn lt(self, other: Self) -> Bits<$count> {
                $ops::lt(self, other)
            }
            #[inline]
            fn le(self, other: Self) -> Bits<$count> {
                $ops::le(self, other)
            }
            #[inline]
            fn select(mask: Bits<$count>, yes: Self, no: Self) -> Self {
                $ops::select(mask, yes, no)
            }
            #[inline]
            fn least(self) -> $scalar {
                self.0.iter().copied().fold(<$scalar>::INFINITY, <$scalar>::min)
            }
            #[inline]
            fn most(self) -> $scalar {
                self.0.iter().copied().fold(<$scalar>::NEG_INFINITY, <$scalar>::max)
            }
        }
    };
    (@operator $vector:ident, $ops:ident, $trait:ident, $name:ident) => {
        impl $trait for $vector {
            type Output = Self;
            #[inline]
            fn $name(self, other: Self) -> Self {
                $ops::$name(self, other)
            }
        }
    };
    (@by_scalar $vector:ident, $scalar:ty, $trait:ident, $name:ident) => {
        impl $trait<$scalar> for $vector {
            type Output = Self;
            #[inline]
            fn $name(self, other: $scalar) -> Self {
                $trait::$name(self, Self(Row::splat(other)))
            }
        }
    };
}

vector!(Eight, f64, 8, F64Row, eight);
vector!(Sixteen, f32, 16, F32Row, sixteen);
