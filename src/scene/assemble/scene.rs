//! A scene as it was read: the problem, and where its files came from; and what the reading needs.

use crate::scene::mesh::formats::triangles::UpAxis;
use crate::scene::mesh::meshes::Meshes;
use crate::scene::reading::error::SceneError;
use crate::scene::sources::package::PackagePath;
use crate::scene::sources::source::{ModelFile, SceneBase, hexadecimal};
use foliate_components::problem::Problem;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// A problem, and what output says about where it came from.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The problem.
    pub problem: Problem,
    /// One sentence about it.
    pub description: String,
    /// The parts' files, in the order of the parts.
    pub parts: Vec<PartSource>,
    /// Remarks that did not stop the reading.
    pub warnings: Vec<SceneError>,
    /// Which scene file it was; none where the scene was read from a text.
    pub file: Option<SceneFile>,
    /// Where its relative names start, and below which its models may name meshes; none of a scene that lies in the program.
    pub directory: Option<PathBuf>,
    /// The file that says where it starts instead of where it says itself, where there is one.
    pub start: Option<SceneFile>,
}

/// A scene file: where it was, and which one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFile {
    /// Where it was read.
    pub origin: SceneOrigin,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// Where a scene file was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SceneOrigin {
    /// From the program, under this name.
    Shipped(&'static str),
    /// From disk.
    File(PathBuf),
}

/// What the reading of a scene needs.
pub(crate) struct Loader<'a> {
    pub packages: &'a PackagePath,
    pub base: SceneBase,
    pub meshes: Meshes<'a>,
    pub warnings: Vec<SceneError>,
    /// SHA-256 of models that were read, hexadecimal.
    pub sums: HashMap<PathBuf, String>,
}

impl Loader<'_> {
    /// SHA-256 of a file, hexadecimal, where it was read.
    pub(crate) fn sum(&self, path: &Path) -> Option<String> {
        self.sums.get(path).cloned().or_else(|| self.meshes.sum(path).map(|sum| hexadecimal(&sum)))
    }
}

/// The files that a part came from.
#[derive(Clone, Debug, PartialEq)]
pub struct PartSource {
    /// The part's name.
    pub name: String,
    /// Its URDF.
    pub urdf: ModelFile,
    /// Its SRDF, where it has one.
    pub srdf: Option<ModelFile>,
    /// SHA-256 (hexadecimal) of every file that it was read from: by `urdf`, `srdf`, and each mesh as the URDF writes its name.
    pub sha256: BTreeMap<String, String>,
    /// What was done with the up axis of COLLADA meshes.
    pub mesh_up_axis: UpAxis,
    /// Where an environment's joints stand that the scene gives values (radians, metres), by name within the part, in the model's
    /// order. The others stand at zero.
    pub joint_values: Vec<(String, f64)>,
}
