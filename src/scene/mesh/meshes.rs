//! The meshes of one model or scene: each file is read once, and turned into the solids that its users want.

use crate::scene::mesh::cache::key::Key;
use crate::scene::mesh::cache::mesh_cache::{Kept, SMALLEST_FILE};
use crate::scene::mesh::formats::gltf_document::OuterFile;
#[cfg(feature = "visuals")]
use crate::scene::mesh::formats::triangles::Paint;
use crate::scene::mesh::formats::triangles::{Triangles, UpAxis};
use crate::scene::mesh::formats::{dae, gltf, obj, ply, stl};
use crate::scene::mesh::outer_files::{OuterFiles, check_memory};
use crate::scene::reading::error::{LoadStop, SceneError};
use crate::scene::reading::input;
use crate::scene::reading::limits::LoadLimits;
use crate::scene::sources::mesh_name::{Base, locate};
use crate::scene::sources::package::PackagePath;
use crate::scene::sources::package_xml::PackagesBelow;
use foliate_components::robot::shape::Mesh;
use foliate_kernels::collision::solids::mesh_record;
use foliate_systems::events::StopSignal;
use glam::DVec3;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
/// Most triangles of all meshes of a scene, each file counted once.
const TRIANGLES_IN_ALL: usize = 20_000_000;

/// Most bytes of memory that are kept for the next file.
const KEPT_BUFFER: usize = 16 << 20;

/// The meshes of a scene: each file is read once.
pub(crate) struct Meshes<'a> {
    packages: &'a PackagePath,
    /// Packages below the search list, where they were looked for.
    below: PackagesBelow,
    read: HashMap<(PathBuf, [u64; 3], UpAxis), LoadedMesh>,
    /// Those of which colours are asked for.
    #[cfg(feature = "visuals")]
    painted: HashMap<(PathBuf, [u64; 3], UpAxis), PaintedMesh>,
    triangles: usize,
    /// That the meshes take which are read.
    bytes: u64,
    /// SHA-256 of the files that were read.
    sums: HashMap<PathBuf, [u8; 32]>,
    /// About entries of the cache.
    remarks: Vec<SceneError>,
    /// Whether the cache has grown.
    has_kept: bool,
    /// Bytes of the last file, and of the last entry.
    buffers: [Vec<u8>; 2],
}

/// A mesh, and the SHA-256 of the bytes that it was read from.
#[derive(Clone)]
pub(crate) struct LoadedMesh {
    pub mesh: Arc<Mesh>,
    pub sha256: [u8; 32],
}

/// The meshes of a file, one for each of its colours, and the SHA-256 of its bytes.
#[cfg(feature = "visuals")]
#[derive(Clone)]
pub(crate) struct PaintedMesh {
    pub meshes: Vec<(Arc<Mesh>, Option<Paint>)>,
    pub sha256: [u8; 32],
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
        Self {
            packages,
            below: PackagesBelow::default(),
            read: HashMap::new(),
            #[cfg(feature = "visuals")]
            painted: HashMap::new(),
            triangles: 0,
            bytes: 0,
            sums: HashMap::new(),
            remarks: Vec::new(),
            has_kept: false,
            buffers: Default::default(),
        }
    }

    /// How much reading may take.
    pub fn limits(&self) -> &LoadLimits {
        self.packages.limits()
    }

    /// Whether a box stands for a mesh that cannot be read.
    pub fn shows_placeholders(&self) -> bool {
        self.packages.shows_placeholders()
    }

    /// The mesh of that name, scaled.
    pub fn load(&mut self, request: &MeshRequest<'_>) -> Result<LoadedMesh, MeshError> {
        let path = self.locate(request)?;
        let key = (path, request.scale.to_array().map(f64::to_bits), request.up_axis);
        if let Some(mesh) = self.read.get(&key) {
            return Ok(mesh.clone());
        }
        let opened = self.open(&key.0, request);
        // What was cut short has no fault of its own.
        self.packages.limits().reached(&key.0.display().to_string()).map_err(MeshError::File)?;
        let (mesh, sha256) = opened.map_err(MeshError::File)?;
        self.bytes += (size_of_val(&*mesh.vertices) + size_of_val(&*mesh.triangles)) as u64;
        let loaded = LoadedMesh { mesh: Arc::new(mesh), sha256 };
        self.count(loaded.mesh.triangles.len())?;
        self.read.insert(key, loaded.clone());
        Ok(loaded)
    }

    /// The meshes of that name, one for each colour of the file, scaled.
    #[cfg(feature = "visuals")]
    pub fn load_painted(&mut self, request: &MeshRequest<'_>) -> Result<PaintedMesh, MeshError> {
        let path = self.locate(request)?;
        let key = (path, request.scale.to_array().map(f64::to_bits), request.up_axis);
        if let Some(meshes) = self.painted.get(&key) {
            return Ok(meshes.clone());
        }
        let read = self.triangles_of(&key.0, request);
        self.packages.limits().reached(&key.0.display().to_string()).map_err(MeshError::File)?;
        let (content, sha256) = read.map_err(MeshError::File)?;
        self.count(content.triangles.len())?;
        let mut meshes = Vec::new();
        for (paint, part) in content.by_paint() {
            let stop = &self.packages.limits().stop;
            let Some(mesh) = meant(part, request, &|| !stop.is_raised()) else {
                return Err(MeshError::File(SceneError::stopped(request.url, LoadStop::Deadline)));
            };
            meshes.push((Arc::new(mesh), paint));
        }
        let painted = PaintedMesh { meshes, sha256 };
        self.painted.insert(key, painted.clone());
        Ok(painted)
    }

    /// Counts triangles, and refuses too many.
    fn count(&mut self, triangles: usize) -> Result<(), MeshError> {
        self.triangles += triangles;
        if self.triangles > TRIANGLES_IN_ALL {
            let message = format!("with this mesh the model has more than {TRIANGLES_IN_ALL} triangles");
            return Err(MeshError::Name(message, "simplify the collision meshes".into()));
        }
        Ok(())
    }

    /// What a file holds, and the SHA-256 of its bytes.
    fn triangles_of(&mut self, path: &Path, request: &MeshRequest<'_>) -> Result<(Triangles, [u8; 32]), SceneError> {
        let reader = Reader::of(path)?;
        let size = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
        check_memory(self.packages.limits(), path, self.bytes, size.saturating_mul(reader.working_bytes()))?;
        let stop = &self.packages.limits().stop;
        let [bytes, _] = &mut self.buffers;
        input::bytes_into(path, reader.cap(), bytes)?;
        let taken = self.bytes + size.saturating_mul(reader.working_bytes());
        let mut outer = OuterFiles::new(path, self.packages, &mut self.below, taken, reader.working_bytes(), &*bytes);
        let content = reader.read(path, bytes, request.up_axis, &mut |name| outer.read(name), stop);
        // A path file says which bytes a proof is about, so that there is one sum of a file and of what it names.
        let sum = outer.finish()?;
        let content = content?;
        if self.sums.insert(path.to_owned(), sum).is_some_and(|before| before != sum) {
            return Err(SceneError::new(path.display().to_string(), "file", "has changed while the model was read"));
        }
        Ok((content, sum))
    }

    /// The mesh of a file, with what the cache knows of it (or else does afterwards), and the SHA-256 of the file.
    fn open(&mut self, path: &Path, request: &MeshRequest<'_>) -> Result<(Mesh, [u8; 32]), SceneError> {
        let size = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
        let (content, sum) = self.triangles_of(path, request)?;
        let stop = &self.packages.limits().stop;
        let [_, entry] = &mut self.buffers;
        let cache = self.packages.mesh_cache().filter(|_| size >= SMALLEST_FILE as u64);
        let go_on = || !stop.is_raised();
        let Some(mut mesh) = meant(content, request, &go_on) else {
            return Err(SceneError::stopped(&path.display().to_string(), LoadStop::Deadline));
        };
        let Some(cache) = cache else { return Ok((mesh, sum)) };
        let key = Key::new(&sum, Reader::of(path)?.name(), request.up_axis, request.scale);
        let why = match cache.find(&key, entry) {
            Kept::Record(record) if mesh_record::proves(&mesh, &record) => {
                mesh.record = Some(record);
                return Ok((mesh, sum));
            }
            Kept::Record(_) => Some("what it says of the mesh does not hold".to_owned()),
            Kept::Bad(why) => Some(why),
            Kept::Nothing => None,
        };
        if let Some(why) = why {
            let entry = cache.path(&key).display().to_string();
            let remark = SceneError::new(entry, "kept mesh", format!("is not used: {why}"));
            self.remarks.push(remark.hint("it is written anew"));
        }
        mesh.record = mesh_record::record_while(&mesh, &go_on);
        self.has_kept |= mesh.record.as_ref().is_some_and(|record| cache.keep(&key, record));
        Ok((mesh, sum))
    }

    /// SHA-256 of a mesh's file, where it was read.
    pub fn sum(&self, path: &Path) -> Option<[u8; 32]> {
        self.sums.get(path).copied()
    }

    /// When all meshes are read: remarks about the cache, which is cut to its size where it has grown.
    pub fn finish(self) -> Vec<SceneError> {
        if let Some(cache) = self.packages.mesh_cache().filter(|_| self.has_kept) {
            cache.trim();
        }
        self.remarks
    }

    fn locate(&mut self, request: &MeshRequest<'_>) -> Result<PathBuf, MeshError> {
        locate(request.url, request.base, self.packages, &mut self.below)
            .map_err(|e| MeshError::Name(e.message, e.hint))
    }
}

/// The mesh that a model means by a file's triangles; none once `go_on` says no.
fn meant(mut content: Triangles, request: &MeshRequest<'_>, go_on: &dyn Fn() -> bool) -> Option<Mesh> {
    for vertex in &mut content.vertices {
        *vertex *= request.scale;
    }
    if request.scale.to_array().iter().filter(|s| **s < 0.0).count() % 2 == 1 {
        content.triangles.iter_mut().for_each(|t| t.swap(1, 2)); // a mirror turns the inside out
    }
    Mesh::new_while(request.url.to_owned(), content.vertices, content.triangles, go_on)
}

/// What understands the files of an extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reader {
    Stl,
    Obj,
    Dae,
    Ply,
    Gltf,
    Glb,
}

impl Reader {
    fn of(path: &Path) -> Result<Self, SceneError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let all = [Self::Stl, Self::Obj, Self::Dae, Self::Ply, Self::Gltf, Self::Glb];
        all.into_iter().find(|reader| reader.name() == extension).ok_or_else(|| {
            let message =
                format!("meshes of the kind `.{}` are not read", crate::scene::reading::error::quoted(&extension));
            let hint = match extension.as_str() {
                "vtk" | "vtp" | "vtu" => {
                    "convert it: `meshio convert FILE.vtk FILE.stl`; `pip install meshio` has the program"
                }
                _ => "convert it to .stl, .obj, .ply, .dae or .glb",
            };
            SceneError::new(path.display().to_string(), "file", message).hint(hint)
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Stl => "stl",
            Self::Obj => "obj",
            Self::Dae => "dae",
            Self::Ply => "ply",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
        }
    }

    /// Bytes of memory that a byte of a file takes at most while the file is read, itself included; measured
    /// with the tree over it: 5.8, 7.0 and 7.5 for files of four (COLLADA: three) million triangles.
    fn working_bytes(self) -> u64 {
        match self {
            Self::Stl => 6,
            Self::Obj => 8,
            Self::Dae => 8,
            // Not measured: by the bytes of a triangle in the densest of these files, and those that it takes of the others.
            Self::Ply | Self::Gltf | Self::Glb => 24,
        }
    }

    /// Largest file, bytes.
    fn cap(self) -> u64 {
        match self {
            Self::Stl | Self::Obj | Self::Ply | Self::Glb => input::MESH_CAP,
            Self::Dae | Self::Gltf => input::MESH_CAP / 2,
        }
    }

    /// The triangles that a file's bytes hold.
    fn read(
        self,
        path: &Path,
        bytes: &mut Vec<u8>,
        up_axis: UpAxis,
        outer: OuterFile<'_>,
        stop: &StopSignal,
    ) -> Result<Triangles, SceneError> {
        let file = path.display().to_string();
        let mesh = Triangles::watched(stop);
        let mut content = match self {
            Self::Stl => stl::read(&file, bytes, mesh)?,
            Self::Obj => obj::read(&file, bytes, mesh)?,
            Self::Ply => ply::read(&file, bytes, mesh)?,
            Self::Gltf | Self::Glb => gltf::read(&file, bytes, up_axis, outer, mesh)?,
            Self::Dae => dae::read(&file, &input::decode(std::mem::take(bytes), &file)?, up_axis, mesh)?,
        };
        // What was read before may have been much larger.
        bytes.clear();
        bytes.shrink_to(KEPT_BUFFER);
        content.drop_unused();
        if content.triangles.is_empty() {
            return Err(SceneError::new(file, "mesh", "has no triangles").hint("points and lines bound no solid"));
        }
        Ok(content)
    }
}
