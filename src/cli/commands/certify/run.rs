//! Runs `foliate certify`: its options, the certification, the report.

use crate::certify::formats::{Format, ReadOptions, read};
use crate::certify::{Certifier, CertifyOptions, CertifyReport, Interpolation, Turns};
use crate::cli::commands::certify::arguments::{attachments, rates, start, touch};
use crate::cli::commands::certify::text;
use crate::cli::commands::certify::text::Spent;
use crate::cli::console::loading::Cut;
use crate::cli::console::print::{Ending, Refusal, print, print_json, say};
use crate::cli::console::{interrupt, loading, processor_time};
use crate::kernels::collision::CollisionScratch;
use crate::kernels::lanes::Level;
use crate::scene::{PackagePath, Scene};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Proves that motions are free of collision and within limits, or says where they first are not
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Trajectories, or folders of them
    #[arg(value_name = "MOTION", required = true)]
    motions: Vec<PathBuf>,
    /// The world: a shipped scene's name, or a scene file; everything stands as at its start
    #[arg(long, value_name = "SCENE")]
    scene: String,
    /// Names of the columns, for files without names: `part/joint`, or a joint's bare name where only one part has it
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    joints: Option<Vec<String>>,
    /// How the motion is written, instead of as the file looks
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<Format>,
    /// How to go from point to point
    #[arg(long, value_enum, default_value_t = Interpolation::Auto, value_name = "HOW")]
    interpolation: Interpolation,
    /// Which way joints without limits turn
    #[arg(long, value_enum, default_value_t = Turns::Format, value_name = "WAY")]
    turns: Turns,
    /// A joint that the motion does not move stands at this value, instead of as at the scene's start; may be given several times
    #[arg(long, value_name = "JOINT=VALUE", allow_hyphen_values = true)]
    start: Vec<String>,
    /// From a time on a link carries an object (a part with a free root), from where it is then; may be given several times
    #[arg(long, value_name = "OBJECT@LINK[:TIME]")]
    attach: Vec<String>,
    /// From a time on an object stays where it is then
    #[arg(long, value_name = "OBJECT[:TIME]")]
    detach: Vec<String>,
    /// Two links (or parts) that may touch and overlap: not tested
    #[arg(long, value_name = "A,B")]
    touch: Vec<String>,
    /// Velocity limits of the models times a number, or a joint's own limit (rad/s, m/s); may be given several times
    #[arg(long, value_name = "FACTOR|JOINT=LIMIT")]
    velocity_limit: Vec<String>,
    /// An acceleration limit of all joints, or of one (rad/s², m/s²); may be given several times
    #[arg(long, value_name = "LIMIT|JOINT=LIMIT")]
    acceleration_limit: Vec<String>,
    /// Find the least clearance, within 10 % or 0.1 mm, and where it is
    #[arg(long)]
    clearance: bool,
    /// Seconds after which to give up, loading included; what is then left is undecided
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    time_limit: f64,
    /// JSON, one object a motion, instead of text
    #[arg(long)]
    json: bool,
    /// What `--simd` says, or the best that this machine has.
    #[arg(skip)]
    pub(crate) level: Level,
}

/// How it went with one motion.
struct Answer {
    result: Result<CertifyReport, String>,
    read: Duration,
    spent: Spent,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let started = Instant::now();
    let limit = crate::cli::commands::solve::arguments::deadline(arguments.time_limit)?;
    let (name, mine) = (arguments.scene.clone(), packages.clone());
    let scene = match loading::beside(limit, Duration::ZERO, move |stop| {
        Ok(Scene::load(&name, &loading::until(&mine, stop))?)
    })? {
        Ok(scene) => scene,
        Err(Cut::Interrupted) => return Ok(Ending::Interrupted),
        Err(Cut::OutOfTime) => {
            say(&format!("{}: undecided: the time limit was reached while the scene was read\n", arguments.scene));
            return Ok(Ending::Undecided);
        }
    };
    for warning in &scene.warnings {
        say(&format!("warning: {warning}\n"));
    }
    let mut problem = scene.problem;
    start(&mut problem, &arguments.start)?;
    let touch = touch(&arguments.touch)?;
    let certifier = Certifier::new(&problem, &touch).map_err(|e| Refusal(format!("--touch: {e}")))?;
    let options = CertifyOptions {
        attachments: attachments(&arguments.attach, &arguments.detach)?,
        rates: rates(certifier.robot(), &arguments.velocity_limit, &arguments.acceleration_limit)?,
        clearance: arguments.clearance,
        ..CertifyOptions::default()
    };
    let motions = files(&arguments.motions)?;
    let many = motions.len() > 1;
    let loaded = started.elapsed();
    let mut scratch = CollisionScratch::at_level(arguments.level);
    let (mut worst, token) = (Ending::Done, interrupt::token());
    let mut refusals = 0;
    for motion in &motions {
        let go_on = || started.elapsed() < limit && !token.is_cancelled();
        let answer = one(arguments, &certifier, motion, &options, &mut scratch, &go_on);
        if token.is_cancelled() {
            say(&format!("interrupted at {}\n", motion.display()));
            return Ok(Ending::Interrupted);
        }
        match (&answer.result, many) {
            (Err(message), false) => return Err(Refusal(message.clone())),
            (Err(_), true) => refusals += 1,
            (Ok(report), _) => worst = worse(worst, report),
        }
        match arguments.json {
            true => print_json(&as_json(arguments, motion, &answer, loaded))?,
            false if many => print(&text::line(motion, &answer.result, answer.spent)),
            false => print(&text::page(motion, &arguments.scene, &answer.result, answer.spent)),
        }
    }
    match refusals {
        0 => Ok(worst),
        _ => Err(Refusal(format!("{refusals} of {} motions cannot be read", motions.len()))),
    }
}

fn one(
    arguments: &Arguments,
    certifier: &Certifier,
    path: &Path,
    options: &CertifyOptions,
    scratch: &mut CollisionScratch,
    go_on: &dyn Fn() -> bool,
) -> Answer {
    let how = ReadOptions {
        format: arguments.format,
        joints: arguments.joints.clone(),
        interpolation: arguments.interpolation,
        turns: arguments.turns,
    };
    let started = Instant::now();
    let motion = read(path, certifier.robot(), &how);
    let read = started.elapsed();
    let (started, before) = (Instant::now(), processor_time::of_this_thread());
    let result = motion.map_err(|e| e.to_string()).and_then(|motion| {
        let report = certifier.certify_while(&motion, options, scratch, go_on);
        report.map_err(|e| format!("{}: {e}", path.display()))
    });
    let spent = Spent { wall: started.elapsed(), processor: processor_time::since(before) };
    Answer { result, read, spent }
}

/// A failure outweighs what is undecided.
fn worse(so_far: Ending, report: &CertifyReport) -> Ending {
    match so_far {
        Ending::Failed => Ending::Failed,
        _ if report.failed() => Ending::Failed,
        so_far if report.passed() => so_far,
        _ => Ending::Undecided,
    }
}

/// Most files of one call.
const FILES: usize = 1_000_000;

/// The files, and those of folders in order of their names.
fn files(named: &[PathBuf]) -> Result<Vec<PathBuf>, Refusal> {
    let mut files = Vec::new();
    for path in named {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let fail = |e: std::io::Error| Refusal(format!("{}: {e}", path.display()));
        let mut inside = Vec::new();
        for entry in std::fs::read_dir(path).map_err(fail)? {
            let entry = entry.map_err(fail)?.path();
            if entry.is_file() {
                inside.push(entry);
            }
            if inside.len() > FILES {
                return Err(Refusal(format!("{}: more than {FILES} files", path.display())));
            }
        }
        inside.sort();
        files.append(&mut inside);
    }
    match files.is_empty() {
        true => Err(Refusal(String::from("there is no motion in the folder"))),
        false => Ok(files),
    }
}

fn as_json(arguments: &Arguments, path: &Path, answer: &Answer, loaded: Duration) -> serde_json::Value {
    let ms = |d: Duration| d.as_secs_f64() * 1e3;
    let (report, error) = match &answer.result {
        Ok(report) => (Some(report), None),
        Err(message) => (None, Some(message)),
    };
    json!({
        "file": path.display().to_string(),
        "scene": arguments.scene,
        "ok": report.is_some_and(CertifyReport::passed),
        "error": error,
        "report": report,
        "load_ms": ms(loaded),
        "read_ms": ms(answer.read),
        "certify_ms": ms(answer.spent.wall),
        "certify_processor_ms": answer.spent.processor.map(ms),
    })
}
