//! The order of the proof: reads file, models and scene, and runs every check over every segment.

use crate::check::clearance::{along, certificate, pairs};
use crate::check::contract::scene_contract;
use crate::check::contract::scene_contract::Contract;
use crate::check::leaf::{articulation, carriers, check, drift};
use crate::check::motion::segment::SegmentMotion;
use crate::check::report::check_report;
use crate::check::report::check_report::CheckReport;
use crate::check::report::error::{CheckError, CheckOptions};
use crate::check::report::kind::Kind;
use crate::check::report::work::{Stop, Work};
use crate::check::timing::{continuity, events, rates};
use crate::check::world::models::World;
use crate::check::world::{attachments, documents};
use crate::check::{limits, structure};
use crate::path_file::document::PathFile;
use crate::scene::sources::package::PackagePath;
use foliate_components::problem::Problem;
use std::path::Path;
use std::time::Instant;

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
    let scene = scene_contract::scene_of(file, base, packages, &options.scene, &mut report)?;
    let contract = scene.as_ref().map(Contract::of_scene);
    let packages = &packages.clone().with_readable(scene.as_ref().and_then(|scene| scene.directory.as_ref()));
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
    rates::note_differences(file, &world, &mut report);
    events::check(file, &world, &frames, &mut report);
    let attachments = attachments::resolve(file, &world, &frames)?;
    let ignored = pairs::ignored(file, &world, &mut report)?;
    if let Some(contract) = contract {
        contract.claims(file, &world, &mut report);
        contract.holding(file, &mut report);
    }
    let pairs = pairs::Pairs::list(file, &world, &ignored, &mut report, options.pairs)?;
    let mut proof = Proof { file, world: &world, frames: &frames, attachments: &attachments, pairs: &pairs, contract };
    let mut work = Work::new(options.work_limit, deadline, options.cancelled.clone());
    proof.segments(options, &mut report, &mut work)?;
    if options.clearance && work.stop().is_none() {
        report.clearance = report.min_clearance.as_ref().map(|least| along::least_between(least.value));
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

/// What the proof of all segments uses.
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
        let mut continuity = continuity::Continuity::default();
        let mut moving = vec![false; self.pairs.list.len()];
        for (index, segment) in self.file.segments.iter().enumerate() {
            let motion = SegmentMotion::new(self.world, segment, index, &self.attachments[index])?;
            carriers::check(&motion, self.file, report);
            articulation::check(&motion, self.file, report);
            drift.add(&motion, self.file, report);
            continuity.add(&motion, self.file, report);
            rates::check(&motion, self.file, report);
            if let Some(contract) = self.contract {
                contract.ends(self.file, &motion, self.frames, report, work)?;
            }
        }
        let claim = self.file.certificate.min_clearance;
        let tester = along::Clearance::new(self.world, self.pairs, options.clearance, claim);
        for (index, segment) in self.file.segments.iter().enumerate() {
            if report.is_broken() {
                work.refused();
            }
            work.look();
            let motion = SegmentMotion::new(self.world, segment, index, &self.attachments[index])?;
            check::check(&motion, self.file, self.frames, &self.attachments[index], report, work)?;
            if let Some(contract) = self.contract {
                contract.required_constraints(self.file, &motion, self.frames, report, work)?;
                contract.held_speeds(&motion, self.frames, report, work)?;
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
            Stop::WorkLimit | Stop::TimeLimit | Stop::Cancelled => {
                let place = check_report::Place { segment: Some(index), t: None };
                report.violate(place, Kind::Undecided, subject, None, None);
            }
        }
    }
}
