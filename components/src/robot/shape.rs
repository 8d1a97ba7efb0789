//! Solids: primitives with their own frame in the middle, z along the axis (URDF's convention), and triangle meshes.

use glam::DVec3;
use std::sync::Arc;

/// A collision solid in its own frame. Lengths in metres.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// Ball about the origin.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// Box about the origin.
    Box {
        /// Half of each side.
        half_extents: DVec3,
    },
    /// Cylinder about z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Half of its length along z.
        half_length: f64,
    },
    /// Capsule about z: the ball swept along the segment of length `2 · half_length`.
    Capsule {
        /// Radius.
        radius: f64,
        /// Half of the segment's length along z.
        half_length: f64,
    },
    /// Triangle mesh; a closed one is a solid.
    Mesh(Arc<Mesh>),
}

/// Triangles with shared vertices, already scaled to metres and turned z-up.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Where it came from, as the model names it (`package://…`); for messages.
    pub source: String,
    /// Vertices, metres, in the shape's frame.
    pub vertices: Vec<DVec3>,
    /// Triangles, counter-clockwise seen from outside. Every index is below `vertices.len()`.
    pub triangles: Vec<[u32; 3]>,
    /// Whether every edge is shared by exactly two triangles, so that the mesh bounds a solid.
    pub closed: bool,
}

impl Mesh {
    /// A mesh from triangles, with `closed` found from its edges. Vertices at the same position count as one.
    ///
    /// # Panics
    /// Never: triangles whose indices are out of range are dropped.
    #[must_use]
    pub fn new(source: String, vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        let count = vertices.len() as u32;
        let triangles: Vec<_> = triangles.into_iter().filter(|t| t.iter().all(|&i| i < count)).collect();
        let closed = is_closed(&vertices, &triangles);
        Self { source, vertices, triangles, closed }
    }
}

/// Whether the triangles bound a solid: every undirected edge (by position) belongs to exactly two triangles.
fn is_closed(vertices: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    use std::collections::HashMap;
    let mut ids: HashMap<[u64; 3], u32> = HashMap::with_capacity(vertices.len());
    let same: Vec<u32> = vertices
        .iter()
        .enumerate()
        // `+ 0.0` maps −0 to +0, which are one position.
        .map(|(i, p)| *ids.entry([p.x, p.y, p.z].map(|c| (c + 0.0).to_bits())).or_insert(i as u32))
        .collect();
    let mut edges: HashMap<(u32, u32), u32> = HashMap::with_capacity(triangles.len() * 2);
    for t in triangles {
        let t = t.map(|i| same[i as usize]);
        if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
            continue; // degenerate: bounds nothing
        }
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *edges.entry((a.min(b), a.max(b))).or_default() += 1;
        }
    }
    !edges.is_empty() && edges.values().all(|&n| n == 2)
}

impl Geometry {
    /// Radius of the smallest ball *about the shape's origin* that holds the solid.
    #[must_use]
    pub fn radius_about_origin(&self) -> f64 {
        match self {
            Self::Sphere { radius } => *radius,
            Self::Box { half_extents } => half_extents.length(),
            Self::Cylinder { radius, half_length } => radius.hypot(*half_length),
            Self::Capsule { radius, half_length } => radius + half_length,
            Self::Mesh(mesh) => mesh.vertices.iter().map(|v| v.length()).fold(0.0, f64::max),
        }
    }

    /// The kind's name, for messages and listings.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Sphere { .. } => "sphere",
            Self::Box { .. } => "box",
            Self::Cylinder { .. } => "cylinder",
            Self::Capsule { .. } => "capsule",
            Self::Mesh(_) => "mesh",
        }
    }
}
