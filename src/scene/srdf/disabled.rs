//! Pairs of links that are not tested: one by one, or all pairs of a link but some (`<disable_default_collisions>` and
//! `<enable_collisions>`, of SRDF since 2021).

use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::xml::elements;
use crate::scene::srdf::reader::Reader;
use roxmltree::Node;
use std::collections::{BTreeMap, HashSet};

/// Most pairs that a file disables.
const PAIRS: usize = 1_000_000;

impl<'a> Reader<'a, '_> {
    /// Pairs that are named.
    pub(super) fn disabled_pairs(&mut self, root: Node<'a, '_>) -> Result<(), SceneError> {
        let pairs = self.pairs(root, "disable_collisions")?;
        self.model.disabled_pairs.extend(pairs.into_iter().map(|(first, second, node)| {
            let reason = node.attribute("reason").unwrap_or("SRDF");
            (first.to_owned(), second.to_owned(), reason.to_owned())
        }));
        Ok(())
    }

    /// All pairs of links that are disabled by default, but for those that are enabled. A pair that is also disabled by name
    /// stays disabled.
    pub(super) fn default_pairs(&mut self, root: Node<'a, '_>) -> Result<(), SceneError> {
        let links: HashSet<&str> = self.model.links.iter().map(|l| l.name.as_str()).collect();
        let (mut by_default, mut unknown) = (Vec::new(), Vec::new());
        let mut named = HashSet::new();
        for (count, node) in elements(root, "disable_default_collisions").enumerate() {
            self.xml.look(count)?;
            let link = self.xml.attribute(node, "link")?;
            match links.contains(link) {
                true if named.insert(link) => by_default.push((link, node)),
                true => {}
                false => unknown.push((link, node)),
            }
        }
        for (link, node) in unknown {
            self.warn(node, format!("link `{}` is not in the URDF", quoted(link)), "it is left out");
        }
        let ordered =
            |a: &'_ str, b: &'_ str| if a <= b { (a.to_owned(), b.to_owned()) } else { (b.to_owned(), a.to_owned()) };
        let enabled = self.pairs(root, "enable_collisions")?;
        let mut known: HashSet<(String, String)> = enabled.iter().map(|(a, b, _)| ordered(a, b)).collect();
        known.extend(self.model.disabled_pairs.iter().map(|(a, b, _)| ordered(a, b)));
        let shaped = self.model.links.iter().filter(|link| !link.shapes.is_empty()).map(|link| link.name.as_str());
        let shaped: Vec<&str> = shaped.collect();
        let has_shape: HashSet<&str> = shaped.iter().copied().collect();
        let mut pairs = Vec::new();
        for (link, node) in by_default.iter().filter(|(link, _)| has_shape.contains(link)) {
            for other in shaped.iter().filter(|other| *other != link) {
                if !known.insert(ordered(link, other)) {
                    continue;
                }
                if pairs.len() == PAIRS {
                    return Err(self.xml.error(*node, format!("disables more than {PAIRS} pairs")));
                }
                pairs.push(((*link).to_owned(), (*other).to_owned(), "disabled by default".to_owned()));
            }
        }
        self.model.disabled_pairs.extend(pairs);
        Ok(())
    }

    /// Pairs of links that are in the URDF; a remark for each that is not.
    fn pairs<'i>(
        &mut self,
        root: Node<'a, 'i>,
        tag: &str,
    ) -> Result<Vec<(&'a str, &'a str, Node<'a, 'i>)>, SceneError> {
        let links: HashSet<&str> = self.model.links.iter().map(|l| l.name.as_str()).collect();
        let (mut pairs, mut unknown) = (Vec::new(), BTreeMap::new());
        for (count, node) in elements(root, tag).enumerate() {
            self.xml.look(count)?;
            let (first, second) = (self.xml.attribute(node, "link1")?, self.xml.attribute(node, "link2")?);
            match [first, second].iter().find(|l| !links.contains(**l)) {
                Some(missing) => unknown.entry(*missing).or_insert((node, 0)).1 += 1,
                None => pairs.push((first, second, node)),
            }
        }
        drop(links);
        for (link, (node, times)) in unknown {
            let message = format!("link `{}` is not in the URDF ({times} pairs name it)", quoted(link));
            self.warn(node, message, "these pairs are left out");
        }
        Ok(pairs)
    }
}
