//! Makes the page of a path, a recorded search, a scene or a model.

use crate::check::{CheckOptions, check};
use crate::cli::commands::solve::arguments::deadline;
use crate::cli::commands::view::written;
use crate::cli::console::loading;
use crate::cli::console::loading::{Cut, Failure};
use crate::cli::console::outputs;
use crate::cli::console::print::{Ending, Refusal, print, say};
use crate::path_file::{LoadPathError, LoadedPath, PathFile, save};
use crate::recording::Recording;
use crate::scene::{PackagePath, Scene, UpAxis, read_model};
use crate::systems::events::StopSignal;
use crate::view::{
    Page, ViewOptions, Visuals, model_of_scene, page_of_model, page_of_path, page_of_recording, page_of_scene,
};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Writes a page that shows a path, a recorded search, a scene or a model: one HTML file, to be opened in a browser
#[derive(clap::Args, Clone)]
pub(crate) struct Arguments {
    /// A path file, a recording of a search, a shipped scene's name, a scene file, or a URDF
    #[arg(value_name = "PATH.json|FILE.search|SCENE|ROBOT.urdf")]
    what: String,
    /// The SRDF of a URDF: grippers, handles, and which links may touch
    #[arg(long, value_name = "FILE")]
    srdf: Option<String>,
    /// What is done with the up axis of a URDF's COLLADA and glTF meshes
    #[arg(long, value_name = "as-written|declared", value_parser = loading::up_axis)]
    mesh_up_axis: Option<UpAxis>,
    /// The page; without it a temporary file, whose name is printed
    #[arg(short, long, value_name = "PAGE.html")]
    out: Option<PathBuf>,
    /// Do not check the path
    #[arg(long)]
    no_check: bool,
    /// Most triangles of all meshes of the page together; meshes are reduced until they have no more, but none below 200
    #[arg(long, value_name = "N", default_value_t = ViewOptions::default().triangles)]
    triangles: usize,
    /// Seconds after which to give up
    #[arg(long, default_value_t = 600.0, value_name = "S")]
    time_limit: f64,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    outputs::check([&*arguments.what].into_iter().chain(arguments.srdf.as_deref()), &arguments.out)?;
    let limit = deadline(arguments.time_limit)?;
    let (mine, packages) = (arguments.clone(), packages.clone());
    let worked = loading::beside(limit, Duration::ZERO, move |stop| page(&mine, &packages, limit, stop))?;
    let page = match worked {
        Ok(page) => page,
        Err(Cut::Interrupted) => return Ok(Ending::Interrupted),
        Err(Cut::OutOfTime) => return Err(Refusal("the time limit was reached; nothing is written".into())),
    };
    for warning in &page.document.warnings {
        say(&format!("warning: {warning}\n"));
    }
    written::write(&page, arguments.out.as_deref(), print)?;
    Ok(Ending::Done)
}

fn page(arguments: &Arguments, packages: &PackagePath, limit: Duration, stop: &StopSignal) -> Result<Page, Failure> {
    let extension = Path::new(&arguments.what).extension().and_then(|e| e.to_str()).unwrap_or_default();
    let extension = extension.to_ascii_lowercase();
    if arguments.mesh_up_axis.is_some() && !matches!(extension.as_str(), "urdf" | "xml") {
        let why = "--mesh-up-axis is for a URDF: a part of a scene says it itself, with `mesh_up_axis`";
        return Err(Refusal(why.into()).into());
    }
    if Recording::is_one(Path::new(&arguments.what)) {
        return of_recording(arguments, packages, stop);
    }
    match extension.as_str() {
        "json" => of_path(arguments, packages, limit, stop),
        "urdf" | "xml" => of_model(arguments, packages, stop),
        _ => of_scene(arguments, packages, stop),
    }
}

fn options(arguments: &Arguments) -> ViewOptions {
    ViewOptions { triangles: arguments.triangles }
}

fn of_model(arguments: &Arguments, packages: &PackagePath, stop: &StopSignal) -> Result<Page, Failure> {
    let packages = loading::until(packages, stop).with_placeholders();
    let up_axis = arguments.mesh_up_axis.unwrap_or_default();
    let mut model = read_model(&arguments.what, arguments.srdf.as_deref(), up_axis, &packages)?;
    Ok(page_of_model(&mut model, up_axis, &packages, &options(arguments))?)
}

fn of_scene(arguments: &Arguments, packages: &PackagePath, stop: &StopSignal) -> Result<Page, Failure> {
    if arguments.srdf.is_some() {
        return Err(Refusal("--srdf is for a URDF: a scene names its SRDFs itself".into()).into());
    }
    let packages = loading::until(packages, stop).with_placeholders();
    let scene = Scene::load(&arguments.what, &packages)?;
    let visuals = Visuals::of_scene(&scene, &packages)?;
    let model = model_of_scene(&scene);
    if stop.is_raised() {
        return Err(Failure::Stopped);
    }
    Ok(page_of_scene(&scene, model, &visuals, &options(arguments)))
}

fn of_path(arguments: &Arguments, packages: &PackagePath, limit: Duration, stop: &StopSignal) -> Result<Page, Failure> {
    let started = Instant::now();
    let packages = loading::until(packages, stop);
    // What is shown may have placeholders; what is proved may not.
    let shown = packages.clone().with_placeholders();
    let place = Path::new(&arguments.what);
    let file = save::read(place).map_err(|e| Refusal(e.to_string()))?;
    let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let path = loaded(&file, place, folder, &shown)?;
    let visuals = Visuals::of_path(&path, &shown)?;
    let scene = file.scene_file.as_ref().and_then(|scene| named_scene(&scene.file, folder, &shown.for_path_files()));
    let report = (!arguments.no_check).then(|| {
        let time_limit = Some(limit.saturating_sub(started.elapsed()));
        check(&file, folder, &packages, &CheckOptions { time_limit, ..CheckOptions::default() })
    });
    if stop.is_raised() {
        return Err(Failure::Stopped);
    }
    page_of_path((&file, &path), scene.as_ref(), report.as_ref(), &visuals, &options(arguments))
        .map_err(|e| Refusal(format!("{}: {e}", place.display())).into())
}

fn of_recording(arguments: &Arguments, packages: &PackagePath, stop: &StopSignal) -> Result<Page, Failure> {
    let shown = loading::until(packages, stop).with_placeholders();
    let place = Path::new(&arguments.what);
    let recording = Recording::read(place).map_err(|e| Refusal(e.to_string()))?;
    let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let path = loaded(&recording.head.path, place, folder, &shown)?;
    let visuals = Visuals::of_path(&path, &shown)?;
    if stop.is_raised() {
        return Err(Failure::Stopped);
    }
    page_of_recording(&recording, &path, &visuals, &options(arguments))
        .map_err(|e| Refusal(format!("{}: {e}", place.display())).into())
}

/// The path of a file on the robot of its models.
fn loaded(file: &PathFile, place: &Path, folder: &Path, packages: &PackagePath) -> Result<LoadedPath, Failure> {
    LoadedPath::of_file(file, folder, packages).map_err(|error| match error {
        LoadPathError::Model { error, .. } if error.stopped.is_some() => Failure::from(*error),
        other => Refusal(format!("{}: {other}", place.display())).into(),
    })
}

/// The scene that a path file names: a shipped one, or a file beside it.
fn named_scene(name: &str, folder: &Path, packages: &PackagePath) -> Option<Scene> {
    let is_shipped = crate::scene::shipped_scenes().iter().any(|scene| scene.name == name);
    let place = if is_shipped { name.to_owned() } else { folder.join(name).to_string_lossy().into_owned() };
    Scene::load(&place, packages).ok()
}
