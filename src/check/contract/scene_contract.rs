//! The contract of a path: the problem that its scene states. The other files of this folder add the comparisons to it.

use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::error::{CheckError, SceneChoice};
use crate::check::report::kind::Kind;
use crate::check::world::models::World;
use crate::path_file::document::PathFile;
use crate::scene::assemble::names::configuration::coordinate_names;
use crate::scene::assemble::names::start_file::StartFile;
use crate::scene::assemble::scene::Scene;
use crate::scene::reading::error::SceneError;
use crate::scene::shipped_scenes;
use crate::scene::sources::package::PackagePath;
use foliate_components::problem::Problem;
use std::cell::OnceCell;
use std::collections::HashMap;
use std::path::Path;

/// A problem that a path is compared with.
pub(crate) struct Contract<'c> {
    pub(crate) problem: &'c Problem,
    pub(crate) scene: Option<&'c Scene>,
    /// By coordinate of the problem: its name.
    pub(crate) names: Vec<String>,
    /// By segment: the state of the problem's own that it lies in, once that is known.
    pub(crate) states: OnceCell<Vec<Option<usize>>>,
}

impl<'c> Contract<'c> {
    pub(crate) fn of_scene(scene: &'c Scene) -> Self {
        Self { scene: Some(scene), ..Self::of_problem(&scene.problem) }
    }

    pub(crate) fn of_problem(problem: &'c Problem) -> Self {
        Self { problem, scene: None, names: coordinate_names(&problem.robot), states: OnceCell::new() }
    }

    pub(crate) fn name(&self) -> &str {
        &self.problem.name
    }

    /// Compares everything that the file says once.
    pub(crate) fn claims(&self, file: &PathFile, world: &World, report: &mut CheckReport) {
        if file.scene != self.problem.name {
            let subject = format!("the path is called one of `{}`, the scene is `{}`", shown(&file.scene), self.name());
            report.violate(Place::FILE, Kind::Scene, subject, None, None);
        }
        self.parts(file, world, report);
        self.documents(file, report);
        self.limits(file, report);
        self.rate_limits(file, report);
        self.pairs(file, report);
        self.locked(file, report);
    }

    /// The columns of the problem's coordinates in the file; none for one that the file lacks.
    pub(crate) fn columns(&self, file: &PathFile) -> Vec<Option<usize>> {
        let places: HashMap<&str, usize> = file.coordinates.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect();
        self.names.iter().map(|name| places.get(name.as_str()).copied()).collect()
    }
}

pub(crate) fn differs(report: &mut CheckReport, subject: impl Into<String>) {
    report.violate(Place::FILE, Kind::Scene, subject, None, None);
}

/// The scene that a path is compared with, if any. A scene that the file only names may be missing; one that was asked for
/// may not.
pub(crate) fn scene_of(
    file: &PathFile,
    base: &Path,
    packages: &PackagePath,
    choice: &SceneChoice,
    report: &mut CheckReport,
) -> Result<Option<Scene>, CheckError> {
    let failed = |error| CheckError::Scene(Box::new(error));
    match choice {
        SceneChoice::Nothing => {
            report.weaker("the path was compared with no scene");
            Ok(None)
        }
        SceneChoice::Given(name) => {
            let start = start_of(file, base, report).map_err(failed)?;
            let scene = Scene::load_from(name, packages, start.as_ref()).map_err(failed)?;
            if !is_the_named(file, &scene) {
                report.note("the scene is not the one that the path names by its SHA-256");
            }
            Ok(Some(scene))
        }
        SceneChoice::Named => {
            let Some(entry) = &file.scene_file else {
                report.weaker("the file names no scene");
                return Ok(None);
            };
            let is_shipped = shipped_scenes().iter().any(|scene| scene.name == entry.file);
            let name = if is_shipped { entry.file.clone() } else { base.join(&entry.file).display().to_string() };
            let start = match start_of(file, base, report) {
                Ok(start) => start,
                Err(error) => {
                    report.weaker(format!("the file that says where the path starts cannot be read: {error}"));
                    return Ok(None);
                }
            };
            match Scene::load_from(&name, &packages.for_path_files(), start.as_ref()) {
                Ok(scene) => {
                    if !is_the_named(file, &scene) {
                        let subject = format!("`{}` has another SHA-256 than the path says", shown(&entry.file));
                        differs(report, subject);
                    }
                    Ok(Some(scene))
                }
                // Nothing is said about a scene that there was no time to read.
                Err(error) if error.stopped.is_some() => Err(failed(error)),
                Err(error) => {
                    report.weaker(format!("the scene that the file names cannot be read: {error}"));
                    Ok(None)
                }
            }
        }
    }
}

/// The file that says where a path starts instead of where its scene says, which the report tells.
fn start_of(file: &PathFile, base: &Path, report: &mut CheckReport) -> Result<Option<StartFile>, SceneError> {
    let Some(entry) = &file.start_file else { return Ok(None) };
    let start = StartFile::read(&base.join(&entry.file))?;
    report.note(format!("the path starts where `{}` says, not where the scene says", shown(&entry.file)));
    if start.sha256() != entry.sha256 {
        differs(report, format!("`{}` has another SHA-256 than the path says", shown(&entry.file)));
    }
    Ok(Some(start))
}

fn is_the_named(file: &PathFile, scene: &Scene) -> bool {
    match (&file.scene_file, &scene.file) {
        (Some(entry), Some(found)) => entry.sha256 == found.sha256,
        _ => true,
    }
}
