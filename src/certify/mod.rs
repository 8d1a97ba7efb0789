//! Certifying anyone's motion: is it free of collision, everywhere and not at samples, and does it keep the limits of its
//! joints?
//!
//! [`formats`] read trajectories as others write them; a [`Motion`] is what they become: polynomials from point to point. A
//! [`Certifier`] holds a scene, and [`Certifier::certify`] answers with a [`CertifyReport`]: proved free, or the first time
//! of contact with the pair and how deep it goes, or undecided, and where.
//!
//! ```
//! use foliate::certify::{Certifier, CertifyOptions, Interpolation, Motion, Point, Turns, Verdict};
//! use foliate::kernels::collision::CollisionScratch;
//! use foliate::scene::{PackagePath, Scene};
//!
//! let scene = Scene::load("demo", &PackagePath::only(&[]))?;
//! let certifier = Certifier::new(&scene.problem, &[])?;
//! let joints = vec![0, 1]; // indices of coordinates; `formats::read` finds them by name
//! let start = &scene.problem.start;
//! let point = |time, turn: f64| Point { time: Some(time), positions: vec![start[0] + turn, start[1]], ..Point::default() };
//! let points = [point(0.0, 0.0), point(1.0, 0.05)];
//! let motion = Motion::through(certifier.robot(), joints, &points, Interpolation::Auto, Turns::Format).map_err(|e| e.message)?;
//! let report = certifier.certify(&motion, &CertifyOptions::default(), &mut CollisionScratch::new())?;
//! assert_eq!(report.verdict, Verdict::Free);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `motion` is the motion itself and the names of its joints; `formats` reads it. `world` is what it moves in, with its
//! limits and the form of the report. `proof` proves a motion free in a world, or finds the contact. `certifier` puts these
//! together.

pub mod certifier;
pub mod formats;
pub(crate) mod motion;
pub(crate) mod proof;
pub(crate) mod world;

pub use crate::certify::certifier::CertifyOptions;
pub use crate::certify::motion::how::{Interpolation, Turns};
pub use crate::certify::motion::names::{UnknownName, find_coordinate, find_joint};
pub use crate::certify::motion::piecewise::{
    Attachment, Curve, FARTHEST, Motion, POINTS, Point, PointError, Segment, Turn,
};
pub use crate::certify::motion::polynomial::{COEFFICIENTS, Polynomial};
pub use crate::certify::motion::scaled::Scaled;
pub use crate::certify::world::limits::Rates;
pub use crate::certify::world::phases::{Certifier, CertifyError};
pub use crate::certify::world::report::{
    CertifyReport, ClearanceReport, ContactReport, LimitKind, LimitViolation, LimitsReport, PairCounts, PairName, Peak,
    UndecidedReport, Verdict,
};
