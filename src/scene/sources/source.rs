//! The files behind a scene: where a name leads, and what is there.

use crate::scene::reading::error::{SceneError, did_you_mean};
use crate::scene::reading::input;
use crate::scene::reading::prefixes::declared;
use crate::scene::sources::mesh_name::{Base, path_of};
use crate::scene::sources::package::PackagePath;
use crate::scene::sources::package_xml::PackagesBelow;
use crate::scene::sources::{program_files, xacro};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where a scene file's relative names lead.
#[derive(Clone, Debug)]
pub(crate) enum SceneBase {
    Directory(PathBuf),
    /// Of a shipped scene: its name.
    Embedded(&'static str),
}

impl SceneBase {
    /// The folder of a scene on disk.
    pub fn directory(&self) -> Option<&Path> {
        match self {
            Self::Directory(directory) => Some(directory),
            Self::Embedded(_) => None,
        }
    }
}

/// A model file of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelFile {
    /// As the scene writes it: a `package://` URL, or a path relative to the scene file.
    pub url: String,
    /// Where it was read.
    pub origin: Origin,
    /// SHA-256 of the content, hexadecimal.
    pub sha256: String,
}

/// Where a model file was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// From disk.
    File(PathBuf),
    /// From the program; its content.
    Program(&'static str),
    /// From a xacro file on disk, and what the program `xacro` made of it.
    Xacro(PathBuf, Arc<str>),
    /// Made of a `shape` of the scene; its content.
    Made {
        /// The URDF.
        text: Arc<str>,
        /// The mesh that it names by its file name alone, where it names one.
        mesh: Option<PathBuf>,
    },
}

/// A file's name for messages, its text, and what output says about it.
pub(crate) struct Opened {
    pub label: String,
    pub text: String,
    pub file: ModelFile,
}

/// Where a name leads; the error is a message and a hint.
pub(crate) enum Place {
    Path(PathBuf),
    Program(&'static str),
}

pub(crate) fn locate(url: &str, base: &SceneBase, packages: &PackagePath) -> Result<Place, (String, String)> {
    if let Some(place) = url.strip_prefix(program_files::PACKAGE) {
        return program_files::find(place).map(Place::Program).ok_or_else(|| {
            let known = did_you_mean(place, program_files::places());
            ("the program has no such file".to_owned(), known)
        });
    }
    if url.starts_with("package://") {
        let found = packages.resolve(url, &[], &mut PackagesBelow::default());
        return found.map(Place::Path).map_err(|e| (e.message, e.hint));
    }
    let url = path_of(url);
    if let Some((scheme, _)) = url.split_once("://") {
        let hint = "use package://NAME/PATH, or a path relative to the scene file";
        return Err((format!("`{}://` URLs are not read", crate::scene::reading::error::quoted(scheme)), hint.into()));
    }
    match base {
        SceneBase::Directory(directory) => {
            let path = directory.join(url);
            match path.exists() {
                true => Ok(Place::Path(path)),
                false => Err(("no such file".into(), format!("looked for {}", path.display()))),
            }
        }
        SceneBase::Embedded(scene) => match program_files::find(&program_files::below(scene, url)) {
            Some(content) => Ok(Place::Program(content)),
            None => Err(("no such file in the program".into(), String::new())),
        },
    }
}

/// Opens a URDF or SRDF.
pub(crate) fn open(url: &str, base: &SceneBase, packages: &PackagePath) -> Result<Opened, OpenError> {
    match locate(url, base, packages).map_err(|(message, hint)| OpenError::Name(message, hint))? {
        Place::Path(path) => open_path(url, path, packages).map_err(OpenError::File),
        Place::Program(content) => Ok(Opened {
            label: url.to_owned(),
            text: content.to_owned(),
            file: ModelFile {
                url: url.to_owned(),
                origin: Origin::Program(content),
                sha256: sha256(content.as_bytes()),
            },
        }),
    }
}

/// Why a model file is not open.
pub(crate) enum OpenError {
    /// The name leads nowhere: message and hint.
    Name(String, String),
    /// The file is wrong.
    File(SceneError),
}

fn open_path(url: &str, path: PathBuf, packages: &PackagePath) -> Result<Opened, SceneError> {
    let read = read_path(url, path.clone())?;
    if !xacro::has_to_be_expanded(&path, &read.text) {
        return Ok(read);
    }
    if !packages.expands_xacro() {
        return Err(xacro::refusal(&read.label, &read.text, xacro::HINT));
    }
    let text = xacro::expand(&path, &read.text, &packages.limits().stop)?;
    let file = ModelFile {
        url: url.to_owned(),
        sha256: sha256(text.as_bytes()),
        origin: Origin::Xacro(path, text.as_str().into()),
    };
    // Lines are those of what was made of the file.
    Ok(Opened { label: format!("{} (expanded)", read.label), text, file })
}

fn read_path(url: &str, path: PathBuf) -> Result<Opened, SceneError> {
    let content = input::bytes(&path, input::MODEL_CAP)?;
    let sha256 = sha256(&content);
    let label = path.display().to_string();
    let text = declared(input::decode(content, &label)?);
    Ok(Opened { label, text, file: ModelFile { url: url.to_owned(), origin: Origin::File(path), sha256 } })
}

/// A model file, read again.
pub(crate) fn again(file: &ModelFile) -> Result<Opened, SceneError> {
    match &file.origin {
        Origin::File(path) => read_path(&file.url, path.clone()),
        Origin::Xacro(path, text) => {
            let label = format!("{} (expanded)", path.display());
            Ok(Opened { label, text: text.as_ref().to_owned(), file: file.clone() })
        }
        Origin::Program(content) => {
            Ok(Opened { label: file.url.clone(), text: (*content).to_owned(), file: file.clone() })
        }
        Origin::Made { text, .. } => Ok(Opened { label: file.url.clone(), text: text.to_string(), file: file.clone() }),
    }
}

impl ModelFile {
    /// Where the model's own relative names lead.
    pub(crate) fn base(&self) -> Base {
        match &self.origin {
            Origin::File(path) | Origin::Xacro(path, _) => Base::of_file(path),
            Origin::Made { mesh: Some(mesh), .. } => Base::of_file(mesh),
            Origin::Program(_) | Origin::Made { mesh: None, .. } => Base::Embedded,
        }
    }
}

/// SHA-256 of a file's bytes, hexadecimal: as in [`ModelFile::sha256`], and in path files.
#[must_use]
pub fn sha256(content: &[u8]) -> String {
    hexadecimal(&Sha256::digest(content).into())
}

/// A sum as 64 hexadecimal digits.
pub(crate) fn hexadecimal(sum: &[u8; 32]) -> String {
    sum.iter().map(|b| format!("{b:02x}")).collect()
}
