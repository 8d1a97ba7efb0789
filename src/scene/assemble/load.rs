//! Reads a scene file table by table and composes its problem.

use crate::scene::assemble::graph::{faces, options, rests, written};
use crate::scene::assemble::names::start_file::StartFile;
use crate::scene::assemble::names::{configuration, locked};
use crate::scene::assemble::parts::{auto, part, root_bounds};
use crate::scene::assemble::scene::{Loader, Scene, SceneFile, SceneOrigin};
use crate::scene::assemble::{goal, pairs, start_tolerance, suggest, timing};
use crate::scene::mesh::meshes::Meshes;
use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::input;
use crate::scene::reading::keys::{File, Item, Keys};
use crate::scene::sources::follower_limits;
use crate::scene::sources::mesh_name::folder_of;
use crate::scene::sources::package::PackagePath;
use crate::scene::sources::source::{Place, SceneBase, locate, sha256};
use foliate_components::constraint::Rests;
use foliate_components::problem::Problem;
use foliate_components::robot::{ComposeError, PartIndex, Robot};
use std::collections::HashMap;
use std::path::Path;

/// The first line of every scene file.
pub(crate) const FORMAT: &str = "foliate.scene/1";
/// Most parts of a scene.
const PARTS: usize = 1000;

/// Reads a scene from its text. `name` is what messages call the file.
///
/// # Errors
/// The first thing that is wrong, in the scene, its models, or the file that says where it starts.
// Long: one table of the file after another.
pub(crate) fn load(
    name: &str,
    text: &str,
    base: SceneBase,
    packages: &PackagePath,
    from: Option<&StartFile>,
) -> Result<Scene, SceneError> {
    let file = File::new(name, text);
    let table = file.parse(text)?;
    let mut keys = Keys::root(&file, &table);
    let (scene_name, description) = heading(&mut keys)?;
    let directory = base.directory().map(Path::to_owned);
    let packages = &packages.clone().with_readable(&directory);
    let mut loader =
        Loader { packages, base, meshes: Meshes::new(packages), warnings: Vec::new(), sums: HashMap::new() };

    let part_items = keys.required("part")?;
    let items = part_items.list()?;
    let mut parts = parts(&mut keys, (&part_items, &items), &mut loader)?;
    let ways = auto::complete(&mut parts, &loader)?;
    let mut robot = compose(&part_items, &parts)?;
    loader.warnings.extend(narrowed(&robot, &parts));
    loader.warnings.extend(root_bounds::open(&robot, &parts));

    configuration::refuse_twins(&robot, &items)?;
    check_sums(&mut keys, &mut loader)?;
    let mut ignored_pairs = pairs::of_parts(&parts, &robot, &loader)?;
    ignored_pairs.extend(pairs::of_regions(&parts, &robot)?);
    ignored_pairs.extend(pairs::ignored(&mut keys, &robot)?);
    let margins = pairs::margins(&mut keys, &robot)?;
    let order = configuration::order(&mut keys, &robot)?;
    let locks = locked::read(&mut keys, &robot)?;
    let reader = configuration::Reader { robot: &robot, locked: &locks.at_values, order: order.as_deref() };
    let mut start = reader.start(&keys.required("start")?)?;
    from.map_or(Ok(()), |from| from.apply(&reader, &mut start))?;
    let graph = options::read(&mut keys, &robot, &start, (&locks, ways))?;
    loader.warnings.extend(rests::remarks(name, &robot, &graph));
    loader.warnings.extend(written::remarks(name, &robot, &graph, &start));
    let reader = configuration::Reader { locked: &graph.locked, ..reader };
    let goals = goal::read::read(&keys.required("goal")?, &reader, &start, &graph)?;
    let timing = timing::timing(&mut keys, &robot, parts.iter().map(|p| (p.placement.name.as_str(), &p.rates)))?;
    let cost = timing::cost(&mut keys)?;
    let suggestions = suggest::read(&mut keys, &robot)?;
    let start_tolerance = start_tolerance::read(&mut keys)?;
    let projection_tolerance = start_tolerance::projection(&mut keys)?;
    keys.finish()?;
    if graph.rests != Rests::Centre {
        robot.surfaces.iter_mut().for_each(faces::join);
    }
    let problem = Problem {
        name: scene_name,
        robot,
        graph,
        ignored_pairs,
        margins,
        start,
        start_tolerance,
        projection_tolerance,
        goals,
        suggestions,
        timing,
        cost,
    };
    let parts = parts.into_iter().map(|p| p.source).collect();
    loader.warnings.extend(loader.meshes.finish());
    Ok(Scene {
        problem,
        description,
        parts,
        warnings: loader.warnings,
        file: None,
        directory,
        start: from.map(of_start),
    })
}

/// Which file says where a scene starts.
fn of_start(from: &StartFile) -> SceneFile {
    SceneFile { origin: SceneOrigin::File(from.path().to_owned()), sha256: from.sha256().to_owned() }
}

/// Format, name and description.
fn heading(keys: &mut Keys<'_>) -> Result<(String, String), SceneError> {
    let format = keys.required("format")?;
    if format.string()? != FORMAT {
        return Err(format
            .error(format!("`{}` is no format of scenes", quoted(format.string()?)))
            .hint(format!("this version reads \"{FORMAT}\"")));
    }
    let name = keys.required("name")?.string()?.to_owned();
    let description = keys.optional("description").map_or(Ok(""), |i| i.string())?.to_owned();
    Ok((name, description))
}

/// The robot of all parts.
fn compose(part_items: &Item<'_>, parts: &[part::LoadedPart<'_>]) -> Result<Robot, SceneError> {
    let composed: Vec<_> = parts.iter().map(|p| (&p.model, p.placement.clone())).collect();
    Robot::compose(&composed).map_err(|error| {
        let at = parts.iter().find(|p| error.to_string().contains(&format!("`{}`", p.placement.name)));
        match (&error, at.and_then(|part| follower_limits::again(&part.source.urdf))) {
            (ComposeError::NoRoom { room, .. }, Some(urdf)) => follower_limits::refusal(&urdf, room),
            _ => at.map_or(part_items, |p| &p.item).error(error.to_string()).because(error),
        }
    })
}

/// Reads the parts, those roots locked that `[locked]` names.
fn parts<'f>(
    keys: &mut Keys<'f>,
    (part_items, items): (&Item<'f>, &[Item<'f>]),
    loader: &mut Loader<'_>,
) -> Result<Vec<part::LoadedPart<'f>>, SceneError> {
    if items.is_empty() || items.len() > PARTS {
        return Err(part_items.error(format!("{} parts are given, 1 to {PARTS} are read", items.len())));
    }
    let mut parts = items.iter().map(|item| part::read(item, loader)).collect::<Result<Vec<_>, _>>()?;
    part::lock_roots(keys, &mut parts)?;
    root_bounds::complete(&mut parts, &mut loader.warnings);
    Ok(parts)
}

/// Remarks about joints that their followers leave little room.
fn narrowed(robot: &Robot, parts: &[part::LoadedPart<'_>]) -> Vec<SceneError> {
    let is_narrowed = |index: &usize| robot.narrowed.iter().any(|n| robot.joints[n.leader.at()].part.at() == *index);
    let of_part = |index: usize| {
        let urdf = follower_limits::again(&parts[index].source.urdf)?;
        Some(follower_limits::remarks(robot, PartIndex(index as u32), &urdf))
    };
    (0..parts.len()).filter(is_narrowed).filter_map(of_part).flatten().collect()
}

/// `[sha256]`: says when a file differs from the one that the scene was made with.
fn check_sums(keys: &mut Keys<'_>, loader: &mut Loader<'_>) -> Result<(), SceneError> {
    let Some(item) = keys.optional("sha256") else { return Ok(()) };
    for (url, item) in item.keys()?.entries() {
        let noted = item.string()?.to_ascii_lowercase();
        if noted.len() != 64 || !noted.bytes().all(|b| b.is_ascii_hexdigit()) {
            return Err(item.error("a SHA-256 has 64 hexadecimal digits"));
        }
        let sum = match locate(url, &loader.base, loader.packages) {
            Ok(Place::Path(path)) => match loader.sum(&path).or_else(|| loader.sum(&path.canonicalize().ok()?)) {
                Some(sum) => sum,
                None => sha256(&input::bytes(&path, input::MESH_CAP)?),
            },
            Ok(Place::Program(content)) => sha256(content.as_bytes()),
            Err((message, hint)) => return Err(item.error(message).hint(hint)),
        };
        if sum != noted {
            let message = "the file differs from the one that the scene was made with";
            loader.warnings.push(item.error(message).hint("results may differ from published ones"));
        }
    }
    Ok(())
}

/// Reads a scene file from disk.
pub(crate) fn load_path(path: &Path, packages: &PackagePath, from: Option<&StartFile>) -> Result<Scene, SceneError> {
    let content = input::bytes(path, input::SCENE_CAP)?;
    let file = SceneFile { origin: SceneOrigin::File(path.to_owned()), sha256: sha256(&content) };
    let name = path.display().to_string();
    let text = input::decode(content, &name)?;
    let scene = load(&name, &text, SceneBase::Directory(folder_of(path).to_owned()), packages, from)?;
    Ok(Scene { file: Some(file), ..scene })
}
