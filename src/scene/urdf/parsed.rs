//! A model from a URDF that `urdf-rs` has parsed already. It knows no lines, so refusals name elements alone.

use crate::scene::mesh::formats::triangles::UpAxis;
use crate::scene::mesh::meshes::{LoadedMesh, MeshError, MeshRequest, Meshes};
use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::sources::mesh_name::Base;
use crate::scene::sources::source::hexadecimal;
use crate::scene::urdf::range::{Range, meant, meant_velocity};
use crate::scene::urdf::values::LONGEST;
use foliate_components::Pose;
use foliate_components::pose::rotation_from_rpy;
use foliate_components::robot::model::{Inertial, JointKind, JointModel, LinkModel, Model};
use foliate_components::robot::shape::Geometry;
use glam::DVec3;
use std::collections::{BTreeMap, HashMap, HashSet};

/// What messages call the document.
const LABEL: &str = "urdf_rs::Robot";

/// Makes a model of a parsed URDF.
pub(crate) struct Converter<'a, 'p> {
    meshes: &'a mut Meshes<'p>,
    base: Base,
    up_axis: UpAxis,
    /// SHA-256 of every mesh file that was read, hexadecimal, by the name that the URDF gives it.
    sha256: BTreeMap<String, String>,
    /// Remarks that do not stop the reading.
    warnings: Vec<SceneError>,
}

fn refusal(element: String, message: impl Into<String>) -> SceneError {
    SceneError::new(LABEL, element, message)
}

fn named(tag: &str, name: &str) -> String {
    format!("<{tag} name=\"{}\">", quoted(name))
}

impl<'a, 'p> Converter<'a, 'p> {
    pub fn new(meshes: &'a mut Meshes<'p>, base: Base, up_axis: UpAxis) -> Self {
        Self { meshes, base, up_axis, sha256: BTreeMap::new(), warnings: Vec::new() }
    }

    /// What was read and remarked.
    pub fn finish(self) -> (BTreeMap<String, String>, Vec<SceneError>) {
        (self.sha256, self.warnings)
    }

    /// The model. That its joints make one tree of its links, and that followers have a leader, is checked where the model is
    /// composed.
    pub fn model(&mut self, robot: &urdf_rs::Robot) -> Result<Model, SceneError> {
        let mut model = Model { name: robot.name.clone(), ..Model::default() };
        let mut links = HashMap::new();
        for link in &robot.links {
            if links.insert(link.name.as_str(), model.links.len()).is_some() {
                return Err(refusal(named("link", &link.name), "a link of this name exists already"));
            }
            model.links.push(self.link(link)?);
        }
        if model.links.is_empty() {
            return Err(refusal("<robot>".into(), "has no links"));
        }
        for described in &robot.joints {
            let (joint, remark) = joint(described, &links)?;
            self.warnings.extend(remark);
            model.joints.push(joint);
        }
        self.free_followers_of_nothing(&mut model.joints);
        Ok(model)
    }

    /// As where the file is read: a follower of a joint that does not exist has a coordinate of its own.
    fn free_followers_of_nothing(&mut self, joints: &mut [JointModel]) {
        let names: HashSet<String> = joints.iter().map(|joint| joint.name.clone()).collect();
        for joint in joints {
            let Some((leader, ..)) = joint.mimic.take_if(|(leader, ..)| !names.contains(leader)) else { continue };
            let message =
                format!("mimics joint `{}`, which does not exist: it is read as a joint of its own", quoted(&leader));
            self.warnings.push(refusal(named("joint", &joint.name), message));
        }
    }

    fn link(&mut self, link: &urdf_rs::Link) -> Result<LinkModel, SceneError> {
        let element = || named("link", &link.name);
        let mut shapes = Vec::with_capacity(link.collision.len());
        for collision in &link.collision {
            shapes.push((pose(&collision.origin, element)?, self.geometry(&collision.geometry, element)?));
        }
        Ok(LinkModel { name: link.name.clone(), shapes, inertial: inertial(&link.inertial, element)? })
    }

    fn geometry(&mut self, geometry: &urdf_rs::Geometry, element: impl Fn() -> String) -> Result<Geometry, SceneError> {
        let length = |value: f64| match value {
            v if !v.is_finite() || v < 0.0 => Err(refusal(element(), format!("{v} m is no length"))),
            v if v > LONGEST => Err(refusal(element(), format!("{v} m is too long")).hint("lengths are metres")),
            v => Ok(v),
        };
        Ok(match geometry {
            urdf_rs::Geometry::Box { size } => {
                size.iter().try_for_each(|&side| length(side).map(drop))?;
                Geometry::Box { half_extents: DVec3::from_array(**size) * 0.5 }
            }
            urdf_rs::Geometry::Sphere { radius } => Geometry::Sphere { radius: length(*radius)? },
            urdf_rs::Geometry::Cylinder { radius, length: long } => {
                Geometry::Cylinder { radius: length(*radius)?, half_length: length(*long)? * 0.5 }
            }
            urdf_rs::Geometry::Capsule { radius, length: long } => {
                Geometry::Capsule { radius: length(*radius)?, half_length: length(*long)? * 0.5 }
            }
            urdf_rs::Geometry::Mesh { filename, scale } => {
                let scale = DVec3::from_array(scale.map_or([1.0; 3], |scale| *scale));
                self.mesh(filename.trim(), scale, element)?
            }
        })
    }

    fn mesh(&mut self, url: &str, scale: DVec3, element: impl Fn() -> String) -> Result<Geometry, SceneError> {
        if scale.to_array().iter().any(|s| !s.is_finite() || *s == 0.0 || s.abs() > LONGEST) {
            return Err(refusal(element(), format!("a scale of {scale} leaves no solid")));
        }
        let request = MeshRequest { url, scale, up_axis: self.up_axis, base: &self.base };
        match self.meshes.load(&request) {
            Ok(LoadedMesh { mesh, sha256 }) => {
                self.sha256.insert(url.to_owned(), hexadecimal(&sha256));
                if !mesh.closed {
                    let remark = refusal(element(), format!("the mesh {} is not closed", quoted(url)));
                    self.warnings.push(remark.hint("only its surface is solid"));
                }
                Ok(Geometry::Mesh(mesh))
            }
            Err(MeshError::Name(message, hint)) => {
                Err(refusal(element(), format!("`{}` {message}", quoted(url))).hint(hint))
            }
            Err(MeshError::File(error)) => Err(error),
        }
    }
}

fn pose(origin: &urdf_rs::Pose, element: impl Fn() -> String) -> Result<Pose, SceneError> {
    let (xyz, [roll, pitch, yaw]) = (DVec3::from_array(*origin.xyz), *origin.rpy);
    if !xyz.is_finite() || ![roll, pitch, yaw].iter().all(|x| x.is_finite()) {
        return Err(refusal(element(), "its origin is not finite"));
    }
    if xyz.abs().max_element() > LONGEST {
        return Err(refusal(element(), format!("is more than {LONGEST} m away")).hint("lengths are metres"));
    }
    Ok(Pose::from_parts(xyz, rotation_from_rpy(roll, pitch, yaw)))
}

/// `urdf-rs` writes zeros where the file gives no mass properties.
fn inertial(inertial: &urdf_rs::Inertial, element: impl Fn() -> String) -> Result<Option<Inertial>, SceneError> {
    match inertial.mass.value {
        0.0 => Ok(None),
        mass if mass.is_finite() && mass > 0.0 => {
            Ok(Some(Inertial { mass, center: pose(&inertial.origin, element)?.translation }))
        }
        mass => Err(refusal(element(), format!("{mass} kg is no mass"))),
    }
}

fn joint(joint: &urdf_rs::Joint, links: &HashMap<&str, usize>) -> Result<(JointModel, Option<SceneError>), SceneError> {
    let element = || named("joint", &joint.name);
    let link = |name: &str| {
        let found = links.get(name).copied();
        found.ok_or_else(|| refusal(element(), format!("link `{}` does not exist", quoted(name))))
    };
    let kind = match joint.joint_type {
        urdf_rs::JointType::Fixed => JointKind::Fixed,
        urdf_rs::JointType::Revolute => JointKind::Revolute,
        urdf_rs::JointType::Continuous => JointKind::Continuous,
        urdf_rs::JointType::Prismatic => JointKind::Prismatic,
        urdf_rs::JointType::Planar => JointKind::Planar,
        urdf_rs::JointType::Floating => JointKind::Floating,
        urdf_rs::JointType::Spherical => {
            return Err(refusal(element(), "is spherical").hint("use three revolute joints, or a floating one"));
        }
    };
    let axis = match (DVec3::from_array(*joint.axis.xyz).try_normalize(), kind) {
        (Some(axis), _) => axis,
        // Fixed and floating joints turn about nothing; exporters write 0 0 0 there.
        (None, JointKind::Fixed | JointKind::Floating) => DVec3::X,
        (None, _) => return Err(refusal(element(), "an axis has a length").hint("give a direction, such as 0 0 1")),
    };
    let Range { kind, limits, remark } = range(joint, kind)?;
    let remark = remark.map(|(message, hint)| refusal(element(), message).hint(hint));
    // A joint without `<limit>` has the velocity 0 here, which no moving joint could keep.
    let velocity_limit = meant_velocity(Some(joint.limit.velocity).filter(|v| v.is_finite() && *v > 0.0));
    let mimic = joint
        .mimic
        .as_ref()
        .map(|mimic| (mimic.joint.clone(), mimic.multiplier.unwrap_or(1.0), mimic.offset.unwrap_or(0.0)));
    if mimic.as_ref().is_some_and(|(_, multiplier, offset)| !(multiplier.is_finite() && offset.is_finite())) {
        return Err(refusal(element(), "its <mimic> is not finite"));
    }
    let model = JointModel {
        name: joint.name.clone(),
        kind,
        parent: link(&joint.parent.link)?,
        child: link(&joint.child.link)?,
        parent_from_joint: pose(&joint.origin, element)?,
        axis,
        limits,
        velocity_limit,
        mimic,
    };
    Ok((model, remark))
}

/// The range of a joint, as it is meant.
fn range(joint: &urdf_rs::Joint, kind: JointKind) -> Result<Range, SceneError> {
    if !matches!(kind, JointKind::Revolute | JointKind::Prismatic) {
        return Ok(Range { kind, limits: (f64::NEG_INFINITY, f64::INFINITY), remark: None });
    }
    let limits = (joint.limit.lower, joint.limit.upper);
    if !(limits.0.is_finite() && limits.1.is_finite() && limits.0 <= limits.1) {
        let message = format!("[{}, {}] are no limits", limits.0, limits.1);
        return Err(refusal(named("joint", &joint.name), message)
            .hint("give finite limits, or make a revolute joint continuous"));
    }
    Ok(meant(kind, limits))
}
