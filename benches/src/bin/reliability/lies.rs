//! Whether `check` accepts a path that was made false.

use crate::page::Figure;
use crate::{Result, scenes};
use foliate::check::{CheckOptions, SceneChoice, Verdict, check};
use foliate::path_file::{PathFile, SegmentEntry};
use rand::RngExt;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::time::Duration;

/// Makes a path false; whether it could.
type Lie = fn(&mut PathFile, &mut ChaCha8Rng) -> bool;

/// Each makes a true path false, whatever the path.
const LIES: [(&str, Lie); 8] = [
    ("a number of the start", |file, random| {
        let Some(knot) = file.segments.first_mut().and_then(|segment| segment.knots.first_mut()) else { return false };
        let at = random.random_range(0..knot.len());
        knot[at] += 0.01;
        true
    }),
    ("a number of the end", |file, random| {
        let Some(knot) = file.segments.last_mut().and_then(|segment| segment.knots.last_mut()) else { return false };
        let at = random.random_range(0..knot.len());
        knot[at] += 0.01;
        true
    }),
    ("a jump between segments", |file, random| {
        if file.segments.len() < 2 {
            return false;
        }
        let at = random.random_range(1..file.segments.len());
        let Some(knot) = file.segments[at].knots.first_mut() else { return false };
        knot[0] += 0.01;
        true
    }),
    ("a motion left out", |file, random| {
        // Without a segment that stands still a path is true: at its knot both of what comes before and after holds.
        let moves = |segment: &SegmentEntry| segment.knots.first() != segment.knots.last();
        let moving: Vec<usize> = (0..file.segments.len()).filter(|&at| moves(&file.segments[at])).collect();
        if moving.len() < 2 {
            return false;
        }
        drop(file.segments.remove(moving[random.random_range(0..moving.len())]));
        true
    }),
    ("a part left out", |file, random| {
        let at = random.random_range(0..file.parts.len());
        drop(file.parts.remove(at));
        true
    }),
    ("wider limits", |file, random| {
        let at = random.random_range(0..file.limits.len());
        let Some(range) = file.limits.values_mut().nth(at) else { return false };
        range[1] += 1.0;
        true
    }),
    ("another sum of a model", |file, _| {
        let sums = file.parts.iter_mut().flat_map(|part| part.sha256.values_mut());
        let changed = sums.take(1).map(|sum| *sum = "0".repeat(64)).count();
        changed > 0
    }),
    ("a clearance that is too large", |file, _| {
        let claimed = file.certificate.min_clearance.as_mut().map(|clearance| *clearance += 1.0);
        claimed.is_some()
    }),
];

pub(crate) fn measure(size: usize) -> Result<Figure> {
    let (scenes, folder, packages) = (scenes::all(usize::MAX), scenes::folder("lies")?, scenes::packages());
    let mut truths = Vec::new();
    for (number, scene) in scenes.iter().enumerate() {
        let out = folder.join(format!("{number}.json"));
        if let Some(file) = scene.path(1, Duration::from_secs(20), &out)? {
            truths.push((scene.name, file));
        }
    }
    if truths.is_empty() {
        return Err("no scene was solved".into());
    }
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let (mut told, mut accepted) = ([0_u64; LIES.len()], [0_u64; LIES.len()]);
    for number in 0..size {
        let (name, truth) = &truths[number % truths.len()];
        let (kind, mut file) = ((number / truths.len()) % LIES.len(), truth.clone());
        if !(LIES[kind].1)(&mut file, &mut random) {
            continue;
        }
        told[kind] += 1;
        let options = CheckOptions {
            scene: SceneChoice::Given((*name).into()),
            time_limit: Some(Duration::from_secs(20)),
            ..CheckOptions::default()
        };
        let is_accepted =
            check(&file, &folder, &packages, &options).is_ok_and(|report| report.verdict() == Verdict::Proved);
        if is_accepted {
            accepted[kind] += 1;
            eprintln!("  accepted: {name}, {}", LIES[kind].0);
        }
        scenes::progress("lies", number + 1, size);
    }
    let how = format!(
        "Paths of {} scenes, each made false in one way, shown to `foliate check` with its scene.",
        truths.len()
    );
    let mut figure = Figure::new("Wrong accepts", how);
    for ((name, _), told) in LIES.iter().zip(told) {
        figure.row(name, told);
    }
    figure.zero("accepted", accepted.iter().sum());
    Ok(figure)
}
