//! The meshes of one page: each stored once, reduced until all of them together are small.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::view::document::model::MeshEntry;
use crate::view::geometry::blob::Blob;
use crate::view::geometry::decimation::Decimation;
use crate::view::geometry::grid::GridMesh;
use foliate_components::Pose;
use foliate_components::robot::shape::{Geometry, Mesh};
use foliate_kernels::collision::convex::{Convex, Core};
use foliate_kernels::collision::{DistanceQuery, Solid, clearance};
use glam::DVec3;
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::sync::Arc;

/// Most triangles of a page, where nothing else is asked.
pub const TRIANGLES: usize = 200_000;
/// A mesh of fewer triangles stays as it is.
pub(crate) const SMALL: usize = 200;
/// The first cost of contractions that is allowed, m²: 0.02 mm squared. Then twice as much, until there are few enough.
const FIRST_COST: f64 = 4e-10;
/// Nothing is taken farther from the surface than the root of the cost times this.
const FARTHER: f64 = 3.0;
/// How often the cost grows.
const ROUNDS: u32 = 40;

/// Meshes that are asked for, by their content.
#[derive(Debug, Default)]
pub(crate) struct MeshStore {
    meshes: Vec<Arc<Mesh>>,
    by_content: HashMap<[u8; 32], usize>,
    by_address: HashMap<usize, usize>,
}

/// All meshes of a page as they are shown.
#[derive(Debug, Default)]
pub(crate) struct StoredMeshes {
    pub entries: Vec<MeshEntry>,
    /// The largest deviation, metres.
    pub deviation: f64,
    /// As the files have them, and as they are shown.
    pub triangles: [usize; 2],
}

impl MeshStore {
    /// The number that a mesh has; a mesh that is there already has one.
    pub fn number(&mut self, mesh: &Arc<Mesh>) -> usize {
        let address = Arc::as_ptr(mesh) as usize;
        if let Some(&number) = self.by_address.get(&address) {
            return number;
        }
        let number = *self.by_content.entry(content(mesh)).or_insert_with(|| {
            self.meshes.push(mesh.clone());
            self.meshes.len() - 1
        });
        // Held, so that nothing else comes to lie at the address.
        if !Arc::ptr_eq(&self.meshes[number], mesh) {
            return number;
        }
        self.by_address.insert(address, number);
        number
    }

    /// Writes all meshes, with at most about `triangles` triangles together.
    pub fn write(&self, triangles: usize, blob: &mut Blob) -> StoredMeshes {
        let grids = self.meshes.par_iter().map(|mesh| GridMesh::new(&mesh.vertices, &mesh.triangles));
        let grids: Vec<Option<GridMesh>> = grids.collect();
        let count = |grids: &[Option<GridMesh>]| grids.iter().flatten().map(|grid| grid.triangles.len()).sum::<usize>();
        let reduced = if count(&grids) > triangles { reduce(grids, triangles) } else { grids };
        let deviations = self.meshes.par_iter().zip(&reduced);
        let deviations: Vec<f64> = deviations
            .map(|(mesh, grid)| grid.as_ref().map_or_else(|| diagonal(mesh), |grid| deviation(mesh, grid)))
            .collect();
        let mut stored = StoredMeshes::default();
        for ((mesh, grid), deviation) in self.meshes.iter().zip(reduced).zip(deviations) {
            let entry = entry(mesh, &grid.unwrap_or_default(), deviation, blob);
            stored.deviation = stored.deviation.max(deviation);
            stored.triangles[0] += entry.of;
            stored.triangles[1] += entry.triangles;
            stored.entries.push(entry);
        }
        stored
    }
}

/// SHA-256 of what a mesh shows.
fn content(mesh: &Mesh) -> [u8; 32] {
    let mut sum = Sha256::new();
    sum.update((mesh.vertices.len() as u64).to_le_bytes());
    for vertex in &mesh.vertices {
        vertex.to_array().iter().for_each(|x| sum.update(x.to_le_bytes()));
    }
    mesh.triangles.iter().flatten().for_each(|corner| sum.update(corner.to_le_bytes()));
    sum.finalize().into()
}

/// Contracts what costs least, of all meshes alike, until few enough triangles are left.
fn reduce(grids: Vec<Option<GridMesh>>, triangles: usize) -> Vec<Option<GridMesh>> {
    let mut decimations: Vec<Option<Decimation>> =
        grids.into_par_iter().map(|grid| grid.map(Decimation::new)).collect();
    let mut cost = FIRST_COST;
    for _ in 0..ROUNDS {
        decimations
            .par_iter_mut()
            .flatten()
            .for_each(|decimation| decimation.reduce(cost, FARTHER * cost.sqrt(), SMALL));
        let left: usize = decimations.iter().flatten().map(Decimation::triangles).sum();
        if left <= triangles {
            break;
        }
        cost *= 2.0;
    }
    decimations.into_par_iter().map(|decimation| decimation.map(Decimation::finish)).collect()
}

/// The diagonal of the box around a mesh, metres: how much is not shown of a mesh of which nothing is left.
fn diagonal(mesh: &Mesh) -> f64 {
    let low = mesh.vertices.iter().copied().reduce(DVec3::min);
    let high = mesh.vertices.iter().copied().reduce(DVec3::max);
    low.zip(high).map_or(0.0, |(low, high)| low.distance(high)).min(f64::MAX)
}

/// How far the vertices of a mesh are from the triangles that are shown, metres, at most.
fn deviation(mesh: &Mesh, shown: &GridMesh) -> f64 {
    if mesh.triangles.len() == shown.triangles.len() {
        return shown.rounding();
    }
    let vertices: Vec<DVec3> = shown.places.iter().map(|&place| shown.position(place)).collect();
    let surface = Mesh::new(String::new(), vertices, shown.triangles.clone());
    let surface = Solid::of(&Geometry::Mesh(Arc::new(surface)));
    let point = Solid::Convex(Convex { core: Core::Point, radius: 0.0 });
    let (still, mut hint, mut farthest) = (Pose::identity(), DVec3::ZERO, 0.0_f64);
    for vertex in &mesh.vertices {
        let at = Pose::from_translation(*vertex);
        let query = DistanceQuery { absolute: 1e-6, ..DistanceQuery::exact(f64::MAX) };
        farthest = farthest.max(clearance(&surface, &still, &point, &at, query, &mut hint) + 1e-6);
    }
    farthest
}

fn entry(mesh: &Mesh, shown: &GridMesh, deviation: f64, blob: &mut Blob) -> MeshEntry {
    // 65535 itself is no index in what shows them.
    let wide = shown.places.len() >= usize::from(u16::MAX);
    let positions = blob.shorts(shown.places.iter().flatten().copied());
    let corners = shown.triangles.iter().flatten().copied();
    let indices = if wide { blob.words(corners) } else { blob.shorts(corners.map(|corner| corner as u16)) };
    MeshEntry {
        name: mesh.source.clone(),
        vertices: shown.places.len(),
        triangles: shown.triangles.len(),
        min: shown.min.to_array(),
        max: shown.max.to_array(),
        positions,
        indices,
        wide,
        of: mesh.triangles.len(),
        deviation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_of_which_nothing_is_left_deviates_by_its_size() {
        let mut store = MeshStore::default();
        store.number(&Arc::new(Mesh::new(
            String::new(),
            vec![DVec3::ZERO, DVec3::new(0.3, 0.4, 0.0)],
            vec![[0, 1, 1]],
        )));
        let stored = store.write(10, &mut Blob::default());
        assert_eq!(stored.triangles, [1, 0]);
        assert!((stored.deviation - 0.5).abs() < 1e-12, "{}", stored.deviation);
    }
}
