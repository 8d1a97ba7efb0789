//! Whether triangles bound a solid, and which of them say nothing that others have not said.
//!
//! Files of meshes hold triangles twice, needles without area, sheets between two parts of a solid, and vertices that should be one
//! and differ in their last digits. None of that makes a solid a shell.

use crate::robot::shape::positions::{Positions, first_at_position};
use glam::DVec3;

/// Corners nearer to each other than this times the mesh's extent are one corner, where whether a surface is closed is asked: a
/// digit or so of the single precision in which files are written. Vertices stay where they are.
const WELD: f64 = 1e-8;

/// What is found about some triangles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surface {
    /// Whether they bound a solid: what is inside is told by how often a ray crosses them.
    pub closed: bool,
    /// Numbers of triangles that are there a second time, ascending: the surface is the same without them.
    pub doubled: Vec<u32>,
}

impl Surface {
    /// Of triangles whose indices are in range.
    ///
    /// A surface is closed where at every edge an even number of triangles meet. Corners at one position, or nearly so, are one;
    /// triangles with two corners in one bound nothing. Of a triangle that is there several times one counts. Of two that face
    /// opposite ways one counts as well (surfaces written with both sides), or, where that leaves a hole, none (the sheet between two
    /// solids that touch, or a fin): every piece has to have something left that bounds it.
    #[must_use]
    pub fn of(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        Self::of_while(vertices, triangles, &|| true).unwrap_or_default()
    }

    /// As [`Self::of`]; none once `go_on` says no. It is asked between passes over all triangles, of which each takes some tenths of a
    /// second for four million.
    #[must_use]
    pub fn of_while(vertices: &[DVec3], triangles: &[[u32; 3]], go_on: &dyn Fn() -> bool) -> Option<Self> {
        let goes_on = || go_on().then_some(());
        goes_on()?;
        let same = first_at_position(vertices);
        goes_on()?;
        if is_plainly_closed(&same, triangles) {
            return Some(Self { closed: true, doubled: Vec::new() });
        }
        goes_on()?;
        let exact = Faces::of(&same, triangles);
        goes_on()?;
        let found = exact.judge();
        if found.closed {
            return Some(found);
        }
        goes_on()?;
        let near = welded(vertices);
        goes_on()?;
        let faces = Faces::of(&near, triangles);
        goes_on()?;
        let welded = faces.judge();
        Some(if welded.closed { welded } else { found })
    }
}

/// Whether every edge belongs to two triangles, which are not the two sides of one. So it is with most meshes, and soon found.
fn is_plainly_closed(same: &[u32], triangles: &[[u32; 3]]) -> bool {
    let corners = triangles.iter().map(|t| t.map(|i| same[i as usize]));
    let corners = corners.filter(|[a, b, c]| a != b && b != c && c != a);
    // An edge with the corner opposite to it.
    let edges = corners.flat_map(|[a, b, c]| [(a, b, c), (b, c, a), (c, a, b)]);
    let edges = edges.map(|(a, b, opposite)| (a.min(b), a.max(b), opposite));
    // Sorted by the lower end, by counting; those of one vertex are few.
    let mut ends = vec![0_usize; same.len() + 1];
    edges.clone().for_each(|(low, ..)| ends[low as usize + 1] += 1);
    for vertex in 0..same.len() {
        ends[vertex + 1] += ends[vertex];
    }
    let count = ends[same.len()];
    let mut others = vec![(0_u32, 0_u32); count];
    let mut next = ends.clone();
    for (low, high, opposite) in edges {
        others[next[low as usize]] = (high, opposite);
        next[low as usize] += 1;
    }
    let twice = |of_vertex: &mut [(u32, u32)]| {
        of_vertex.sort_unstable();
        of_vertex.chunk_by(|a, b| a.0 == b.0).all(|edge| edge.len() == 2 && edge[0].1 != edge[1].1)
    };
    count > 0 && ends.windows(2).all(|range| twice(&mut others[range[0]..range[1]]))
}

/// For every vertex the first one that is near it.
fn welded(vertices: &[DVec3]) -> Vec<u32> {
    let Some(low) = vertices.iter().copied().reduce(DVec3::min) else { return Vec::new() };
    let high = vertices.iter().copied().fold(low, DVec3::max);
    let near = WELD * (high - low).max_element();
    if !(near.is_finite() && near > 0.0) {
        return first_at_position(vertices);
    }
    // Cells several times as large: most points are near one cell only. Each cell keeps the first that fell into it.
    let cell = 8.0 * near;
    let mut cells = Positions::with_capacity(vertices.len());
    let mut firsts: Vec<u32> = Vec::with_capacity(vertices.len());
    for (number, &vertex) in vertices.iter().enumerate() {
        let (from, to) = (((vertex - low - near) / cell).floor(), ((vertex - low + near) / cell).floor());
        let known = corners_between(from, to).filter_map(|at| cells.get(at)).find(|&first| {
            let between: DVec3 = vertices[first as usize] - vertex;
            between.abs().max_element() <= near
        });
        let first = known.unwrap_or(number as u32);
        cells.number(((vertex - low) / cell).floor(), first);
        firsts.push(first);
    }
    firsts
}

/// The cells with these two in opposite corners: one to eight, as the two differ by at most one along each axis.
fn corners_between(from: DVec3, to: DVec3) -> impl Iterator<Item = DVec3> {
    let differs = from.cmpne(to);
    (0..8_u32).filter(move |bits| bits & !differs.bitmask() == 0).map(move |bits| {
        let pick = |axis: usize| if bits >> axis & 1 == 1 { to[axis] } else { from[axis] };
        DVec3::new(pick(0), pick(1), pick(2))
    })
}

/// One triangle: its corners in ascending order, whether they were so up to a rotation, and its number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Face {
    corners: [u32; 3],
    number: u32,
    is_turned: bool,
}

/// Triangles with three corners, those between the same corners together, in the order of their numbers.
struct Faces(Vec<Face>);

impl Faces {
    fn of(same: &[u32], triangles: &[[u32; 3]]) -> Self {
        let face = |(number, triangle): (usize, &[u32; 3])| {
            let [a, b, c] = triangle.map(|i| same[i as usize]);
            let mut corners = [a, b, c];
            corners.sort_unstable();
            let [x, y, z] = corners;
            let is_turned = ![[x, y, z], [y, z, x], [z, x, y]].contains(&[a, b, c]);
            (x != y && y != z).then_some(Face { corners, number: number as u32, is_turned })
        };
        let mut faces: Vec<Face> = triangles.iter().enumerate().filter_map(face).collect();
        faces.sort_unstable();
        Self(faces)
    }

    fn groups(&self) -> impl Iterator<Item = &[Face]> + Clone {
        self.0.chunk_by(|a, b| a.corners == b.corners)
    }

    fn judge(&self) -> Surface {
        if is_even(self.groups().map(|group| group[0].corners)) {
            return Surface { closed: true, doubled: ascending(self.groups().flat_map(|group| &group[1..])) };
        }
        let is_sheet = |group: &&[Face]| group.iter().any(|face| face.is_turned != group[0].is_turned);
        let rest = || self.groups().filter(|group| !is_sheet(group)).map(|group| group[0].corners);
        let closed = is_even(rest()) && self.pieces_are_among(rest());
        // A sheet keeps its two sides, which count as none.
        let again = |group: &'_ [Face]| -> Vec<Face> {
            let first = |side: bool| group.iter().find(|face| face.is_turned == side).map(|face| face.number);
            let firsts = [first(false), first(true)];
            group.iter().filter(|face| !firsts.contains(&Some(face.number))).copied().collect()
        };
        let doubled: Vec<Face> = self.groups().flat_map(again).collect();
        Surface { closed, doubled: ascending(&doubled) }
    }

    /// Whether every connected piece has one of these triangles.
    fn pieces_are_among(&self, some: impl Iterator<Item = [u32; 3]>) -> bool {
        let most = self.0.iter().map(|face| face.corners[2]).max().map_or(0, |most| most as usize + 1);
        let mut parent: Vec<u32> = (0..most as u32).collect();
        for face in &self.0 {
            let [a, b, c] = face.corners;
            let one = root(&mut parent, a);
            for other in [b, c] {
                let other = root(&mut parent, other);
                parent[other as usize] = one;
            }
        }
        let mut bounded = vec![false; most];
        some.for_each(|[a, ..]| bounded[root(&mut parent, a) as usize] = true);
        self.0.iter().all(|face| bounded[root(&mut parent, face.corners[0]) as usize])
    }
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

fn ascending<'f>(faces: impl IntoIterator<Item = &'f Face>) -> Vec<u32> {
    let mut numbers: Vec<u32> = faces.into_iter().map(|face| face.number).collect();
    numbers.sort_unstable();
    numbers
}

/// Whether there are triangles, and an even number of them at every edge.
fn is_even(faces: impl Iterator<Item = [u32; 3]>) -> bool {
    let mut edges: Vec<(u32, u32)> = faces.flat_map(|[a, b, c]| [(a, b), (b, c), (a, c)]).collect();
    edges.sort_unstable();
    !edges.is_empty() && edges.chunk_by(|a, b| a == b).all(|edge| edge.len().is_multiple_of(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube from `low`, of side 1: corners by the bits of their number.
    fn cube(low: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let corner = |i: u32| low + DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        ((0..8).map(corner).collect(), faces.into_iter().flat_map(halves).collect())
    }

    /// Both, with vertices of their own.
    fn both(one: (Vec<DVec3>, Vec<[u32; 3]>), other: (Vec<DVec3>, Vec<[u32; 3]>)) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let shift = one.0.len() as u32;
        let moved = other.1.iter().map(|t| t.map(|i| i + shift));
        ([one.0, other.0].concat(), one.1.into_iter().chain(moved).collect())
    }

    fn of(solid: &(Vec<DVec3>, Vec<[u32; 3]>)) -> Surface {
        Surface::of(&solid.0, &solid.1)
    }

    fn closed(doubled: &[u32]) -> Surface {
        Surface { closed: true, doubled: doubled.to_vec() }
    }

    #[test]
    fn a_cube_is_closed_and_a_box_without_a_lid_is_not() {
        let mut solid = cube(DVec3::ZERO);
        assert_eq!(of(&solid), closed(&[]));
        solid.1.pop();
        assert_eq!(of(&solid), Surface::default());
        assert_eq!(Surface::of(&[], &[]), Surface::default());
    }

    #[test]
    fn a_triangle_that_is_there_again_counts_once_whichever_way_it_faces() {
        let (vertices, triangles) = cube(DVec3::ZERO);
        let [a, b, c] = triangles[4];
        for again in [[a, b, c], [b, c, a], [a, c, b]] {
            let more = [triangles.clone(), vec![again]].concat();
            assert_eq!(Surface::of(&vertices, &more), closed(&[12]));
        }
        // All of it twice, with vertices of their own; and with both sides.
        assert_eq!(of(&both(cube(DVec3::ZERO), cube(DVec3::ZERO))).doubled, (12..24).collect::<Vec<_>>());
        let turned: Vec<_> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let sides = Surface::of(&vertices, &[triangles.clone(), turned.clone()].concat());
        assert_eq!(sides, closed(&(12..24).collect::<Vec<_>>()));
        // Both sides of a box without a lid are a shell.
        let open = [&triangles[1..], &turned[1..]].concat();
        assert_eq!(Surface::of(&vertices, &open), Surface::default());
    }

    #[test]
    fn needles_bound_nothing() {
        let (vertices, mut triangles) = cube(DVec3::ZERO);
        triangles.extend([[0, 0, 1], [3, 3, 3]]);
        assert!(Surface::of(&vertices, &triangles).closed);
    }

    #[test]
    fn solids_that_touch_are_solids() {
        // Along a face, of which both have a side; along an edge; apart.
        for low in [DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::X * 3.0] {
            assert_eq!(of(&both(cube(DVec3::ZERO), cube(low))), closed(&[]), "{low}");
        }
        let mut open = both(cube(DVec3::ZERO), cube(DVec3::X * 3.0));
        open.1.pop();
        assert!(!of(&open).closed, "one of two pieces is open");
    }

    #[test]
    fn a_sheet_beside_a_solid_is_no_solid() {
        let (mut vertices, mut triangles) = cube(DVec3::ZERO);
        // A fin on an edge, with both sides: the cube is as solid as before.
        vertices.push(DVec3::new(0.5, -1.0, -1.0));
        triangles.extend([[0, 1, 8], [0, 8, 1]]);
        assert_eq!(Surface::of(&vertices, &triangles), closed(&[]));
        // The same sheet apart from the cube bounds nothing.
        let sheet = (vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2], [0, 2, 1]]);
        assert!(!of(&both(cube(DVec3::splat(3.0)), sheet.clone())).closed);
        assert!(!of(&sheet).closed);
    }

    #[test]
    fn corners_that_differ_in_the_last_digits_are_one() {
        let cracked = |by: f64| {
            let (vertices, triangles) = cube(DVec3::splat(-0.3));
            // Every triangle has vertices of its own, a little off.
            let off = |i: usize| DVec3::new([-by, by][i % 2], [by, 0.0, -by][i % 3], 0.0);
            let corners = triangles.as_flattened().iter().enumerate().map(|(i, &v)| vertices[v as usize] + off(i));
            let numbers = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
            Surface::of(&corners.collect::<Vec<_>>(), &numbers.collect::<Vec<_>>())
        };
        assert_eq!(cracked(0.0), closed(&[]));
        assert_eq!(cracked(4e-9), closed(&[]));
        assert!(!cracked(1e-6).closed, "a crack of a micrometre");
    }
}
