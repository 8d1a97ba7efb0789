//! The certification of a motion: its options, and the answer of a certifier, phase by phase.

#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::certify::proof::{advance, nearest};
use crate::certify::world::limits;
use crate::certify::{
    Attachment, Certifier, CertifyError, CertifyReport, ClearanceReport, Motion, Rates, UndecidedReport, Verdict,
};

use crate::certify::proof::chords::{Proof, Proved};
use crate::certify::world::phases::Phase;
use advance::{Budget, Met};
use foliate_kernels::collision::{CollisionScratch, PairId};

/// What is asked of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct CertifyOptions {
    /// Who carries what, besides what the motion itself says.
    pub attachments: Vec<Attachment>,
    /// Velocity and acceleration limits.
    pub rates: Rates,
    /// Whether the least clearance is asked for, within 10 % or 0.1 mm.
    pub clearance: bool,
    /// Distances on curves that may be asked for; what is then left is undecided.
    pub work_limit: u64,
}

impl Default for CertifyOptions {
    fn default() -> Self {
        Self { attachments: Vec::new(), rates: Rates::default(), clearance: false, work_limit: 5_000_000 }
    }
}

impl Certifier {
    /// Certifies a motion. See [`CertifyReport`].
    ///
    /// # Errors
    /// A part or link that the scene does not have; an object that cannot be carried.
    pub fn certify(
        &self,
        motion: &Motion,
        options: &CertifyOptions,
        scratch: &mut CollisionScratch,
    ) -> Result<CertifyReport, CertifyError> {
        self.certify_while(motion, options, scratch, &|| true)
    }

    /// As [`Self::certify`], as long as `go_on` says so; what is then left is undecided.
    ///
    /// # Errors
    /// As [`Self::certify`].
    pub fn certify_while(
        &self,
        motion: &Motion,
        options: &CertifyOptions,
        scratch: &mut CollisionScratch,
        go_on: &dyn Fn() -> bool,
    ) -> Result<CertifyReport, CertifyError> {
        let phases = self.phases(motion, &options.attachments)?;
        let mut budget = Budget { spent: 0, limit: options.work_limit, go_on, is_over: false };
        let mut report = self.report(motion, &phases, options);
        let mut proof = Proof::new(self, motion, scratch);
        let mut distance = f64::INFINITY;
        let mut still: Option<f64> = None;
        let mut grazing: Option<(f64, PairId)> = None;
        let mut free_until = 0.0;
        for phase in &phases {
            let found = self.go_through(&mut proof, phase, &mut budget);
            distance = distance.min(found.distance);
            let standing = nearest::still(&proof, phase, &mut budget);
            still = [still, standing].into_iter().flatten().min_by(f64::total_cmp);
            if grazing.is_none() {
                (grazing, free_until) = (found.grazing, found.free_until);
            }
            if let Some(met) = found.met {
                report.verdict = Verdict::Contact;
                report.contact = Some(self.contact(motion, phase, met, &mut budget));
                break;
            }
            if budget.is_over {
                break;
            }
        }
        report.free_until = motion.time(free_until);
        if let Some((at, pair)) = grazing {
            let reason = format!("the two come closer than {:e} m, and no contact was found", advance::RESOLUTION);
            report.undecided = Some(UndecidedReport { at: motion.time(at), pair: Some(self.pair_name(pair)), reason });
        } else if budget.is_over && report.contact.is_none() {
            let reason = String::from("the limit of time or work is reached");
            report.undecided = Some(UndecidedReport { at: report.free_until, pair: None, reason });
        }
        if report.contact.is_none() && report.undecided.is_some() {
            report.verdict = Verdict::Undecided;
        }
        if report.verdict == Verdict::Free {
            report.clearance = self.clearance(&mut proof, &phases, (distance, still), options, &mut budget);
        }
        report.distances = budget.spent;
        Ok(report)
    }

    fn go_through(&self, proof: &mut Proof<'_>, phase: &Phase, budget: &mut Budget<'_>) -> Proved {
        match proof.at_start(phase) {
            Some(contact) => {
                let met = Met { at: phase.from, pair: contact.pair, distance: contact.clearance };
                Proved { free_until: phase.from, met: Some(met), grazing: None, distance: 0.0 }
            }
            None => proof.go(phase, budget),
        }
    }

    fn clearance(
        &self,
        proof: &mut Proof<'_>,
        phases: &[Phase],
        (distance, still): (f64, Option<f64>),
        options: &CertifyOptions,
        budget: &mut Budget<'_>,
    ) -> Option<ClearanceReport> {
        if self.scene.pairs().is_empty() {
            return None;
        }
        let margins = self.scene.pairs().iter().map(|p| p.margin).fold(0.0, f64::max);
        let moving = (distance - margins).max(0.0);
        let at_least = still.map_or(moving, |value| moving.min(value));
        let mut report = ClearanceReport { at_least, measured: None, at: None, pair: None };
        if options.clearance {
            let found = nearest::nearest(proof, phases, budget);
            report.at_least = report.at_least.max(found.at_least);
            if let Some((value, at, pair)) = found.measured {
                report.measured = Some(value);
                report.at = Some(proof.motion().time(at));
                report.pair = Some(self.pair_name(pair));
            }
        }
        report.at_least.is_finite().then_some(report)
    }

    /// What is known before anything is proved.
    fn report(&self, motion: &Motion, phases: &[Phase], options: &CertifyOptions) -> CertifyReport {
        let mut notes = motion.notes.clone();
        let pairs = self.counts(phases);
        if pairs.tested == 0 {
            notes.push(String::from("no pair of shapes was tested: nothing is known of collisions"));
        }
        if !motion.timed {
            notes.push(String::from("the motion has no times: velocities and accelerations are not checked"));
        } else if motion.starts() > 0.0 {
            let start = motion.starts();
            notes.push(format!("the first point is at {start} s: the way there is not part of the motion"));
        }
        notes.extend(limits::not_looked_at(self.robot(), motion, phases));
        CertifyReport {
            verdict: Verdict::Free,
            span: [motion.starts(), motion.ends()],
            timed: motion.timed,
            coordinates: motion.coordinates.len(),
            segments: motion.segments.len(),
            degree: motion.degree(),
            free_until: motion.ends(),
            contact: None,
            undecided: None,
            clearance: None,
            limits: limits::look(self.robot(), motion, &options.rates),
            pairs,
            distances: 0,
            notes,
        }
    }
}
