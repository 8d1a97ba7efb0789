//! A hierarchy of boxes over a mesh's triangles.
//!
//! parry's mesh distance is three orders of magnitude too slow for a planner and its meshes are hollow, so this is ours:
//! axis-aligned boxes in the mesh's frame, eight to a block and side by side in lanes, median splits, f64 throughout.

use super::around::Around;
use super::hull::Hull;
use super::mesh_record::{findings, proves};
use super::triangle_order::parts_of;
use crate::lanes::{F64Row, Level, Row};
use foliate_components::robot::shape::Mesh;
use foliate_components::robot::shape::mesh_record::MeshRecord;
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
    /// What holds it, larger and larger.
    pub(super) around: Around,
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

/// The least and largest coordinates of some triangles, and whether all of these are finite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    low: DVec3,
    high: DVec3,
    whole: bool,
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
    /// Builds the tree: from the mesh's record where that is proved, else from nothing; the tree is the same. Triangles with a
    /// coordinate that is not finite are kept and make every answer *in collision*.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        Self::new_while(mesh, &|| true).unwrap_or_default()
    }

    /// As [`Self::new`]; none once `go_on` says no. It is asked between passes over all triangles, of which each takes some tenths of
    /// a second for four million.
    #[must_use]
    pub fn new_while(mesh: &Mesh, go_on: &dyn Fn() -> bool) -> Option<Self> {
        match mesh.record.as_ref().filter(|record| proves(mesh, record)) {
            Some(record) => Self::of_record(mesh, record, go_on),
            None => Self::of_record(mesh, &findings(mesh, go_on)?, go_on),
        }
    }

    /// What a record that holds makes of a mesh.
    fn of_record(mesh: &Mesh, record: &MeshRecord, go_on: &dyn Fn() -> bool) -> Option<Self> {
        let goes_on = || go_on().then_some(());
        goes_on()?;
        let corners = corners_of(mesh);
        let mut tree = Self {
            triangles: record.order.iter().map(|&t| corners(t as usize)).collect(),
            witnesses: witnesses(mesh, &record.same),
            closed: mesh.closed,
            lanes: Level::detected(),
            ..Self::default()
        };
        goes_on()?;
        if !tree.triangles.is_empty() {
            tree.fill_blocks();
        }
        goes_on()?;
        let vertex = |i: &u32| mesh.vertices.get(*i as usize).copied();
        tree.hull = Hull::of(record.hull.iter().filter_map(vertex).collect(), record.slack);
        tree.around = Around::of(mesh, &tree);
        Some(tree)
    }

    /// Level by level, so that what a block leads to stands side by side.
    fn fill_blocks(&mut self) {
        let branches = branches(self.triangles.len());
        let extents = self.extents(&branches);
        self.blocks.reserve_exact(branches.len());
        self.corners.reserve_exact(branches.iter().filter(|branch| branch.parts.is_empty()).count());
        let mut boxes = [Extent::EMPTY; WIDE];
        for (branch, extent) in branches.iter().zip(&extents) {
            let (count, first, corners) = if branch.parts.is_empty() {
                let triangles = &self.triangles[branch.triangles.clone()];
                boxes.iter_mut().zip(triangles).for_each(|(one, triangle)| *one = Extent::of(triangle));
                self.corners.push(in_lanes(triangles));
                (triangles.len(), branch.triangles.start, Some(self.corners.len() as u32 - 1))
            } else {
                let parts = &extents[branch.parts.clone()];
                boxes[..parts.len()].copy_from_slice(parts);
                (parts.len(), branch.parts.start, None)
            };
            self.blocks.push(Block::new(extent.bounds(), &boxes[..count], first as u32, corners));
        }
    }

    /// Of all triangles of each branch.
    fn extents(&self, branches: &[Branch]) -> Vec<Extent> {
        let mut extents = vec![Extent::EMPTY; branches.len()];
        // What a branch leads to stands behind it.
        for (place, branch) in branches.iter().enumerate().rev() {
            extents[place] = match branch.parts.is_empty() {
                true => Extent::of_all(self.triangles[branch.triangles.clone()].iter().map(Extent::of)),
                false => Extent::of_all(extents[branch.parts.clone()].iter().copied()),
            };
        }
        extents
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
    fn new(bounds: Bounds, boxes: &[Extent], first: u32, corners: Option<u32>) -> Self {
        let of = |lane: usize| boxes.get(lane).unwrap_or(&boxes[0]).bounds();
        let (centers, halves) = (in_rows(|lane| of(lane).center), in_rows(|lane| of(lane).half));
        Self { bounds, centers, halves, count: boxes.len() as u32, first, corners }
    }
}

fn in_rows(of: impl Fn(usize) -> DVec3) -> [F64Row; 3] {
    let points: [DVec3; WIDE] = std::array::from_fn(of);
    [Row(points.map(|p| p.x)), Row(points.map(|p| p.y)), Row(points.map(|p| p.z))]
}

/// One coordinate that is not finite spoils the triangle: minima and maxima over its corners are then no numbers either.
fn whole_or_nothing(triangle: [DVec3; 3]) -> [DVec3; 3] {
    if triangle.iter().all(|p| p.is_finite()) { triangle } else { [DVec3::NAN; 3] }
}

/// The triangles of a mesh by number; with corners that are no numbers where a vertex is not there.
pub(super) fn corners_of(mesh: &Mesh) -> impl Fn(usize) -> [DVec3; 3] + '_ {
    let corner = |i: u32| mesh.vertices.get(i as usize).copied().unwrap_or(DVec3::NAN);
    move |t| whole_or_nothing(mesh.triangles.get(t).map_or([DVec3::NAN; 3], |t| t.map(corner)))
}

/// Which triangles a block is over, and which branches it leads to; none where it is one of the last.
struct Branch {
    triangles: Range<usize>,
    parts: Range<usize>,
}

/// Those of a tree over so many triangles: how they are cut is a matter of numbers alone.
fn branches(count: usize) -> Vec<Branch> {
    let mut branches = vec![Branch { triangles: 0..count, parts: 0..0 }];
    let mut next = 0;
    while let Some(triangles) = branches.get(next).map(|branch| branch.triangles.clone()) {
        if triangles.len() > WIDE {
            let first = branches.len();
            let parts = parts_of(triangles, |_, _| {});
            branches.extend(parts.into_iter().map(|triangles| Branch { triangles, parts: 0..0 }));
            branches[next].parts = first..branches.len();
        }
        next += 1;
    }
    branches
}

impl Extent {
    /// Of nothing.
    pub(super) const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, whole: true };

    pub(super) fn of(triangle: &[DVec3; 3]) -> Self {
        let [a, b, c] = *triangle;
        Self { low: a.min(b).min(c), high: a.max(b).max(c), whole: a.is_finite() && b.is_finite() && c.is_finite() }
    }

    /// Of both.
    pub(super) fn and(self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high), whole: self.whole && other.whole }
    }

    /// Of them together.
    pub(super) fn of_all(extents: impl Iterator<Item = Self>) -> Self {
        extents.fold(Self::EMPTY, |all, one| all.and(&one))
    }

    pub(super) fn bounds(&self) -> Bounds {
        if !self.whole {
            // A box that nothing is far from.
            return Bounds { center: DVec3::ZERO, half: DVec3::INFINITY };
        }
        Bounds { center: (self.low + self.high) * 0.5, half: (self.high - self.low) * (0.5 * (1.0 + 1e-15)) }
    }
}

/// Up to eight triangles in lanes.
fn in_lanes(triangles: &[[DVec3; 3]]) -> Corners {
    let corner = |c: usize| in_rows(|lane| triangles.get(lane).unwrap_or(&triangles[0])[c]);
    [corner(0), corner(1), corner(2)]
}

/// One vertex of each connected component (triangles that share a vertex position, for which `same` has the first vertex).
fn witnesses(mesh: &Mesh, same: &[u32]) -> Vec<DVec3> {
    let first = |i: u32| match same.is_empty() {
        true => Some(i).filter(|&i| (i as usize) < mesh.vertices.len()),
        false => same.get(i as usize).copied(),
    };
    let mut parent: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    for t in &mesh.triangles {
        let Some(one) = first(t[0]).map(|i| root(&mut parent, i)) else { continue };
        for i in t[1..].iter().filter_map(|&i| first(i)) {
            let other = root(&mut parent, i);
            parent[other as usize] = one;
        }
    }
    let mut seen = vec![false; mesh.vertices.len()];
    let mut found = Vec::new();
    for i in mesh.triangles.iter().filter_map(|t| first(t[0])) {
        if !std::mem::replace(&mut seen[root(&mut parent, i) as usize], true) {
            found.push(mesh.vertices[i as usize]);
        }
    }
    found
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}
