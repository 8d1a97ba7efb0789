//! Single transitions along the lines of a layout: side by side, each with an arrow at its end; loops as small arcs.

use crate::view::graph::layout::Placed;
use std::f64::consts::{PI, TAU};

/// Between two transitions side by side.
const APART: f64 = 7.0;
/// Radius of a loop.
pub(crate) const LOOP: f64 = 9.0;

type Point = [f64; 2];

/// The way from one box to another over some bends, shifted to its right by a number of tracks, from border to border.
pub(crate) fn between(from: &Placed, to: &Placed, bends: &[Point], track: usize) -> Vec<Point> {
    let mut way = vec![[from.x, from.y]];
    way.extend_from_slice(bends);
    way.push([to.x, to.y]);
    way.dedup();
    let by = APART * (0.5 + track as f64);
    let mut shifted: Vec<Point> = (0..way.len()).map(|index| beside(&way, index, by)).collect();
    let last = shifted.len() - 1;
    if last > 0 {
        shifted[0] = border(from, shifted[0], shifted[1]);
        shifted[last] = border(to, shifted[last], shifted[last - 1]);
    }
    shifted
}

/// A point of a way, shifted to the right of the direction of travel.
fn beside(way: &[Point], index: usize, by: f64) -> Point {
    let (before, after) = (way[index.saturating_sub(1)], way[(index + 1).min(way.len() - 1)]);
    let (dx, dy) = (after[0] - before[0], after[1] - before[1]);
    let length = dx.hypot(dy).max(1e-9);
    // y points down: the right hand of who goes down is at smaller x.
    [way[index][0] - by * dy / length, way[index][1] + by * dx / length]
}

/// Where the way from a point in a box to one outside crosses the border.
fn border(placed: &Placed, inside: Point, outside: Point) -> Point {
    let (low, high) = (
        [placed.x - 0.5 * placed.w, placed.y - 0.5 * placed.h],
        [placed.x + 0.5 * placed.w, placed.y + 0.5 * placed.h],
    );
    let start = [inside[0].clamp(low[0], high[0]), inside[1].clamp(low[1], high[1])];
    let mut share = 1.0_f64;
    for axis in 0..2 {
        let way = outside[axis] - start[axis];
        let wall = if way > 0.0 { high[axis] } else { low[axis] };
        if way.abs() > 1e-12 {
            share = share.min(((wall - start[axis]) / way).max(0.0));
        }
    }
    [start[0] + share * (outside[0] - start[0]), start[1] + share * (outside[1] - start[1])]
}

/// A loop on the upper border of a box, near its right end: an arc of a circle.
pub(crate) fn around(placed: &Placed, number: usize) -> Vec<Point> {
    let (top, right) = (placed.y - 0.5 * placed.h, placed.x + 0.5 * placed.w);
    let middle = [right - LOOP - 6.0 - 2.4 * LOOP * number as f64, top - 0.45 * LOOP];
    // From where the circle leaves the border, over its top, back to the border.
    let opening = (0.45_f64).acos();
    let (first, last) = (0.5 * PI + opening, 0.5 * PI + TAU - opening);
    let steps = 14;
    (0..=steps)
        .map(|step| {
            let angle = first + (last - first) * f64::from(step) / f64::from(steps);
            [middle[0] + LOOP * angle.cos(), middle[1] + LOOP * angle.sin()]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_there_and_back_run_side_by_side_from_border_to_border() {
        let (a, b) = (Placed { w: 40.0, h: 20.0, x: 50.0, y: 30.0 }, Placed { w: 40.0, h: 20.0, x: 50.0, y: 130.0 });
        let (there, back) = (between(&a, &b, &[], 0), between(&b, &a, &[], 0));
        assert_eq!(there, [[46.5, 40.0], [46.5, 120.0]]);
        assert_eq!(back, [[53.5, 120.0], [53.5, 40.0]]);
    }

    #[test]
    fn a_loop_begins_and_ends_on_the_border() {
        let placed = Placed { w: 80.0, h: 20.0, x: 50.0, y: 30.0 };
        let arc = around(&placed, 0);
        let (first, last) = (arc[0], arc[arc.len() - 1]);
        assert!((first[1] - 20.0).abs() < 1e-9 && (last[1] - 20.0).abs() < 1e-9, "{first:?} {last:?}");
        assert!(arc[1..arc.len() - 1].iter().all(|p| p[1] < 20.0));
    }
}
