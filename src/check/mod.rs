//! Proving a path file right or wrong from the file and its models alone.
//!
//! Nothing of the search is trusted: bodies, limits and pairs are rebuilt from the models, motions are read as the
//! path contract says, and where the planner certifies clearance by covering intervals around samples, this marches
//! forward along each pair's own clock; distances of primitives come from two independent codes. What cannot be proved
//! counts as broken.
//!
//! [`check`] answers with a [`CheckReport`], or with a [`CheckError`] where the file or a model cannot be read.

mod articulation;
mod attachments;
mod balance;
mod carriers;
mod clearance;
mod constraint;
mod distance;
mod documents;
mod enclosure;
mod leaf;
mod limits;
mod models;
mod motion;
mod pairs;
mod reach;
mod report;
mod residual;
mod structure;

pub use report::{CheckReport, Counts, Extreme, Kind, Section, Violation};

use crate::path_file::PathFile;
use crate::scene::{PackagePath, SceneError};
use models::World;
use motion::SegmentMotion;
use std::path::Path;

/// How much work a check may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckOptions {
    /// Distances and residuals that are computed at most; what is then left counts as undecided.
    pub work_limit: u64,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self { work_limit: 50_000_000 }
    }
}

/// Why a file cannot be checked.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// The file is not well formed, or does not fit its models.
    #[error("{place}: {message}")]
    Malformed {
        /// JSON path, such as `segments[3].knots[0]`.
        place: String,
        /// What is wrong there.
        message: String,
    },
    /// A model cannot be read.
    #[error("{place}: {error}")]
    Model {
        /// JSON path of the part.
        place: String,
        /// What is wrong with it.
        error: Box<SceneError>,
    },
}

impl CheckError {
    fn malformed(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Malformed { place: place.into(), message: message.into() }
    }
}

/// Proves a path. Relative model names start at `base`, the folder of the file.
///
/// # Errors
/// The file is not well formed, or a model that it names cannot be read.
pub fn check(
    file: &PathFile,
    base: &Path,
    packages: &PackagePath,
    options: &CheckOptions,
) -> Result<CheckReport, CheckError> {
    structure::check(file)?;
    let world = World::load(file, base, packages)?;
    let frames = documents::Frames::new(file, &world)?;
    let mut report = CheckReport::default();
    report.counts.parts = world.parts.len();
    report.counts.bodies = world.bodies.len();
    report.counts.shapes = world.shapes.len();
    report.counts.segments = file.segments.len();
    report.counts.knots = file.segments.iter().map(|s| s.knots.len()).sum();
    documents::check(file, &world, &mut report);
    limits::check(file, &world, &mut report);
    let attachments = attachments::resolve(file, &world, &frames)?;
    let pairs = pairs::Pairs::list(file, &world, &mut report)?;
    let mut work = Work { left: options.work_limit };
    let tester = clearance::Clearance::new(&world, &pairs);
    for (index, segment) in file.segments.iter().enumerate() {
        let motion = SegmentMotion::new(&world, segment, index, &attachments[index])?;
        carriers::check(&motion, file, &mut report);
        articulation::check(&motion, file, &mut report);
        leaf::check(&motion, file, &frames, &attachments[index], &mut report, &mut work)?;
        let thresholds = pairs.thresholds(&world, file, &attachments, index);
        tester.check(&motion, &thresholds, &mut report, &mut work);
        if index + 1 == file.segments.len() {
            tester.check_written_end(&motion, &thresholds, &mut report);
        }
    }
    certificate(file, &mut report);
    Ok(report)
}

/// How much a claimed clearance may exceed a measured one, metres: the accuracy of the distances.
const CLAIM_SLACK: f64 = 2e-6;

/// What the file claims about itself against what was measured.
fn certificate(file: &PathFile, report: &mut CheckReport) {
    let claims = &file.certificate;
    let tolerance = claims.path_tolerance;
    if !(tolerance > 0.0 && tolerance <= 1e-3) {
        report.violate(report::Place::FILE, Kind::PathTolerance, "certificate.path_tolerance", tolerance, 1e-3);
    }
    if claims.joint_limits != "within" {
        report.note(format!("certificate.joint_limits is `{}`", models::shown(&claims.joint_limits)));
    }
    let measured = report.min_clearance.clone().filter(|_| !report.has(Kind::Collision) && !report.has(Kind::Margin));
    if let (Some(claim), Some(measured)) = (claims.min_clearance, measured)
        && claim > measured.value + CLAIM_SLACK
    {
        let subject = format!("min_clearance claims {claim:.6e}, measured at {}", measured.subject);
        let place = report::Place::at(measured.segment, measured.t);
        report.violate(place, Kind::Certificate, subject, measured.value, claim);
    }
    if let Some(measured) = report.max_residual.clone().filter(|m| m.value > claims.max_residual + 1e-9) {
        let claim = claims.max_residual;
        report
            .note(format!("max_residual claims {claim:.3e}, measured {:.3e} at {}", measured.value, measured.subject));
    }
}

/// What is left of the work that a check may be.
struct Work {
    left: u64,
}

impl Work {
    /// Whether there was this much left.
    fn spend(&mut self, amount: u64) -> bool {
        let enough = self.left >= amount;
        self.left = self.left.saturating_sub(amount);
        enough
    }
}
