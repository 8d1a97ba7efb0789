//! How close things come over time: the closest pair of shapes that move against each other, and its nearest points.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::planner::trajectory::trajectory::Trajectory;
use crate::view::document::path::ClearanceEntry;
use crate::view::geometry::blob::Blob;
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, Robot, ShapeIndex};
use foliate_kernels::collision::distance::witness::witnesses;
use foliate_kernels::collision::{CollisionScene, DistanceQuery, PairId, contained, pair_clearance};
use glam::DVec3;

/// Most moments that are measured.
const MOMENTS: usize = 400;
/// Moments a second, where there are not more than that.
const RATE: f64 = 25.0;

/// What is measured at a moment.
struct Nearest {
    pair: PairId,
    distance: f64,
    points: Option<[DVec3; 2]>,
}

/// The clearance of a motion, measured at moments of equal distance; none where no two tested shapes move against each other.
pub(crate) fn clearance(
    trajectory: &Trajectory<'_>,
    scene: &CollisionScene,
    blob: &mut Blob,
) -> Option<ClearanceEntry> {
    let robot = trajectory.robot();
    let count = ((trajectory.duration() * RATE).ceil() as usize).clamp(1, MOMENTS);
    let at = |number: usize| trajectory.start() + trajectory.duration() * number as f64 / count as f64;
    let (mut current, mut pairs) = (None, Vec::new());
    let mut poses = trajectory.poses();
    let (mut times, mut found): (Vec<f64>, Vec<Nearest>) = (Vec::new(), Vec::new());
    for number in 0..=count {
        let time = at(number);
        poses.place(time);
        let segment = trajectory.moment(time).segment;
        let is_new = current != Some(segment);
        if is_new {
            (current, pairs) = (Some(segment), moving_pairs(trajectory, scene, segment));
        }
        // What starts outside and never touches stays outside.
        let last = found.last();
        let asks = is_new || last.is_some_and(|last| last.distance <= 0.0);
        let inside = pairs.iter().copied().find(|&pair| asks && contained(scene, pair, poses.bodies()));
        let nearest = match inside {
            Some(pair) => Some(Nearest { pair, distance: 0.0, points: None }),
            None => nearest(scene, &pairs, poses.bodies(), last.map(|last| last.pair)),
        };
        if let Some(nearest) = nearest {
            times.push(time - trajectory.start());
            found.push(nearest);
        }
    }
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
    let points = |nearest: &Nearest| match nearest.points {
        Some([p, q]) => [p.x, p.y, p.z, q.x, q.y, q.z].map(|x| x as f32),
        None => [f32::NAN; 6],
    };
    Some(ClearanceEntry {
        samples: found.len(),
        times: blob.floats(times.iter().map(|&time| time as f32)),
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

fn is_placeholder(robot: &Robot, shape: ShapeIndex) -> bool {
    robot.shapes[shape.at()].geometry.missing_file().is_some()
}

/// The pairs that move against each other along a segment, without those of placeholders.
fn moving_pairs(trajectory: &Trajectory<'_>, scene: &CollisionScene, segment: usize) -> Vec<PairId> {
    let rigid = trajectory.rigid_bodies(segment);
    let one_with = |body: Option<JointIndex>| body.and_then(|body| rigid[body.at()]);
    let moves = |id: &PairId| {
        let pair = scene.pairs()[id.at()];
        let body = |shape: ShapeIndex| one_with(scene.solids()[shape.at()].body);
        let is_left_out = [pair.first, pair.second].iter().any(|&shape| is_placeholder(trajectory.robot(), shape));
        !is_left_out && body(pair.first) != body(pair.second)
    };
    (0..scene.pairs().len() as u32).map(PairId).filter(moves).collect()
}

/// The closest of some pairs; the one that was the closest before is asked first, so that most others are seen to be farther at once.
fn nearest(scene: &CollisionScene, pairs: &[PairId], X_WJ: &[Pose], before: Option<PairId>) -> Option<Nearest> {
    let before = before.filter(|pair| pairs.binary_search(pair).is_ok());
    let mut least: Option<(f64, PairId)> = None;
    for &pair in before.iter().chain(pairs) {
        let so_far = least.map_or(f64::MAX, |(distance, _)| distance);
        let query = DistanceQuery::exact(so_far.max(0.0));
        let distance = pair_clearance(scene, pair, X_WJ, query, &mut DVec3::ZERO.clone());
        if distance < so_far {
            least = Some((distance, pair));
        }
    }
    let (distance, pair) = least?;
    let [first, second] = [scene.pairs()[pair.at()].first, scene.pairs()[pair.at()].second];
    let placed = |shape: ShapeIndex| {
        let solid = &scene.solids()[shape.at()];
        (&solid.solid, solid.body.map_or(Pose::identity(), |body| X_WJ[body.at()]) * solid.X_JS)
    };
    let ((a, X_WA), (b, X_WB)) = (placed(first), placed(second));
    if contained(scene, pair, X_WJ) {
        return Some(Nearest { pair, distance: 0.0, points: None });
    }
    let points = witnesses(a, &X_WA, b, &X_WB, distance);
    let distance = if distance.is_finite() { distance } else { 0.0 };
    Some(Nearest { pair, distance, points })
}
