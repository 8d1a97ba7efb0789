//! Values of URDF elements that links and joints share: origins and required numbers.

use crate::scene::reading::error::SceneError;
use crate::scene::reading::xml::Xml;
use foliate_components::Pose;
use foliate_components::pose::rotation_from_rpy;
use glam::{DQuat, DVec3};
use roxmltree::Node;
/// Longest length in a model, metres; a mesh scale or box beyond it is a slip of units.
pub(crate) const LONGEST: f64 = 1e6;

/// `<origin xyz rpy>` of an element, or with `quat_xyzw` (URDF 1.1); the identity without one.
pub(crate) fn origin(xml: &Xml<'_>, node: Node<'_, '_>) -> Result<Pose, SceneError> {
    let Some(origin) = xml.optional_child(node, "origin")? else { return Ok(Pose::identity()) };
    let xyz = DVec3::from_array(xml.vector(origin, "xyz")?.unwrap_or_default());
    let rotation = match (xml.vector(origin, "rpy")?, xml.array::<4>(origin, "quat_xyzw")?) {
        (Some(_), Some(_)) => {
            return Err(xml.error(origin, "gives the rotation twice: rpy and quat_xyzw").hint("leave one of them out"));
        }
        (None, Some(quaternion)) => unit(quaternion).ok_or_else(|| {
            let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
            let message = format!("attribute `quat_xyzw` has length {length:.4}, a rotation has length 1");
            xml.error(origin, message).hint("order is x y z w; no rotation is 0 0 0 1")
        })?,
        (rpy, None) => {
            let [roll, pitch, yaw] = rpy.unwrap_or_default();
            rotation_from_rpy(roll, pitch, yaw)
        }
    };
    if xyz.abs().max_element() > LONGEST {
        return Err(xml.error(origin, format!("is more than {LONGEST} m away")).hint("lengths are metres"));
    }
    Ok(Pose::from_parts(xyz, rotation))
}

/// The rotation of a quaternion x y z w of length one, within the digits that files have.
fn unit(quaternion: [f64; 4]) -> Option<DQuat> {
    let quaternion = DQuat::from_array(quaternion);
    let length = quaternion.length();
    ((length - 1.0).abs() < 1e-3).then(|| quaternion / length)
}

pub(crate) fn required_number(xml: &Xml<'_>, node: Node<'_, '_>, name: &str) -> Result<f64, SceneError> {
    xml.number(node, name)?.ok_or_else(|| xml.error(node, format!("attribute `{name}` is missing")))
}
