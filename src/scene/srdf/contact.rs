//! Contact surfaces: convex planar polygons on a link.

use super::frames::text;
use crate::scene::reading::error::SceneError;
use crate::scene::reading::xml::elements;
use crate::scene::srdf::flat::{FLATNESS, bend, flatten};
use crate::scene::srdf::reader::Reader;
use foliate_components::robot::model::SurfaceModel;
use glam::DVec3;
use roxmltree::Node;

/// Most vertices of one surface.
const POINTS: usize = 100_000;

impl<'a> Reader<'a, '_> {
    pub(super) fn contact(&mut self, node: Node<'a, '_>) -> Result<SurfaceModel, SceneError> {
        let name = self.name(node, "contact")?;
        let link = self.link(node)?;
        let mut points = self.points(node)?;
        let mut polygons = Vec::new();
        let (mut element, mut old) = (None, false);
        for shape in elements(node, "shape") {
            element = Some(shape);
            self.shapes(shape, points.len(), &mut polygons)?;
        }
        for triangles in elements(node, "triangle") {
            (element, old) = (Some(triangles), true);
            let indices = self.indices(triangles, points.len())?;
            if indices.is_empty() || !indices.len().is_multiple_of(3) {
                let message = format!("has {} indices, 3 make a triangle", indices.len());
                return Err(self.xml.error(triangles, message));
            }
            polygons.extend(indices.chunks_exact(3).map(<[u32]>::to_vec));
        }
        let Some(element) = element else {
            return Err(self.xml.error(node, "<shape> is missing").hint("N i1 … iN, counter-clockwise from outside"));
        };
        if old {
            self.warn(element, "is an old form", "write <shape> N i1 … iN </shape>");
        }
        let bent = flatten(&mut points, &mut polygons);
        if bent > 0.0 {
            let message = format!(
                "has polygons that are bent by up to {:.2} mm: their corners are moved onto a plane",
                bent * 1e3
            );
            self.warn(
                element,
                message,
                "the plane is HPP's: through the mean of the corners, along the first two sides",
            );
        }
        check_polygons(&points, &polygons).map_err(|message| self.xml.error(element, message))?;
        Ok(SurfaceModel { name: name.to_owned(), link, points, polygons })
    }

    fn points(&self, node: Node<'_, '_>) -> Result<Vec<DVec3>, SceneError> {
        let element = self.xml.child(node, "point")?;
        let numbers = self.xml.numbers(element, "text", &text(element))?;
        if numbers.is_empty() || numbers.len() % 3 != 0 {
            return Err(self.xml.error(element, format!("has {} numbers, 3 make a point", numbers.len())));
        }
        if numbers.len() > 3 * POINTS {
            return Err(self.xml.error(element, format!("has more than {POINTS} points")));
        }
        Ok(numbers.chunks_exact(3).map(DVec3::from_slice).collect())
    }

    fn indices(&self, element: Node<'_, '_>, points: usize) -> Result<Vec<u32>, SceneError> {
        let mut indices = Vec::new();
        for number in self.xml.numbers(element, "text", &text(element))? {
            if number < 0.0 || number.fract() != 0.0 {
                return Err(self.xml.error(element, format!("{number} is no index")));
            }
            if indices.len() == 4 * POINTS {
                return Err(self.xml.error(element, format!("has more than {} indices", 4 * POINTS)));
            }
            indices.push(number.min(f64::from(u32::MAX)) as u32);
        }
        match indices.iter().find(|&&i| i as usize >= points && element.tag_name().name() == "triangle") {
            Some(i) => Err(self.xml.error(element, format!("names point {i}, there are {points}"))),
            None => Ok(indices),
        }
    }

    /// `N i1 … iN`, any number of times.
    fn shapes(&self, element: Node<'_, '_>, points: usize, polygons: &mut Vec<Vec<u32>>) -> Result<(), SceneError> {
        let indices = self.indices(element, points)?;
        let mut rest = indices.as_slice();
        while let Some((&count, behind)) = rest.split_first() {
            let Some((polygon, next)) = behind.split_at_checked(count as usize) else {
                let message = format!("announces {count} indices, {} follow", behind.len());
                return Err(self.xml.error(element, message).hint("N i1 … iN, with indices from 0"));
            };
            if let Some(i) = polygon.iter().find(|&&i| i as usize >= points) {
                let message = format!("names point {i}, there are {points}");
                return Err(self.xml.error(element, message).hint("N i1 … iN, with indices from 0"));
            }
            polygons.push(polygon.to_vec());
            rest = next;
        }
        match indices.is_empty() {
            true => Err(self.xml.error(element, "is empty").hint("N i1 … iN, counter-clockwise from outside")),
            false => Ok(()),
        }
    }
}

/// Every polygon has an area, is planar, and turns one way at every corner, once around.
pub(crate) fn check_polygons(points: &[DVec3], polygons: &[Vec<u32>]) -> Result<(), String> {
    for (number, polygon) in polygons.iter().enumerate() {
        let corners: Vec<DVec3> = polygon.iter().filter_map(|&i| points.get(i as usize).copied()).collect();
        if corners.len() < 3 || corners.len() != polygon.len() {
            return Err(format!("polygon {number} has {} corners, a polygon has at least 3", corners.len()));
        }
        convex(&corners).map_err(|what| format!("polygon {number} {what}"))?;
    }
    Ok(())
}

fn convex(corners: &[DVec3]) -> Result<(), String> {
    let n = corners.len();
    let center = corners.iter().sum::<DVec3>() / n as f64;
    let size = corners.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
    let area: DVec3 = (0..n).map(|i| (corners[i] - center).cross(corners[(i + 1) % n] - center)).sum();
    let Some(normal) = area.try_normalize().filter(|_| area.length() > 1e-9 * size * size) else {
        return Err("has no area".into());
    };
    let (off, _) = bend(corners, normal);
    if off > FLATNESS * size {
        return Err(format!("is not planar: a corner is {:.2} mm off the plane of all of them", off * 1e3));
    }
    let mut turned = 0.0;
    for i in 0..n {
        let (before, after) = (corners[(i + 1) % n] - corners[i], corners[(i + 2) % n] - corners[(i + 1) % n]);
        let sine = before.cross(after).dot(normal);
        if sine < -1e-6 * size * size {
            return Err("is not convex".into());
        }
        turned += sine.atan2(before.dot(after));
    }
    // A star turns one way at every corner, too, but more than once around.
    match turned < 3.0 * std::f64::consts::PI {
        true => Ok(()),
        false => Err("crosses itself".into()),
    }
}
