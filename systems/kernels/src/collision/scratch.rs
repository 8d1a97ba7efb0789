//! Buffers of the collision queries, so that none of them allocates once they are warm.

use super::bounds::Ball;
use super::certificate::Level;
use super::polyline::PolylineScratch;
use super::scene::{CollisionScene, PairId};
use super::velocity_bound::MotionBound;
use foliate_components::Pose;
use glam::DVec3;

/// Buffers, one set per thread. Any scene and any robot may use them in turn; nothing that they hold changes an answer.
#[derive(Clone, Debug, Default)]
pub struct CollisionScratch {
    pub(super) q: Vec<f64>,
    pub(super) delta: Vec<f64>,
    pub(super) X_WJ: Vec<Pose>,
    /// By cluster, in the world.
    pub(super) balls: Vec<Ball>,
    pub(super) bound: MotionBound,
    pub(super) level: Level,
    pub(super) next_level: Level,
    pub(super) polyline: PolylineScratch,
    /// By pair: the direction that separated it last, within one query.
    pub(super) hints: Vec<DVec3>,
    /// By pair: the direction that set the hulls of its solids apart, within one query.
    pub(super) hull_hints: Vec<DVec3>,
}

impl CollisionScratch {
    /// Empty buffers; they grow with the first queries.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    pub(super) fn forget_hints(&mut self, scene: &CollisionScene) {
        self.hints.clear();
        self.hints.resize(scene.pairs.len(), DVec3::ZERO);
        self.hull_hints.clear();
        self.hull_hints.resize(scene.pairs.len(), DVec3::ZERO);
    }
}

/// Writes the clusters' balls in the world.
pub(super) fn place_balls(scene: &CollisionScene, X_WJ: &[Pose], balls: &mut Vec<Ball>) {
    balls.clear();
    balls.extend(scene.clusters.iter().map(|cluster| match cluster.body {
        Some(body) => {
            Ball { center: X_WJ[body.at()].transform_point(cluster.ball.center), radius: cluster.ball.radius }
        }
        None => cluster.ball,
    }));
}

/// The balls of a pair's two shapes in the world.
#[inline]
pub(super) fn solid_balls(scene: &CollisionScene, id: PairId, X_WJ: &[Pose]) -> [Ball; 2] {
    let pair = &scene.pairs[id.at()];
    [pair.first, pair.second].map(|shape| {
        let solid = &scene.solids[shape.at()];
        match solid.body {
            Some(body) => Ball { center: X_WJ[body.at()].transform_point(solid.ball.center), ..solid.ball },
            None => solid.ball,
        }
    })
}
