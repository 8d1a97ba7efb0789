//! Limits of positions, velocities and accelerations hold between the points of a motion, or where they first do not is said.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

mod certify_common;

use certify_common::{certify, motion, point, slider};
use foliate::certify::{CertifyOptions, CertifyReport, Interpolation, LimitKind, LimitViolation, Point, Rates};

fn with(time: f64, x: f64, v: f64) -> Point {
    Point { velocities: Some(vec![v]), ..point(time, &[x]) }
}

fn only(report: &CertifyReport, kind: LimitKind) -> LimitViolation {
    let found: Vec<_> = report.limits.violations.iter().filter(|v| v.kind == kind).collect();
    assert_eq!(found.len(), 1, "{:?}", report.limits);
    found[0].clone()
}

/// The slider may be between ±4 and moves at most 2 m/s; the wall is far away on the other side.
#[test]
fn a_spline_leaves_its_limits_between_points() {
    let problem = slider();
    // x = −3.9 − 1.6 s (1 − s), s = t/2: at most 0.4 beyond −3.9, both points within the limits.
    let points = [with(0.0, -3.9, -0.8), with(2.0, -3.9, 0.8)];
    let curve = motion(&problem, &["slide"], &points, Interpolation::Auto);
    let report = certify(&problem, &curve, &CertifyOptions::default());
    let broken = only(&report, LimitKind::Position);
    assert_eq!((broken.joint.as_str(), broken.limit), ("robot/slide", -4.0));
    assert!((broken.worst + 4.3).abs() < 1e-9 && (broken.worst_at - 1.0).abs() < 1e-6, "{broken:?}");
    // −3.9 − 1.6 s (1 − s) = −4.
    let first = 2.0 * 0.5 * (1.0 - (1.0_f64 - 4.0 * 0.1 / 1.6).sqrt());
    assert!((broken.first_at - first).abs() < 1e-9, "{broken:?} {first}");
    assert!(report.failed() && !report.passed());
}

#[test]
fn velocities_and_accelerations_are_those_of_the_curve() {
    let problem = slider();
    // From rest to rest over a metre in 0.6 s: at most 1.5 · 1/0.6 = 2.5 m/s in the middle, 6/0.36 m/s² at the ends.
    let points = [with(0.0, -3.0, 0.0), with(0.6, -2.0, 0.0)];
    let curve = motion(&problem, &["slide"], &points, Interpolation::Auto);
    let broken = only(&certify(&problem, &curve, &CertifyOptions::default()), LimitKind::Velocity);
    assert!((broken.worst - 2.5).abs() < 1e-9 && (broken.worst_at - 0.3).abs() < 1e-6, "{broken:?}");
    // 2.5 · 4 s (1 − s) = 2 in units of 0.6 s.
    let first = 0.6 * 0.5 * (1.0 - (1.0_f64 - 0.8).sqrt());
    assert!((broken.first_at - first).abs() < 1e-9, "{broken:?}");
    let rates = |rates: Rates| CertifyOptions { rates, ..CertifyOptions::default() };
    let wider = Rates { velocity_scale: 1.3, ..Rates::default() };
    assert!(certify(&problem, &curve, &rates(wider)).passed());
    let own = Rates { velocity: vec![("robot/slide".into(), 2.6)], ..Rates::default() };
    let report = certify(&problem, &curve, &rates(own.clone()));
    assert!(report.passed());
    let peak = report.limits.velocity_peak.unwrap();
    assert!((peak.value - 2.5).abs() < 1e-9 && peak.limit == 2.6);
    let accelerated = Rates { acceleration: Some(16.0), ..own.clone() };
    let broken = only(&certify(&problem, &curve, &rates(accelerated)), LimitKind::Acceleration);
    assert!((broken.worst.abs() - 6.0 / 0.36).abs() < 1e-9 && broken.first_at == 0.0, "{broken:?}");
    let enough = Rates { acceleration: Some(17.0), ..own };
    assert!(certify(&problem, &curve, &rates(enough)).passed());
}

#[test]
fn a_polyline_has_corners_that_no_acceleration_takes() {
    let problem = slider();
    let points = [point(0.0, &[0.0]), point(1.0, &[0.5]), point(2.0, &[0.0])];
    let polyline = motion(&problem, &["slide"], &points, Interpolation::Auto);
    assert!(certify(&problem, &polyline, &CertifyOptions::default()).passed());
    let rates = Rates { acceleration: Some(100.0), ..Rates::default() };
    let report = certify(&problem, &polyline, &CertifyOptions { rates, ..CertifyOptions::default() });
    let jump = only(&report, LimitKind::VelocityJump);
    assert!((jump.worst + 1.0).abs() < 1e-12 && jump.first_at == 1.0, "{jump:?}");
    // Without times nothing is said of velocities.
    let untimed = points.map(|p| Point { time: None, ..p });
    let untimed = motion(&problem, &["slide"], &untimed, Interpolation::Auto);
    let report = certify(&problem, &untimed, &CertifyOptions::default());
    assert!(report.limits.velocities == 0 && report.notes.iter().any(|n| n.contains("no times")));
}
