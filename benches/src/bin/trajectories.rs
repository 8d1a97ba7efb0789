//! Times geometric paths for the comparison with toppra (`benches/peers/toppra`): reads one JSON object per line from the standard
//! input, a path and its limits, and writes one per line.

use foliate_kernels::trajectory::{Limits, Spline, TimedPath, TimingScratch, TimingSettings, time_optimal};
use serde_json::{Value, json};
use std::io::BufRead;
use std::time::Instant;

/// How often each path is timed; the median counts.
const REPEATS: usize = 21;

fn numbers(line: &Value, key: &str) -> Result<Vec<f64>, String> {
    let list = line[key].as_array().ok_or_else(|| format!("`{key}` is no list"))?;
    list.iter().map(|x| x.as_f64().ok_or_else(|| format!("`{key}` has something that is no number"))).collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut scratch, mut out) = (TimingScratch::default(), TimedPath::default());
    for line in std::io::stdin().lock().lines() {
        let line: Value = serde_json::from_str(&line?)?;
        let (velocity, acceleration) = (numbers(&line, "velocity")?, numbers(&line, "acceleration")?);
        let size = velocity.len();
        let path = Spline::from_parts(
            size,
            numbers(&line, "parameters")?,
            numbers(&line, "knots")?,
            numbers(&line, "derivatives")?,
        )?;
        let jerk = vec![f64::INFINITY; size];
        let limits = Limits { velocity: &velocity, acceleration: &acceleration, jerk: &jerk };
        let mut seconds = [0.0; REPEATS];
        let mut report = Default::default();
        for seconds in &mut seconds {
            let start = Instant::now();
            report = time_optimal(&path, limits, TimingSettings::default(), &mut scratch, &mut out)?;
            *seconds = start.elapsed().as_secs_f64();
        }
        seconds.sort_by(f64::total_cmp);
        let knots: Vec<&[f64]> = (0..out.curve.len()).map(|k| out.curve.knot(k)).collect();
        let velocities: Vec<&[f64]> = (0..out.curve.len()).map(|k| out.curve.velocity(k)).collect();
        let answer = json!({
            "seconds": seconds[REPEATS / 2],
            "intervals": report.intervals,
            "times": out.curve.parameters(),
            "knots": knots,
            "velocities": velocities,
        });
        println!("{answer}");
    }
    Ok(())
}
