//! Polygons that are not quite flat are made flat, as HPP does: models are drawn by hand and rounded.

use glam::DVec3;

/// How far a corner may lie off its polygon's plane, as a share of the polygon's size, to count as in it.
pub(crate) const FLATNESS: f64 = 1e-3;
/// Most that a corner is moved, metres.
const MOST: f64 = 10e-3;
/// Most that a corner is moved, as a share of the polygon's size.
const MOST_SHARE: f64 = 0.05;

/// How far the corners of a polygon are off a plane through their mean, metres, and the polygon's size: the largest distance of a
/// corner from the mean.
pub(crate) fn bend(corners: &[DVec3], normal: DVec3) -> (f64, f64) {
    let middle = middle(corners);
    let off = corners.iter().map(|p| (*p - middle).dot(normal).abs()).fold(0.0, f64::max);
    (off, corners.iter().map(|p| p.distance(middle)).fold(0.0, f64::max))
}

/// Moves the corners of polygons that are a little bent onto their plane, and returns by how much at most, metres. The plane is
/// HPP's: through the mean of the corners, with the normal of the first two sides. Corners that other polygons share stay where
/// those have them: a bent polygon gets corners of its own. What is bent more is left as it is.
pub(super) fn flatten(points: &mut Vec<DVec3>, polygons: &mut [Vec<u32>]) -> f64 {
    let mut worst = 0.0_f64;
    for polygon in polygons {
        let corners: Vec<DVec3> = polygon.iter().filter_map(|&i| points.get(i as usize).copied()).collect();
        if corners.len() < 4 || corners.len() != polygon.len() {
            continue;
        }
        let first = (corners[1] - corners[0]).cross(corners[2] - corners[1]);
        let Some(normal) = first.try_normalize() else { continue };
        let (off, size) = bend(&corners, normal);
        if off <= FLATNESS * size || off > MOST || off > MOST_SHARE * size {
            continue;
        }
        let middle = middle(&corners);
        let begin = points.len() as u32;
        points.extend(corners.iter().map(|p| *p - (*p - middle).dot(normal) * normal));
        *polygon = (begin..points.len() as u32).collect();
        worst = worst.max(off);
    }
    worst
}

fn middle(corners: &[DVec3]) -> DVec3 {
    corners.iter().sum::<DVec3>() / corners.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(bent: f64) -> Vec<DVec3> {
        [(0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.2, 0.2, 0.0), (0.0, 0.2, bent)].map(DVec3::from).to_vec()
    }

    #[test]
    fn a_bent_polygon_gets_flat_corners_of_its_own() {
        let mut points = square(0.008);
        points.push(DVec3::new(0.3, 0.1, 0.0));
        // The second polygon is flat and keeps the corners that both share.
        let mut polygons = vec![vec![0, 1, 2, 3], vec![1, 4, 2]];
        let worst = flatten(&mut points, &mut polygons);
        assert!((worst - 0.006).abs() < 1e-12, "{worst}");
        assert_eq!(polygons, [vec![5, 6, 7, 8], vec![1, 4, 2]]);
        assert_eq!(points[..4], square(0.008)[..]);
        // On the plane of the first two sides, through the mean.
        assert!(points[5..].iter().all(|p| (p.z - 0.002).abs() < 1e-12));
    }

    #[test]
    fn what_is_flat_or_bent_too_much_is_left() {
        for bent in [0.0, 1e-4, 0.02] {
            let (mut points, mut polygons) = (square(bent), vec![vec![0, 1, 2, 3]]);
            assert_eq!(flatten(&mut points, &mut polygons), 0.0);
            assert_eq!((points, polygons), (square(bent), vec![vec![0, 1, 2, 3]]));
        }
    }
}
