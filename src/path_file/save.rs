//! Path files on disk.

use super::PathFile;
use crate::output;
use crate::scene::{ModelFile, Origin, Scene};
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

/// Largest path file that is read, bytes: some hundred thousand knots.
const CAP: u64 = 1 << 28;

/// URDF and SRDF of every part as a path file at `out` has to name them. Models that live only in the program are written
/// beside it, into `PATH.models/`, unless `out` is a device or a pipe.
///
/// # Errors
/// A model cannot be written.
pub fn model_names(scene: &Scene, out: &Path) -> Result<Vec<(String, Option<String>)>, PathFileError> {
    let name = |file: &ModelFile| model_name(file, out);
    scene.parts.iter().map(|part| Ok((name(&part.urdf)?, part.srdf.as_ref().map(name).transpose()?))).collect()
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
    let whole = |p: &Path| std::path::absolute(p).unwrap_or_else(|_| p.to_owned());
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

/// Reads a path file.
///
/// # Errors
/// It cannot be read, is larger than 256 MiB, is not JSON, or is of another format.
pub fn read(path: &Path) -> Result<PathFile, PathFileError> {
    let io = |source| PathFileError::Io { path: path.to_owned(), source };
    let size = std::fs::metadata(path).map_err(io)?.len();
    if size > CAP {
        return Err(io(std::io::Error::other(format!("{size} bytes are more than the {CAP} that are read"))));
    }
    let text = std::fs::read_to_string(path).map_err(io)?;
    let json = |source: serde_json::Error| {
        let place = super::place::json_path(&text, source.line(), source.column());
        PathFileError::Json { path: path.to_owned(), place, source }
    };
    let format: Format = serde_json::from_str(&text).map_err(json)?;
    if format.format != super::FORMAT {
        return Err(PathFileError::Format { path: path.to_owned(), found: format.format });
    }
    serde_json::from_str(&text).map_err(json)
}

/// Only the format, so that a file of another one is refused by its name and not by a missing field.
#[derive(serde::Deserialize)]
struct Format {
    format: String,
}
