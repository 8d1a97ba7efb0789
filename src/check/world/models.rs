//! From a file's parts to bodies, links and shapes, rebuilt from the models that the file names.
//!
//! Coordinates are found by name: the order in which a file writes them does not matter, nor which numbers the planner
//! would give them.

use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::error::CheckError;
use crate::check::report::kind::Kind;
use crate::path_file::document::{PartEntry, PathFile, SurfaceEntry};
use crate::scene::load::{ReadModel, read_model};
use crate::scene::mesh::formats::triangles::UpAxis;
use crate::scene::sources::package::PackagePath;
use foliate_components::Pose;
use foliate_components::pose::pose_from_array;
use foliate_components::robot::model::Model;
use foliate_components::robot::shape::Geometry;
use foliate_components::robot::{JointIndex, JointType, PartKind, PartPlacement, Robot, RootJoint, Source};
use glam::{DQuat, DVec3};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::path::Path;

/// Corners of a polygon, in its link's frame.
pub(crate) fn corners(surface: &SurfaceEntry, polygon: &[u32]) -> Vec<DVec3> {
    polygon.iter().filter_map(|&i| surface.points.get(i as usize)).map(|&p| DVec3::from_array(p)).collect()
}

/// Unit normal by the right-hand rule, from all edges; none for a polygon without area.
pub(crate) fn normal(corners: &[DVec3]) -> Option<DVec3> {
    let next = corners.iter().cycle().skip(1);
    let sum: DVec3 = corners.iter().zip(next).map(|(a, b)| (*a - corners[0]).cross(*b - corners[0])).sum();
    sum.try_normalize()
}

/// A frame on a moving body, or in the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// The body; none for the world.
    pub body: Option<usize>,
    /// Pose of the frame in the body, or in the world.
    pub body_from_frame: Pose,
}

/// A link's rigid body: links of different parts that stand fixed in the world are told apart by their part.
pub(crate) type RigidBody = (usize, Option<usize>);

/// Where the numbers of a joint come from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// Columns of a knot, one per number.
    Columns(Vec<usize>),
    /// `multiplier · leader + offset`.
    Follows { leader: usize, multiplier: f64, offset: f64 },
    /// Zero: an environment's joint that the file does not name.
    Still,
}

/// A joint that moves, and the rigid body beyond it.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    /// `part/joint`.
    pub name: String,
    pub part: usize,
    pub parent: Option<usize>,
    pub parent_from_joint: Pose,
    pub motion: JointType,
    pub value: Value,
    /// The model's limits; infinite where it has none.
    pub limits: (f64, f64),
    /// The model's velocity limit, rad/s or m/s.
    pub velocity_limit: Option<f64>,
}

impl Body {
    /// Where the joint's motion takes its body from the joint frame, for a joint of one coordinate and a knot.
    pub(crate) fn moved_at(&self, world: &World, index: usize, knot: &[f64]) -> Pose {
        let value = world.scalar(index, |column| knot[column]);
        match self.motion {
            JointType::Revolute { axis } => Pose::from_rotation(DQuat::from_axis_angle(axis, value)),
            JointType::Prismatic { axis } => Pose::from_translation(axis * value),
            JointType::Planar | JointType::FreeFlyer => Pose::identity(),
        }
    }
}

/// A part of the file.
pub(crate) struct Part {
    pub name: String,
    pub kind: PartKind,
    pub bodies: Range<usize>,
    /// The body of a root that is not fixed.
    pub root: Option<usize>,
    pub root_link: String,
    /// An object whose root pose is no motion of its own: it follows a carrier, or rests.
    pub floats: bool,
    /// As its files describe it.
    pub model: Model,
}

/// A collision shape.
pub(crate) struct Shape {
    pub link: String,
    pub rigid: RigidBody,
    pub world_fixed: bool,
    pub body_from_shape: Pose,
    pub geometry: Geometry,
}

/// A link: its frame, and the part that it belongs to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub part: usize,
    pub frame: Frame,
}

impl Link {
    pub(crate) fn rigid(&self) -> RigidBody {
        (self.part, self.frame.body)
    }
}

/// Everything that the models say.
pub(crate) struct World {
    pub parts: Vec<Part>,
    /// Parents before children.
    pub bodies: Vec<Body>,
    pub links: HashMap<String, Link>,
    pub shapes: Vec<Shape>,
    /// Pairs of links that the parts' SRDFs disable, the smaller name first.
    pub disabled: HashSet<(String, String)>,
    /// Masses: body, centre in the body's frame, kilograms; by part.
    pub masses: Vec<Vec<(Frame, f64)>>,
}

/// A pair of names, the smaller first.
pub(crate) fn ordered(a: &str, b: &str) -> (String, String) {
    if a <= b { (a.to_owned(), b.to_owned()) } else { (b.to_owned(), a.to_owned()) }
}

impl World {
    /// Reads every model that the file names.
    pub(crate) fn load(
        file: &PathFile,
        base: &Path,
        packages: &PackagePath,
        report: &mut CheckReport,
    ) -> Result<Self, CheckError> {
        // A proof reads the models themselves.
        let packages = &packages.for_path_files().with_mesh_cache(None).with_readable(file.directories(base));
        let mut parts = Vec::with_capacity(file.parts.len());
        for (index, entry) in file.parts.iter().enumerate() {
            let place = format!("parts[{index}]");
            let urdf = located(&entry.urdf, base);
            let srdf = entry.srdf.as_deref().filter(|s| !s.is_empty()).map(|s| located(s, base));
            let read = read_model(&urdf, srdf.as_deref(), up_axis(entry, &place)?, packages)
                .map_err(|error| CheckError::Model { place: place.clone(), error: Box::new(error) })?;
            remarks(entry, &read, report);
            parts.push((read.model, placement(entry, &place)?));
        }
        let composed: Vec<_> = parts.iter().map(|(model, placement)| (model, placement.clone())).collect();
        let robot = Robot::compose(&composed).map_err(|e| CheckError::malformed("parts", e.to_string()))?;
        let models = parts.into_iter().map(|(model, _)| model).collect();
        Self::of_robot(&robot, models, &file.coordinates)
    }

    fn of_robot(robot: &Robot, models: Vec<Model>, coordinates: &[String]) -> Result<Self, CheckError> {
        let columns: HashMap<&str, usize> = coordinates.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect();
        let bodies: Vec<Body> =
            (0..robot.joints.len()).map(|j| body(robot, j, &columns)).collect::<Result<_, CheckError>>()?;
        refuse_unknown(coordinates, &bodies)?;
        let links = robot.links.iter().map(|link| {
            let frame = Frame { body: at(link.joint), body_from_frame: link.joint_from_link };
            (link.name.clone(), Link { part: link.part.at(), frame })
        });
        let shapes = robot.shapes.iter().map(|shape| {
            let link = &robot.links[shape.link.at()];
            let still = robot.parts[link.part.at()].kind == PartKind::Environment;
            Shape {
                link: link.name.clone(),
                rigid: (link.part.at(), at(link.joint)),
                world_fixed: still || link.joint.is_none(),
                body_from_shape: shape.joint_from_shape,
                geometry: shape.geometry.clone(),
            }
        });
        let disabled = robot.disabled_pairs.iter().map(|pair| {
            let name = |l: foliate_components::robot::LinkIndex| robot.links[l.at()].name.as_str();
            ordered(name(pair.first), name(pair.second))
        });
        let mut masses = vec![Vec::new(); robot.parts.len()];
        for link in &robot.links {
            if let Some(inertial) = link.inertial {
                let center = link.joint_from_link * Pose::from_translation(inertial.center);
                let frame = Frame { body: at(link.joint), body_from_frame: center };
                masses[link.part.at()].push((frame, inertial.mass));
            }
        }
        let parts = robot.parts.iter().zip(models).map(|(part, model)| Part {
            name: part.name.clone(),
            kind: part.kind,
            bodies: part.joints.clone(),
            root: at(part.root_joint),
            root_link: robot.links[part.root_link.at()].name.clone(),
            floats: part.kind == PartKind::Object && part.root == RootJoint::FreeFlyer,
            model,
        });
        Ok(Self {
            parts: parts.collect(),
            links: links.collect(),
            shapes: shapes.collect(),
            disabled: disabled.collect(),
            masses,
            bodies,
        })
    }

    pub(crate) fn part(&self, name: &str) -> Option<usize> {
        self.parts.iter().position(|p| p.name == name)
    }

    /// The link of that name, or the refusal of the place in the file that names it.
    pub(crate) fn link(&self, name: &str, place: impl FnOnce() -> String) -> Result<Link, CheckError> {
        self.links
            .get(name)
            .copied()
            .ok_or_else(|| CheckError::malformed(place(), format!("there is no link `{}`", shown(name))))
    }
}

fn at(joint: Option<JointIndex>) -> Option<usize> {
    joint.map(JointIndex::at)
}

fn up_axis(entry: &PartEntry, place: &str) -> Result<UpAxis, CheckError> {
    let Some(word) = entry.mesh_up_axis.as_deref() else { return Ok(UpAxis::AsWritten) };
    UpAxis::of_word(word).ok_or_else(|| {
        let message = format!("`{}` is none of as-written, declared", shown(word));
        CheckError::malformed(format!("{place}.mesh_up_axis"), message)
    })
}

/// What a proof with these models is worth: whether they are those that the path was planned with, and whether they say
/// enough.
fn remarks(entry: &PartEntry, read: &ReadModel, report: &mut CheckReport) {
    let part = shown(&entry.name);
    for (what, sum) in &read.sha256 {
        match entry.sha256.get(what) {
            Some(said) if said.eq_ignore_ascii_case(sum) => {}
            Some(_) => {
                let subject = format!("`{}` of {part} is not the file that the path was planned with", shown(what));
                report.violate(Place::FILE, Kind::Model, subject, None, None);
            }
            None => {
                report.weaker(format!("the file does not say which `{}` of {part} it was planned with", shown(what)))
            }
        }
    }
    for what in entry.sha256.keys().filter(|what| !read.sha256.contains_key(*what)) {
        let subject = format!("{part} was planned with `{}`, which is not read now", shown(what));
        report.violate(Place::FILE, Kind::Model, subject, None, None);
    }
    if (entry.kind.as_str(), entry.root.as_str()) == ("object", "planar") {
        let subject = format!(
            "{part} is an object with a planar root, which no gripper can move: its root is freeflyer or fixed"
        );
        report.violate(Place::FILE, Kind::UnattachedObjectMoved, subject, None, None);
    }
    if read.model.links.iter().all(|link| link.shapes.is_empty()) {
        report.weaker(format!("{part} has no collision shapes: it is never in the way"));
    }
    for warning in &read.warnings {
        report.note(warning.to_string());
    }
}

/// The name of a model file as seen from here.
fn located(name: &str, base: &Path) -> String {
    if name.contains("://") { name.to_owned() } else { base.join(name).to_string_lossy().into_owned() }
}

fn placement(entry: &PartEntry, place: &str) -> Result<PartPlacement, CheckError> {
    let wrong = |key: &str, value: &str, known: &str| {
        Err(CheckError::malformed(format!("{place}.{key}"), format!("`{}` is none of {known}", shown(value))))
    };
    let kind = match entry.kind.as_str() {
        "robot" => PartKind::Robot,
        "object" => PartKind::Object,
        "environment" => PartKind::Environment,
        other => return wrong("kind", other, "robot, object, environment"),
    };
    let root = match entry.root.as_str() {
        "fixed" => RootJoint::Fixed,
        "freeflyer" => RootJoint::FreeFlyer,
        "planar" => RootJoint::Planar,
        other => return wrong("root", other, "fixed, freeflyer, planar"),
    };
    let mimic_follows = match entry.mimic.as_str() {
        "follow" => true,
        "free" => false,
        other => return wrong("mimic", other, "follow, free"),
    };
    if kind == PartKind::Environment && root != RootJoint::Fixed {
        return Err(CheckError::malformed(format!("{place}.root"), "an environment never moves: its root is fixed"));
    }
    let pose = pose_from_array(entry.world_from_root);
    let pose = pose.ok_or_else(|| CheckError::malformed(format!("{place}.world_from_root"), "is no pose"))?;
    // A free-flying root is written in the world.
    let world_from_root = if root == RootJoint::FreeFlyer { Pose::identity() } else { pose };
    Ok(PartPlacement {
        name: entry.name.clone(),
        kind,
        root,
        world_from_root,
        mimic_follows,
        root_bounds: Vec::new(),
        joint_bounds: Vec::new(),
    })
}

fn body(robot: &Robot, index: usize, columns: &HashMap<&str, usize>) -> Result<Body, CheckError> {
    let joint = &robot.joints[index];
    let part = &robot.parts[joint.part.at()];
    let value = match joint.source {
        Source::Follows { leader, multiplier, offset } => Value::Follows { leader: leader.at(), multiplier, offset },
        Source::Coordinates { .. } => {
            let is_root = at(part.root_joint) == Some(index);
            let names = names(if is_root { &part.name } else { &joint.name }, &joint.name, joint.motion);
            let found: Vec<usize> = names.iter().filter_map(|n| columns.get(n.as_str()).copied()).collect();
            match names.iter().find(|n| !columns.contains_key(n.as_str())) {
                None => Value::Columns(found),
                Some(_) if part.kind == PartKind::Environment && found.is_empty() => Value::Still,
                Some(missing) => {
                    let message = format!("`{}` is missing: a coordinate of {}", shown(missing), shown(&part.name));
                    return Err(CheckError::malformed("coordinates", message));
                }
            }
        }
    };
    let scalar = joint.motion.configuration_size() == 1;
    let limits = if scalar { (joint.lower[0], joint.upper[0]) } else { (f64::NEG_INFINITY, f64::INFINITY) };
    Ok(Body {
        name: joint.name.clone(),
        part: joint.part.at(),
        parent: at(joint.parent),
        parent_from_joint: joint.parent_from_joint,
        motion: joint.motion,
        value,
        limits,
        velocity_limit: joint.velocity_limit.filter(|limit| *limit > 0.0),
    })
}

/// Names of a joint's coordinates.
fn names(prefix: &str, joint: &str, motion: JointType) -> Vec<String> {
    let axes: &[&str] = match motion {
        JointType::Revolute { .. } | JointType::Prismatic { .. } => return vec![joint.to_owned()],
        JointType::Planar => &["x", "y", "theta"],
        JointType::FreeFlyer => &["x", "y", "z", "qx", "qy", "qz", "qw"],
    };
    axes.iter().map(|axis| format!("{prefix}/{axis}")).collect()
}

fn refuse_unknown(coordinates: &[String], bodies: &[Body]) -> Result<(), CheckError> {
    let mut known = vec![false; coordinates.len()];
    for body in bodies {
        if let Value::Columns(columns) = &body.value {
            columns.iter().for_each(|&c| known[c] = true);
        }
    }
    match known.iter().position(|k| !k) {
        None => Ok(()),
        Some(index) => {
            let message = format!("`{}` is neither a free joint nor a root's of a part", shown(&coordinates[index]));
            Err(CheckError::malformed(format!("coordinates[{index}]"), message))
        }
    }
}
