//! Solids: primitives with their own frame in the middle, z along the axis (URDF's convention), and triangle meshes.

use crate::robot::shape::closed_surface::Surface;
use crate::robot::shape::mesh_record::MeshRecord;
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
    /// Whether the mesh bounds a solid ([`Surface::of`](crate::robot::shape::closed_surface::Surface::of)).
    pub closed: bool,
    /// What an earlier search over vertices and triangles found, so that it need not be repeated. Its user proves it first.
    pub record: Option<MeshRecord>,
    /// Whether the file could not be read, and a small box stands for it: only for what shows models and asks for that.
    pub placeholder: bool,
}

/// Half of a side of a box that stands for a mesh, metres.
const PLACEHOLDER: f64 = 0.025;

impl Mesh {
    /// A mesh from triangles, with `closed` found from its edges. Vertices at the same position count as one; of triangles that are
    /// there several times one is kept.
    ///
    /// # Panics
    /// Never: triangles whose indices are out of range are dropped.
    #[must_use]
    pub fn new(source: String, vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self::new_while(source, vertices, triangles, &|| true).unwrap_or_default()
    }

    /// As [`Self::new`]; none once `go_on` says no, see [`Surface::of_while`](crate::robot::shape::closed_surface::Surface::of_while).
    #[must_use]
    pub fn new_while(
        source: String,
        vertices: Vec<DVec3>,
        mut triangles: Vec<[u32; 3]>,
        go_on: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let count = vertices.len() as u32;
        triangles.retain(|t| t.iter().all(|&i| i < count));
        let surface = Surface::of_while(&vertices, &triangles, go_on)?;
        let mut doubled = surface.doubled.iter().copied().peekable();
        let mut number = 0;
        triangles.retain(|_| {
            number += 1;
            doubled.next_if_eq(&(number - 1)).is_none()
        });
        Some(Self { source, vertices, triangles, closed: surface.closed, record: None, placeholder: false })
    }

    /// A box with sides of 5 cm in place of a mesh that could not be read.
    #[must_use]
    pub fn placeholder(source: String) -> Self {
        let sign = |bit: u32| if bit == 0 { -PLACEHOLDER } else { PLACEHOLDER };
        let vertices = (0..8_u32).map(|i| DVec3::new(sign(i & 1), sign(i & 2), sign(i & 4))).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Self { placeholder: true, ..Self::new(source, vertices, triangles) }
    }
}

impl Geometry {
    /// The file of a mesh that could not be read, where this is the box in its place ([`Mesh::placeholder`]).
    #[must_use]
    pub fn missing_file(&self) -> Option<&str> {
        match self {
            Self::Mesh(mesh) if mesh.placeholder => Some(&mesh.source),
            _ => None,
        }
    }

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
