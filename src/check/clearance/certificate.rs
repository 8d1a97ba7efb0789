//! What the file claims about itself against what was measured.

use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::kind::Kind;
use crate::path_file::document::{PairsEntry, PathFile};

/// How much a claimed clearance may exceed a measured one, metres: the accuracy of the distances.
pub(crate) const CLAIM_SLACK: f64 = 2e-6;

/// How much a measured residual may exceed a claimed one, metres or radians: rounding.
const RESIDUAL_SLACK: f64 = 1e-9;

/// How much a share of a limit may exceed a claimed one: what rounding can do to it, see `timing::rates`.
const RATE_SLACK: f64 = 1.1e-6;

pub(crate) fn check(file: &PathFile, report: &mut CheckReport) {
    let claims = &file.certificate;
    let tolerance = claims.path_tolerance;
    if !(tolerance > 0.0 && tolerance <= 1e-3) {
        report.violate(Place::FILE, Kind::PathTolerance, "certificate.path_tolerance", tolerance, 1e-3);
    }
    if claims.joint_limits != "within" {
        let subject = format!("joint_limits is `{}`, not `within`", shown(&claims.joint_limits));
        report.violate(Place::FILE, Kind::Certificate, subject, None, None);
    }
    clearance(file, report);
    residual(file, report);
    rates(file, report);
    if report.counts.pairs == 0 {
        report.note("no pair of shapes is tested: nothing is said about collisions");
    }
    if let Some(claimed) = &claims.pairs {
        pairs(claimed, report);
    }
}

/// The claim may not be smaller than a residual that was measured. One beyond the tolerance is a violation by itself.
fn residual(file: &PathFile, report: &mut CheckReport) {
    let (claim, tolerance) = (file.certificate.max_residual, file.certificate.path_tolerance);
    let is_false = |measured: f64| measured > claim + RESIDUAL_SLACK && measured <= tolerance;
    if let Some(measured) = report.max_residual.clone().filter(|m| is_false(m.value)) {
        let subject = format!("max_residual claims {claim:.3e}, measured at {}", measured.subject);
        let place = Place::at(measured.segment, measured.t);
        report.violate(place, Kind::Certificate, subject, measured.value, claim);
    }
}

/// A claimed share of a limit is at most 1, and not smaller than what was found.
fn rates(file: &PathFile, report: &mut CheckReport) {
    let claims = &file.certificate;
    for (what, claim, found) in [
        ("max_velocity", claims.max_velocity, report.max_velocity.clone()),
        ("max_acceleration", claims.max_acceleration, report.max_acceleration.clone()),
    ] {
        let Some(claim) = claim else { continue };
        if claim > 1.0 + RATE_SLACK {
            report.violate(Place::FILE, Kind::Certificate, format!("{what} is more than a limit"), claim, 1.0);
        }
        if let Some(found) = found.filter(|found| found.value > claim + RATE_SLACK) {
            let subject = format!("{what} claims {claim:.6}, found at {}", found.subject);
            report.violate(Place::at(found.segment, found.t), Kind::Certificate, subject, found.value, claim);
        }
    }
}

fn clearance(file: &PathFile, report: &mut CheckReport) {
    let Some(claim) = file.certificate.min_clearance else {
        if report.counts.pairs > 0 {
            report.note("the certificate says nothing about clearance");
        }
        return;
    };
    if report.has(Kind::Collision) || report.has(Kind::Margin) {
        return;
    }
    match report.min_clearance.clone() {
        Some(measured) if claim > measured.value + CLAIM_SLACK => {
            let subject = format!("min_clearance claims {claim:.6e}, measured at {}", measured.subject);
            let place = Place::at(measured.segment, measured.t);
            report.violate(place, Kind::Certificate, subject, measured.value, claim);
        }
        None if report.counts.pairs == 0 => {
            let subject = "min_clearance claims a number, and no pair is tested";
            report.violate(Place::FILE, Kind::Certificate, subject, None, claim);
        }
        _ => {}
    }
}

/// Rigid pairs are those that locked joints hold together, which the file does not tell: they are counted with those that
/// are tested.
fn pairs(claimed: &PairsEntry, report: &mut CheckReport) {
    let counts = &report.counts;
    let rows = [
        ("tested, or rigid to one another,", claimed.tested + claimed.rigid, counts.pairs),
        ("of one body", claimed.same_body, counts.pairs_of_one_body),
        ("of the environment", claimed.environment, counts.pairs_of_the_environment),
        ("disabled by an SRDF", claimed.srdf, counts.pairs_disabled_by_srdf),
        ("of neighbours", claimed.adjacent, counts.pairs_adjacent),
        ("ignored", claimed.ignored, counts.pairs_ignored_by_file),
    ];
    let wrong: Vec<_> = rows.into_iter().filter(|(_, claim, counted)| *claim != *counted as u64).collect();
    for (what, claim, counted) in wrong {
        let subject = format!("pairs {what}: the certificate counts {claim}, the models have {counted}");
        report.violate(Place::FILE, Kind::Certificate, subject, counted as f64, claim as f64);
    }
}
