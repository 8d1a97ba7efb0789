//! Loads a scene, or one robot model, by name or path.

use crate::scene::assemble::load;
use crate::scene::mesh::meshes;
use crate::scene::reading::error;
use crate::scene::sources::{follower_limits, source};
use crate::scene::urdf::read;
use crate::scene::{PackagePath, Scene, SceneError, UpAxis, shipped, shipped_scenes};

use foliate_components::Pose;
use foliate_components::robot::model::Model;
use foliate_components::robot::{ComposeError, PartIndex, PartKind, PartPlacement, Robot, RootJoint};
use source::SceneBase;
use std::collections::BTreeMap;
use std::path::Path;

/// Loads a scene: a shipped one by its name, or a file.
///
/// # Errors
/// The first thing that is wrong, with file, line and element.
pub fn load_scene(name_or_path: &str, packages: &PackagePath) -> Result<Scene, SceneError> {
    if let Some(shipped) = shipped::find(name_or_path) {
        return shipped.load(packages);
    }
    let path = Path::new(name_or_path);
    if !path.exists() {
        let names = shipped_scenes().iter().map(|s| s.name);
        let hint = error::did_you_mean(name_or_path, names);
        return Err(SceneError::new(name_or_path, "scene", "is neither a shipped scene nor a file").hint(hint));
    }
    load::load_path(path, packages)
}

/// Loads a scene from its text. `name` is what messages call it; relative names start at `directory`.
///
/// # Errors
/// As [`load_scene`].
pub fn load_scene_text(name: &str, text: &str, directory: &Path, packages: &PackagePath) -> Result<Scene, SceneError> {
    load::load(name, text, SceneBase::Directory(directory.to_owned()), packages)
}

/// A model as its files describe it, and remarks about them.
#[derive(Clone, Debug)]
pub struct ReadModel {
    /// The model.
    pub model: Model,
    /// Remarks that did not stop the reading.
    pub warnings: Vec<SceneError>,
    /// SHA-256 (hexadecimal) of every file that was read: by `urdf`, `srdf`, and each mesh as the URDF writes its name.
    pub sha256: BTreeMap<String, String>,
    urdf: source::ModelFile,
}

impl ReadModel {
    /// The model as a robot of one part, `model`, fixed in the world; its remarks grow by those about joints that their followers
    /// leave little room.
    ///
    /// # Errors
    /// Followers that leave their leader no room at all, with the line.
    pub fn compose_alone(&mut self) -> Result<Robot, SceneError> {
        let placement = PartPlacement {
            name: "model".into(),
            kind: PartKind::Robot,
            root: RootJoint::Fixed,
            world_from_root: Pose::identity(),
            mimic_follows: true,
            root_bounds: Vec::new(),
            joint_bounds: Vec::new(),
        };
        let robot = Robot::compose(&[(&self.model, placement)]).map_err(|error| {
            match (&error, follower_limits::again(&self.urdf)) {
                (ComposeError::NoRoom { room, .. }, Some(urdf)) => follower_limits::refusal(&urdf, room),
                _ => SceneError::new(&self.urdf.url, "<robot>", error.to_string()),
            }
        })?;
        if !robot.narrowed.is_empty()
            && let Some(urdf) = follower_limits::again(&self.urdf)
        {
            self.warnings.extend(follower_limits::remarks(&robot, PartIndex(0), &urdf));
        }
        Ok(robot)
    }
}

/// Reads a URDF and, where there is one, its SRDF. Both are paths or `package://` URLs. `up_axis` is for COLLADA meshes.
///
/// # Errors
/// As [`load_scene`].
pub fn read_model(
    urdf: &str,
    srdf: Option<&str>,
    up_axis: UpAxis,
    packages: &PackagePath,
) -> Result<ReadModel, SceneError> {
    let open = |name: &str| {
        let base = SceneBase::Directory(".".into());
        source::open(name, &base, packages).map_err(|error| match error {
            source::OpenError::Name(message, hint) => SceneError::new(name, "file", message).hint(hint),
            source::OpenError::File(error) => error,
        })
    };
    let urdf = open(urdf)?;
    let mut warnings = Vec::new();
    let mut meshes = meshes::Meshes::new(packages);
    let base = urdf.file.base();
    let mut context = read::Context::new(&mut meshes, &base, up_axis, &mut warnings);
    let mut model = read::read(&urdf.label, &urdf.text, &mut context)?;
    let mut sha256 = context.sha256;
    sha256.insert("urdf".into(), urdf.file.sha256.clone());
    if let Some(srdf) = srdf {
        let srdf = open(srdf)?;
        crate::scene::srdf::read::read(&srdf.label, &srdf.text, &mut model, &mut warnings, &packages.limits().stop)?;
        sha256.insert("srdf".into(), srdf.file.sha256);
    }
    warnings.extend(meshes.finish());
    Ok(ReadModel { model, warnings, sha256, urdf: urdf.file })
}
