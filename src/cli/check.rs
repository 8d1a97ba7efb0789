//! `foliate check`: prove a path again from its file.

use super::{Ending, Refusal, print, print_json};
use foliate::check::{CheckOptions, CheckReport, Extreme, Section, check};
use foliate::path_file::{PathFile, save};
use foliate::scene::PackagePath;
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Proves a path again from its file and the models that it names
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The path file
    #[arg(value_name = "PATH.json")]
    path: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let started = Instant::now();
    let file = save::read(&arguments.path).map_err(|e| Refusal(e.to_string()))?;
    let base = arguments.path.parent().unwrap_or(Path::new(""));
    let report = check(&file, base, packages, &CheckOptions::default())
        .map_err(|e| Refusal(format!("{}: {e}", arguments.path.display())))?;
    let time = started.elapsed();
    match arguments.json {
        true => print_json(&json(&arguments.path, &file, &report, time))?,
        false => print(&text(&arguments.path, &file, &report, time)),
    }
    Ok(if report.passed() { Ending::Done } else { Ending::Failed })
}

fn json(path: &Path, file: &PathFile, report: &CheckReport, time: Duration) -> serde_json::Value {
    json!({
        "file": path.display().to_string(),
        "scene": file.scene,
        "ok": report.passed(),
        "check_ms": time.as_secs_f64() * 1e3,
        "report": report,
    })
}

fn text(path: &Path, file: &PathFile, report: &CheckReport, time: Duration) -> String {
    let mut out = String::new();
    let c = &report.counts;
    let _ = writeln!(
        out,
        "{}: {} of {} knots in {} segments; {} parts, {} shapes",
        path.display(),
        file.scene.escape_debug(),
        c.knots,
        c.segments,
        c.parts,
        c.shapes
    );
    for section in Section::ALL {
        let broken: Vec<_> = report.violations.iter().filter(|v| v.kind.section() == section).collect();
        let verdict = if broken.is_empty() { "ok  " } else { "FAIL" };
        let _ = writeln!(out, "  {verdict} {:<11} {}", section.name(), proven(section, file, report));
        for violation in broken {
            let _ = writeln!(out, "         {violation}");
        }
    }
    for note in &report.notes {
        let _ = writeln!(out, "  note {note}");
    }
    let verdict = match report.violations.len() {
        0 => "proved".to_owned(),
        1 => "1 violation".to_owned(),
        n => format!("{n} violations"),
    };
    let _ = writeln!(out, "{verdict} in {:.2} s", time.as_secs_f64());
    out
}

/// What a section looked at, and the worst that it saw.
fn proven(section: Section, file: &PathFile, report: &CheckReport) -> String {
    let c = &report.counts;
    let worst = |what: &str, extreme: &Option<Extreme>| match extreme {
        Some(e) => format!("; {what} {:.3e} at segment {} t={:.3}, {}", e.value, e.segment, e.t, e.subject),
        None => String::new(),
    };
    match section {
        Section::Documents => {
            let d = &file.documents;
            format!(
                "{} grippers, {} handles, {} surfaces against the models'",
                d.grippers.len(),
                d.handles.len(),
                d.surfaces.len()
            )
        }
        Section::Limits => {
            let nearest = worst("nearest to a limit", &report.nearest_limit);
            format!("joints and roots along the whole motion, objects where they rest{nearest}")
        }
        Section::Knots => "joint knots bit for bit, unit quaternions, times".to_owned(),
        Section::Carriers => {
            let off = worst("farthest", &report.max_off_carrier);
            format!("objects are written where their carriers take them{off}")
        }
        Section::Residuals => {
            let largest = worst("largest", &report.max_residual);
            let (bound, allowed) = (report.residual_bound, file.certificate.path_tolerance);
            format!(
                "grasps, placements, constraints: at most {bound:.1e} between knots, allowed {allowed:.1e}{largest}"
            )
        }
        Section::Clearance => {
            let nearest = worst("nearest", &report.min_clearance);
            let (free, queries) = (c.pairs, c.distance_queries);
            format!("{free} pairs of shapes over the continuum, {queries} distances{nearest}")
        }
        Section::Certificate => {
            let claims = &file.certificate;
            let clearance = claims.min_clearance.map_or("none".to_owned(), |c| format!("{c:.1e} m"));
            format!("claims clearance {clearance}, residual {:.1e}", claims.max_residual)
        }
    }
}
