//! Memory that a solve works in; kept by the caller so that no solve allocates.

use super::lane_newton::LaneMemory;
use super::program::ConstraintProgram;
use crate::constraints::custom::FunctionMemory;
use crate::constraints::placement::Contact;
use crate::kinematics::Carriage;
use crate::lanes::{F32Row, F64Row};
use crate::linear::WideMemory;
use foliate_components::Pose;
use glam::DVec3;

/// A placement's leaf parameter, read.
pub(super) type Decoded = (Contact, Pose);

/// What single constraints work with.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    pub(super) moments: Vec<DVec3>,
    pub(super) function: FunctionMemory,
}

/// Working memory of one thread; it serves every program in turn and grows to the largest.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// Poses of bodies; only those that the last program needed are current.
    pub(super) X_WJ: Vec<Pose>,
    pub(super) carriages: Vec<Carriage>,
    pub(super) decoded: Vec<Decoded>,
    pub(super) memory: Memory,
    pub(super) values: Vec<f64>,
    pub(super) jacobian: Vec<f64>,
    pub(super) gram: Vec<f64>,
    pub(super) wide: WideMemory,
    pub(super) multipliers: Vec<f64>,
    pub(super) step: Vec<f64>,
    pub(super) frozen: Vec<bool>,
    pub(super) lanes: LaneMemory<F64Row>,
    pub(super) single_lanes: LaneMemory<F32Row>,
    /// Where rows are only evaluated: a motion does so between its solves.
    pub(super) probe_lanes: LaneMemory<F64Row>,
    /// Jobs that wait for double precision, with the steps that they have taken.
    pub(super) todo: Vec<(usize, u32)>,
}

impl Scratch {
    /// Makes room for a program; allocates only where an earlier one needed less.
    pub(super) fn prepare(&mut self, program: &ConstraintProgram) {
        let (rows, width) = (program.rows().max(program.check_rows), program.active.len());
        grow(&mut self.X_WJ, program.bodies_count, Pose::identity());
        grow(&mut self.values, rows, 0.0);
        grow(&mut self.jacobian, rows * width, 0.0);
        grow(&mut self.memory.moments, program.moments, DVec3::ZERO);
        grow(&mut self.gram, rows * rows, 0.0);
        grow(&mut self.multipliers, rows, 0.0);
        grow(&mut self.step, width, 0.0);
        grow(&mut self.frozen, width, false);
    }

    /// Poses of the bodies that the last solve's program needed, in the world, by joint index; others are stale.
    #[must_use]
    pub fn poses(&self) -> &[Pose] {
        &self.X_WJ
    }
}

fn grow<T: Clone>(items: &mut Vec<T>, length: usize, fill: T) {
    if items.len() < length {
        items.resize(length, fill);
    }
}
