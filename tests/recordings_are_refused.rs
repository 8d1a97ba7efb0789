//! Promise: a recording that is cut off, changed or made up is refused with the place and the reason, or read; never a panic, never more
//! memory than the file is worth.

#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

#[path = "common/recorded.rs"]
mod recorded;

use foliate::recording::Recording;
use recorded::{Folder, planner, recorded};
use std::path::Path;

fn good() -> Recording {
    recorded(&planner("mrrt").seed(1).record().solve(), "mrrt", 1)
}

fn refused(bytes: &[u8]) -> String {
    Recording::of_bytes(Path::new("bad.search"), bytes).expect_err("it is bad").to_string()
}

/// The bytes of a recording whose head says something else.
fn with_head(recording: &Recording, change: impl FnOnce(&mut serde_json::Value)) -> Vec<u8> {
    let bytes = recording.to_bytes().expect("finite");
    let end = bytes.iter().position(|&byte| byte == b'\n').expect("a head");
    let mut head = serde_json::from_slice(&bytes[..end]).expect("JSON");
    change(&mut head);
    let mut changed = serde_json::to_vec(&head).expect("JSON");
    changed.extend(&bytes[end..]);
    changed
}

#[test]
fn what_is_cut_off_or_longer_is_refused() {
    let bytes = good().to_bytes().expect("finite");
    let head = bytes.iter().position(|&byte| byte == b'\n').expect("a head");
    for length in [0, 1, head / 2, head] {
        assert!(refused(&bytes[..length]).contains("no line with a head"), "{length}");
    }
    for length in [head + 1, head + 2, bytes.len() - 4, bytes.len() - 1] {
        assert!(refused(&bytes[..length]).contains("are announced"), "{length}");
    }
    assert!(refused(&[&bytes[..], &[0]].concat()).contains("are announced"));
    assert!(refused(b"\n").contains("EOF"));
    assert!(refused(b"\xff\n").contains("UTF-8"));
}

#[test]
fn heads_that_do_not_fit_are_refused_with_their_place() {
    let good = good();
    let huge = u64::MAX;
    type Change = Box<dyn Fn(&mut serde_json::Value)>;
    let set =
        |key: &'static str, value: serde_json::Value| -> Change { Box::new(move |head| head[key] = value.clone()) };
    let cases: Vec<(Change, &str)> = vec![
        (set("format", "foliate.search/9".into()), "`foliate.search/9`"),
        (set("format", 3.into()), "format"),
        (set("nodes", huge.into()), "announces too much"),
        (set("edges", (huge / 17).into()), "announces too much"),
        (set("collisions", 1_000_000_000_u64.into()), "are announced"),
        (set("width", (u32::MAX as u64).into()), "announce"),
        (set("nodes", 0.into()), "are announced"),
        (set("still", serde_json::json!([1.0])), "width"),
        (set("start", serde_json::json!([1.0])), "start"),
        (set("unknown", 1.into()), "unknown"),
        (set("states", serde_json::json!([])), "transitions[0]"),
        (set("outcome", serde_json::Value::Null), "outcome"),
        (Box::new(|head| head["path"]["format"] = "foliate.path/7".into()), "path"),
        (Box::new(|head| head["funnel"][0]["transition"] = 4_000_000_000_u64.into()), "funnel[0]"),
        (Box::new(|head| head["funnel"][0]["pairs"][0]["at"] = 4_000_000_000_u64.into()), "funnel[0]"),
        (Box::new(|head| head["transitions"][0]["to"] = 70_000.into()), "transitions[0]"),
        (Box::new(|head| head["roots"]["goals"][0] = 4_000_000_000_u64.into()), "roots"),
    ];
    for (number, (change, place)) in cases.into_iter().enumerate() {
        let mut has_pairs = good.clone();
        // A row with a pair, whatever the search met.
        has_pairs.head.funnel.sort_by_key(|row| row.pairs.is_empty());
        let told = refused(&with_head(&has_pairs, |head| change(head)));
        assert!(told.starts_with("bad.search: ") && told.contains(place) && told.len() < 500, "case {number}: {told}");
    }
}

#[test]
fn columns_that_do_not_fit_are_refused_with_their_place() {
    let whole = good();
    type Change = fn(&mut Recording);
    let cases: [(Change, &str); 7] = [
        (|r| r.nodes.states[2] = 60_000, "node 2"),
        (|r| r.edges.to[1] = u32::MAX, "edge 1"),
        (|r| r.edges.from[0] = r.nodes.len() as u32, "edge 0"),
        (|r| r.edges.transitions[3] = 60_000, "edge 3"),
        (|r| r.nodes.configurations[5] = f32::NAN, "number 5"),
        (|r| r.nodes.configurations[7] = f32::INFINITY, "number 7"),
        (|r| r.collisions[0] = f32::NEG_INFINITY, "is not finite"),
    ];
    for (change, place) in cases {
        let mut bad = whole.clone();
        change(&mut bad);
        let told = refused(&bad.to_bytes().expect("the head is finite"));
        assert!(told.contains(place), "{place}: {told}");
    }
    let mut bytes = whole.to_bytes().expect("finite");
    let kinds = bytes.len() - 4 * whole.collisions.len() - whole.edges.len();
    bytes[kinds + 1] = 9;
    assert!(refused(&bytes).contains("edge 1: 9 is no kind of edge"), "{}", refused(&bytes));
}

/// Trees, sides and leaves are labels: any numbers are shown, without memory for all that lie between them.
#[test]
fn labels_may_be_any_numbers() {
    let mut odd = good();
    for (node, (tree, side)) in odd.nodes.trees.iter_mut().zip(&mut odd.nodes.sides).enumerate() {
        (*tree, *side) = (u32::MAX - node as u32, u32::MAX);
    }
    odd.head.roots.goals = (0..odd.nodes.len() as u32).cycle().take(100_000).collect();
    let odd = Recording::of_bytes(Path::new("odd"), &odd.to_bytes().expect("finite")).expect("it fits together");
    let taken = allocation_counter::measure(|| drop(odd.shown()));
    assert!(taken.bytes_max < 32 << 20, "{} bytes", taken.bytes_max);
}

#[test]
fn a_long_chain_of_trees_is_shown_in_no_time() {
    let count = 200_000_u32;
    let mut chain = good();
    let (width, states) = (chain.head.width, vec![0; count as usize]);
    chain.nodes.configurations = vec![0.0; width * count as usize];
    (chain.nodes.leaves, chain.nodes.sides, chain.nodes.steps) = (states.clone(), states.clone(), states.clone());
    (chain.nodes.states, chain.nodes.trees) = (states, (0..count).collect());
    chain.edges.from = (1..count).rev().collect();
    chain.edges.to = (0..count - 1).rev().collect();
    chain.edges.transitions = vec![0; count as usize - 1];
    chain.edges.steps = vec![0; count as usize - 1];
    chain.edges.kinds = vec![foliate::planner::EdgeKind::Certified; count as usize - 1];
    let started = std::time::Instant::now();
    let shown = chain.shown();
    assert_eq!(shown.joins.len(), count as usize - 1);
    assert!(shown.tree.iter().all(|&tree| tree == shown.tree[0]));
    assert!(started.elapsed().as_secs() < 10, "{:?}", started.elapsed());
}

#[test]
fn what_is_no_regular_file_is_refused() {
    let folder = Folder::new("irregular");
    let told = |path: &Path| Recording::read(path).expect_err("no recording").to_string();
    assert!(told(&folder.0).contains("is not a regular file"));
    assert!(told(&folder.0.join("missing")).contains("missing"));
    #[cfg(unix)]
    assert!(told(Path::new("/dev/zero")).contains("is not a regular file"));
    // Longer than what is read, without its bytes on disk.
    let large = folder.0.join("large.search");
    std::fs::File::create(&large).and_then(|file| file.set_len((1 << 28) + 1)).expect("a sparse file");
    assert!(told(&large).contains("are more than"), "{}", told(&large));
}
