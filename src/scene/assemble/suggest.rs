//! `[suggest]`: poses of objects that may help on the way.

use crate::scene::assemble::goal::coordinates::moving_object;
use crate::scene::reading::error::SceneError;
use crate::scene::reading::keys::Keys;
use foliate_components::Pose;
use foliate_components::robot::{PartIndex, Robot};

/// Most suggested poses of a scene.
const SUGGESTIONS: usize = 10_000;

pub(super) fn read(keys: &mut Keys<'_>, robot: &Robot) -> Result<Vec<(PartIndex, Pose)>, SceneError> {
    let Some(item) = keys.optional("suggest") else { return Ok(Vec::new()) };
    let mut suggestions = Vec::new();
    for (name, item) in item.keys()?.entries() {
        let object = moving_object(name, &item, robot)?;
        let poses = item.list()?;
        if suggestions.len() + poses.len() > SUGGESTIONS {
            return Err(item.error(format!("more than {SUGGESTIONS} poses are suggested")));
        }
        for pose in poses {
            suggestions.push((object, pose.pose()?));
        }
    }
    Ok(suggestions)
}
