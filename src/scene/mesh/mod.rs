//! Triangle meshes from STL, OBJ and COLLADA files: strict readers with caps, in metres.
//!
//! COLLADA units and node transforms are applied. The declared up axis is not, unless asked for: ROS, pinocchio and coal
//! take mesh coordinates as the link's, and published models rely on it (TIAGo's collision meshes declare `Y_UP` and
//! agree with its STL meshes only as they are written).

mod dae;
mod obj;
mod stl;

use super::error::SceneError;
use super::input;
use super::package::{Contained, PackagePath, contained, is_below};
use foliate_components::robot::shape::Mesh;
use glam::DVec3;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most triangles of one mesh.
const TRIANGLES: usize = 4_000_000;
/// Most triangles of all meshes of a scene, each file counted once.
const TRIANGLES_IN_ALL: usize = 20_000_000;

/// Triangles as a file holds them, in metres, unscaled.
#[derive(Debug, Default)]
pub(crate) struct Triangles {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl Triangles {
    /// Refuses the next triangle where the cap is reached, and vertex numbers beyond 32 bits.
    fn check_room(&self) -> Result<(), String> {
        match self.triangles.len() >= TRIANGLES || self.vertices.len() >= 3 * TRIANGLES {
            true => Err(format!("has more than {TRIANGLES} triangles")),
            false => Ok(()),
        }
    }

    /// Adds a polygon as a fan about its first vertex.
    fn push_polygon(&mut self, corners: &[u32]) -> Result<(), String> {
        for pair in corners.windows(2).skip(1) {
            self.check_room()?;
            self.triangles.push([corners[0], pair[0], pair[1]]);
        }
        Ok(())
    }

    /// Drops triangles with two corners at one position, which bound nothing, and vertices that no triangle names: files
    /// share their arrays among meshes, and a stray vertex would only widen every bound on the solid.
    fn drop_unused(&mut self) {
        let at = |i: u32| self.vertices[i as usize];
        self.triangles.retain(|&[a, b, c]| at(a) != at(b) && at(b) != at(c) && at(c) != at(a));
        let mut number = vec![u32::MAX; self.vertices.len()];
        let mut kept = Vec::new();
        for corner in self.triangles.iter_mut().flatten() {
            let known = &mut number[*corner as usize];
            if *known == u32::MAX {
                *known = kept.len() as u32;
                kept.push(self.vertices[*corner as usize]);
            }
            *corner = *known;
        }
        self.vertices = kept;
    }
}

/// What to do with a COLLADA file's `<up_axis>`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum UpAxis {
    /// Take coordinates as the link's, as ROS and pinocchio do.
    #[default]
    AsWritten,
    /// Turn the declared axis to z.
    Declared,
}

/// Where the relative names of a model lead.
#[derive(Clone, Debug)]
pub(crate) enum Base {
    /// To files in this directory.
    Directory(PathBuf),
    /// Nowhere: the model lies in the program.
    Embedded,
}

/// The meshes of a scene: each file is read once.
pub(crate) struct Meshes<'a> {
    packages: &'a PackagePath,
    read: HashMap<(PathBuf, [u64; 3], UpAxis), Arc<Mesh>>,
    triangles: usize,
}

/// What a model asks for.
pub(crate) struct MeshRequest<'a> {
    /// As the model writes it.
    pub url: &'a str,
    pub scale: DVec3,
    pub up_axis: UpAxis,
    pub base: &'a Base,
}

/// Why a mesh is not there: the name leads nowhere, or the file is wrong.
pub(crate) enum MeshError {
    /// Message and hint; the model's element is to blame.
    Name(String, String),
    /// Located in the mesh file.
    File(SceneError),
}

impl<'a> Meshes<'a> {
    pub fn new(packages: &'a PackagePath) -> Self {
        Self { packages, read: HashMap::new(), triangles: 0 }
    }

    /// The mesh of that name, scaled.
    pub fn load(&mut self, request: &MeshRequest<'_>) -> Result<Arc<Mesh>, MeshError> {
        let path = self.resolve(request.url, request.base)?;
        let key = (path, request.scale.to_array().map(f64::to_bits), request.up_axis);
        if let Some(mesh) = self.read.get(&key) {
            return Ok(mesh.clone());
        }
        let mut content = read(&key.0, request.up_axis).map_err(MeshError::File)?;
        self.triangles += content.triangles.len();
        if self.triangles > TRIANGLES_IN_ALL {
            let message = format!("with this mesh the model has more than {TRIANGLES_IN_ALL} triangles");
            return Err(MeshError::Name(message, "simplify the collision meshes".into()));
        }
        for vertex in &mut content.vertices {
            *vertex *= request.scale;
        }
        if request.scale.to_array().iter().filter(|s| **s < 0.0).count() % 2 == 1 {
            content.triangles.iter_mut().for_each(|t| t.swap(1, 2)); // a mirror turns the inside out
        }
        let mesh = Arc::new(Mesh::new(request.url.to_owned(), content.vertices, content.triangles));
        self.read.insert(key, mesh.clone());
        Ok(mesh)
    }

    fn resolve(&self, url: &str, base: &Base) -> Result<PathBuf, MeshError> {
        let fail = |message: &str, hint: &str| Err(MeshError::Name(message.into(), hint.into()));
        let hint = "use package://NAME/PATH, or a path below the model's directory";
        if url.starts_with("package://") {
            return self.packages.resolve(url).map_err(|e| MeshError::Name(e.message, e.hint));
        }
        if let Some((scheme, _)) = url.split_once("://") {
            return fail(&format!("`{}://` URLs are not read", super::error::quoted(scheme)), hint);
        }
        let inner = Path::new(url);
        if !is_below(inner) {
            return fail("leads out of the model's directory", hint);
        }
        match base {
            Base::Embedded => fail("an embedded model has no directory with meshes", "use primitive shapes"),
            Base::Directory(directory) => match contained(directory, inner) {
                Contained::File(path) => Ok(path),
                Contained::Outside(_) => fail("leads out of the model's directory by a link", hint),
                Contained::Missing => {
                    let place = directory.display();
                    fail("no such file", &format!("looked in {place}; relative names start at the model's directory"))
                }
            },
        }
    }
}

/// Reads a mesh file by its extension.
pub(crate) fn read(path: &Path, up_axis: UpAxis) -> Result<Triangles, SceneError> {
    let file = path.display().to_string();
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let mut content = match extension.as_str() {
        "stl" => stl::read(&file, &input::bytes(path, input::MESH_CAP)?),
        "obj" => obj::read(&file, &input::text(path, input::MESH_CAP)?),
        "dae" => dae::read(&file, &input::text(path, input::MESH_CAP / 2)?, up_axis),
        _ => {
            let message = format!("meshes of the kind `.{}` are not read", super::error::quoted(&extension));
            Err(SceneError::new(&file, "file", message).hint("convert it to .stl, .obj or .dae"))
        }
    }?;
    content.drop_unused();
    if content.triangles.is_empty() {
        return Err(SceneError::new(file, "mesh", "has no triangles").hint("points and lines bound no solid"));
    }
    Ok(content)
}
