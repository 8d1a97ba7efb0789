//! Solids of links: what collides, or what is seen.

use crate::arrays::{Array, matrix};
use foliate::components::pose::pose_to_array;
use foliate::components::robot::shape::Geometry;
use foliate::scene::{Surface, Visual};
use pyo3::prelude::*;

/// A solid of a link.
#[pyclass(frozen, name = "Solid", module = "foliate")]
pub struct PySolid {
    link: String,
    visual: Visual,
}

impl PySolid {
    pub(crate) fn of(link: &str, visual: &Visual) -> Self {
        Self { link: link.to_owned(), visual: visual.clone() }
    }

    fn surface(&self) -> Surface {
        Surface::of(&self.visual.geometry).unwrap_or_default()
    }
}

#[pymethods]
impl PySolid {
    /// The link that it belongs to, `part/link`.
    #[getter]
    fn link(&self) -> &str {
        &self.link
    }

    /// `"box"`, `"cylinder"`, `"sphere"`, `"capsule"` or `"mesh"`.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.visual.geometry {
            Geometry::Box { .. } => "box",
            Geometry::Cylinder { .. } => "cylinder",
            Geometry::Sphere { .. } => "sphere",
            Geometry::Capsule { .. } => "capsule",
            Geometry::Mesh(_) => "mesh",
        }
    }

    /// Its sizes, metres: the sides of a box; radius and length of a cylinder; the radius of a sphere; radius and length of a capsule without its round ends;
    /// nothing of a mesh.
    #[getter]
    fn size(&self) -> Vec<f64> {
        match &self.visual.geometry {
            Geometry::Box { half_extents } => (2.0 * half_extents).to_array().to_vec(),
            Geometry::Cylinder { radius, half_length } | Geometry::Capsule { radius, half_length } => {
                vec![*radius, 2.0 * half_length]
            }
            Geometry::Sphere { radius } => vec![*radius],
            Geometry::Mesh(_) => Vec::new(),
        }
    }

    /// Its pose in the link: x, y, z in metres and the quaternion x, y, z, w.
    #[getter]
    fn pose(&self) -> [f64; 7] {
        pose_to_array(&self.visual.link_from_visual)
    }

    /// Red, green, blue and opacity from 0 to 1; `None` where the model says nothing.
    #[getter]
    fn color(&self) -> Option<[f64; 4]> {
        self.visual.color
    }

    /// The corners of its surface in its own frame, metres: an array of shape (vertices, 3). Round solids are approximated from inside.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let numbers = self.surface().vertices.iter().flatten().map(|x| f64::from(*x)).collect();
        matrix(py, numbers, 3)
    }

    /// Triangles of its surface as indices of vertices, counter-clockwise seen from outside: an array of shape (triangles, 3).
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, u32>> {
        matrix(py, self.surface().triangles.into_iter().flatten().collect(), 3)
    }

    fn __repr__(&self) -> String {
        format!("Solid({:?}, {})", self.link, self.kind())
    }
}
