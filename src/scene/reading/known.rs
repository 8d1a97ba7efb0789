//! What a file says and is not read: attributes and elements that no reader knows.
//!
//! Other programs put elements of their own into these files, so an unknown name is no error. It is a remark, since the author of
//! `<origin xzy="…"/>` meant a pose.

use crate::scene::reading::error::{SceneError, nearest, quoted};
use crate::scene::reading::xml::Xml;
use roxmltree::Node;
use std::collections::BTreeMap;

/// The children of an element.
pub(crate) struct Children {
    pub of: &'static str,
    /// Those that are read, and looked into.
    pub read: &'static [&'static str],
    /// Those that say nothing that is needed.
    pub other: &'static [&'static str],
    /// Whether any other is told; else only a name that is like one of those that are read.
    pub all: bool,
}

/// The elements of a format that matter.
pub(crate) struct Known {
    /// Elements whose attributes matter, and those that are known.
    pub attributes: &'static [(&'static str, &'static [&'static str])],
    /// Elements whose children matter.
    pub children: &'static [Children],
}

/// What is not known: by element and name, the first place and how often.
type Unknown<'n, 'i> = BTreeMap<(&'n str, &'n str), (Node<'n, 'i>, usize)>;

impl Known {
    /// Reports what is not read from an element on; one remark for all places of an element's attribute or child. Elements of
    /// namespaces other than the root's are left out.
    pub fn tell_unknown(&self, xml: &Xml<'_>, root: Node<'_, '_>, warnings: &mut Vec<SceneError>) {
        let (mut attributes, mut children) = (Unknown::new(), Unknown::new());
        let mut stack = vec![root];
        while let Some(node) = stack.pop() {
            let tag = node.tag_name().name();
            if let Some(known) = self.attributes_of(tag) {
                let own = node.attributes().filter(|a| a.namespace().is_none()).map(|a| a.name());
                for name in own.filter(|name| !known.contains(name)) {
                    attributes.entry((tag, name)).or_insert((node, 0)).1 += 1;
                }
            }
            let Some(known) = self.children.iter().find(|known| known.of == tag) else { continue };
            let is_of_format = |n: &Node<'_, '_>| n.tag_name().namespace() == root.tag_name().namespace();
            let first_of_children = stack.len();
            for child in node.children().filter(|n| n.is_element() && is_of_format(n)) {
                let name = child.tag_name().name();
                if known.read.contains(&name) {
                    stack.push(child);
                } else if !known.other.contains(&name)
                    && (known.all || nearest(name, known.read.iter().copied()).is_some())
                {
                    children.entry((tag, name)).or_insert((child, 0)).1 += 1;
                }
            }
            stack[first_of_children..].reverse();
        }
        for ((tag, name), (node, count)) in attributes {
            let message = format!("attribute `{}` is not read{}", quoted(name), times(count));
            let near = nearest(name, self.attributes_of(tag).unwrap_or_default().iter().copied());
            let hint = near.map(|near| format!("did you mean `{near}`?"));
            warnings.push(xml.error(node, message).hint(hint.unwrap_or_default()));
        }
        for ((tag, name), (node, count)) in children {
            let read = self.children.iter().find(|known| known.of == tag).map_or(&[][..], |known| known.read);
            let message = format!("<{}> is no element of <{tag}> and is not read{}", quoted(name), times(count));
            let hint = nearest(name, read.iter().copied()).map(|near| format!("did you mean <{near}>?"));
            warnings.push(xml.error(node, message).hint(hint.unwrap_or_default()));
        }
    }

    fn attributes_of(&self, tag: &str) -> Option<&'static [&'static str]> {
        self.attributes.iter().find(|(of, _)| *of == tag).map(|(_, known)| *known)
    }
}

fn times(count: usize) -> String {
    if count > 1 { format!(", {count} times") } else { String::new() }
}
