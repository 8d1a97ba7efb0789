//! What links look like: the `visual` elements of a URDF.
//!
//! A picture is no proof: where a mesh cannot be read, a remark says so and the link is shown by other means.

use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::xml::{Xml, elements};
use crate::scene::urdf::read::{Context, painted_geometry};
use crate::scene::urdf::values::origin;
use foliate_components::Pose;
use foliate_components::robot::shape::Geometry;
use roxmltree::Node;
use std::collections::HashMap;

/// Red, green, blue and opacity, from 0 to 1.
pub type Color = [f64; 4];

/// A solid that a link shows.
#[derive(Clone, Debug)]
pub struct VisualModel {
    /// Its pose in the link.
    pub link_from_visual: Pose,
    /// The solid.
    pub geometry: Geometry,
    /// Its colour, where the file gives one.
    pub color: Option<Color>,
}

/// What a link looks like.
#[derive(Clone, Debug, Default)]
pub struct LinkVisuals {
    /// Name of the link, without its part.
    pub link: String,
    /// Its solids.
    pub visuals: Vec<VisualModel>,
    /// Whether some of them cannot be read.
    pub incomplete: bool,
}

/// Reads the visual elements of a URDF.
///
/// # Errors
/// No well-formed XML; reading was stopped.
pub(crate) fn read(file: &str, text: &str, context: &mut Context<'_, '_>) -> Result<Vec<LinkVisuals>, SceneError> {
    let xml = Xml::parse(file, text, &context.meshes.limits().stop)?;
    let root = xml.document.root_element();
    let named: HashMap<&str, Color> = root
        .descendants()
        .filter(|node| node.is_element() && node.tag_name().name() == "material")
        .filter_map(|node| Some((node.attribute("name")?, own_color(&xml, node)?)))
        .collect();
    let mut links = Vec::new();
    for (count, node) in elements(root, "link").enumerate() {
        xml.look(count)?;
        let mut link = LinkVisuals { link: xml.attribute(node, "name")?.to_owned(), ..LinkVisuals::default() };
        for visual in elements(node, "visual") {
            match one(&xml, visual, &named, context) {
                Ok(visuals) => link.visuals.extend(visuals),
                Err(error) if error.stopped.is_some() => return Err(error),
                Err(error) => {
                    link.incomplete = true;
                    context.warnings.push(error.hint(format!("`{}` is shown without it", quoted(&link.link))));
                }
            }
        }
        links.push(link);
    }
    // Whether a mesh is closed has no say in how it looks.
    context.open_meshes.clear();
    Ok(links)
}

fn one(
    xml: &Xml<'_>,
    node: Node<'_, '_>,
    named: &HashMap<&str, Color>,
    context: &mut Context<'_, '_>,
) -> Result<Vec<VisualModel>, SceneError> {
    let material = elements(node, "material").next();
    let by_name = || material.and_then(|m| m.attribute("name")).and_then(|name| named.get(name)).copied();
    let color = material.and_then(|m| own_color(xml, m)).or_else(by_name);
    let link_from_visual = origin(xml, node)?;
    let visual = |(geometry, paint): (Geometry, Option<Color>)| {
        // What the URDF says of a colour comes before what the mesh does.
        VisualModel { link_from_visual, geometry, color: color.or(paint) }
    };
    Ok(painted_geometry(xml, node, context)?.into_iter().map(visual).collect())
}

/// The colour that a material element has itself.
fn own_color(xml: &Xml<'_>, material: Node<'_, '_>) -> Option<Color> {
    let color = elements(material, "color").next()?;
    let rgba = xml.array::<4>(color, "rgba").ok()??;
    Some(rgba.map(|x| x.clamp(0.0, 1.0)))
}
