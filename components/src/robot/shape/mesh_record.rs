//! What takes long to find out about a mesh and little time to prove once it is known.

/// What a search over a mesh's vertices and triangles has found, so that it need not be repeated (by the kernels, which build their
/// trees from it). Nothing in it is to be believed: it may come from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshRecord {
    /// For every vertex the first one at its position; empty where no two vertices are at one.
    pub same: Vec<u32>,
    /// The triangles in the order in which a hierarchy over them has them.
    pub order: Vec<u32>,
    /// Few vertices, around whose convex hull the mesh lies; at most 256.
    pub hull: Vec<u32>,
    /// For every vertex up to four of those few, as places in `hull`, near whose convex hull it is; the last is repeated where they
    /// are fewer.
    pub near: Vec<[u8; 4]>,
    /// No vertex is farther than this from the convex hull of the few, metres.
    pub slack: f64,
}

impl MeshRecord {
    /// Counts changes of what is found: a record of another version is none.
    pub const VERSION: u32 = 1;
}
