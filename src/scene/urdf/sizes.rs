//! Solids whose size tells of a slip: wider than a robot's link can be, or without a volume.

use crate::scene::reading::error::SceneError;
use crate::scene::reading::xml::Xml;
use foliate_components::robot::shape::Geometry;
use glam::DVec3;
use roxmltree::Node;

/// From this on a link of a robot or an object is told, metres.
const WIDE: f64 = 50.0;
/// The same of what stands around.
const WIDE_AROUND: f64 = 1000.0;

/// A remark about a solid of a collision element whose size cannot be meant.
pub(super) fn remark(
    xml: &Xml<'_>,
    collision: Node<'_, '_>,
    shape: &Geometry,
    stands_around: bool,
) -> Option<SceneError> {
    let size = size(shape)?;
    let kind = shape.kind();
    if size.max_element() > if stands_around { WIDE_AROUND } else { WIDE } {
        let message = format!("the {kind} is {:.0} m wide", size.max_element());
        let hint = match shape {
            Geometry::Mesh(_) => "lengths are metres: a mesh in millimetres wants scale=\"0.001 0.001 0.001\"",
            _ => "lengths are metres",
        };
        return Some(xml.error(collision, message).hint(hint));
    }
    let is_flat = !matches!(shape, Geometry::Mesh(_)) && size.min_element() == 0.0;
    is_flat.then(|| {
        xml.error(collision, format!("the {kind} has no volume: one of its lengths is 0"))
            .hint("give it a size, or remove it")
    })
}

/// The sides of the box around a solid, in its frame; none of a box that stands for a missing mesh.
fn size(shape: &Geometry) -> Option<DVec3> {
    Some(match shape {
        Geometry::Box { half_extents } => *half_extents * 2.0,
        Geometry::Sphere { radius } => DVec3::splat(2.0 * radius),
        Geometry::Cylinder { radius, half_length } => DVec3::new(2.0 * radius, 2.0 * radius, 2.0 * half_length),
        Geometry::Capsule { radius, half_length } => {
            DVec3::new(2.0 * radius, 2.0 * radius, 2.0 * (half_length + radius))
        }
        Geometry::Mesh(_) if shape.missing_file().is_some() => return None,
        Geometry::Mesh(mesh) => {
            let corner = |fold: fn(DVec3, DVec3) -> DVec3| mesh.vertices.iter().copied().reduce(fold);
            corner(DVec3::max)? - corner(DVec3::min)?
        }
    })
}
