//! What a setup finds in a model: where links and grippers are, which links touch.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::components::Pose;
use crate::components::pose::pose_to_array;
use crate::components::robot::model::Model;
use crate::components::robot::{LinkIndex, Robot};
use crate::kernels::kinematics::Kinematics;
use crate::setup::collision_matrix::{CollisionMatrix, PairReason};
use crate::setup::grippers::FoundGripper;
use serde_json::{Value, json};
use std::fmt::Write;

/// The links in the world where all joints are at zero, or at the bound nearest to it, and the root is at the origin.
fn link_poses(robot: &Robot) -> Vec<(&str, Pose)> {
    let mut q = robot.space.neutral();
    robot.space.clamp(&mut q);
    let kinematics = Kinematics::new(robot);
    let X_WJ = kinematics.poses(&q);
    let pose = |link: &crate::components::robot::Link| {
        link.joint.map_or(Pose::IDENTITY, |body| X_WJ[body.at()]) * link.joint_from_link
    };
    robot.links.iter().map(|link| (own(&link.name), pose(link))).collect()
}

/// A name without its part.
fn own(name: &str) -> &str {
    name.split_once('/').map_or(name, |(_, own)| own)
}

/// x y z qx qy qz qw on one line.
fn numbers(pose: &Pose) -> String {
    let numbers: Vec<String> = pose_to_array(pose).iter().map(|x| format!("{:.4}", x + 0.0)).collect();
    numbers.join(" ")
}

/// Writes where links and grippers are.
pub(super) fn poses(model: &Model, robot: &Robot, found: &[FoundGripper], out: &mut String) {
    let poses = link_poses(robot);
    let _ = writeln!(out, "\nPoses of links at the default configuration (x y z qx qy qz qw, from the root)");
    for (name, pose) in &poses {
        let _ = writeln!(out, "  {name}: {}", numbers(pose));
    }
    if model.grippers.is_empty() && found.is_empty() {
        let _ = writeln!(out, "Grippers: none is documented, and none is found by its joints");
        return;
    }
    let _ = writeln!(out, "Poses of grippers (in their link; x approaches)");
    for gripper in &model.grippers {
        let _ = writeln!(out, "  {} on {}: {}", gripper.name, gripper.link, numbers(&gripper.link_from_gripper));
    }
    for gripper in found {
        let link = own(&robot.links[gripper.link.at()].name);
        let _ = writeln!(out, "  found on {link}: {}; {}", numbers(&gripper.link_from_gripper), gripper.reason);
    }
}

/// Writes the table of links that touch, and what a scene would leave out.
pub(super) fn matrix(robot: &Robot, matrix: &CollisionMatrix, out: &mut String) {
    let name = |link: LinkIndex| own(&robot.links[link.at()].name);
    let _ = writeln!(
        out,
        "\nCollision matrix ({} random configurations): pair, share of them in which it touches, reason",
        matrix.samples
    );
    for pair in matrix.pairs.iter().filter(|pair| pair.reason != PairReason::Never) {
        let (first, second) = (name(pair.first), name(pair.second));
        let _ = writeln!(out, "  {first} {second}  {:.1} %  {}", 100.0 * pair.share, pair.reason.word());
    }
    let count = |reason: PairReason| matrix.pairs.iter().filter(|pair| pair.reason == reason).count();
    let _ = writeln!(
        out,
        "Pairs: {} adjacent, {} telescope, {} always, {} mostly, {} default, {} sometimes, {} never",
        count(PairReason::Adjacent),
        count(PairReason::Telescope),
        count(PairReason::Always),
        count(PairReason::Mostly),
        count(PairReason::Default),
        count(PairReason::Sometimes),
        count(PairReason::Never)
    );
    let pairs: Vec<String> = matrix
        .pairs
        .iter()
        .filter(|pair| pair.reason != PairReason::Adjacent && pair.reason <= PairReason::Default)
        .map(|pair| format!("[\"{}\", \"{}\"]", name(pair.first), name(pair.second)))
        .collect();
    let _ = writeln!(
        out,
        "For a scene, so that the default configuration is free: ignore = [\"adjacent\"{}{}]\n\
         Pairs with the reason `default` can really collide; better begin elsewhere and leave them out of this list.",
        if pairs.is_empty() { "" } else { ", " },
        pairs.join(", ")
    );
}

/// The links' poses for JSON.
pub(super) fn poses_json(robot: &Robot) -> Value {
    let poses = link_poses(robot).into_iter();
    Value::Object(poses.map(|(name, pose)| (name.to_owned(), json!(pose_to_array(&pose)))).collect())
}

/// Found grippers for JSON.
pub(super) fn grippers_json(robot: &Robot, found: &[FoundGripper]) -> Value {
    let gripper = |gripper: &FoundGripper| {
        json!({
            "link": own(&robot.links[gripper.link.at()].name),
            "link_from_gripper": pose_to_array(&gripper.link_from_gripper),
            "reason": gripper.reason,
        })
    };
    found.iter().map(gripper).collect()
}

/// The table for JSON.
pub(super) fn matrix_json(robot: &Robot, matrix: &CollisionMatrix) -> Value {
    let name = |link: LinkIndex| own(&robot.links[link.at()].name);
    let pair = |pair: &crate::setup::collision_matrix::MatrixPair| {
        json!({
            "links": [name(pair.first), name(pair.second)], "share": pair.share, "reason": pair.reason.word(),
        })
    };
    json!({ "samples": matrix.samples, "pairs": matrix.pairs.iter().map(pair).collect::<Vec<_>>() })
}
