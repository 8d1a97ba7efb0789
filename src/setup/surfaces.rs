//! Faces that carry objects, and faces on which objects lie.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::objects::RigidObject;
use foliate_components::Pose;
use glam::{DQuat, DVec3};
use std::collections::HashMap;

/// How far inside a face the centre of mass has to be for the object to rest on it, metres: the default of `rests_margin`, and some room.
const STABLE: f64 = 0.006;
/// Most resting poses of an object.
const MOST: usize = 6;
/// How far normals of a horizontal face may lean, as the cosine.
const LEVEL: f64 = 0.9998;
/// A face is as good as its hull where it fills this share of it.
const FILLS: f64 = 0.98;
/// Least area of a face that carries something, square metres.
const LEAST_AREA: f64 = 0.001;

/// A flat convex face of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundSurface {
    /// A name, unique in its part.
    pub name: String,
    /// Corners in the root link, metres, counter-clockwise seen from outside.
    pub points: Vec<DVec3>,
    /// Unit normal out of the body.
    pub normal: DVec3,
    /// How it was found, in words.
    pub reason: String,
}

/// The stable resting poses of an object: the faces of its hull above which its centre of mass is, 6 mm or more inside. The face below
/// the object as it is modelled comes first, then those on which it lies lowest.
#[must_use]
pub fn resting_faces(object: &RigidObject) -> Vec<FoundSurface> {
    let mut faces: Vec<(f64, FoundSurface)> = object
        .hull
        .iter()
        .filter_map(|facet| {
            let inside = facet.inside(object.centre);
            let height = facet.normal.dot(facet.corners[0] - object.centre);
            let face = FoundSurface {
                name: String::new(),
                points: facet.corners.clone(),
                normal: facet.normal,
                reason: format!("the centre of mass is {:.0} mm above it, {:.0} mm inside", height * 1e3, inside * 1e3),
            };
            let is_below = facet.normal.z < -LEVEL;
            (inside > STABLE).then_some((if is_below { f64::NEG_INFINITY } else { height }, face))
        })
        .collect();
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    faces.truncate(MOST);
    let named =
        |(at, (_, face)): (usize, (f64, FoundSurface))| FoundSurface { name: format!("rest_{}", at + 1), ..face };
    faces.into_iter().enumerate().map(named).collect()
}

/// The horizontal faces of a body that stands in the world as `X_WL` says and that look upwards, the largest first: connected triangles
/// of one height that fill a convex polygon.
#[must_use]
pub fn level_faces(body: &RigidObject, X_WL: &Pose) -> Vec<FoundSurface> {
    let key = |p: DVec3| (p * 1e5).round().to_array().map(|x| x as i64);
    let level: Vec<[DVec3; 3]> = body
        .triangles
        .iter()
        .map(|t| t.map(|p| X_WL.transform_point(p)))
        .filter(|[a, b, c]| (*b - *a).cross(*c - *a).normalize_or_zero().z > LEVEL)
        .collect();
    // Triangles that share a corner are one face.
    let mut face: Vec<usize> = (0..level.len()).collect();
    let mut first_at: HashMap<[i64; 3], usize> = HashMap::new();
    let find = |face: &[usize], mut at: usize| {
        while face[at] != at {
            at = face[at];
        }
        at
    };
    for (at, corner) in level.iter().enumerate().flat_map(|(at, t)| t.iter().map(move |p| (at, *p))) {
        let other = *first_at.entry(key(corner)).or_insert(at);
        let (a, b) = (find(&face, at), find(&face, other));
        face[a.max(b)] = a.min(b);
    }
    let mut groups: Vec<(usize, Vec<[DVec3; 3]>)> = Vec::new();
    for (at, triangle) in level.iter().enumerate() {
        let root = find(&face, at);
        match groups.iter_mut().find(|(known, _)| *known == root) {
            Some((_, group)) => group.push(*triangle),
            None => groups.push((root, vec![*triangle])),
        }
    }
    let mut found: Vec<(f64, FoundSurface)> = groups.iter().filter_map(|(_, group)| level_face(group, X_WL)).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let named = |(at, (_, face)): (usize, (f64, FoundSurface))| {
        let name = if at == 0 { "top".to_owned() } else { format!("top_{}", at + 1) };
        FoundSurface { name, ..face }
    };
    found.into_iter().enumerate().map(named).collect()
}

/// The polygon of a group of triangles, where they fill it.
fn level_face(group: &[[DVec3; 3]], X_WL: &Pose) -> Option<(f64, FoundSurface)> {
    let area: f64 = group.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a).length() / 2.0).sum();
    let corners = group.as_flattened();
    let height = corners.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    // A point below makes a solid of the face: the hull's upper face is the polygon.
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let mut points = corners.to_vec();
    points.push(middle - DVec3::Z);
    let facets = crate::setup::solids::hull::facets(&points);
    let upper = facets.iter().find(|facet| facet.normal.z > LEVEL)?;
    if area < LEAST_AREA || area < FILLS * upper.area {
        return None;
    }
    let X_LW = X_WL.inverse();
    let face = FoundSurface {
        name: String::new(),
        points: upper.corners.iter().map(|p| X_LW.transform_point(*p)).collect(),
        normal: X_LW.rotation * DVec3::Z,
        reason: format!("level, {height:.3} m high, {:.0} cm²", upper.area * 1e4),
    };
    Some((upper.area, face))
}

/// The pose of an object that lies with a face on the plane z = `height`, `gap` metres above it, turned by `yaw` about the vertical, with its
/// centre of mass above (x, y).
#[must_use]
pub fn lying_on(
    object: &RigidObject,
    face: &FoundSurface,
    (x, y, height): (f64, f64, f64),
    gap: f64,
    yaw: f64,
) -> Pose {
    let down = DQuat::from_rotation_arc(face.normal, -DVec3::Z);
    let rotation = DQuat::from_rotation_z(yaw) * down;
    let lowest = (rotation * face.points[0]).z;
    let centre = rotation * object.centre;
    Pose::from_parts(DVec3::new(x - centre.x, y - centre.y, height + gap - lowest), rotation)
}
