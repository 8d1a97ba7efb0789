//! What can be named from outside: public items of public modules, under the path by which they are reached, and what is
//! re-exported.

use super::items::{self, Modules};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Where an item is defined: module, and name there.
type Place = (Vec<String>, String);

/// The listing of the crate whose `lib.rs` lies in a folder, sorted.
pub fn list(folder: &Path) -> Vec<String> {
    let modules = items::read(folder);
    let mut walk = Walk { modules: &modules, listed: BTreeMap::new(), lines: BTreeSet::new() };
    walk.module(&[], &[]);
    walk.lines.into_iter().collect()
}

struct Walk<'m> {
    modules: &'m Modules,
    /// Items that are listed, and where.
    listed: BTreeMap<Place, String>,
    lines: BTreeSet<String>,
}

impl Walk<'_> {
    /// Lists the module at a path under the path by which it is reached.
    fn module(&mut self, at: &[String], shown: &[String]) {
        let module = &self.modules[at];
        for (name, item) in &module.items {
            if item.is_public {
                self.item(&(at.to_vec(), name.clone()), shown, name);
            }
        }
        for (name, is_public) in &module.children {
            if *is_public {
                self.lines.insert(format!("{}: mod", [shown, std::slice::from_ref(name)].concat().join("::")));
                self.module(&below(at, name), &below(shown, name));
            }
        }
        for one in module.uses.iter().filter(|one| one.is_public) {
            match self.absolute(at, &one.path) {
                None => {
                    let shown = below(shown, &one.name).join("::");
                    self.lines.insert(format!("{shown}: use {}", one.path.join("::")));
                }
                Some(path) if one.is_glob => self.module(&path, shown),
                Some(path) if self.modules.contains_key(&path) => self.module(&path, &below(shown, &one.name)),
                Some(path) => match self.defined(&path, 0) {
                    Some(place) => self.item(&place, shown, &one.name),
                    // Only its name is known: a macro makes it.
                    None => drop(self.lines.insert(format!("{}: of a macro", below(shown, &one.name).join("::")))),
                },
            }
        }
    }

    fn item(&mut self, place: &Place, shown: &[String], name: &str) {
        let shown = below(shown, name).join("::");
        if let Some(first) = self.listed.get(place) {
            self.lines.insert(format!("{shown}: use {first}"));
            return;
        }
        self.listed.insert(place.clone(), shown.clone());
        let item = &self.modules[&place.0].items[&place.1];
        for (part, line) in &item.lines {
            self.lines.insert(format!("{shown}{part}: {line}"));
        }
        for (at, module) in self.modules {
            for (of, lines) in &module.impls {
                if self.defined(&below(at, of), 0).as_ref() == Some(place) {
                    self.lines.extend(lines.iter().map(|(part, line)| format!("{shown}{part}: {line}")));
                }
            }
        }
    }

    /// A path from the crate's root; none for another crate's.
    fn absolute(&self, at: &[String], path: &[String]) -> Option<Vec<String>> {
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => Some(rest.to_vec()),
            "self" => self.absolute_below(at, rest),
            "super" => self.absolute_below(&at[..at.len().checked_sub(1)?], rest),
            name if self.modules[at].children.contains_key(name) => Some([at, path].concat()),
            _ => None,
        }
    }

    fn absolute_below(&self, at: &[String], rest: &[String]) -> Option<Vec<String>> {
        match rest.first().map(String::as_str) {
            Some("super") => self.absolute(at, rest),
            _ => Some([at, rest].concat()),
        }
    }

    /// Where the item that a path from the root names is defined.
    fn defined(&self, path: &[String], depth: usize) -> Option<Place> {
        let (name, at) = path.split_last()?;
        let module = self.modules.get(at)?;
        if module.items.contains_key(name) {
            return Some((at.to_vec(), name.clone()));
        }
        let import = module.uses.iter().find(|one| one.name == *name && !one.is_glob).filter(|_| depth < 16)?;
        self.defined(&self.absolute(at, &import.path)?, depth + 1)
    }
}

fn below(path: &[String], name: &str) -> Vec<String> {
    [path, &[name.to_owned()]].concat()
}
