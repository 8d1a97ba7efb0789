//! Promise: `docs/path-file.md` describes every key of a path file, and every verdict, section and kind of violation of a check.

const REFERENCE: &str = include_str!("../docs/path-file.md");
const KEYS: [&str; 2] = [include_str!("../src/path_file/document.rs"), include_str!("../src/path_file/constraint.rs")];
const WORDS: &str = include_str!("../src/check/report/kind.rs");

fn is_described(word: &str) -> bool {
    REFERENCE.contains(&format!("`{word}`"))
}

#[test]
fn every_key_is_described() {
    let fields = |source: &'static str| source.lines().filter_map(|line| line.trim().strip_prefix("pub "));
    let keys = KEYS.into_iter().flat_map(fields).filter_map(|field| field.split_once(": ").map(|(name, _)| name));
    let keys: Vec<&str> = keys.filter(|key| !key.contains(' ')).collect();
    assert!(keys.len() > 60, "the sources have other keys: {keys:?}");
    let missing: Vec<_> = keys.into_iter().filter(|key| !is_described(key)).collect();
    assert!(missing.is_empty(), "docs/path-file.md does not describe {missing:?}");
}

#[test]
fn every_verdict_section_and_kind_is_described() {
    let words = WORDS.lines().filter_map(|line| line.split_once("=> \"")?.1.split_once('"').map(|(word, _)| word));
    let words: Vec<&str> = words.collect();
    assert!(words.len() > 40, "the source has other words: {words:?}");
    let missing: Vec<_> = words.into_iter().filter(|word| !is_described(word)).collect();
    assert!(missing.is_empty(), "docs/path-file.md does not describe {missing:?}");
}
