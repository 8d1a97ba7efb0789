//! Random problems, whose paths are made to pass thin posts: what a motion that is tested only at samples passes through.

use crate::every_answer::{Fate, examine_among_posts};
use crate::independent::{knows, recheck};
use crate::page::Figure;
use crate::{Result, scenes};
use std::panic::catch_unwind;

/// The first seed: the tests examine those before it.
const FIRST: u64 = 10_000;
/// One of so many proved paths is shown to other people's code.
const SHOWN: u64 = 10;

pub(crate) fn measure(size: usize) -> Result<Figure> {
    let root = scenes::folder("random")?;
    let [mut proved, mut unsolved, mut infeasible, mut refused, mut failed] = [0_u64; 5];
    let mut shown = Vec::new();
    for number in 0..size as u64 {
        let seed = FIRST + number;
        let folder = root.join(seed.to_string());
        let fate = catch_unwind(|| examine_among_posts(seed, &folder).1);
        let mut is_kept = false;
        match fate.unwrap_or_else(|_| Fate::Failed("a panic".into())) {
            Fate::Proved => {
                proved += 1;
                is_kept = proved.is_multiple_of(SHOWN) && knows(&folder)?;
                shown.extend(is_kept.then(|| folder.join("path.json")));
            }
            Fate::Unsolved => unsolved += 1,
            Fate::Infeasible(_) => infeasible += 1,
            Fate::Refused(_) => refused += 1,
            Fate::Failed(why) => {
                failed += 1;
                is_kept = true;
                eprintln!("  failed: {} {why}", folder.display());
            }
        }
        if !is_kept {
            std::fs::remove_dir_all(&folder)?;
        }
        scenes::progress("random", number as usize + 1, size);
    }
    let how = format!(
        "Generated problems (robots, hands, followers, locked joints, margins, up axes, values, furniture; seeds from {FIRST} on), each \
         solved, then solved again among one to four posts of 1 mm that stand 0.6 to 6 mm beside what the first path swept. Every path has to pass \
         `foliate check`, hold its claims where it is sampled densely, answer its problem, and be the same on two threads."
    );
    let mut figure = Figure::new("Random problems among thin posts", how);
    figure.row("problems", size);
    figure.row("proved", proved);
    figure.row("no path within 120 steps", unsolved);
    figure.row("start or goal not free", infeasible);
    figure.row("scene refused", refused);
    figure.zero("something does not hold", failed);
    recheck(&mut figure, &shown)?;
    Ok(figure)
}
