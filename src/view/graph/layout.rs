//! Where boxes and the lines between them go.

use dagre::graph::{Graph, GraphOptions};
use dagre::{EdgeLabel, LayoutOptions, NodeLabel, RankDir, layout};

/// Between boxes of one row, between rows, and around everything.
const BESIDE: f64 = 28.0;
const BELOW: f64 = 46.0;
pub(crate) const MARGIN: f64 = 16.0;

/// A box: width and height, then its middle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Placed {
    pub w: f64,
    pub h: f64,
    pub x: f64,
    pub y: f64,
}

/// A line between two boxes, and the size and the middle of what is written beside it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Line {
    pub from: usize,
    pub to: usize,
    pub label: [f64; 2],
    pub label_at: [f64; 2],
    /// Where it bends, from box to box; the ends in the boxes are not among them.
    pub bends: Vec<[f64; 2]>,
}

/// The shape of the frame that a picture should fit: width to height.
const FRAME: [f64; 2] = [4.0, 3.0];

/// Gives boxes and lines places; width and height of all of it. Lines go down or to the right, from the first box to the second, whichever
/// fits better into a frame; none leads back to its own box.
pub(crate) fn place(boxes: &mut [Placed], lines: &mut [Line]) -> [f64; 2] {
    let (mut beside, mut beside_lines) = (boxes.to_vec(), lines.to_vec());
    let [down, right] = [towards(boxes, lines, RankDir::TB), towards(&mut beside, &mut beside_lines, RankDir::LR)];
    let scale = |[width, height]: [f64; 2]| (width / FRAME[0]).max(height / FRAME[1]);
    if scale(down) <= scale(right) {
        return down;
    }
    boxes.copy_from_slice(&beside);
    lines.clone_from_slice(&beside_lines);
    right
}

fn towards(boxes: &mut [Placed], lines: &mut [Line], rankdir: RankDir) -> [f64; 2] {
    let mut graph: Graph<NodeLabel, EdgeLabel> =
        Graph::with_options(GraphOptions { directed: true, multigraph: true, compound: false });
    for (number, placed) in boxes.iter().enumerate() {
        let label = NodeLabel { width: placed.w, height: placed.h, ..NodeLabel::default() };
        graph.set_node(number.to_string(), Some(label));
    }
    for (number, line) in lines.iter().enumerate() {
        let [width, height] = line.label;
        let label =
            EdgeLabel { width, height, labelpos: dagre::layout::types::LabelPos::Center, ..EdgeLabel::default() };
        graph.set_edge(line.from.to_string(), line.to.to_string(), Some(label), Some(&number.to_string()));
    }
    let options = LayoutOptions { rankdir, nodesep: BESIDE, ranksep: BELOW, edgesep: 14.0, ..LayoutOptions::default() };
    layout(&mut graph, Some(options));
    for (number, placed) in boxes.iter_mut().enumerate() {
        let label = graph.node(&number.to_string());
        (placed.x, placed.y) = label.map_or((0.0, 0.0), |label| (label.x.unwrap_or(0.0), label.y.unwrap_or(0.0)));
    }
    for (number, line) in lines.iter_mut().enumerate() {
        let Some(label) = graph.edge(&line.from.to_string(), &line.to.to_string(), Some(&number.to_string())) else {
            continue;
        };
        let inner = label.points.len().saturating_sub(1).max(1);
        line.bends = label.points.get(1..inner).unwrap_or_default().iter().map(|p| [p.x, p.y]).collect();
        line.label_at = [label.x.unwrap_or(0.0), label.y.unwrap_or(0.0)];
    }
    moved(boxes, lines)
}

/// Puts the upper left corner to the margin; width and height.
fn moved(boxes: &mut [Placed], lines: &mut [Line]) -> [f64; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let mut hold = |x: f64, y: f64| {
        low = [low[0].min(x), low[1].min(y)];
        high = [high[0].max(x), high[1].max(y)];
    };
    for b in boxes.iter() {
        hold(b.x - 0.5 * b.w, b.y - 0.5 * b.h);
        hold(b.x + 0.5 * b.w, b.y + 0.5 * b.h);
    }
    for line in lines.iter() {
        line.bends.iter().for_each(|&[x, y]| hold(x, y));
        let [w, h] = line.label;
        if w > 0.0 {
            hold(line.label_at[0] - 0.5 * w, line.label_at[1] - 0.5 * h);
            hold(line.label_at[0] + 0.5 * w, line.label_at[1] + 0.5 * h);
        }
    }
    if low[0] > high[0] {
        return [2.0 * MARGIN; 2];
    }
    let by = [MARGIN - low[0], MARGIN - low[1]];
    for placed in boxes.iter_mut() {
        placed.x += by[0];
        placed.y += by[1];
    }
    for line in lines.iter_mut() {
        let shift = |p: &mut [f64; 2]| *p = [p[0] + by[0], p[1] + by[1]];
        line.bends.iter_mut().for_each(shift);
        shift(&mut line.label_at);
    }
    [high[0] - low[0] + 2.0 * MARGIN, high[1] - low[1] + 2.0 * MARGIN]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_do_not_overlap_and_all_is_inside_the_margins() {
        let mut boxes = vec![Placed { w: 80.0, h: 30.0, ..Placed::default() }; 7];
        let pairs = [(0, 1), (0, 2), (1, 3), (2, 3), (3, 4), (0, 5), (5, 4), (2, 6)];
        let mut lines: Vec<Line> =
            pairs.iter().map(|&(from, to)| Line { from, to, label: [60.0, 12.0], ..Line::default() }).collect();
        let [width, height] = place(&mut boxes, &mut lines);
        for (number, a) in boxes.iter().enumerate() {
            assert!(a.x - 40.0 >= MARGIN - 1e-9 && a.x + 40.0 <= width - MARGIN + 1e-9);
            assert!(a.y - 15.0 >= MARGIN - 1e-9 && a.y + 15.0 <= height - MARGIN + 1e-9);
            for b in &boxes[number + 1..] {
                assert!((a.x - b.x).abs() >= 80.0 || (a.y - b.y).abs() >= 30.0, "{a:?} {b:?}");
            }
        }
        let before = |a: usize, b: usize| boxes[a].y < boxes[b].y || boxes[a].x < boxes[b].x;
        assert!(before(0, 3) && before(3, 4));
    }

    #[test]
    fn the_same_graph_has_the_same_places() {
        let placed = || {
            let mut boxes = vec![Placed { w: 50.0, h: 20.0, ..Placed::default() }; 40];
            let mut lines: Vec<Line> = (1..40)
                .flat_map(|to| [(to / 3, to), (to / 2, to)])
                .map(|(from, to)| Line { from, to, ..Line::default() })
                .collect();
            let size = place(&mut boxes, &mut lines);
            (size, boxes, lines)
        };
        assert_eq!(placed(), placed());
    }
}
