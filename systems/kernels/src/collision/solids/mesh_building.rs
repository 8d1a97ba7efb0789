//! Building a `MeshTree`, from the triangles of a mesh or from a record that is proved first.
//!
//! The bounding ball and capsule of a mesh are found here once, for every shape that has the mesh. Building is apart from
//! `mesh_tree`, so that queries depend on the tree alone.

use crate::collision::solids::boxes::{Bounds, Extent, WIDE, corners_of, in_lanes, in_rows};
use crate::collision::solids::hull::Hull;
use crate::collision::solids::mesh_tree::{Block, MeshTree};
use crate::collision::solids::support_points::PointRows;
use crate::collision::solids::triangle_order::parts_of;
use crate::collision::solids::volumes::{Ball, Capsule, MeshBounding, farthest_of};
use crate::lanes::level::Level;
use foliate_components::robot::shape::Mesh;
use foliate_components::robot::shape::mesh_record::MeshRecord;
use glam::DVec3;
use std::ops::Range;

impl MeshBounding {
    /// Around the triangles of a tree whose boxes and hull are there; they are those of `mesh`.
    pub(crate) fn of(mesh: &Mesh, tree: &MeshTree) -> Self {
        let (middle, half) = tree.bounds().map_or((DVec3::ZERO, DVec3::ZERO), |b| (b.center, b.half));
        let center = Ball::center_of_few(&tree.hull.points, middle);
        let points = tree.triangles.as_flattened();
        // Vertices are a sixth of the corners of triangles.
        let rows = match is_all_used(mesh) {
            true => PointRows::of(&mesh.vertices),
            false => PointRows::of(points),
        };
        match rows {
            Some(rows) => Self {
                ball: Ball::reaching(center, rows.last_from(center).1.sqrt()),
                capsule: rows.capsule(middle, half),
                about_middle: rows.last_from(middle).1.sqrt(),
            },
            None => Self {
                ball: Ball::reaching(center, farthest_of(points, center).distance(center)),
                capsule: Capsule::of_points(middle, half, points, 0.0),
                about_middle: farthest_of(points, middle).distance(middle),
            },
        }
    }
}

/// Whether the corners of the triangles are the vertices, all there and none to spare.
fn is_all_used(mesh: &Mesh) -> bool {
    let mut used = vec![false; mesh.vertices.len()];
    for &corner in mesh.triangles.as_flattened() {
        match used.get_mut(corner as usize) {
            Some(used) => *used = true,
            None => return false,
        }
    }
    used.into_iter().all(|used| used)
}

impl Ball {
    /// Where the centre of a ball around many points should be, as few of them tell.
    pub(crate) fn center_of_few(few: &[DVec3], start: DVec3) -> DVec3 {
        match PointRows::of(few) {
            Some(rows) => Self::bounding(start, |from| few[rows.last_from(from).0]).center,
            None => Self::bounding(start, |from| farthest_of(few, from)).center,
        }
    }
}

impl MeshTree {
    /// Builds the tree: from the mesh's record where that is proved, else from nothing; the tree is the same. Triangles with a
    /// coordinate that is not finite are kept and make every answer *in collision*.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        Self::new_while(mesh, &|| true).unwrap_or_default()
    }

    /// What a record that holds makes of a mesh.
    pub(crate) fn of_record(mesh: &Mesh, record: &MeshRecord, go_on: &dyn Fn() -> bool) -> Option<Self> {
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
        tree.bounding = MeshBounding::of(mesh, &tree);
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
}

impl Block {
    fn new(bounds: Bounds, boxes: &[Extent], first: u32, corners: Option<u32>) -> Self {
        let of = |lane: usize| boxes.get(lane).unwrap_or(&boxes[0]).bounds();
        let (centers, halves) = (in_rows(|lane| of(lane).center), in_rows(|lane| of(lane).half));
        Self { bounds, centers, halves, count: boxes.len() as u32, first, corners }
    }
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
