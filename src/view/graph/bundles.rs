//! Transitions between two states that are about the same gripper and handle share one line of the layout.

use crate::view::document::graph::MarkEntry;
use crate::view::graph::layout::{Line, Placed};
use crate::view::graph::lines::{around, between};
use foliate_components::graph::TransitionId;
use std::collections::BTreeMap;

/// Size of a letter and of a line of text beside lines.
const LETTER: f64 = 5.6;
const ROW: f64 = 14.0;

/// Transitions that share a line.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bundle {
    /// Those in the direction of the line.
    pub down: Vec<TransitionId>,
    /// Those against it.
    pub up: Vec<TransitionId>,
    /// The lines one after the other, and the boxes between them.
    lines: Vec<usize>,
    waypoints: Vec<usize>,
}

/// Boxes and lines of a picture.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drawing {
    /// States, then waypoints.
    pub boxes: Vec<Placed>,
    pub lines: Vec<Line>,
    /// By the states' places, the lower first, and what the transitions are about.
    pub bundles: BTreeMap<(usize, usize, String), Bundle>,
    /// What is written in boxes of waypoints and beside lines.
    waypoint_words: Vec<String>,
    line_words: Vec<String>,
    states: usize,
}

impl Drawing {
    /// Adds a line for every bundle, by way of its waypoints; `told` says what is written beside it, and the waypoints on the way down.
    pub fn add_lines(&mut self, depth: &[usize], told: impl Fn(&Bundle) -> (String, Vec<String>)) {
        self.states = self.boxes.len();
        let Self { boxes, lines, bundles, waypoint_words, line_words, .. } = self;
        for (&(a, b, _), bundle) in bundles {
            let (upper, lower) = if (depth[a], a) < (depth[b], b) { (a, b) } else { (b, a) };
            let (words, waypoints) = told(bundle);
            let mut from = upper;
            for waypoint in waypoints {
                boxes.push(Placed {
                    w: waypoint.chars().count() as f64 * LETTER + 12.0,
                    h: ROW + 6.0,
                    ..Placed::default()
                });
                waypoint_words.push(waypoint);
                bundle.waypoints.push(boxes.len() - 1);
                bundle.lines.push(lines.len());
                lines.push(Line { from, to: boxes.len() - 1, ..Line::default() });
                line_words.push(String::new());
                from = boxes.len() - 1;
            }
            let width = if words.is_empty() { 0.0 } else { words.chars().count() as f64 * LETTER + 18.0 };
            let label = [width, if words.is_empty() { 0.0 } else { ROW }];
            bundle.lines.push(lines.len());
            lines.push(Line { from, to: lower, label, ..Line::default() });
            line_words.push(words);
        }
    }

    /// The way of a transition, once everything has its place.
    pub fn points(&self, id: TransitionId, from: usize, to: usize, loops: usize) -> Vec<[f64; 2]> {
        if from == to {
            return around(&self.boxes[from], loops);
        }
        let mut candidates = self.bundles.range((from.min(to), from.max(to), String::new())..);
        let found = candidates.find_map(|(_, bundle)| {
            let track = |ids: &[TransitionId]| ids.iter().position(|&other| other == id);
            track(&bundle.down).map(|track| (bundle, true, track)).or(track(&bundle.up).map(|t| (bundle, false, t)))
        });
        let Some((bundle, is_down, track)) = found else { return Vec::new() };
        let mut bends = Vec::new();
        for (number, &line) in bundle.lines.iter().enumerate() {
            bends.extend_from_slice(&self.lines[line].bends);
            bends
                .extend(bundle.waypoints.get(number).map(|&waypoint| [self.boxes[waypoint].x, self.boxes[waypoint].y]));
        }
        if !is_down {
            bends.reverse();
        }
        between(&self.boxes[from], &self.boxes[to], &bends, track)
    }

    /// What is written beside lines, and the boxes of waypoints.
    pub fn marks(&self) -> Vec<MarkEntry> {
        let labels =
            self.lines.iter().zip(&self.line_words).filter(|(_, words)| !words.is_empty()).map(|(line, words)| {
                MarkEntry { words: words.clone(), x: line.label_at[0], y: line.label_at[1], w: 0.0, h: 0.0 }
            });
        let waypoints = self.boxes[self.states..].iter().zip(&self.waypoint_words);
        let waypoints = waypoints.map(|(b, words)| MarkEntry { words: words.clone(), x: b.x, y: b.y, w: b.w, h: b.h });
        labels.chain(waypoints).collect()
    }
}
