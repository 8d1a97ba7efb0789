//! Whether joints and links make one tree, and followers lead to a joint of their own.

use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::xml::Xml;
use foliate_components::robot::model::{JointKind, JointModel, Model};
use roxmltree::Node;
use std::collections::HashMap;

/// One root, one parent for every other link, no cycle.
pub(super) fn check(
    xml: &Xml<'_>,
    root: Node<'_, '_>,
    nodes: &[Node<'_, '_>],
    joints: &[JointModel],
    model: &Model,
) -> Result<(), SceneError> {
    let mut parent_joint = vec![None; model.links.len()];
    for (index, joint) in joints.iter().enumerate() {
        if let Some(first) = parent_joint[joint.child].replace(index) {
            let child = quoted(&model.links[joint.child].name);
            let (first, line) = (quoted(&joints[first].name), xml.line(nodes[first]));
            return Err(xml
                .error(nodes[index], format!("link `{child}` is already the child of joint `{first}` (line {line})"))
                .hint("URDF describes trees; closed loops are constraints"));
        }
    }
    let roots: Vec<_> = (0..model.links.len()).filter(|&l| parent_joint[l].is_none()).collect();
    if let [first, second, ..] = roots[..] {
        let (first, second) = (quoted(&model.links[first].name), quoted(&model.links[second].name));
        return Err(xml
            .error(root, format!("links `{first}` and `{second}` are both roots"))
            .hint("connect them by a joint; a model has one root link"));
    }
    // With at most one root and one parent per link, a link whose ancestors never end is on or below a cycle.
    let mut ends = vec![false; model.links.len()];
    roots.iter().for_each(|&r| ends[r] = true);
    for link in 0..model.links.len() {
        let mut way = Vec::new();
        let mut at = link;
        while !ends[at] {
            way.push(at);
            match parent_joint[at] {
                Some(joint) if way.len() <= model.links.len() => at = joints[joint].parent,
                _ => {
                    let joint = parent_joint[at].unwrap_or_default();
                    let message = format!("link `{}` is on a cycle of joints", quoted(&model.links[at].name));
                    return Err(xml.error(nodes[joint], message).hint("URDF describes trees"));
                }
            }
        }
        way.into_iter().for_each(|l| ends[l] = true);
    }
    Ok(())
}

/// Leaders have one coordinate, and do not follow their followers.
///
/// A follower whose leader does not exist becomes a joint of its own, with a remark: published models have such (renamed
/// hands), and pinocchio reads them so.
pub(super) fn check_mimics(
    xml: &Xml<'_>,
    nodes: &[Node<'_, '_>],
    joints: &mut [JointModel],
    by_name: &HashMap<&str, usize>,
    warnings: &mut Vec<SceneError>,
) -> Result<(), SceneError> {
    let scalar = |kind| matches!(kind, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic);
    let mut leaders = vec![None; joints.len()];
    for index in 0..joints.len() {
        let Some((leader, ..)) = &joints[index].mimic else { continue };
        let Some(&found) = by_name.get(leader.as_str()) else {
            let message =
                format!("mimics joint `{}`, which does not exist: it is read as a joint of its own", quoted(leader));
            let hint = did_you_mean(leader, joints.iter().map(|joint| joint.name.as_str()));
            warnings.push(xml.error(nodes[index], message).hint(hint));
            joints[index].mimic = None;
            continue;
        };
        let can_lead = scalar(joints[found].kind) || joints[found].kind == JointKind::Fixed;
        let can_follow = scalar(joints[index].kind) || joints[index].kind == JointKind::Fixed;
        if !can_lead || !can_follow {
            let message = format!("mimics joint `{}`: only joints of one coordinate can be coupled", quoted(leader));
            return Err(xml.error(nodes[index], message));
        }
        leaders[index] = Some(found);
    }
    let mut walked_in = vec![usize::MAX; joints.len()];
    for index in 0..joints.len() {
        let mut at = index;
        // A joint that an earlier traversal has seen leads to an end; one that this traversal has seen leads back to itself.
        while walked_in[at] == usize::MAX {
            walked_in[at] = index;
            match leaders[at] {
                Some(leader) if walked_in[leader] == index => {
                    let hint = "one joint must lead";
                    return Err(xml.error(nodes[leader], "follows itself through <mimic>").hint(hint));
                }
                Some(leader) => at = leader,
                None => break,
            }
        }
    }
    Ok(())
}
