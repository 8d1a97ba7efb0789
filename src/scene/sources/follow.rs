//! Where a path leads once its links are resolved.

use std::path::{Component, Path, PathBuf};

/// Where a path leads.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Followed {
    /// A file, or a directory, that may be read.
    Found(PathBuf),
    /// Nothing is there, where something might be read.
    Missing,
    /// To a place that may not be read; whether something is there is not said.
    Outside(PathBuf),
}

/// Follows a path, links included; `may_be_read` says whether a place without links may be.
pub(crate) fn follow(path: &Path, may_be_read: impl Fn(&Path) -> bool) -> Followed {
    match path.canonicalize() {
        Ok(target) if may_be_read(&target) => Followed::Found(target),
        Ok(target) => Followed::Outside(target),
        Err(_) => match would_be(path) {
            target if may_be_read(&target) => Followed::Missing,
            target => Followed::Outside(target),
        },
    }
}

/// Where a path would lead if something were there: without `.` and `..`, and without links as far as it exists.
fn would_be(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).components() {
        match component {
            Component::ParentDir => drop(plain.pop()),
            Component::CurDir => {}
            other => plain.push(other),
        }
    }
    let real = |above: &Path| Some(above.canonicalize().ok()?.join(plain.strip_prefix(above).ok()?));
    let found = plain.ancestors().find_map(real);
    found.unwrap_or(plain)
}

/// Whether a place without links lies below one of some directories.
pub(crate) fn is_below_one<'a>(target: &Path, mut directories: impl Iterator<Item = &'a Path>) -> bool {
    directories.any(|directory| directory.canonicalize().is_ok_and(|directory| target.starts_with(directory)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_leads_where_it_would() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let here = root.canonicalize().expect("it is there");
        assert_eq!(would_be(&root.join("src/./none/../../missing.stl")), here.join("missing.stl"));
        let below = |target: &Path| is_below_one(target, [root].into_iter());
        assert_eq!(follow(&root.join("src/../Cargo.toml"), below), Followed::Found(here.join("Cargo.toml")));
        assert_eq!(follow(&root.join("src/../missing"), below), Followed::Missing);
        assert!(matches!(follow(&root.join("../missing"), below), Followed::Outside(_)));
        assert!(matches!(follow(&root.join(".."), below), Followed::Outside(_)));
    }
}
