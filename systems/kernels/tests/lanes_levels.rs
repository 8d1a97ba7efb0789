//! Every level of the lanes computes the same, and what it computes is right: arithmetic, masks, trigonometry, geometry.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate_components::Pose;
use foliate_kernels::lanes::{
    F32Row, F64Row, Isa, Kernel, Lanes, Level, Mask, Rotation, Scalar, Transform, Vector3, atan_ratio, sin_cos,
};
use glam::{DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn numbers(seed: u64, count: usize, reach: f64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..count).map(|_| rng.random_range(-reach..reach)).collect()
}

/// A function of one number, of which every lane gets another.
macro_rules! mapped {
    ($name:ident, |$x:ident: $v:ident| $body:expr) => {
        struct $name<'a>(&'a [f64], &'a mut Vec<f64>, bool);
        impl Kernel for $name<'_> {
            type Output = ();
            #[inline(always)]
            fn run<I: Isa>(self, isa: I) {
                if self.2 {
                    for chunk in self.0.chunks_exact(8) {
                        let mut row = F64Row::default();
                        row.copy_from_slice(chunk);
                        type $v<I> = <I as Isa>::F64;
                        let $x = $v::<I>::load(isa, &row);
                        let y = $body;
                        y.store(&mut row);
                        self.1.extend_from_slice(&row.0);
                    }
                } else {
                    for chunk in self.0.chunks_exact(16) {
                        let mut row = F32Row::default();
                        for (to, from) in row.iter_mut().zip(chunk) {
                            *to = *from as f32;
                        }
                        type $v<I> = <I as Isa>::F32;
                        let $x = $v::<I>::load(isa, &row);
                        let y = $body;
                        y.store(&mut row);
                        for x in row.0 {
                            self.1.push(f64::from(x));
                        }
                    }
                }
            }
        }
    };
}

mapped!(Sine, |x: V| sin_cos(x).0);
mapped!(Cosine, |x: V| sin_cos(x).1);
mapped!(Angle, |x: V| atan_ratio(sin_cos(x).0, sin_cos(x).1));

#[test]
fn sine_and_cosine_agree_with_the_standard_library_at_every_level() {
    for level in Level::available() {
        for (reach, tolerance) in [(3.2, 3e-16), (1e3, 3e-16), (1e5, 4e-16)] {
            let x = numbers(1, 40_000, reach);
            let (mut sine, mut cosine) = (Vec::new(), Vec::new());
            level.run(Sine(&x, &mut sine, true));
            level.run(Cosine(&x, &mut cosine, true));
            for (i, x) in x.iter().enumerate() {
                assert!((sine[i] - x.sin()).abs() < tolerance, "{level} sin {x}: {} {}", sine[i], x.sin());
                assert!((cosine[i] - x.cos()).abs() < tolerance, "{level} cos {x}: {} {}", cosine[i], x.cos());
            }
        }
        for (reach, tolerance) in [(3.2, 1.5e-7), (100.0, 2e-7)] {
            let x = numbers(2, 40_000, reach);
            let (mut sine, mut cosine) = (Vec::new(), Vec::new());
            level.run(Sine(&x, &mut sine, false));
            level.run(Cosine(&x, &mut cosine, false));
            for (i, x) in x.iter().enumerate() {
                let x = f64::from(*x as f32);
                assert!((sine[i] - x.sin()).abs() < tolerance, "{level} sin {x}: {} {}", sine[i], x.sin());
                assert!((cosine[i] - x.cos()).abs() < tolerance, "{level} cos {x}: {} {}", cosine[i], x.cos());
            }
        }
    }
}

#[test]
fn angles_come_back_from_sine_and_cosine() {
    for level in Level::available() {
        let x: Vec<f64> = numbers(3, 40_000, std::f64::consts::PI).into_iter().map(f64::abs).collect();
        for (wide, tolerance) in [(true, 1e-15), (false, 8e-7)] {
            let mut angle = Vec::new();
            level.run(Angle(&x, &mut angle, wide));
            for (x, angle) in x.iter().zip(&angle) {
                assert!((x - angle).abs() < tolerance, "{level}: {x} {angle}");
            }
        }
    }
}

#[test]
fn small_angles_keep_their_digits() {
    for level in Level::available() {
        let x: Vec<f64> = (0..320).map(|i| 10f64.powf(-f64::from(i) / 20.0)).collect();
        let mut angle = Vec::new();
        level.run(Angle(&x, &mut angle, true));
        for (x, angle) in x.iter().zip(&angle) {
            assert!((x - angle).abs() <= 4.0 * f64::EPSILON * x, "{level}: {x} {angle}");
        }
    }
}

struct Arithmetic<'a>(&'a [F64Row; 3], &'a mut [F64Row; 9]);

impl Kernel for Arithmetic<'_> {
    type Output = (u32, u32, bool, bool, f64, f64);
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> Self::Output {
        let [a, b, c] = [I::F64::load(isa, &self.0[0]), I::F64::load(isa, &self.0[1]), I::F64::load(isa, &self.0[2])];
        let (less, most) = (a.lt(b), a.le(a));
        a.mul_add(b, c).store(&mut self.1[0]);
        a.mul_sub(b, c).store(&mut self.1[1]);
        a.neg_mul_add(b, c).store(&mut self.1[2]);
        (a / b - c).store(&mut self.1[3]);
        a.min(b).store(&mut self.1[4]);
        a.max(b).store(&mut self.1[5]);
        a.abs().sqrt().copysign(b).store(&mut self.1[6]);
        I::F64::select(less, a, c).store(&mut self.1[7]);
        let odd = <I::F64 as Lanes>::Mask::from_bits(isa, 0b1010_1010);
        I::F64::select(odd & !less, b, -a).store(&mut self.1[8]);
        (less.bits(), (odd | less).bits(), most.all(), (less & !less).any(), a.least(), a.most())
    }
}

#[test]
fn arithmetic_and_masks_agree_with_scalars_at_every_level() {
    let rows = numbers(4, 24, 2.0);
    let row = |k: usize| {
        let mut row = F64Row::default();
        row.copy_from_slice(&rows[8 * k..8 * k + 8]);
        row
    };
    let given = [row(0), row(1), row(2)];
    let near = |a: f64, b: f64| (a - b).abs() <= 4.0 * f64::EPSILON * (1.0 + b.abs()) * 10.0;
    for level in Level::available() {
        let mut out = [F64Row::default(); 9];
        let (less, either, all, none, least, most) = level.run(Arithmetic(&given, &mut out));
        assert!(all && !none, "{level}");
        assert_eq!(least, given[0].iter().copied().fold(f64::INFINITY, f64::min));
        assert_eq!(most, given[0].iter().copied().fold(f64::NEG_INFINITY, f64::max));
        for lane in 0..8 {
            let [a, b, c] = [given[0][lane], given[1][lane], given[2][lane]];
            let is_less = a < b;
            let odd = lane % 2 == 1;
            assert_eq!(less >> lane & 1 == 1, is_less, "{level}");
            assert_eq!(either >> lane & 1 == 1, is_less || odd, "{level}");
            let expected = [
                a * b + c,
                a * b - c,
                c - a * b,
                a / b - c,
                a.min(b),
                a.max(b),
                a.abs().sqrt().copysign(b),
                if is_less { a } else { c },
                if odd && !is_less { b } else { -a },
            ];
            for (k, expected) in expected.into_iter().enumerate() {
                assert!(near(out[k][lane], expected), "{level} {k} {lane}: {} {expected}", out[k][lane]);
            }
        }
    }
}

/// Multiplies poses and turns points, with the numbers of lane 0 read back.
struct Geometry(Pose, Pose, DVec3);

impl Kernel for Geometry {
    type Output = [f64; 21];
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> [f64; 21] {
        let (a, b) = (Transform::<I::F64>::splat(isa, &self.0), Transform::splat(isa, &self.1));
        let q = self.1.rotation;
        let number = |x: f64| I::F64::splat(isa, x);
        let turned = Rotation::from_quaternion(number(q.x), number(q.y), number(q.z), number(q.w));
        let product = Transform { rotation: turned, translation: b.translation };
        let product = a.times(&product);
        let point = Vector3::splat(isa, self.2);
        let mut rows = [F64Row::default(); 21];
        product.store(&mut rows[..12]);
        product.point(point).store(&mut rows[12..15]);
        a.rotation.transpose_times(&b.rotation).turn(point).store(&mut rows[15..18]);
        a.rotation.turn_back(point).cross(b.translation).store(&mut rows[18..]);
        let mut out = [0.0; 21];
        for (out, row) in out.iter_mut().zip(&rows) {
            *out = row[3];
        }
        out
    }
}

#[test]
fn geometry_agrees_with_poses() {
    let n = numbers(5, 14, 1.0);
    let quaternion = |k: usize| DQuat::from_xyzw(n[k], n[k + 1], n[k + 2], n[k + 3]).normalize();
    let a = Pose::from_parts(DVec3::new(n[0], n[1], n[2]), quaternion(3));
    let b = Pose::from_parts(DVec3::new(n[7], n[8], n[9]), quaternion(10));
    let point = DVec3::new(0.3, -0.2, 0.7);
    let product = a * b;
    let r = glam::DMat3::from_quat(product.rotation);
    let mut expected = r.to_cols_array().to_vec();
    expected.extend(product.translation.to_array());
    expected.extend(product.transform_point(point).to_array());
    expected.extend((a.rotation.conjugate() * b.rotation * point).to_array());
    expected.extend((a.rotation.conjugate() * point).cross(b.translation).to_array());
    for level in Level::available() {
        for (found, expected) in level.run(Geometry(a, b, point)).iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-14, "{level}: {found} {expected}");
        }
    }
}

#[test]
fn levels_are_found_by_name_and_others_are_refused_with_what_there_is() {
    let levels = Level::available();
    assert_eq!(levels.last(), Some(&Level::scalar()));
    assert_eq!(levels.first(), Some(&Level::detected()));
    for level in &levels {
        assert_eq!(Level::named(level.name()).as_ref(), Ok(level));
    }
    let error = Level::named("mmx").unwrap_err();
    let said = error.to_string();
    assert!(said.contains("mmx") && levels.iter().all(|level| said.contains(level.name())), "{said}");
    assert!("".parse::<Level>().is_err());
}

#[test]
fn tolerances_scale_with_the_type() {
    assert!(<f32 as Scalar>::EPSILON.to_f64() > 1e8 * <f64 as Scalar>::EPSILON);
    assert_eq!(<f32 as Scalar>::of(0.1).to_f64(), f64::from(0.1_f32));
}
