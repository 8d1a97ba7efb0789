//! The same arithmetic on several numbers at once: eight `f64` or sixteen `f32` a vector, one source for every processor.
//!
//! Nothing outside this folder names an instruction set. A kernel is a value with the data it works on, written once and
//! compiled for each [`Level`]; the level is chosen at run time.
//!
//! ```
//! use foliate_kernels::lanes::{F32Row, Isa, Kernel, Lanes, Level};
//!
//! /// Squared lengths of sixteen vectors at a time.
//! struct Lengths<'a> {
//!     xy: &'a [[F32Row; 2]],
//!     out: &'a mut [F32Row],
//! }
//!
//! impl Kernel for Lengths<'_> {
//!     type Output = ();
//!     #[inline(always)]
//!     fn run<I: Isa>(self, isa: I) {
//!         for ([x, y], out) in self.xy.iter().zip(self.out) {
//!             let (x, y) = (I::F32::load(isa, x), I::F32::load(isa, y));
//!             x.mul_add(x, y * y).store(out);
//!         }
//!     }
//! }
//!
//! let (xy, mut out) = ([[F32Row::splat(3.0), F32Row::splat(4.0)]], [F32Row::splat(0.0)]);
//! Level::detected().run(Lengths { xy: &xy, out: &mut out });
//! assert_eq!(out[0][7], 25.0);
//! ```
//!
//! How to write one:
//!
//! * Functions that touch vectors are generic over [`Isa`] or [`Lanes`] and `#[inline(always)]`, every one of them: only what
//!   is inlined into [`Level::run`] is compiled with the level's instructions. Closures too, so loops are `for` loops;
//!   `map`, `array::from_fn` and iterator adaptors that are handed closures over vectors are compiled without.
//! * One [`Level::run`] per batch of work, not per number: the call costs a few nanoseconds and is not inlined.
//! * Memory is made of rows: a [`Row`] is one quantity of every lane, 64 bytes on a 64-byte border, so that the layout is
//!   `[quantity][lane]` on every machine. Vectors themselves live in registers and are never stored in structures.
//! * An array of vectors is in registers only where every loop over it is unrolled. Loops whose number of turns is constant
//!   are, triangular nests of six turns are not: their outermost turns are calls with a constant each (`linear/lane_ldlt`).
//! * No branch on what a lane contains, except to skip work that no lane needs (`mask.any()`), and then each lane's result
//!   is selected as if the work had been done: what a lane gets must not depend on its neighbours.
//! * `mul_add` is fused where the level has it, so that last bits differ between levels, never between two runs at one.
//!   Tolerances scale with [`Scalar::EPSILON`]: `x < low + 1e-9` is never true in `f32`.
//! * There is a test for parity with a scalar counterpart, at [`Level::available`] levels all.

pub(crate) mod geometry;
pub(crate) mod level;
pub(crate) mod scalar;
pub(crate) mod trigonometry;
pub(crate) mod vector;

pub use crate::lanes::geometry::{Rotation, Transform, Vector3};
pub use crate::lanes::level::{Kernel, Level, UnknownLevel};
pub use crate::lanes::trigonometry::{atan_ratio, sin_cos};
pub use crate::lanes::vector::{F32Row, F64Row, Isa, Lanes, Mask, Row, Scalar};
