//! Positions, velocities and accelerations of joints, by name.

use crate::planner::trajectory::error::TrajectoryError;
use crate::planner::trajectory::sample_times::SampleTimes;
use crate::planner::trajectory::trajectory::Trajectory;
use foliate_components::robot::{Joint, JointIndex, PartKind, Source};

/// Some joints of a trajectory, in an order: revolute and prismatic ones, those that mimic others included.
#[derive(Clone, Debug)]
pub struct JointSelection<'t> {
    trajectory: &'t Trajectory<'t>,
    names: Vec<&'t str>,
    joints: Vec<JointIndex>,
    values: Vec<Value>,
}

/// Where a joint's number comes from: multiplier · coordinate + offset.
#[derive(Clone, Copy, Debug)]
struct Value {
    coordinate: usize,
    multiplier: f64,
    offset: f64,
}

/// What joints do at a time, in the order of their selection.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointSample {
    /// Seconds.
    pub time: f64,
    /// Radians or metres.
    pub positions: Vec<f64>,
    /// rad/s or m/s.
    pub velocities: Vec<f64>,
    /// rad/s² or m/s². Between two knots they are linear in time; at a knot this is the one of the piece that begins there, at the end that of
    /// the last piece.
    pub accelerations: Vec<f64>,
}

impl<'a> Trajectory<'a> {
    /// Names of a robot's joints of one coordinate, `part/joint`, those that mimic others included, in the order of the robot's
    /// coordinates (depth first, pinocchio's order).
    ///
    /// # Errors
    /// There is no robot of that name.
    pub fn joint_names(&self, robot: &str) -> Result<Vec<&'a str>, TrajectoryError> {
        let joints = &self.robot.joints;
        Ok(self.joints_of_part(robot)?.into_iter().map(|j| joints[j.at()].name.as_str()).collect())
    }

    /// All joints of a robot: [`Self::joint_names`].
    ///
    /// # Errors
    /// There is no robot of that name.
    pub fn joints_of(&self, robot: &str) -> Result<JointSelection<'_>, TrajectoryError> {
        Ok(self.selected(self.joints_of_part(robot)?))
    }

    /// Joints by their names, `part/joint`, or the bare name of a joint that only one part has; in the order in which they are given.
    ///
    /// # Errors
    /// There is no joint of that name that has one coordinate, or several parts have it.
    pub fn joints(&self, names: &[&str]) -> Result<JointSelection<'_>, TrajectoryError> {
        let joints: Result<Vec<JointIndex>, TrajectoryError> = names.iter().map(|name| self.joint(name)).collect();
        Ok(self.selected(joints?))
    }

    fn selected(&self, joints: Vec<JointIndex>) -> JointSelection<'_> {
        let all = &self.robot.joints;
        let value = |&joint: &JointIndex| match all[joint.at()].source {
            Source::Coordinates { q, .. } => Value { coordinate: q, multiplier: 1.0, offset: 0.0 },
            Source::Follows { leader, multiplier, offset } => {
                // A leader follows no joint.
                let Source::Coordinates { q, .. } = all[leader.at()].source else {
                    return Value { coordinate: 0, multiplier: 0.0, offset };
                };
                Value { coordinate: q, multiplier, offset }
            }
        };
        JointSelection {
            trajectory: self,
            names: joints.iter().map(|j| all[j.at()].name.as_str()).collect(),
            values: joints.iter().map(value).collect(),
            joints,
        }
    }

    fn joints_of_part(&self, name: &str) -> Result<Vec<JointIndex>, TrajectoryError> {
        let part = self.robot.parts.iter().find(|part| part.name == name && part.kind == PartKind::Robot);
        let part = part.ok_or_else(|| TrajectoryError::unknown("robot", name, self.robots()))?;
        let joints = part.joints.clone().filter(|&index| is_scalar(&self.robot.joints[index]));
        Ok(joints.map(|index| JointIndex(index as u32)).collect())
    }

    fn joint(&self, name: &str) -> Result<JointIndex, TrajectoryError> {
        let bare = |joint: &Joint| joint.name.rsplit('/').next() == Some(name);
        let is_meant = |joint: &Joint| is_scalar(joint) && (joint.name == name || bare(joint));
        let all = || (0_u32..).zip(&self.robot.joints);
        if let Some((index, _)) = all().find(|(_, joint)| is_scalar(joint) && joint.name == name) {
            return Ok(JointIndex(index));
        }
        let meant: Vec<(u32, &Joint)> = all().filter(|(_, joint)| is_meant(joint)).collect();
        match meant.as_slice() {
            [(index, _)] => Ok(JointIndex(*index)),
            [] => {
                let known = self.robot.joints.iter().filter(|j| is_scalar(j)).map(|j| j.name.as_str());
                Err(TrajectoryError::unknown("joint of one coordinate", name, known))
            }
            several => {
                let names: Vec<&str> = several.iter().map(|(_, joint)| joint.name.as_str()).collect();
                let hint = format!("several parts have it: {}", names.join(", "));
                Err(TrajectoryError::Unknown { what: "one joint", name: name.to_owned(), hint })
            }
        }
    }
}

fn is_scalar(joint: &Joint) -> bool {
    joint.motion.configuration_size() == 1
}

impl<'t> JointSelection<'t> {
    /// Names of the joints, `part/joint`.
    #[must_use]
    pub fn names(&self) -> &[&'t str] {
        &self.names
    }

    /// The joints in the robot.
    #[must_use]
    pub fn indices(&self) -> &[JointIndex] {
        &self.joints
    }

    /// What the joints do at a time.
    #[must_use]
    pub fn at(&self, time: f64) -> JointSample {
        let mut sample = JointSample::default();
        self.sample_into(time, &mut sample);
        sample
    }

    /// As [`Self::at`], into a sample that was there before: without allocation once it has the right size.
    pub fn sample_into(&self, time: f64, sample: &mut JointSample) {
        let moment = self.trajectory.moment(time);
        let JointSample { time: at, positions, velocities, accelerations } = sample;
        *at = time.max(self.trajectory.start()).min(self.trajectory.end());
        [&mut *positions, &mut *velocities, &mut *accelerations].into_iter().for_each(Vec::clear);
        for value in &self.values {
            let [position, velocity, acceleration] = moment.piece.number(value.coordinate);
            positions.push(value.multiplier * position + value.offset);
            velocities.push(value.multiplier * velocity);
            accelerations.push(value.multiplier * acceleration);
        }
    }

    /// Samples at a rate (per second), see [`Trajectory::sample_times`]: the last one is exactly at the end.
    ///
    /// # Errors
    /// The rate is not positive and finite, or gives more than ten million samples.
    pub fn sampled(&self, rate: f64) -> Result<impl Iterator<Item = JointSample> + '_, TrajectoryError> {
        let times: SampleTimes = self.trajectory.sample_times(rate)?;
        Ok(times.map(|time| self.at(time)))
    }
}
