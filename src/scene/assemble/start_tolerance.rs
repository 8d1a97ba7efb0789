//! `start_tolerance`: how far the start and the goals may be off a state. `projection_tolerance`: how exactly constraints are met.

use crate::scene::reading::error::SceneError;
use crate::scene::reading::keys::Keys;
use foliate_components::problem::{PROJECTION_TOLERANCE, StartTolerance};

/// Most that may be asked, metres: what is farther off is somewhere else.
const FARTHEST: f64 = 0.05;
/// Most that may be asked, radians.
const MOST_ANGLE: f64 = 0.2;
/// Largest residual that may be asked for, metres and radians: objects that are carried are then less than 1e-5 off their carriers.
pub(crate) const MOST_RESIDUAL: f64 = 5e-6;

pub(super) fn read(keys: &mut Keys<'_>) -> Result<StartTolerance, SceneError> {
    let usual = StartTolerance::default();
    let Some(item) = keys.optional("start_tolerance") else { return Ok(usual) };
    let mut keys = item.keys()?;
    let mut value = |key, usual: f64, most: f64, unit: &str| -> Result<f64, SceneError> {
        let Some(item) = keys.optional(key) else { return Ok(usual) };
        match item.distance()? {
            value if value > most => Err(item
                .error(format!("{value} is more than {most} {unit}"))
                .hint("a pose that is so far off is another one: correct it in `start` or `goal`")),
            value => Ok(value),
        }
    };
    let distance = value("distance", usual.distance, FARTHEST, "metres")?;
    let angle = value("angle", usual.angle, MOST_ANGLE, "radians")?;
    keys.finish()?;
    Ok(StartTolerance { distance, angle })
}

pub(super) fn projection(keys: &mut Keys<'_>) -> Result<f64, SceneError> {
    let Some(item) = keys.optional("projection_tolerance") else { return Ok(PROJECTION_TOLERANCE) };
    match item.distance()? {
        value if (PROJECTION_TOLERANCE..=MOST_RESIDUAL).contains(&value) => Ok(value),
        value => Err(item
            .error(format!(
                "{value:e} is not between {PROJECTION_TOLERANCE:e} and {MOST_RESIDUAL:e} (metres and radians)"
            ))
            .hint("objects in a hand are to be within 1e-5 of where it carries them, in each direction and together")),
    }
}
