//! The convex hull of a mesh, approximated by few points and a slack.
//!
//! A distance of hulls (`distance/hull_distance.rs`) is never more than the distance of what is in them, and costs little: two
//! links of a robot that are neighbours of neighbours are as a rule separated by a plane. To find one takes a dozen supports; to
//! prove the same by the triangles takes hundreds of boxes.

use crate::collision::convex::simplex::{Closest, Simplex};
use crate::lanes::geometry::Vector3;
use crate::lanes::level::{Kernel, Level};
use crate::lanes::vector::{F64Row, Isa, Lanes, Row};
use glam::DVec3;

/// Few points, and how far beyond their convex hull a mesh reaches at most.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hull {
    /// Vertices of the mesh; none where it has no triangles or numbers that are not finite.
    pub points: Vec<DVec3>,
    /// The same in lanes, the last filled up with the first point.
    rows: Vec<[F64Row; 3]>,
    /// Metres.
    pub slack: f64,
    /// Somewhere in the middle of the points.
    pub middle: DVec3,
    /// How supports are computed, not what they are: they are equal bit for bit at every level.
    pub lanes: Level,
}

/// With more points every direction would cost more than closer hulls save.
pub(crate) const MOST_POINTS: usize = 128;
/// Vertices that are farther than this share of the mesh's size beyond the hull become points of it.
const FAR: f64 = 0.003;
/// Rounding of coordinates up to some tens of metres, with room to spare; metres.
const ROUNDING: f64 = 1e-9;

/// Which vertices make a hull, and what shows that it is one.
#[derive(Debug, Default)]
pub(crate) struct FoundHull {
    /// Numbers of vertices.
    pub points: Vec<u32>,
    /// For each vertex the points, as places in `points`, that it was seen to be close to.
    pub near: Vec<[u8; 4]>,
    /// Metres.
    pub slack: f64,
}

impl FoundHull {
    /// Of `vertices`, beginning with those of the numbers `extreme`.
    pub(crate) fn of(vertices: &[DVec3], extreme: Vec<u32>) -> Self {
        let mut found = Self::default();
        let mut hull = Hull { lanes: Level::detected(), ..Hull::default() };
        for number in extreme {
            let point = vertices[number as usize];
            if !hull.points.contains(&point) {
                hull.add(point);
                found.points.push(number);
            }
        }
        if hull.points.is_empty() || !vertices.iter().all(|v| v.is_finite()) {
            return Self::default();
        }
        let size = hull.points.iter().map(|p| p.distance(hull.points[0])).fold(0.0, f64::max);
        let (mut slack, mut met): (f64, _) = (0.0, Met::default());
        found.near.reserve(vertices.len());
        for (number, &vertex) in vertices.iter().enumerate() {
            let (far, near) = hull.beyond(vertex, slack, &mut met);
            if far > FAR * size && hull.points.len() < MOST_POINTS {
                found.near.push([hull.points.len() as u8; 4]);
                hull.add(vertex);
                found.points.push(number as u32);
            } else {
                slack = slack.max(far);
                found.near.push(near);
            }
        }
        found.slack = slack + ROUNDING;
        found
    }
}

/// Whether every vertex is within `slack` of the convex hull of `points`, as what it is said to be `near` shows.
pub(crate) fn is_around(points: &[DVec3], vertices: &[DVec3], near: &[[u8; 4]], slack: f64) -> bool {
    if vertices.len() != near.len() || !(slack.is_finite() && slack >= ROUNDING) {
        return false;
    }
    // Half of the rounding may have been used up when the slack was found, half of it here.
    let most = slack - 0.5 * ROUNDING;
    vertices.iter().zip(near).all(|(&vertex, near)| {
        // False also for what is no number.
        distance_from_few(points, vertex, near).is_some_and(|distance| distance <= most)
    })
}

/// How far a vertex is from the convex hull of the points at some places; none where a place does not exist.
fn distance_from_few(points: &[DVec3], vertex: DVec3, places: &[u8; 4]) -> Option<f64> {
    let at = |place: u8| points.get(usize::from(place)).map(|&p| p - vertex);
    let mut simplex = Simplex::of(at(places[0])?);
    for &place in &places[1..] {
        simplex.add(at(place)?);
    }
    match simplex.reduce() {
        Closest::Outside(point) => Some(point.length()),
        Closest::Inside => Some(0.0),
    }
}

impl Hull {
    /// Of points that are known to be around something but for the slack; nothing where there are none.
    pub(crate) fn of(points: Vec<DVec3>, slack: f64) -> Self {
        if points.is_empty() {
            return Self::default();
        }
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        let rows = in_rows(&points);
        Self { points, rows, slack, middle, lanes: Level::detected() }
    }

    fn add(&mut self, point: DVec3) {
        self.points.push(point);
        let last = self.points.len() - 1;
        let begun = &self.points[last - last % 8..];
        let row = in_rows(begun);
        self.rows.truncate(last / 8);
        self.rows.extend(row);
    }

    /// At least the distance of `vertex` from the convex hull of the points, nearly that where it is more than `enough`; and the places
    /// of the points to which it was found to be that close, the last repeated where they are fewer than four.
    fn beyond(&self, vertex: DVec3, enough: f64, met: &mut Met) -> (f64, [u8; 4]) {
        let mut closest = self.points[0] - vertex;
        let mut simplex = Simplex::of(closest);
        met.0.clear();
        met.0.push((closest, 0));
        // Whatever the search does, `closest` is a point of the hull, seen from the vertex.
        for _ in 0..32 {
            let length = closest.length();
            let place = self.lanes.run(Farthest { rows: &self.rows, d: -closest });
            let w = self.points.get(place).copied().unwrap_or(DVec3::NAN) - vertex;
            if length <= enough || length * length - closest.dot(w) <= 1e-3 * length * length || !simplex.add(w) {
                break;
            }
            met.0.push((w, place as u8));
            match simplex.reduce() {
                Closest::Outside(point) => closest = point,
                Closest::Inside => return (0.0, met.places(&simplex)),
            }
        }
        (closest.length(), met.places(&simplex))
    }
}

/// The points that a search has met, relative to its query point, and their places.
#[derive(Default)]
struct Met(Vec<(DVec3, u8)>);

impl Met {
    /// Where the points of a simplex are.
    fn places(&self, simplex: &Simplex) -> [u8; 4] {
        let points = simplex.points();
        let place = |point: &DVec3| self.0.iter().find(|(p, _)| p == point).map_or(0, |&(_, place)| place);
        std::array::from_fn(|i| points.get(i).or(points.last()).map_or(0, place))
    }
}

impl Hull {
    /// A point that lies farthest in direction `d`, of several the first.
    #[inline]
    pub(crate) fn support(&self, d: DVec3) -> DVec3 {
        let best = self.lanes.run(Farthest { rows: &self.rows, d });
        self.points.get(best).copied().unwrap_or(DVec3::NAN)
    }
}

fn in_rows(points: &[DVec3]) -> Vec<[F64Row; 3]> {
    let row = |points: &[DVec3]| {
        let coordinate = |axis: usize| Row(std::array::from_fn(|lane| points.get(lane).unwrap_or(&points[0])[axis]));
        [coordinate(0), coordinate(1), coordinate(2)]
    };
    points.chunks(8).map(row).collect()
}

/// Number of the point that lies farthest in a direction; of several the first.
struct Farthest<'a> {
    rows: &'a [[F64Row; 3]],
    d: DVec3,
}

impl Kernel for Farthest<'_> {
    type Output = usize;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> usize {
        let d = Vector3::<I::F64>::splat(isa, self.d);
        let mut best = I::F64::constant(isa, f64::NEG_INFINITY);
        let mut number = I::F64::constant(isa, 0.0);
        for place in 0..self.rows.len() {
            let p = Vector3::<I::F64>::load(isa, &self.rows[place]);
            // Products and sums as one at a time has them, not fused.
            let along = d.x * p.x + d.y * p.y + d.z * p.z;
            let farther = best.lt(along);
            best = I::F64::select(farther, along, best);
            number = I::F64::select(farther, I::F64::constant(isa, place as f64), number);
        }
        let most = best.most();
        if most == f64::NEG_INFINITY {
            // Not a number in any lane.
            return usize::MAX;
        }
        let (mut rows, mut values) = (F64Row::default(), F64Row::default());
        number.store(&mut rows);
        best.store(&mut values);
        let mut found = usize::MAX;
        for lane in 0..8 {
            if values.0[lane] == most {
                found = found.min(8 * rows.0[lane] as usize + lane);
            }
        }
        found
    }
}
