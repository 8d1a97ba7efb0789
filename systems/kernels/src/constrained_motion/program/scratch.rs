//! Memory that a solve works in; kept by the caller so that no solve allocates.

use crate::constrained_motion::lane_rows::memory::LaneMemory;
use crate::constrained_motion::rows::blocks::{Decoded, Memory};
use crate::kinematics::forward::RigidAttachment;
use crate::lanes::vector::{F32Row, F64Row};
use crate::linear::wide_ldlt::WideMemory;
use foliate_components::Pose;

/// Working memory of one thread; it serves every program in turn and grows to the largest.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// Poses of bodies; only those that the last program needed are current.
    pub(crate) X_WJ: Vec<Pose>,
    pub(crate) rigid_attachments: Vec<RigidAttachment>,
    pub(crate) decoded: Vec<Decoded>,
    pub(crate) memory: Memory,
    pub(crate) values: Vec<f64>,
    pub(crate) jacobian: Vec<f64>,
    pub(crate) gram: Vec<f64>,
    pub(crate) wide: WideMemory,
    pub(crate) multipliers: Vec<f64>,
    pub(crate) step: Vec<f64>,
    pub(crate) frozen: Vec<bool>,
    pub(crate) lanes: LaneMemory<F64Row>,
    pub(crate) single_lanes: LaneMemory<F32Row>,
    /// Where rows are only evaluated: a motion does so between its solves.
    pub(crate) probe_lanes: LaneMemory<F64Row>,
    /// Jobs that wait for double precision, with the steps that they have taken.
    pub(crate) todo: Vec<(usize, u32)>,
}

impl Scratch {
    /// Poses of the bodies that the last solve's program needed, in the world, by joint index; others are stale.
    #[must_use]
    pub fn poses(&self) -> &[Pose] {
        &self.X_WJ
    }
}
