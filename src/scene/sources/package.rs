//! `package://` without ROS: a search list, and no way out of the package.

use crate::scene::mesh::cache::mesh_cache::MeshCache;
use crate::scene::reading::cache_folders::model_cache;
use crate::scene::reading::limits::LoadLimits;
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

/// Where the relative names of a model lead.
#[derive(Clone, Debug)]
pub(crate) enum Base {
    /// To files in this directory.
    Directory(PathBuf),
    /// Nowhere: the model lies in the program.
    Embedded,
}

/// Directories in which packages are looked for, in order, where what was found about meshes is kept, and how much reading may take.
#[derive(Clone, Debug, Default)]
pub struct PackagePath {
    places: Vec<Place>,
    meshes: Option<MeshCache>,
    limits: LoadLimits,
    placeholders: bool,
}

/// A directory, and where the search list has it from.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Place {
    directory: PathBuf,
    from: &'static str,
}

impl Place {
    /// Whether the directory itself is the package of that name; `.` and `..` have the names of what they are.
    fn is_called(&self, package: &str) -> bool {
        let is_name = |directory: &Path| directory.file_name() == Some(OsStr::new(package));
        match self.directory.file_name() {
            Some(_) => is_name(&self.directory),
            None => self.directory.canonicalize().is_ok_and(|directory| is_name(&directory)),
        }
    }
}

/// Why a URL names no file: a message, and the way out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Unresolved {
    pub message: String,
    pub hint: String,
}

/// Environment variables of the search list, and whether they list install prefixes (packages lie in `share/`).
const VARIABLES: [(&str, bool); 3] =
    [("FOLIATE_PACKAGE_PATH", false), ("ROS_PACKAGE_PATH", false), ("AMENT_PREFIX_PATH", true)];

impl PackagePath {
    /// The whole list: the given directories, `FOLIATE_PACKAGE_PATH`, `ROS_PACKAGE_PATH`, `AMENT_PREFIX_PATH` (in each
    /// prefix `share/`), and the user's model cache.
    #[must_use]
    pub fn from_environment(given: &[PathBuf]) -> Self {
        let mut path = Self::only(given);
        for (variable, is_prefix) in VARIABLES {
            let Some(value) = std::env::var_os(variable) else { continue };
            for entry in std::env::split_paths(&value).filter(|p| !p.as_os_str().is_empty()) {
                let directory = if is_prefix { entry.join("share") } else { entry };
                path.places.push(Place { directory, from: variable });
            }
        }
        if let Some(directory) = model_cache() {
            path.places.push(Place { directory, from: "the model cache" });
        }
        path
    }

    /// Nothing but these directories.
    #[must_use]
    pub fn only(given: &[PathBuf]) -> Self {
        // The empty name is that of no directory, though files below it have names.
        let named = |directory: &PathBuf| match directory.as_os_str().is_empty() {
            true => PathBuf::from("."),
            false => directory.clone(),
        };
        let place = |directory: &PathBuf| Place { directory: named(directory), from: "--package-path" };
        Self { places: given.iter().map(place).collect(), ..Self::default() }
    }

    /// Where meshes are kept between runs, or that they are not. Without this they are not: nothing is written to a disk whose
    /// owner has not asked for it.
    #[must_use]
    pub fn with_mesh_cache(mut self, cache: impl Into<Option<MeshCache>>) -> Self {
        self.meshes = cache.into();
        self
    }

    /// How much reading with this may take.
    #[must_use]
    pub fn with_limits(mut self, limits: LoadLimits) -> Self {
        self.limits = limits;
        self
    }

    /// Lets a small box stand for each mesh that cannot be read ([`Mesh::placeholder`](foliate_components::robot::shape::Mesh::placeholder)),
    /// with a remark, instead of refusing the model: for what shows models. Nothing may be planned or proved with it.
    #[must_use]
    pub fn with_placeholders(mut self) -> Self {
        self.placeholders = true;
        self
    }

    /// Whether a box stands for a mesh that cannot be read.
    pub(crate) fn shows_placeholders(&self) -> bool {
        self.placeholders
    }

    /// How much reading may take.
    #[must_use]
    pub fn limits(&self) -> &LoadLimits {
        &self.limits
    }

    /// Where meshes are kept, if they are.
    #[must_use]
    pub fn mesh_cache(&self) -> Option<&MeshCache> {
        self.meshes.as_ref()
    }

    /// The first directory of the list that is the package of that name.
    #[must_use]
    pub fn find(&self, package: &str) -> Option<PathBuf> {
        self.candidates(package).find(|d| d.is_dir())
    }

    /// The file that `package://name/path` (or `package:///name/path`) names.
    pub(crate) fn resolve(&self, url: &str) -> Result<PathBuf, Unresolved> {
        let fail = |message: &str, hint: &str| Err(Unresolved { message: message.into(), hint: hint.into() });
        let rest = url.strip_prefix("package://").unwrap_or(url).trim_start_matches('/');
        let Some((package, inner)) = rest.split_once('/').filter(|(p, i)| !p.is_empty() && !i.is_empty()) else {
            return fail("names no file in a package", "write package://NAME/PATH");
        };
        let inner = Path::new(inner);
        if package == ".." || !is_below(inner) {
            return fail("leaves its package", "`..` and absolute paths are not followed in package URLs");
        }
        let mut refused = None;
        for directory in self.candidates(package) {
            match contained(&directory, inner) {
                Contained::File(path) => return Ok(path),
                Contained::Outside(target) => refused = refused.or(Some(target)),
                Contained::Missing => {}
            }
        }
        if let Some(target) = refused {
            let message = format!("leaves its package by a link, to {}", target.display());
            return fail(&message, "links out of a package are not followed; copy the file into it");
        }
        let is_there = self.candidates(package).any(|d| d.is_dir());
        let message = match is_there {
            true => format!("package `{package}` has no such file"),
            false => format!("package `{package}` is not found"),
        };
        fail(&message, &format!("{}; give its parent directory with --package-path DIR", self.looked_at()))
    }

    /// Directories that may be the package of that name.
    fn candidates(&self, package: &str) -> impl Iterator<Item = PathBuf> {
        self.places.iter().flat_map(move |place| {
            let is_itself = place.is_called(package);
            [Some(place.directory.join(package)), is_itself.then(|| place.directory.clone())].into_iter().flatten()
        })
    }

    fn looked_at(&self) -> String {
        if self.places.is_empty() {
            return "no directory was given to look in".into();
        }
        let shown: Vec<_> = self.places.iter().map(|p| format!("{} ({})", p.directory.display(), p.from)).collect();
        format!("looked in {}", shown.join(", "))
    }
}

/// Whether a relative path goes only downwards.
pub(crate) fn is_below(path: &Path) -> bool {
    path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir))
}

/// Where a path below a directory leads.
pub(crate) enum Contained {
    File(PathBuf),
    /// It exists, but elsewhere.
    Outside(PathBuf),
    Missing,
}

/// Follows a path below a directory, links included, and tells where it ends.
pub(crate) fn contained(directory: &Path, inner: &Path) -> Contained {
    let (Ok(root), Ok(target)) = (directory.canonicalize(), directory.join(inner).canonicalize()) else {
        return Contained::Missing;
    };
    if target.starts_with(&root) { Contained::File(target) } else { Contained::Outside(target) }
}

#[cfg(test)]
mod tests {
    use super::*;

    use std::path::Path;

    fn message(url: &str) -> String {
        PackagePath::default().resolve(url).expect_err("no package is there").message
    }

    #[test]
    fn urls_that_leave_the_package_are_refused_before_any_file_is_looked_for() {
        for url in
            ["package://a/../b.stl", "package://../a/b.stl", "package://a/b/../../../c.stl", "package://a//etc/passwd"]
        {
            assert_eq!(message(url), "leaves its package", "{url}");
        }
        assert_eq!(message("package://a"), "names no file in a package");
        assert_eq!(message("package://a/b.stl"), "package `a` is not found");
    }

    #[test]
    fn two_and_three_slashes_name_the_same_file() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = PackagePath::only(&[root.to_path_buf()]);
        let two = path.resolve("package://src/lib.rs").expect("src is a directory of this package");
        assert_eq!(path.resolve("package:///src/lib.rs"), Ok(two));
    }
}
