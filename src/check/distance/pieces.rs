//! A shape as convex pieces in a tree of boxes, and the distance of two such trees.
//!
//! Two boxes are at least as far apart as their shadows on the axes of either. What is nearer than anything known is
//! opened, the nearest first; what is left closed bounds the answer from below.

use crate::check::distance::apart::{Bounds, Wanted, apart, depth};
use crate::check::distance::convex::{Core, Piece, parts};
use foliate_components::Pose;
use foliate_components::robot::shape::{Geometry, Mesh};
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// Most triangles of a leaf.
const LEAF: usize = 1;

/// A box around pieces. Its two children follow one another; a leaf has pieces instead.
#[derive(Clone, Copy, Debug)]
struct Node {
    center: DVec3,
    half: DVec3,
    /// Number of the first child, or of the first piece.
    first: u32,
    /// Number of pieces; 0 for a node with children.
    count: u32,
}

/// The convex pieces of a shape.
#[derive(Debug)]
pub(crate) struct Pieces {
    nodes: Vec<Node>,
    content: Content,
    /// Around every piece, metres.
    radius: f64,
}

#[derive(Debug)]
enum Content {
    One(Core),
    /// Triangles of a mesh in the order of the leaves.
    Triangles(Arc<Mesh>, Vec<u32>),
}

/// Pieces that were nearest the last time: the next distance is likely theirs.
pub(crate) type Hint = Option<(u32, u32)>;

impl Pieces {
    pub(crate) fn of(geometry: &Geometry) -> Self {
        match (Core::of(geometry), geometry) {
            (Some((core, radius)), _) => {
                let (center, half) = bounds(geometry);
                let half = half - DVec3::splat(radius);
                let node = Node { center, half, first: 0, count: 1 };
                Self { nodes: vec![node], content: Content::One(core), radius }
            }
            (None, Geometry::Mesh(mesh)) => Self::of_mesh(mesh),
            (None, _) => Self { nodes: Vec::new(), content: Content::One(Core::Point), radius: 0.0 },
        }
    }

    fn of_mesh(mesh: &Arc<Mesh>) -> Self {
        let corners = |t: u32| mesh.triangles[t as usize].map(|i| mesh.vertices[i as usize]);
        let middles: Vec<DVec3> =
            (0..mesh.triangles.len() as u32).map(|t| corners(t).into_iter().sum::<DVec3>() / 3.0).collect();
        let mut order: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
        let mut nodes = Vec::with_capacity(2 * order.len().div_ceil(LEAF));
        if !order.is_empty() {
            nodes.push(Node { center: DVec3::ZERO, half: DVec3::ZERO, first: 0, count: order.len() as u32 });
        }
        let mut open = vec![0_usize; nodes.len()];
        while let Some(index) = open.pop() {
            let Node { first, count, .. } = nodes[index];
            let mine = &mut order[first as usize..(first + count) as usize];
            let all = mine.iter().flat_map(|&t| corners(t));
            let (low, high) = all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
            (nodes[index].center, nodes[index].half) = ((low + high) / 2.0, (high - low) / 2.0);
            if mine.len() <= LEAF {
                continue;
            }
            let spread = mine.iter().map(|&t| middles[t as usize]);
            let (l, h) = spread.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
            let axis = (h - l).max_position();
            let half = mine.len() / 2;
            let along = |t: &u32| middles[*t as usize][axis];
            mine.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
            let child = nodes.len() as u32;
            (nodes[index].first, nodes[index].count) = (child, 0);
            let (half, blank) = (half as u32, DVec3::ZERO);
            nodes.push(Node { center: blank, half: blank, first, count: half });
            nodes.push(Node { center: blank, half: blank, first: first + half, count: count - half });
            open.extend([child as usize, child as usize + 1]);
        }
        Self { nodes, content: Content::Triangles(mesh.clone(), order), radius: 0.0 }
    }

    fn core(&self, piece: u32) -> Core {
        match &self.content {
            Content::One(core) => *core,
            Content::Triangles(mesh, order) => {
                let triangle = mesh.triangles[order[piece as usize] as usize];
                Core::Triangle(triangle.map(|i| mesh.vertices[i as usize]))
            }
        }
    }
}

/// Bounds of the distance of two shapes, the second at a pose in the first one's frame: see [`Wanted`]. Overlaps of single
/// pieces are told by how deep they are at most, as negative numbers; shells of triangles know no depth.
pub(crate) fn distance(a: &Pieces, b: &Pieces, a_from_b: &Pose, wanted: &Wanted, hint: &mut Hint) -> Bounds {
    let around = a.radius + b.radius;
    let place = parts(a_from_b);
    let mut descent = Descent {
        a,
        b,
        place,
        shadows: DMat3::from_cols(place.0.x_axis.abs(), place.0.y_axis.abs(), place.0.z_axis.abs()),
        wanted: Wanted { enough: wanted.enough + around, around, ..*wanted },
        found: Bounds { lower: f64::INFINITY, upper: f64::INFINITY },
        nearest: *hint,
    };
    descent.run();
    *hint = descent.nearest;
    let mut found = descent.found;
    if found.upper <= 0.0 {
        let single = matches!((&a.content, &b.content), (Content::One(_), Content::One(_)));
        let depth = if single { depth(&Piece::at_home(a.core(0)), &Piece::seen(b.core(0), &place)) } else { 0.0 };
        found = Bounds { lower: -depth, upper: -depth };
    }
    Bounds { lower: found.lower - around, upper: found.upper - around }
}

struct Descent<'d> {
    a: &'d Pieces,
    b: &'d Pieces,
    place: (DMat3, DVec3),
    /// Absolute values of the rotation.
    shadows: DMat3,
    wanted: Wanted,
    found: Bounds,
    nearest: Hint,
}

impl Descent<'_> {
    fn run(&mut self) {
        if self.a.nodes.is_empty() || self.b.nodes.is_empty() {
            return;
        }
        if let Some((a, b)) = self.nearest {
            let known = apart(&Piece::at_home(self.a.core(a)), &Piece::seen(self.b.core(b), &self.place), &self.wanted);
            self.found.upper = known.upper;
        }
        let mut open = vec![(0_u32, 0_u32, self.between(0, 0))];
        while let Some((one, other, bound)) = open.pop() {
            if self.is_far(bound) {
                self.found.lower = self.found.lower.min(bound);
                continue;
            }
            let (a, b) = (self.a.nodes[one as usize], self.b.nodes[other as usize]);
            if a.count > 0 && b.count > 0 {
                self.leaves(&a, &b);
                if self.found.upper <= 0.0 {
                    return;
                }
                continue;
            }
            let open_first = b.count > 0 || (a.count == 0 && a.half.max_element() >= b.half.max_element());
            let mut children = [0, 1].map(|i| match open_first {
                true => (a.first + i, other, 0.0),
                false => (one, b.first + i, 0.0),
            });
            children.iter_mut().for_each(|child| child.2 = self.between(child.0, child.1));
            // The nearer one is opened first.
            children.sort_unstable_by(|x, y| y.2.total_cmp(&x.2));
            open.extend(children);
        }
    }

    /// Whether what is this far need not be opened.
    fn is_far(&self, bound: f64) -> bool {
        let known = self.found.upper;
        bound >= self.wanted.enough || (known.is_finite() && bound >= known - self.wanted.slack(known))
    }

    fn leaves(&mut self, a: &Node, b: &Node) {
        for one in a.first..a.first + a.count {
            let piece = Piece::at_home(self.a.core(one));
            for other in b.first..b.first + b.count {
                // What is farther than what is known need not be measured exactly.
                let enough = self.wanted.enough.min(self.found.upper);
                let wanted = Wanted { enough, ..self.wanted };
                let found = apart(&piece, &Piece::seen(self.b.core(other), &self.place), &wanted);
                if found.upper < self.found.upper {
                    (self.found.upper, self.nearest) = (found.upper, Some((one, other)));
                }
                self.found.lower = self.found.lower.min(found.lower);
                if self.found.upper <= 0.0 {
                    return;
                }
            }
        }
    }

    /// A lower bound of the distance of two boxes.
    fn between(&self, one: u32, other: u32) -> f64 {
        let (a, b) = (&self.a.nodes[one as usize], &self.b.nodes[other as usize]);
        let way = self.place.0 * b.center + self.place.1 - a.center;
        let gap = (way.abs() - a.half - self.shadows * b.half).max(DVec3::ZERO).length();
        if self.is_far(gap) {
            return gap;
        }
        let back = self.place.0.transpose() * way;
        let gap_back = (back.abs() - b.half - self.shadows.transpose() * a.half).max(DVec3::ZERO).length();
        gap.max(gap_back)
    }
}

pub(crate) fn bounds(geometry: &Geometry) -> (DVec3, DVec3) {
    match geometry {
        Geometry::Sphere { radius } => (DVec3::ZERO, DVec3::splat(*radius)),
        Geometry::Box { half_extents } => (DVec3::ZERO, *half_extents),
        Geometry::Cylinder { radius, half_length } => (DVec3::ZERO, DVec3::new(*radius, *radius, *half_length)),
        Geometry::Capsule { radius, half_length } => {
            (DVec3::ZERO, DVec3::new(*radius, *radius, *half_length + *radius))
        }
        Geometry::Mesh(mesh) => {
            let low = mesh.vertices.iter().copied().reduce(DVec3::min).unwrap_or_default();
            let high = mesh.vertices.iter().copied().reduce(DVec3::max).unwrap_or_default();
            ((low + high) / 2.0, (high - low) / 2.0)
        }
    }
}
