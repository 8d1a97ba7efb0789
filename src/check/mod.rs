//! Proving a path file right or wrong, against the scene that it answers and the models as they are.
//!
//! Nothing of the search is trusted: bodies, limits and pairs are rebuilt from the models, motions are read as the
//! path contract says, and where the planner certifies clearance by covering intervals around samples, this marches
//! forward along each pair's own clock; distances are computed by code of its own. What cannot be proved counts as broken,
//! or as undecided where work, time or resolution end first.
//!
//! A path answers a problem: the scene is the contract ([`SceneChoice`]), and what the file says of itself is compared with
//! it. Without a scene only what the file says is proved, and [`CheckReport::verdict`] says so.
//!
//! [`check`] answers with a [`CheckReport`], or with a [`CheckError`] where the file or a model cannot be read.

mod adjacent;
mod articulation;
mod attachments;
mod balance;
mod carriers;
mod certificate;
mod clearance;
mod constraint;
mod contract;
mod distance;
mod documents;
mod drift;
mod enclosure;
mod kind;
mod leaf;
mod limits;
mod models;
mod motion;
mod pairs;
mod reach;
mod report;
mod residual;
mod structure;
mod work;

pub use kind::{Kind, Section, Verdict};
pub use report::{CheckReport, Counts, Extreme, LeftOut, Violation};

use crate::path_file::PathFile;
use crate::scene::{PackagePath, SceneError};
use contract::Contract;
use foliate_components::problem::Problem;
use models::World;
use motion::SegmentMotion;
use std::path::Path;
use std::time::{Duration, Instant};
use work::{Stop, Work};

/// What a path is held against.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum SceneChoice {
    /// The scene that the file names, where it can be found; else nothing, which the report says.
    #[default]
    Named,
    /// A shipped scene, or a scene file.
    Given(String),
    /// Nothing but the models: the file is believed in everything that these do not say.
    Nothing,
}

/// How much work a check may be, and what is asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CheckOptions {
    /// Distances and residuals that are computed at most; what is then left is undecided.
    pub work_limit: u64,
    /// Time that a check may take, reading of models included; what is then left is undecided.
    pub time_limit: Option<Duration>,
    /// What the path is held against.
    pub scene: SceneChoice,
    /// Whether the smallest clearance is asked for: see [`CheckReport::clearance`].
    pub clearance: bool,
    /// Whether pairs that are not tested are asked for by name: see [`CheckReport::left_out`].
    pub pairs: bool,
}

impl Default for CheckOptions {
    fn default() -> Self {
        let scene = SceneChoice::default();
        Self { work_limit: 50_000_000, time_limit: None, scene, clearance: false, pairs: false }
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
    /// The scene that the path is to be held against cannot be read.
    #[error("scene: {0}")]
    Scene(Box<SceneError>),
}

impl CheckError {
    fn malformed(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Malformed { place: place.into(), message: message.into() }
    }
}

/// Proves a path. Relative model names start at `base`, the folder of the file; so does the name of its scene file.
///
/// # Errors
/// The file is not well formed, or a model that it names cannot be read, or the scene that was asked for.
pub fn check(
    file: &PathFile,
    base: &Path,
    packages: &PackagePath,
    options: &CheckOptions,
) -> Result<CheckReport, CheckError> {
    let deadline = deadline(options);
    let mut report = CheckReport::default();
    let scene = contract::scene_of(file, base, packages, &options.scene, &mut report)?;
    let contract = scene.as_ref().map(Contract::of_scene);
    prove(file, (base, packages), options, deadline, contract.as_ref(), report)
}

/// Proves that a path answers a problem that was built in code: as [`check`] against a scene.
///
/// # Errors
/// As [`check`].
pub fn check_problem(
    file: &PathFile,
    base: &Path,
    packages: &PackagePath,
    options: &CheckOptions,
    problem: &Problem,
) -> Result<CheckReport, CheckError> {
    let contract = Contract::of_problem(problem);
    prove(file, (base, packages), options, deadline(options), Some(&contract), CheckReport::default())
}

fn deadline(options: &CheckOptions) -> Option<Instant> {
    options.time_limit.and_then(|limit| Instant::now().checked_add(limit))
}

fn prove(
    file: &PathFile,
    (base, packages): (&Path, &PackagePath),
    options: &CheckOptions,
    deadline: Option<Instant>,
    contract: Option<&Contract<'_>>,
    mut report: CheckReport,
) -> Result<CheckReport, CheckError> {
    report.scene = contract.map(|contract| contract.name().to_owned());
    structure::check(file)?;
    let world = World::load(file, base, packages, &mut report)?;
    let frames = documents::Frames::new(file, &world)?;
    count(file, &world, &mut report);
    documents::check(file, &world, &mut report);
    limits::check(file, &world, &mut report);
    let attachments = attachments::resolve(file, &world, &frames)?;
    let ignored = pairs::ignored(file, &world, &mut report)?;
    if let Some(contract) = contract {
        contract.claims(file, &world, &mut report);
        contract.holding(file, &mut report);
    }
    let pairs = pairs::Pairs::list(file, &world, &ignored, &mut report, options.pairs)?;
    let mut proof = Proof { file, world: &world, frames: &frames, attachments: &attachments, pairs: &pairs, contract };
    let mut work = Work::new(options.work_limit, deadline);
    proof.segments(options, &mut report, &mut work)?;
    if options.clearance && work.stop().is_none() {
        report.clearance = report.min_clearance.as_ref().map(|least| clearance::least_between(least.value));
    }
    certificate::check(file, &mut report);
    Ok(report)
}

fn count(file: &PathFile, world: &World, report: &mut CheckReport) {
    report.counts.parts = world.parts.len();
    report.counts.bodies = world.bodies.len();
    report.counts.shapes = world.shapes.len();
    report.counts.segments = file.segments.len();
    report.counts.knots = file.segments.iter().map(|s| s.knots.len()).sum();
}

/// What the proof of all segments looks at.
struct Proof<'p> {
    file: &'p PathFile,
    world: &'p World,
    frames: &'p documents::Frames,
    attachments: &'p [Vec<attachments::Attachment>],
    pairs: &'p pairs::Pairs,
    contract: Option<&'p Contract<'p>>,
}

impl Proof<'_> {
    /// Everything that is cheap first, over all segments, then what costs work.
    fn segments(
        &mut self,
        options: &CheckOptions,
        report: &mut CheckReport,
        work: &mut Work,
    ) -> Result<(), CheckError> {
        let mut drift = drift::Drift::new(self.world.parts.len(), self.world.bodies.len());
        let mut moving = vec![false; self.pairs.list.len()];
        for (index, segment) in self.file.segments.iter().enumerate() {
            let motion = SegmentMotion::new(self.world, segment, index, &self.attachments[index])?;
            carriers::check(&motion, self.file, report);
            articulation::check(&motion, self.file, report);
            drift.add(&motion, self.file, report);
            if let Some(contract) = self.contract {
                contract.ends(self.file, &motion, self.frames, report, work)?;
            }
        }
        let claim = self.file.certificate.min_clearance;
        let tester = clearance::Clearance::new(self.world, self.pairs, options.clearance, claim);
        for (index, segment) in self.file.segments.iter().enumerate() {
            if report.is_broken() {
                work.refused();
            }
            work.look();
            let motion = SegmentMotion::new(self.world, segment, index, &self.attachments[index])?;
            leaf::check(&motion, self.file, self.frames, &self.attachments[index], report, work)?;
            if let Some(contract) = self.contract {
                contract.demands(self.file, &motion, self.frames, report, work)?;
            }
            let thresholds = self.pairs.thresholds(self.world, self.file, self.attachments, index);
            tester.check(&motion, &thresholds, &mut moving, report, work);
            if let Some(stop) = work.stop() {
                self.left(index, stop, report);
                break;
            }
            if index + 1 == self.file.segments.len() {
                tester.check_written_end(&motion, &thresholds, report);
            }
        }
        report.counts.pairs_moving = moving.iter().filter(|moves| **moves).count();
        Ok(())
    }

    /// Says what is left where a check stops before its end.
    fn left(&self, index: usize, stop: Stop, report: &mut CheckReport) {
        let last = self.file.segments.len() - 1;
        let subject = format!("{}: segments {index} to {last} of 0 to {last} are not proved", stop.told());
        match stop {
            Stop::Refused => report.note(subject),
            Stop::WorkLimit | Stop::TimeLimit => {
                let place = report::Place { segment: Some(index), t: None };
                report.violate(place, Kind::Undecided, subject, None, None);
            }
        }
    }
}
