//! Blocks of candidates: one candidate per lane.
//!
//! The arithmetic inside is scalar still; the layout and the signature are those of the lanes to come.

use super::newton::{Outcome, Settings, project};
use super::program::ConstraintProgram;
use super::scratch::Scratch;
use foliate_components::Pose;
use foliate_components::pose::pose_to_array;
use glam::{DQuat, DVec3};

/// Candidates in a block.
pub const LANES: usize = 8;

/// Configurations, `[coordinate][lane]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LaneBlock {
    values: Vec<[f64; LANES]>,
}

/// Arguments, `[slot][x y z qx qy qz qw][lane]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArgumentBlock {
    values: Vec<[[f64; LANES]; 7]>,
}

/// Which lanes of a block hold a candidate: bit `lane`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LaneMask(pub u8);

impl LaneMask {
    /// Every lane.
    pub const ALL: Self = Self(u8::MAX);

    /// The first `count` lanes.
    #[must_use]
    pub fn first(count: usize) -> Self {
        if count >= LANES { Self::ALL } else { Self((1 << count) - 1) }
    }

    /// Whether the lane is set.
    #[must_use]
    pub fn contains(self, lane: usize) -> bool {
        lane < LANES && self.0 >> lane & 1 == 1
    }
}

impl LaneBlock {
    /// Zeros, for configurations of that size.
    #[must_use]
    pub fn new(size: usize) -> Self {
        Self { values: vec![[0.0; LANES]; size] }
    }

    /// Length of a configuration.
    #[must_use]
    pub fn size(&self) -> usize {
        self.values.len()
    }

    /// `[coordinate][lane]`.
    #[must_use]
    pub fn values(&self) -> &[[f64; LANES]] {
        &self.values
    }

    /// `[coordinate][lane]`.
    pub fn values_mut(&mut self) -> &mut [[f64; LANES]] {
        &mut self.values
    }

    /// Copies a configuration into a lane.
    ///
    /// # Panics
    /// If there is no such lane.
    pub fn set(&mut self, lane: usize, q: &[f64]) {
        for (row, &x) in self.values.iter_mut().zip(q) {
            row[lane] = x;
        }
    }

    /// Copies a lane out.
    ///
    /// # Panics
    /// If there is no such lane.
    pub fn get(&self, lane: usize, q: &mut [f64]) {
        for (row, x) in self.values.iter().zip(q) {
            *x = row[lane];
        }
    }
}

impl ArgumentBlock {
    /// Identities, for that many slots.
    #[must_use]
    pub fn new(slots: usize) -> Self {
        let mut identity = [[0.0; LANES]; 7];
        identity[6] = [1.0; LANES];
        Self { values: vec![identity; slots] }
    }

    /// Number of slots.
    #[must_use]
    pub fn slots(&self) -> usize {
        self.values.len()
    }

    /// Copies an argument into a lane.
    ///
    /// # Panics
    /// If there is no such slot or lane.
    pub fn set(&mut self, slot: usize, lane: usize, pose: &Pose) {
        for (row, x) in self.values[slot].iter_mut().zip(pose_to_array(pose)) {
            row[lane] = x;
        }
    }

    /// The argument in a lane, bit for bit as it was set.
    ///
    /// # Panics
    /// If there is no such slot or lane.
    #[must_use]
    pub fn get(&self, slot: usize, lane: usize) -> Pose {
        let [x, y, z, qx, qy, qz, qw] = self.values[slot].map(|row| row[lane]);
        Pose::from_parts(DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw))
    }
}

/// Moves the configurations of the active lanes onto the program's constraints, each with its own arguments: as
/// [`project`](super::project()) does, lane for lane. Lanes that are not active are left alone.
pub fn project_batch(
    program: &ConstraintProgram,
    block: &mut LaneBlock,
    arguments: &ArgumentBlock,
    active: LaneMask,
    settings: &Settings,
    outcomes: &mut [Outcome; LANES],
    scratch: &mut Scratch,
) {
    let mut q = std::mem::take(&mut scratch.q);
    let mut poses = std::mem::take(&mut scratch.arguments);
    q.resize(block.size(), 0.0);
    for (lane, outcome) in outcomes.iter_mut().enumerate() {
        *outcome = Outcome::Idle;
        if !active.contains(lane) {
            continue;
        }
        block.get(lane, &mut q);
        poses.clear();
        poses.extend((0..arguments.slots()).map(|slot| arguments.get(slot, lane)));
        *outcome = project(program, &mut q, &poses, settings, scratch);
        block.set(lane, &q);
    }
    (scratch.q, scratch.arguments) = (q, poses);
}
