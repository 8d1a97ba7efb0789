//! Where rows in lanes read and write: poses of bodies and given poses, values and Jacobian.
//!
//! `frame` loads the pose of a frame, `select` chooses between two poses lane by lane. `linearise` and `balance` share this
//! file.

use crate::constrained_motion::lane_rows::form::FrameAt;
use crate::kinematics::lane_steps::POSE_ROWS;
use crate::lanes::geometry::{Rotation, Transform, Vector3};
use crate::lanes::vector::Lanes;
use foliate_components::Pose;

/// Where rows are evaluated.
#[derive(Clone, Copy)]
pub(crate) struct At<'a, R> {
    pub bodies: &'a [R],
    pub given: &'a [R],
}

/// Where rows are written: values, and a Jacobian column by column.
pub(crate) struct Out<'a, R> {
    pub values: &'a mut [R],
    pub jacobian: &'a mut [R],
    /// Working memory: vectors, three rows each.
    pub vectors: &'a mut [R],
    pub stride: usize,
    /// Numbers of the Jacobian are added to what is there, instead of replacing it.
    pub adds: bool,
    /// Whether values alone are asked for: then nothing is written to the Jacobian.
    pub values_alone: bool,
}

#[inline(always)]
pub(crate) fn frame<V: Lanes>(isa: V::Isa, frame: &FrameAt, at: At<'_, V::Row>) -> Transform<V> {
    match frame {
        FrameAt::Given(slot) => Transform::load(isa, &at.given[slot * POSE_ROWS..]),
        FrameAt::Body(body, X_JF) => {
            let body = Transform::load(isa, &at.bodies[body * POSE_ROWS..]);
            if *X_JF == Pose::identity() { body } else { body.times(&Transform::splat(isa, X_JF)) }
        }
    }
}

#[inline(always)]
pub(crate) fn select<V: Lanes>(mask: V::Mask, yes: &Transform<V>, no: &Transform<V>) -> Transform<V> {
    let [a, b, c] = yes.rotation.columns;
    let [d, e, f] = no.rotation.columns;
    let columns = [Vector3::select(mask, a, d), Vector3::select(mask, b, e), Vector3::select(mask, c, f)];
    Transform { rotation: Rotation { columns }, translation: Vector3::select(mask, yes.translation, no.translation) }
}
