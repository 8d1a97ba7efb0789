//! What a figure has found, and the page that tells all of them.

use foliate::batch::{Machine, today};
use serde_json::{Value, json};
use std::fmt::Write;
use std::process::Command;

/// What was measured.
#[derive(Clone, Debug, Default)]
pub(crate) struct Figure {
    /// The heading.
    pub title: String,
    /// What was done, in a sentence or two.
    pub how: String,
    /// What was found: name and value.
    pub rows: Vec<(String, String)>,
    /// How often a promise was broken.
    pub failures: u64,
    /// How long it took.
    pub seconds: f64,
    /// What was measured.
    pub version: String,
}

impl Figure {
    pub(crate) fn new(title: &str, how: String) -> Self {
        Self { title: title.into(), how, ..Self::default() }
    }

    pub(crate) fn row(&mut self, name: &str, value: impl ToString) {
        self.rows.push((name.into(), value.to_string()));
    }

    /// A row that has to be zero.
    pub(crate) fn zero(&mut self, name: &str, count: u64) {
        self.row(&format!("{name} (promised: 0)"), count);
        self.failures += count;
    }

    pub(crate) fn json(&self) -> Value {
        json!({ "title": self.title, "how": self.how, "rows": self.rows, "failures": self.failures, "seconds": self.seconds,
                "version": self.version })
    }

    pub(crate) fn read(text: &str) -> Option<Self> {
        let value: Value = serde_json::from_str(text).ok()?;
        let word = |value: &Value| value.as_str().map(str::to_owned);
        let rows = value["rows"].as_array()?.iter().map(|row| Some((word(&row[0])?, word(&row[1])?)));
        Some(Self {
            title: word(&value["title"])?,
            how: word(&value["how"])?,
            rows: rows.collect::<Option<_>>()?,
            failures: value["failures"].as_u64()?,
            seconds: value["seconds"].as_f64()?,
            version: word(&value["version"])?,
        })
    }
}

/// Version and commit; with `+` behind it where files have been changed since.
pub(crate) fn version() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let commit = git(&["rev-parse", "--short", "HEAD"]).unwrap_or_else(|| "no commit".into());
    let changed = git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|text| !text.is_empty());
    format!("{} {commit}{}", env!("CARGO_PKG_VERSION"), if changed { "+" } else { "" })
}

/// The page.
pub(crate) fn page(figures: &[Figure], version: &str, options: &str) -> String {
    let build = if cfg!(debug_assertions) { "debug build, whose times say nothing" } else { "release build" };
    let mut out = format!(
        "# Reliability\n\nHow often Foliate fails, and how. Written by a program; do not edit it by hand:\n\n```\ncargo run --profile dist -p \
         foliate_benches --bin reliability{options}\n```\n\nfoliate {version} ({build}); {}; {}.\n",
        Machine::here(),
        today()
    );
    for figure in figures {
        let _ = write!(out, "\n## {}\n\n{}\n\n| | |\n| :-- | --: |\n", figure.title, figure.how);
        for (name, value) in &figure.rows {
            let _ = writeln!(out, "| {name} | {value} |");
        }
        let _ = writeln!(out, "| seconds | {:.0} |", figure.seconds);
        if figure.version != version {
            let _ = writeln!(out, "\nMeasured with foliate {}.", figure.version);
        }
    }
    out
}

/// Values at shares of a sorted list.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let at = (share * sorted.len() as f64) as usize;
    sorted.get(at.min(sorted.len().saturating_sub(1))).copied().unwrap_or(0.0)
}
