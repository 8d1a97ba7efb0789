//! Regenerates `docs/reliability.md`: how often Foliate fails, and how.
//!
//! `cargo run --profile dist -p foliate_benches --bin reliability [-- --quick] [--percent P] [--only FIGURE] [--reuse] [--out FILE]`. Each figure is a module with a
//! size, of which `--percent` takes a share; what it found is kept in `target/reliability/` under the version and the size, so that a run that was stopped goes on with
//! the figures that are missing; `--reuse` takes also those of other versions, and the page tells which. `--quick` is a smoke test of three minutes, whose page goes to `target/reliability/quick.md`.
#![forbid(unsafe_code)]

mod coal;
mod deadlines;
mod determinism;
#[path = "../../../../tests/common/every_answer/mod.rs"]
mod every_answer;
mod fuzz;
mod independent;
mod lies;
mod page;
mod random;
#[path = "../../../../tests/common/random_scene/mod.rs"]
mod random_scene;
mod rechecks;
mod scenes;
mod soak;

use page::Figure;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub(crate) type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A figure: name, how large it is in full and in short, and how it is made.
type Entry = (&'static str, usize, usize, fn(usize) -> Result<Figure>);

const FIGURES: [Entry; 8] = [
    ("deadlines", 10_000, 60, deadlines::measure),
    ("rechecks", 10_000, 24, rechecks::measure),
    ("random", 3_000, 12, random::measure),
    ("lies", 2_000, 96, lies::measure),
    ("determinism", 20, 1, determinism::measure),
    ("coal", 1_000_000, 5_000, coal::measure),
    ("fuzz", 20, 1, fuzz::measure),
    ("soak", 100_000, 200, soak::measure),
];

fn main() -> Result<()> {
    let (mut quick, mut reuse, mut only, mut out, mut percent) = (false, false, None, None, 100);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--quick" => quick = true,
            "--reuse" => reuse = true,
            "--only" => only = Some(arguments.next().ok_or("--only FIGURE")?),
            "--percent" => {
                percent = arguments.next().and_then(|p| p.parse().ok()).ok_or("--percent P, a whole number")?
            }
            "--out" => out = Some(PathBuf::from(arguments.next().ok_or("--out FILE")?)),
            other => return Err(format!("`{other}` is not understood").into()),
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = root.join("target/reliability");
    std::fs::create_dir_all(&folder)?;
    let version = page::version();
    let mut figures = Vec::new();
    for (name, full, short, measure) in FIGURES {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        let size = if quick { short } else { (full * percent / 100).max(1) };
        let kept =
            folder.join(format!("{name}-{size}-{}.json", version.replace(|c: char| !c.is_ascii_alphanumeric(), "_")));
        // Changed code without a commit is measured anew.
        let known = std::fs::read_to_string(&kept).ok().filter(|_| !version.ends_with("+"));
        let known = known.and_then(|text| Figure::read(&text));
        let known = known.or_else(|| if reuse { latest(&folder, &format!("{name}-{size}-")) } else { None });
        let figure = match known {
            Some(figure) => figure,
            None => {
                eprintln!("{name}: {size}");
                let started = Instant::now();
                let mut figure = measure(size)?;
                figure.seconds = started.elapsed().as_secs_f64();
                figure.version.clone_from(&version);
                foliate::output::write(&kept, figure.json().to_string().as_bytes())?;
                figure
            }
        };
        eprintln!("{name}: {:.0} s", figure.seconds);
        figures.push(figure);
    }
    let out = out.unwrap_or_else(|| match quick || only.is_some() {
        true => folder.join("quick.md"),
        false => root.join("docs/reliability.md"),
    });
    let options = match (quick, percent) {
        (true, _) => " -- --quick".to_owned(),
        (false, 100) => String::new(),
        (false, _) => format!(" -- --percent {percent}"),
    };
    if let Some(parent) = out.parent() {
        std::fs::create_dir_all(parent)?;
    }
    foliate::output::write(&out, page::page(&figures, &version, &options).as_bytes())?;
    println!("{}", out.display());
    let failed = figures.iter().any(|figure| figure.failures > 0);
    if failed { Err("some figures are not what is promised; the page tells which".into()) } else { Ok(()) }
}

/// The figure that was kept last under a name that begins so, of whatever version without changes.
fn latest(folder: &Path, begin: &str) -> Option<Figure> {
    let entries = std::fs::read_dir(folder).ok()?.flatten();
    let figures = entries.filter_map(|entry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        let when = entry.metadata().and_then(|data| data.modified()).ok()?;
        let figure = Figure::read(&std::fs::read_to_string(entry.path()).ok()?)?;
        (name.starts_with(begin) && !figure.version.ends_with('+')).then_some((when, figure))
    });
    figures.max_by_key(|(when, _)| *when).map(|(_, figure)| figure)
}
