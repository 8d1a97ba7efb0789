//! The constraint graph as text for Graphviz (DOT) and Mermaid.

use foliate_components::graph::{ConstraintGraph, TransitionKind};
use std::fmt::Write;

/// DOT, for `dot -Tsvg`. Crossed transitions are dashed, loops dotted; waypoints stand on the edges' labels.
#[must_use]
pub fn dot(graph: &ConstraintGraph) -> String {
    let mut text = String::from("digraph constraint_graph {\n  rankdir=LR;\n  node [shape=box, style=rounded];\n");
    for (id, state) in graph.states_of_nodes() {
        let index = id.at();
        let _ =
            writeln!(text, "  s{index} [label=\"{}\\n{}\"];", escape(&state.name), escape(&leaf_line(graph, index)));
    }
    for transition in &graph.transitions {
        let style = match transition.kind {
            TransitionKind::Loop => "dotted",
            TransitionKind::Regular => "solid",
            TransitionKind::Crossed => "dashed",
        };
        let (from, to, name) = (transition.from.0, transition.to.0, escape(&transition.name));
        let waypoints = transition.legs.len().saturating_sub(1);
        let _ = writeln!(
            text,
            "  s{from} -> s{to} [style={style}, label=\"{name}\", tooltip=\"{waypoints} waypoints, weight {:.3}\"];",
            transition.weight
        );
    }
    text.push_str("}\n");
    text
}

/// Mermaid, for Markdown pages.
#[must_use]
pub fn mermaid(graph: &ConstraintGraph) -> String {
    let mut text = String::from("flowchart LR\n");
    for (id, state) in graph.states_of_nodes() {
        let index = id.at();
        let _ = writeln!(text, "  s{index}[\"{}<br/>{}\"]", quoted(&state.name), quoted(&leaf_line(graph, index)));
    }
    for transition in &graph.transitions {
        let arrow = match transition.kind {
            TransitionKind::Crossed => "-.->",
            TransitionKind::Loop | TransitionKind::Regular => "-->",
        };
        let _ =
            writeln!(text, "  s{} {arrow}|\"{}\"| s{}", transition.from.0, quoted(&transition.name), transition.to.0);
    }
    text
}

/// What gives the leaves of a state their values.
fn leaf_line(graph: &ConstraintGraph, state: usize) -> String {
    let names: Vec<_> = graph.states[state].foliation.iter().map(|&c| graph.constraint(c).name.as_str()).collect();
    if names.is_empty() { "one leaf".into() } else { format!("leaves: {}", names.join(", ")) }
}

fn escape(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"")
}

fn quoted(text: &str) -> String {
    text.replace('"', "#quot;").replace('|', "#124;")
}
