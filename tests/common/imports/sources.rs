//! Reads a crate and resolves the paths in it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// Path of a module from the root of its crate.
type ModulePath = Vec<String>;

/// Names that a module has: those that it defines, and those that it imports from elsewhere.
#[derive(Default)]
struct Module {
    file: PathBuf,
    defines: BTreeSet<String>,
    /// Name here, and the path that it stands for.
    imports: BTreeMap<String, Vec<String>>,
    /// Paths of imports of everything.
    globs: Vec<Vec<String>>,
    /// Every path that the module's code has, imports included.
    paths: Vec<Vec<String>>,
}

/// A crate's modules.
pub struct Crate {
    root: PathBuf,
    modules: BTreeMap<ModulePath, Module>,
}

impl Crate {
    /// Reads all files below a folder that has a `lib.rs` or `main.rs`, or else stands for the module of that path.
    pub fn read(folder: &Path, at: &[&str]) -> Self {
        let at: ModulePath = at.iter().map(ToString::to_string).collect();
        let mut found = Self { root: folder.to_owned(), modules: BTreeMap::new() };
        found.folder(folder, &at);
        assert!(!found.modules.is_empty(), "{} has no sources", folder.display());
        found
    }

    fn folder(&mut self, folder: &Path, at: &[String]) {
        for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry")) {
            let path = entry.path();
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            if path.is_dir() {
                self.folder(&path, &[at, &[name]].concat());
            } else if path.extension().is_some_and(|ending| ending == "rs") && name != "tests" {
                let is_page = ["mod", "lib", "main"].contains(&name.as_str());
                let module = if is_page { at.to_vec() } else { [at, &[name]].concat() };
                let text = std::fs::read_to_string(&path).expect("a source");
                let file = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                self.module(&path, module, &file.items);
            }
        }
    }

    fn module(&mut self, file: &Path, at: ModulePath, items: &[syn::Item]) {
        let mut module = Module { file: file.to_owned(), ..Module::default() };
        for item in items.iter().filter(|item| !is_test(item)) {
            match item {
                syn::Item::Use(item) => module.uses(&item.tree, &mut Vec::new()),
                syn::Item::Mod(item) => {
                    if let Some((_, items)) = &item.content {
                        module.defines.insert(item.ident.to_string());
                        self.module(file, [at.as_slice(), &[item.ident.to_string()]].concat(), items);
                    }
                }
                item => {
                    module.defines.extend(name_of(item));
                    // What has no name of its own (an `impl`) is still code of this file.
                    if matches!(item, syn::Item::Impl(_)) {
                        module.defines.insert(String::new());
                    }
                    Paths(&mut module.paths).visit_item(item);
                }
            }
        }
        self.modules.insert(at, module);
    }

    /// What each file uses: file, file, and the names.
    pub fn edges(&self) -> BTreeMap<(PathBuf, PathBuf), BTreeSet<String>> {
        let mut edges: BTreeMap<_, BTreeSet<String>> = BTreeMap::new();
        for (at, module) in &self.modules {
            if module.is_page() {
                continue;
            }
            let everything = module.globs.iter();
            for path in module.paths.iter().chain(everything) {
                let Some(file) = self.absolute(at, path).and_then(|path| self.file_of(&path, 0)) else { continue };
                if file != module.file {
                    let name = path.last().cloned().unwrap_or_default();
                    edges.entry((self.short(&module.file), self.short(&file))).or_default().insert(name);
                }
            }
        }
        edges
    }

    /// Files, relative to the crate's folder.
    pub fn files(&self) -> BTreeSet<PathBuf> {
        self.modules.values().map(|module| self.short(&module.file)).collect()
    }

    fn short(&self, file: &Path) -> PathBuf {
        file.strip_prefix(&self.root).unwrap_or(file).to_owned()
    }

    /// A path from the crate's root; none for another crate's, and for names that are in scope anyway.
    fn absolute(&self, at: &[String], path: &[String]) -> Option<Vec<String>> {
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => Some(rest.to_vec()),
            "self" => Some([at, rest].concat()),
            "super" => {
                let up = &at[..at.len().checked_sub(1)?];
                let again = rest.first().is_some_and(|word| word == "super");
                if again { self.absolute(up, rest) } else { Some([up, rest].concat()) }
            }
            child if self.modules.contains_key(&[at, &[child.to_owned()]].concat()) => Some([at, path].concat()),
            _ => None,
        }
    }

    /// The file that defines what a path from the root names.
    fn file_of(&self, path: &[String], depth: usize) -> Option<PathBuf> {
        let mut at = ModulePath::new();
        for (number, word) in path.iter().enumerate() {
            let below = [at.as_slice(), std::slice::from_ref(word)].concat();
            if self.modules.contains_key(&below) {
                at = below;
                continue;
            }
            let Some(module) = self.modules.get(&at) else {
                // A folder that this crate knows only from its files, as the program's.
                at = below;
                continue;
            };
            if !module.defines.contains(word)
                && depth < 16
                && let Some(stands_for) = module.imports.get(word)
                && let Some(stands_for) = self.absolute(&at, stands_for)
            {
                return self.file_of(&[&stands_for, &path[number + 1..]].concat(), depth + 1);
            }
            return Some(module.file.clone());
        }
        // A page by itself is nothing that could be used.
        self.modules.get(&at).filter(|module| !module.is_page()).map(|module| module.file.clone())
    }
}

impl Module {
    fn is_page(&self) -> bool {
        self.defines.is_empty()
    }

    fn uses(&mut self, tree: &syn::UseTree, before: &mut Vec<String>) {
        match tree {
            syn::UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.uses(&path.tree, before);
                drop(before.pop());
            }
            syn::UseTree::Name(name) => self.import(name.ident.to_string(), name.ident.to_string(), before),
            syn::UseTree::Rename(name) => self.import(name.rename.to_string(), name.ident.to_string(), before),
            syn::UseTree::Glob(_) => self.globs.push(before.clone()),
            syn::UseTree::Group(group) => group.items.iter().for_each(|tree| self.uses(tree, before)),
        }
    }

    fn import(&mut self, here: String, there: String, before: &[String]) {
        let path = if there == "self" { before.to_vec() } else { [before, &[there]].concat() };
        let here = if here == "self" { path.last().cloned().unwrap_or_default() } else { here };
        self.paths.push(path.clone());
        self.imports.insert(here, path);
    }
}

/// Collects paths of more than one word.
struct Paths<'p>(&'p mut Vec<Vec<String>>);

impl<'a> Visit<'a> for Paths<'_> {
    fn visit_path(&mut self, path: &'a syn::Path) {
        if path.segments.len() > 1 {
            self.0.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }
}

fn is_test(item: &syn::Item) -> bool {
    let attributes = match item {
        syn::Item::Mod(item) => &item.attrs,
        syn::Item::Use(item) => &item.attrs,
        syn::Item::Fn(item) => &item.attrs,
        syn::Item::Impl(item) => &item.attrs,
        _ => return false,
    };
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.meta.require_list().is_ok_and(|list| list.tokens.to_string() == "test")
    })
}

fn name_of(item: &syn::Item) -> Option<String> {
    Some(match item {
        syn::Item::Const(item) => item.ident.to_string(),
        syn::Item::Enum(item) => item.ident.to_string(),
        syn::Item::Fn(item) => item.sig.ident.to_string(),
        syn::Item::Macro(item) => item.ident.as_ref()?.to_string(),
        syn::Item::Static(item) => item.ident.to_string(),
        syn::Item::Struct(item) => item.ident.to_string(),
        syn::Item::Trait(item) => item.ident.to_string(),
        syn::Item::Type(item) => item.ident.to_string(),
        _ => return None,
    })
}
