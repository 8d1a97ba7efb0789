//! How a path file calls what is held, and which of its coordinates and links are which of a robot.

use crate::path_file::document::PathFile;
use crate::scene::assemble::names::configuration::coordinate_names;
use crate::scene::reading::error::quoted;
use foliate_components::robot::{DisabledPair, HandleIndex, PartKind, Robot};
use std::collections::HashMap;

/// The part that a handle is on, with the link where that is not rigidly the part's root.
pub(super) fn held(robot: &Robot, handle: HandleIndex) -> String {
    let link = &robot.links[robot.handles[handle.at()].link.at()];
    let part = &robot.parts[link.part.at()];
    if link.joint == robot.links[part.root_link.at()].joint { part.name.clone() } else { link.name.clone() }
}

/// For each coordinate of the robot its place in a knot; none for an environment's joint that the file does not name, which stands at
/// zero.
///
/// # Errors
/// The element of the file that does not fit, and why.
pub(super) fn columns(coordinates: &[String], robot: &Robot) -> Result<Vec<Option<usize>>, (String, String)> {
    let places: HashMap<&str, usize> = coordinates.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect();
    let still = |name: &str| {
        let part = name.split('/').next().and_then(|part| robot.part(part));
        part.is_some_and(|part| robot.parts[part.at()].kind == PartKind::Environment)
    };
    let names = coordinate_names(robot);
    let mut known = vec![false; coordinates.len()];
    let mut columns = Vec::with_capacity(names.len());
    for name in &names {
        let place = places.get(name.as_str()).copied();
        if place.is_none() && !still(name) {
            return Err(("coordinates".into(), format!("`{}` is missing", quoted(name))));
        }
        place.into_iter().for_each(|place| known[place] = true);
        columns.push(place);
    }
    match known.iter().position(|known| !known) {
        None => Ok(columns),
        Some(index) => {
            let message = format!("`{}` is no coordinate of a part", quoted(&coordinates[index]));
            Err((format!("coordinates[{index}]"), message))
        }
    }
}

/// The pairs of links that the file leaves untested, those that the models have.
pub(crate) fn ignored_pairs(file: &PathFile, robot: &Robot) -> Vec<DisabledPair> {
    let pair = |[first, second, reason]: &[String; 3]| {
        let (first, second) = (robot.link(first)?, robot.link(second)?);
        Some(DisabledPair { first, second, reason: reason.clone() })
    };
    file.ignored_pairs.iter().filter_map(pair).collect()
}
