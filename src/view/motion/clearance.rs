//! How close things come over time: the closest pair of shapes that move against each other, and its nearest points.

use crate::planner::trajectory::nearest_pairs::{NearestPair, is_placeholder};
use crate::planner::trajectory::trajectory::Trajectory;
use crate::view::document::path::ClearanceEntry;
use crate::view::geometry::blob::Blob;
use foliate_components::robot::{Robot, ShapeIndex};
use foliate_kernels::collision::CollisionScene;

/// Most moments that are measured.
const MOMENTS: usize = 400;
/// Moments a second, where there are not more than that.
const RATE: f64 = 25.0;

/// The clearance of a motion, measured at moments of equal distance; none where no two tested shapes move against each other.
pub(crate) fn clearance(
    trajectory: &Trajectory<'_>,
    scene: &CollisionScene,
    blob: &mut Blob,
) -> Option<ClearanceEntry> {
    let robot = trajectory.robot();
    let count = ((trajectory.duration() * RATE).ceil() as usize).clamp(1, MOMENTS);
    let at = |number: usize| trajectory.start() + trajectory.duration() * number as f64 / count as f64;
    let mut nearest = trajectory.nearest_pairs(scene);
    let (times, found): (Vec<f64>, Vec<NearestPair>) =
        (0..=count).filter_map(|number| Some((at(number), nearest.at(at(number))?))).unzip();
    if found.is_empty() {
        return None;
    }
    let mut pairs: Vec<[usize; 2]> = Vec::new();
    let mut numbers = Vec::with_capacity(found.len());
    for nearest in &found {
        let pair = scene.pairs()[nearest.pair.at()];
        let link = |shape: ShapeIndex| robot.shapes[shape.at()].link.at();
        let links = [link(pair.first), link(pair.second)];
        let number = pairs.iter().position(|known| *known == links);
        numbers.push(number.unwrap_or(pairs.len()) as u16);
        number.is_none().then(|| pairs.push(links));
    }
    let points = |nearest: &NearestPair| match nearest.points {
        Some([p, q]) => [p.x, p.y, p.z, q.x, q.y, q.z].map(|x| x as f32),
        None => [f32::NAN; 6],
    };
    Some(ClearanceEntry {
        samples: found.len(),
        times: blob.floats(times.iter().map(|&time| (time - trajectory.start()) as f32)),
        values: blob.floats(found.iter().map(|nearest| nearest.distance as f32)),
        pair: blob.shorts(numbers),
        points: blob.floats(found.iter().flat_map(points)),
        pairs,
    })
}

/// Whether pairs of a scene are left out because a box stands for a mesh that cannot be read.
pub(crate) fn leaves_out(robot: &Robot, scene: &CollisionScene) -> bool {
    scene.pairs().iter().any(|pair| is_placeholder(robot, pair.first) || is_placeholder(robot, pair.second))
}
