//! Loads a scene, or one robot model, by name or path.

use crate::scene::assemble::load;
use crate::scene::assemble::names::start_file::StartFile;
use crate::scene::assemble::scene::Scene;
use crate::scene::mesh::meshes;
use crate::scene::reading::error;
#[cfg(feature = "urdf-rs")]
use crate::scene::sources::mesh_name::Base;
use crate::scene::sources::{follower_limits, source};
#[cfg(feature = "urdf-rs")]
use crate::scene::urdf::parsed;
use crate::scene::urdf::read;
#[cfg(feature = "visuals")]
use crate::scene::urdf::visuals;
use crate::scene::{PackagePath, SceneError, UpAxis, shipped, shipped_scenes};

use foliate_components::Pose;
use foliate_components::problem::Problem;
use foliate_components::robot::model::Model;
use foliate_components::robot::{ComposeError, PartIndex, PartKind, PartPlacement, Robot, RootJoint};
use source::SceneBase;
use std::collections::BTreeMap;
use std::path::Path;

impl Scene {
    /// Reads a scene: a shipped one by its name, or a file.
    ///
    /// # Errors
    /// The first thing that is wrong, with file, line and element.
    pub fn load(name_or_path: &str, packages: &PackagePath) -> Result<Self, SceneError> {
        Self::load_from(name_or_path, packages, None)
    }

    /// Reads a scene as [`Self::load`] does, to start where another file says.
    ///
    /// # Errors
    /// As [`Self::load`], and what is wrong with that file.
    pub fn load_from(
        name_or_path: &str,
        packages: &PackagePath,
        start: Option<&StartFile>,
    ) -> Result<Self, SceneError> {
        if let Some(shipped) = shipped::find(name_or_path) {
            return shipped.load_from(packages, start);
        }
        let path = Path::new(name_or_path);
        if !path.exists() {
            let names = shipped_scenes().iter().map(|s| s.name);
            let hint = error::did_you_mean(name_or_path, names);
            return Err(SceneError::new(name_or_path, "scene", "is neither a shipped scene nor a file").hint(hint));
        }
        load::load_path(path, packages, start)
    }

    /// Reads a scene file.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn from_file(path: impl AsRef<Path>, packages: &PackagePath) -> Result<Self, SceneError> {
        load::load_path(path.as_ref(), packages, None)
    }

    /// Reads a scene from its text. `name` is what messages call it; relative names start at `directory`.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn from_text(name: &str, text: &str, directory: &Path, packages: &PackagePath) -> Result<Self, SceneError> {
        load::load(name, text, SceneBase::Directory(directory.to_owned()), packages, None)
    }
}

impl From<Scene> for Problem {
    fn from(scene: Scene) -> Self {
        scene.problem
    }
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
    /// None of a model that was parsed elsewhere.
    urdf: Option<source::ModelFile>,
}

impl ReadModel {
    /// The model as a robot of one part, `model`, fixed in the world; its remarks grow by those about joints that their followers
    /// leave little room.
    ///
    /// # Errors
    /// Followers that leave their leader no room at all, with the line.
    pub fn compose_alone(&mut self) -> Result<Robot, SceneError> {
        self.compose_as("model")
    }

    /// As [`Self::compose_alone`], as a part of this name.
    ///
    /// # Errors
    /// As [`Self::compose_alone`].
    pub fn compose_as(&mut self, name: &str) -> Result<Robot, SceneError> {
        self.compose_placed(PartPlacement::new(name, PartKind::Robot, RootJoint::Fixed, Pose::identity()))
    }

    /// As [`Self::compose_alone`], as the part that is described.
    ///
    /// # Errors
    /// As [`Self::compose_alone`].
    pub fn compose_placed(&mut self, placement: PartPlacement) -> Result<Robot, SceneError> {
        let robot = Robot::compose(&[(&self.model, placement)]).map_err(|error| {
            match (&error, self.urdf.as_ref().and_then(follower_limits::again)) {
                (ComposeError::NoRoom { room, .. }, Some(urdf)) => follower_limits::refusal(&urdf, room),
                _ => SceneError::new(self.label(), "<robot>", error.to_string()).because(error),
            }
        })?;
        if !robot.narrowed.is_empty()
            && let Some(urdf) = self.urdf.as_ref().and_then(follower_limits::again)
        {
            self.warnings.extend(follower_limits::remarks(&robot, PartIndex(0), &urdf));
        }
        Ok(robot)
    }

    /// The file of the model; none of one that was parsed elsewhere.
    #[must_use]
    pub fn urdf(&self) -> Option<&source::ModelFile> {
        self.urdf.as_ref()
    }

    /// What messages call the file.
    fn label(&self) -> &str {
        self.urdf.as_ref().map_or("urdf_rs::Robot", |urdf| &urdf.url)
    }

    /// Makes a model of a URDF that the crate `urdf-rs` has parsed. Names of meshes that are relative start at `directory`, those with
    /// `package://` are looked up in `packages`; `up_axis` is for COLLADA meshes. The elements that `urdf-rs` does not know are lost,
    /// such as pinocchio's `<collision_checking>`.
    ///
    /// # Errors
    /// The first element that makes no model, by its name; `urdf-rs` keeps no lines.
    #[cfg(feature = "urdf-rs")]
    pub fn from_urdf_rs(
        robot: &urdf_rs::Robot,
        directory: impl AsRef<Path>,
        up_axis: UpAxis,
        packages: &PackagePath,
    ) -> Result<Self, SceneError> {
        let base = Base::Directory(directory.as_ref().to_owned(), None);
        let mut meshes = meshes::Meshes::new(packages);
        let mut converter = parsed::Converter::new(&mut meshes, base, up_axis);
        let model = converter.model(robot)?;
        let (sha256, mut warnings) = converter.finish();
        warnings.extend(meshes.finish());
        Ok(Self { model, warnings, sha256, urdf: None })
    }
}

/// A model's file, by its path or `package://` URL.
fn open(name: &str, packages: &PackagePath) -> Result<source::Opened, SceneError> {
    source::open(name, &SceneBase::Directory(".".into()), packages).map_err(|error| match error {
        source::OpenError::Name(message, hint) => SceneError::new(name, "file", message).hint(hint),
        source::OpenError::File(error) => error,
    })
}

/// A URDF whose visual elements are asked for.
#[cfg(feature = "visuals")]
pub(crate) enum VisualSource<'a> {
    /// By its path or `package://` URL.
    Name(&'a str),
    /// One that was read before.
    Again(&'a source::ModelFile),
}

/// What the links of a URDF look like, and remarks about what cannot be read.
///
/// # Errors
/// The file cannot be read, or reading was stopped.
#[cfg(feature = "visuals")]
pub(crate) fn read_visuals(
    urdf: &VisualSource<'_>,
    up_axis: UpAxis,
    packages: &PackagePath,
) -> Result<(Vec<visuals::LinkVisuals>, Vec<SceneError>), SceneError> {
    // Nothing is searched in them that a cache could keep.
    let packages = &packages.clone().with_mesh_cache(None);
    let mut warnings = Vec::new();
    let urdf = match *urdf {
        VisualSource::Name(name) => open(name, packages)?,
        VisualSource::Again(file) => {
            let now = source::again(file)?;
            if now.file.sha256 != file.sha256 {
                warnings.push(SceneError::new(&now.label, "file", "has changed since it was read"));
            }
            now
        }
    };
    let mut meshes = meshes::Meshes::new(packages);
    let base = urdf.file.base();
    let mut context = read::Context::new(&mut meshes, &base, up_axis, &mut warnings);
    let links = visuals::read(&urdf.label, &urdf.text, &mut context)?;
    Ok((links, warnings))
}

/// The pairs of links that an SRDF disables in a model: names, and why.
///
/// # Errors
/// As [`read_model`].
pub(crate) fn disabled_pairs(
    model: &Model,
    srdf: &str,
    packages: &PackagePath,
) -> Result<Vec<(String, String, String)>, SceneError> {
    let srdf = open(srdf, packages)?;
    // The rest of the file is about things that the model may have already.
    let mut of_file = Model { links: model.links.clone(), joints: model.joints.clone(), ..Model::default() };
    let stop = &packages.limits().stop;
    crate::scene::srdf::read::read(&srdf.label, &srdf.text, &mut of_file, &mut Vec::new(), stop)?;
    Ok(of_file.disabled_pairs)
}

/// Reads a URDF and, where there is one, its SRDF. Both are paths or `package://` URLs. `up_axis` is for COLLADA meshes.
///
/// # Errors
/// As [`Scene::load`].
pub fn read_model(
    urdf: &str,
    srdf: Option<&str>,
    up_axis: UpAxis,
    packages: &PackagePath,
) -> Result<ReadModel, SceneError> {
    let open = |name: &str| open(name, packages);
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
    Ok(ReadModel { model, warnings, sha256, urdf: Some(urdf.file) })
}
