//! A handle that was found, and which of them a hand can really take.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::{FoundGripper, GripperKind};
use crate::setup::objects::RigidObject;
use foliate_components::Pose;
use foliate_components::pose::exp_so3;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::TAU;

/// How far the palm and the tips of a hand stay off an object and what it lies on, metres.
pub(super) const ROOM: f64 = 0.003;
/// How far the open hand stays off the object at the grasp, metres.
const GAP: f64 = 3e-4;
/// How far a hand backs off beyond what it encloses, metres.
const BACK_OFF: f64 = 0.02;
/// By how much a handle is moved out of the hand at a time, metres.
const STEP: f64 = 0.01;
/// How far the tips reach around an object at least, metres.
const LEAST_OVERLAP: f64 = 0.006;
/// How far an object stays off a jaw that does not move, metres.
const AGAINST: f64 = 1e-3;
/// How many times farther than [`AGAINST`] an object may stay off the middle of such a jaw, whose face bulges elsewhere.
const OFF_JAW: u32 = 15;
/// Turns about a free axis at which a grasp is tested.
pub(super) const TURNS: usize = 8;
/// Places between pregrasp and grasp at which the open hand is tested.
const PLACES: usize = 6;

/// A handle of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundHandle {
    /// A name, unique in the object, without its part.
    pub name: String,
    /// Its frame in the object's root link: x along the approach, y along the closing direction.
    pub link_from_handle: Pose,
    /// How far before the grasp the hand stands still, metres.
    pub clearance: f64,
    /// Rows (tx ty tz rx ry rz) that a grasp forces to zero.
    pub mask: [bool; 6],
    /// How it was found, in words.
    pub reason: String,
}

/// Settings of [`handles`](fn@crate::setup::handles::handles).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandleSettings {
    /// Points on the surface of a mesh at which grasps are sought.
    pub samples: usize,
    /// Most handles of a mesh.
    pub most: usize,
    /// Largest angle between a surface's normal and the closing direction, radians: the angle of friction.
    pub friction: f64,
    /// Seed of the points.
    pub seed: u64,
}

impl Default for HandleSettings {
    fn default() -> Self {
        Self { samples: 1500, most: 24, friction: 0.25, seed: 0 }
    }
}

/// A handle that reaches less far into the hand, in steps of a centimetre, until the hand can take it.
pub(super) fn farther_out(object: &RigidObject, gripper: &FoundGripper, handle: &FoundHandle) -> Option<FoundHandle> {
    let steps = ((handle.clearance - BACK_OFF - LEAST_OVERLAP) / STEP).floor().clamp(0.0, 20.0) as u32;
    (1..=steps).find_map(|step| {
        let out = STEP * f64::from(step);
        let moved = FoundHandle {
            link_from_handle: handle.link_from_handle * Pose::from_translation(-DVec3::X * out),
            clearance: handle.clearance - out,
            ..handle.clone()
        };
        fitted(object, gripper, &moved)
    })
}

/// A handle that the hand can take. Where one jaw moves alone, the object lies against the other one as near as that one's shape allows:
/// its face need not be flat.
pub(super) fn fitted(object: &RigidObject, gripper: &FoundGripper, handle: &FoundHandle) -> Option<FoundHandle> {
    let GripperKind::Jaws { one_moves, .. } = gripper.kind else {
        return can_take(object, gripper, handle).then(|| handle.clone());
    };
    let places = if one_moves { OFF_JAW } else { 0 };
    (0..=places).find_map(|place| {
        let off = Pose::from_translation(-DVec3::Y * AGAINST * f64::from(place));
        let moved = FoundHandle { link_from_handle: handle.link_from_handle * off, ..handle.clone() };
        can_take(object, gripper, &moved).then_some(moved)
    })
}

/// Whether the open hand is clear of the object at the grasp and all the way from the pregrasp, at some turn that the mask leaves free.
fn can_take(object: &RigidObject, gripper: &FoundGripper, handle: &FoundHandle) -> bool {
    free_turns(handle.mask).into_iter().any(|X_GH| can_take_turned(object, gripper, handle, &X_GH))
}

/// Likewise where the handle is so in the gripper's frame.
pub(crate) fn can_take_turned(object: &RigidObject, gripper: &FoundGripper, handle: &FoundHandle, X_GH: &Pose) -> bool {
    (0..=PLACES).all(|place| {
        let ahead = Pose::from_translation(DVec3::X * handle.clearance * place as f64 / PLACES as f64);
        gripper.is_clear(&object.solids, &(ahead * *X_GH * handle.link_from_handle.inverse()), GAP)
    })
}

/// Poses of a handle in a gripper that a mask allows.
fn free_turns(mask: [bool; 6]) -> Vec<Pose> {
    let mut turns = vec![Pose::identity()];
    for (row, axis) in [(3, DVec3::X), (4, DVec3::Y), (5, DVec3::Z)] {
        if !mask[row] {
            let angles = (1..TURNS).map(|turn| TAU * turn as f64 / TURNS as f64);
            turns.extend(angles.map(|angle| Pose::from_rotation(exp_so3(axis * angle))));
        }
    }
    turns
}

/// The sizes of two jaws.
#[derive(Clone, Copy)]
pub(super) struct Jaws {
    pub opening: f64,
    pub shut: f64,
    pub depth: f64,
    pub tip: f64,
    /// Whether one jaw moves alone, that on the side of y.
    pub one_moves: bool,
}

impl Jaws {
    pub(super) fn of(kind: GripperKind) -> Option<Self> {
        match kind {
            GripperKind::Jaws { opening, shut, depth, tip, one_moves } => {
                Some(Self { opening, shut, depth, tip, one_moves })
            }
            GripperKind::Tool => None,
        }
    }

    /// Whether something so wide fits between the open jaws, and is not too thin for the shut ones.
    pub(super) fn fits(&self, width: f64) -> bool {
        width <= self.opening - 2.0 * GAP - 1e-3 && width >= self.shut
    }

    /// How far behind a face that is approached the origin of the gripper comes to lie, where the object is `thick` along the approach:
    /// in the middle, unless the palm or the tips have no room there. None where the jaws would hardly reach it.
    pub(super) fn behind(&self, thick: f64) -> Option<f64> {
        let behind = (thick / 2.0).min(self.depth - ROOM).min(thick - self.tip - ROOM);
        (behind + self.tip > LEAST_OVERLAP).then_some(behind)
    }

    /// The frame of a handle that holds `width` metres, the middle of which is at `at`, with that approach and closing direction. Where one
    /// jaw moves alone, the object lies against the other one.
    pub(super) fn frame(&self, at: DVec3, approach: DVec3, closing: DVec3, width: f64) -> Pose {
        let beside = if self.one_moves { ((self.opening - width) / 2.0 - AGAINST).max(0.0) } else { 0.0 };
        frame(at, approach, closing) * Pose::from_translation(DVec3::Y * beside)
    }

    /// The clearance of a handle whose object reaches `behind` metres into the hand.
    pub(super) fn clearance(&self, behind: f64) -> f64 {
        let clearance = (behind + self.tip).max(0.0) + BACK_OFF;
        (clearance * 1e3).ceil() / 1e3
    }
}

/// The frame of a handle with that approach and closing direction.
pub(super) fn frame(at: DVec3, approach: DVec3, closing: DVec3) -> Pose {
    let rotation = DQuat::from_mat3(&DMat3::from_cols(approach, closing, approach.cross(closing)));
    Pose::from_parts(at, rotation.normalize())
}
