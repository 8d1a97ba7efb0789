//! Balance: constraints on the centre of mass of parts.

use crate::scene::assemble::names::frame::{Context, ReadFrame, frame, or_start};
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::constraint::{CentreOfMass, CentreOfMassBetween, Constraint, Masses, PlaneRow, Reference, Row};
use foliate_components::robot::{PartIndex, Robot};
use glam::{DVec2, DVec3};

/// Most corners of a support polygon.
const CORNERS: usize = 1000;

/// `centre_of_mass`: fixed in a frame (`value`, `mask`), or above a polygon of its xy plane (`polygon`, `margin`).
pub(crate) fn centre(keys: &mut Keys<'_>, item: &Item<'_>, context: &Context<'_>) -> Result<Constraint, SceneError> {
    let at = frame(&keys.required("frame")?, context.robot)?;
    let masses = masses(keys, item, &at, context.robot)?;
    let rows = match (keys.optional("value"), keys.optional("polygon")) {
        (Some(value), None) => {
            let start = at.in_world(&context.bodies).inverse() * centre_at_start(&masses, context);
            let value = or_start(&value, start, |item| item.array("x y z").map(DVec3::from_array))?;
            fixed(keys, value)?
        }
        (None, Some(polygon)) => {
            let margin = keys.optional("margin").map_or(Ok(0.0), |item| item.distance())?;
            above(&polygon, margin)?
        }
        _ => return Err(item.error("wants either `value` or `polygon`")),
    };
    Ok(Constraint::CentreOfMass(CentreOfMass { masses, frame: at.frame, rows, reference: Reference::Identity }))
}

/// `centre_of_mass_between`: over the line from one frame to another.
pub(crate) fn between(keys: &mut Keys<'_>, item: &Item<'_>, context: &Context<'_>) -> Result<Constraint, SceneError> {
    let first = frame(&keys.required("first")?, context.robot)?;
    let second = frame(&keys.required("second")?, context.robot)?;
    let masses = masses(keys, item, &first, context.robot)?;
    let middle = [first, second].map(|f| f.in_world(&context.bodies).translation.z).iter().sum::<f64>() / 2.0;
    let at_start = centre_at_start(&masses, context).z - middle;
    let height = keys.optional("height").map(|item| or_start(&item, at_start, |item| item.number())).transpose()?;
    let (first, second) = (first.frame, second.frame);
    if first.joint == second.joint {
        return Err(item.error("`first` and `second` are on one body"));
    }
    Ok(Constraint::CentreOfMassBetween(CentreOfMassBetween { masses, first, second, height }))
}

/// The masses of `parts`, by default of the part that carries the frame.
fn masses(keys: &mut Keys<'_>, item: &Item<'_>, at: &ReadFrame, robot: &Robot) -> Result<Masses, SceneError> {
    let parts = match (keys.optional("parts"), at.part) {
        (Some(list), _) => parts(&list, robot)?,
        (None, Some(part)) => vec![(item.clone(), part)],
        (None, None) => return Err(item.error("key `parts` is missing").hint("a frame of the world is on no part")),
    };
    for (item, part) in &parts {
        Masses::of_parts(robot, &[*part]).map_err(|e| item.error(e.to_string()))?;
    }
    let parts: Vec<PartIndex> = parts.into_iter().map(|(_, part)| part).collect();
    Masses::of_parts(robot, &parts).map_err(|e| item.error(e.to_string()))
}

fn parts<'f>(list: &Item<'f>, robot: &Robot) -> Result<Vec<(Item<'f>, PartIndex)>, SceneError> {
    let mut parts: Vec<(Item<'f>, PartIndex)> = Vec::new();
    for item in list.list()? {
        let name = item.string()?;
        let known = || robot.parts.iter().map(|p| p.name.as_str());
        let part = robot.part(name).ok_or_else(|| {
            item.error(format!("there is no part `{}`", quoted(name))).hint(did_you_mean(name, known()))
        })?;
        if parts.iter().any(|(_, p)| *p == part) {
            return Err(item.error("is named a second time"));
        }
        parts.push((item, part));
    }
    match parts.is_empty() {
        true => Err(list.error("is empty").hint("name at least one part")),
        false => Ok(parts),
    }
}

/// Centre of mass in the world where the start has the bodies.
fn centre_at_start(masses: &Masses, context: &Context<'_>) -> DVec3 {
    let weighed = masses.bodies().iter().map(|b| match b.body {
        Some(joint) => context.bodies[joint.at()] * b.center * b.mass,
        None => b.center * b.mass,
    });
    weighed.sum::<DVec3>() / masses.total()
}

/// The components that `mask` names (all by default) keep the value.
fn fixed(keys: &mut Keys<'_>, value: DVec3) -> Result<Vec<PlaneRow>, SceneError> {
    let mask = match keys.optional("mask") {
        Some(item) => {
            let mask = item.flags::<3>("x y z")?;
            if mask == [false; 3] {
                return Err(item.error("no row is asked for"));
            }
            mask
        }
        None => [true; 3],
    };
    let row = |i: usize| PlaneRow { normal: DVec3::AXES[i], offset: value[i], row: Row::Zero };
    Ok((0..3).filter(|&i| mask[i]).map(row).collect())
}

/// One half-space per side of a convex polygon in the xy plane, moved inwards by the margin.
fn above(item: &Item<'_>, margin: f64) -> Result<Vec<PlaneRow>, SceneError> {
    let list = item.list()?;
    if !(3..=CORNERS).contains(&list.len()) {
        return Err(item.error(format!("{} corners are given, 3 to {CORNERS} are read", list.len())));
    }
    let corners: Vec<DVec2> = list.iter().map(|p| p.array("x y").map(DVec2::from_array)).collect::<Result<_, _>>()?;
    let rows = sides(&corners).ok_or_else(|| {
        item.error("is no convex polygon").hint("give its corners in order, counter-clockwise seen from +z")
    })?;
    let rows: Vec<PlaneRow> = rows.into_iter().map(|row| PlaneRow { offset: row.offset + margin, ..row }).collect();
    if rows.iter().try_fold(corners, |left, row| clip(&left, row)).is_none() {
        return Err(item.error(format!("a margin of {margin} leaves nothing of the polygon")));
    }
    Ok(rows)
}

/// The half-planes whose intersection is a convex polygon given counter-clockwise; `None` where it is not.
fn sides(corners: &[DVec2]) -> Option<Vec<PlaneRow>> {
    let next = |i: usize| corners[(i + 1) % corners.len()];
    let sides = (0..corners.len()).map(|i| {
        let inwards = (next(i) - corners[i]).perp().try_normalize()?;
        let row = PlaneRow { normal: inwards.extend(0.0), offset: inwards.dot(corners[i]), row: Row::Inequality };
        // Every corner on the inner side, and not all of them on the border.
        let depths = || corners.iter().map(|&c| inwards.dot(c) - row.offset);
        (depths().all(|d| d > -1e-9) && depths().any(|d| d > 1e-9)).then_some(row)
    });
    sides.collect()
}

/// What of a convex polygon lies on the inner side; `None` where nothing does.
fn clip(corners: &[DVec2], side: &PlaneRow) -> Option<Vec<DVec2>> {
    let depth = |c: DVec2| side.normal.truncate().dot(c) - side.offset;
    let mut left = Vec::with_capacity(corners.len() + 1);
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (da, db) = (depth(a), depth(b));
        if da >= 0.0 {
            left.push(a);
        }
        if (da < 0.0) != (db < 0.0) {
            left.push(a.lerp(b, da / (da - db)));
        }
    }
    (!left.is_empty()).then_some(left)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<DVec2> {
        [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)].map(DVec2::from).to_vec()
    }

    #[test]
    fn the_sides_of_a_polygon_hold_inside_and_only_there() {
        let rows = sides(&square()).unwrap_or_default();
        let least = |p: DVec3| rows.iter().map(|r| r.normal.dot(p) - r.offset).fold(f64::INFINITY, f64::min);
        assert_eq!(rows.len(), 4);
        assert_eq!(least(DVec3::new(0.5, 0.25, 7.0)), 0.25);
        assert_eq!(least(DVec3::new(2.5, 0.5, 0.0)), -0.5);
    }

    #[test]
    fn clockwise_crossed_and_flat_polygons_are_none() {
        let clockwise: Vec<DVec2> = square().into_iter().rev().collect();
        let crossed: Vec<DVec2> = [0, 2, 1, 3].map(|i| square()[i]).to_vec();
        let flat = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)].map(DVec2::from);
        let twice = [(0.0, 0.0), (0.0, 0.0), (2.0, 0.0), (2.0, 1.0)].map(DVec2::from);
        assert!([&clockwise[..], &crossed[..], &flat[..], &twice[..]].iter().all(|p| sides(p).is_none()));
    }

    #[test]
    fn a_margin_beyond_the_middle_leaves_nothing() {
        let moved = |by: f64| {
            let rows = sides(&square()).unwrap_or_default();
            let mut rows = rows.into_iter().map(|r| PlaneRow { offset: r.offset + by, ..r });
            rows.try_fold(square(), |left, row| clip(&left, &row))
        };
        assert!(moved(0.49).is_some());
        assert!(moved(0.51).is_none());
    }
}
