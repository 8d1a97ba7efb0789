//! Joints whose followers leave them little room, or none: where in the URDF, and between which values.

use crate::scene::reading::error::SceneError;
use crate::scene::reading::xml::Xml;
use crate::scene::sources::source::{self, ModelFile, Opened};
use foliate_components::robot::{JointIndex, NarrowedLimits, NoRoom, PartIndex, Robot};
use foliate_systems::events::StopSignal;

/// Why a model has no motion at all for a joint.
pub(crate) fn refusal(urdf: &Opened, room: &NoRoom) -> SceneError {
    let hint = "mend a <limit> or the <mimic>; or let followers be joints of their own: `mimic = \"free\"` in a scene";
    at_joint(urdf, &room.follower, room.to_string()).hint(hint)
}

/// Remarks about the leaders of a part that their followers leave a single value, or less than half of their range.
pub(crate) fn remarks(robot: &Robot, part: PartIndex, urdf: &Opened) -> Vec<SceneError> {
    let own = |n: &&NarrowedLimits| robot.joints[n.leader.at()].part == part && n.is_suspicious();
    let name = |joint: JointIndex| {
        let name = robot.joints[joint.at()].name.as_str();
        name.split_once('/').map_or(name, |(_, own)| own)
    };
    let remark = |narrowed: &NarrowedLimits| {
        let followers: Vec<_> = narrowed.followers.iter().map(|&f| format!("`{}`", name(f))).collect();
        let ((low, high), (from, to)) = (narrowed.own, narrowed.left);
        let left = if from == to { format!("only at {from}") } else { format!("only in [{from}, {to}]") };
        let message = format!(
            "its limits are [{low}, {high}], but {left} do its followers keep their own ({}): there it stays",
            followers.join(", ")
        );
        at_joint(urdf, name(narrowed.leader), message)
    };
    robot.narrowed.iter().filter(own).map(remark).collect()
}

/// A remark about a joint, with its line.
pub(crate) fn at_joint(urdf: &Opened, name: &str, message: String) -> SceneError {
    let element = format!("<joint name=\"{}\">", crate::scene::reading::error::quoted(name));
    SceneError::new(&urdf.label, element, message).at(line_of(urdf, name))
}

/// The line of a joint in a URDF that has been read.
fn line_of(urdf: &Opened, joint: &str) -> Option<u32> {
    let xml = Xml::parse(&urdf.label, &urdf.text, &StopSignal::default()).ok()?;
    let is_joint = |node: &roxmltree::Node<'_, '_>| {
        node.has_tag_name("joint") && node.attribute("name") == Some(joint) && node.parent_element().is_some()
    };
    let node = xml.document.root_element().children().find(is_joint)?;
    Some(xml.line(node))
}

/// A model file, read again: lines are of interest only where something is wrong.
pub(crate) fn again(file: &ModelFile) -> Option<Opened> {
    source::again(file).ok()
}
