//! The path answers the problem that was drawn: it begins at its start and ends at its goal.

use super::solve::Answer;
use crate::random_scene::RandomScene;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// How far a number may be off: what counts as lying in a state, metres and radians.
const TOLERANCE: f64 = 2e-4;

pub fn answers(scene: &RandomScene, answer: &Answer) -> Result<(), String> {
    let (Some(first), Some(last)) = (answer.file.segments.first(), answer.file.segments.last()) else {
        return Err("goal: the path has no segments".into());
    };
    let (Some(from), Some(to)) = (first.knots.first(), last.knots.last()) else {
        return Err("goal: a segment has no knots".into());
    };
    same(&scene.start, &answer.file.coordinates, from, "start")?;
    same(&scene.goal, &answer.file.coordinates, to, "goal")
}

fn same(wanted: &BTreeMap<String, f64>, names: &[String], knot: &[f64], what: &str) -> Result<(), String> {
    for (name, value) in wanted {
        let Some(index) = names.iter().position(|n| n == name) else { continue };
        let found = knot[index];
        let turned = (found - value).rem_euclid(TAU);
        // An angle may be a full turn off, a quaternion may have the other sign.
        let negated =
            name.rsplit('/').next().is_some_and(|axis| axis.starts_with('q')) && (found + value).abs() < TOLERANCE;
        if (found - value).abs() > TOLERANCE && turned.min(TAU - turned) > TOLERANCE && !negated {
            return Err(format!("{what}: {name} is {found}, {value} is wanted"));
        }
    }
    Ok(())
}
