//! A picture of a constraint graph as SVG, without scripts and files of others.

use crate::view::document::graph::{GraphEntry, TransitionKindEntry};
use std::fmt::Write;

/// What the picture looks like, light and dark.
const STYLE: &str = "\
text{font:12px ui-sans-serif,system-ui,sans-serif;fill:#1b1f24}
.state{fill:#f4f6f8;stroke:#57606a}
.waypoint{fill:#fff;stroke:#8c959f}
.label{font-size:10px;fill:#424a53;paint-order:stroke;stroke:#fff;stroke-width:4px}
.line{fill:none;stroke:#57606a;stroke-width:1.2}
.crossed{stroke-dasharray:5 3}
.loop{stroke:#8c959f}
.head{fill:#57606a}
.ground{fill:#fff}
@media (prefers-color-scheme:dark){
text{fill:#e6edf3}.ground{fill:#0d1117}.state{fill:#161b22;stroke:#8b949e}.waypoint{fill:#0d1117;stroke:#6e7681}
.label{fill:#c9d1d9;stroke:#0d1117}.line{stroke:#8b949e}.loop{stroke:#6e7681}.head{fill:#8b949e}
}";

/// The picture as a whole SVG document.
#[must_use]
pub fn svg(graph: &GraphEntry, title: &str) -> String {
    let note = if graph.left_out.is_some() { 22.0 } else { 0.0 };
    let (width, height) = (graph.width.ceil(), (graph.height + note).ceil());
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">\n\
         <title>{}</title>\n<style>{STYLE}</style>\n\
         <defs><marker id=\"head\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" \
         orient=\"auto-start-reverse\"><path class=\"head\" d=\"M0 0.6 L8 4 L0 7.4 Z\"/></marker></defs>\n\
         <rect class=\"ground\" width=\"{width}\" height=\"{height}\"/>\n",
        escaped(title)
    );
    for transition in &graph.transitions {
        let class = match transition.kind {
            TransitionKindEntry::Loop => "line loop",
            TransitionKindEntry::Regular => "line",
            TransitionKindEntry::Crossed => "line crossed",
        };
        let way: Vec<String> = transition.points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(
            out,
            "<polyline class=\"{class}\" points=\"{}\" marker-end=\"url(#head)\"><title>{}</title></polyline>",
            way.join(" "),
            escaped(&format!("{} [{}]", transition.words, transition.name))
        );
    }
    for mark in &graph.marks {
        if mark.w > 0.0 {
            let (x, y) = (mark.x - 0.5 * mark.w, mark.y - 0.5 * mark.h);
            let (w, h) = (mark.w, mark.h);
            let _ = writeln!(
                out,
                "<rect class=\"waypoint\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" rx=\"9\"/>"
            );
        }
        let (x, y, words) = (mark.x, mark.y + 3.5, escaped(&mark.words));
        let _ = writeln!(out, "<text class=\"label\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{words}</text>");
    }
    for state in &graph.states {
        let (x, y, w, h) = (state.x, state.y, state.w, state.h);
        let _ = writeln!(
            out,
            "<g><title>{}</title><rect class=\"state\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" rx=\"6\"/>",
            escaped(&state.name)
        );
        let first = y + 0.5 * h - 15.0 * (state.lines.len() as f64 - 1.0) * 0.5 + 4.0;
        for (number, line) in state.lines.iter().enumerate() {
            let (x, y, line) = (x + 0.5 * w, first + 15.0 * number as f64, escaped(line));
            let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{line}</text>");
        }
        out.push_str("</g>\n");
    }
    if let Some(note) = &graph.left_out {
        let y = graph.height + 12.0;
        let _ = writeln!(out, "<text class=\"label\" x=\"16\" y=\"{y:.1}\">{}</text>", escaped(note));
    }
    out.push_str("</svg>\n");
    out
}

/// Text as XML has it; what XML has no sign for is a space.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | ' '.. if !('\u{fffe}'..='\u{ffff}').contains(&letter) => out.push(letter),
            _ => out.push(' '),
        }
    }
    out
}
