//! `ignore` and `margins`: pairs of links.

use crate::scene::assemble::parts::part::LoadedPart;
use crate::scene::assemble::scene::Loader;
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::problem::Margin;
use foliate_components::robot::{DisabledPair, LinkIndex, Part, PartIndex, Robot};
use foliate_kernels::collision::adjacent_links_while;
use std::collections::{BTreeSet, HashSet};

/// Most pairs that a scene's lists unfold to.
const PAIRS: usize = 4_000_000;

/// What the parts' own `ignore` asks for: where a part has no SRDF and does not say otherwise, links that one joint joins and
/// that touch wherever it is.
pub(super) fn of_parts(
    parts: &[LoadedPart<'_>],
    robot: &Robot,
    loader: &Loader<'_>,
) -> Result<Vec<DisabledPair>, SceneError> {
    let limits = loader.packages.limits();
    let mut pairs = Vec::new();
    for (index, (loaded, part)) in parts.iter().zip(&robot.parts).enumerate() {
        // Trees of its meshes are built for that, which may take long.
        let neighbours = || {
            let found = adjacent_links_while(robot, PartIndex(index as u32), &|| !limits.stop.is_raised());
            limits.reached(&loaded.source.urdf.url).map(|()| found.unwrap_or_default())
        };
        match &loaded.ignore {
            None if part.has_srdf => {}
            None => pairs.extend(neighbours()?),
            Some(item) if item.is_string() => pairs.extend(word(item, neighbours)?),
            Some(item) => {
                for item in item.list()? {
                    match item.is_string() {
                        true => pairs.extend(word(&item, neighbours)?),
                        false => own_pair(&item, part, robot, &mut pairs)?,
                    }
                }
            }
        }
    }
    Ok(pairs)
}

/// `avoided_by` of environments: pairs with what need not avoid them.
pub(super) fn of_regions(parts: &[LoadedPart<'_>], robot: &Robot) -> Result<Vec<DisabledPair>, SceneError> {
    let mut pairs = Vec::new();
    for (loaded, region) in parts.iter().zip(&robot.parts) {
        let Some(item) = &loaded.avoided_by else { continue };
        let mut avoiding = BTreeSet::new();
        for item in item.list()? {
            avoiding.extend(links(&item, robot)?);
        }
        let others = (0..robot.links.len() as u32).map(LinkIndex);
        let others = others.filter(|link| !avoiding.contains(link) && !region.links.contains(&link.at()));
        let with_shapes: BTreeSet<LinkIndex> = robot.shapes.iter().map(|shape| shape.link).collect();
        for other in others.filter(|link| with_shapes.contains(link) && robot.links[link.at()].joint.is_some()) {
            let own = region.links.clone().map(|link| LinkIndex(link as u32)).filter(|link| with_shapes.contains(link));
            pairs.extend(own.map(|first| DisabledPair { first, second: other, reason: "region".into() }));
        }
        if pairs.len() > PAIRS {
            return Err(item.error(format!("with this there are more than {PAIRS} pairs of links")));
        }
    }
    Ok(pairs)
}

fn word(
    item: &Item<'_>,
    neighbours: impl FnOnce() -> Result<Vec<DisabledPair>, SceneError>,
) -> Result<Vec<DisabledPair>, SceneError> {
    match item.string()? {
        "adjacent" => neighbours(),
        "none" => Ok(Vec::new()),
        other => {
            let message = format!("`{}` is neither \"adjacent\" nor \"none\" nor a pair of links", quoted(other));
            Err(item.error(message).hint(did_you_mean(other, ["adjacent", "none"])))
        }
    }
}

/// `["link", "link"]`, without the part's name.
fn own_pair(item: &Item<'_>, part: &Part, robot: &Robot, pairs: &mut Vec<DisabledPair>) -> Result<(), SceneError> {
    let find = |item: &Item<'_>| {
        let name = item.string()?;
        let full = format!("{}/{name}", part.name);
        let index = part.links.clone().find(|&l| robot.links[l].name == full);
        let known = part.links.clone().filter_map(|l| robot.links[l].name.split_once('/').map(|(_, n)| n));
        index.map(|l| LinkIndex(l as u32)).ok_or_else(|| {
            item.error(format!("there is no link `{}` in this part", quoted(name))).hint(did_you_mean(name, known))
        })
    };
    let (first, second) = two(item)?;
    pairs.push(DisabledPair { first: find(&first)?, second: find(&second)?, reason: "scene".into() });
    Ok(())
}

fn two<'f>(item: &Item<'f>) -> Result<(Item<'f>, Item<'f>), SceneError> {
    match <[Item<'f>; 2]>::try_from(item.list()?) {
        Ok([first, second]) => Ok((first, second)),
        Err(list) => Err(item.error(format!("wants two names, got {}", list.len()))),
    }
}

/// The links that `part/link` or `part` names.
fn links(item: &Item<'_>, robot: &Robot) -> Result<Vec<LinkIndex>, SceneError> {
    let name = item.string()?;
    if let Some(link) = robot.link(name) {
        return Ok(vec![link]);
    }
    if let Some(part) = robot.part(name) {
        return Ok(robot.parts[part.at()].links.clone().map(|l| LinkIndex(l as u32)).collect());
    }
    let known = robot.links.iter().map(|l| l.name.as_str()).chain(robot.parts.iter().map(|p| p.name.as_str()));
    Err(item.error(format!("there is no link or part `{}`", quoted(name))).hint(did_you_mean(name, known)))
}

fn all_pairs(item: &Item<'_>, robot: &Robot, so_far: usize) -> Result<Vec<(LinkIndex, LinkIndex)>, SceneError> {
    let (first, second) = two(item)?;
    let (first, second) = (links(&first, robot)?, links(&second, robot)?);
    if so_far + first.len() * second.len() > PAIRS {
        return Err(item.error(format!("with this there are more than {PAIRS} pairs of links")));
    }
    Ok(first.iter().flat_map(|&a| second.iter().map(move |&b| (a, b))).filter(|(a, b)| a != b).collect())
}

/// `ignore = [["a/link", "b"], …]`: a part's name stands for all its links.
pub(super) fn ignored(keys: &mut Keys<'_>, robot: &Robot) -> Result<Vec<DisabledPair>, SceneError> {
    let mut pairs = Vec::new();
    for item in keys.optional("ignore").map_or(Ok(Vec::new()), |i| i.list())? {
        let all = all_pairs(&item, robot, pairs.len())?;
        pairs.extend(all.into_iter().map(|(first, second)| DisabledPair { first, second, reason: "scene".into() }));
    }
    Ok(pairs)
}

/// `margins = [{ pair = ["a/link", "b"], distance = 0.01 }, …]`, and `default_margin` for all other pairs of parts.
pub(super) fn margins(keys: &mut Keys<'_>, robot: &Robot) -> Result<Vec<Margin>, SceneError> {
    let mut margins = Vec::new();
    for item in keys.optional("margins").map_or(Ok(Vec::new()), |i| i.list())? {
        let mut keys = item.keys()?;
        let all = all_pairs(&keys.required("pair")?, robot, margins.len())?;
        let distance = keys.required("distance")?.distance()?;
        keys.finish()?;
        margins.extend(all.into_iter().map(|(first, second)| Margin { first, second, distance }));
    }
    if let Some(item) = keys.optional("default_margin") {
        let distance = item.distance()?;
        // None at all is what pairs have that no margin names.
        let others = if distance > 0.0 { others(&margins, robot) } else { Vec::new() };
        if margins.len() + others.len() > PAIRS {
            return Err(item.error(format!("with this there are more than {PAIRS} pairs of links")));
        }
        margins.extend(others.into_iter().map(|(first, second)| Margin { first, second, distance }));
    }
    Ok(margins)
}

/// Pairs of links with shapes, of different parts and not both fixed in the world, that have no margin of their own.
fn others(margins: &[Margin], robot: &Robot) -> Vec<(LinkIndex, LinkIndex)> {
    let own: HashSet<_> = margins.iter().flat_map(|m| [(m.first, m.second), (m.second, m.first)]).collect();
    let with_shapes: BTreeSet<LinkIndex> = robot.shapes.iter().map(|s| s.link).collect();
    let may_meet = |a: LinkIndex, b: LinkIndex| {
        let (a, b) = (&robot.links[a.at()], &robot.links[b.at()]);
        a.part != b.part && (a.joint.is_some() || b.joint.is_some())
    };
    let pairs = with_shapes.iter().flat_map(|&a| with_shapes.range(a..).map(move |&b| (a, b)));
    pairs.filter(|&(a, b)| may_meet(a, b) && !own.contains(&(a, b))).take(PAIRS + 1).collect()
}
