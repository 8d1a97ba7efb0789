//! The order in which a tree of boxes has a mesh's triangles: halves of halves, at medians of the longest side.

use crate::collision::solids::boxes::{Extent, WIDE};
use crate::collision::solids::volumes::longest_axis;
use glam::DVec3;
use std::ops::Range;

/// A range of as many triangles takes a millisecond: smaller ones do not ask whether to go on.
const LOOK: usize = 1 << 14;

/// The numbers of `triangles` in the order of the last blocks. Whatever it is, a tree over it is a tree; this one has small boxes. None
/// once `go_on` says no.
pub(crate) fn triangle_order(triangles: &[[DVec3; 3]], go_on: &dyn Fn() -> bool) -> Option<Vec<u32>> {
    let boxes: Vec<Extent> = triangles.iter().map(Extent::of).collect();
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    let mut keyed: Vec<(f64, u32)> = Vec::with_capacity(triangles.len());
    let mut ranges: Vec<Range<usize>> = std::iter::once(0..triangles.len()).collect();
    while let Some(range) = ranges.pop() {
        if range.len() <= WIDE {
            continue;
        }
        if range.len() >= LOOK && !go_on() {
            return None;
        }
        ranges.extend(parts_of(range, |part, middle| {
            let part = &mut order[part];
            let extent = Extent::of_all(part.iter().map(|&t| boxes[t as usize]));
            let axis = longest_axis(extent.bounds().half);
            let key = |t: &[DVec3; 3]| t[0][axis] + t[1][axis] + t[2][axis];
            keyed.clear();
            keyed.extend(part.iter().map(|&t| (key(&triangles[t as usize]), t)));
            keyed.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0));
            part.iter_mut().zip(&keyed).for_each(|(place, &(_, t))| *place = t);
        }));
    }
    Some(order)
}

/// Cuts a range of more than eight triangles three times in two; all but the last of eight triangles are full. `cut` gets each part
/// that is cut, and after how many of its triangles, before its halves are visited.
pub(crate) fn parts_of(range: Range<usize>, mut cut: impl FnMut(Range<usize>, usize)) -> Vec<Range<usize>> {
    let mut parts = vec![range];
    for _ in 0..WIDE.ilog2() {
        parts = parts.into_iter().flat_map(|part| halves(part, &mut cut)).filter(|part| !part.is_empty()).collect();
    }
    parts
}

fn halves(range: Range<usize>, cut: &mut impl FnMut(Range<usize>, usize)) -> [Range<usize>; 2] {
    if range.len() <= WIDE {
        return [range.clone(), range.end..range.end];
    }
    let middle = range.len().div_ceil(2).next_multiple_of(WIDE).min(range.len() - 1);
    cut(range.clone(), middle);
    [range.start..range.start + middle, range.start + middle..range.end]
}
