//! Promise: relative links in Markdown lead to files and headings that exist, and files that Markdown names in backticks exist.
#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

/// Endings of files that a name in backticks can have.
const ENDINGS: [&str; 14] =
    ["csv", "dae", "json", "lock", "md", "obj", "py", "rs", "srdf", "stl", "svg", "toml", "tsv", "urdf"];
/// Folders of the tree that are not part of it.
const SKIPPED: [&str; 5] = [".git", "target", "shared", "__pycache__", "node_modules"];

/// The files of a project, by their path from its root.
struct Tree {
    files: BTreeSet<String>,
    folders: BTreeSet<String>,
    /// Headings of the Markdown files, as the part of a link behind `#`.
    anchors: BTreeMap<String, BTreeSet<String>>,
}

impl Tree {
    fn new(texts: &BTreeMap<String, String>, others: impl IntoIterator<Item = String>) -> Self {
        let files: BTreeSet<String> = texts.keys().cloned().chain(others).collect();
        let above = |file: &String| Path::new(file).ancestors().skip(1).map(name).collect::<Vec<_>>();
        let folders = files.iter().flat_map(above).collect();
        let anchors = texts.iter().map(|(file, text)| (file.clone(), anchors(text))).collect();
        Self { files, folders, anchors }
    }

    fn has(&self, path: &str) -> bool {
        self.files.contains(path) || self.folders.contains(path)
    }

    /// What is wrong with a link of a page, if anything is.
    fn wrong_link(&self, page: &str, target: &str) -> Option<String> {
        if target.contains("://") || target.starts_with("mailto:") {
            return None;
        }
        let (file, anchor) = target.split_once('#').map_or((target, None), |(file, anchor)| (file, Some(anchor)));
        let folder = Path::new(page).parent().unwrap_or(Path::new(""));
        let path = if file.is_empty() { Some(page.to_owned()) } else { normal(&folder.join(file)) };
        let Some(path) = path else { return Some(format!("{target} leaves the project")) };
        if !self.has(&path) {
            return Some(format!("there is no {path}"));
        }
        let anchor = anchor?;
        match self.anchors.get(&path) {
            Some(known) if known.contains(anchor) => None,
            _ => Some(format!("{path} has no heading #{anchor}")),
        }
    }

    /// What is wrong with a name in backticks, if it is one of a file or folder.
    ///
    /// A file may be named from the root, from the page's folder, or by the end of its path: `collision/mod.rs`.
    fn wrong_name(&self, page: &str, name: &str) -> Option<String> {
        let plain = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
        let relative = name.trim_end_matches('/');
        let (first, rest) = relative.split_once('/')?;
        if !name.chars().all(plain) || first.is_empty() || rest.is_empty() || name.contains("//") {
            return None;
        }
        let is_file = ENDINGS.iter().any(|ending| rest.rsplit_once('.').is_some_and(|(_, e)| e == *ending));
        let begins_in_the_tree = self.folders.contains(first);
        if !is_file && !begins_in_the_tree {
            return None;
        }
        let folder = Path::new(page).parent().unwrap_or(Path::new(""));
        let from_page = normal(&folder.join(relative)).is_some_and(|path| self.has(&path));
        let ending = format!("/{relative}");
        let mut all = self.files.iter().chain(&self.folders);
        let found = from_page || self.has(relative) || all.any(|path| path.ends_with(&ending));
        (!found).then(|| format!("there is no `{name}`"))
    }

    fn faults(&self, page: &str, text: &str) -> Vec<String> {
        let mut faults = Vec::new();
        let mut in_code = false;
        for (number, line) in prose(text) {
            // A span in backticks may go on in the next line of its paragraph.
            in_code &= !line.trim().is_empty();
            let wrong = links(line, in_code).filter_map(|link| self.wrong_link(page, link));
            let wrong = wrong.chain(names(line, in_code).filter_map(|name| self.wrong_name(page, name)));
            faults.extend(wrong.map(|fault| format!("{page}:{number}: {fault}")));
            in_code ^= line.matches('`').count() % 2 == 1;
        }
        faults
    }
}

fn name(path: &Path) -> String {
    path.components().map(|c| c.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// A path without `.` and `..`; none where it leaves the tree.
fn normal(path: &Path) -> Option<String> {
    let mut parts = Vec::new();
    for component in path.components() {
        match component {
            Component::Normal(part) => parts.push(part.to_string_lossy().into_owned()),
            Component::CurDir => {}
            Component::ParentDir => drop(parts.pop()?),
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(parts.join("/"))
}

/// The lines outside code blocks, with their numbers.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_code = false;
    text.lines().enumerate().filter_map(move |(index, line)| {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
            return None;
        }
        (!in_code).then_some((index + 1, line))
    })
}

/// Targets of `[text](target)` and `![text](target)` outside backticks; `in_code` says whether the line begins between two of them.
fn links(line: &str, in_code: bool) -> impl Iterator<Item = &str> {
    line.match_indices("](").filter_map(move |(at, _)| {
        let is_in_code = in_code ^ (line[..at].matches('`').count() % 2 == 1);
        let target = line[at + 2..].split_once(')')?.0;
        (!is_in_code).then_some(target.split_whitespace().next()?)
    })
}

/// What stands between backticks.
fn names(line: &str, in_code: bool) -> impl Iterator<Item = &str> {
    line.split('`').enumerate().filter(move |(index, _)| in_code ^ (index % 2 == 1)).map(|(_, piece)| piece)
}

/// The anchors that GitHub makes of the headings of a page.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (_, line) in prose(text).filter(|(_, line)| line.starts_with('#')) {
        let heading = line.trim_start_matches('#').trim().to_lowercase();
        let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        let anchor: String = kept.map(|c| if c == ' ' { '-' } else { c }).collect();
        let again = (1..).map(|n| format!("{anchor}-{n}")).find(|other| !found.contains(other));
        let is_new = found.insert(anchor);
        found.extend(again.filter(|_| !is_new));
    }
    found
}

fn walk(root: &Path, folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry")) {
        let path = entry.path();
        let is_folder = entry.file_type().expect("a type").is_dir();
        if !is_folder {
            files.push(path.strip_prefix(root).expect("below the root").to_owned());
        } else if !SKIPPED.contains(&entry.file_name().to_string_lossy().as_ref()) {
            walk(root, &path, files);
        }
    }
}

#[test]
fn links_and_names_of_files_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    walk(root, root, &mut files);
    let (pages, others): (Vec<String>, Vec<String>) =
        files.iter().map(|file| name(file)).partition(|file| file.ends_with(".md"));
    let read = |page: String| {
        let text = std::fs::read_to_string(root.join(&page)).expect("a page");
        (page, text)
    };
    let texts: BTreeMap<String, String> = pages.into_iter().map(read).collect();
    assert!(texts.len() > 40, "only {} pages are found", texts.len());
    let tree = Tree::new(&texts, others);
    let faults: Vec<String> = texts.iter().flat_map(|(page, text)| tree.faults(page, text)).collect();
    assert!(faults.is_empty(), "{} links or names lead nowhere:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn what_leads_nowhere_is_found() {
    let page = "# One `thing`, two\n[file](../b.md) [gone](gone.md) ![heading](../b.md#a-b) [no heading](../b.md#c)\n\
                [here](#one-thing-two) [out](../../x.md) [web](https://example.org/gone.md)\n\
                `src/lib.rs` `deep/mod.rs` `src/gone.rs` `src/gone/` `l/h on s/t` `q/r` `](gone.md)`\n\
                `a long\nspan](gone.md) src/gone.rs` [gone](too.md)\n\n\
                ```\n[code](gone.md) `src/gone.rs`\n```\n## A B\n## A B\n[second](#a-b-1) [third](#a-b-2)\n";
    let texts = BTreeMap::from([("docs/a.md".to_owned(), page.to_owned()), ("b.md".to_owned(), "# A: B!".to_owned())]);
    let tree = Tree::new(&texts, ["src/lib.rs", "src/deep/mod.rs"].map(str::to_owned));
    let expected = [
        "docs/a.md:2: there is no docs/gone.md",
        "docs/a.md:2: b.md has no heading #c",
        "docs/a.md:3: ../../x.md leaves the project",
        "docs/a.md:4: there is no `src/gone.rs`",
        "docs/a.md:4: there is no `src/gone/`",
        "docs/a.md:6: there is no docs/too.md",
        "docs/a.md:13: docs/a.md has no heading #a-b-2",
    ];
    assert_eq!(tree.faults("docs/a.md", page), expected);
}
