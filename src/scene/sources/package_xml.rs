//! Which directory is which package, by its `package.xml`: going up from a file, or down from the search list.

use crate::scene::reading::input;
use crate::scene::reading::xml::{Xml, elements};
use foliate_systems::events::StopSignal;
use std::path::{Component, Path, PathBuf};

/// Largest `package.xml` that is read, bytes.
const CAP: u64 = 1 << 16;
/// Most directories above a file that may be its package.
const LEVELS: usize = 16;
/// How deep below a directory of the search list packages are looked for.
const DEPTH: usize = 3;
/// Most directories that are looked into below the search list.
const DIRECTORIES: usize = 10_000;

/// The name in the `package.xml` of a directory, where there is one.
pub(crate) fn name_in(directory: &Path) -> Option<String> {
    let content = input::bytes(&directory.join("package.xml"), CAP).ok()?;
    let text = String::from_utf8(content).ok()?;
    let xml = Xml::parse("package.xml", &text, &StopSignal::default()).ok()?;
    let root = xml.document.root_element();
    let name = elements(root, "name").next()?.text()?.trim();
    (root.has_tag_name("package") && !name.is_empty()).then(|| name.to_owned())
}

/// The directories that may be the package of what lies in a directory, that itself included, nearest first. The argument has no
/// links.
///
/// A file must not make a package of all that its user owns: the user's home, the system's folder of temporary files, what holds
/// them, and what lies at the root of the file system are none.
pub(crate) fn above(directory: &Path) -> impl Iterator<Item = &Path> {
    let kept = [std::env::home_dir(), Some(std::env::temp_dir())].into_iter().flatten();
    let kept: Vec<PathBuf> = kept.filter_map(|kept| kept.canonicalize().ok()).collect();
    let may_be_one = move |directory: &&Path| {
        let depth = directory.components().filter(|c| matches!(c, Component::Normal(_))).count();
        depth >= 2 && !kept.iter().any(|kept| kept.starts_with(directory))
    };
    directory.ancestors().take(LEVELS).take_while(may_be_one)
}

/// The nearest directory above what lies in a directory that has a `package.xml`, that itself included.
pub(crate) fn holder(directory: &Path) -> Option<&Path> {
    above(directory).find(|directory| name_in(directory).is_some())
}

/// The packages below directories, whose folders may have other names: name and directory. They are looked for once.
#[derive(Debug, Default)]
pub(crate) struct PackagesBelow(Option<Vec<(String, PathBuf)>>);

impl PackagesBelow {
    /// The directories of the packages of a name, in the order of the search list, then of names.
    pub fn named(&mut self, package: &str, list: &[&Path]) -> Vec<PathBuf> {
        let found = self.0.get_or_insert_with(|| below(list));
        found.iter().filter(|(name, _)| name == package).map(|(_, directory)| directory.clone()).collect()
    }
}

/// Looks for packages; as ROS does, not within packages nor in hidden directories.
fn below(list: &[&Path]) -> Vec<(String, PathBuf)> {
    let (mut found, mut looked_into) = (Vec::new(), 0);
    let mut stack: Vec<(PathBuf, usize)> = list.iter().rev().map(|directory| (directory.to_path_buf(), 0)).collect();
    while let Some((directory, depth)) = stack.pop() {
        looked_into += 1;
        if looked_into > DIRECTORIES {
            break;
        }
        if let Some(name) = name_in(&directory) {
            found.push((name, directory));
            continue;
        }
        if depth == DEPTH {
            continue;
        }
        let Ok(entries) = std::fs::read_dir(&directory) else { continue };
        let is_shown = |path: &PathBuf| path.file_name().is_some_and(|name| !name.as_encoded_bytes().starts_with(b"."));
        let mut within: Vec<PathBuf> = entries.take(DIRECTORIES).filter_map(|entry| Some(entry.ok()?.path())).collect();
        within.retain(|path| is_shown(path) && path.is_dir());
        within.sort_unstable_by(|a, b| b.cmp(a));
        stack.extend(within.into_iter().map(|directory| (directory, depth + 1)));
    }
    found
}
