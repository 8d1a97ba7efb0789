//! What a URDF says and is not read: attributes, and misspelt elements, of what decides where solids are and how they move.
//!
//! Other programs put elements of their own into URDF files, so an unknown name is no error. It is a remark, since the author of
//! `<origin xzy="…"/>` meant a pose.

use crate::scene::reading::error::{SceneError, nearest, quoted};
use crate::scene::reading::xml::{Xml, elements};
use roxmltree::Node;
use std::collections::BTreeMap;

/// Elements whose attributes matter, and those that are known.
const ATTRIBUTES: [(&str, &[&str]); 14] = [
    ("origin", &["xyz", "rpy", "quat_xyzw"]),
    ("box", &["size"]),
    ("sphere", &["radius"]),
    ("cylinder", &["radius", "length"]),
    ("capsule", &["radius", "length"]),
    ("mesh", &["filename", "scale"]),
    ("parent", &["link"]),
    ("child", &["link"]),
    ("axis", &["xyz"]),
    ("limit", &["lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"]),
    ("mimic", &["joint", "multiplier", "offset"]),
    ("mass", &["value"]),
    ("joint", &["name", "type"]),
    ("link", &["name", "type"]),
];

/// Elements whose children matter, and those that are read.
const CHILDREN: [(&str, &[&str]); 4] = [
    ("joint", &["origin", "parent", "child", "axis", "limit", "mimic"]),
    ("link", &["collision", "inertial", "visual"]),
    ("collision", &["origin", "geometry"]),
    ("inertial", &["origin", "mass", "inertia"]),
];

/// What is not known: by element and name, the first place and how often.
type Unknown<'n, 'i> = BTreeMap<(&'n str, &'n str), (Node<'n, 'i>, usize)>;

/// Reports attributes that are not read; one remark for all places of an element's attribute.
pub(super) fn tell_unknown(xml: &Xml<'_>, root: Node<'_, '_>, warnings: &mut Vec<SceneError>) {
    let (mut attributes, mut children) = (Unknown::new(), Unknown::new());
    let mut stack: Vec<Node<'_, '_>> = elements(root, "joint").chain(elements(root, "link")).collect();
    stack.reverse();
    while let Some(node) = stack.pop() {
        let tag = node.tag_name().name();
        if let Some((_, known)) = ATTRIBUTES.iter().find(|(of, _)| *of == tag) {
            let own = node.attributes().filter(|a| a.namespace().is_none()).map(|a| a.name());
            for name in own.filter(|name| !known.contains(name)) {
                attributes.entry((tag, name)).or_insert((node, 0)).1 += 1;
            }
        }
        let Some((_, read)) = CHILDREN.iter().find(|(of, _)| *of == tag).or((tag == "geometry").then_some(&("", &[])))
        else {
            continue;
        };
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            match name {
                // How a link looks is not read.
                "visual" => {}
                _ if tag == "geometry" || read.contains(&name) => stack.push(child),
                _ if nearest(name, read.iter().copied()).is_some() => {
                    children.entry((tag, name)).or_insert((child, 0)).1 += 1;
                }
                _ => {}
            }
        }
    }
    let times = |count: usize| if count > 1 { format!(", {count} times") } else { String::new() };
    for ((tag, name), (node, count)) in attributes {
        let known = ATTRIBUTES.iter().find(|(of, _)| *of == tag).map_or(&[][..], |(_, known)| known);
        let message = format!("attribute `{}` is not read{}", quoted(name), times(count));
        let hint = nearest(name, known.iter().copied()).map(|near| format!("did you mean `{near}`?"));
        warnings.push(xml.error(node, message).hint(hint.unwrap_or_default()));
    }
    for ((tag, name), (node, count)) in children {
        let read = CHILDREN.iter().find(|(of, _)| *of == tag).map_or(&[][..], |(_, read)| read);
        let near = nearest(name, read.iter().copied()).unwrap_or_default();
        let message = format!("<{}> is no element of <{tag}> and is not read{}", quoted(name), times(count));
        warnings.push(xml.error(node, message).hint(format!("did you mean <{near}>?")));
    }
}

/// A part without collision shapes: nothing can touch it. Frames alone (a world, a floor's edge) are fine where they are no robot.
pub(super) fn tell_shapeless(xml: &Xml<'_>, root: Node<'_, '_>, may_be_frames: bool) -> Option<SceneError> {
    let visuals = elements(root, "link").filter(|link| elements(*link, "visual").next().is_some()).count();
    let (message, hint) = match visuals {
        0 if may_be_frames => return None,
        0 => ("has no collision shapes: it is never in the way".to_owned(), "give its links <collision> elements"),
        _ => {
            let links = if visuals == 1 { "1 link has".to_owned() } else { format!("{visuals} links have") };
            let message = format!("has no collision shapes ({links} a <visual> alone): it is never in the way");
            (message, "what is to be solid needs a <collision> of its own")
        }
    };
    Some(xml.error(root, message).hint(hint))
}
