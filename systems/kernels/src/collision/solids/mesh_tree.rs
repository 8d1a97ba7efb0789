//! A hierarchy of boxes over a mesh's triangles.
//!
//! parry's mesh distance is three orders of magnitude too slow for a planner and its meshes are hollow, so this is ours:
//! axis-aligned boxes in the mesh's frame, eight to a block and side by side in lanes, median splits, f64 throughout.

use crate::collision::solids::boxes::{Bounds, Corners};
use crate::collision::solids::hull::Hull;
use crate::collision::solids::mesh_record::{findings, proves};
use crate::collision::solids::volumes::MeshBounding;
use crate::lanes::level::Level;
use crate::lanes::vector::F64Row;
use foliate_components::robot::shape::Mesh;
use glam::DVec3;

/// Triangles in a tree of axis-aligned boxes.
#[derive(Clone, Debug, Default)]
pub struct MeshTree {
    /// The first is the root; the blocks that a block leads to stand side by side behind it.
    pub(crate) blocks: Vec<Block>,
    /// In the order of the last blocks.
    pub(crate) triangles: Vec<[DVec3; 3]>,
    /// The same in lanes, one for each of the last blocks.
    pub(crate) corners: Vec<Corners>,
    /// One vertex of each connected component: where none of them is inside a solid whose surface the mesh does not
    /// touch, nothing of the mesh is.
    pub(crate) witnesses: Vec<DVec3>,
    /// Few points around it.
    pub(crate) hull: Hull,
    /// What holds it, larger and larger.
    pub(crate) bounding: MeshBounding,
    pub(crate) closed: bool,
    /// How distances are computed, not what they are: they are equal bit for bit at every level.
    pub(crate) lanes: Level,
}

/// Up to eight boxes, of blocks or of triangles, and the box around them.
#[derive(Clone, Debug)]
pub(crate) struct Block {
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

impl Block {
    /// Its boxes, a bit for each.
    pub(crate) fn lanes(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// One of the boxes.
    pub(crate) fn bounds_of(&self, lane: usize) -> Bounds {
        let of = |rows: &[F64Row; 3]| DVec3::new(rows[0][lane], rows[1][lane], rows[2][lane]);
        Bounds { center: of(&self.centers), half: of(&self.halves) }
    }
}

impl MeshTree {
    /// As [`Self::new`]; none once `go_on` says no. It is asked between passes over all triangles, of which each takes some tenths of
    /// a second for four million.
    #[must_use]
    pub fn new_while(mesh: &Mesh, go_on: &dyn Fn() -> bool) -> Option<Self> {
        match mesh.record.as_ref().filter(|record| proves(mesh, record)) {
            Some(record) => Self::of_record(mesh, record, go_on),
            None => Self::of_record(mesh, &findings(mesh, go_on)?, go_on),
        }
    }

    /// The box around the mesh; none where there are no triangles.
    pub(crate) fn bounds(&self) -> Option<Bounds> {
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
