//! Which two shapes that move against each other are the closest at a time, and how close they are.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::planner::trajectory::poses::Poses;
use crate::planner::trajectory::trajectory::Trajectory;
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, Robot, ShapeIndex};
use foliate_kernels::collision::distance::witness::witnesses;
use foliate_kernels::collision::{CollisionScene, DistanceQuery, PairId, contained, pair_clearance};
use glam::DVec3;

/// The closest of the pairs of shapes that move against each other, at times of a trajectory one after the other.
///
/// Distances are measured at these times; what lies between them is for certificates.
#[derive(Clone, Debug)]
pub struct NearestPairs<'t> {
    trajectory: &'t Trajectory<'t>,
    scene: &'t CollisionScene,
    poses: Poses<'t>,
    /// The pairs that move against each other along a segment.
    along: Option<(usize, Vec<PairId>)>,
    last: Option<NearestPair>,
}

/// Two shapes at a time.
#[derive(Clone, Copy, Debug)]
pub struct NearestPair {
    /// The pair, in the collision scene that was given.
    pub pair: PairId,
    /// Their distance, metres; 0 where they meet.
    pub distance: f64,
    /// The nearest points of both in the world, metres; `None` where they meet, or where no points are known.
    pub points: Option<[DVec3; 2]>,
}

impl<'a> Trajectory<'a> {
    /// Distances of the shapes of `scene`, a collision scene of the trajectory's robot.
    #[must_use]
    pub fn nearest_pairs<'t>(&'t self, scene: &'t CollisionScene) -> NearestPairs<'t> {
        NearestPairs { trajectory: self, scene, poses: self.poses(), along: None, last: None }
    }
}

impl NearestPairs<'_> {
    /// The closest pair at a time (seconds; clamped to the trajectory); `None` where no two shapes move against each other. Times that rise along one segment are cheaper
    /// than others.
    pub fn at(&mut self, time: f64) -> Option<NearestPair> {
        let Self { trajectory, scene, poses, along, last } = self;
        poses.place(time);
        let segment = trajectory.moment(time).segment;
        let is_new = along.as_ref().is_none_or(|(known, _)| *known != segment);
        let (_, pairs) = match along {
            Some(known) if known.0 == segment => known,
            _ => along.insert((segment, moving_pairs(trajectory, scene, segment))),
        };
        // What starts outside and never touches stays outside.
        let asks = is_new || last.is_none_or(|last| last.distance <= 0.0);
        let inside = pairs.iter().copied().find(|&pair| asks && contained(scene, pair, poses.bodies()));
        let found = match inside {
            Some(pair) => Some(NearestPair { pair, distance: 0.0, points: None }),
            None => nearest(scene, pairs, poses.bodies(), last.map(|last| last.pair)),
        };
        *last = found.or(*last);
        found
    }
}

/// Whether a box stands for the mesh of a shape that cannot be read.
pub(crate) fn is_placeholder(robot: &Robot, shape: ShapeIndex) -> bool {
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
fn nearest(scene: &CollisionScene, pairs: &[PairId], X_WJ: &[Pose], before: Option<PairId>) -> Option<NearestPair> {
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
        return Some(NearestPair { pair, distance: 0.0, points: None });
    }
    let points = witnesses(a, &X_WA, b, &X_WB, distance);
    let distance = if distance.is_finite() { distance } else { 0.0 };
    Some(NearestPair { pair, distance, points })
}
