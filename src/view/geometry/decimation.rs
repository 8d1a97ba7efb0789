//! Takes triangles away that change a surface little.
//!
//! An edge is contracted into one of its ends: vertices stay where they were, so that 16-bit positions stay exact. The cost of a contraction is
//! the mean of squared distances of the remaining vertex to the planes of all triangles that it has taken in, by their areas ([`Quadric`]); edges
//! of holes count as walls. The cheapest comes first, unless it takes something too far
//! from the surface: a mean says little about a bump on a large plane. Ties go to the lowest numbers, so that the same mesh gives the same triangles.

use crate::view::geometry::grid::GridMesh;
use crate::view::geometry::quadric::Quadric;
use foliate_kernels::collision::convex::closest_on_triangle;
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// How much more the edge of a hole weighs than a triangle as long on each side.
const WALL: f64 = 10.0;
/// A contraction is refused if it turns a triangle so far that the cosine of the angle is not above this.
const TURN: f64 = 0.2;

/// A contraction: its cost as bits (costs are at least 0, so that bits have the order of numbers), what goes, what stays, and how often both
/// had changed.
type Entry = Reverse<(u64, u32, u32, u32, u32)>;

/// A mesh that is losing triangles.
pub(crate) struct Decimation {
    mesh: GridMesh,
    positions: Vec<DVec3>,
    /// By vertex the triangles around it; some are gone.
    around: Vec<Vec<u32>>,
    gone: Vec<bool>,
    left: usize,
    quadrics: Vec<Quadric>,
    /// By vertex whether it is on the edge of a hole, or where more than two triangles meet.
    is_border: Vec<bool>,
    /// By vertex how often it has changed.
    changes: Vec<u32>,
    /// By vertex how far what it has taken in is from the surface, at most: each contraction adds how far its vertex is from the new triangles.
    off: Vec<f64>,
    heap: BinaryHeap<Entry>,
    /// What was cheap enough and would have moved something too far.
    deferred: Vec<Entry>,
}

impl Decimation {
    pub fn new(mesh: GridMesh) -> Self {
        let positions: Vec<DVec3> = mesh.places.iter().map(|&place| mesh.position(place)).collect();
        let count = positions.len();
        let mut decimation = Self {
            around: vec![Vec::new(); count],
            gone: vec![false; mesh.triangles.len()],
            left: mesh.triangles.len(),
            quadrics: vec![Quadric::default(); count],
            is_border: vec![false; count],
            changes: vec![0; count],
            off: vec![0.0; count],
            heap: BinaryHeap::new(),
            deferred: Vec::new(),
            positions,
            mesh,
        };
        decimation.prepare();
        decimation
    }

    /// How many triangles are left.
    pub fn triangles(&self) -> usize {
        self.left
    }

    fn prepare(&mut self) {
        let mut edges: HashMap<(u32, u32), (u32, u32)> = HashMap::new();
        for (number, triangle) in self.mesh.triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|i| self.positions[i as usize]);
            let normal = (b - a).cross(c - a);
            let area = 0.5 * normal.length();
            let plane = Quadric::plane(normal.normalize_or_zero(), a, area);
            for corner in 0..3 {
                let (from, to) = (triangle[corner], triangle[(corner + 1) % 3]);
                self.around[from as usize].push(number as u32);
                self.quadrics[from as usize] += plane;
                let edge = edges.entry((from.min(to), from.max(to))).or_insert((0, number as u32));
                edge.0 += 1;
            }
        }
        let mut edges: Vec<((u32, u32), (u32, u32))> = edges.into_iter().collect();
        edges.sort_unstable();
        for &((a, b), (_, triangle)) in edges.iter().filter(|(_, (count, _))| *count != 2) {
            let (p, q) = (self.positions[a as usize], self.positions[b as usize]);
            let normal = self.normal(triangle);
            let wall = Quadric::plane((q - p).cross(normal).normalize_or_zero(), p, WALL * p.distance_squared(q));
            for end in [a, b] {
                self.is_border[end as usize] = true;
                self.quadrics[end as usize] += wall;
            }
        }
        edges.iter().for_each(|&((a, b), _)| self.offer(a, b));
    }

    fn normal(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.mesh.triangles[triangle as usize].map(|i| self.positions[i as usize]);
        (b - a).cross(c - a)
    }

    /// Puts both contractions of an edge up.
    fn offer(&mut self, a: u32, b: u32) {
        let sum = self.quadrics[a as usize] + self.quadrics[b as usize];
        for (goes, stays) in [(a, b), (b, a)] {
            if self.is_border[goes as usize] && !self.is_border[stays as usize] {
                continue;
            }
            let cost = sum.mean_at(self.positions[stays as usize]).to_bits();
            self.heap.push(Reverse((cost, goes, stays, self.changes[goes as usize], self.changes[stays as usize])));
        }
    }

    /// Contracts what costs no more than `cost`, m², and takes nothing farther from the surface than `most`, metres, while more than `least`
    /// triangles are left.
    pub fn reduce(&mut self, cost: f64, most: f64, least: usize) {
        self.heap.extend(self.deferred.drain(..));
        while self.left > least {
            let Some(&Reverse((bits, goes, stays, a, b))) = self.heap.peek() else { break };
            if f64::from_bits(bits) > cost {
                break;
            }
            self.heap.pop();
            let is_current = self.changes[goes as usize] == a && self.changes[stays as usize] == b;
            if !is_current || !self.may(goes, stays) {
                continue;
            }
            let off = self.off_after(goes, stays);
            match off <= most {
                true => self.contract(goes, stays, off),
                false => self.deferred.push(Reverse((bits, goes, stays, a, b))),
            }
        }
    }

    /// How far what both vertices have taken in is from the surface after a contraction, at most.
    fn off_after(&self, goes: u32, stays: u32) -> f64 {
        let p = self.positions[goes as usize];
        let fan = self.living(goes).map(|triangle| self.mesh.triangles[triangle as usize]);
        let fan = fan.filter(|corners| !corners.contains(&stays));
        let new = fan.map(|corners| corners.map(|i| self.positions[if i == goes { stays } else { i } as usize]));
        let distances = new.map(|triangle| closest_on_triangle(p, &triangle).distance(p));
        let nearest = distances.fold(self.positions[stays as usize].distance(p), f64::min);
        (self.off[goes as usize] + nearest).max(self.off[stays as usize])
    }

    fn living(&self, vertex: u32) -> impl Iterator<Item = u32> {
        self.around[vertex as usize].iter().copied().filter(|&t| !self.gone[t as usize])
    }

    fn neighbours(&self, vertex: u32) -> Vec<u32> {
        let corners = self.living(vertex).flat_map(|t| self.mesh.triangles[t as usize]);
        let mut neighbours: Vec<u32> = corners.filter(|&other| other != vertex).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        neighbours
    }

    /// Whether a contraction turns no triangle over, and pinches nothing.
    fn may(&self, goes: u32, stays: u32) -> bool {
        let mut shared = 0;
        for triangle in self.living(goes) {
            let corners = self.mesh.triangles[triangle as usize];
            if corners.contains(&stays) {
                shared += 1;
                continue;
            }
            let old = corners.map(|i| self.positions[i as usize]);
            let new = corners.map(|i| self.positions[if i == goes { stays } else { i } as usize]);
            let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
            let (before, after) = (normal(old), normal(new));
            let keeps = before.dot(after) > TURN * before.length() * after.length();
            if !keeps {
                return false;
            }
        }
        let (of_one, of_other) = (self.neighbours(goes), self.neighbours(stays));
        // A wall of a hole goes along the hole only.
        let is_along = !self.is_border[goes as usize] || shared != 2;
        is_along && of_one.iter().filter(|n| of_other.binary_search(n).is_ok()).count() == shared
    }

    fn contract(&mut self, goes: u32, stays: u32, off: f64) {
        self.off[stays as usize] = off;
        let moved: Vec<u32> = self.living(goes).collect();
        for triangle in moved {
            let corners = &mut self.mesh.triangles[triangle as usize];
            if corners.contains(&stays) {
                self.gone[triangle as usize] = true;
                self.left -= 1;
                continue;
            }
            corners.iter_mut().filter(|corner| **corner == goes).for_each(|corner| *corner = stays);
            self.around[stays as usize].push(triangle);
        }
        self.around[goes as usize] = Vec::new();
        let own = std::mem::take(&mut self.around[stays as usize]);
        self.around[stays as usize] = own.into_iter().filter(|&t| !self.gone[t as usize]).collect();
        let taken = self.quadrics[goes as usize];
        self.quadrics[stays as usize] += taken;
        self.is_border[stays as usize] |= self.is_border[goes as usize];
        self.changes[goes as usize] += 1;
        self.changes[stays as usize] += 1;
        for neighbour in self.neighbours(stays) {
            self.offer(stays, neighbour);
        }
    }

    /// What is left.
    pub fn finish(self) -> GridMesh {
        let Self { mut mesh, gone, .. } = self;
        let mut number = 0;
        mesh.triangles.retain(|_| {
            number += 1;
            !gone[number - 1]
        });
        mesh.drop_unused();
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of two triangles a patch.
    fn ball(around: u32) -> GridMesh {
        let mut vertices = Vec::new();
        for ring in 0..=around {
            for number in 0..around {
                let (a, b) = (f64::from(ring) / f64::from(around), f64::from(number) / f64::from(around));
                let (a, b) = (a * std::f64::consts::PI, b * std::f64::consts::TAU);
                // One vertex at each pole: the grid would tell apart what a rounding error tells apart.
                let radius = if ring % around == 0 { 0.0 } else { a.sin() };
                vertices.push(DVec3::new(radius * b.cos(), radius * b.sin(), a.cos()));
            }
        }
        let at = |ring: u32, number: u32| ring * around + number % around;
        let mut triangles = Vec::new();
        for ring in 0..around {
            for number in 0..around {
                let [a, b] = [at(ring, number), at(ring, number + 1)];
                let [c, d] = [at(ring + 1, number), at(ring + 1, number + 1)];
                triangles.extend([[a, c, d], [a, d, b]]);
            }
        }
        GridMesh::new(&vertices, &triangles).expect("a ball")
    }

    fn volume(mesh: &GridMesh) -> f64 {
        let corner = |i: u32| mesh.position(mesh.places[i as usize]);
        mesh.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0).sum()
    }

    #[test]
    fn a_ball_stays_a_closed_ball() {
        let mesh = ball(60);
        let (count, before) = (mesh.triangles.len(), volume(&mesh));
        let mut decimation = Decimation::new(mesh);
        decimation.reduce(f64::INFINITY, f64::INFINITY, count / 10);
        let mesh = decimation.finish();
        assert!(mesh.triangles.len() <= count / 10, "{}", mesh.triangles.len());
        assert!((volume(&mesh) - before).abs() < 0.03 * before, "{} {before}", volume(&mesh));
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        for t in &mesh.triangles {
            for corner in 0..3 {
                let (a, b) = (t[corner], t[(corner + 1) % 3]);
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|sum| *sum == 0));
    }

    #[test]
    fn a_flat_sheet_loses_what_says_nothing_and_keeps_its_edge() {
        let side = 20;
        let vertices: Vec<DVec3> =
            (0..=side).flat_map(|y| (0..=side).map(move |x| DVec3::new(f64::from(x), f64::from(y), 0.0))).collect();
        let at = |x: i32, y: i32| (y * (side + 1) + x) as u32;
        let triangles: Vec<[u32; 3]> = (0..side)
            .flat_map(|y| (0..side).map(move |x| (x, y)))
            .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]])
            .collect();
        let mut decimation = Decimation::new(GridMesh::new(&vertices, &triangles).expect("a sheet"));
        decimation.reduce(1e-12, 1e-6, 1);
        let mesh = decimation.finish();
        let corner = |i: u32| mesh.position(mesh.places[i as usize]);
        let area: f64 = mesh
            .triangles
            .iter()
            .map(|t| 0.5 * (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).length())
            .sum();
        assert!(mesh.triangles.len() < 20, "{}", mesh.triangles.len());
        assert!((area - 400.0).abs() < 1e-6, "{area}");
    }

    #[test]
    fn the_same_mesh_gives_the_same_triangles() {
        let reduced = || {
            let mut decimation = Decimation::new(ball(30));
            decimation.reduce(f64::INFINITY, f64::INFINITY, 300);
            decimation.finish().triangles
        };
        assert_eq!(reduced(), reduced());
    }
}
