//! A hierarchy of boxes over a mesh's triangles.
//!
//! parry's mesh distance is three orders of magnitude too slow for a planner and its meshes are hollow, so this is ours:
//! axis-aligned boxes in the mesh's frame, eight to a block and side by side in lanes, median splits, f64 throughout.

use super::hull::Hull;
use crate::lanes::{F64Row, Level, Row};
use foliate_components::robot::shape::Mesh;
use glam::DVec3;
use std::ops::Range;

/// Boxes in a block, and triangles in one of the last.
pub(super) const WIDE: usize = 8;

/// Triangles in a tree of axis-aligned boxes.
#[derive(Clone, Debug, Default)]
pub struct MeshTree {
    /// The first is the root; the blocks that a block leads to stand side by side behind it.
    pub(super) blocks: Vec<Block>,
    /// In the order of the last blocks.
    pub(super) triangles: Vec<[DVec3; 3]>,
    /// The same in lanes, one for each of the last blocks.
    pub(super) corners: Vec<Corners>,
    /// One vertex of each connected component: where none of them is inside a solid whose surface the mesh does not
    /// touch, nothing of the mesh is.
    pub(super) witnesses: Vec<DVec3>,
    /// Few points around it.
    pub(super) hull: Hull,
    pub(super) closed: bool,
    /// How distances are computed, not what they are: they are equal bit for bit at every level.
    pub(super) lanes: Level,
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub center: DVec3,
    pub half: DVec3,
}

/// Up to eight boxes, of blocks or of triangles, and the box around them.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub bounds: Bounds,
    /// Of the boxes; in lanes that are not used those of the first.
    pub centers: [F64Row; 3],
    pub halves: [F64Row; 3],
    /// Number of boxes.
    pub count: u32,
    /// Index of the first block or triangle.
    pub first: u32,
    /// Of one of the last blocks: where its triangles are in lanes.
    pub corners: Option<u32>,
}

/// Coordinates of the three corners of eight triangles; lanes that are not used repeat the first.
pub(super) type Corners = [[F64Row; 3]; 3];

impl Block {
    /// Its boxes, a bit for each.
    pub(super) fn lanes(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// One of the boxes.
    pub(super) fn bounds_of(&self, lane: usize) -> Bounds {
        let of = |rows: &[F64Row; 3]| DVec3::new(rows[0][lane], rows[1][lane], rows[2][lane]);
        Bounds { center: of(&self.centers), half: of(&self.halves) }
    }
}

impl MeshTree {
    /// Builds the tree. Triangles with a coordinate that is not finite are kept and make every answer *in collision*.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        let corner = |i: u32| mesh.vertices.get(i as usize).copied().unwrap_or(DVec3::NAN);
        let mut tree = Self {
            triangles: mesh.triangles.iter().map(|t| whole_or_nothing(t.map(corner))).collect(),
            witnesses: witnesses(mesh),
            closed: mesh.closed,
            lanes: Level::detected(),
            ..Self::default()
        };
        if !tree.triangles.is_empty() {
            tree.split();
        }
        if tree.bounds().is_some_and(|bounds| bounds.half.is_finite()) {
            tree.hull = Hull::new(&mesh.vertices, extreme_points(&mesh.vertices));
        }
        tree
    }

    /// Level by level, so that what a block leads to stands side by side.
    fn split(&mut self) {
        let mut ranges: Vec<Range<usize>> = std::iter::once(0..self.triangles.len()).collect();
        let mut next = 0;
        while let Some(range) = ranges.get(next).cloned() {
            next += 1;
            let block = if range.len() <= WIDE {
                self.last_block(range)
            } else {
                let parts = parts_of(&mut self.triangles, range.clone());
                let boxes: Vec<Bounds> = parts.iter().map(|part| bounds(&self.triangles[part.clone()])).collect();
                let first = ranges.len() as u32;
                ranges.extend(parts);
                Block::new(bounds(&self.triangles[range]), &boxes, first, None)
            };
            self.blocks.push(block);
        }
    }

    fn last_block(&mut self, range: Range<usize>) -> Block {
        let triangles = &self.triangles[range.clone()];
        let boxes: Vec<Bounds> = triangles.iter().map(|t| bounds(std::slice::from_ref(t))).collect();
        let corner = |c: usize| in_rows(|lane| triangles.get(lane).unwrap_or(&triangles[0])[c]);
        self.corners.push([corner(0), corner(1), corner(2)]);
        Block::new(bounds(triangles), &boxes, range.start as u32, Some(self.corners.len() as u32 - 1))
    }

    /// The box around the mesh; none where there are no triangles.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        self.blocks.first().map(|root| root.bounds)
    }

    /// The same tree, whose distances are computed at another level than the best; the answers are the same bit for bit.
    #[must_use]
    pub fn computed_at(mut self, level: Level) -> Self {
        self.lanes = level;
        self.hull.lanes = level;
        self
    }

    /// Whether the mesh bounds a solid.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Number of triangles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are no triangles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }
}

impl Block {
    fn new(bounds: Bounds, boxes: &[Bounds], first: u32, corners: Option<u32>) -> Self {
        let of = |lane: usize| boxes.get(lane).unwrap_or(&boxes[0]);
        let (centers, halves) = (in_rows(|lane| of(lane).center), in_rows(|lane| of(lane).half));
        Self { bounds, centers, halves, count: boxes.len() as u32, first, corners }
    }
}

fn in_rows(of: impl Fn(usize) -> DVec3) -> [F64Row; 3] {
    let points: [DVec3; WIDE] = std::array::from_fn(of);
    [Row(points.map(|p| p.x)), Row(points.map(|p| p.y)), Row(points.map(|p| p.z))]
}

/// Cuts a range of more than eight triangles three times in two, at medians of the longest side; all but the last
/// of eight triangles are full.
fn parts_of(triangles: &mut [[DVec3; 3]], range: Range<usize>) -> Vec<Range<usize>> {
    let mut parts = vec![range];
    for _ in 0..WIDE.ilog2() {
        parts = parts.into_iter().flat_map(|part| halves(triangles, part)).filter(|part| !part.is_empty()).collect();
    }
    parts
}

fn halves(triangles: &mut [[DVec3; 3]], range: Range<usize>) -> [Range<usize>; 2] {
    if range.len() <= WIDE {
        return [range.clone(), range.end..range.end];
    }
    let axis = longest_axis(bounds(&triangles[range.clone()]).half);
    let middle = range.len().div_ceil(2).next_multiple_of(WIDE).min(range.len() - 1);
    let key = |t: &[DVec3; 3]| t[0][axis] + t[1][axis] + t[2][axis];
    triangles[range.clone()].select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
    [range.start..range.start + middle, range.start + middle..range.end]
}

/// One coordinate that is not finite spoils the triangle: minima and maxima over its corners are then no numbers either.
fn whole_or_nothing(triangle: [DVec3; 3]) -> [DVec3; 3] {
    if triangle.iter().all(|p| p.is_finite()) { triangle } else { [DVec3::NAN; 3] }
}

fn bounds(triangles: &[[DVec3; 3]]) -> Bounds {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in triangles.iter().flatten() {
        if !p.is_finite() {
            // A box that nothing is far from.
            return Bounds { center: DVec3::ZERO, half: DVec3::INFINITY };
        }
        (low, high) = (low.min(*p), high.max(*p));
    }
    Bounds { center: (low + high) * 0.5, half: (high - low) * (0.5 * (1.0 + 1e-15)) }
}

/// The vertices that lie farthest in each of 98 directions.
fn extreme_points(vertices: &[DVec3]) -> Vec<DVec3> {
    let range = || -2..=2_i32;
    let directions = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| (x, y, z))));
    directions
        .filter(|&(x, y, z)| x.abs().max(y.abs()).max(z.abs()) == 2)
        .filter_map(|(x, y, z)| {
            let d = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            vertices.iter().max_by(|a, b| a.dot(d).total_cmp(&b.dot(d))).copied()
        })
        .collect()
}

fn longest_axis(half: DVec3) -> usize {
    if half.x >= half.y && half.x >= half.z {
        0
    } else if half.y >= half.z {
        1
    } else {
        2
    }
}

/// One vertex of each connected component (triangles that share a vertex position).
fn witnesses(mesh: &Mesh) -> Vec<DVec3> {
    use std::collections::HashMap;
    let mut ids: HashMap<[u64; 3], usize> = HashMap::with_capacity(mesh.vertices.len());
    let same: Vec<usize> = mesh
        .vertices
        .iter()
        .enumerate()
        .map(|(i, p)| *ids.entry([p.x, p.y, p.z].map(|c| (c + 0.0).to_bits())).or_insert(i))
        .collect();
    let mut parent: Vec<usize> = (0..mesh.vertices.len()).collect();
    for t in &mesh.triangles {
        let Some(first) = same.get(t[0] as usize).map(|&i| root(&mut parent, i)) else { continue };
        for &i in &t[1..] {
            if let Some(&i) = same.get(i as usize) {
                let other = root(&mut parent, i);
                parent[other] = first;
            }
        }
    }
    let mut seen = std::collections::HashSet::new();
    let mut found = Vec::new();
    for t in &mesh.triangles {
        if let Some(&i) = same.get(t[0] as usize)
            && seen.insert(root(&mut parent, i))
        {
            found.push(mesh.vertices[i]);
        }
    }
    found
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}
