//! Files that use each other, directly or through others.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

type Edges = BTreeMap<(PathBuf, PathBuf), BTreeSet<String>>;

/// Sets of two and more files of which each reaches each, with the edges between them.
pub fn circles(edges: &Edges) -> Vec<Vec<String>> {
    let files: BTreeSet<&PathBuf> = edges.keys().flat_map(|(from, to)| [from, to]).collect();
    let reached: BTreeMap<&PathBuf, BTreeSet<&PathBuf>> =
        files.iter().map(|&file| (file, reached_from(edges, file))).collect();
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for &file in &files {
        // A file that reaches itself lies on a circle.
        if !reached[file].contains(file) || seen.contains(file) {
            continue;
        }
        let circle: BTreeSet<&PathBuf> =
            reached[file].iter().copied().filter(|other| reached[other].contains(file)).collect();
        seen.extend(circle.iter().copied());
        let inside = edges.iter().filter(|((from, to), _)| circle.contains(from) && circle.contains(to));
        let told = |((from, to), names): (&(PathBuf, PathBuf), &BTreeSet<String>)| {
            format!("{} -> {}: {names:?}", from.display(), to.display())
        };
        found.push(inside.map(told).collect());
    }
    found
}

fn reached_from<'e>(edges: &'e Edges, file: &PathBuf) -> BTreeSet<&'e PathBuf> {
    let mut reached = BTreeSet::new();
    let mut open = vec![file];
    while let Some(from) = open.pop() {
        for ((_, to), _) in edges.range((from.clone(), PathBuf::new())..).take_while(|((f, _), _)| f == from) {
            if reached.insert(to) {
                open.push(to);
            }
        }
    }
    reached
}
