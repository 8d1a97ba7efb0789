//! What of an object must be over its support, by the rule that the file says (and the contract has compared with the scene's).

use crate::check::world::models::{Link, World};
use crate::path_file::document::{RestsEntry, RestsRule};
use glam::DVec3;

/// Points in the object's link that must be over the support's polygon, each with its name, and by how much, metres.
pub(in crate::check) struct Footing {
    pub points: Vec<(&'static str, DVec3)>,
    pub margin: f64,
}

/// The footing of an object's polygon with these corners and this outer unit normal, in the link `held`; none where the object
/// cannot rest on it by more than the tolerance, metres.
pub(in crate::check) fn footing(
    world: &World,
    held: &Link,
    rests: Option<RestsEntry>,
    (corners, normal): (&[DVec3], DVec3),
    tolerance: f64,
) -> Option<Footing> {
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let Some(RestsEntry { rule, margin }) = rests else {
        return Some(Footing { points: vec![("centre outside the support", middle)], margin: 0.0 });
    };
    let points = match rule {
        RestsRule::WholeFace => corners.iter().map(|corner| ("corner hangs over the support", *corner)).collect(),
        RestsRule::Stable => {
            let centre = centre_of_mass(world, held).unwrap_or(middle);
            let inside = beyond(corners, normal, centre) <= tolerance - margin;
            if !inside {
                return None;
            }
            vec![("centre of mass not over the support", centre)]
        }
    };
    Some(Footing { points, margin })
}

/// How far a point is beyond the worst edge of a convex polygon, seen along its normal; negative inside.
fn beyond(corners: &[DVec3], normal: DVec3, point: DVec3) -> f64 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let out = |(a, b): (&DVec3, &DVec3)| (*b - *a).cross(normal).try_normalize().map(|n| n.dot(point - *a));
    edges.filter_map(out).fold(f64::NEG_INFINITY, f64::max)
}

/// The centre of mass of all that is fixed to a link, in the link's frame; by the volume of its shapes where nothing has a mass, and
/// none where nothing has a volume either.
fn centre_of_mass(world: &World, held: &Link) -> Option<DVec3> {
    let masses = world.masses[held.part].iter().filter(|(frame, _)| frame.body == held.frame.body);
    let masses = masses.map(|(frame, mass)| (*mass, frame.body_from_frame.translation));
    let shapes = world.shapes.iter().filter(|shape| shape.rigid == held.rigid());
    let volumes = shapes.filter_map(|shape| {
        let (volume, centre) = shape.geometry.volume()?;
        Some((volume, shape.body_from_shape.transform_point(centre)))
    });
    let centre = mean(masses).or_else(|| mean(volumes))?;
    Some(held.frame.body_from_frame.inverse_transform_point(centre))
}

fn mean(weighted: impl Iterator<Item = (f64, DVec3)>) -> Option<DVec3> {
    let (mut total, mut sum) = (0.0, DVec3::ZERO);
    for (weight, point) in weighted {
        total += weight;
        sum += point * weight;
    }
    Some(sum / total).filter(|mean| total > 0.0 && mean.is_finite())
}
