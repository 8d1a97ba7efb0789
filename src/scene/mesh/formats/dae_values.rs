//! Values of COLLADA elements: index lists, kinds of primitives, node transforms.
//!
//! They need none of the state that `dae` keeps while it traverses the nodes of a document.

use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::xml::Xml;
use glam::{DMat4, DQuat, DVec3};
use roxmltree::Node;

pub(crate) struct Inputs<'a, 'i> {
    pub(crate) stride: usize,
    pub(crate) offset: usize,
    pub(crate) positions: Node<'a, 'i>,
}

/// Turns the interleaved indices of a primitive into vertices of the mesh.
pub(crate) struct Corners<'c, 'a, 'i> {
    pub(crate) inputs: &'c Inputs<'a, 'i>,
    pub(crate) first: u32,
    pub(crate) count: u32,
}

impl Corners<'_, '_, '_> {
    pub(crate) fn vertices(&self, xml: &Xml<'_>, p: Node<'_, '_>, numbers: &[u32]) -> Result<Vec<u32>, SceneError> {
        if !numbers.len().is_multiple_of(self.inputs.stride) {
            let message = format!("has {} indices, {} make a corner", numbers.len(), self.inputs.stride);
            return Err(xml.error(p, message).hint("the file is cut off or damaged"));
        }
        numbers
            .chunks_exact(self.inputs.stride)
            .map(|corner| match corner[self.inputs.offset] {
                i if i < self.count => Ok(self.first + i),
                i => Err(xml.error(p, format!("names vertex {i}, there are {}", self.count))),
            })
            .collect()
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Triangles,
    Polylist,
    Polygons,
    Strips,
    Fans,
}

impl Kind {
    pub(crate) fn of(tag: &str) -> Option<Self> {
        Some(match tag {
            "triangles" => Self::Triangles,
            "polylist" => Self::Polylist,
            "polygons" => Self::Polygons,
            "tristrips" => Self::Strips,
            "trifans" => Self::Fans,
            _ => return None,
        })
    }
}

pub(crate) fn indices(xml: &Xml<'_>, p: Node<'_, '_>) -> Result<Vec<u32>, SceneError> {
    let text = p.text().unwrap_or_default();
    xml.words(text)
        .map(|word| {
            word.and_then(|word| word.parse().map_err(|_| xml.error(p, format!("`{}` is no index", quoted(word)))))
        })
        .collect()
}

/// The product of a node's transformation elements, in their order.
pub(crate) fn transform(xml: &Xml<'_>, node: Node<'_, '_>) -> Result<DMat4, SceneError> {
    let mut product = DMat4::IDENTITY;
    for child in node.children().filter(Node::is_element) {
        let tag = child.tag_name().name();
        let wanted = match tag {
            "matrix" => 16,
            "translate" | "scale" => 3,
            "rotate" => 4,
            "lookat" | "skew" => {
                return Err(xml.error(child, "this kind of transform is not read").hint("write it as a <matrix>"));
            }
            _ => continue,
        };
        let v = xml.numbers(child, "transform", child.text().unwrap_or_default())?;
        if v.len() != wanted {
            return Err(xml.error(child, format!("wants {wanted} numbers, got {}", v.len())));
        }
        product *= match tag {
            "matrix" => {
                let mut rows = [0.0; 16];
                rows.copy_from_slice(&v);
                DMat4::from_cols_array(&rows).transpose()
            }
            "translate" => DMat4::from_translation(DVec3::new(v[0], v[1], v[2])),
            "scale" => DMat4::from_scale(DVec3::new(v[0], v[1], v[2])),
            _ => match DVec3::new(v[0], v[1], v[2]).try_normalize() {
                Some(axis) => DMat4::from_quat(DQuat::from_axis_angle(axis, v[3].to_radians())),
                None if v[3] == 0.0 => DMat4::IDENTITY,
                None => return Err(xml.error(child, "turns about an axis of length zero")),
            },
        };
    }
    Ok(product)
}
