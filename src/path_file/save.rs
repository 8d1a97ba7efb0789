//! Path files on disk.

pub use super::read::read;
use super::{FileNames, PartFiles, PathFile, SceneFileEntry};
use crate::output;
use crate::scene::{ModelFile, Origin, PartSource, Scene, SceneFile, SceneOrigin, folder_of, shipped_scenes};
use std::path::{Path, PathBuf};

/// Why a path file was not written or read.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum PathFileError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error("{}: {place}: {source}", path.display())]
    Json { path: PathBuf, place: String, source: serde_json::Error },
    #[error("{}: `format` is `{found}`; this version reads `{}`", path.display(), super::FORMAT)]
    Format { path: PathBuf, found: String },
}

/// The files of a scene as a path file at `out` has to name them. Models that live only in the program are written beside it,
/// into `PATH.models/`, unless `out` is a device or a pipe.
///
/// # Errors
/// A model cannot be written.
pub fn model_names(scene: &Scene, out: &Path) -> Result<FileNames, PathFileError> {
    let name = |file: &ModelFile| model_name(file, out);
    let files = |part: &PartSource| -> Result<PartFiles, PathFileError> {
        Ok(PartFiles {
            urdf: name(&part.urdf)?,
            srdf: part.srdf.as_ref().map(name).transpose()?,
            mesh_up_axis: part.mesh_up_axis,
            sha256: part.sha256.clone(),
            joint_values: part.joint_values.clone(),
        })
    };
    let parts = scene.parts.iter().map(files).collect::<Result<_, _>>()?;
    Ok(FileNames { scene_file: scene.file.as_ref().map(|file| scene_file(file, out)), parts })
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

fn model_name(file: &ModelFile, out: &Path) -> Result<String, PathFileError> {
    if file.url.starts_with("package://") {
        return Ok(file.url.clone());
    }
    match &file.origin {
        Origin::File(path) => Ok(relative(path, out)),
        Origin::Program(content) => {
            let folder = models_folder(out);
            let place = folder.join(Path::new(&file.url).file_name().unwrap_or_default());
            // Beside a device or a pipe there is no place; the file then says what it would say.
            if output::is_file(out) {
                let failed = |source| PathFileError::Io { path: place.clone(), source };
                std::fs::create_dir_all(&folder).map_err(failed)?;
                output::write(&place, content.as_bytes()).map_err(failed)?;
            }
            Ok(relative(&place, out))
        }
    }
}

/// `PATH.models` for `PATH.json`.
fn models_folder(out: &Path) -> PathBuf {
    out.with_extension("models")
}

/// The name of `path` as seen from the folder of `out`; absolute where the two share no folder.
fn relative(path: &Path, out: &Path) -> String {
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

/// Writes a path file: whole or not at all, see [`crate::output`].
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
