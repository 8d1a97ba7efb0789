//! Joints that lead others move only where every follower keeps its own limits.

use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::{JointIndex, PartIndex};
use crate::robot::joint::Source;
use crate::robot::limits::{NarrowedLimits, NoRoom, SAME};

impl Robot {
    /// Narrows the bounds of a part's leaders to where all their followers keep their own.
    pub(crate) fn narrow_leaders(&mut self, part: PartIndex) -> Result<(), NoRoom> {
        for index in self.parts[part.at()].joints.clone() {
            let follower = JointIndex(index as u32);
            let Source::Follows { leader, multiplier, offset } = self.joints[index].source else { continue };
            let limits = (self.joints[index].lower[0], self.joints[index].upper[0]);
            let allowed = allowed(limits, multiplier, offset);
            let range = (self.joints[leader.at()].lower[0], self.joints[leader.at()].upper[0]);
            // What differs by rounding alone leaves the leader its own.
            let mut left = (
                if allowed.0 > range.0 + SAME { allowed.0 } else { range.0 },
                if allowed.1 < range.1 - SAME { allowed.1 } else { range.1 },
            );
            // Written so that NaN leaves no room.
            let fits = left.1 - left.0 >= -SAME;
            if !fits {
                let name = |joint: JointIndex| {
                    let name = &self.joints[joint.at()].name;
                    name.split_once('/').map_or(name.as_str(), |(_, own)| own).to_owned()
                };
                let (leader, follower) = (name(leader), name(follower));
                return Err(NoRoom { leader, range, follower, follower_range: limits, allowed });
            }
            if left.0 > left.1 {
                let middle = 0.5 * (left.0 + left.1);
                left = (middle, middle);
            }
            if left != range {
                let joint = &mut self.joints[leader.at()];
                (joint.lower[0], joint.upper[0]) = left;
                self.note_narrowed(leader, follower, range, left);
            }
        }
        Ok(())
    }

    fn note_narrowed(&mut self, leader: JointIndex, follower: JointIndex, own: (f64, f64), left: (f64, f64)) {
        match self.narrowed.iter_mut().find(|n| n.leader == leader) {
            Some(known) => {
                known.followers.push(follower);
                known.left = left;
            }
            None => self.narrowed.push(NarrowedLimits { leader, followers: vec![follower], own, left }),
        }
    }
}

/// The leader's values at which a follower, `multiplier` · leader + `offset`, is within limits.
fn allowed((low, high): (f64, f64), multiplier: f64, offset: f64) -> (f64, f64) {
    if multiplier == 0.0 {
        let holds = offset >= low - SAME && offset <= high + SAME;
        return if holds { (f64::NEG_INFINITY, f64::INFINITY) } else { (f64::INFINITY, f64::NEG_INFINITY) };
    }
    let (a, b) = ((low - offset) / multiplier, (high - offset) / multiplier);
    (a.min(b), a.max(b))
}

#[cfg(test)]
mod tests {
    use crate::pose::Pose;
    use crate::robot::configuration::Group;
    use crate::robot::hybrid_robot::Robot;

    use crate::robot::error::ComposeError;
    use crate::robot::joint::PartPlacement;
    use crate::robot::model::part_model::{JointKind, JointModel, LinkModel, Model};
    use crate::samples::models::fixed_robot;
    use glam::DVec3;

    /// A leader, and followers with multiplier, offset and limits, side by side on one base.
    fn hand(leader: (JointKind, f64, f64), followers: &[(f64, f64, f64, f64)]) -> Model {
        let joint = |number: usize, kind, limits, mimic| JointModel {
            name: format!("j{number}"),
            kind,
            parent: 0,
            child: number + 1,
            parent_from_joint: Pose::identity(),
            axis: DVec3::Z,
            limits,
            velocity_limit: None,
            mimic,
        };
        let mut joints = vec![joint(0, leader.0, (leader.1, leader.2), None)];
        joints.extend(followers.iter().enumerate().map(|(number, &(multiplier, offset, low, high))| {
            joint(number + 1, leader.0, (low, high), Some(("j0".into(), multiplier, offset)))
        }));
        let links = (0..=joints.len()).map(|i| LinkModel { name: format!("l{i}"), ..LinkModel::default() });
        Model { links: links.collect(), joints, ..Model::default() }
    }

    fn composed(model: &Model, placement: PartPlacement) -> Result<Robot, ComposeError> {
        Robot::compose(&[(model, placement)])
    }

    fn fixed() -> PartPlacement {
        fixed_robot("hand", Pose::identity())
    }

    #[test]
    fn a_leader_keeps_to_where_all_followers_keep_their_limits() {
        let followers = [(1.0, 0.0, 0.0, 0.03), (-2.0, 0.1, 0.06, 1.0)];
        let robot = composed(&hand((JointKind::Prismatic, 0.0, 0.04), &followers), fixed()).expect("there is room");
        assert!(robot.space.lower[0] == 0.0 && (robot.space.upper[0] - 0.02).abs() < 1e-15);
        let narrowed = &robot.narrowed[0];
        assert_eq!((narrowed.own, narrowed.left.1, narrowed.followers.len()), ((0.0, 0.04), robot.space.upper[0], 2));
        assert!(!narrowed.is_suspicious());
    }

    #[test]
    fn one_value_or_less_than_half_is_suspicious_and_nothing_is_an_error() {
        let with =
            |followers: &[(f64, f64, f64, f64)]| composed(&hand((JointKind::Prismatic, 0.0, 0.04), followers), fixed());
        let one = with(&[(-1.0, 0.0, 0.0, 0.04)]).expect("zero is left");
        assert_eq!((one.space.lower[0], one.space.upper[0]), (0.0, 0.0));
        assert!(one.narrowed[0].is_suspicious() && one.joints[0].is_immovable());
        assert!(with(&[(1.0, 0.0, 0.0, 0.01)]).expect("a quarter is left").narrowed[0].is_suspicious());
        assert!(with(&[(1.0, 0.0, 0.0, 0.04)]).expect("all is left").narrowed.is_empty());
        let Err(ComposeError::NoRoom { room, .. }) = with(&[(1.0, 0.0, 0.05, 0.06)]) else { panic!("there is none") };
        assert_eq!((room.range, room.follower_range), ((0.0, 0.04), (0.05, 0.06)));
        // What does not follow at all stands at its offset.
        assert!(with(&[(0.0, 0.02, 0.0, 0.04)]).expect("stands within").narrowed.is_empty());
        assert!(with(&[(0.0, 0.5, 0.0, 0.04)]).is_err());
    }

    #[test]
    fn a_leader_without_limits_has_those_of_its_followers() {
        let robot = composed(&hand((JointKind::Continuous, f64::NEG_INFINITY, f64::INFINITY), &[]), fixed());
        assert_eq!(robot.expect("composes").space.factors[0].group, Group::Circle);
        let mut model = hand((JointKind::Continuous, f64::NEG_INFINITY, f64::INFINITY), &[(2.0, 0.0, -1.0, 1.0)]);
        model.joints[1].kind = JointKind::Revolute;
        let robot = composed(&model, fixed()).expect("composes");
        assert_eq!((robot.space.factors[0].group, robot.space.upper[0]), (Group::Real, 0.5));
    }

    #[test]
    fn who_does_not_follow_narrows_nothing() {
        let model = hand((JointKind::Prismatic, 0.0, 0.04), &[(1.0, 0.0, 0.05, 0.06)]);
        let robot = composed(&model, PartPlacement { mimic_follows: false, ..fixed() }).expect("free");
        assert!(robot.narrowed.is_empty());
    }
}
