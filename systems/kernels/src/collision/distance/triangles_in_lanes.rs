//! Eight triangles of a mesh at once: how far they are from a triangle or a segment.
//!
//! The closest points of their features give a vector from one to the other, and that the gap between the two along it:
//! a certified lower bound, whatever went wrong on the way. Where the two meet there is no gap; that is for GJK to
//! decide. Products and sums are not fused, so that the answers are equal bit for bit at every level of lanes.

use crate::collision::convex::gjk::{ROUNDING, Relative};
use crate::collision::distance::boxes_in_lanes::{combined, dot};
use crate::collision::solids::boxes::{Bounds, Corners};
use crate::lanes::{F64Row, Isa, Lanes, Mask, Vector3};
use glam::DVec3;

/// Edges whose sines square to less count as parallel; the gap tells whether that was wrong.
const PARALLEL: f64 = 1e-12;

/// What keeps eight triangles from something.
pub(crate) struct Gaps {
    /// Unit vectors from the triangles to it; not numbers where they meet.
    n: [F64Row; 3],
    /// Certified lower bounds of the distances, metres.
    pub lower: F64Row,
    /// Lengths of vectors between two of their points, metres.
    pub upper: F64Row,
}

impl Gaps {
    /// The direction of one lane.
    pub(crate) fn direction(&self, lane: usize) -> DVec3 {
        DVec3::new(self.n[0][lane], self.n[1][lane], self.n[2][lane])
    }

    /// The one of `lanes` with the smallest lower bound; of several the first.
    pub(crate) fn tightest(&self, lanes: u32) -> usize {
        let mut tightest = lanes.trailing_zeros() as usize;
        for lane in tightest + 1..8 {
            if lanes >> lane & 1 == 1 && self.lower[lane] < self.lower[tightest] {
                tightest = lane;
            }
        }
        tightest
    }
}

/// Eight triangles, and of each what does not depend on the other side.
pub(crate) struct LaneTriangles<V> {
    corners: [Vector3<V>; 3],
    edges: [Edge<V>; 3],
    face: Face<V>,
}

/// From a corner to the next.
#[derive(Clone, Copy)]
struct Edge<V> {
    from: Vector3<V>,
    along: Vector3<V>,
    squared: V,
    inverse: V,
}

/// The plane of a triangle, and the planes through its edges that stand on it.
#[derive(Clone, Copy)]
struct Face<V> {
    normal: Vector3<V>,
    inverse: V,
    /// Inwards.
    sides: [Vector3<V>; 3],
    corners: [Vector3<V>; 3],
}

/// The shortest vector so far.
struct Shortest<V> {
    v: Vector3<V>,
    squared: V,
}

impl<V: Lanes> Shortest<V> {
    #[inline(always)]
    fn none(isa: V::Isa) -> Self {
        let far = V::constant(isa, f64::INFINITY);
        Self { v: Vector3::new(far, far, far), squared: far }
    }

    #[inline(always)]
    fn or(&mut self, v: Vector3<V>, squared: V) {
        let shorter = squared.lt(self.squared);
        self.v = Vector3::select(shorter, v, self.v);
        self.squared = V::select(shorter, squared, self.squared);
    }
}

impl<V: Lanes> Edge<V> {
    #[inline(always)]
    fn new(isa: V::Isa, from: Vector3<V>, to: Vector3<V>) -> Self {
        let along = to.minus(from);
        let squared = dot(along, along);
        // An edge of no length is a point: what is divided by its length is zero then.
        let inverse = V::constant(isa, 1.0) / squared.max(V::constant(isa, f64::MIN_POSITIVE));
        Self { from, along, squared, inverse }
    }
}

impl<V: Lanes> Face<V> {
    #[inline(always)]
    fn new(isa: V::Isa, corners: [Vector3<V>; 3], edges: &[Edge<V>; 3]) -> Self {
        let normal = cross(edges[0].along, edges[1].along);
        let inverse = V::constant(isa, 1.0) / dot(normal, normal);
        let sides = [cross(normal, edges[0].along), cross(normal, edges[1].along), cross(normal, edges[2].along)];
        Self { normal, inverse, sides, corners }
    }

    /// The vector to a point that lies over the triangle.
    #[inline(always)]
    fn to(&self, point: Vector3<V>, sign: V, shortest: &mut Shortest<V>) {
        let from = [point.minus(self.corners[0]), point.minus(self.corners[1]), point.minus(self.corners[2])];
        let zero = V::constant(sign.isa(), 0.0);
        let inside = zero.le(dot(self.sides[0], from[0]))
            & zero.le(dot(self.sides[1], from[1]))
            & zero.le(dot(self.sides[2], from[2]));
        let height = dot(self.normal, from[0]);
        let scale = height * self.inverse;
        let squared = V::select(inside, height * scale, V::constant(sign.isa(), f64::INFINITY));
        shortest.or(self.normal.scaled(scale * sign), squared);
    }
}

impl<V: Lanes> LaneTriangles<V> {
    #[inline(always)]
    fn new(isa: V::Isa, corners: [Vector3<V>; 3]) -> Self {
        let [a, b, c] = corners;
        let edges = [Edge::new(isa, a, b), Edge::new(isa, b, c), Edge::new(isa, c, a)];
        Self { corners, edges, face: Face::new(isa, corners, &edges) }
    }

    /// The same triangle in every lane.
    #[inline(always)]
    fn splat(isa: V::Isa, [a, b, c]: &[DVec3; 3]) -> Self {
        Self::new(isa, [Vector3::splat(isa, *a), Vector3::splat(isa, *b), Vector3::splat(isa, *c)])
    }

    #[inline(always)]
    fn least_along(&self, n: Vector3<V>) -> V {
        dot(n, self.corners[0]).min(dot(n, self.corners[1])).min(dot(n, self.corners[2]))
    }

    #[inline(always)]
    fn most_along(&self, n: Vector3<V>) -> V {
        dot(n, self.corners[0]).max(dot(n, self.corners[1])).max(dot(n, self.corners[2]))
    }
}

/// Along the axes, the least and the largest coordinates of eight triangles.
pub(crate) struct Extents<V> {
    low: Vector3<V>,
    high: Vector3<V>,
}

impl<V: Lanes> Extents<V> {
    #[inline(always)]
    pub(crate) fn of(eight: &LaneTriangles<V>) -> Self {
        let [a, b, c] = eight.corners;
        let least = |p: Vector3<V>, q: Vector3<V>| Vector3::new(p.x.min(q.x), p.y.min(q.y), p.z.min(q.z));
        let most = |p: Vector3<V>, q: Vector3<V>| Vector3::new(p.x.max(q.x), p.y.max(q.y), p.z.max(q.z));
        Self { low: least(least(a, b), c), high: most(most(a, b), c) }
    }
}

/// The triangles that are not `least` away from a box.
#[inline(always)]
pub(crate) fn beside<I: Isa>(isa: I, extents: &Extents<I::F64>, bounds: &Bounds, least: f64) -> u32 {
    if least <= 0.0 {
        return u32::MAX;
    }
    let zero = I::F64::constant(isa, 0.0);
    let (low, high) = (bounds.center - bounds.half, bounds.center + bounds.half);
    let above = extents.low.minus(Vector3::splat(isa, high));
    let below = Vector3::<I::F64>::splat(isa, low).minus(extents.high);
    let gap =
        Vector3::new(above.x.max(below.x).max(zero), above.y.max(below.y).max(zero), above.z.max(below.z).max(zero));
    // Compared so that NaN is near.
    !I::F64::constant(isa, least * least).le(dot(gap, gap)).bits()
}

/// Eight triangles as they are.
#[inline(always)]
pub(crate) fn load<I: Isa>(isa: I, corners: &Corners) -> LaneTriangles<I::F64> {
    let corner = |c: usize| Vector3::load(isa, &corners[c]);
    LaneTriangles::new(isa, [corner(0), corner(1), corner(2)])
}

/// Eight triangles, moved by X.
#[inline(always)]
pub(crate) fn load_moved<I: Isa>(isa: I, corners: &Corners, X: &Relative) -> LaneTriangles<I::F64> {
    let at = Vector3::splat(isa, X.translation);
    let a = combined(isa, &X.rotation, Vector3::load(isa, &corners[0])).plus(at);
    let b = combined(isa, &X.rotation, Vector3::load(isa, &corners[1])).plus(at);
    let c = combined(isa, &X.rotation, Vector3::load(isa, &corners[2])).plus(at);
    LaneTriangles::new(isa, [a, b, c])
}

/// The triangles that are not set `least` apart along `n`, which points from them to the points at least `start` along it.
#[inline(always)]
pub(crate) fn reaching<I: Isa>(isa: I, eight: &LaneTriangles<I::F64>, n: DVec3, start: f64, least: f64) -> u32 {
    let end = eight.most_along(Vector3::splat(isa, n));
    // Compared so that NaN reaches.
    !end.le(I::F64::constant(isa, start - least)).bits()
}

/// The triangles that neither their own planes nor that of another triangle set `least` apart from it: most of those that
/// lie along a surface are, for a tenth of what a distance costs.
#[inline(always)]
pub(crate) fn crossing<I: Isa>(isa: I, eight: &LaneTriangles<I::F64>, one: &[DVec3; 3], least: f64) -> u32 {
    let least = least + ROUNDING;
    // Compared so that triangles without a normal cross.
    let normal = (one[1] - one[0]).cross(one[2] - one[0]);
    let (n, start) = (Vector3::splat(isa, normal), I::F64::constant(isa, normal.dot(one[0])));
    let needed = I::F64::constant(isa, least * normal.length());
    let above = needed.lt(eight.least_along(n) - start) | needed.lt(start - eight.most_along(n));
    let n = eight.face.normal;
    let start = dot(n, eight.corners[0]);
    let [a, b, c] = one;
    let (a, b, c) = (dot(n, Vector3::splat(isa, *a)), dot(n, Vector3::splat(isa, *b)), dot(n, Vector3::splat(isa, *c)));
    let needed = dot(n, n).sqrt() * least;
    let beside = needed.lt(a.min(b).min(c) - start) | needed.lt(start - a.max(b).max(c));
    !(above | beside).bits()
}

/// How far the triangles are from another one.
#[inline(always)]
pub(crate) fn to_triangle<I: Isa>(isa: I, eight: &LaneTriangles<I::F64>, triangle: &[DVec3; 3]) -> Gaps {
    let one = LaneTriangles::<I::F64>::splat(isa, triangle);
    let (plus, minus) = (I::F64::constant(isa, 1.0), I::F64::constant(isa, -1.0));
    let mut shortest = Shortest::none(isa);
    for first in &one.edges {
        for second in &eight.edges {
            between(isa, first, second, &mut shortest);
        }
    }
    for corner in one.corners {
        eight.face.to(corner, plus, &mut shortest);
    }
    for corner in eight.corners {
        one.face.to(corner, minus, &mut shortest);
    }
    let upper = shortest.squared.sqrt();
    let n = shortest.v.scaled(plus / upper);
    gaps(isa, n, one.least_along(n) - eight.most_along(n), upper)
}

/// How far the triangles are from a segment from `middle` − `half` to `middle` + `half`.
#[inline(always)]
pub(crate) fn to_segment<I: Isa>(isa: I, eight: &LaneTriangles<I::F64>, middle: DVec3, half: DVec3) -> Gaps {
    let (low, high) = (Vector3::splat(isa, middle - half), Vector3::splat(isa, middle + half));
    let segment = Edge::new(isa, low, high);
    let one = I::F64::constant(isa, 1.0);
    let mut shortest = Shortest::none(isa);
    for edge in &eight.edges {
        between(isa, &segment, edge, &mut shortest);
    }
    eight.face.to(low, one, &mut shortest);
    eight.face.to(high, one, &mut shortest);
    let upper = shortest.squared.sqrt();
    let n = shortest.v.scaled(one / upper);
    gaps(isa, n, dot(n, low).min(dot(n, high)) - eight.most_along(n), upper)
}

#[inline(always)]
fn gaps<I: Isa>(isa: I, n: Vector3<I::F64>, gap: I::F64, upper: I::F64) -> Gaps {
    let mut gaps = Gaps { n: [F64Row::default(); 3], lower: F64Row::default(), upper: F64Row::default() };
    n.store(&mut gaps.n);
    (gap - I::F64::constant(isa, ROUNDING)).store(&mut gaps.lower);
    upper.store(&mut gaps.upper);
    gaps
}

/// The vector between the closest points of two edges, from the second to the first (Ericson, Real-Time Collision
/// Detection, §5.1.9).
#[inline(always)]
fn between<I: Isa>(isa: I, a: &Edge<I::F64>, b: &Edge<I::F64>, shortest: &mut Shortest<I::F64>) {
    let (zero, one) = (I::F64::constant(isa, 0.0), I::F64::constant(isa, 1.0));
    let r = a.from.minus(b.from);
    let (uv, ur, vr) = (dot(a.along, b.along), dot(a.along, r), dot(b.along, r));
    let squares = a.squared * b.squared;
    let determinant = squares - uv * uv;
    let s = ((uv * vr - ur * b.squared) / determinant).max(zero).min(one);
    let s = I::F64::select((squares * PARALLEL).lt(determinant), s, zero);
    let t = ((uv * s + vr) * b.inverse).max(zero).min(one);
    let s = ((uv * t - ur) * a.inverse).max(zero).min(one);
    let v = r.plus(a.along.scaled(s)).minus(b.along.scaled(t));
    shortest.or(v, dot(v, v));
}

/// Vector product, not fused.
#[inline(always)]
fn cross<V: Lanes>(a: Vector3<V>, b: Vector3<V>) -> Vector3<V> {
    Vector3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}
