//! Buffers of the collision queries, so that none of them allocates once they are warm.

use crate::collision::broad_phase::open_pairs::Open;
use crate::collision::broad_phase::placed::BroadPhaseScratch;
use crate::collision::narrow_phase::pair_at_sample::Hints;
use crate::collision::samples::interval::Interval;
use crate::collision::samples::motion_bound::MotionBound;
use crate::collision::samples::motion_samples::MotionSamples;
use crate::collision::scene::collision_scene::CollisionScene;
use crate::collision::scene::pair_query::Contact;
use crate::collision::solids::volumes::Ball;
use crate::lanes::level::Level;
use foliate_components::Pose;

/// Up to sixteen intervals, and what is open there.
#[derive(Clone, Debug, Default)]
pub(crate) struct Block {
    pub(crate) intervals: Vec<Interval>,
    pub(crate) open: Vec<Open>,
}

/// Buffers of a proof.
#[derive(Clone, Debug, Default)]
pub(crate) struct CertifierScratch {
    /// The blocks of this round and of the next; those from `used` on are spare.
    pub(crate) rounds: [Vec<Block>; 2],
    pub(crate) used: [usize; 2],
    /// What is left of the current block.
    pub(crate) rest: Vec<Open>,
}

/// An empty block.
pub(crate) fn spare<'a>(blocks: &'a mut Vec<Block>, used: &mut usize) -> &'a mut Block {
    if *used == blocks.len() {
        blocks.push(Block::default());
    }
    let block = &mut blocks[*used];
    *used += 1;
    block.intervals.clear();
    block.open.clear();
    block
}

/// Buffers, one set per thread, and the level at which lanes work. Any scene and any robot may use them in turn; nothing
/// else that they hold changes an answer.
#[derive(Clone, Debug, Default)]
pub struct CollisionScratch {
    pub(crate) level: Level,
    pub(crate) knots: Vec<f64>,
    pub(crate) X_WJ: Vec<Pose>,
    /// By cluster, in the world.
    pub(crate) balls: Vec<Ball>,
    pub(crate) bound: MotionBound,
    pub(crate) motion_samples: MotionSamples,
    pub(crate) broad_phase: BroadPhaseScratch,
    pub(crate) certifier: CertifierScratch,
    pub(crate) verdicts: VerdictScratch,
    /// By pair: what set it apart last, within one query.
    pub(crate) hints: Vec<Hints>,
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

    pub(crate) fn forget_hints(&mut self, scene: &CollisionScene) {
        self.hints.clear();
        self.hints.resize(scene.pairs.len(), Hints::default());
    }
}

/// Buffers of verdicts.
#[derive(Clone, Debug, Default)]
pub(crate) struct VerdictScratch {
    pub(crate) intervals: Vec<Interval>,
    pub(crate) open: Vec<Open>,
    pub(crate) rest: Vec<Open>,
    /// By configuration of a block.
    pub(crate) found: Vec<Option<Contact>>,
}
