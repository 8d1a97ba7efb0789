//! `package://` without ROS: a search list, the package that a model lies in, and no way out of what may be read.

use crate::scene::mesh::cache::mesh_cache::MeshCache;
use crate::scene::reading::cache_folders::model_cache;
use crate::scene::reading::error::quoted;
use crate::scene::reading::limits::LoadLimits;
use crate::scene::sources::follow::{Followed, follow, is_below_one};
use crate::scene::sources::package_xml::{PackagesBelow, above, holder, name_in};
use crate::scene::sources::xacro::XacroUse;
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

/// Directories in which packages are looked for, in order, where what was found about meshes is kept, and how much reading may take.
///
/// What lies below these directories may be read by any name that a model gives it. So may what lies in the directory of the model
/// and in the package that holds it, which is looked for upwards.
#[derive(Clone, Debug, Default)]
pub struct PackagePath {
    places: Vec<Place>,
    /// Directories in which nothing is looked for, but below which everything may be read.
    readable: Vec<PathBuf>,
    meshes: Option<MeshCache>,
    limits: LoadLimits,
    placeholders: bool,
    xacro: XacroUse,
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

/// What the search list calls directories that a user gave.
const GIVEN: &str = "--package-path";

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

    /// Nothing but these directories, and the package that a model lies in.
    #[must_use]
    pub fn only(given: &[PathBuf]) -> Self {
        let place = |directory: &PathBuf| Place { directory: named(directory), from: GIVEN };
        Self { places: given.iter().map(place).collect(), ..Self::default() }
    }

    /// Lets models name what lies below these directories or in the packages that hold them, as [`Scene`](crate::scene::Scene) does for
    /// the directory of a scene file.
    #[must_use]
    pub fn with_readable(mut self, directories: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        self.readable.extend(directories.into_iter().map(|directory| named(directory.as_ref())));
        self
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

    /// Which xacro files the program `xacro` may expand. Without this none: it evaluates what is written in them.
    #[must_use]
    pub fn with_xacro(mut self, whose: XacroUse) -> Self {
        self.xacro = whose;
        self
    }

    /// The same for models and scenes that a path file names, whose author may be another than that of the models.
    #[must_use]
    pub fn for_path_files(&self) -> Self {
        let whose = if self.xacro == XacroUse::Always { self.xacro } else { XacroUse::Never };
        self.clone().with_xacro(whose)
    }

    /// Whether the program `xacro` may expand files.
    pub(crate) fn expands_xacro(&self) -> bool {
        self.xacro != XacroUse::Never
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
        self.candidates(package, |_| true).into_iter().find(|d| d.is_dir())
    }

    /// The file that `package://name/path` (or `package:///name/path`) names in a model or scene that lies in the directories `near`.
    pub(crate) fn resolve(&self, url: &str, near: &[&Path], below: &mut PackagesBelow) -> Result<PathBuf, Unresolved> {
        let fail = |message: &str, hint: &str| Err(Unresolved { message: message.into(), hint: hint.into() });
        let rest = url.strip_prefix("package://").unwrap_or(url).trim_start_matches('/');
        let Some((package, inner)) = rest.split_once('/').filter(|(p, i)| !p.is_empty() && !i.is_empty()) else {
            return fail("names no file in a package", "write package://NAME/PATH");
        };
        let inner = Path::new(inner);
        if matches!(package, "." | "..") || inner.is_absolute() {
            return fail("leaves its package", "a package has a name, and the path in it is relative");
        }
        let (mut is_there, mut outside) = (false, None);
        let mut look = |directories: Vec<PathBuf>| {
            directories.into_iter().find_map(|directory| {
                is_there |= directory.is_dir();
                match self.within(&directory, (package, inner), near) {
                    Followed::Found(path) => return Some(path),
                    Followed::Outside(target) => drop(outside.get_or_insert(target)),
                    Followed::Missing => {}
                }
                None
            })
        };
        let given = |place: &&Place| place.from == GIVEN;
        let list: Vec<&Path> = self.places.iter().map(|place| place.directory.as_path()).collect();
        let found = look(self.candidates(package, given))
            .or_else(|| look(self.packages_above(package, near)))
            .or_else(|| look(self.candidates(package, |place| !given(place))))
            .or_else(|| look(below.named(package, &list)));
        match (found, outside) {
            (Some(path), _) => Ok(path),
            (None, Some(target)) => Err(Unresolved::outside(&target, near.first().copied())),
            (None, None) => {
                let package = quoted(package);
                let message = match is_there {
                    true => format!("package `{package}` has no such file"),
                    false => format!("package `{package}` is not found"),
                };
                let above = if near.is_empty() { "" } else { ", and above the model" };
                let hint = format!("{}{above}; give its parent directory with --package-path DIR", self.looked_at());
                fail(&message, &hint)
            }
        }
    }

    /// Where a path in a directory that may be the package leads. A link may lead to the same package in another place, as
    /// `colcon build --symlink-install` lays packages out.
    fn within(&self, directory: &Path, (package, inner): (&str, &Path), near: &[&Path]) -> Followed {
        let is_same = |target: &Path| {
            let folder = target.parent().unwrap_or(target);
            is_below(inner) && above(folder).any(|directory| name_in(directory).as_deref() == Some(package))
        };
        follow(&directory.join(inner), |target| {
            is_below_one(target, [directory].into_iter()) || self.may_be_read(target, near) || is_same(target)
        })
    }

    /// Whether a place without links lies below a directory of the list, of `near`, or in a package that holds one of `near`.
    pub(crate) fn may_be_read(&self, target: &Path, near: &[&Path]) -> bool {
        let places = self.places.iter().map(|place| place.directory.as_path());
        let in_package = |directory: PathBuf| holder(&directory).is_some_and(|package| target.starts_with(package));
        is_below_one(target, self.near(near).chain(places)) || self.near(near).filter_map(real).any(in_package)
    }

    /// Where models and scenes lie.
    fn near<'a>(&'a self, near: &'a [&'a Path]) -> impl Iterator<Item = &'a Path> {
        near.iter().copied().chain(self.readable.iter().map(PathBuf::as_path))
    }

    /// The directories above those of a model or scene that are the package of that name, by their `package.xml` or their folder.
    fn packages_above(&self, package: &str, near: &[&Path]) -> Vec<PathBuf> {
        let is_it = |directory: &&Path| {
            directory.file_name() == Some(OsStr::new(package)) || name_in(directory).as_deref() == Some(package)
        };
        let mut found: Vec<PathBuf> = Vec::new();
        for directory in self.near(near).filter_map(real) {
            for package in above(&directory).filter(is_it) {
                if !found.iter().any(|known| known == package) {
                    found.push(package.to_owned());
                }
            }
        }
        found
    }

    /// Directories that may be the package of that name, in those places of the list that are asked for.
    fn candidates(&self, package: &str, is_asked: impl Fn(&&Place) -> bool) -> Vec<PathBuf> {
        let of_place = |place: &Place| {
            let is_itself = place.is_called(package);
            [Some(place.directory.join(package)), is_itself.then(|| place.directory.clone())].into_iter().flatten()
        };
        self.places.iter().filter(is_asked).flat_map(of_place).collect()
    }

    fn looked_at(&self) -> String {
        if self.places.is_empty() {
            return "no directory was given to look in".into();
        }
        let shown: Vec<_> = self.places.iter().map(|p| format!("{} ({})", p.directory.display(), p.from)).collect();
        format!("looked in {}", shown.join(", "))
    }
}

impl Unresolved {
    /// A place that may not be read, named in a file that lies in a directory.
    pub(crate) fn outside(target: &Path, named_in: Option<&Path>) -> Self {
        // What lies above both lets a model's other files be read, too, unless that is half of the disk.
        let both = named_in.and_then(real).and_then(|named_in| {
            let common = named_in.ancestors().find(|directory| target.starts_with(directory))?;
            above(common).next().map(Path::to_owned)
        });
        let allowed = both.unwrap_or_else(|| target.parent().unwrap_or(target).to_owned());
        Self {
            message: format!("leads to {}, outside of the directories that may be read", shown(target)),
            hint: format!("--package-path {} allows it", shown(&allowed)),
        }
    }
}

/// A directory without links; none where it is missing.
fn real(directory: &Path) -> Option<PathBuf> {
    directory.canonicalize().ok()
}

/// The empty name is that of no directory, though files below it have names.
fn named(directory: &Path) -> PathBuf {
    if directory.as_os_str().is_empty() { PathBuf::from(".") } else { directory.to_owned() }
}

/// A path on one line.
fn shown(path: &Path) -> String {
    path.display().to_string().chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

/// Whether a relative path goes only downwards.
fn is_below(path: &Path) -> bool {
    path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir))
}

#[cfg(test)]
mod tests {
    use super::*;

    use std::path::Path;

    fn resolved(path: &PackagePath, url: &str) -> Result<PathBuf, Unresolved> {
        path.resolve(url, &[], &mut PackagesBelow::default())
    }

    fn message(path: &PackagePath, url: &str) -> String {
        resolved(path, url).expect_err("nothing is there").message
    }

    #[test]
    fn urls_stay_in_their_package_and_in_what_was_given() {
        let nothing = PackagePath::default();
        for url in ["package://../a/b.stl", "package://./b.stl", "package://a//etc/passwd"] {
            assert_eq!(message(&nothing, url), "leaves its package", "{url}");
        }
        assert_eq!(message(&nothing, "package://a"), "names no file in a package");
        assert_eq!(message(&nothing, "package://a/b.stl"), "package `a` is not found");
        let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let path = PackagePath::only(&[src]);
        assert!(resolved(&path, "package://scene/../lib.rs").is_ok(), "it lies below what was given");
        for url in ["package://scene/../../Cargo.toml", "package://scene/../../missing"] {
            assert!(message(&path, url).starts_with("leads to /"), "{url}");
        }
    }

    #[test]
    fn two_and_three_slashes_name_the_same_file() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = PackagePath::only(&[root.to_path_buf()]);
        let two = resolved(&path, "package://src/lib.rs").expect("src is a directory of this package");
        assert_eq!(resolved(&path, "package:///src/lib.rs"), Ok(two));
    }
}
