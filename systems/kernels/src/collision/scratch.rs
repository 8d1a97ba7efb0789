//! Buffers of the collision queries, so that none of them allocates once they are warm.

use super::bounds::Ball;
use super::course::Course;
use super::look::Hints;
use super::proof::ProofScratch;
use super::scene::{CollisionScene, PairId};
use super::sweep::SweepScratch;
use super::velocity_bound::MotionBound;
use super::verdicts::VerdictScratch;
use crate::lanes::Level;
use foliate_components::Pose;

/// Buffers, one set per thread, and the level at which lanes work. Any scene and any robot may use them in turn; nothing
/// else that they hold changes an answer.
#[derive(Clone, Debug, Default)]
pub struct CollisionScratch {
    pub(super) level: Level,
    pub(super) knots: Vec<f64>,
    pub(super) X_WJ: Vec<Pose>,
    /// By cluster, in the world.
    pub(super) balls: Vec<Ball>,
    pub(super) bound: MotionBound,
    pub(super) course: Course,
    pub(super) sweep: SweepScratch,
    pub(super) proof: ProofScratch,
    pub(super) verdicts: VerdictScratch,
    /// By pair: what set it apart last, within one query.
    pub(super) hints: Vec<Hints>,
}

impl CollisionScratch {
    /// Empty buffers, which grow with the first queries, and the best level that this machine has.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Empty buffers at a level. Answers may differ between levels where bounds decide what is in doubt, and in last
    /// digits.
    #[must_use]
    pub fn at_level(level: Level) -> Self {
        Self { level, ..Self::default() }
    }

    /// From now on lanes work at that level.
    pub fn set_level(&mut self, level: Level) {
        self.level = level;
    }

    pub(super) fn forget_hints(&mut self, scene: &CollisionScene) {
        self.hints.clear();
        self.hints.resize(scene.pairs.len(), Hints::default());
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
