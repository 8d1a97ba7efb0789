//! All items of a crate, public or not, by module.

use std::collections::BTreeMap;
use std::path::Path;
use syn::spanned::Spanned;

/// Path of a module from the root of its crate.
pub type ModulePath = Vec<String>;

/// What one module says.
#[derive(Default)]
pub struct Module {
    /// Lines of each item that the module defines, by name; empty where the item is not `pub`.
    pub items: BTreeMap<String, Item>,
    /// Child modules, and whether they are `pub`.
    pub children: BTreeMap<String, bool>,
    /// Imports: the name here, the path that it stands for, whether it is `pub`.
    pub uses: Vec<Use>,
    /// Public methods and traits of `impl` blocks: the type's name here, and the lines.
    pub impls: Vec<(String, Vec<(String, String)>)>,
}

pub struct Use {
    pub name: String,
    pub path: Vec<String>,
    pub is_public: bool,
    pub is_glob: bool,
}

#[derive(Clone, Default)]
pub struct Item {
    pub is_public: bool,
    /// Path below the item (empty for the item itself), and what stands there.
    pub lines: Vec<(String, String)>,
}

/// The modules of a crate, by path.
pub type Modules = BTreeMap<ModulePath, Module>;

pub fn read(folder: &Path) -> Modules {
    let mut modules = Modules::new();
    let root = folder.join("lib.rs");
    module(&mut modules, folder, &parse(&root), Vec::new());
    modules
}

fn parse(path: &Path) -> Vec<syn::Item> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display())).items
}

/// Source text in one line.
fn text(spanned: &impl Spanned) -> String {
    let text = spanned.span().source_text().unwrap_or_default();
    let lines = text.lines().map(|line| line.split_once("//").map_or(line, |(code, _)| code).trim());
    let joined = lines.collect::<Vec<_>>().join(" ");
    let words = joined.split_whitespace().collect::<Vec<_>>().join(" ");
    // Line breaks of the formatter are no part of an item.
    words.replace("( ", "(").replace(", )", ")").replace(" )", ")").replace("< ", "<").replace(", >", ">")
}

fn is_public(visibility: &syn::Visibility) -> bool {
    matches!(visibility, syn::Visibility::Public(_))
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|a| a.path().is_ident("cfg") && text(a).contains("cfg(test)"))
}

/// `#[derive(..)]` and `#[non_exhaustive]`, in front of a type; features that it needs.
fn attributes(attributes: &[syn::Attribute]) -> String {
    let told = ["derive", "non_exhaustive", "cfg", "cfg_attr"];
    let told = attributes.iter().filter(|a| told.iter().any(|name| a.path().is_ident(name)));
    told.map(|a| text(a) + " ").collect()
}

fn module(modules: &mut Modules, folder: &Path, items: &[syn::Item], at: ModulePath) {
    let mut here = Module::default();
    for item in items {
        match item {
            syn::Item::Mod(item) if is_test(&item.attrs) => {}
            syn::Item::Mod(item) => {
                let name = item.ident.to_string();
                here.children.insert(name.clone(), is_public(&item.vis));
                let below = [at.as_slice(), std::slice::from_ref(&name)].concat();
                let own = folder.join(&name);
                match &item.content {
                    Some((_, items)) => module(modules, &own, items, below),
                    None if own.with_extension("rs").is_file() => {
                        module(modules, &own, &parse(&own.with_extension("rs")), below);
                    }
                    None => module(modules, &own, &parse(&own.join("mod.rs")), below),
                }
            }
            syn::Item::Use(item) => uses(&item.tree, &mut Vec::new(), is_public(&item.vis), &mut here.uses),
            syn::Item::Impl(item) if !is_test(&item.attrs) => here.impls.extend(implementation(item)),
            item => here.items.extend(named(item)),
        }
    }
    modules.insert(at, here);
}

fn uses(tree: &syn::UseTree, before: &mut Vec<String>, is_public: bool, found: &mut Vec<Use>) {
    let mut add = |name: String, last: Option<String>, is_glob| {
        let path: Vec<String> = before.iter().cloned().chain(last).collect();
        found.push(Use { name, path, is_public, is_glob });
    };
    match tree {
        syn::UseTree::Path(path) => {
            before.push(path.ident.to_string());
            uses(&path.tree, before, is_public, found);
            drop(before.pop());
        }
        syn::UseTree::Name(name) if name.ident == "self" => {
            add(before.last().cloned().unwrap_or_default(), None, false);
        }
        syn::UseTree::Name(name) => add(name.ident.to_string(), Some(name.ident.to_string()), false),
        syn::UseTree::Rename(name) => add(name.rename.to_string(), Some(name.ident.to_string()), false),
        syn::UseTree::Glob(_) => add(String::new(), None, true),
        syn::UseTree::Group(group) => group.items.iter().for_each(|tree| uses(tree, before, is_public, found)),
    }
}

/// An item's name, and its lines.
fn named(item: &syn::Item) -> Option<(String, Item)> {
    let one = |ident: &syn::Ident, visibility: &syn::Visibility, line: String| {
        Some((ident.to_string(), Item { is_public: is_public(visibility), lines: vec![(String::new(), line)] }))
    };
    match item {
        syn::Item::Const(item) => one(&item.ident, &item.vis, format!("const: {}", text(&item.ty))),
        syn::Item::Static(item) => one(&item.ident, &item.vis, format!("static: {}", text(&item.ty))),
        syn::Item::Fn(item) => one(&item.sig.ident, &item.vis, text(&item.sig)),
        syn::Item::Type(item) => one(&item.ident, &item.vis, format!("type = {}", text(&item.ty))),
        syn::Item::Struct(item) => {
            let head = format!("{}struct{}", attributes(&item.attrs), text(&item.generics));
            let mut lines = vec![(String::new(), head)];
            let fields = item.fields.iter().enumerate().filter(|(_, field)| is_public(&field.vis));
            lines.extend(fields.map(|(number, field)| {
                let name = field.ident.as_ref().map_or(number.to_string(), ToString::to_string);
                (format!(".{name}"), text(&field.ty))
            }));
            Some((item.ident.to_string(), Item { is_public: is_public(&item.vis), lines }))
        }
        syn::Item::Enum(item) => {
            let head = format!("{}enum{}", attributes(&item.attrs), text(&item.generics));
            let mut lines = vec![(String::new(), head)];
            for variant in &item.variants {
                let name = format!("::{}", variant.ident);
                let fields = variant.fields.iter().enumerate().map(|(number, field)| {
                    field.ident.as_ref().map_or(number.to_string(), ToString::to_string) + ": " + &text(&field.ty)
                });
                lines.push((name, format!("variant {{{}}}", fields.collect::<Vec<_>>().join(", "))));
            }
            Some((item.ident.to_string(), Item { is_public: is_public(&item.vis), lines }))
        }
        syn::Item::Trait(item) => {
            let mut lines =
                vec![(String::new(), format!("trait{}: {}", text(&item.generics), text(&item.supertraits)))];
            for item in &item.items {
                match item {
                    syn::TraitItem::Fn(method) => {
                        let provided = if method.default.is_some() { " {..}" } else { "" };
                        lines.push((format!("::{}", method.sig.ident), text(&method.sig) + provided));
                    }
                    syn::TraitItem::Type(of) => lines.push((format!("::{}", of.ident), text(of))),
                    syn::TraitItem::Const(of) => lines.push((format!("::{}", of.ident), text(of))),
                    _ => {}
                }
            }
            Some((item.ident.to_string(), Item { is_public: is_public(&item.vis), lines }))
        }
        _ => None,
    }
}

/// The type's name, and what the block adds to it.
fn implementation(item: &syn::ItemImpl) -> Option<(String, Vec<(String, String)>)> {
    let syn::Type::Path(path) = item.self_ty.as_ref() else { return None };
    let name = path.path.segments.last()?.ident.to_string();
    if let Some((_, of, _)) = &item.trait_ {
        return Some((name, vec![(" impl".into(), format!("{} for {}", text(of), text(&item.self_ty)))]));
    }
    let mut lines = Vec::new();
    for item in &item.items {
        match item {
            syn::ImplItem::Fn(method) if is_public(&method.vis) && !is_test(&method.attrs) => {
                lines.push((format!("::{}", method.sig.ident), text(&method.sig)));
            }
            syn::ImplItem::Const(of) if is_public(&of.vis) => {
                lines.push((format!("::{}", of.ident), format!("const: {}", text(&of.ty))));
            }
            _ => {}
        }
    }
    Some((name, lines))
}
