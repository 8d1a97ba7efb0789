//! How fast are first paths of MotionBenchMaker's problems, certified on the robot's published meshes?
//!
//! `cargo run --profile dist -p foliate_benches --bin motionbenchmaker -- FILE.json[.gz]`; `--help` lists the options. One thread, first
//! paths. A solve counts from the prepared model (scene read, tables of pairs and constraint graph built) to the certified path;
//! reading and building have columns of their own. `benches/README.md` describes the file.
#![forbid(unsafe_code)]

use foliate::batch::{Seeds, SeedsError};
use foliate::output;
use foliate::scene::{MeshCache, PackagePath};
use foliate_benches::motionbenchmaker::file::{ProblemRecord, ProblemSets};
use foliate_benches::motionbenchmaker::run::{Ready, Row, Settings};
use foliate_benches::motionbenchmaker::scene::{RobotFiles, SceneWriter, WrittenScene};
use foliate_benches::motionbenchmaker::table;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

const USAGE: &str = "usage: motionbenchmaker FILE.json[.gz] [OPTION ...]

  --urdf NAME         the robot's URDF, a path or package:// URL (default: by the file's robot; known: panda)
  --srdf NAME         its SRDF
  --packages DIR      where packages are; may be repeated (also FOLIATE_PACKAGE_PATH)
  --sets A,B          only these sets
  --every N           every Nth problem of a set
  --seeds A..B        seeds (default 1..1)
  --time-limit S      seconds of a search (default 10)
  --csv FILE          a line per solve
  --scenes DIR        keeps the scenes there
  --paths DIR         writes the path files there, and the scenes, where --scenes says nothing else
  --check             proves each path again by the independent checker";

struct Options {
    file: PathBuf,
    robot: Option<RobotFiles>,
    srdf: Option<String>,
    packages: Vec<PathBuf>,
    sets: Option<Vec<String>>,
    every: usize,
    seeds: RangeInclusive<u64>,
    csv: Option<PathBuf>,
    scenes: Option<PathBuf>,
    settings: Settings,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|argument| argument == "--help" || argument == "-h") {
        println!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    let done = read(arguments).map_err(|error| format!("{error}\n{USAGE}")).and_then(|options| measure(&options));
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn read(arguments: Vec<String>) -> Result<Options, String> {
    let settings = Settings { time_limit: Duration::from_secs(10), paths: None, check: false };
    let mut options = Options {
        file: PathBuf::new(),
        robot: None,
        srdf: None,
        packages: Vec::new(),
        sets: None,
        every: 1,
        seeds: 1..=1,
        csv: None,
        scenes: None,
        settings,
    };
    let mut arguments = arguments.into_iter();
    while let Some(argument) = arguments.next() {
        if argument == "--check" {
            options.settings.check = true;
            continue;
        }
        if !argument.starts_with("--") {
            if !options.file.as_os_str().is_empty() {
                return Err(format!("`{argument}`: one file at a time"));
            }
            options.file = argument.into();
            continue;
        }
        let value = arguments.next().ok_or_else(|| format!("{argument} wants a value"))?;
        let wrong = |what: &str| format!("{argument} {value}: {what}");
        match argument.as_str() {
            "--urdf" => options.robot = Some(RobotFiles { urdf: from_here(value), srdf: None }),
            "--srdf" => options.srdf = Some(from_here(value)),
            "--packages" => options.packages.push(value.into()),
            "--sets" => options.sets = Some(value.split(',').map(str::to_owned).collect()),
            "--every" => {
                options.every = value.parse().ok().filter(|&n| n > 0).ok_or_else(|| wrong("is no number above 0"))?;
            }
            "--seeds" => {
                let seeds: Seeds = value.parse().map_err(|why: SeedsError| wrong(&why.to_string()))?;
                options.seeds = seeds.first()..=seeds.first() + (seeds.count() - 1);
            }
            "--time-limit" => {
                let limit = value.parse().ok().and_then(|s| Duration::try_from_secs_f64(s).ok());
                options.settings.time_limit = limit.ok_or_else(|| wrong("is no number of seconds"))?;
            }
            "--csv" => options.csv = Some(value.into()),
            "--scenes" => options.scenes = Some(value.into()),
            "--paths" => options.settings.paths = Some(value.into()),
            _ => return Err(format!("there is no option `{argument}`")),
        }
    }
    if options.file.as_os_str().is_empty() { Err("which file?".into()) } else { Ok(options) }
}

/// A file's path from where the program runs, as scenes in other folders can name it; URLs stay.
fn from_here(name: String) -> String {
    let is_file = !name.contains("://");
    std::path::absolute(&name).ok().filter(|_| is_file).map_or(name, |path| path.display().to_string())
}

/// Whether all that is feasible was solved.
fn measure(options: &Options) -> Result<bool, String> {
    let sets = ProblemSets::read(&options.file)?;
    let chosen = chosen(&sets, options)?;
    let robot = options.robot.clone().or_else(|| RobotFiles::known(&sets.robot));
    let robot = robot.ok_or_else(|| {
        format!("no description of the robot `{}` is known; give it by --urdf and --srdf", sets.robot.escape_debug())
    })?;
    let robot = RobotFiles { srdf: options.srdf.clone().or(robot.srdf), ..robot };
    let packages = PackagePath::from_environment(&options.packages).with_mesh_cache(MeshCache::of_user());
    foliate_benches::one_thread();
    // Path files name the obstacles of their scene, which have to stay with them.
    let folder = Folder::new(options.scenes.as_deref().or(options.settings.paths.as_deref()))?;
    if let Some(paths) = &options.settings.paths {
        make(paths)?;
    }
    let writer = SceneWriter::new(robot, &packages).map_err(|error| error.to_string())?;
    let mut rows: Vec<Row> = Vec::new();
    let (mut left_out, mut moved) = (BTreeMap::<String, usize>::new(), BTreeMap::<String, usize>::new());
    for (set, problem) in &chosen {
        let name = format!("{}-{:04}", file_name(set), problem.index);
        let written = writer.write(problem, &name, &folder.path)?;
        written.left_out.iter().for_each(|joint| *left_out.entry(joint.clone()).or_default() += 1);
        written.moved.iter().for_each(|(joint, _)| *moved.entry(joint.clone()).or_default() += 1);
        rows.extend(solved(set, problem, &written, options, &packages)?);
    }
    println!("{}", table::markdown(&rows));
    said("joints of starts that the robot's description fixes or has follow another", &left_out);
    said("values that were moved onto the nearest bound", &moved);
    if let Some(path) = &options.csv {
        output::write(path, table::csv(&rows).as_bytes()).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(rows.iter().all(|row| row.is_infeasible() || (row.is_solved() && row.verdict.is_none_or(|v| v == "proved"))))
}

fn solved(
    set: &str,
    problem: &ProblemRecord,
    written: &WrittenScene,
    options: &Options,
    packages: &PackagePath,
) -> Result<Vec<Row>, String> {
    // A model keeps what searches have compiled: each solve has a new one.
    let solve = |seed| Ready::new(written, packages)?.solve((set, problem.index, seed), &options.settings, packages);
    let rows = options.seeds.clone().map(solve).collect::<Result<Vec<_>, _>>()?;
    for row in rows.iter().filter(|row| !row.is_solved()) {
        eprintln!("{set} {} seed {}: {} {}", row.index, row.seed, row.outcome, row.detail);
    }
    Ok(rows)
}

/// Problems with their sets, as the options choose them.
fn chosen<'a>(sets: &'a ProblemSets, options: &Options) -> Result<Vec<(&'a str, &'a ProblemRecord)>, String> {
    let names: Vec<&str> = sets.sets.keys().map(String::as_str).collect();
    if let Some(unknown) = options.sets.iter().flatten().find(|name| !names.contains(&name.as_str())) {
        return Err(format!("--sets {unknown}: the file has {}", names.join(", ")));
    }
    let wanted = |name: &str| options.sets.as_ref().is_none_or(|sets| sets.iter().any(|wanted| wanted == name));
    let of_set = |(name, problems): (&'a String, &'a Vec<ProblemRecord>)| {
        problems.iter().step_by(options.every).map(|problem| (name.as_str(), problem)).collect::<Vec<_>>()
    };
    Ok(sets.sets.iter().filter(|(name, _)| wanted(name)).flat_map(of_set).collect())
}

fn said(what: &str, joints: &BTreeMap<String, usize>) {
    if !joints.is_empty() {
        let joints: Vec<String> = joints.iter().map(|(joint, times)| format!("{joint} ({times} times)")).collect();
        println!("{what}: {}", joints.join(", "));
    }
}

/// A set's name as part of the name of a file.
fn file_name(set: &str) -> String {
    set.chars().take(100).map(|c| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' }).collect()
}

fn make(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))
}

/// Where scenes are, for as long as they are needed.
struct Folder {
    path: PathBuf,
    is_kept: bool,
}

impl Folder {
    fn new(kept: Option<&Path>) -> Result<Self, String> {
        let own = || std::env::temp_dir().join(format!("foliate-motionbenchmaker-{}", std::process::id()));
        let path = kept.map_or_else(own, Path::to_owned);
        make(&path)?;
        Ok(Self { path, is_kept: kept.is_some() })
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if !self.is_kept {
            // What is left of a temporary folder does no harm.
            let _ = std::fs::remove_dir_all(&self.path);
        }
    }
}
