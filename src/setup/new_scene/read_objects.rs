//! The objects of a request, read.

use crate::scene::assemble::parts::shape::{self, ShapeSolid};
use crate::scene::{PackagePath, SceneError, UpAxis, read_model};
use crate::setup::error::SetupError;
use crate::setup::handles::FoundHandle;
use crate::setup::new_scene::request::NewScene;
use crate::setup::objects::RigidObject;
use crate::setup::request::ObjectRequest;
use crate::setup::surfaces::{FoundSurface, resting_faces};
use crate::setup::writing::numbers::{number, point, quoted};
use foliate_components::robot::model::Model;
use glam::DVec3;
use std::path::Path;

/// An object as it was read.
pub(super) struct Object {
    pub name: String,
    /// For the scene: `urdf = …` or `shape = …`.
    pub source: String,
    pub model: Model,
    pub rigid: RigidObject,
    pub faces: Vec<FoundSurface>,
    /// By gripper.
    pub handles: Vec<(usize, FoundHandle)>,
}

/// Reads the objects.
pub(super) fn objects(
    request: &NewScene,
    packages: &PackagePath,
    warnings: &mut Vec<SceneError>,
) -> Result<Vec<Object>, SetupError> {
    if request.objects.is_empty() {
        return Err(SetupError::Request("no object is given; name at least one with --object".into()));
    }
    let mut found: Vec<Object> = Vec::new();
    for one in &request.objects {
        let word = match one.word() {
            word if word == "robot" || word == "table" => format!("{word}_object"),
            word => word,
        };
        let count = found.iter().filter(|o| o.name == word || o.name.starts_with(&format!("{word}_"))).count();
        let name = if count == 0 { word } else { format!("{word}_{}", count + 1) };
        let (model, source) = match one {
            ObjectRequest::Urdf(file) => {
                let mut read = read_model(file, None, UpAxis::AsWritten, packages)?;
                warnings.append(&mut read.warnings);
                (read.model, format!("urdf = {}", quoted(&seen_from(file, &request.place))))
            }
            ObjectRequest::Box(size) => shaped(&name, ShapeSolid::Box { size: *size }, request, packages)?,
            ObjectRequest::Cylinder(radius, length) => {
                shaped(&name, ShapeSolid::Cylinder { radius: *radius, length: *length }, request, packages)?
            }
            ObjectRequest::Sphere(radius) => shaped(&name, ShapeSolid::Sphere { radius: *radius }, request, packages)?,
            ObjectRequest::Mesh(file, scale) => {
                let solid = ShapeSolid::Mesh { url: file.clone(), scale: DVec3::splat(*scale) };
                shaped(&name, solid, request, packages)?
            }
        };
        let rigid = RigidObject::of(&name, &model)?;
        let faces = if rigid.is_ball() { Vec::new() } else { resting_faces(&rigid) };
        if faces.is_empty() && !rigid.is_ball() {
            return Err(SetupError::Request(format!(
                "`{name}` rests on none of its faces: its centre of mass is less than 6 mm inside of each"
            )));
        }
        found.push(Object { name, source, model, rigid, faces, handles: Vec::new() });
    }
    Ok(found)
}

/// The model of a shape, and how the scene writes it.
fn shaped(
    name: &str,
    solid: ShapeSolid,
    request: &NewScene,
    packages: &PackagePath,
) -> Result<(Model, String), SetupError> {
    let model = shape::model(name, &solid, packages)?;
    let source = match &solid {
        ShapeSolid::Box { size } => format!("box = {}", point(*size)),
        ShapeSolid::Cylinder { radius, length } => format!("cylinder = [{}, {}]", number(*radius), number(*length)),
        ShapeSolid::Sphere { radius } => format!("sphere = {}", number(*radius)),
        ShapeSolid::Mesh { url, scale } => {
            let scale = if scale.x == 1.0 { String::new() } else { format!(", scale = {}", scale.x) };
            format!("mesh = {}{scale}", quoted(&seen_from(url, &request.place)))
        }
    };
    Ok((model, format!("shape = {{ {source} }}")))
}

/// The name of a file as a scene writes it.
pub(super) fn seen_from(file: &str, place: &Path) -> String {
    match file.contains("://") || Path::new(file).is_absolute() {
        true => file.to_owned(),
        false => crate::path_file::save::relative(Path::new(file), place),
    }
}
