//! Reads what varies: `[vary]` of a suite file.

use crate::batch::vary::options::{MovedPart, Obstacles, SizedPart, Span, Vary, Which};
use crate::scene::reading::error::SceneError;
use crate::scene::reading::keys::{Item, Keys};
use std::f64::consts::PI;

/// Most objects or obstacles.
const MOST: u64 = 100;

/// The table `vary`.
pub(crate) fn vary(item: &Item<'_>) -> Result<Vary, SceneError> {
    let mut keys = item.keys()?;
    let instances = keys.required("instances")?.whole(1..=1_000_000)?;
    let seed = keys.optional("seed").map_or(Ok(1), |item| item.whole(0..=1 << 53))?;
    let mut vary = Vary::new(instances, seed);
    if let Some(item) = keys.optional("tries") {
        vary.tries = item.whole(1..=1_000_000)? as u32;
    }
    vary.starts = which(keys.optional("starts"))?;
    vary.goals = which(keys.optional("goals"))?;
    vary.any_face = keys.optional("any_face").map_or(Ok(false), |item| item.boolean())?;
    vary.within = within(keys.optional("within"))?;
    vary.objects = keys.optional("objects").map(|item| counts(&item, 1)).transpose()?;
    vary.moves = of_list(keys.optional("move"), moved)?;
    vary.sizes = of_list(keys.optional("size"), sized)?;
    vary.obstacles = keys.optional("obstacles").map(|item| obstacles(&item)).transpose()?;
    keys.finish()?;
    Ok(vary)
}

fn of_list<T>(item: Option<Item<'_>>, read: impl Fn(&Item<'_>) -> Result<T, SceneError>) -> Result<Vec<T>, SceneError> {
    item.map_or_else(|| Ok(Vec::new()), |item| item.list()?.iter().map(read).collect())
}

/// `true`: all, `false`: none; or a list of names.
fn which(item: Option<Item<'_>>) -> Result<Which, SceneError> {
    let Some(item) = item else { return Ok(Which::None) };
    if item.is_list() {
        let names = item.list()?.iter().map(|name| Ok(name.string()?.to_owned())).collect::<Result<_, SceneError>>()?;
        return Ok(Which::These(names));
    }
    Ok(if item.boolean()? { Which::All } else { Which::None })
}

fn within(item: Option<Item<'_>>) -> Result<[Option<Span>; 3], SceneError> {
    let Some(item) = item else { return Ok([None; 3]) };
    let mut keys = item.keys()?;
    let mut spans = [None; 3];
    for (span, axis) in spans.iter_mut().zip(["x", "y", "z"]) {
        *span = keys.optional(axis).map(|item| item.bounds()).transpose()?;
    }
    keys.finish()?;
    Ok(spans)
}

/// From fewest to most: `[1, 3]`, or `2`.
fn counts(item: &Item<'_>, fewest: u64) -> Result<(usize, usize), SceneError> {
    if !item.is_list() {
        let count = item.whole(fewest..=MOST)? as usize;
        return Ok((count, count));
    }
    let counts = item.list()?;
    let [low, high] = counts.as_slice() else { return Err(item.error("wants two numbers, fewest and most")) };
    let (low, high) = (low.whole(fewest..=MOST)? as usize, high.whole(fewest..=MOST)? as usize);
    if low > high { Err(item.error(format!("{low} is more than {high}"))) } else { Ok((low, high)) }
}

/// Spans along x, y and z, and the turn about the vertical.
fn spans(keys: &mut Keys<'_>, turn: Span) -> Result<([Span; 3], Span), SceneError> {
    let mut shift = [(0.0, 0.0); 3];
    for (span, axis) in shift.iter_mut().zip(["x", "y", "z"]) {
        if let Some(item) = keys.optional(axis) {
            *span = item.bounds()?;
        }
    }
    Ok((shift, keys.optional("turn").map_or(Ok(turn), |item| item.bounds())?))
}

fn moved(item: &Item<'_>) -> Result<MovedPart, SceneError> {
    let mut keys = item.keys()?;
    let part = keys.required("part")?.string()?.to_owned();
    let (shift, turn) = spans(&mut keys, (0.0, 0.0))?;
    keys.finish()?;
    Ok(MovedPart { part, shift, turn })
}

fn sized(item: &Item<'_>) -> Result<SizedPart, SceneError> {
    let mut keys = item.keys()?;
    let part = keys.required("part")?.string()?.to_owned();
    let factor = positive(&keys.required("factor")?)?;
    keys.finish()?;
    Ok(SizedPart { part, factor })
}

fn obstacles(item: &Item<'_>) -> Result<Obstacles, SceneError> {
    let mut keys = item.keys()?;
    let count = counts(&keys.required("count")?, 0)?;
    let sides = keys.required("sides")?.list()?.iter().map(positive).collect::<Result<Vec<_>, _>>()?;
    let sides = <[Span; 3]>::try_from(sides).map_err(|_| item.error("wants `sides` of three spans, x y z"))?;
    let (middle, turn) = spans(&mut keys, (-PI, PI))?;
    keys.finish()?;
    Ok(Obstacles { count, sides, middle, turn })
}

fn positive(item: &Item<'_>) -> Result<Span, SceneError> {
    match item.bounds()? {
        (low, _) if low <= 0.0 => Err(item.error(format!("{low} is not above 0"))),
        span => Ok(span),
    }
}
