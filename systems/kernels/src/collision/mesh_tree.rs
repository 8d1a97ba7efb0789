//! A hierarchy of boxes over a mesh's triangles, and the question whether a point is inside a closed mesh.
//!
//! parry's mesh distance is three orders of magnitude too slow for a planner and its meshes are hollow
//! (reference/rust.md §4), so this is ours: axis-aligned boxes in the mesh's frame, median splits, f64 throughout.

use super::hull::Hull;
use foliate_components::robot::shape::Mesh;
use glam::DVec3;

/// Triangles per leaf.
const LEAF: usize = 2;

/// Triangles in a binary tree of axis-aligned boxes.
#[derive(Clone, Debug, Default)]
pub struct MeshTree {
    pub(super) nodes: Vec<Node>,
    /// In the order of the leaves.
    pub(super) triangles: Vec<[DVec3; 3]>,
    /// One vertex of each connected component: where none of them is inside a solid whose surface the mesh does not
    /// touch, nothing of the mesh is.
    pub(super) witnesses: Vec<DVec3>,
    /// Few points around it.
    pub(super) hull: Hull,
    closed: bool,
}

/// A box, and what is in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub center: DVec3,
    pub half: DVec3,
    /// An inner node: index of its second child (the first stands behind it). A leaf: index of its first triangle.
    pub next: u32,
    /// Number of triangles of a leaf, 0 for inner nodes.
    pub count: u32,
}

impl Node {
    pub(super) fn is_leaf(&self) -> bool {
        self.count > 0
    }
}

impl MeshTree {
    /// Builds the tree. Triangles with a coordinate that is not finite are kept and make every answer *in collision*.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        let corner = |i: u32| mesh.vertices.get(i as usize).copied().unwrap_or(DVec3::NAN);
        let mut triangles: Vec<[DVec3; 3]> = mesh.triangles.iter().map(|t| t.map(corner)).collect();
        let mut tree = Self { witnesses: witnesses(mesh), closed: mesh.closed, ..Self::default() };
        if !triangles.is_empty() {
            tree.split(&mut triangles);
        }
        tree.triangles = triangles;
        if tree.nodes.first().is_some_and(|root| root.half.is_finite()) {
            tree.hull = Hull::new(&mesh.vertices, extreme_points(&mesh.vertices));
        }
        tree
    }

    /// Splits at the median of the longest side, with a stack of our own (ranges halve, so it stays short).
    fn split(&mut self, triangles: &mut [[DVec3; 3]]) {
        let mut stack = vec![(0, triangles.len(), None)];
        while let Some((first, last, parent)) = stack.pop() {
            let index = self.nodes.len();
            if let Some(parent) = parent {
                let parent: &mut Node = &mut self.nodes[parent];
                parent.next = index as u32;
            }
            let (center, half) = bounds(&triangles[first..last]);
            if last - first <= LEAF {
                self.nodes.push(Node { center, half, next: first as u32, count: (last - first) as u32 });
                continue;
            }
            self.nodes.push(Node { center, half, next: 0, count: 0 });
            let axis = longest_axis(half);
            let middle = first.midpoint(last);
            let key = |t: &[DVec3; 3]| t[0][axis] + t[1][axis] + t[2][axis];
            triangles[first..last].select_nth_unstable_by(middle - first, |a, b| key(a).total_cmp(&key(b)));
            // The first child is popped next and so stands right behind its parent.
            stack.push((middle, last, Some(index)));
            stack.push((first, middle, None));
        }
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

    /// Whether a point, in the mesh's frame, is inside the solid; false for meshes that are not closed.
    ///
    /// Rays in several directions count crossings. Inside is where their number is odd, or where they do not balance
    /// (solids that overlap each other). A ray that meets an edge is no witness; without any clean ray, or where two
    /// disagree, the answer is true: in doubt, in collision.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        if !self.closed || self.nodes.is_empty() {
            return false;
        }
        if !point.is_finite() {
            return true;
        }
        let root = &self.nodes[0];
        if (point - root.center).abs().cmpgt(root.half).any() {
            return false;
        }
        let mut clean = self.clean_crossings(point);
        match (clean.next(), clean.next()) {
            (Some(first), Some(second)) => first.tell_inside() || second.tell_inside(),
            _ => true,
        }
    }

    /// Whether a point, in the mesh's frame, is inside the solid beyond doubt: three rays are clean and cross the surface an odd
    /// number of times each.
    pub(super) fn surely_contains(&self, point: DVec3) -> bool {
        if !self.closed || !point.is_finite() {
            return false;
        }
        let is_odd = |crossings: Crossings| crossings.count % 2 == 1;
        let mut clean = self.clean_crossings(point);
        (0..3).all(|_| clean.next().is_some_and(is_odd))
    }

    fn clean_crossings(&self, point: DVec3) -> impl Iterator<Item = Crossings> + '_ {
        RAYS.iter().filter_map(move |&ray| self.crossings(point, DVec3::from_array(ray)))
    }

    /// Where a ray crosses the surface; none where it passes too close to an edge to be sure.
    fn crossings(&self, from: DVec3, direction: DVec3) -> Option<Crossings> {
        let inverse = direction.recip();
        let mut crossings = Crossings { count: 0, balance: 0 };
        let mut stack = [0_u32; 64];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let index = stack[depth] as usize;
            let node = &self.nodes[index];
            if !ray_meets_box(from, inverse, node) {
                continue;
            }
            if node.is_leaf() {
                let first = node.next as usize;
                for triangle in &self.triangles[first..first + node.count as usize] {
                    let side = ray_meets_triangle(from, direction, triangle)?;
                    crossings.count += side.unsigned_abs();
                    crossings.balance += side;
                }
            } else {
                (stack[depth], stack[depth + 1]) = (node.next, index as u32 + 1);
                depth += 2;
            }
        }
        Some(crossings)
    }
}

/// How often a ray crosses a surface, and how much more often it leaves than enters.
#[derive(Clone, Copy, Debug)]
struct Crossings {
    count: u32,
    balance: i32,
}

impl Crossings {
    fn tell_inside(self) -> bool {
        self.count % 2 == 1 || self.balance != 0
    }
}

/// Directions that no sane model is aligned with.
const RAYS: [[f64; 3]; 6] = [
    [0.683_012, 0.549_021, 0.481_713],
    [-0.391_207, 0.727_113, -0.564_109],
    [0.311_903, -0.412_021, 0.856_107],
    [-0.771_309, -0.273_107, 0.575_021],
    [0.129_017, 0.913_019, -0.387_011],
    [-0.547_031, -0.631_013, -0.550_127],
];

/// Slab test, widened by rounding; NaN (a coordinate of 0/0) counts as a hit.
fn ray_meets_box(from: DVec3, inverse: DVec3, node: &Node) -> bool {
    let near = (node.center - node.half - from) * inverse;
    let far = (node.center + node.half - from) * inverse;
    let (enter, leave) = (near.min(far).max_element(), near.max(far).min_element());
    let slack = 1e-9 * (1.0 + enter.abs());
    !(enter > leave + slack || leave < -slack)
}

/// 1 where the ray leaves through the triangle's front, −1 where it enters, 0 where it misses; none in doubt.
fn ray_meets_triangle(from: DVec3, direction: DVec3, &[a, b, c]: &[DVec3; 3]) -> Option<i32> {
    let (a, b, c) = (a - from, b - from, c - from);
    // Volumes of ray and edges (Plücker): all of one sign where the line passes inside.
    let volumes = [direction.dot(b.cross(a)), direction.dot(c.cross(b)), direction.dot(a.cross(c))];
    let normal = (b - a).cross(c - a);
    let area = normal.length();
    if area == 0.0 {
        return Some(0); // degenerate: its neighbours close the surface without it
    }
    let edge = (b - a).length().max((c - b).length()).max((a - c).length());
    let reach = a.length().max(b.length()).max(c.length());
    let doubt = 1e-12 * edge * reach;
    let (low, high) = (volumes[0].min(volumes[1]).min(volumes[2]), volumes[0].max(volumes[1]).max(volumes[2]));
    if low < -doubt && high > doubt {
        return Some(0);
    }
    let (height, slope) = (normal.dot(a), normal.dot(direction));
    // In front of the whole triangle, or behind it, edges do not matter.
    let along = a.dot(direction).max(b.dot(direction)).max(c.dot(direction));
    if along < -1e-12 * reach {
        return Some(0);
    }
    if low.abs() <= doubt || high.abs() <= doubt || slope.abs() <= 1e-9 * area || height.abs() <= 1e-12 * area {
        return None;
    }
    let distance = height / slope;
    Some(if distance < 0.0 {
        0
    } else if slope > 0.0 {
        1
    } else {
        -1
    })
}

fn bounds(triangles: &[[DVec3; 3]]) -> (DVec3, DVec3) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in triangles.iter().flatten() {
        if !p.is_finite() {
            // A box that nothing is far from.
            return (DVec3::ZERO, DVec3::INFINITY);
        }
        (low, high) = (low.min(*p), high.max(*p));
    }
    ((low + high) * 0.5, (high - low) * (0.5 * (1.0 + 1e-15)))
}

/// The vertices that lie farthest in each of 98 directions.
fn extreme_points(vertices: &[DVec3]) -> Vec<DVec3> {
    let range = || -2..=2_i32;
    let directions = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| (x, y, z))));
    directions
        .filter(|&(x, y, z)| x.abs().max(y.abs()).max(z.abs()) == 2)
        .filter_map(|(x, y, z)| {
            let d = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            vertices.iter().max_by(|a, b| a.dot(d).total_cmp(&b.dot(d))).copied()
        })
        .collect()
}

fn longest_axis(half: DVec3) -> usize {
    if half.x >= half.y && half.x >= half.z {
        0
    } else if half.y >= half.z {
        1
    } else {
        2
    }
}

/// One vertex of each connected component (triangles that share a vertex position).
fn witnesses(mesh: &Mesh) -> Vec<DVec3> {
    use std::collections::HashMap;
    let mut ids: HashMap<[u64; 3], usize> = HashMap::with_capacity(mesh.vertices.len());
    let same: Vec<usize> = mesh
        .vertices
        .iter()
        .enumerate()
        .map(|(i, p)| *ids.entry([p.x, p.y, p.z].map(|c| (c + 0.0).to_bits())).or_insert(i))
        .collect();
    let mut parent: Vec<usize> = (0..mesh.vertices.len()).collect();
    for t in &mesh.triangles {
        let Some(first) = same.get(t[0] as usize).map(|&i| root(&mut parent, i)) else { continue };
        for &i in &t[1..] {
            if let Some(&i) = same.get(i as usize) {
                let other = root(&mut parent, i);
                parent[other] = first;
            }
        }
    }
    let mut seen = std::collections::HashSet::new();
    let mut found = Vec::new();
    for t in &mesh.triangles {
        if let Some(&i) = same.get(t[0] as usize)
            && seen.insert(root(&mut parent, i))
        {
            found.push(mesh.vertices[i]);
        }
    }
    found
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}
