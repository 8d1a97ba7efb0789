//! Promise: what the crates show to others changes only on purpose. `docs/api` has the listing of each; after a change that is
//! meant, `FOLIATE_API=write cargo test --test public_api` writes them anew.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/api/mod.rs"]
mod api;

use std::collections::BTreeSet;
use std::path::PathBuf;

const CRATES: [(&str, &str); 5] = [
    ("foliate", "src"),
    ("foliate_schedulers", "systems/schedulers/src"),
    ("foliate_systems", "systems/src"),
    ("foliate_kernels", "systems/kernels/src"),
    ("foliate_components", "components/src"),
];

/// Most differences that are told.
const TOLD: usize = 20;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_listings_are_those_of_the_sources() {
    let mut told = Vec::new();
    for (name, folder) in CRATES {
        let lines = api::list(&root().join(folder));
        let file = root().join("docs/api").join(format!("{name}.txt"));
        if std::env::var_os("FOLIATE_API").is_some_and(|wish| wish == "write") {
            std::fs::create_dir_all(root().join("docs/api")).unwrap();
            std::fs::write(&file, lines.join("\n") + "\n").unwrap();
        }
        let kept = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let (kept, now): (BTreeSet<&str>, BTreeSet<&str>) =
            (kept.lines().collect(), lines.iter().map(String::as_str).collect());
        told.extend(kept.difference(&now).map(|line| format!("- {name}::{line}")));
        told.extend(now.difference(&kept).map(|line| format!("+ {name}::{line}")));
    }
    let more = told.len().saturating_sub(TOLD);
    told.truncate(TOLD);
    assert!(
        told.is_empty(),
        "the public interface differs from docs/api (and {more} lines more); if that is meant: \
         FOLIATE_API=write cargo test --test public_api\n{}",
        told.join("\n")
    );
}

/// A lister that finds nothing would never differ.
#[test]
fn the_lister_sees_what_others_can_name_and_nothing_else() {
    let folder = std::env::temp_dir().join(format!("foliate-api-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("room")).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    write("lib.rs", "pub mod room; mod hidden; pub use hidden::Shown as Renamed; pub use std::fmt; mod prelude;");
    write(
        "hidden.rs",
        "use crate::room::Error; #[derive(Debug)] #[non_exhaustive] pub struct Shown { pub a: Vec<u8>, b: u8 } \
         pub struct Unseen; impl Shown { pub fn new(a: u8, // first\n) -> Self {} fn own(&self) {} } impl Drop for Shown {} \
         impl Error { pub fn told(&self) {} }",
    );
    write(
        "room/mod.rs",
        "pub(crate) mod deep; pub use self::deep::Error; pub fn f<T: Copy>(t: T) {} fn g() {} #[cfg(test)] mod tests;",
    );
    write(
        "room/deep.rs",
        "pub enum Error { Io(String), At { line: u32 } } pub trait T: Copy { const N: usize; fn must(&self); fn may(&self) {} }",
    );
    write("prelude.rs", "");
    let lines = api::list(&folder);
    std::fs::remove_dir_all(&folder).unwrap();
    let expected = [
        "Renamed impl: Drop for Shown",
        "Renamed.a: Vec<u8>",
        "Renamed: #[derive(Debug)] #[non_exhaustive] struct",
        "Renamed::new: fn new(a: u8) -> Self",
        "fmt: use std::fmt",
        "room: mod",
        "room::Error: enum",
        "room::Error::At: variant {line: u32}",
        "room::Error::Io: variant {0: String}",
        "room::Error::told: fn told(&self)",
        "room::f: fn f<T: Copy>(t: T)",
    ];
    assert_eq!(lines, expected);
}
