//! Path files on disk.

use crate::os::output;
use crate::path_file::document::{PathFile, SceneFileEntry};
use crate::path_file::error::PathFileError;
pub use crate::path_file::read::read;
use crate::path_file::write::{FileNames, PartFiles};
use crate::scene::assemble::scene::{PartSource, Scene, SceneFile, SceneOrigin};
use crate::scene::mesh::formats::gltf_document;
use crate::scene::reading::input;
use crate::scene::shipped::shipped_scenes;
use crate::scene::sources::mesh_name::folder_of;
use crate::scene::sources::source::{ModelFile, Origin};
use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

/// The files of a scene as a path file at `out` has to name them. Models that live only in the program are written beside it,
/// into `PATH.models/`, two of one name and different content under different names, unless `out` is a device or a pipe. So are
/// those that a scene describes by a `shape`, each with its mesh in a folder of its own.
///
/// # Errors
/// A model cannot be written.
pub fn model_names(scene: &Scene, out: &Path) -> Result<FileNames, PathFileError> {
    let mut beside = NamesBeside::default();
    let parts = scene.parts.iter().map(|part| part_files(part, out, &mut beside)).collect::<Result<_, _>>()?;
    let named = |file: &Option<SceneFile>| file.as_ref().map(|file| scene_file(file, out));
    Ok(FileNames { scene_file: named(&scene.file), start_file: named(&scene.start), parts })
}

fn part_files<'s>(part: &'s PartSource, out: &Path, beside: &mut NamesBeside<'s>) -> Result<PartFiles, PathFileError> {
    Ok(PartFiles {
        urdf: model_name(&part.urdf, out, beside)?,
        srdf: part.srdf.as_ref().map(|srdf| model_name(srdf, out, beside)).transpose()?,
        mesh_up_axis: part.mesh_up_axis,
        sha256: part.sha256.clone(),
        joint_values: part.joint_values.clone(),
    })
}

fn scene_file(file: &SceneFile, out: &Path) -> SceneFileEntry {
    let name = match &file.origin {
        SceneOrigin::Shipped(name) => (*name).to_owned(),
        SceneOrigin::File(path) => {
            let name = relative(path, out);
            // A file of a shipped scene's name is not that scene.
            let is_shipped = shipped_scenes().iter().any(|scene| scene.name == name);
            if is_shipped { format!("./{name}") } else { name }
        }
    };
    SceneFileEntry { file: name, sha256: file.sha256.clone() }
}

/// Names of models that are written beside one path file: files of different content have different names, also where a file
/// system takes small and capital letters for the same.
#[derive(Default)]
struct NamesBeside<'s> {
    /// Content by the name in small letters.
    taken: HashMap<String, &'s str>,
}

impl<'s> NamesBeside<'s> {
    /// The name that the model has, or, where another one has that already, with `-2`, `-3` and so on.
    fn of(&mut self, url: &str, content: &'s str) -> String {
        let name = Path::new(url).file_name().unwrap_or_default();
        let part = |part: Option<&OsStr>| part.map(|part| part.to_string_lossy().into_owned()).unwrap_or_default();
        let (stem, ending) = (part(Path::new(name).file_stem()), part(Path::new(name).extension()));
        let dot = if ending.is_empty() { "" } else { "." };
        let mut number = 1_u32;
        loop {
            let again = if number == 1 { String::new() } else { format!("-{number}") };
            let name = format!("{stem}{again}{dot}{ending}");
            if *self.taken.entry(name.to_lowercase()).or_insert(content) == content {
                return name;
            }
            number += 1;
        }
    }
}

fn model_name<'s>(file: &'s ModelFile, out: &Path, beside: &mut NamesBeside<'s>) -> Result<String, PathFileError> {
    if file.url.starts_with("package://") {
        return Ok(file.url.clone());
    }
    match &file.origin {
        Origin::File(path) | Origin::Xacro(path, _) => Ok(relative(path, out)),
        Origin::Program(content) => {
            let place = models_folder(out).join(beside.of(&file.url, content));
            written_beside(&place, content.as_bytes(), out)?;
            Ok(relative(&place, out))
        }
        Origin::Made { text, mesh: None } => {
            let place = models_folder(out).join(beside.of(&file.url, text));
            written_beside(&place, text.as_bytes(), out)?;
            Ok(relative(&place, out))
        }
        Origin::Made { text, mesh: Some(mesh) } => {
            let own = Path::new(&file.url).with_extension("");
            let folder = models_folder(out).join(beside.of(&own.to_string_lossy(), text));
            let place = folder.join(&file.url);
            written_beside(&place, text.as_bytes(), out)?;
            let io = |source| PathFileError::Io { path: mesh.clone(), source };
            let bytes = input::bytes(mesh, input::MESH_CAP).map_err(|error| io(std::io::Error::other(error)))?;
            let name = mesh.file_name().ok_or_else(|| io(std::io::ErrorKind::InvalidFilename.into()))?;
            written_beside(&folder.join(name), &bytes, out)?;
            for outer in outer_files(mesh, &bytes) {
                let is_below =
                    Path::new(&outer).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
                let target = folder.join(&outer);
                if !is_below || target == place || target == folder.join(name) {
                    let why = format!(
                        "it names `{outer}`, which is no file of its own below its folder: save the mesh as .glb"
                    );
                    return Err(io(std::io::Error::other(why)));
                }
                let source = folder_of(mesh).join(&outer);
                let bytes = input::bytes(&source, input::MESH_CAP).map_err(|error| io(std::io::Error::other(error)))?;
                written_beside(&target, &bytes, out)?;
            }
            Ok(relative(&place, out))
        }
    }
}

/// The files that a mesh file names.
fn outer_files(mesh: &Path, content: &[u8]) -> Vec<String> {
    let is_gltf = mesh.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gltf"));
    if is_gltf { gltf_document::outer_files(content) } else { Vec::new() }
}

/// Writes a file into a folder beside `out`. Beside a device or a pipe there is no place; the file then says what it would say.
fn written_beside(place: &Path, bytes: &[u8], out: &Path) -> Result<(), PathFileError> {
    if !output::is_file(out) {
        return Ok(());
    }
    let failed = |source| PathFileError::Io { path: place.to_owned(), source };
    std::fs::create_dir_all(folder_of(place)).map_err(failed)?;
    output::write(place, bytes).map_err(failed)
}

/// `PATH.models` for `PATH.json`.
fn models_folder(out: &Path) -> PathBuf {
    out.with_extension("models")
}

/// The name of `path` as seen from the folder of `out`; absolute where the two share no folder.
pub(crate) fn relative(path: &Path, out: &Path) -> String {
    // Behind a link, `..` leads elsewhere than it reads: folders are named as they are.
    let whole = |p: &Path| {
        let place = folder_of(p).canonicalize().ok().zip(p.file_name()).map(|(folder, name)| folder.join(name));
        place.or_else(|| std::path::absolute(p).ok()).unwrap_or_else(|| p.to_owned())
    };
    let (path, out) = (whole(path), whole(out));
    let folder = out.parent().unwrap_or(Path::new("/"));
    let shared = path.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().count() - shared;
    let steps = std::iter::repeat_n("..".into(), up)
        .chain(path.components().skip(shared).map(|c| c.as_os_str().to_string_lossy().into_owned()));
    steps.collect::<Vec<String>>().join("/")
}

/// Writes a path file: whole or not at all, see [`crate::os::output`].
///
/// # Errors
/// The file cannot be written.
pub fn save(file: &PathFile, out: &Path) -> Result<(), PathFileError> {
    let io = |source| PathFileError::Io { path: out.to_owned(), source };
    let json = |source| PathFileError::Json { path: out.to_owned(), place: "the file".into(), source };
    let mut text = serde_json::to_string(file).map_err(json)?;
    text.push('\n');
    output::write(out, text.as_bytes()).map_err(io)
}
