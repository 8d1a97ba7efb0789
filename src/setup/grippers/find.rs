//! The grippers of a robot: by its joints, or by names.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::error::SetupError;
use crate::setup::grippers::bodies::is_beyond;
use crate::setup::grippers::hand::FoundGripper;
use crate::setup::grippers::{jaws, tools};
use foliate_components::Pose;
use foliate_components::robot::model::EndEffectorModel;
use foliate_components::robot::{JointIndex, LinkIndex, Robot};
use foliate_kernels::collision::{CollisionScene, PairRule, Solid};

/// The grippers of a robot: those called by `names` (links: a tool frame, or any link of a hand), or else its end effectors, or else all
/// hands that have jaws. An end effector is the hand whose links are in its group, or a tool on the link that carries it.
///
/// A hand has two or more short chains of joints that begin at one body, move against each other and have shapes. Its approach leads
/// from the joints of the fingers to their tips; a frame of a link within 15 degrees of that gives the exact direction.
///
/// # Errors
/// A name that is no link; a robot in which nothing is found.
pub fn grippers(
    robot: &Robot,
    names: &[String],
    end_effectors: &[EndEffectorModel],
) -> Result<Vec<FoundGripper>, SetupError> {
    let mut found = hands(robot);
    if !names.is_empty() {
        let all = std::mem::take(&mut found);
        for name in names {
            found.push(named(robot, &all, name)?);
        }
        found.dedup_by(|a, b| (a.link, a.kind) == (b.link, b.kind));
        rename(robot, &mut found);
    } else if !end_effectors.is_empty() {
        found = of_end_effectors(robot, &found, end_effectors);
    }
    if found.is_empty() {
        return Err(SetupError::NoGripper { links: outermost(robot) });
    }
    Ok(found.into_iter().map(|gripper| with_solids(robot, gripper)).collect())
}

/// A gripper, with what grasps are tested against.
pub(super) fn with_solids(robot: &Robot, gripper: FoundGripper) -> FoundGripper {
    let scene = CollisionScene::new(robot, &PairRule::default());
    FoundGripper { solids: solids_of(robot, &scene, &gripper), ..gripper }
}

/// The hands with two jaws of a robot, without what grasps are tested against.
#[must_use]
pub fn hands(robot: &Robot) -> Vec<FoundGripper> {
    let mut found = jaws::jaws(robot);
    rename(robot, &mut found);
    found
}

/// Names grippers after their links, where there are several.
fn rename(robot: &Robot, found: &mut [FoundGripper]) {
    let count = found.len();
    for gripper in found {
        let link = robot.links[gripper.link.at()].name.as_str();
        let own = link.split_once('/').map_or(link, |(_, own)| own);
        gripper.name = if count == 1 { "gripper".into() } else { format!("{own}_gripper") };
    }
}

/// The end effectors, called as they are.
fn of_end_effectors(robot: &Robot, hands: &[FoundGripper], effectors: &[EndEffectorModel]) -> Vec<FoundGripper> {
    let part = robot.parts.first().map_or("", |part| part.name.as_str());
    let number = |link: &String| robot.link(&format!("{part}/{link}"));
    let mut found: Vec<FoundGripper> = Vec::new();
    for effector in effectors {
        let links: Vec<LinkIndex> = effector.links.iter().filter_map(number).collect();
        let is_own = |hand: &&FoundGripper| {
            let is_finger = |link: &LinkIndex| {
                let body = robot.links[link.at()].joint;
                body != robot.links[hand.link.at()].joint && hand.moves(robot, body)
            };
            links.contains(&hand.link) || links.iter().any(is_finger)
        };
        let gripper = match (hands.iter().find(is_own), number(&effector.parent_link)) {
            (Some(hand), _) => hand.clone(),
            (None, Some(link)) => tools::tool(robot, link, None),
            (None, None) => continue,
        };
        // One hand may be in several groups.
        if found.iter().any(|other| (other.link, other.kind) == (gripper.link, gripper.kind)) {
            continue;
        }
        let is_link = robot.link(&format!("{part}/{}", effector.name)).is_some();
        let name = if is_link { format!("{}_gripper", effector.name) } else { effector.name.clone() };
        let reason = format!("end effector `{}` of the SRDF, {}", effector.name, gripper.reason);
        found.push(FoundGripper { name, reason, ..gripper });
    }
    found
}

/// The hand that a link belongs to, or a tool on the link.
fn named(robot: &Robot, hands: &[FoundGripper], name: &str) -> Result<FoundGripper, SetupError> {
    let own = |link: usize| robot.links[link].name.split_once('/').map_or("", |(_, own)| own);
    let (plain, axis) = tools::axis_of(name);
    let link = (0..robot.links.len()).find(|&link| own(link) == plain);
    let link = LinkIndex(link.ok_or_else(|| SetupError::NoLink {
        name: plain.to_owned(),
        known: (0..robot.links.len()).map(|link| own(link).to_owned()).collect(),
    })? as u32);
    let body = robot.links[link.at()].joint;
    let holds = |hand: &&FoundGripper| body.is_some() && is_beyond(robot, body, robot.links[hand.link.at()].joint);
    match hands.iter().find(holds) {
        Some(hand) if axis.is_none() => Ok(hand.clone()),
        _ => Ok(tools::tool(robot, link, axis)),
    }
}

/// The links that carry no other: where a tool would be.
fn outermost(robot: &Robot) -> Vec<String> {
    let carries = |link: usize| robot.links.iter().any(|other| other.parent == Some(LinkIndex(link as u32)));
    let own = |link: usize| robot.links[link].name.split_once('/').map_or("", |(_, own)| own).to_owned();
    (0..robot.links.len()).filter(|&link| !carries(link) && robot.links[link].joint.is_some()).map(own).collect()
}

/// The solids of the body that carries a gripper and of all beyond it, where its fingers are open, in its frame.
fn solids_of(robot: &Robot, scene: &CollisionScene, gripper: &FoundGripper) -> Vec<(Pose, Solid)> {
    let X_WJ = gripper.poses(robot, 0.0);
    let link = &robot.links[gripper.link.at()];
    let X_WG = gripper.in_world(robot, &X_WJ);
    let is_hand = |body: Option<JointIndex>| link.joint.is_some() && is_beyond(robot, body, link.joint);
    let solids = scene.solids().iter().filter(|solid| is_hand(solid.body));
    solids
        .map(|solid| {
            let X_WB = solid.body.map_or(Pose::IDENTITY, |body| X_WJ[body.at()]);
            (X_WG.inverse() * X_WB * solid.X_JS, solid.solid.clone())
        })
        .collect()
}
