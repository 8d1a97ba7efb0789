//! Whether polygons of a file are those of a document, or whole faces that the document cuts into pieces. The reader of scenes joins such
//! pieces with code of its own: the check does not share it.

use crate::check::world::models::normal;
use glam::DVec3;

/// How far corners of pieces may be beyond the polygon that they are part of, or over one another, metres.
const SLACK: f64 = 2e-5;

/// Whether each of the document's polygons `pieces` is in one of the file's polygons `wholes`, these are convex and in a plane with what is
/// in them, and nothing is in them besides. Corners are metres in one frame.
pub(super) fn are_joined(wholes: &[Vec<DVec3>], pieces: &[Vec<DVec3>]) -> bool {
    let made = |whole: &Vec<DVec3>| {
        let inside: Vec<_> = pieces.iter().filter(|piece| is_in(whole, piece)).collect();
        is_convex(whole) && is_made_of(whole, &inside)
    };
    let is_in_one = |piece: &Vec<DVec3>| wholes.iter().filter(|whole| is_in(whole, piece)).count() == 1;
    wholes.iter().all(made) && pieces.iter().all(is_in_one)
}

/// Pieces that do not overlap fill a polygon in which they are.
fn is_made_of(whole: &[DVec3], pieces: &[&Vec<DVec3>]) -> bool {
    let apart = |(index, piece): (usize, &&Vec<DVec3>)| pieces[..index].iter().all(|other| are_apart(piece, other));
    let filled: f64 = pieces.iter().map(|piece| area(piece)).sum();
    let around: f64 = edges(whole).map(|(a, b)| a.distance(b)).sum();
    pieces.iter().enumerate().all(apart) && (area(whole) - filled).abs() <= SLACK * around
}

fn is_in(whole: &[DVec3], piece: &[DVec3]) -> bool {
    let (Some(up), Some(of_piece)) = (normal(whole), normal(piece)) else { return false };
    let within = |corner: &DVec3| {
        up.dot(*corner - whole[0]).abs() <= SLACK && beyond(whole, up, *corner).all(|beyond| beyond <= SLACK)
    };
    up.dot(of_piece) > 0.999 && piece.iter().all(within)
}

fn is_convex(corners: &[DVec3]) -> bool {
    let Some(up) = normal(corners) else { return false };
    corners.iter().all(|corner| {
        up.dot(*corner - corners[0]).abs() <= SLACK && beyond(corners, up, *corner).all(|beyond| beyond <= SLACK)
    })
}

/// An edge of one has the other beyond it.
fn are_apart(first: &[DVec3], second: &[DVec3]) -> bool {
    let separates = |one: &[DVec3], other: &[DVec3]| {
        let Some(up) = normal(one) else { return false };
        edges(one).any(|(a, b)| {
            let out = (b - a).cross(up).normalize_or_zero();
            out != DVec3::ZERO && other.iter().all(|corner| out.dot(*corner - a) >= -SLACK)
        })
    };
    separates(first, second) || separates(second, first)
}

fn edges(corners: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// How far a point is beyond each edge of a polygon with this normal.
fn beyond(corners: &[DVec3], up: DVec3, point: DVec3) -> impl Iterator<Item = f64> + '_ {
    edges(corners).map(move |(a, b)| (b - a).cross(up).normalize_or_zero().dot(point - a))
}

fn area(corners: &[DVec3]) -> f64 {
    let across: DVec3 = edges(corners).map(|(a, b)| (a - corners[0]).cross(b - corners[0])).sum();
    across.length() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(corners: &[(f64, f64)]) -> Vec<DVec3> {
        corners.iter().map(|&(x, y)| DVec3::new(x, y, 0.3)).collect()
    }

    #[test]
    fn only_the_whole_of_its_pieces_is_accepted() {
        let square = polygon(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
        let lower = polygon(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]);
        let upper = polygon(&[(0.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
        let both = [lower.clone(), upper.clone()];
        assert!(are_joined(std::slice::from_ref(&square), &both));
        assert!(are_joined(&both, &both));
        // Too large, only a part, of one piece twice, with a side that the document does not have.
        let larger = polygon(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.001), (0.0, 1.0)]);
        assert!(!are_joined(&[larger], &both));
        assert!(!are_joined(std::slice::from_ref(&lower), &both));
        assert!(!are_joined(std::slice::from_ref(&square), &[lower.clone(), lower.clone()]));
        assert!(!are_joined(std::slice::from_ref(&square), &[lower]));
        let under: Vec<_> = square.iter().rev().copied().collect();
        assert!(!are_joined(&[under], &both));
        let lifted = square.iter().map(|corner| *corner + DVec3::Z * 1e-3).collect();
        assert!(!are_joined(&[lifted], &both));
    }
}
