//! Files with random changes, shown to the readers: the test `fuzz_readers`, for longer.

use crate::Result;
use crate::page::Figure;
use std::process::Command;

pub(crate) fn measure(seconds: usize) -> Result<Figure> {
    let output = Command::new(env!("CARGO"))
        .args([
            "test",
            "--release",
            "-p",
            "foliate",
            "--test",
            "fuzz_readers",
            "--",
            "--nocapture",
            "--test-threads",
            "1",
        ])
        .env("FOLIATE_FUZZ_SECONDS", seconds.to_string())
        .env("FOLIATE_FUZZ_SEED", "12")
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()?;
    let said = String::from_utf8_lossy(&output.stdout);
    let how = format!(
        "{seconds} s for each kind of file: good ones with random changes, as `tests/fuzz_readers.rs` makes them. A find is a panic, more than a \
         second of processor time, or more than 96 MiB for 64 kB."
    );
    let mut figure = Figure::new("Hostile files", how);
    for line in said.lines() {
        // `name: N inputs, at most T and B bytes each`, behind what the test harness says.
        let Some((before, found)) = line.split_once(" inputs, at most ") else { continue };
        let mut words = before.rsplit(": ");
        let (Some(inputs), Some(name)) = (words.next(), words.next()) else { continue };
        let name = name.rsplit(' ').next().unwrap_or(name);
        figure.row(&format!("{name}: inputs; at most"), format!("{inputs}; {}", found.trim_end_matches(" each")));
    }
    if !output.status.success() {
        eprintln!("{said}{}", String::from_utf8_lossy(&output.stderr));
    }
    figure.zero("targets with a find", finds(&said).max(u64::from(!output.status.success())));
    Ok(figure)
}

/// How many tests failed.
fn finds(said: &str) -> u64 {
    let failed = |line: &str| line.starts_with("test ") && line.ends_with("FAILED");
    said.lines().filter(|line| failed(line)).count() as u64
}
