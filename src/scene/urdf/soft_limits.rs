//! Soft limits of `<safety_controller>`: where a controller brakes, inside of the limits.
//!
//! Plans keep the limits of `<limit>`. A controller with narrower soft limits does not follow a plan between both, so that they are told.

use crate::scene::reading::error::SceneError;
use crate::scene::reading::xml::{Xml, elements};
use foliate_components::robot::model::{JointKind, JointModel};
use roxmltree::Node;

/// By how much soft limits have to be narrower, radians or metres.
const LEAST: f64 = 1e-6;

/// The element whose soft limits are narrower than the limits, and what it says.
pub(super) type Soft<'n, 'i> = (Node<'n, 'i>, String);

/// Soft limits of a joint, where both are given and narrower than its limits.
pub(super) fn narrower<'n, 'i>(node: Node<'n, 'i>, joint: &JointModel) -> Option<Soft<'n, 'i>> {
    let element = elements(node, "safety_controller").next()?;
    let number = |name: &str| element.attribute(name)?.trim().parse::<f64>().ok();
    let (low, high) = (number("soft_lower_limit")?, number("soft_upper_limit")?);
    let (from, to) = joint.limits;
    let has_limits = matches!(joint.kind, JointKind::Revolute | JointKind::Prismatic);
    let is_narrower = has_limits && low < high && (low > from + LEAST || high < to - LEAST);
    let message = || format!("its soft limits [{low}, {high}] are narrower than its limits [{from}, {to}]");
    is_narrower.then(|| (element, message()))
}

/// One remark for all of a file.
pub(super) fn remark(xml: &Xml<'_>, soft: &[Soft<'_, '_>]) -> Option<SceneError> {
    let (element, message) = soft.first()?;
    let others = match soft.len() - 1 {
        0 => String::new(),
        1 => "; so are those of 1 other joint".to_owned(),
        n => format!("; so are those of {n} other joints"),
    };
    let hint = "plans keep the limits; `joint_bounds` of a scene narrows them";
    Some(xml.error(*element, format!("{message}{others}")).hint(hint))
}
