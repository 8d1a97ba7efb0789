//! Humanoids on both feet, in balance: what some benches put to the test.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::{random_configurations, skipped};
use foliate::scene::{PackagePath, UpAxis, read_model};
use foliate_components::Pose;
use foliate_components::constraint::{CentreOfMass, Constraint, Frame, Masses, PlaneRow, Reference, RelativePose, Row};
use foliate_components::robot::model::Model as RobotModel;
use foliate_components::robot::{PartIndex, PartKind, PartPlacement, Robot, RootJoint, Source};
use foliate_components::samples::models as sample_models;
use foliate_kernels::constrained_motion::{ConstraintProgram, Scratch, Settings, project};
use foliate_kernels::constraints::{centre_of_mass, placement_of};
use foliate_kernels::kinematics::Kinematics;
use glam::DVec3;

/// Configurations of a humanoid; a multiple of the lanes.
pub const BALANCED: usize = 256;

/// A humanoid that stands: the sample in code, or a published one.
#[derive(Debug)]
pub struct Humanoid {
    /// Of the rows that it gives.
    pub name: &'static str,
    /// The robot alone.
    pub robot: Robot,
    standing: Vec<f64>,
    ankles: [Frame; 2],
    hand: Frame,
}

impl Humanoid {
    fn new(name: &'static str, model: &RobotModel, ankles: [&str; 2], hand: &str, bent: &[(&str, f64)]) -> Self {
        let placement = PartPlacement {
            root_bounds: vec![(-1.0, 1.0); 3],
            ..sample_models::part("human", PartKind::Robot, RootJoint::FreeFlyer, Pose::identity())
        };
        let robot = Robot::compose(&[(model, placement)]).unwrap();
        let frame = |joint: &str| Frame::of_joint(robot.joint(&format!("human/{joint}")).unwrap());
        let (ankles, hand) = (ankles.map(frame), frame(hand));
        let mut standing = robot.space.neutral();
        for (joint, value) in bent {
            let joint = &robot.joints[robot.joint(&format!("human/{joint}")).unwrap().at()];
            let Source::Coordinates { q, .. } = joint.source else { continue };
            standing[q] = *value;
        }
        Self { name, robot, standing, ankles, hand }
    }

    /// The sample in code.
    #[must_use]
    pub fn sample() -> Self {
        let bent =
            [("hip_pitch", -0.4), ("knee", 0.8), ("ankle_pitch", -0.4), ("shoulder_pitch", -0.4), ("elbow", -1.0)];
        let bent: Vec<_> = ["l", "r"].iter().flat_map(|s| bent.map(|(joint, x)| (format!("{s}_{joint}"), x))).collect();
        let bent: Vec<_> = bent.iter().map(|(joint, x)| (joint.as_str(), *x)).collect();
        Self::new("sample", &sample_models::humanoid(), ["l_ankle_roll", "r_ankle_roll"], "l_wrist_roll", &bent)
    }

    /// Talos; `None`, and said so, where the published robots are not at hand.
    #[must_use]
    pub fn talos() -> Option<Self> {
        let url = "package://example-robot-data/robots/talos_data/robots/talos_full_v2.urdf";
        let read = match read_model(url, None, UpAxis::AsWritten, &PackagePath::from_environment(&[])) {
            Ok(read) => read,
            Err(error) => {
                skipped("talos", &error.to_string());
                return None;
            }
        };
        let bent = [("3", -0.41), ("4", 0.86), ("5", -0.45)];
        let bent: Vec<_> =
            ["left", "right"].iter().flat_map(|s| bent.map(|(k, x)| (format!("leg_{s}_{k}_joint"), x))).collect();
        let mut bent: Vec<_> = bent.iter().map(|(joint, x)| (joint.as_str(), *x)).collect();
        bent.extend([("arm_left_4_joint", -0.5), ("arm_right_4_joint", -0.5)]);
        let ankles = ["leg_left_6_joint", "leg_right_6_joint"];
        Some(Self::new("talos", &read.model, ankles, "arm_left_7_joint", &bent))
    }

    /// Both feet where they stand, the centre of mass over them where it is, and, if it reaches, a hand at an argument: 15 rows or
    /// 21. Where the
    /// robot stands on a foot, its root and six of them are eliminated; a foot in two halves, place and turn, is none, so
    /// that what elimination saves can be measured.
    #[must_use]
    pub fn program(&self, kinematics: &Kinematics, stands: bool, reaches: bool) -> ConstraintProgram {
        let mut bodies = vec![Pose::identity(); kinematics.bodies()];
        kinematics.forward(&self.standing, &mut bodies);
        let world = Frame::world(Pose::identity());
        let foot = |frame: Frame| {
            let there = Reference::Fixed(placement_of(&frame).in_world(&bodies));
            let whole = RelativePose::rigid(world, frame, there);
            let half = |from: usize| {
                let rows = std::array::from_fn(|k| whole.rows[k].filter(|_| (from..from + 3).contains(&k)));
                Constraint::RelativePose(RelativePose { rows, ..whole })
            };
            if stands { vec![Constraint::RelativePose(whole)] } else { vec![half(0), half(3)] }
        };
        let masses = Masses::of_parts(&self.robot, &[PartIndex(0)]).unwrap();
        let plane = |normal| PlaneRow { normal, offset: 0.0, row: Row::Zero };
        let rows = DVec3::AXES.map(plane).to_vec();
        let mut balance = CentreOfMass { masses, frame: self.ankles[0], rows, reference: Reference::Identity };
        let center = centre_of_mass::in_frame(&balance, &bodies);
        balance.rows.iter_mut().for_each(|plane| plane.offset = plane.normal.dot(center));
        let hand = Constraint::RelativePose(RelativePose::rigid(world, self.hand, Reference::Argument(0)));
        let mut constraints = self.ankles.map(foot).concat();
        constraints.push(Constraint::CentreOfMass(balance));
        constraints.extend(reaches.then_some(hand));
        ConstraintProgram::compile(&self.robot, kinematics, &constraints, &[], &[]).unwrap()
    }

    /// [`BALANCED`] configurations that satisfy the program, a `share` of the way from standing to anywhere, and where their hands
    /// are.
    #[must_use]
    pub fn solutions(
        &self,
        kinematics: &Kinematics,
        program: &ConstraintProgram,
        share: f64,
    ) -> (Vec<Vec<f64>>, Vec<Pose>) {
        let (mut found, mut hands) = (Vec::new(), Vec::new());
        let (mut scratch, mut bodies) = (Scratch::default(), vec![Pose::identity(); kinematics.bodies()]);
        for random in random_configurations(&self.robot, 20 * BALANCED) {
            let mut q = self.standing.clone();
            self.robot.space.interpolate(&self.standing, &random, share, &mut q);
            kinematics.forward(&q, &mut bodies);
            let target = [placement_of(&self.hand).in_world(&bodies)];
            if found.len() < BALANCED
                && project(program, &mut q, &target, &Settings::default(), &mut scratch).is_converged()
            {
                found.push(q);
                hands.push(target[0]);
            }
        }
        assert_eq!(found.len(), BALANCED, "{}: too few reach so far", self.name);
        (found, hands)
    }
}
