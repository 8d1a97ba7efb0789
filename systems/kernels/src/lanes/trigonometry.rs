//! Sine, cosine and arc tangent without a branch: the same polynomials in every lane.
//!
//! The coefficients are Chebyshev fits of our own (in x², with forty digits) on the interval to which the argument is
//! reduced; what they leave out is below half a last digit.

use super::vector::{Lanes, Scalar};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4};

/// (sin(x)/x − 1)/x² on [−π/2, π/2].
const SINE: [f64; 8] = [
    -0.166_666_666_666_666_66,
    0.008_333_333_333_333_316,
    -0.000_198_412_698_412_549_66,
    2.755_731_921_916_083_3e-6,
    -2.505_210_761_669_045e-8,
    1.605_897_729_264_274_3e-10,
    -7.643_969_663_988_074e-13,
    2.731_436_876_937_989_5e-15,
];

/// (cos(x) − 1 + x²/2)/x⁴ on [−π/2, π/2].
const COSINE: [f64; 8] = [
    0.041_666_666_666_666_664,
    -0.001_388_888_888_888_888,
    2.480_158_730_157_984_8e-5,
    -2.755_731_922_156_836e-7,
    2.087_675_660_272_221_5e-9,
    -1.147_071_226_281_378_6e-11,
    4.777_877_608_038_441e-14,
    -1.521_859_881_858_031_5e-16,
];

/// (atan(x)/x − 1)/x² on [1 − √2, √2 − 1].
const ARC_TANGENT: [f64; 11] = [
    -0.333_333_333_333_333_3,
    0.199_999_999_999_955_16,
    -0.142_857_142_846_656_82,
    0.111_111_110_151_870_18,
    -0.090_909_045_753_064_9,
    0.076_921_831_253_768_92,
    -0.066_645_105_255_089_36,
    0.058_581_409_048_663_28,
    -0.050_854_078_345_894_844,
    0.039_230_447_784_793_09,
    -0.019_175_404_711_104_932,
];

/// The same three for single precision.
const SINE_SHORT: [f64; 4] =
    [-0.166_666_656_732_559_2, 0.008_333_242_498_338_223, -1.982_273_539_340_315e-4, 2.634_744_532_770_128e-6];
const COSINE_SHORT: [f64; 4] =
    [0.041_666_667_908_430_1, -0.001_388_881_239_108_741_3, 2.478_607_893_863_227_2e-5, -2.654_596_755_746_752e-7];
const ARC_TANGENT_SHORT: [f64; 4] =
    [-0.333_332_866_430_282_6, 0.199_912_354_350_090_03, -0.140_240_967_273_712_16, 0.085_202_775_895_595_55];

/// π in parts whose products with small whole numbers are exact.
const PI: [f64; 3] = [3.141_592_653_468_251_2, 1.215_420_100_718_692e-10, 5.825_464_112_186_712e-20];
const PI_SHORT: [f64; 3] = [3.140_625, 9.675_025_939_941_406e-4, 1.509_958_025_280_866_4e-7];

/// Whether the type has the digits of `f32`.
#[inline(always)]
fn is_short<V: Lanes>() -> bool {
    V::Scalar::EPSILON.to_f64() > 1e-10
}

/// Σ cᵢ xⁱ.
#[inline(always)]
fn polynomial<V: Lanes, const N: usize>(x: V, coefficients: &[f64; N]) -> V {
    let isa = x.isa();
    let mut sum = V::constant(isa, coefficients[N - 1]);
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        sum = sum.mul_add(x, V::constant(isa, coefficients[k]));
    }
    sum
}

/// The nearest whole number, ties to even; exact for |x| below half the largest exact whole number.
#[inline(always)]
fn nearest_whole<V: Lanes>(x: V) -> V {
    let rounder = V::constant(x.isa(), 1.5 / V::Scalar::EPSILON.to_f64());
    (x + rounder) - rounder
}

/// Sine and cosine.
///
/// Within 2 EPSILON of the truth for |x| ≤ 10⁵ in `f64`, 10² in `f32`; the error grows with |x| beyond that.
#[inline(always)]
pub fn sin_cos<V: Lanes>(x: V) -> (V, V) {
    let isa = x.isa();
    let turns = nearest_whole(x * V::constant(isa, FRAC_1_PI));
    let parts = if is_short::<V>() { &PI_SHORT } else { &PI };
    let mut r = x;
    for part in parts {
        r = turns.neg_mul_add(V::constant(isa, *part), r);
    }
    // Half turns that are odd change both signs: the rest by two is −1, 0 or 1.
    let rest = turns - nearest_whole(turns * V::constant(isa, 0.5)) * V::constant(isa, 2.0);
    let sign = (rest * rest).neg_mul_add(V::constant(isa, 2.0), V::constant(isa, 1.0));
    let square = r * r;
    let (s, c) = if is_short::<V>() {
        (polynomial(square, &SINE_SHORT), polynomial(square, &COSINE_SHORT))
    } else {
        (polynomial(square, &SINE), polynomial(square, &COSINE))
    };
    let sine = (s * square).mul_add(r, r);
    let cosine = (c * square).mul_add(square, square.neg_mul_add(V::constant(isa, 0.5), V::constant(isa, 1.0)));
    (sine * sign, cosine * sign)
}

/// The angle in [0, π] of the direction (`cosine`, `sine`), for `sine` ≥ 0 and any common scale; within 4 EPSILON. Where both
/// are zero the answer is not a number.
#[inline(always)]
pub fn atan_ratio<V: Lanes>(sine: V, cosine: V) -> V {
    let isa = sine.isa();
    // Around 0, π/4 and π/2 the arc tangent of (s·cos a − c·sin a)/(c·cos a + s·sin a) is added to a.
    let c = cosine.abs();
    let narrow = V::constant(isa, std::f64::consts::SQRT_2 - 1.0);
    let (low, high) = (sine.le(c * narrow), c.le(sine * narrow));
    let numerator = V::select(low, sine, V::select(high, -c, sine - c));
    let denominator = V::select(low, c, V::select(high, sine, sine + c));
    let zero = V::constant(isa, 0.0);
    let base = V::select(low, zero, V::select(high, V::constant(isa, FRAC_PI_2), V::constant(isa, FRAC_PI_4)));
    let t = numerator / denominator;
    let square = t * t;
    let p = if is_short::<V>() { polynomial(square, &ARC_TANGENT_SHORT) } else { polynomial(square, &ARC_TANGENT) };
    let angle = base + (p * square).mul_add(t, t);
    V::select(cosine.lt(zero), V::constant(isa, std::f64::consts::PI) - angle, angle)
}
