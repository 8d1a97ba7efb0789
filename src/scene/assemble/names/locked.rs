//! `[locked]`: joints that never move, at values of their own or where the start has them.

use crate::scene::assemble::names::configuration::{has_number, joint_of_several};
use crate::scene::reading::error::{SceneError, did_you_mean};
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::problem::RestingJoint;
use foliate_components::robot::{JointIndex, PartIndex, Robot, Source};

/// What `[locked]` says, before the start is known.
#[derive(Default)]
pub(crate) struct Locks {
    /// Joints with values.
    pub at_values: Vec<(JointIndex, f64)>,
    /// Joints that stay where the start has them.
    joints: Vec<JointIndex>,
    /// Parts of which all joints do, but those that have a say elsewhere.
    parts: Vec<PartIndex>,
}

pub(crate) fn read(keys: &mut Keys<'_>, robot: &Robot) -> Result<Locks, SceneError> {
    let mut locks = Locks::default();
    let Some(item) = keys.optional("locked") else { return Ok(locks) };
    for (name, item) in item.keys()?.entries() {
        if joint_of_several(name, robot).is_some() {
            // Its bounds are equal already.
            continue;
        }
        match (item.is_string(), robot.part(name)) {
            (true, Some(part)) => {
                start_word(&item)?;
                locks.parts.push(part);
            }
            (true, None) => {
                let joint = scalar_joint(&item, name, robot)?;
                start_word(&item)?;
                locks.joints.push(joint);
            }
            (false, Some(_)) => {
                let hint = format!("`\"{name}\" = \"start\"` locks all joints of the part where the start has them");
                return Err(item.error("is a part").hint(hint));
            }
            (false, None) => locks.at_values.push((scalar_joint(&item, name, robot)?, item.number()?)),
        }
    }
    Ok(locks)
}

fn start_word(item: &Item<'_>) -> Result<(), SceneError> {
    match item.string()? {
        "start" => Ok(()),
        word => Err(item.error("wants a number or \"start\"").hint(did_you_mean(word, ["start"]))),
    }
}

impl Locks {
    /// Whether a joint is locked by its own name.
    pub fn names(&self, joint: JointIndex) -> bool {
        self.joints.contains(&joint) || self.at_values.iter().any(|(j, _)| *j == joint)
    }

    /// All locked joints with their values. A resting joint is none of them: it moves when it is held.
    pub fn at_start(&self, robot: &Robot, start: &[f64], resting: &[RestingJoint]) -> Vec<(JointIndex, f64)> {
        let mut locked = self.at_values.clone();
        let of_parts = self.parts.iter().flat_map(|part| robot.parts[part.at()].joints.clone());
        let of_parts = of_parts.map(|j| JointIndex(j as u32)).filter(|j| has_number(&robot.joints[j.at()]));
        let moves = |joint: &JointIndex| resting.iter().any(|r| r.joint == *joint);
        for joint in self.joints.iter().copied().chain(of_parts.filter(|j| !moves(j))) {
            let Source::Coordinates { q, .. } = robot.joints[joint.at()].source else { continue };
            if !locked.iter().any(|(j, _)| *j == joint) {
                locked.push((joint, start[q]));
            }
        }
        locked
    }
}

/// The joint of one coordinate of its own that has this name.
pub(crate) fn scalar_joint(item: &Item<'_>, name: &str, robot: &Robot) -> Result<JointIndex, SceneError> {
    let known = || robot.joints.iter().filter(|j| has_number(j)).map(|j| j.name.as_str());
    robot.joint(name).filter(|j| has_number(&robot.joints[j.at()])).ok_or_else(|| {
        item.error("there is no joint with one coordinate of this name").hint(did_you_mean(name, known()))
    })
}

/// A number within a joint's bounds.
pub(crate) fn within(item: &Item<'_>, joint: JointIndex, robot: &Robot) -> Result<f64, SceneError> {
    let (value, joint) = (item.number()?, &robot.joints[joint.at()]);
    match (joint.lower.first(), joint.upper.first()) {
        (Some(low), Some(high)) if !(low..=high).contains(&&value) => {
            Err(item.error(format!("{value} is outside the bounds of `{}`, [{low}, {high}]", joint.name)))
        }
        _ => Ok(value),
    }
}
