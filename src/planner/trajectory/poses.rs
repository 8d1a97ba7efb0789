//! Where links and objects are at a time.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::planner::trajectory::error::TrajectoryError;
use crate::planner::trajectory::trajectory::Trajectory;
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, LinkIndex, PartIndex};
use foliate_kernels::kinematics::RigidAttachment;

/// Everything placed at one time after the other. It does not allocate once it is made.
#[derive(Clone, Debug)]
pub struct Poses<'t> {
    trajectory: &'t Trajectory<'t>,
    time: f64,
    q: Vec<f64>,
    X_WJ: Vec<Pose>,
    carried: Vec<RigidAttachment>,
}

impl<'a> Trajectory<'a> {
    /// Everything placed at the start, and then wherever [`Poses::place`] says.
    #[must_use]
    pub fn poses(&self) -> Poses<'_> {
        let most = self.carried.iter().map(Vec::len).max().unwrap_or(0);
        let mut poses = Poses {
            trajectory: self,
            time: self.start(),
            q: self.robot.space.neutral(),
            X_WJ: vec![Pose::identity(); self.kinematics.bodies()],
            carried: Vec::with_capacity(most),
        };
        poses.place(self.start());
        poses
    }

    /// Pose in the world of a link (`part/link`) or of a part's root link (`part`) at a time. Objects follow what carries them.
    ///
    /// For many links or times use [`Self::poses`].
    ///
    /// # Errors
    /// There is no such link or part.
    pub fn pose(&self, name: &str, time: f64) -> Result<Pose, TrajectoryError> {
        let link = self.link(name)?;
        let mut poses = self.poses();
        poses.place(time);
        Ok(poses.link(link))
    }

    /// The link `part/link`, or the root link of a part.
    ///
    /// # Errors
    /// There is no such link or part.
    pub fn link(&self, name: &str) -> Result<LinkIndex, TrajectoryError> {
        let part = || self.robot.part(name).map(|part| self.robot.parts[part.at()].root_link);
        self.robot.link(name).or_else(part).ok_or_else(|| {
            let parts = self.robot.parts.iter().map(|part| part.name.as_str());
            TrajectoryError::unknown("part, nor link `part/link`,", name, parts)
        })
    }

    /// The whole configuration at a time, in the order of the robot's coordinates, objects where they are.
    #[must_use]
    pub fn configuration(&self, time: f64) -> Vec<f64> {
        let mut poses = self.poses();
        poses.place(time);
        poses.q
    }
}

impl Poses<'_> {
    /// Places everything at a time.
    pub fn place(&mut self, time: f64) {
        let Self { trajectory, q, X_WJ, carried, .. } = self;
        self.time = time;
        let moment = trajectory.moment(time);
        trajectory.write(&moment, q);
        trajectory.kinematics.forward(q, X_WJ);
        carried.clear();
        carried.extend(trajectory.carried[moment.segment].iter().map(|follow| {
            // Where the held body is no root, the object's own joints are between the two.
            let X_HO = X_WJ[follow.held.at()].inverse() * X_WJ[follow.object.at()];
            let X_CO = match follow.held == follow.object {
                true => follow.carrier_from_held,
                false => follow.carrier_from_held * X_HO,
            };
            RigidAttachment { object: follow.object, carrier: follow.carrier, X_CO }
        }));
        trajectory.kinematics.carry(q, carried, X_WJ);
        trajectory.kinematics.write_back(carried, X_WJ, q);
    }

    /// The time at which everything is placed, seconds.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The whole configuration, objects where they are.
    #[must_use]
    pub fn configuration(&self) -> &[f64] {
        &self.q
    }

    /// Poses of all bodies in the world.
    pub(crate) fn bodies(&self) -> &[Pose] {
        &self.X_WJ
    }

    /// Pose of a body in the world: the joint's frame after its motion.
    ///
    /// # Panics
    /// If there is no such joint.
    #[must_use]
    pub fn body(&self, joint: JointIndex) -> Pose {
        self.X_WJ[joint.at()]
    }

    /// Pose of a link in the world.
    ///
    /// # Panics
    /// If there is no such link.
    #[must_use]
    pub fn link(&self, link: LinkIndex) -> Pose {
        let link = &self.trajectory.robot.links[link.at()];
        link.joint.map_or(link.joint_from_link, |joint| self.X_WJ[joint.at()] * link.joint_from_link)
    }

    /// Pose of a part's root link in the world.
    ///
    /// # Panics
    /// If there is no such part.
    #[must_use]
    pub fn part(&self, part: PartIndex) -> Pose {
        self.link(self.trajectory.robot.parts[part.at()].root_link)
    }
}
