//! Promise: no two files of a crate use each other, directly or through others; folders, files and functions stay small.

#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

#[path = "common/imports/mod.rs"]
mod imports;

use imports::{Crate, circles};
use std::path::{Path, PathBuf};

/// Most entries of a folder besides its page.
const ENTRIES: usize = 12;
/// Most lines of a file.
const LINES: usize = 400;
/// Most lines of a function that does not say why it has more.
const FUNCTION: usize = 60;
const CRATES: [&str; 5] = ["components/src", "systems/kernels/src", "systems/src", "systems/schedulers/src", "src"];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn no_file_uses_a_file_that_uses_it() {
    for folder in CRATES {
        let sources = Crate::read(&root().join(folder), &[]);
        let (files, edges) = (sources.files().len(), sources.edges());
        // A parser that finds nothing would find no circle either.
        assert!(edges.len() > files, "{folder}: {} edges between {files} files", edges.len());
        let found = circles(&edges);
        assert!(found.is_empty(), "{folder} has {} circles: {found:#?}", found.len());
    }
}

#[test]
fn circles_are_found() {
    let folder = std::env::temp_dir().join(format!("foliate-circles-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("room")).expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("a file");
    write("lib.rs", "pub mod alone; pub mod room;");
    write("alone.rs", "use crate::room::Two; pub struct Alone(Two);");
    write("room/mod.rs", "mod one; mod two; mod three; pub use two::Two;");
    write("room/one.rs", "use crate::room::Two; pub struct One(Two);");
    write("room/two.rs", "pub struct Two; impl Two { fn three() { super::three::three() } }");
    write("room/three.rs", "pub fn three() {} #[cfg(test)] mod tests { use crate::room::one::One; }");
    let open = circles(&Crate::read(&folder, &[]).edges());
    assert!(open.is_empty(), "{open:?}");
    write("room/three.rs", "pub fn three() { let _ = crate::room::one::One; }");
    let closed = circles(&Crate::read(&folder, &[]).edges());
    std::fs::remove_dir_all(&folder).expect("the folder goes");
    assert_eq!(closed.len(), 1);
    assert_eq!(closed[0].len(), 3, "{closed:?}");
}

#[test]
fn folders_files_and_functions_stay_small() {
    let mut large = Vec::new();
    for folder in CRATES {
        measure(&root().join(folder), &mut large);
    }
    assert!(large.is_empty(), "{large:#?}");
}

fn measure(folder: &Path, large: &mut Vec<String>) {
    let entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    let is_page = |path: &&PathBuf| ["mod.rs", "lib.rs", "main.rs"].iter().any(|page| path.ends_with(page));
    let count = entries.iter().filter(|path| !is_page(path)).count();
    if count > ENTRIES {
        large.push(format!("{}: {count} entries", folder.display()));
    }
    for path in entries {
        if path.is_dir() {
            measure(&path, large);
        } else {
            let text = std::fs::read_to_string(&path).expect("a source");
            if text.lines().count() > LINES {
                large.push(format!("{}: {} lines", path.display(), text.lines().count()));
            }
            let long = long_functions(&text).into_iter();
            large.extend(long.map(|(line, lines)| format!("{}:{line}: a function of {lines} lines", path.display())));
        }
    }
}

/// Where a function starts that is long and has no comment in front of it that says why (`// Long: ...`), and its lines. Reads
/// formatted sources: a function ends at the brace that stands as far in as it begins.
fn long_functions(text: &str) -> Vec<(usize, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut long = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        let code = line.trim_start();
        let is_visibility = |word: &str| word == "const" || word.starts_with("pub");
        let is_function = code.split(' ').find(|word| !is_visibility(word)) == Some("fn");
        if !is_function || code.ends_with([';', '}']) {
            continue;
        }
        let end = format!("{}}}", &line[..line.len() - code.len()]);
        let body = lines[number..].iter().position(|line| **line == end);
        let count = body.map_or(1, |last| last + 1);
        let before = lines[..number].iter().rev().take_while(|line| {
            let line = line.trim_start();
            line.starts_with("//") || line.starts_with("#[")
        });
        if count > FUNCTION && !before.into_iter().any(|line| line.trim_start().starts_with("// Long: ")) {
            long.push((number + 1, count));
        }
    }
    long
}

#[test]
fn long_functions_are_found() {
    let body = "        step();\n".repeat(FUNCTION);
    let method = format!("impl A {{\n    pub(crate) fn long(&self) {{\n{body}    }}\n    fn short() {{}}\n}}\n");
    assert_eq!(long_functions(&method), [(2, FUNCTION + 2)]);
    assert_eq!(long_functions(&method.replace("    pub(crate)", "    // Long: it is one list.\n    pub(crate)")), []);
}
