//! Whether every path that is found passes `check`, which shares as little as possible with the search.

use crate::independent::recheck;
use crate::page::Figure;
use crate::{Result, scenes};
use foliate::check::{CheckOptions, SceneChoice, Verdict, check};
use std::time::Duration;

/// One of so many paths is shown to other people's code.
const SHOWN: u64 = 50;
/// Longest search of a path.
const LIMIT: Duration = Duration::from_secs(20);

pub(crate) fn measure(size: usize) -> Result<Figure> {
    let (scenes, folder, packages) = (scenes::all(usize::MAX), scenes::folder("paths")?, scenes::packages());
    let [mut paths, mut unsolved, mut proved, mut undecided, mut violations, mut distances] = [0_u64; 6];
    let (mut number, mut shown) = (0, Vec::new());
    // A scene that is not solved in time is not asked again and again.
    let mut failures = vec![0_u32; scenes.len()];
    while (paths as usize) < size && failures.iter().any(|&n| n < 5) {
        let at = number % scenes.len();
        number += 1;
        if failures[at] >= 5 {
            continue;
        }
        let scene = &scenes[at];
        let out = folder.join(format!("{}.json", scene.name));
        let Some(file) = scene.path(number as u64, LIMIT, &out)? else {
            unsolved += 1;
            failures[at] += 1;
            continue;
        };
        paths += 1;
        if paths % SHOWN == 1 {
            let kept = folder.join(format!("{}-{number}.json", scene.name));
            std::fs::copy(&out, &kept)?;
            shown.push(kept);
        }
        let options = CheckOptions {
            scene: SceneChoice::Given(scene.name.into()),
            time_limit: Some(Duration::from_secs(120)),
            ..CheckOptions::default()
        };
        let report = check(&file, &folder, &packages, &options)?;
        distances += report.counts.distance_queries;
        match report.verdict() {
            Verdict::Proved => proved += 1,
            Verdict::Undecided => undecided += 1,
            Verdict::Refused | Verdict::Relative(_) => {
                violations += 1;
                let kept = folder.join(format!("refused-{}-{number}.json", scene.name));
                std::fs::copy(&out, &kept)?;
                eprintln!("  refused: {} {:?}", kept.display(), report.violations.first());
            }
        }
        scenes::progress("rechecks", paths as usize, size);
    }
    let how = format!(
        "Paths of {} scenes, one seed after another, each proved again by `foliate check` against its scene.",
        scenes.len()
    );
    let mut figure = Figure::new("Paths, proved again", how);
    figure.row("paths", paths);
    figure.row("not solved within 20 s", unsolved);
    figure.row("proved", proved);
    figure.row("undecided", undecided);
    figure.zero("refused", violations);
    figure.row("distances that were computed", distances);
    recheck(&mut figure, &shown)?;
    Ok(figure)
}
