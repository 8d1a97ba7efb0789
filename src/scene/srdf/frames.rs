//! Grippers and handles: frames in their link.

use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::xml::{Xml, elements};
use crate::scene::srdf::reader::Reader;
use foliate_components::Pose;
use foliate_components::pose::rotation_from_rpy;
use foliate_components::robot::model::{GripperModel, HandleModel};
use glam::{DQuat, DVec3};
use roxmltree::Node;

/// Names that `<position>` had in older files.
const OLD_POSITIONS: [&str; 2] = ["handle_position_in_joint", "local_position"];

impl<'a> Reader<'a, '_> {
    pub(super) fn gripper(&mut self, node: Node<'a, '_>) -> Result<GripperModel, SceneError> {
        let name = self.name(node, "gripper")?;
        let link = self.link(node)?;
        if link == name {
            let hint = "the gripper is a frame of its own";
            return Err(self.xml.error(node, "a gripper and its link must have different names").hint(hint));
        }
        Ok(GripperModel {
            name: name.to_owned(),
            link,
            link_from_gripper: self.position(node)?,
            clearance: self.clearance(node)?,
        })
    }

    pub(super) fn handle(&mut self, node: Node<'a, '_>) -> Result<HandleModel, SceneError> {
        let name = self.name(node, "handle")?;
        let mask = self.mask(node, "mask")?.unwrap_or([true; 6]);
        if let Err(message) = check_mask(mask) {
            let element = elements(node, "mask").next().unwrap_or(node);
            return Err(self.xml.error(element, message).hint("free one rotation, all of them, or none"));
        }
        Ok(HandleModel {
            name: name.to_owned(),
            link: self.link(node)?,
            link_from_handle: self.position(node)?,
            clearance: self.clearance(node)?,
            mask,
            mask_complement: self.mask(node, "mask_complement")?.unwrap_or(mask.map(|m| !m)),
            approaching_direction: self.approach(node)?,
        })
    }

    fn approach(&self, node: Node<'_, '_>) -> Result<DVec3, SceneError> {
        let direction = DVec3::from_array(self.xml.vector(node, "approaching_direction")?.unwrap_or([1.0, 0.0, 0.0]));
        direction
            .try_normalize()
            .ok_or_else(|| self.xml.error(node, "attribute `approaching_direction` has length zero"))
    }

    fn clearance(&mut self, node: Node<'_, '_>) -> Result<f64, SceneError> {
        match self.xml.number(node, "clearance")? {
            Some(c) if c < 0.0 => Err(self.xml.error(node, format!("attribute `clearance` is negative: {c}"))),
            Some(c) => Ok(c),
            None => {
                self.warn(node, "attribute `clearance` is missing, 0 is taken", "there is no pre-grasp distance");
                Ok(0.0)
            }
        }
    }

    /// Six values of 0, 1, false or true.
    fn mask(&self, node: Node<'_, '_>, tag: &str) -> Result<Option<[bool; 6]>, SceneError> {
        let Some(element) = elements(node, tag).next() else { return Ok(None) };
        let mut values = Vec::new();
        for word in text(element).split_ascii_whitespace() {
            values.push(match word {
                "1" | "true" | "True" => true,
                "0" | "false" | "False" => false,
                other => {
                    let message = format!("`{}` is neither 0 nor 1", quoted(other));
                    return Err(self.xml.error(element, message));
                }
            });
        }
        let wrong = || self.xml.error(element, format!("wants 6 values, tx ty tz rx ry rz, got {}", values.len()));
        <[bool; 6]>::try_from(values.as_slice()).map(Some).map_err(|_| wrong())
    }

    /// The pose of a frame in its link.
    fn position(&mut self, node: Node<'a, '_>) -> Result<Pose, SceneError> {
        let mut all = node.children().filter(|n| {
            let tag = n.tag_name().name();
            n.is_element() && (tag == "position" || OLD_POSITIONS.contains(&tag))
        });
        let Some(element) = all.next() else {
            return Err(self.xml.error(node, "<position> is missing").hint("x y z qw qx qy qz, in the link"));
        };
        if let Some(second) = all.next() {
            return Err(self.xml.error(second, "a second position of one frame"));
        }
        if element.tag_name().name() != "position" {
            self.warn(element, "is an old name", "write <position>");
        }
        let numbers = self.xml.numbers(element, "text", &text(element))?;
        let by_attributes = ["xyz", "rpy", "wxyz", "xyzw"].iter().any(|a| element.attribute(*a).is_some());
        let (translation, rotation) = match (numbers.as_slice(), by_attributes) {
            (&[x, y, z, qw, qx, qy, qz], false) => (DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw)),
            ([], true) => attributes(self.xml, element)?,
            ([], false) => return Err(self.xml.error(element, "is empty").hint("x y z qw qx qy qz, in the link")),
            (_, true) => return Err(self.xml.error(element, "has both text and attributes")),
            (other, false) => {
                let message = format!("wants 7 numbers, x y z qw qx qy qz, got {}", other.len());
                return Err(self.xml.error(element, message));
            }
        };
        let length = rotation.length();
        if !(1e-6..1e6).contains(&length) {
            return Err(self.xml.error(element, "the quaternion is zero").hint("no rotation is 1 0 0 0, w first"));
        }
        if (length - 1.0).abs() > 0.01 {
            self.warn(element, format!("the quaternion has length {length:.4}"), "it is scaled to 1");
        }
        Ok(Pose::from_parts(translation, rotation / length))
    }
}

/// `xyz`, and at most one of `rpy`, `wxyz`, `xyzw`.
fn attributes(xml: &Xml<'_>, element: Node<'_, '_>) -> Result<(DVec3, DQuat), SceneError> {
    let xyz = DVec3::from_array(xml.vector(element, "xyz")?.unwrap_or_default());
    let given: Vec<_> = ["rpy", "wxyz", "xyzw"].into_iter().filter(|a| element.attribute(*a).is_some()).collect();
    let rotation = match given[..] {
        [] => DQuat::IDENTITY,
        ["rpy"] => {
            let [roll, pitch, yaw] = xml.vector(element, "rpy")?.unwrap_or_default();
            rotation_from_rpy(roll, pitch, yaw)
        }
        [name] => {
            let numbers = xml.numbers(element, name, element.attribute(name).unwrap_or_default())?;
            match numbers[..] {
                [w, x, y, z] if name == "wxyz" => DQuat::from_xyzw(x, y, z, w),
                [x, y, z, w] => DQuat::from_xyzw(x, y, z, w),
                _ => return Err(xml.error(element, format!("`{name}` wants 4 numbers, got {}", numbers.len()))),
            }
        }
        _ => return Err(xml.error(element, format!("gives the rotation twice: {}", given.join(", ")))),
    };
    Ok((xyz, rotation))
}

/// All text below an element; comments may split it.
pub(super) fn text(element: Node<'_, '_>) -> String {
    element.children().filter_map(|n| n.text().filter(|_| n.is_text())).collect()
}

/// A mask may constrain no, two or three rotations: of exactly one, the logarithm's row means nothing.
pub(crate) fn check_mask(mask: [bool; 6]) -> Result<(), String> {
    match mask[3..].iter().filter(|m| **m).count() {
        1 => Err("constrains exactly one rotation".into()),
        _ if mask == [false; 6] => Err("constrains nothing".into()),
        _ => Ok(()),
    }
}
