//! `shape` of a part: one solid that the scene describes itself, in place of a URDF.
//!
//! A shape becomes a URDF of one link, `body`, so that whatever reads, writes or checks a part knows one form of it. A path file has the
//! URDF, and a mesh that it names, beside it.

use crate::scene::assemble::scene::Loader;
use crate::scene::mesh::formats::triangles::UpAxis;
use crate::scene::mesh::meshes::{MeshError, MeshRequest, Meshes};
use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::keys::Item;
use crate::scene::sources::mesh_name::{Base, folder_of};
use crate::scene::sources::package::PackagePath;
use crate::scene::sources::source::{ModelFile, Opened, Origin, Place, locate, sha256};
use crate::scene::urdf::read::Context;
use crate::scene::urdf::values::LONGEST;
use foliate_components::robot::model::Model;
use foliate_components::robot::shape::Geometry;
use glam::DVec3;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The name of the only link of a shape.
pub(crate) const LINK: &str = "body";

/// A solid as a scene writes it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ShapeSolid {
    /// Sides, metres.
    Box {
        size: DVec3,
    },
    /// About z.
    Cylinder {
        radius: f64,
        length: f64,
    },
    Sphere {
        radius: f64,
    },
    /// A mesh as the scene names it, with a scale along each axis.
    Mesh {
        url: String,
        scale: DVec3,
    },
}

/// `shape` of a part, as a URDF.
pub(crate) fn opened(
    item: &Item<'_>,
    name: &str,
    up_axis: UpAxis,
    loader: &mut Loader<'_>,
) -> Result<Opened, SceneError> {
    let (solid, mass) = read(item)?;
    let (solid, mesh) = match solid {
        ShapeSolid::Mesh { url, scale } => {
            let (url, mesh) = named(item, &url, loader)?;
            (ShapeSolid::Mesh { url, scale }, mesh)
        }
        other => (other, None),
    };
    let file = |text: String| ModelFile {
        url: format!("{name}.urdf"),
        sha256: sha256(text.as_bytes()),
        origin: Origin::Made { text: text.into(), mesh: mesh.clone() },
    };
    let inertial = match mass {
        Some(mass) => Some((mass, centre(item, &solid, &file(String::new()), up_axis, loader)?)),
        None => None,
    };
    let text = urdf(name, &solid, inertial);
    Ok(Opened { label: format!("{name}.urdf"), file: file(text.clone()), text })
}

/// The solid and its mass.
fn read(item: &Item<'_>) -> Result<(ShapeSolid, Option<f64>), SceneError> {
    let mut keys = item.keys()?;
    let sides = keys.optional("box").map(|item| {
        let sides: [f64; 3] = item.array("x y z")?;
        sides.into_iter().try_for_each(|side| positive(&item, side).map(drop))?;
        Ok(ShapeSolid::Box { size: DVec3::from_array(sides) })
    });
    let cylinder = keys.optional("cylinder").map(|item| {
        let [radius, length] = item.array("radius and length")?;
        Ok(ShapeSolid::Cylinder { radius: positive(&item, radius)?, length: positive(&item, length)? })
    });
    let sphere = keys.optional("sphere").map(|item| {
        let radius = positive(&item, item.number()?)?;
        Ok(ShapeSolid::Sphere { radius })
    });
    let scale = keys.optional("scale");
    let mesh = keys.optional("mesh").map(|item| {
        let scale = scale.as_ref().map_or(Ok(DVec3::ONE), scaled)?;
        Ok(ShapeSolid::Mesh { url: item.string()?.to_owned(), scale })
    });
    if let (Some(scale), None) = (&scale, &mesh) {
        return Err(scale.error("only a mesh has a scale").hint("give the lengths of the solid as they are"));
    }
    let mass = keys.optional("mass").map(|item| positive_mass(&item)).transpose()?;
    keys.finish()?;
    let mut solids = [sides, cylinder, sphere, mesh].into_iter().flatten();
    let hint = "write one of box = [x, y, z], cylinder = [radius, length], sphere = radius, mesh = \"FILE\"";
    match (solids.next(), solids.next()) {
        (Some(solid), None) => Ok((solid?, mass)),
        (None, _) => Err(item.error("names no solid").hint(hint)),
        (Some(_), Some(_)) => Err(item.error("names several solids").hint(hint)),
    }
}

/// A length that bounds a solid, metres.
fn positive(item: &Item<'_>, length: f64) -> Result<f64, SceneError> {
    match length {
        x if x <= 0.0 => Err(item.error(format!("a length of {x} leaves no solid"))),
        x if x > LONGEST => Err(item.error(format!("is {x} m long")).hint("lengths are metres")),
        x => Ok(x),
    }
}

fn positive_mass(item: &Item<'_>) -> Result<f64, SceneError> {
    match item.number()? {
        x if x <= 0.0 => Err(item.error(format!("{x} kg is no mass"))),
        x => Ok(x),
    }
}

/// One number for all axes, or three.
fn scaled(item: &Item<'_>) -> Result<DVec3, SceneError> {
    let scale = match item.number() {
        Ok(scale) => DVec3::splat(scale),
        Err(_) => DVec3::from_array(item.array("along x y z, or one number")?),
    };
    match scale.to_array().iter().any(|s| *s == 0.0 || s.abs() > LONGEST) {
        true => Err(item.error(format!("a scale of {scale} leaves no solid"))),
        false => Ok(scale),
    }
}

/// The name of a mesh as the URDF says it, and the file where the name alone does not lead there.
fn named(item: &Item<'_>, url: &str, loader: &Loader<'_>) -> Result<(String, Option<PathBuf>), SceneError> {
    let place = locate(url, &loader.base, loader.packages)
        .map_err(|(message, hint)| item.error(format!("`{}`: {message}", quoted(url))).hint(hint))?;
    match place {
        Place::Path(_) if url.starts_with("package://") => Ok((url.to_owned(), None)),
        Place::Path(path) => match path.file_name().and_then(|name| name.to_str()) {
            Some(name) => Ok((name.to_owned(), Some(path.clone()))),
            None => Err(item.error(format!("`{}` names no file", quoted(url)))),
        },
        Place::Program(_) => Err(item.error("a mesh in the program is not read")),
    }
}

/// The centre of mass of a solid of one density, in the link.
fn centre(
    item: &Item<'_>,
    solid: &ShapeSolid,
    file: &ModelFile,
    up_axis: UpAxis,
    loader: &mut Loader<'_>,
) -> Result<DVec3, SceneError> {
    let ShapeSolid::Mesh { url, scale } = solid else { return Ok(DVec3::ZERO) };
    let base = file.base();
    let request = MeshRequest { url, scale: *scale, up_axis, base: &base };
    let loaded = loader.meshes.load(&request).map_err(|error| match error {
        MeshError::Name(message, hint) => item.error(format!("`{}` {message}", quoted(url))).hint(hint),
        MeshError::File(error) => error,
    })?;
    let volume = Geometry::Mesh(loaded.mesh).volume();
    let (_, centre) = volume.ok_or_else(|| {
        let message = format!("the mesh {} is not closed: where its mass is, is unknown", quoted(url));
        item.error(message).hint("leave out `mass`, or close the mesh")
    })?;
    Ok(centre)
}

/// The URDF of one link that has the solid as collision and visual element.
pub(crate) fn urdf(name: &str, solid: &ShapeSolid, inertial: Option<(f64, DVec3)>) -> String {
    let spaced = |v: DVec3| format!("{} {} {}", v.x, v.y, v.z);
    let solid = match solid {
        ShapeSolid::Box { size } => format!("<box size=\"{}\"/>", spaced(*size)),
        ShapeSolid::Cylinder { radius, length } => format!("<cylinder radius=\"{radius}\" length=\"{length}\"/>"),
        ShapeSolid::Sphere { radius } => format!("<sphere radius=\"{radius}\"/>"),
        ShapeSolid::Mesh { url, scale } => {
            format!("<mesh filename=\"{}\" scale=\"{}\"/>", escaped(url), spaced(*scale))
        }
    };
    let mut text = format!("<?xml version=\"1.0\"?>\n<robot name=\"{name}\">\n  <link name=\"{LINK}\">\n");
    if let Some((mass, centre)) = inertial {
        let origin = spaced(centre);
        let _ = writeln!(text, "    <inertial><origin xyz=\"{origin}\"/><mass value=\"{mass}\"/></inertial>");
    }
    for element in ["visual", "collision"] {
        let _ = writeln!(text, "    <{element}><geometry>{solid}</geometry></{element}>");
    }
    text.push_str("  </link>\n</robot>\n");
    text
}

/// A text inside an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// The model of a shape that no scene file holds yet; a mesh is named as from the current folder.
///
/// # Errors
/// The mesh cannot be read.
pub(crate) fn model(name: &str, solid: &ShapeSolid, packages: &PackagePath) -> Result<Model, SceneError> {
    let (solid, base) = match solid {
        ShapeSolid::Mesh { url, scale } if !url.starts_with("package://") => {
            let path = Path::new(url);
            let file = path.file_name().map(|file| file.to_string_lossy().into_owned());
            let file = file.ok_or_else(|| SceneError::new(url, "mesh", "names no file"))?;
            let folder = folder_of(path).to_owned();
            (ShapeSolid::Mesh { url: file, scale: *scale }, Base::Directory(folder, None))
        }
        other => (other.clone(), Base::Embedded),
    };
    let mut meshes = Meshes::new(packages);
    let mut warnings = Vec::new();
    let mut context = Context::new(&mut meshes, &base, UpAxis::AsWritten, &mut warnings);
    crate::scene::urdf::read::read(&format!("{name}.urdf"), &urdf(name, &solid, None), &mut context)
}
