//! Faces that a document cuts into pieces: polygons of one surface that adjoin in one plane become one polygon where that is convex.
//!
//! Objects that must not tip over are judged by one polygon of their own and one of the support. Of a square that is cut into two
//! triangles neither has the centre of mass in its middle, and no object would rest there.

use foliate_components::robot::Surface;
use glam::{DVec2, DVec3};

/// Corners that are closer, and polygons whose planes or edges are, count as one, metres.
const CLOSE: f64 = 1e-5;
/// Corners that are less beside the line between their neighbours are on it, metres.
const STRAIGHT: f64 = 1e-6;
/// Surfaces of more polygons stay as they are.
const MOST: usize = 1000;

/// A piece of a face: its corners as numbers of the surface's points, counter-clockwise seen from outside.
struct Piece {
    corners: Vec<u32>,
    at: Vec<DVec3>,
    normal: DVec3,
    area: f64,
}

/// Joins the pieces of a surface's faces: two by two as long as their union is convex, then those that are left and touch one another
/// all at once, as of a fan around a point in the middle.
pub(in crate::scene::assemble) fn join(surface: &mut Surface) {
    if surface.polygons.len() < 2 || surface.polygons.len() > MOST {
        return;
    }
    let points = &surface.points;
    let pieces: Option<Vec<_>> = surface.polygons.iter().map(|corners| Piece::new(points, corners.clone())).collect();
    let Some(mut pieces) = pieces else { return };
    let before = pieces.len();
    join_pairs(points, &mut pieces);
    join_islands(points, &mut pieces);
    if pieces.len() < before {
        surface.polygons = pieces.into_iter().map(|piece| piece.corners).collect();
    }
}

fn join_pairs(points: &[DVec3], pieces: &mut Vec<Piece>) {
    // What has grown may fit to what it did not before. So passes follow one another until one joins nothing.
    loop {
        let before = pieces.len();
        let mut first = 0;
        while first + 1 < pieces.len() {
            let union = |other: usize| {
                let pair = [&pieces[first], &pieces[other]];
                let whole = pair[0].touches(pair[1]).then(|| union(points, &pair)).flatten()?;
                Some((other, whole))
            };
            match (first + 1..pieces.len()).find_map(union) {
                Some((other, whole)) => {
                    pieces[first] = whole;
                    pieces.remove(other);
                }
                None => first += 1,
            }
        }
        if pieces.len() == before {
            return;
        }
    }
}

fn join_islands(points: &[DVec3], pieces: &mut Vec<Piece>) {
    let mut first = 0;
    while first < pieces.len() {
        let mut island = vec![first];
        let mut reached = 0;
        while reached < island.len() {
            let near = |other: &usize| !island.contains(other) && pieces[island[reached]].touches(&pieces[*other]);
            let found: Vec<_> = (first + 1..pieces.len()).filter(near).collect();
            island.extend(found);
            reached += 1;
        }
        let parts: Vec<_> = island.iter().map(|&index| &pieces[index]).collect();
        if let Some(whole) = (parts.len() > 2).then(|| union(points, &parts)).flatten() {
            pieces[first] = whole;
            let mut index = 0;
            pieces.retain(|_| {
                index += 1;
                index - 1 == first || !island.contains(&(index - 1))
            });
        }
        first += 1;
    }
}

impl Piece {
    /// None where it has no area.
    fn new(points: &[DVec3], corners: Vec<u32>) -> Option<Self> {
        let at: Vec<_> = corners.iter().filter_map(|&corner| points.get(corner as usize).copied()).collect();
        let from = *at.first()?;
        let across: DVec3 = at.windows(2).map(|side| (side[0] - from).cross(side[1] - from)).sum();
        Some(Self { normal: across.try_normalize()?, area: across.length() / 2.0, corners, at })
    }

    fn is_in_plane_of(&self, other: &Self) -> bool {
        self.normal.dot(other.normal) > 0.999
            && self.at.iter().all(|p| other.normal.dot(*p - other.at[0]).abs() < CLOSE)
    }

    /// How far a point of its plane is beyond each of its edges.
    fn beyond(&self, point: DVec3) -> impl Iterator<Item = f64> + '_ {
        let edges = self.at.iter().zip(self.at.iter().cycle().skip(1));
        edges.map(move |(a, b)| (*b - *a).cross(self.normal).normalize_or_zero().dot(point - *a))
    }

    /// Whether a corner of one is on the other.
    fn touches(&self, other: &Self) -> bool {
        let on = |piece: &Self, corners: &Self| {
            corners.at.iter().any(|corner| piece.beyond(*corner).all(|beyond| beyond < CLOSE))
        };
        self.is_in_plane_of(other) && (on(self, other) || on(other, self))
    }

    /// Whether an edge of one has all of the other beyond it.
    fn is_beside(&self, other: &Self) -> bool {
        let separates = |piece: &Self, others: &Self| {
            let beyond: Vec<Vec<f64>> = others.at.iter().map(|corner| piece.beyond(*corner).collect()).collect();
            (0..piece.at.len()).any(|edge| beyond.iter().all(|of_corner| of_corner[edge] > -CLOSE))
        };
        separates(self, other) || separates(other, self)
    }
}

/// The union of pieces that do not overlap; none where it is not convex: where their hull is larger than they are.
fn union(points: &[DVec3], pieces: &[&Piece]) -> Option<Piece> {
    let first = pieces[0];
    if !pieces[1..].iter().all(|piece| piece.is_in_plane_of(first)) {
        return None;
    }
    let apart = |(index, piece): (usize, &&Piece)| pieces[..index].iter().all(|other| piece.is_beside(other));
    if !pieces.iter().enumerate().all(apart) {
        return None;
    }
    let whole = Piece::new(points, hull(points, pieces)?)?;
    let around: f64 = whole.at.iter().zip(whole.at.iter().cycle().skip(1)).map(|(a, b)| a.distance(*b)).sum();
    let parts: f64 = pieces.iter().map(|piece| piece.area).sum();
    ((whole.area - parts).abs() < CLOSE * around).then_some(whole)
}

/// The convex hull of all corners, without those that lie on a side (Andrew's monotone chain).
fn hull(points: &[DVec3], pieces: &[&Piece]) -> Option<Vec<u32>> {
    let normal = pieces[0].normal;
    let (x, y) = normal.any_orthonormal_pair();
    let flat = |corner: u32| points.get(corner as usize).map(|p| DVec2::new(p.dot(x), p.dot(y)));
    let corners = pieces.iter().flat_map(|piece| &piece.corners);
    let mut corners: Vec<(DVec2, u32)> = corners.filter_map(|&corner| Some((flat(corner)?, corner))).collect();
    corners.sort_by(|(a, i), (b, j)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(i.cmp(j)));
    let mut chain = half(corners.iter());
    let back = half(corners.iter().rev());
    chain.pop();
    chain.extend(&back[..back.len() - 1]);
    without_straight(&mut chain);
    // Frames of polygons follow their first corner: the one that is told best.
    let size = |corner: usize| {
        let [a, b, c] = [0, 1, 2].map(|step| chain[(corner + step) % chain.len()].0);
        (b - a).perp_dot(c - b)
    };
    let best = (0..chain.len()).reduce(|best, corner| if size(corner) > size(best) { corner } else { best })?;
    chain.rotate_left(best);
    (chain.len() >= 3).then(|| chain.into_iter().map(|(_, corner)| corner).collect())
}

fn half<'c>(corners: impl Iterator<Item = &'c (DVec2, u32)>) -> Vec<(DVec2, u32)> {
    let mut chain: Vec<(DVec2, u32)> = Vec::new();
    for &(point, corner) in corners {
        while let [.., (a, _), (b, _)] = chain[..]
            && (b - a).perp_dot(point - b) <= 0.0
        {
            chain.pop();
        }
        chain.push((point, corner));
    }
    chain
}

/// Takes out corners that lie on the line between their neighbours, one by one.
fn without_straight(chain: &mut Vec<(DVec2, u32)>) {
    let mut corner = 0;
    while corner < chain.len() && chain.len() > 3 {
        let count = chain.len();
        let [before, at, after] = [count - 1, 0, 1].map(|step| chain[(corner + step) % count].0);
        let side = (after - before).normalize_or_zero();
        if side.perp_dot(at - before).abs() < STRAIGHT {
            chain.remove(corner);
            corner = 0;
        } else {
            corner += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::robot::LinkIndex;

    fn surface(points: &[(f64, f64)], polygons: &[&[u32]]) -> Surface {
        Surface {
            name: "table/top".into(),
            link: LinkIndex(0),
            points: points.iter().map(|&(x, y)| DVec3::new(x, y, 0.7)).collect(),
            polygons: polygons.iter().map(|polygon| polygon.to_vec()).collect(),
        }
    }

    fn joined(points: &[(f64, f64)], polygons: &[&[u32]]) -> Vec<Vec<u32>> {
        let mut surface = surface(points, polygons);
        join(&mut surface);
        surface.polygons
    }

    const SQUARE: [(f64, f64); 4] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];

    #[test]
    fn two_triangles_are_a_square_with_the_same_side_up() {
        let whole = joined(&SQUARE, &[&[0, 1, 2], &[0, 2, 3]]);
        assert_eq!(whole.len(), 1);
        let at = |k: usize| DVec3::new(SQUARE[whole[0][k] as usize].0, SQUARE[whole[0][k] as usize].1, 0.0);
        assert_eq!(whole[0].len(), 4);
        assert!((at(1) - at(0)).cross(at(2) - at(1)).z > 0.0);
    }

    #[test]
    fn corners_in_the_middle_of_a_side_go() {
        // A grid of four squares, each with points of its own.
        let mut points = Vec::new();
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            points.extend(SQUARE.map(|(u, v)| (x + u, y + v)));
        }
        let whole = joined(&points, &[&[0, 1, 2, 3], &[4, 5, 6, 7], &[8, 9, 10, 11], &[12, 13, 14, 15]]);
        assert_eq!(whole.len(), 1, "{whole:?}");
        assert_eq!(whole[0].len(), 4, "{whole:?}");
    }

    #[test]
    fn a_fan_about_the_middle_is_joined_though_no_half_of_it_is_convex() {
        let corner = |k: i32| (f64::from(k) * std::f64::consts::TAU / 5.0).sin_cos();
        let mut points: Vec<_> = (0..5).map(|k| (corner(k).1, corner(k).0)).collect();
        points.push((0.0, 0.0));
        let fan: [&[u32]; 5] = [&[5, 0, 1], &[5, 1, 2], &[5, 2, 3], &[5, 3, 4], &[5, 4, 0]];
        let whole = joined(&points, &fan);
        assert_eq!(whole.len(), 1, "{whole:?}");
        assert_eq!(whole[0].len(), 5, "{whole:?}");
    }

    #[test]
    fn what_is_not_convex_apart_in_height_or_twice_there_stays_as_it_is() {
        let l: [(f64, f64); 6] = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];
        assert_eq!(joined(&l, &[&[0, 1, 2, 3], &[0, 3, 4, 5]]).len(), 2);
        assert_eq!(joined(&SQUARE, &[&[0, 1, 2], &[0, 1, 2]]).len(), 2);
        let far: Vec<_> = SQUARE.iter().chain(&SQUARE.map(|(x, y)| (x + 1.01, y))).copied().collect();
        assert_eq!(joined(&far, &[&[0, 1, 2, 3], &[4, 5, 6, 7]]).len(), 2);
        let mut stairs = surface(&far, &[&[0, 1, 2, 3], &[4, 5, 6, 7]]);
        stairs.points[4..].iter_mut().for_each(|p| *p += DVec3::new(-0.01, 0.0, 0.001));
        join(&mut stairs);
        assert_eq!(stairs.polygons.len(), 2);
        // Back to back: normals are opposite.
        assert_eq!(joined(&SQUARE, &[&[0, 1, 2], &[0, 3, 2]]).len(), 2);
    }
}
