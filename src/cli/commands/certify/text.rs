//! What `foliate certify` says to people.

use crate::certify::{CertifyReport, ClearanceReport, ContactReport, LimitKind, LimitViolation, PairName, Verdict};
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

/// What a certification took, reading and loading aside.
#[derive(Clone, Copy)]
pub(crate) struct Spent {
    pub(crate) wall: Duration,
    /// None where the system does not tell.
    pub(crate) processor: Option<Duration>,
}

/// One of many motions, in one line.
pub(crate) fn line(path: &Path, result: &Result<CertifyReport, String>, spent: Spent) -> String {
    let name = path.display();
    let report = match result {
        Ok(report) => report,
        Err(message) => return format!("error      {message}\n"),
    };
    let what = match (&report.contact, &report.undecided, report.limits.violations.first()) {
        (Some(contact), ..) => format!("{} at {}", pair(&contact.pair), at(report, contact.at)),
        (None, Some(undecided), _) => format!("from {} on: {}", at(report, undecided.at), undecided.reason),
        (None, None, Some(violation)) => limit(report, violation),
        (None, None, None) => String::new(),
    };
    let verdict = match report.verdict {
        Verdict::Contact => "CONTACT  ",
        Verdict::Undecided => "undecided",
        Verdict::Free if report.limits.violations.is_empty() => "free     ",
        Verdict::Free => "LIMIT    ",
    };
    format!("{verdict}  {name}  {:.2} ms  {what}\n", spent.wall.as_secs_f64() * 1e3)
}

/// One motion alone.
pub(crate) fn page(path: &Path, scene: &str, result: &Result<CertifyReport, String>, spent: Spent) -> String {
    let Ok(report) = result else { return String::new() };
    let mut out = String::new();
    let curves = match report.degree {
        0 | 1 => "straight",
        2 | 3 => "cubic",
        _ => "quintic",
    };
    let [start, end] = report.span;
    let _ = writeln!(
        out,
        "{} in {}: {} coordinates, {} {curves} pieces, {} to {}",
        path.display(),
        scene.escape_debug(),
        report.coordinates,
        report.segments,
        at(report, start),
        at(report, end)
    );
    clearance(&mut out, report);
    limits(&mut out, report);
    let p = &report.pairs;
    let _ = writeln!(
        out,
        "  pairs      {} pairs of shapes tested ({} without their margin); left out: {} by SRDF, {} adjacent, {} ignored by the \
         scene, {} of one body, {} of the environment, {} allowed to touch",
        p.tested, p.without_margin, p.srdf, p.adjacent, p.ignored, p.same_body, p.environment, p.touch_allowed
    );
    for note in &report.notes {
        let _ = writeln!(out, "  note       {note}");
    }
    let verdict = match (report.failed(), report.verdict) {
        (true, _) => "refused",
        (false, Verdict::Undecided) => "undecided",
        _ => "proved",
    };
    let _ = write!(out, "{verdict} in {:.2} ms", spent.wall.as_secs_f64() * 1e3);
    let _ = match spent.processor {
        Some(processor) => writeln!(out, ", {:.2} ms of processor time", processor.as_secs_f64() * 1e3),
        None => writeln!(out),
    };
    out
}

fn at(report: &CertifyReport, time: f64) -> String {
    if report.timed { format!("{time:.6} s") } else { format!("point {time:.6}") }
}

fn pair(pair: &PairName) -> String {
    pair.shapes.join(" and ")
}

fn clearance(out: &mut String, report: &CertifyReport) {
    match report.verdict {
        Verdict::Free => {
            let _ = writeln!(out, "  ok         free over the continuum{}", kept(report, report.clearance.as_ref()));
        }
        Verdict::Contact => {
            if let Some(contact) = &report.contact {
                let _ = writeln!(out, "  CONTACT    {}", met(report, contact));
                let (free, at) = (at(report, report.free_until), at(report, contact.at));
                let _ = writeln!(out, "             free until {free}, in contact at {at}");
            }
        }
        Verdict::Undecided => {
            let _ = writeln!(out, "  UNDECIDED  free until {}", at(report, report.free_until));
        }
    }
    if let Some(undecided) = &report.undecided {
        let who = undecided.pair.as_ref().map_or(String::new(), |p| format!("{}: ", pair(p)));
        let _ = writeln!(out, "  undecided  from {} on: {who}{}", at(report, undecided.at), undecided.reason);
    }
}

fn kept(report: &CertifyReport, clearance: Option<&ClearanceReport>) -> String {
    let Some(found) = clearance else { return String::new() };
    match (&found.measured, &found.at, &found.pair) {
        (Some(value), Some(time), Some(name)) => format!(
            ": at least {:.3} mm beyond margins; nearest {:.3} mm at {}, {}",
            found.at_least * 1e3,
            value * 1e3,
            at(report, *time),
            pair(name)
        ),
        _ => format!(
            ": at least {:.3} mm beyond margins (a bound that the proof yields, often far below the least clearance; \
             --clearance finds that, and where)",
            found.at_least * 1e3
        ),
    }
}

fn met(report: &CertifyReport, contact: &ContactReport) -> String {
    let how = match contact.depth {
        Some(depth) => format!("{:.3} mm deep at {}", depth * 1e3, at(report, contact.deepest_at)),
        None if contact.contained => String::from("one inside the other"),
        None if contact.margin > 0.0 => {
            format!("{:.3} mm apart, {:.3} mm wanted", contact.least_distance * 1e3, contact.margin * 1e3)
        }
        None => String::from("touching"),
    };
    format!("{}: {how}, until about {}", pair(&contact.pair), at(report, contact.until))
}

fn limits(out: &mut String, report: &CertifyReport) {
    let l = &report.limits;
    let verdict = if l.violations.is_empty() { "ok       " } else { "LIMIT    " };
    let _ = writeln!(
        out,
        "  {verdict}  limits: positions of {}, velocities of {}, accelerations of {} coordinates; efforts are not checked",
        l.positions, l.velocities, l.accelerations
    );
    for violation in &l.violations {
        let _ = writeln!(out, "             {}", limit(report, violation));
    }
    for (peak, what) in [(&l.velocity_peak, "velocity"), (&l.acceleration_peak, "acceleration")] {
        if let Some(peak) = peak {
            let _ = writeln!(
                out,
                "             fastest {what}: {} {:.4} of {:.4} at {}",
                peak.joint,
                peak.value,
                peak.limit,
                at(report, peak.at)
            );
        }
    }
}

fn limit(report: &CertifyReport, violation: &LimitViolation) -> String {
    let what = match violation.kind {
        LimitKind::Position => "position",
        LimitKind::Velocity => "velocity",
        LimitKind::Acceleration => "acceleration",
        LimitKind::VelocityJump => {
            let by = violation.worst;
            let (first, worst) = (at(report, violation.first_at), at(report, violation.worst_at));
            return format!("{}: velocity jumps from {first} on, by {by:.4} at {worst}", violation.joint);
        }
    };
    format!(
        "{}: {what} beyond {:.4} from {} on, {:.4} at {}",
        violation.joint,
        violation.limit,
        at(report, violation.first_at),
        violation.worst,
        at(report, violation.worst_at)
    )
}
