//! `rests` and `rests_margin` of `[graph]`: how objects must lie on their supports.

use crate::scene::assemble::names::frame::one_of;
use crate::scene::reading::error::SceneError;
use crate::scene::reading::keys::Keys;
use foliate_components::constraint::Rests;
use foliate_components::problem::GraphOptions;
use foliate_components::robot::{CentreSource, Robot};

pub(in crate::scene::assemble) fn read(keys: &mut Keys<'_>) -> Result<Rests, SceneError> {
    let words = [
        ("centre", Rests::Centre),
        ("stable", Rests::Stable { margin: Rests::STABLE_MARGIN }),
        ("whole-face", Rests::WholeFace { margin: 0.0 }),
    ];
    let rests = keys.optional("rests").map_or(Ok(Rests::default()), |item| one_of(&item, &words))?;
    let Some(item) = keys.optional("rests_margin") else { return Ok(rests) };
    let margin = item.distance()?;
    match rests {
        Rests::Centre => {
            let hint = "it is of rests = \"stable\" (the centre of mass) and \"whole-face\" (all of the object's face)";
            Err(item.error("has no meaning with rests = \"centre\"").hint(hint))
        }
        Rests::Stable { .. } => Ok(Rests::Stable { margin }),
        Rests::WholeFace { .. } => Ok(Rests::WholeFace { margin }),
    }
}

/// Says of which objects it is not known where their mass is, though it is asked.
pub(in crate::scene::assemble) fn remarks(scene: &str, robot: &Robot, options: &GraphOptions) -> Vec<SceneError> {
    if !matches!(options.rests, Rests::Stable { .. }) {
        return Vec::new();
    }
    let lying = options.objects.iter().filter(|object| !object.surfaces.is_empty() && object.plane.is_none());
    let remark = |object: &foliate_components::problem::ObjectOptions| {
        let body = robot.links[robot.surfaces[object.surfaces[0].at()].link.at()].joint;
        let stands_for = match robot.body_centre(object.part, body) {
            Some((_, CentreSource::Masses)) => return None,
            Some((_, CentreSource::Volume)) => "the centre of the volume of its shapes",
            None => "the centre of the polygon that it lies on",
        };
        let message = format!("`{}` has no mass: {stands_for} stands for its centre of mass", robot[object.part].name);
        Some(
            SceneError::new(scene, "graph.rests", message)
                .hint("give its links an <inertial>, or say rests = \"centre\""),
        )
    };
    lying.filter_map(remark).collect()
}
