//! The file that a model means by the name of a mesh.

use crate::scene::reading::error::quoted;
use crate::scene::sources::follow::{Followed, follow};
use crate::scene::sources::package::{PackagePath, Unresolved};
use crate::scene::sources::package_xml::PackagesBelow;
use std::path::{Path, PathBuf};

/// Where the names of a model lead.
#[derive(Clone, Debug)]
pub(crate) enum Base {
    /// Relative ones start at the first directory. The model lies there, and in the other where the first has it by a link.
    Directory(PathBuf, Option<PathBuf>),
    /// Nowhere: the model lies in the program.
    Embedded,
}

impl Base {
    /// That of a model in a file.
    pub fn of_file(file: &Path) -> Self {
        let named = folder_of(file).to_owned();
        let real = file.canonicalize().ok().map(|file| folder_of(&file).to_owned());
        let linked = real.filter(|real| named.canonicalize().is_ok_and(|named| named != *real));
        Self::Directory(named, linked)
    }

    /// The directories that the model lies in.
    fn directories(&self) -> Vec<&Path> {
        match self {
            Self::Directory(named, linked) => {
                [Some(named), linked.as_ref()].into_iter().flatten().map(PathBuf::as_path).collect()
            }
            Self::Embedded => Vec::new(),
        }
    }
}

/// The folder that a file lies in. A bare name's is `.`: the empty path leads nowhere.
pub(crate) fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The path of a `file:` URL; any other name as it is.
pub(crate) fn path_of(url: &str) -> &str {
    match url.strip_prefix("file:") {
        Some(path) if path.starts_with('/') => {
            path.strip_prefix("//").filter(|path| path.starts_with('/')).unwrap_or(path)
        }
        _ => url,
    }
}

/// The file of a mesh: by `package://`, `file://`, an absolute path, or one that starts at the model. It lies where files may be read.
pub(crate) fn locate(
    url: &str,
    base: &Base,
    packages: &PackagePath,
    below: &mut PackagesBelow,
) -> Result<PathBuf, Unresolved> {
    let fail = |message: String, hint: &str| Err(Unresolved { message, hint: hint.into() });
    let near = base.directories();
    if url.starts_with("package://") {
        return packages.resolve(url, &near, below);
    }
    let path = path_of(url);
    if let Some((scheme, _)) = path.split_once("://") {
        let hint = "use package://NAME/PATH, file:///PATH or a path relative to the model";
        return fail(format!("`{}://` URLs are not read", quoted(scheme)), hint);
    }
    let path = match (Path::new(path), near.first()) {
        (path, _) if path.is_absolute() => path.to_owned(),
        (path, Some(directory)) => directory.join(path),
        (_, None) => return fail("an embedded model has no directory with meshes".into(), "use primitive shapes"),
    };
    match follow(&path, |target| packages.may_be_read(target, &near)) {
        Followed::Found(path) => Ok(path),
        Followed::Outside(target) => Err(Unresolved::outside(&target, near.first().copied())),
        Followed::Missing => {
            let place = near.first().map_or(String::new(), |place| place.display().to_string());
            let hint = format!("looked in {place}; relative names start at the model's directory");
            fail("no such file".into(), if Path::new(path_of(url)).is_absolute() { "" } else { &hint })
        }
    }
}
