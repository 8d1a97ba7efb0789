//! Solids: primitives with their own frame in the middle, z along the axis (URDF's convention), and triangle meshes.

use super::mesh_record::MeshRecord;
use super::positions::first_at_position;
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
    /// What was found out about vertices and triangles before, so that it need not be again. Whoever uses it proves it first.
    pub record: Option<MeshRecord>,
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
        Self { source, vertices, triangles, closed, record: None }
    }
}

/// Whether the triangles bound a solid: every undirected edge (by position) belongs to exactly two triangles.
fn is_closed(vertices: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    let same = first_at_position(vertices);
    let corners = triangles.iter().map(|t| t.map(|i| same[i as usize]));
    // Triangles with two corners at one position bound nothing.
    let edges = corners.filter(|[a, b, c]| a != b && b != c && c != a).flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
    let edges = edges.map(|(a, b)| (a.min(b), a.max(b)));
    // Sorted by the lower end, by counting; those of one vertex are few.
    let mut ends = vec![0_usize; vertices.len() + 1];
    edges.clone().for_each(|(low, _)| ends[low as usize + 1] += 1);
    for vertex in 0..vertices.len() {
        ends[vertex + 1] += ends[vertex];
    }
    let count = ends[vertices.len()];
    let mut highs = vec![0_u32; count];
    let mut next = ends.clone();
    for (low, high) in edges {
        highs[next[low as usize]] = high;
        next[low as usize] += 1;
    }
    let twice = |of_vertex: &mut [u32]| {
        of_vertex.sort_unstable();
        of_vertex.chunk_by(|a, b| a == b).all(|edge| edge.len() == 2)
    };
    count > 0 && ends.windows(2).all(|range| twice(&mut highs[range[0]..range[1]]))
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
