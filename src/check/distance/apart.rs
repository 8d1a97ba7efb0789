//! How far two convex pieces are apart: bounds that hold whatever found them.
//!
//! For a unit direction n the pieces are at least `min over B of n · b − max over A of n · a` apart: both shadows along n
//! are known exactly. And they are at most as far apart as any point of the one from any point of the other. Directions
//! and points are searched by the nearest-point method (P. Wolfe, Finding the nearest point in a polytope, Mathematical
//! Programming 11, 1976) on the differences b − a; where it stalls, by E. G. Gilbert's step (An iterative procedure for
//! computing the minimum of a quadratic form on a convex set, SIAM J. Control 4, 1966), which cannot. The answer is right
//! however badly the search goes: a bad search only leaves the two bounds apart.

use super::convex::Piece;
use glam::DVec3;

/// Most directions of a search; some ten are usual.
const STEPS: usize = 160;

/// What is known of a distance, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// It is no less; negative where a shadow shows no gap.
    pub lower: f64,
    /// It is no more; 0 where the pieces overlap.
    pub upper: f64,
}

/// How exactly a distance is asked for: the search ends once the lower bound is `enough`, or the bounds are `open` plus
/// the share `share` of the distance apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    pub enough: f64,
    pub open: f64,
    pub share: f64,
    /// Radii around the pieces, metres: not part of the distance that shares are of.
    pub around: f64,
}

impl Wanted {
    fn met(&self, bounds: &Bounds) -> bool {
        bounds.lower >= self.enough || bounds.lower >= bounds.upper - self.slack(bounds.upper)
    }

    /// How far the lower bound may be below an upper one.
    pub(crate) fn slack(&self, upper: f64) -> f64 {
        self.open + self.share * (upper - self.around).max(0.0)
    }
}

/// Searches the distance of two pieces.
pub(crate) fn apart(a: &Piece, b: &Piece, wanted: &Wanted) -> Bounds {
    let difference = |along: DVec3| b.farthest(-along) - a.farthest(along);
    let start = b.middle() - a.middle();
    let first = difference(if start.length_squared() > 0.0 { start } else { DVec3::X });
    let mut known = Corral { points: [first; 4], shares: [1.0, 0.0, 0.0, 0.0], size: 1 };
    let mut bounds = Bounds { lower: f64::NEG_INFINITY, upper: first.length() };
    let mut nearest = first;
    for _ in 0..STEPS {
        let length = nearest.length();
        // So near that the rounding of the points decides: an overlap.
        let touching = length <= 1e-14;
        if touching {
            return Bounds { lower: bounds.lower.min(0.0), upper: 0.0 };
        }
        let along = nearest / length;
        let reached = difference(along);
        bounds.lower = bounds.lower.max(along.dot(reached));
        bounds.upper = bounds.upper.min(length);
        if wanted.met(&bounds) {
            return bounds;
        }
        let next = known.join(reached).filter(|next| next.length() < length * (1.0 - 1e-16));
        nearest = match next {
            Some(next) => next,
            None => match between(nearest, reached).filter(|next| next.length() < length) {
                Some(next) => {
                    known = Corral { points: [next; 4], shares: [1.0, 0.0, 0.0, 0.0], size: 1 };
                    next
                }
                // Nothing is nearer: the direction is as good as its rounding.
                None => return bounds,
            },
        };
        if known.size == 4 {
            return Bounds { lower: bounds.lower.min(0.0), upper: 0.0 };
        }
    }
    bounds
}

/// An upper bound of how deep two pieces that overlap are in each other: the shallowest overlap of their shadows along
/// the directions of their faces and from middle to middle.
pub(crate) fn depth(a: &Piece, b: &Piece) -> f64 {
    let faces = a.faces().into_iter().chain(b.faces()).chain([b.middle() - a.middle()]);
    let overlap = |n: DVec3| n.dot(a.farthest(n)) - n.dot(b.farthest(-n));
    let normals = faces.filter_map(DVec3::try_normalize).flat_map(|n| [n, -n]);
    normals.map(overlap).fold(f64::INFINITY, f64::min).max(0.0)
}

/// The point nearest to the origin between two points.
fn between(from: DVec3, to: DVec3) -> Option<DVec3> {
    let way = to - from;
    let square = way.length_squared();
    (square > 0.0).then(|| from + way * (-from.dot(way) / square).clamp(0.0, 1.0))
}

/// Up to four differences, and the shares with which they make the nearest point of their hull.
struct Corral {
    points: [DVec3; 4],
    shares: [f64; 4],
    size: usize,
}

impl Corral {
    fn nearest(&self) -> DVec3 {
        self.points.iter().zip(self.shares).take(self.size).map(|(p, share)| *p * share).sum()
    }

    /// Takes a point in, and answers with the nearest point of the hull; none where the points are too flat to tell.
    fn join(&mut self, point: DVec3) -> Option<DVec3> {
        if self.size == 4 || self.points[..self.size].contains(&point) {
            return None;
        }
        self.points[self.size] = point;
        self.shares[self.size] = 0.0;
        self.size += 1;
        // Each round leaves a point out.
        for _ in 0..4 {
            let affine = self.affine()?;
            if affine[..self.size].iter().all(|&share| share > 0.0) {
                self.shares = affine;
                return Some(self.nearest());
            }
            self.walk(&affine);
        }
        None
    }

    /// Goes from the shares towards others until one is used up, and leaves out what is.
    fn walk(&mut self, affine: &[f64; 4]) {
        let limit = |i: usize| {
            let (old, new) = (self.shares[i], affine[i]);
            if new > 0.0 { 1.0 } else { old / (old - new).max(f64::MIN_POSITIVE) }
        };
        let used_up = (0..self.size).min_by(|&i, &j| limit(i).total_cmp(&limit(j)));
        let step = used_up.map_or(0.0, limit).clamp(0.0, 1.0);
        for (share, wanted) in self.shares.iter_mut().zip(affine).take(self.size) {
            *share += step * (wanted - *share);
        }
        let mut kept = 0;
        for i in 0..self.size {
            if Some(i) != used_up && self.shares[i] >= 0.0 {
                (self.points[kept], self.shares[kept]) = (self.points[i], self.shares[i]);
                kept += 1;
            }
        }
        self.size = kept.max(1);
        let sum: f64 = self.shares[..self.size].iter().sum();
        match sum > 0.0 {
            true => self.shares[..self.size].iter_mut().for_each(|share| *share /= sum),
            false => self.shares[0] = 1.0,
        }
    }

    /// Shares of the point nearest to the origin in the plane (line, space) through the points.
    fn affine(&self) -> Option<[f64; 4]> {
        let [a, b, c, d] = self.points;
        let shares = match self.size {
            1 => [1.0, 0.0, 0.0, 0.0],
            2 => {
                let way = b - a;
                let to_b = -a.dot(way) / way.length_squared();
                [1.0 - to_b, to_b, 0.0, 0.0]
            }
            3 => {
                let normal = (b - a).cross(c - a);
                let square = normal.length_squared();
                let of = |p: DVec3, q: DVec3| normal.dot(p.cross(q)) / square;
                [of(b, c), of(c, a), of(a, b), 0.0]
            }
            _ => {
                let volume = |p: DVec3, q: DVec3, r: DVec3| p.dot(q.cross(r));
                let whole = volume(b - a, c - a, d - a);
                let parts = [volume(b, c, d), -volume(a, c, d), volume(a, b, d), -volume(a, b, c)];
                parts.map(|part| part / whole)
            }
        };
        let sum: f64 = shares.iter().sum();
        // Written so that NaN is none. Points that are nearly on a line or plane give shares that do not add up.
        let sound = (sum - 1.0).abs() < 1e-6;
        sound.then(|| shares.map(|share| share / sum))
    }
}
