//! Colours of COLLADA: a symbol of a primitive is bound to a material where its geometry is placed, the material has an effect, and that a
//! diffuse colour. What leads nowhere has no colour.

use crate::scene::mesh::formats::triangles::Paint;
use crate::scene::reading::xml::{Xml, elements};
use roxmltree::Node;
use std::collections::HashMap;

/// Colours that are this clear are meant to be seen all the same: exporters disagree about which end is opaque.
const CLEAR: f64 = 0.05;

/// What symbols stand for where a geometry is placed: names of materials.
pub(super) fn bound<'a>(instance: Node<'a, '_>) -> HashMap<&'a str, &'a str> {
    let binds = elements(instance, "bind_material").flat_map(|bind| elements(bind, "technique_common"));
    let materials = binds.flat_map(|common| elements(common, "instance_material"));
    let pair = |material: Node<'a, '_>| {
        Some((material.attribute("symbol")?, material.attribute("target")?.strip_prefix('#')?))
    };
    materials.filter_map(pair).collect()
}

/// The diffuse colour of a material, by its name.
pub(super) fn color(xml: &Xml<'_>, by_id: &HashMap<&str, Node<'_, '_>>, material: &str) -> Option<Paint> {
    let material = by_id.get(material).filter(|node| node.tag_name().name() == "material")?;
    let effect = elements(*material, "instance_effect").next()?.attribute("url")?.strip_prefix('#')?;
    let diffuse = by_id.get(effect)?.descendants().find(|node| node.tag_name().name() == "diffuse")?;
    let node = elements(diffuse, "color").next()?;
    let numbers = xml.numbers(node, "color", node.text().unwrap_or_default()).ok()?;
    let &[red, green, blue, opacity] = numbers.as_slice() else { return None };
    let opacity = if opacity > CLEAR { opacity } else { 1.0 };
    Some([red, green, blue, opacity].map(|x| x.clamp(0.0, 1.0)))
}
