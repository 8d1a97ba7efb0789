//! A URDF document as a model: its links with masses, solids and meshes; the joints are read by `joints`.

use crate::scene::mesh::formats::triangles::UpAxis;
use crate::scene::mesh::meshes::{LoadedMesh, MeshError, MeshRequest, Meshes};
use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::prefixes;
use crate::scene::reading::xml::{Xml, elements};
use crate::scene::sources::mesh_name::Base;
use crate::scene::sources::source::hexadecimal;
use crate::scene::sources::xacro;
use crate::scene::urdf::values::{LONGEST, origin, required_number};
use crate::scene::urdf::{attributes, joints, sizes};
use foliate_components::robot::model::{Inertial, LinkModel, Model};
use foliate_components::robot::shape::{Geometry, Mesh};
use glam::DVec3;
use roxmltree::Node;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Most links of one model.
const LINKS: usize = 20_000;

/// How a model is read.
pub(crate) struct Context<'a, 'p> {
    pub meshes: &'a mut Meshes<'p>,
    pub base: &'a Base,
    pub up_axis: UpAxis,
    /// Whether it may be nothing but frames: what stands around, unlike a robot.
    pub may_be_frames: bool,
    /// Remarks that do not stop the reading.
    pub warnings: &'a mut Vec<SceneError>,
    /// Of meshes that are not closed; one for all of a file goes to the warnings.
    pub open_meshes: Vec<SceneError>,
    /// SHA-256 of every mesh file that was read, hexadecimal, by the name that the URDF gives it.
    pub sha256: BTreeMap<String, String>,
}

impl<'a, 'p> Context<'a, 'p> {
    pub fn new(meshes: &'a mut Meshes<'p>, base: &'a Base, up_axis: UpAxis, warnings: &'a mut Vec<SceneError>) -> Self {
        Self { meshes, base, up_axis, may_be_frames: false, warnings, open_meshes: Vec::new(), sha256: BTreeMap::new() }
    }
}

/// Reads a model from the text of a URDF file.
///
/// # Errors
/// The first thing that is wrong, with its line.
pub(crate) fn read(file: &str, text: &str, context: &mut Context<'_, '_>) -> Result<Model, SceneError> {
    let xml = Xml::parse(file, text, &context.meshes.limits().stop)?;
    let root = robot_element(&xml)?;
    let mut model = Model { name: xml.attribute(root, "name")?.to_owned(), ..Model::default() };
    let mut lines = HashMap::new();
    for (count, node) in elements(root, "link").enumerate() {
        xml.look(count)?;
        let name = xml.attribute(node, "name")?;
        if let Some(first) = lines.insert(name, xml.line(node)) {
            return Err(xml
                .error(node, "a link of this name exists already")
                .hint(format!("the first is at line {first}")));
        }
        if model.links.len() == LINKS {
            return Err(xml.error(node, format!("there are more than {LINKS} links")));
        }
        model.links.push(link(&xml, node, name, context)?);
    }
    if model.links.is_empty() {
        return Err(xml.error(root, "has no links").hint("a model has at least one <link name=\"…\"/>"));
    }
    joints::read(&xml, root, &mut model, (context.may_be_frames, context.warnings))?;
    attributes::KNOWN.tell_unknown(&xml, root, context.warnings);
    context.warnings.extend(prefixes::undeclared(root).map(|prefix| {
        let message = format!("the prefix `{prefix}:` is not declared; it is read as if `xmlns:{prefix}` were there");
        xml.error(root, message)
    }));
    if model.links.iter().all(|link| link.shapes.is_empty()) {
        context.warnings.extend(attributes::tell_shapeless(&xml, root, context.may_be_frames));
    }
    let open_meshes = std::mem::take(&mut context.open_meshes);
    context.warnings.extend(in_one(open_meshes));
    Ok(model)
}

/// The first of some remarks, and how many more there are: robots have dozens of such meshes.
fn in_one(open_meshes: Vec<SceneError>) -> Option<SceneError> {
    let others = open_meshes.len().saturating_sub(1);
    let mut first = open_meshes.into_iter().next()?;
    if others > 0 {
        let are = if others == 1 { "is 1 other".to_owned() } else { format!("are {others} others") };
        first.message = format!("{}, nor {are} of this file", first.message);
        first.hint = "only their surfaces are solid; `foliate inspect` lists them".into();
    }
    Some(first)
}

/// The root, or the reason why this is no URDF.
fn robot_element<'a, 'i>(xml: &'a Xml<'i>) -> Result<Node<'a, 'i>, SceneError> {
    let root = xml.document.root_element();
    let tag = root.tag_name().name();
    if tag != "robot" {
        let hint = match tag {
            "sdf" => "this is an SDF file; convert it to URDF",
            "mujoco" => {
                "this is an MJCF file; convert it to URDF: `pip install mjcf-urdf-simple-converter` does so for rigid bodies and meshes"
            }
            "COLLADA" => "this is a mesh; a URDF refers to it by <mesh filename=…/>",
            _ => "a URDF begins with <robot name=…>",
        };
        return Err(xml.error(root, "is not the root of a URDF").hint(hint));
    }
    match xacro::first_use(root) {
        Some(node) => Err(xml.error(node, "has to be expanded by xacro").hint(xacro::HINT)),
        None => Ok(root),
    }
}

fn link(xml: &Xml<'_>, node: Node<'_, '_>, name: &str, context: &mut Context<'_, '_>) -> Result<LinkModel, SceneError> {
    let mut link = LinkModel { name: name.to_owned(), ..LinkModel::default() };
    if let Some(inertial) = xml.optional_child(node, "inertial")? {
        link.inertial = Some(mass(xml, inertial)?);
    }
    // Pinocchio's extension: `<collision_checking><capsule name="…"/>` makes a capsule of the cylinder of that name.
    let capsules: Vec<&str> = elements(node, "collision_checking")
        .flat_map(|c| elements(c, "capsule"))
        .filter_map(|c| c.attribute("name"))
        .collect();
    for collision in elements(node, "collision") {
        let pose = origin(xml, collision)?;
        let mut shape = geometry(xml, collision, context)?;
        if let (Geometry::Cylinder { radius, half_length }, Some(name)) = (&shape, collision.attribute("name"))
            && capsules.contains(&name)
        {
            shape = Geometry::Capsule { radius: *radius, half_length: *half_length };
        }
        context.warnings.extend(sizes::remark(xml, collision, &shape, context.may_be_frames));
        link.shapes.push((pose, shape));
    }
    Ok(link)
}

fn mass(xml: &Xml<'_>, node: Node<'_, '_>) -> Result<Inertial, SceneError> {
    let element = xml.child(node, "mass")?;
    let mass = required_number(xml, element, "value")?;
    if mass < 0.0 {
        return Err(xml.error(element, format!("a mass of {mass} kg is negative")));
    }
    if let Some(inertia) = xml.optional_child(node, "inertia")? {
        for name in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"] {
            xml.number(inertia, name)?;
        }
    }
    Ok(Inertial { mass, center: origin(xml, node)?.translation })
}

/// A length that bounds a solid.
fn length(xml: &Xml<'_>, node: Node<'_, '_>, name: &str) -> Result<f64, SceneError> {
    let value = required_number(xml, node, name)?;
    check_length(xml, node, name, value)?;
    Ok(value)
}

fn check_length(xml: &Xml<'_>, node: Node<'_, '_>, name: &str, value: f64) -> Result<(), SceneError> {
    match value {
        v if v < 0.0 => Err(xml.error(node, format!("`{name}` is negative: {v}"))),
        v if v > LONGEST => Err(xml.error(node, format!("`{name}` is {v} m")).hint("lengths are metres")),
        _ => Ok(()),
    }
}

/// The solid of a collision or visual element.
pub(super) fn geometry(
    xml: &Xml<'_>,
    collision: Node<'_, '_>,
    context: &mut Context<'_, '_>,
) -> Result<Geometry, SceneError> {
    let geometry = xml.child(collision, "geometry")?;
    let mut shapes = geometry.children().filter(Node::is_element);
    let Some(node) = shapes.next() else {
        return Err(xml.error(geometry, "holds no shape").hint("box, cylinder, sphere, capsule or mesh"));
    };
    if let Some(second) = shapes.next() {
        return Err(xml.error(second, "is a second shape of one <geometry>").hint("give each its own <collision>"));
    }
    match node.tag_name().name() {
        "box" => {
            let size = xml.vector(node, "size")?.ok_or_else(|| xml.error(node, "attribute `size` is missing"))?;
            size.into_iter().try_for_each(|side| check_length(xml, node, "size", side))?;
            Ok(Geometry::Box { half_extents: DVec3::from_array(size) * 0.5 })
        }
        "sphere" => Ok(Geometry::Sphere { radius: length(xml, node, "radius")? }),
        "cylinder" => Ok(Geometry::Cylinder {
            radius: length(xml, node, "radius")?,
            half_length: length(xml, node, "length")? * 0.5,
        }),
        "capsule" => Ok(Geometry::Capsule {
            radius: length(xml, node, "radius")?,
            half_length: length(xml, node, "length")? * 0.5,
        }),
        "mesh" => mesh(xml, node, context),
        other => Err(xml
            .error(node, format!("`{}` is no shape of URDF", quoted(other)))
            .hint("box, cylinder, sphere, capsule or mesh")),
    }
}

/// A solid, and its colour where its file says one.
#[cfg(feature = "visuals")]
pub(super) type Painted = (Geometry, Option<crate::scene::mesh::formats::triangles::Paint>);

/// As [`geometry`], a mesh in pieces of one colour each, where its file has colours.
#[cfg(feature = "visuals")]
pub(super) fn painted_geometry(
    xml: &Xml<'_>,
    visual: Node<'_, '_>,
    context: &mut Context<'_, '_>,
) -> Result<Vec<Painted>, SceneError> {
    let shape = elements(visual, "geometry").flat_map(|g| g.children().filter(Node::is_element)).next();
    let Some(node) = shape.filter(|node| node.tag_name().name() == "mesh") else {
        return Ok(vec![(geometry(xml, visual, context)?, None)]);
    };
    let (url, scale) = named_mesh(xml, node)?;
    let request = MeshRequest { url, scale, up_axis: context.up_axis, base: context.base };
    match context.meshes.load_painted(&request) {
        Ok(painted) => {
            context.sha256.insert(url.to_owned(), hexadecimal(&painted.sha256));
            Ok(painted.meshes.into_iter().map(|(mesh, paint)| (Geometry::Mesh(mesh), paint)).collect())
        }
        Err(error) => Ok(vec![(placeholder(xml, node, url, error, context)?, None)]),
    }
}

/// The name of a mesh and its scale.
fn named_mesh<'n>(xml: &Xml<'_>, node: Node<'n, '_>) -> Result<(&'n str, DVec3), SceneError> {
    let url = xml.attribute(node, "filename")?.trim();
    let scale = DVec3::from_array(xml.vector(node, "scale")?.unwrap_or([1.0; 3]));
    if scale.to_array().iter().any(|s| *s == 0.0 || s.abs() > LONGEST) {
        return Err(xml.error(node, format!("a scale of {scale} leaves no solid")));
    }
    Ok((url, scale))
}

fn mesh(xml: &Xml<'_>, node: Node<'_, '_>, context: &mut Context<'_, '_>) -> Result<Geometry, SceneError> {
    let (url, scale) = named_mesh(xml, node)?;
    let request = MeshRequest { url, scale, up_axis: context.up_axis, base: context.base };
    match context.meshes.load(&request) {
        Ok(LoadedMesh { mesh, sha256 }) => {
            context.sha256.insert(url.to_owned(), hexadecimal(&sha256));
            if !mesh.closed {
                let message = format!("the mesh {} is not closed", quoted(url));
                let remark =
                    SceneError::new(xml.file, crate::scene::reading::xml::label(node), message).at(xml.line(node));
                context.open_meshes.push(remark.hint("only its surface is solid"));
            }
            Ok(Geometry::Mesh(mesh))
        }
        Err(error) => placeholder(xml, node, url, error, context),
    }
}

/// A box in place of a mesh that is not there, and a remark, where that is asked for; else the refusal.
fn placeholder(
    xml: &Xml<'_>,
    node: Node<'_, '_>,
    url: &str,
    error: MeshError,
    context: &mut Context<'_, '_>,
) -> Result<Geometry, SceneError> {
    let error = mesh_refusal(xml, node, url, error);
    // What was cut short is no fault of the file.
    if error.stopped.is_some() || !context.meshes.shows_placeholders() {
        return Err(error);
    }
    context.warnings.push(error);
    Ok(Geometry::Mesh(Arc::new(Mesh::placeholder(url.to_owned()))))
}

fn mesh_refusal(xml: &Xml<'_>, node: Node<'_, '_>, url: &str, error: MeshError) -> SceneError {
    match error {
        MeshError::Name(message, hint) => xml.error(node, format!("`{}` {message}", quoted(url))).hint(hint),
        MeshError::File(mut error) => {
            let user = format!("used at {}:{}", xml.file, xml.line(node));
            error.hint = if error.hint.is_empty() { user } else { format!("{}; {user}", error.hint) };
            error
        }
    }
}
