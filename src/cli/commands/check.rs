//! `foliate check`: prove that a path answers its scene.

use crate::check::{CheckOptions, CheckReport, Extreme, SceneChoice, Section, Verdict, check};
use crate::cli::console::loading;
use crate::cli::console::loading::{Cut, Failure};
use crate::cli::console::print::{Ending, Refusal, print, print_json, say};
use crate::path_file::{PathFile, save};
use crate::scene::PackagePath;
use crate::systems::events::StopSignal;
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How much longer than its time limit a check may take to say what it has found, before it is left to itself.
const GRACE: Duration = Duration::from_millis(400);

/// Proves that a path answers its scene, over the continuum
///
/// Exit codes: 0 proved; 1 refused; 2 a file that cannot be read; 3 proved, but only relative to what the file says of
/// itself; 4 undecided within the limits.
#[derive(clap::Args, Clone)]
pub(crate) struct Arguments {
    /// The path file
    #[arg(value_name = "PATH.json")]
    path: PathBuf,
    /// The scene that the path has to answer, shipped or a file; without it the one that the path names
    #[arg(long, value_name = "SCENE", conflicts_with = "no_scene")]
    scene: Option<String>,
    /// Compare the path with its models alone: what is proved is then relative to what the file says
    #[arg(long)]
    no_scene: bool,
    /// Seconds after which what is left counts as undecided; reading is included
    #[arg(long, default_value_t = 600.0, value_name = "S")]
    time_limit: f64,
    /// Distances and residuals after which what is left counts as undecided
    #[arg(long, default_value_t = CheckOptions::default().work_limit, value_name = "N")]
    work_limit: u64,
    /// Print the smallest clearance, proved to a tenth of it or 0.1 mm
    #[arg(long)]
    clearance: bool,
    /// List the pairs of links that are not tested, with the reason
    #[arg(long)]
    pairs: bool,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let started = Instant::now();
    let limit = crate::cli::commands::solve::arguments::deadline(arguments.time_limit)?;
    let (mine, packages) = (arguments.clone(), packages.clone());
    let proved = loading::beside(limit, GRACE, move |stop| proved(&mine, &packages, limit, stop))?;
    let (file, report) = match proved {
        Ok(proved) => proved,
        Err(Cut::OutOfTime) => return out_of_time(arguments, started.elapsed()),
        Err(Cut::Interrupted) => {
            say(&format!("{}: interrupted, nothing is proved\n", arguments.path.display()));
            return Ok(Ending::Interrupted);
        }
    };
    let (time, verdict) = (started.elapsed(), report.verdict());
    match arguments.json {
        true => print_json(&json(&arguments.path, &file, &report, time))?,
        false => print(&text(&arguments.path, &file, &report, time)),
    }
    Ok(match verdict {
        Verdict::Proved => Ending::Done,
        Verdict::Refused => Ending::Failed,
        Verdict::Relative(_) => Ending::Relative,
        Verdict::Undecided => Ending::Undecided,
    })
}

fn proved(
    arguments: &Arguments,
    packages: &PackagePath,
    limit: Duration,
    stop: &StopSignal,
) -> Result<(PathFile, CheckReport), Failure> {
    let started = Instant::now();
    let file = save::read(&arguments.path).map_err(|e| Refusal(e.to_string()))?;
    let base = arguments.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let scene = match &arguments.scene {
        Some(name) => SceneChoice::Given(name.clone()),
        None if arguments.no_scene => SceneChoice::Nothing,
        None => SceneChoice::Named,
    };
    let options = CheckOptions {
        work_limit: arguments.work_limit,
        time_limit: Some(limit.saturating_sub(started.elapsed())),
        scene,
        clearance: arguments.clearance,
        pairs: arguments.pairs,
        cancelled: None,
    };
    let report =
        check(&file, base, &loading::until(packages, stop), &options).map_err(|error| match stop.is_raised() {
            true => Failure::Stopped,
            false => Refusal(format!("{}: {error}", arguments.path.display())).into(),
        })?;
    Ok((file, report))
}

/// The limit ran out while something was read that cannot be interrupted.
fn out_of_time(arguments: &Arguments, time: Duration) -> Result<Ending, Refusal> {
    let (path, why) = (arguments.path.display(), "the time limit was reached while the file or its models were read");
    match arguments.json {
        true => print_json(&json!({
            "file": path.to_string(), "ok": false, "verdict": Verdict::Undecided.name(), "reasons": [why],
            "check_ms": time.as_secs_f64() * 1e3,
        }))?,
        false => print(&format!("{path}: undecided: {why}\n")),
    }
    Ok(Ending::Undecided)
}

fn json(path: &Path, file: &PathFile, report: &CheckReport, time: Duration) -> serde_json::Value {
    let verdict = report.verdict();
    json!({
        "file": path.display().to_string(),
        "scene": file.scene,
        "ok": verdict == Verdict::Proved,
        "verdict": verdict.name(),
        "reasons": report.weaker,
        "check_ms": time.as_secs_f64() * 1e3,
        "report": report,
    })
}

fn text(path: &Path, file: &PathFile, report: &CheckReport, time: Duration) -> String {
    let mut out = String::new();
    let c = &report.counts;
    let _ = writeln!(
        out,
        "{}: {} of {} knots in {} segments (counted from 0; t counts knots); {} parts, {} shapes",
        path.display(),
        file.scene.escape_debug(),
        c.knots,
        c.segments,
        c.parts,
        c.shapes
    );
    for section in Section::ALL {
        let broken: Vec<_> = report.violations.iter().filter(|v| v.kind.section() == section).collect();
        let verdict = match section {
            Section::Scene if report.scene.is_none() => "none",
            _ if broken.is_empty() => "ok  ",
            _ => "FAIL",
        };
        let _ = writeln!(out, "  {verdict} {:<11} {}", section.name(), proven(section, file, report));
        for violation in broken {
            let _ = writeln!(out, "         {violation}");
        }
    }
    for pair in &report.left_out {
        let _ = writeln!(out, "  not tested: {} - {}: {}", pair.first, pair.second, pair.reason.escape_debug());
    }
    for note in &report.notes {
        let _ = writeln!(out, "  note {note}");
    }
    let _ = writeln!(out, "{} in {:.2} s", concluded(report), time.as_secs_f64());
    out
}

fn concluded(report: &CheckReport) -> String {
    let count = report.violations.len();
    match report.verdict() {
        Verdict::Proved => "proved".into(),
        Verdict::Refused => format!("refused: {count} violation{}", if count == 1 { "" } else { "s" }),
        Verdict::Undecided => "undecided".into(),
        Verdict::Relative(reasons) => {
            let reasons: String = reasons.iter().map(|reason| format!("\n  - {reason}")).collect();
            format!("proved only relative to what the file says of itself:{reasons}\nrelative")
        }
    }
}

/// What a section checked, and the worst value that it found.
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
        Section::Timing => {
            let shares = [
                worst("largest share of a velocity limit", &report.max_velocity),
                worst("of an acceleration limit", &report.max_acceleration),
                worst("of a jerk limit", &report.max_jerk),
            ];
            let events = file.events.as_ref().map_or(0, Vec::len);
            let times = report.duration.map_or("no times".to_owned(), |duration| format!("{duration:.3} s"));
            format!("{times}, {events} events{}", shares.concat())
        }
        Section::Carriers => {
            let off = worst("farthest", &report.max_off_carrier);
            format!("objects are written where their carriers take them{off}")
        }
        Section::Residuals => {
            let largest = worst("largest", &report.max_residual);
            let (most, allowed) = (report.residual_bound, file.certificate.path_tolerance);
            format!("grasps, placements, constraints: at most {most:.1e} between knots, allowed {allowed:.1e}{largest}")
        }
        Section::Clearance => {
            let nearest = worst("nearest", &report.min_clearance);
            let least = report.clearance.map_or(String::new(), |c| format!("; nowhere less than {c:.4e} m"));
            format!("{} over the continuum, {} distances{nearest}{least}", tested(report), c.distance_queries)
        }
        Section::Certificate => {
            let claims = &file.certificate;
            let clearance = claims.min_clearance.map_or("none".to_owned(), |c| format!("{c:.1e} m"));
            format!("claims clearance {clearance}, residual {:.1e}", claims.max_residual)
        }
        Section::Scene => match &report.scene {
            Some(name) => {
                let name = name.escape_debug();
                format!("start, goal, models, documents, limits, pairs, grasps and constraints are those of {name}")
            }
            None => "the path was compared with no scene".to_owned(),
        },
    }
}

/// Which pairs were tested, and which were left out.
fn tested(report: &CheckReport) -> String {
    let c = &report.counts;
    let left_out = [
        (c.pairs_of_one_body, "of one body"),
        (c.pairs_of_the_environment, "of the environment"),
        (c.pairs_disabled_by_srdf, "disabled by an SRDF"),
        (c.pairs_adjacent, "of neighbours"),
        (c.pairs_ignored_by_file, "ignored"),
    ];
    let left_out = left_out.iter().filter(|(count, _)| *count > 0).map(|(count, why)| format!("{count} {why}"));
    let left_out: Vec<_> = left_out.collect();
    let left_out = if left_out.is_empty() { "none".to_owned() } else { left_out.join(", ") };
    format!("{} pairs of shapes ({} of them move; not tested: {left_out})", c.pairs, c.pairs_moving)
}
