//! Bounds of roots that a scene leaves open: a free object goes no farther than robots reach.

use crate::scene::assemble::parts::part::LoadedPart;
use crate::scene::reading::error::SceneError;
use crate::scene::sources::follower_limits;
use foliate_components::robot::model::{JointKind, Model};
use foliate_components::robot::{Joint, JointType, PartKind, Robot, RootJoint};
use glam::DVec3;

/// Room beyond the reach of a robot, metres: for what it holds.
const ROOM: f64 = 0.25;

/// Gives free-flyer roots of objects without `root_bounds` the box that the robots of the scene reach, and says so. A scene without
/// robots has none to give.
pub(crate) fn complete(parts: &mut [LoadedPart<'_>], warnings: &mut Vec<SceneError>) {
    let reached = parts.iter().filter(|part| part.placement.kind == PartKind::Robot).filter_map(box_of);
    let Some((low, high)) = reached.reduce(|(low, high), (l, h)| (low.min(l), high.max(h))) else { return };
    // Numbers that a person may copy: whole centimetres, outwards.
    let (low, high) = ((low * 100.0).floor() / 100.0, (high * 100.0).ceil() / 100.0);
    let bounds: Vec<(f64, f64)> = (0..3).map(|axis| (low[axis], high[axis])).collect();
    let open = |part: &&mut LoadedPart<'_>| {
        let placement = &part.placement;
        placement.kind == PartKind::Object && placement.root == RootJoint::FreeFlyer && placement.root_bounds.is_empty()
    };
    for part in parts.iter_mut().filter(open) {
        let message = format!(
            "`root_bounds` is not given: the reach of the robots, [[{}, {}], [{}, {}], [{}, {}]], bounds the root",
            low.x, high.x, low.y, high.y, low.z, high.z
        );
        warnings.push(part.item.error(message));
        part.placement.root_bounds.clone_from(&bounds);
    }
}

/// Remarks about roots, and planar and floating joints of models, that move without bounds: no planner takes them.
pub(crate) fn open(robot: &Robot, parts: &[LoadedPart<'_>]) -> Vec<SceneError> {
    let remark = |(index, joint): (usize, &Joint)| {
        let first = match joint.motion {
            JointType::Planar => 2,
            JointType::FreeFlyer => 3,
            JointType::Revolute { .. } | JointType::Prismatic { .. } => return None,
        };
        let is_open = |axis: &usize| !(joint.lower[*axis].is_finite() && joint.upper[*axis].is_finite());
        let axis = joint.motion.axes()[(0..first).find(is_open)?];
        let (part, placed) = (&parts[joint.part.at()], &robot.parts[joint.part.at()]);
        if placed.root_joint.is_some_and(|root| root.at() == index) {
            let error = part.item.error(format!("its root moves along {axis} without bounds"));
            return Some(error.hint("give `root_bounds`, or lock the root in [locked]"));
        }
        let own = joint.name.split_once('/').map_or(joint.name.as_str(), |(_, own)| own);
        let urdf = follower_limits::again(&part.source.urdf)?;
        let error = follower_limits::at_joint(&urdf, own, format!("moves along {axis} without bounds"));
        let hint = format!(
            "in the scene: `joint_bounds = {{ \"{own}/{axis}\" = [-1, 1] }}` and so on, or `\"{}\"` in [locked]",
            joint.name
        );
        Some(error.hint(hint))
    };
    robot.joints.iter().enumerate().filter_map(remark).collect()
}

/// The box in the world that a robot reaches at most; none where its root moves without bounds.
fn box_of(part: &LoadedPart<'_>) -> Option<(DVec3, DVec3)> {
    let placement = &part.placement;
    let reach = reach(&part.model) + ROOM;
    let bound = |axis: usize| placement.root_bounds.get(axis).copied();
    let (low, high) = match placement.root {
        RootJoint::Fixed => (DVec3::ZERO, DVec3::ZERO),
        RootJoint::Planar => {
            let (x, y) = (bound(0)?, bound(1)?);
            // The plane may be turned: a ball about its origin holds what the bounds allow.
            let farther = |(low, high): (f64, f64)| low.abs().max(high.abs());
            let far = farther(x).hypot(farther(y));
            (DVec3::splat(-far), DVec3::splat(far))
        }
        RootJoint::FreeFlyer => {
            let (x, y, z) = (bound(0)?, bound(1)?, bound(2)?);
            (DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1))
        }
    };
    let middle = match placement.root {
        RootJoint::FreeFlyer => DVec3::ZERO,
        RootJoint::Fixed | RootJoint::Planar => placement.world_from_root.translation,
    };
    let found = (middle + low - reach, middle + high + reach);
    (found.0.is_finite() && found.1.is_finite()).then_some(found)
}

/// How far any shape or frame of a model can be from its root link's origin, metres: the longest chain of joints stretched out, with
/// slides drawn out, and the size of what is at its end.
pub(crate) fn reach(model: &Model) -> f64 {
    let mut above: Vec<Option<(usize, f64)>> = vec![None; model.links.len()];
    for joint in &model.joints {
        let slide = match joint.kind {
            JointKind::Prismatic => joint.limits.0.abs().max(joint.limits.1.abs()),
            _ => 0.0,
        };
        above[joint.child] = Some((joint.parent, joint.parent_from_joint.translation.length() + slide));
    }
    let size = |link: usize| {
        let shapes = model.links[link].shapes.iter();
        shapes.map(|(pose, shape)| pose.translation.length() + shape.radius_about_origin()).fold(0.0, f64::max)
    };
    let far = |link: usize| {
        let (mut at, mut length) = (link, size(link));
        // Composing refuses circles later; the walk is bounded all the same.
        for _ in 0..model.links.len() {
            let Some((parent, step)) = above[at] else { break };
            (at, length) = (parent, length + step);
        }
        length
    };
    (0..model.links.len()).map(far).fold(0.0, f64::max)
}
