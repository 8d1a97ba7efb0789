//! A mesh on a grid of 16-bit numbers between its least and its greatest corner.

use glam::DVec3;
use std::collections::HashMap;

/// Positions on the grid, triangles between them. Vertices at one place are one; triangles with less than three places are gone, and of
/// several on the same three places one is left.
#[derive(Clone, Debug, Default)]
pub(crate) struct GridMesh {
    pub min: DVec3,
    pub max: DVec3,
    pub places: Vec<[u16; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

impl GridMesh {
    /// Vertices and triangles as they are, all indices in range and numbers finite; none where nothing is to be seen.
    pub fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Option<Self> {
        let min = vertices.iter().copied().reduce(DVec3::min)?;
        let max = vertices.iter().copied().reduce(DVec3::max)?;
        if !(min.is_finite() && max.is_finite()) {
            return None;
        }
        let mut mesh = Self { min, max, places: Vec::new(), triangles: Vec::new() };
        let step = mesh.step();
        let mut numbers: HashMap<[u16; 3], u32> = HashMap::new();
        let on_grid = |vertex: &DVec3| {
            let along = (*vertex - min) / step;
            // A flat mesh has no extent along one axis: every place is the first.
            along.to_array().map(|x| if x.is_finite() { x.round().clamp(0.0, 65535.0) as u16 } else { 0 })
        };
        let places: Vec<[u16; 3]> = vertices.iter().map(on_grid).collect();
        let mut seen = std::collections::HashSet::new();
        for triangle in triangles {
            let corners = triangle.map(|corner| places[corner as usize]);
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                continue;
            }
            let triangle = corners.map(|place| {
                *numbers.entry(place).or_insert_with(|| {
                    mesh.places.push(place);
                    mesh.places.len() as u32 - 1
                })
            });
            let mut key = triangle;
            key.sort_unstable();
            if seen.insert(key) {
                mesh.triangles.push(triangle);
            }
        }
        (!mesh.triangles.is_empty()).then_some(mesh)
    }

    /// Metres between two places, along each axis.
    pub fn step(&self) -> DVec3 {
        (self.max - self.min) / 65535.0
    }

    /// How far a vertex is from its place at most, metres.
    pub fn rounding(&self) -> f64 {
        0.5 * self.step().length()
    }

    /// Where a place is, metres.
    pub fn position(&self, place: [u16; 3]) -> DVec3 {
        self.min + self.step() * DVec3::from_array(place.map(f64::from))
    }

    /// Drops places that no triangle names; the others are numbered in the order in which triangles name them.
    pub fn drop_unused(&mut self) {
        let mut number = vec![u32::MAX; self.places.len()];
        let mut kept = Vec::new();
        for corner in self.triangles.iter_mut().flatten() {
            let known = &mut number[*corner as usize];
            if *known == u32::MAX {
                *known = kept.len() as u32;
                kept.push(self.places[*corner as usize]);
            }
            *corner = *known;
        }
        self.places = kept;
    }
}
