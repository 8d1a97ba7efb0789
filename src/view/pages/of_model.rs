//! The page of one model.

use crate::inspection::inspect_pairs;
use crate::scene::load::ReadModel;
use crate::scene::mesh::formats::triangles::UpAxis;
use crate::scene::reading::error::SceneError;
use crate::scene::sources::package::PackagePath;
use crate::scene::visuals::Visuals;
use crate::view::document::finding::WhereEntry;
use crate::view::document::page::{MOST_PAIRS, PageKind};
use crate::view::html::page::Page;
use crate::view::pages::base::{ViewOptions, base};
use crate::view::pages::findings::Placed;
use foliate_components::robot::{DisabledPair, PartIndex, ShapeIndex};
use foliate_kernels::collision::{CollisionScene, PairRule, adjacent_links};
use std::collections::BTreeSet;

/// The page of a model alone, fixed in the world: all joints at zero, or as near to it as their limits let them, and the links that
/// collide there.
///
/// # Errors
/// Followers that leave their leader no room; the URDF cannot be read again.
pub fn page_of_model(
    model: &mut ReadModel,
    up_axis: UpAxis,
    packages: &PackagePath,
    options: &ViewOptions,
) -> Result<Page, SceneError> {
    let name = if model.model.name.is_empty() || model.model.name.contains('/') { "model" } else { &model.model.name };
    let name = name.to_owned();
    let robot = model.compose_as(&name)?;
    let visuals = Visuals::of_model(&robot, model, up_axis, packages)?;
    let mut page = base((&name, PageKind::Model), &robot, &visuals, None, options);
    model.warnings.iter().map(SceneError::to_string).for_each(|warning| page.warn(warning));
    let mut q = robot.space.neutral();
    robot.space.clamp(&mut q);
    page.document.neutral = q.clone();
    page.document.start = Some(q.clone());
    let without = robot.parts.iter().enumerate().filter(|(_, part)| !part.has_srdf);
    let ignored: Vec<DisabledPair> =
        without.flat_map(|(part, _)| adjacent_links(&robot, PartIndex(part as u32))).collect();
    let scene = CollisionScene::new(&robot, &PairRule { ignored: &ignored, ..PairRule::default() });
    let placed = Placed::new(&robot, &scene, &q, WhereEntry::Numbers(q.clone()));
    page.document.collisions = placed.collisions();
    let link = |shape: ShapeIndex| robot.shapes[shape.at()].link.at();
    // A box in the place of a mesh that is missing says nothing about collisions.
    let is_known =
        |shapes: [ShapeIndex; 2]| shapes.iter().all(|shape| robot.shapes[shape.at()].geometry.missing_file().is_none());
    let known = scene.pairs().iter().filter(|pair| is_known([pair.first, pair.second]));
    let pairs: BTreeSet<[usize; 2]> = known.map(|pair| [link(pair.first), link(pair.second)]).collect();
    page.document.pairs = (pairs.len() <= MOST_PAIRS).then(|| pairs.into_iter().collect());
    let shape = |shape: ShapeIndex| robot.shapes[shape.at()].name.as_str();
    let always = inspect_pairs(&robot).map(|found| found.always_colliding).unwrap_or_default();
    for (a, b) in always.into_iter().filter(|&(a, b)| is_known([a, b])) {
        page.warn(format!("{} and {} collide wherever the joints are", shape(a), shape(b)));
    }
    Ok(page)
}
