//! All grasps of a box, a cylinder and a sphere with two jaws.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::FoundGripper;
use crate::setup::handles::handle::{FoundHandle, Jaws, ROOM, TURNS, frame};
use crate::setup::objects::RigidObject;
use foliate_components::Pose;
use foliate_components::robot::shape::Geometry;
use glam::{DQuat, DVec3};
use std::f64::consts::{SQRT_2, TAU};

/// Beyond this length, metres, a solid is held near its ends too.
const LONG: f64 = 0.12;
/// How far from the end of a long solid, metres.
const FROM_END: f64 = 0.03;

/// Closing directions about the axis of a cylinder.
const AROUND: usize = 8;

const AXES: [(DVec3, &str); 3] = [(DVec3::X, "x"), (DVec3::Y, "y"), (DVec3::Z, "z")];

/// The grasps of an object of one solid; none of an object of another kind.
pub(super) fn families(object: &RigidObject, gripper: &FoundGripper) -> Option<Vec<FoundHandle>> {
    let jaws = Jaws::of(gripper.kind)?;
    let [(X_LS, solid)] = object.shapes.as_slice() else { return None };
    let mut found = match solid {
        Geometry::Box { half_extents } => on_box(*half_extents, &jaws),
        Geometry::Cylinder { radius, half_length } => on_cylinder(*radius, *half_length, &jaws),
        Geometry::Sphere { radius } => on_sphere(*radius, &jaws),
        Geometry::Capsule { .. } | Geometry::Mesh(_) => return None,
    };
    if jaws.one_moves {
        found = found.into_iter().flat_map(|handle| without_turn(handle, solid, &jaws)).collect();
    }
    for handle in &mut found {
        handle.link_from_handle = *X_LS * handle.link_from_handle;
    }
    Some(found)
}

/// What turns about an axis that is not the closing direction cannot lie against a fixed jaw wherever it is turned: single turns of it.
fn without_turn(handle: FoundHandle, solid: &Geometry, jaws: &Jaws) -> Vec<FoundHandle> {
    let axes: &[DVec3] = match handle.mask {
        [_, _, _, true, true, true] | [_, _, _, true, false, true] => return vec![handle],
        [_, _, _, false, true, true] => &[DVec3::X],
        [_, _, _, true, true, false] => &[DVec3::Z],
        _ => &[DVec3::X, DVec3::Z],
    };
    let (Geometry::Cylinder { radius, .. } | Geometry::Sphere { radius }) = solid else { return vec![handle] };
    let turn = |axis: DVec3, turn: usize| {
        let angle = TAU * turn as f64 / TURNS as f64;
        let turned = handle.link_from_handle * Pose::from_rotation(DQuat::from_axis_angle(axis, angle));
        let (translation, rotation) = (turned.translation, turned.rotation);
        FoundHandle {
            name: format!("{}_{}{}", handle.name, if axis.x > 0.0 { "x" } else { "z" }, turn + 1),
            link_from_handle: jaws.frame(translation, rotation * DVec3::X, rotation * DVec3::Y, 2.0 * radius),
            // About the closing direction a ball turns freely all the same.
            mask: [true, true, true, true, axes.len() == 1, true],
            reason: "against the jaw that does not move".into(),
            ..handle.clone()
        }
    };
    axes.iter().flat_map(|axis| (0..TURNS).map(|number| turn(*axis, number))).collect()
}

/// Where along a direction a solid is held that reaches so far both ways.
fn along(half: f64) -> Vec<(f64, &'static str)> {
    match 2.0 * half > LONG {
        true => vec![(0.0, ""), (half - FROM_END, "_far"), (FROM_END - half, "_near")],
        false => vec![(0.0, "")],
    }
}

/// From anywhere around, closing on a pair of faces; and from each face, closing on each pair of faces that fits, both ways round.
fn on_box(half: DVec3, jaws: &Jaws) -> Vec<FoundHandle> {
    let mut found = around_box(half, jaws);
    for (a, (axis, from)) in AXES.into_iter().enumerate().rev() {
        for (sign, word) in [(1.0, "plus"), (-1.0, "minus")] {
            for (c, (closing, across)) in AXES.into_iter().enumerate().filter(|(c, _)| *c != a) {
                let Some(behind) = jaws.behind(2.0 * half[a]).filter(|_| jaws.fits(2.0 * half[c])) else { continue };
                let other = 3 - a - c;
                for (place, at) in along(half[other]) {
                    for (way, turned) in [(1.0, ""), (-1.0, "_turned")] {
                        let origin = axis * sign * (half[a] - behind) + AXES[other].0 * place;
                        found.push(FoundHandle {
                            name: format!("{word}_{from}_{across}{at}{turned}"),
                            link_from_handle: jaws.frame(origin, -axis * sign, closing * way, 2.0 * half[c]),
                            clearance: jaws.clearance(behind),
                            mask: [true; 6],
                            reason: format!("from {word} {from}, jaws along {across}"),
                        });
                    }
                }
            }
        }
    }
    found
}

/// Closing on a pair of faces, free to turn about the closing direction: over faces and edges alike. In the middle, where the hand has room
/// for the corners; else near both ends of the longer side.
fn around_box(half: DVec3, jaws: &Jaws) -> Vec<FoundHandle> {
    let mut found = Vec::new();
    for (c, (closing, across)) in AXES.into_iter().enumerate() {
        let (a, b) = ((c + 1) % 3, (c + 2) % 3);
        let (long, short) = if half[a] > half[b] { (a, b) } else { (b, a) };
        let in_middle = half[a].hypot(half[b]);
        let at_end = half[short] * SQRT_2;
        let off = AXES[long].0 * (half[long] - half[short]);
        let mut places = vec![("", DVec3::ZERO, in_middle)];
        // A jaw that turns takes away room behind its tip: near the ends more is left.
        if in_middle > jaws.depth - ROOM || (jaws.one_moves && off != DVec3::ZERO) {
            places.extend([("_far", off, at_end), ("_near", -off, at_end)]);
        }
        let fits = |(_, _, far): &(&str, DVec3, f64)| jaws.fits(2.0 * half[c]) && *far <= jaws.depth - ROOM;
        found.extend(places.into_iter().filter(fits).map(|(place, at, far)| FoundHandle {
            name: format!("around_{across}{place}"),
            link_from_handle: jaws.frame(
                at,
                if at.length() > 0.0 { -at.normalize() } else { -AXES[long].0 },
                closing,
                2.0 * half[c],
            ),
            clearance: jaws.clearance(far),
            mask: [true, true, true, true, false, true],
            reason: format!("jaws along {across}, free to turn about it"),
        }));
    }
    found
}

/// About its axis from all sides, both ways up; along the axis from both ends; and across the axis, free to turn about the closing
/// direction: hands that always tilt cannot do the others.
fn on_cylinder(radius: f64, half_length: f64, jaws: &Jaws) -> Vec<FoundHandle> {
    let mut found = Vec::new();
    if !jaws.fits(2.0 * radius) {
        return found;
    }
    for (place, at) in along(half_length) {
        for (way, turned) in [(DVec3::Z, ""), (-DVec3::Z, "_turned")] {
            found.push(FoundHandle {
                name: format!("side{at}{turned}"),
                link_from_handle: frame(DVec3::Z * place, DVec3::X, way.cross(DVec3::X)),
                clearance: jaws.clearance(radius),
                mask: [true, true, true, true, true, false],
                reason: "from the side, free to turn about the axis of the cylinder".into(),
            });
        }
    }
    if let Some(behind) = jaws.behind(2.0 * half_length) {
        for (sign, word) in [(1.0, "plus_z"), (-1.0, "minus_z")] {
            found.push(FoundHandle {
                name: word.into(),
                link_from_handle: frame(DVec3::Z * sign * (half_length - behind), -DVec3::Z * sign, DVec3::X),
                clearance: jaws.clearance(behind),
                mask: [true, true, true, false, true, true],
                reason: "along the axis of the cylinder, free to turn about it".into(),
            });
        }
    }
    found.extend(across_cylinder(radius, half_length, jaws));
    found
}

/// Closing on a diameter, free to turn about it: in the middle, where the hand has room for the length; else near both ends.
fn across_cylinder(radius: f64, half_length: f64, jaws: &Jaws) -> Vec<FoundHandle> {
    let in_middle = radius.hypot(half_length);
    let at_end = radius * SQRT_2;
    let off = half_length - radius;
    let mut places = vec![("", 0.0, in_middle)];
    if off > 0.0 && (in_middle > jaws.depth - ROOM || jaws.one_moves) {
        places.extend([("_far", off, at_end), ("_near", -off, at_end)]);
    }
    places.retain(|(.., far)| *far <= jaws.depth - ROOM);
    let handle = |turn: usize, (place, at, far): (&str, f64, f64)| {
        let angle = TAU * turn as f64 / AROUND as f64;
        let closing = DVec3::new(angle.cos(), angle.sin(), 0.0);
        let approach = if at < 0.0 { DVec3::Z } else { -DVec3::Z };
        FoundHandle {
            name: format!("across_{}{place}", turn + 1),
            link_from_handle: jaws.frame(DVec3::Z * at, approach, closing, 2.0 * radius),
            clearance: jaws.clearance(far),
            mask: [true, true, true, true, false, true],
            reason: "jaws on a diameter, free to turn about it".into(),
        }
    };
    places.into_iter().flat_map(|place| (0..AROUND).map(move |turn| handle(turn, place))).collect()
}

/// From anywhere.
fn on_sphere(radius: f64, jaws: &Jaws) -> Vec<FoundHandle> {
    if !jaws.fits(2.0 * radius) || radius > jaws.depth - ROOM {
        return Vec::new();
    }
    vec![FoundHandle {
        name: "around".into(),
        link_from_handle: Pose::identity(),
        clearance: jaws.clearance(radius),
        mask: [true, true, true, false, false, false],
        reason: "about the middle, free to turn".into(),
    }]
}
