//! Promise: without a path `foliate solve` says what was asked, how far the search got from either side, and what may help; counters of the
//! search are printed with `--verbose` alone.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

#[path = "common/demo.rs"]
mod demo;

use demo::{Demo, SCENE};

/// The demo with a start of the first box, and a goal for it alone.
fn scene(start: &str, goal: &str) -> String {
    let (head, _) = SCENE.split_once("[[goal]]").unwrap();
    let from = head.find("box1 = { xyz").unwrap();
    let to = from + head[from..].find('\n').unwrap();
    format!(
        "{}box1 = {{ xyz = {start} }}{}[[goal]]\nobjects = {{ box1 = {{ xyz = {goal} }} }}\n",
        &head[..from],
        &head[to..]
    )
}

#[test]
fn a_box_out_of_reach_is_told_with_what_may_help() {
    let demo = Demo::new("told-to-people");
    demo.write("scene.toml", &scene("[0.87, 0.55, 0.741]", "[0.50, 0.10, 0.741]"));
    let said = demo.run(&["solve", "scene.toml", "--time-limit", "3"]);
    assert_eq!(said.code, 1, "{} {}", said.out, said.err);
    assert!(said.err.contains("note: `box1` is likely out of reach where it starts: "), "{}", said.err);
    for words in [
        "  asked:\n    box1 at (0.500, 0.100, 0.741)\n",
        "`box1` was never grasped where it starts: ",
        "    from the start: hardest is \"robot/",
        "    from the goal: ",
        "  what may help:\n",
        "more time: --time-limit",
    ] {
        assert!(said.out.contains(words), "{words}:\n{}", said.out);
    }
    assert!(!said.out.contains("funnel") && !said.out.contains(" candidates, "), "{}", said.out);
    let verbose = demo.run(&["solve", "scene.toml", "--time-limit", "3", "--verbose"]);
    assert!(verbose.out.contains("funnel (candidates") && verbose.out.contains(" candidates, "), "{}", verbose.out);
    // Names of files stand beside the words.
    assert!(verbose.out.contains("(robot/left_hand > box1/top | "), "{}", verbose.out);
}

#[test]
fn a_solved_scene_prints_counters_where_they_are_asked_for() {
    let demo = Demo::new("counters");
    demo.write("scene.toml", SCENE);
    let [plain, verbose] = [&["solve", "scene.toml", "--first"][..], &["solve", "scene.toml", "--first", "--verbose"]]
        .map(|arguments| demo.run(arguments));
    assert_eq!((plain.code, verbose.code), (0, 0));
    assert!(!plain.out.contains("funnel") && !plain.out.contains("what may help"), "{}", plain.out);
    assert!(verbose.out.contains("funnel (candidates"), "{}", verbose.out);
}
