//! Promise: pictures of constraint graphs are well-formed SVG, the same every time, and can be read: boxes lie apart, large graphs say what
//! they leave out.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

use common::published_models;
use foliate::components::graph::ConstraintGraph;
use foliate::components::samples;
use foliate::inspection::words::ShortNames;
use foliate::scene::{PackagePath, Scene};
use foliate::view::{GraphEntry, PictureOptions, grown_graph, picture, svg};
use std::time::Instant;

fn drawn(graph: &ConstraintGraph, names: &ShortNames, options: &PictureOptions, title: &str) -> (GraphEntry, String) {
    let entry = picture(graph, names, options);
    let text = svg(&entry, title);
    let again = svg(&picture(graph, names, options), title);
    assert_eq!(text, again, "{title}");
    (entry, text)
}

fn is_readable(entry: &GraphEntry, text: &str, title: &str) {
    let document = roxmltree::Document::parse(text).unwrap_or_else(|e| panic!("{title}: {e}"));
    let boxes = document.descendants().filter(|node| node.attribute("class") == Some("state")).count();
    assert_eq!(boxes, entry.states.len(), "{title}");
    let lines = document.descendants().filter(|node| node.tag_name().name() == "polyline").count();
    assert_eq!(lines, entry.transitions.len(), "{title}");
    for (number, a) in entry.states.iter().enumerate() {
        for b in &entry.states[number + 1..] {
            let apart = a.x + a.w <= b.x || b.x + b.w <= a.x || a.y + a.h <= b.y || b.y + b.h <= a.y;
            assert!(apart, "{title}: {} and {}", a.name, b.name);
        }
    }
    let boxes = entry.marks.iter().filter(|mark| mark.w > 0.0);
    for mark in boxes {
        for state in &entry.states {
            let (x, y) = (mark.x - 0.5 * mark.w, mark.y - 0.5 * mark.h);
            let apart =
                x + mark.w <= state.x || state.x + state.w <= x || y + mark.h <= state.y || state.y + state.h <= y;
            assert!(apart, "{title}: {} and {}", mark.words, state.name);
        }
    }
}

#[test]
fn graphs_of_embedded_scenes_are_drawn() {
    for name in ["demo", "stack", "drawer"] {
        let scene = Scene::load(name, &PackagePath::default()).unwrap();
        let graph = grown_graph(&scene.problem).unwrap();
        let names = ShortNames::of(&scene.problem.robot, &graph);
        for waypoints in [false, true] {
            let options = PictureOptions { waypoints, ..PictureOptions::default() };
            let (entry, text) = drawn(&graph, &names, &options, name);
            is_readable(&entry, &text, name);
            assert_eq!(entry.left_out, None);
            assert_eq!(entry.states.len(), graph.states_of_nodes().count());
            assert_eq!(entry.transitions.len(), graph.transitions.len());
            let shown = entry.marks.iter().any(|mark| mark.w > 0.0);
            assert_eq!(shown, waypoints, "{name}");
        }
        let (_, text) = drawn(&graph, &names, &PictureOptions::default(), "a < b & \"c\"");
        assert!(text.contains("a &lt; b &amp; &quot;c&quot;"));
    }
}

#[test]
fn graphs_of_published_scenes_are_drawn() {
    let Some(packages) = published_models("graphs_of_published_scenes_are_drawn") else { return };
    for shipped in foliate::scene::shipped_scenes() {
        let scene = Scene::load(shipped.name, &packages).unwrap();
        let graph = grown_graph(&scene.problem).unwrap();
        let started = Instant::now();
        let names = ShortNames::of(&scene.problem.robot, &graph);
        let (entry, text) = drawn(&graph, &names, &PictureOptions::default(), shipped.name);
        println!(
            "{}: {} states, {} transitions, {:.0?} twice",
            shipped.name,
            entry.states.len(),
            entry.transitions.len(),
            started.elapsed()
        );
        is_readable(&entry, &text, shipped.name);
    }
}

#[test]
fn a_large_graph_says_what_it_leaves_out() {
    for (title, problem) in
        [("whole", samples::crowd(3, 3).unwrap()), ("lazy", samples::eight_arms_and_ten_boxes().unwrap())]
    {
        let graph = grown_graph(&problem).unwrap();
        assert_eq!(graph.lazy, title == "lazy");
        assert!(graph.states_of_nodes().count() > 20, "{title}");
        let names = ShortNames::of(&problem.robot, &graph);
        let options = PictureOptions { most_states: 20, ..PictureOptions::default() };
        let (entry, text) = drawn(&graph, &names, &options, title);
        is_readable(&entry, &text, title);
        assert!(entry.states.len() <= 20);
        let left_out = entry.left_out.expect("it says so");
        assert!(left_out.contains("states are shown") && text.contains("states are shown"), "{left_out}");
    }
}
