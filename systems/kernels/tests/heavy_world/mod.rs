//! What several tests share: a robot of every kind of joint, all of it with masses, and a humanoid with things to hold.
#![allow(dead_code, reason = "each test uses its part")]
#![allow(non_snake_case, reason = "pose names carry their frames")]

use foliate_components::Pose;
use foliate_components::constraint::{
    CentreOfMass, CentreOfMassBetween, Curvature, Custom, Distance, Frame, Function, Gradient, Masses, PlaneRow,
    Reference, Row,
};
use foliate_components::pose::exp_so3;
use foliate_components::robot::model::{Inertial, Model};
use foliate_components::robot::{LinkIndex, PartIndex, PartKind, PartPlacement, Robot, RootJoint, Source};
use foliate_components::samples::models;
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// Gives every link a mass of its own.
fn weighed(mut model: Model) -> Model {
    for (number, link) in model.links.iter_mut().enumerate() {
        let n = number as f64;
        link.inertial =
            Some(Inertial { mass: 0.5 + 0.3 * n, center: DVec3::new(0.02 * n, 0.05 - 0.03 * n, 0.04 + 0.01 * n) });
    }
    model
}

/// A fixed arm, arms on a planar and on a free-flyer root, a hand with a mimic finger, a humanoid, objects with and
/// without joints of their own.
pub fn world() -> Robot {
    let size = DVec3::new(0.1, 0.14, 0.2);
    let tilted = Pose::from_parts(DVec3::new(0.3, -0.2, 0.5), exp_so3(DVec3::new(0.4, -0.3, 0.9)));
    let (arm, two) = (weighed(models::seven_axis_arm()), weighed(models::two_joint_arm()));
    let (hand, humanoid) = (weighed(models::two_finger_hand()), models::humanoid());
    let (block, lid) = (weighed(models::block(size)), weighed(models::box_with_lid(size)));
    let floating = |name| PartPlacement {
        root_bounds: vec![(-1.0, 1.0); 3],
        ..models::part(name, PartKind::Robot, RootJoint::FreeFlyer, tilted)
    };
    Robot::compose(&[
        (&arm, models::fixed_robot("arm", tilted)),
        (&two, models::part("rover", PartKind::Robot, RootJoint::Planar, tilted)),
        (&two, floating("drone")),
        (&hand, models::fixed_robot("hand", tilted)),
        (&humanoid, floating("human")),
        (&block, models::movable_object("block")),
        (&block, models::movable_object("other")),
        (&lid, models::movable_object("lid")),
    ])
    .unwrap()
}

/// The block in the arm's hand, the lid's box on the block.
pub fn held(robot: &Robot) -> Vec<RigidAttachment> {
    let X_CO = Pose::from_parts(DVec3::new(0.1, 0.02, 0.2), exp_so3(DVec3::new(1.0, 0.5, -0.3)));
    let root = |part: &str| robot.joint(&format!("{part}/root_joint")).unwrap();
    vec![
        RigidAttachment { object: root("block"), carrier: robot.joint("arm/w2"), X_CO },
        RigidAttachment { object: root("lid"), carrier: Some(root("block")), X_CO },
    ]
}

pub fn poses(kinematics: &Kinematics, rigid_attachments: &[RigidAttachment], q: &[f64]) -> Vec<Pose> {
    let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
    kinematics.forward(q, &mut X_WJ);
    kinematics.carry(q, rigid_attachments, &mut X_WJ);
    X_WJ
}

/// Random constraints on a robot.
pub struct Draw {
    pub rng: ChaCha8Rng,
}

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self { rng: ChaCha8Rng::seed_from_u64(seed) }
    }

    pub fn vector(&mut self, size: f64) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| self.rng.random_range(-size..size)))
    }

    pub fn configuration(&mut self, robot: &Robot) -> Vec<f64> {
        let mut q = robot.space.neutral();
        robot.space.random(&mut self.rng, &mut q);
        q
    }

    pub fn frame(&mut self, robot: &Robot) -> Frame {
        let link = LinkIndex(self.rng.random_range(0..robot.links.len() as u32));
        let turn = self.vector(1.0);
        Frame::on_link(robot, link, &Pose::from_parts(self.vector(0.2), exp_so3(turn)))
    }

    /// Of one to three parts that weigh something.
    pub fn masses(&mut self, robot: &Robot) -> Masses {
        let mut part = || PartIndex(self.rng.random_range(0..robot.parts.len() as u32));
        let mut parts = vec![part(), part(), part()];
        parts.sort_unstable_by_key(|part| part.0);
        parts.dedup();
        Masses::of_parts(robot, &parts).unwrap()
    }

    pub fn balance(&mut self, robot: &Robot, kinds: [Row; 3]) -> CentreOfMass {
        let rows = kinds.map(|row| {
            let normal = self.vector(1.0).normalize();
            PlaneRow { normal, offset: self.rng.random_range(-0.3..0.3), row }
        });
        let reference = Reference::Argument(0);
        CentreOfMass { masses: self.masses(robot), frame: self.frame(robot), rows: rows.to_vec(), reference }
    }

    pub fn between(&mut self, robot: &Robot, height: Option<f64>) -> CentreOfMassBetween {
        let (first, second) = (self.frame(robot), self.frame(robot));
        CentreOfMassBetween { masses: self.masses(robot), first, second, height }
    }

    pub fn distance(&mut self, robot: &Robot, row: Row, at_most: bool) -> Distance {
        Distance { a: self.frame(robot), b: self.frame(robot), length: self.rng.random_range(0.2..1.5), row, at_most }
    }

    pub fn gaze(&mut self, robot: &Robot) -> Custom {
        Custom(Arc::new(Gaze { frames: [self.frame(robot), self.frame(robot)] }))
    }
}

/// The z axis of one frame points away from the other's origin by more than 1 m: s = z·(p₂ − p₁) ≥ 1, and its x axis is
/// level. A function with frames that turn, whose second derivatives are bounded while the frames are within 10 m.
#[derive(Debug)]
pub struct Gaze {
    pub frames: [Frame; 2],
}

impl Function for Gaze {
    fn name(&self) -> &str {
        "gaze"
    }

    fn frames(&self) -> &[Frame] {
        &self.frames
    }

    fn rows(&self) -> &[Row] {
        &[Row::Inequality, Row::Zero]
    }

    fn value(&self, X_WF: &[Pose], values: &mut [f64]) {
        let axis = X_WF[0].rotation * DVec3::Z;
        values[0] = axis.dot(X_WF[1].translation - X_WF[0].translation) - 1.0;
        values[1] = (X_WF[0].rotation * DVec3::X).z;
    }

    fn gradient(&self, X_WF: &[Pose], gradients: &mut [Gradient]) {
        let axis = X_WF[0].rotation * DVec3::Z;
        let apart = X_WF[1].translation - X_WF[0].translation;
        gradients[0] = Gradient { linear: -axis, angular: axis.cross(apart) };
        gradients[1] = Gradient { linear: axis, angular: DVec3::ZERO };
        let level = X_WF[0].rotation * DVec3::X;
        gradients[2] = Gradient { linear: DVec3::ZERO, angular: level.cross(DVec3::Z) };
        gradients[3] = Gradient::default();
    }

    /// s″ = z″·d + 2z′·d′ + z·d″ with |d| ≤ 10, |z′| ≤ |ω|, |z″| ≤ |α| + |ω|².
    fn curvature(&self) -> Option<Curvature> {
        Some(Curvature { lipschitz: 10.0, bend: 10.0 })
    }
}

/// The sample humanoid flies as `human` from a tilted place, within so much of it along each axis.
pub fn flying_human(bound: f64) -> PartPlacement {
    let tilted = Pose::from_parts(DVec3::new(0.3, -0.2, 0.5), exp_so3(DVec3::new(0.4, -0.3, 0.9)));
    PartPlacement {
        root_bounds: vec![(-bound, bound); 3],
        ..models::part("human", PartKind::Robot, RootJoint::FreeFlyer, tilted)
    }
}

/// The `human` stands with bent knees and elbows.
pub fn bent_knees(robot: &Robot) -> Vec<f64> {
    let mut q = robot.space.neutral();
    for side in ["l", "r"] {
        for (joint, value) in [("hip_pitch", -0.4), ("knee", 0.8), ("ankle_pitch", -0.4), ("elbow", -1.0)] {
            let joint = robot.joint(&format!("human/{side}_{joint}")).unwrap();
            let Source::Coordinates { q: at, .. } = robot.joints[joint.at()].source else { unreachable!() };
            q[at] = value;
        }
    }
    q
}
