//! A path file's path, on the robot that the models it names make.
//!
//! The models are read and composed; nothing is proved. Coordinates are found by name.

use crate::path_file::document::{AttachmentEntry, PartEntry, PathFile, SegmentEntry, SurfaceEntry};
use crate::path_file::error::PathFileError;
use crate::path_file::names::{columns, ignored_pairs};
use crate::path_file::read::read;
use crate::planner::trajectory::curve::Interpolation;
use crate::planner::trajectory::error::TrajectoryError;
use crate::planner::trajectory::trajectory::Trajectory;
use crate::scene::load::{disabled_pairs, read_model};
use crate::scene::mesh::formats::triangles::UpAxis;
use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::sources::package::PackagePath;
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::path::{Attachment, ManipulationPath, Segment, SegmentTiming};
use foliate_components::pose::pose_from_array;
use foliate_components::robot::configuration::Group;
use foliate_components::robot::model::{GripperModel, HandleModel, Model, SurfaceModel};
use foliate_components::robot::{DisabledPair, PartKind, PartPlacement, Robot, RootJoint};
use glam::DVec3;
use std::path::{Path, PathBuf};

/// The format whose motions are straight, with or without times.
const STRAIGHT: &str = "foliate.path/1";
/// How far a quaternion of a knot may be from length 1.
const UNIT: f64 = 1e-3;

/// Why a path file makes no path.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadPathError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] PathFileError),
    /// A model that it names cannot be read.
    #[error("{place}: {error}")]
    Model {
        /// The part: `parts[2]`.
        place: String,
        /// Why.
        error: Box<SceneError>,
    },
    /// What it says does not fit together.
    #[error("{place}: {message}")]
    Malformed {
        /// The element: `segments[3].attachments[0]`.
        place: String,
        /// What is wrong with it.
        message: String,
    },
}

fn malformed(place: impl Into<String>, message: impl Into<String>) -> LoadPathError {
    LoadPathError::Malformed { place: place.into(), message: message.into() }
}

/// Where the models of a part are, as this program finds them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartModel {
    /// A path or a `package://` URL.
    pub urdf: String,
    /// What is done with the up axis of COLLADA meshes.
    pub up_axis: UpAxis,
}

/// A path file's path, on the robot that the models it names make.
#[derive(Clone, Debug)]
pub struct LoadedPath {
    /// All parts as one tree. Joints of environments are coordinates here.
    pub robot: Robot,
    /// The path, in the order of the robot's coordinates. States and transitions are numbered as they come; constraints and the
    /// certificate are left out.
    pub path: ManipulationPath,
    /// By part of the robot.
    pub models: Vec<PartModel>,
    /// Pairs of links that the file leaves untested, besides those that the models' SRDFs disable.
    pub ignored_pairs: Vec<DisabledPair>,
    /// Remarks about the models.
    pub warnings: Vec<SceneError>,
    /// Below these its models may name meshes.
    pub directories: Vec<PathBuf>,
    states: Vec<String>,
    transitions: Vec<String>,
    interpolation: Interpolation,
    /// For each coordinate of the robot its place in a row of the file.
    columns: Vec<Option<usize>>,
}

impl LoadedPath {
    /// Reads a path file and the models that it names. Names of files are relative to its folder.
    ///
    /// # Errors
    /// The file or a model cannot be read; something in the file does not fit together.
    pub fn read(path: &Path, packages: &PackagePath) -> Result<Self, LoadPathError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::of_file(&read(path)?, folder, packages)
    }

    /// The path of a file that was read already. Relative names start at `folder`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn of_file(file: &PathFile, folder: &Path, packages: &PackagePath) -> Result<Self, LoadPathError> {
        let directories = file.directories(folder);
        let packages = &packages.for_path_files().with_readable(&directories);
        let (mut parts, mut models, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
        for (index, entry) in file.parts.iter().enumerate() {
            let place = format!("parts[{index}]");
            let named = PartModel { urdf: located(&entry.urdf, folder), up_axis: up_axis(entry, &place)? };
            let refused = |error| LoadPathError::Model { place: place.clone(), error: Box::new(error) };
            let read = read_model(&named.urdf, None, named.up_axis, packages).map_err(refused)?;
            warnings.extend(read.warnings);
            let mut model = read.model;
            if let Some(srdf) = &entry.srdf {
                // An unreadable SRDF does not change the path: it only says which links may touch.
                match disabled_pairs(&model, &located(srdf, folder), packages) {
                    Ok(pairs) => model.disabled_pairs = pairs,
                    Err(error) if error.stopped.is_some() => return Err(refused(error)),
                    Err(error) => warnings.push(error),
                }
            }
            documents(file, &entry.name, &mut model)?;
            parts.push((model, placement(entry, &place)?));
            models.push(named);
        }
        let composed: Vec<_> = parts.iter().map(|(model, placement)| (model, placement.clone())).collect();
        let robot = Robot::compose(&composed).map_err(|e| malformed("parts", e.to_string()))?;
        let interpolation = match file.format == STRAIGHT {
            true => Interpolation::Linear,
            false => Interpolation::Hermite,
        };
        let columns = columns(&file.coordinates, &robot).map_err(|(place, message)| malformed(place, message))?;
        let reader = Reader { robot: &robot, columns: &columns, width: file.coordinates.len(), interpolation };
        let segments: Result<Vec<Segment>, LoadPathError> =
            file.segments.iter().enumerate().map(|(index, segment)| reader.segment(index, segment)).collect();
        let path = ManipulationPath { segments: segments?, ..ManipulationPath::default() };
        let states = file.segments.iter().map(|segment| segment.state.clone()).collect();
        let transitions = file.segments.iter().map(|segment| segment.transition.clone()).collect();
        let ignored_pairs = ignored_pairs(file, &robot);
        Ok(Self {
            robot,
            path,
            models,
            directories,
            ignored_pairs,
            warnings,
            states,
            transitions,
            interpolation,
            columns,
        })
    }

    /// A row of numbers by the coordinates of the file, in the order of the robot's coordinates.
    ///
    /// # Panics
    /// If the row is shorter than the coordinates of the file.
    #[must_use]
    pub fn in_order<T: Copy + Default>(&self, row: &[T]) -> Vec<T> {
        self.columns.iter().map(|column| column.map_or_else(T::default, |column| row[column])).collect()
    }

    /// By segment the name of its state.
    #[must_use]
    pub fn states(&self) -> &[String] {
        &self.states
    }

    /// By segment the name of its transition.
    #[must_use]
    pub fn transitions(&self) -> &[String] {
        &self.transitions
    }

    /// How the path goes from knot to knot.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// What a robot program asks of the path.
    ///
    /// # Errors
    /// [`TrajectoryError::NoTimes`] where the file has no times.
    pub fn trajectory(&self) -> Result<Trajectory<'_>, TrajectoryError> {
        let states = self.states.iter().map(String::as_str).collect();
        Trajectory::new(&self.robot, &self.path, states, self.interpolation)
    }
}

#[cfg(feature = "visuals")]
impl crate::scene::visuals::Visuals {
    /// The visual elements of the models that a path file names. A link of which one cannot be read, and a link without any, shows its
    /// collision shapes.
    ///
    /// # Errors
    /// A model cannot be read.
    pub fn read(path: &LoadedPath, packages: &PackagePath) -> Result<Self, SceneError> {
        let models = path.models.iter().map(|model| (model.urdf.as_str(), model.up_axis));
        Self::with_shapes(&path.robot, models, &packages.for_path_files().with_readable(&path.directories))
    }

    /// As [`Self::read`], but a link without visual elements shows nothing.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn of_path(path: &LoadedPath, packages: &PackagePath) -> Result<Self, SceneError> {
        let models = path.models.iter().map(|model| (model.urdf.as_str(), model.up_axis));
        Self::of_names(&path.robot, models, &packages.for_path_files().with_readable(&path.directories))
    }
}

/// The name of a model file as seen from here.
pub(crate) fn located(name: &str, folder: &Path) -> String {
    if name.contains("://") { name.to_owned() } else { folder.join(name).to_string_lossy().into_owned() }
}

fn up_axis(entry: &PartEntry, place: &str) -> Result<UpAxis, LoadPathError> {
    let Some(word) = entry.mesh_up_axis.as_deref() else { return Ok(UpAxis::AsWritten) };
    let place = || format!("{place}.mesh_up_axis");
    UpAxis::of_word(word).ok_or_else(|| malformed(place(), format!("`{}` is no up axis", quoted(word))))
}

fn placement(entry: &PartEntry, place: &str) -> Result<PartPlacement, LoadPathError> {
    let refuse =
        |key: &str, value: &str| malformed(format!("{place}.{key}"), format!("`{}` is unknown", quoted(value)));
    let kind = match entry.kind.as_str() {
        "robot" => PartKind::Robot,
        "object" => PartKind::Object,
        "environment" => PartKind::Environment,
        other => return Err(refuse("kind", other)),
    };
    let root = match entry.root.as_str() {
        "fixed" => RootJoint::Fixed,
        "freeflyer" => RootJoint::FreeFlyer,
        "planar" => RootJoint::Planar,
        other => return Err(refuse("root", other)),
    };
    let mimic_follows = match entry.mimic.as_str() {
        "follow" => true,
        "free" => false,
        other => return Err(refuse("mimic", other)),
    };
    let pose = pose_from_array(entry.world_from_root);
    let pose = pose.ok_or_else(|| malformed(format!("{place}.world_from_root"), "is no pose"))?;
    // A free-flying root is written in the world.
    let world_from_root = if root == RootJoint::FreeFlyer { foliate_components::Pose::identity() } else { pose };
    let (name, (root_bounds, joint_bounds)) = (entry.name.clone(), Default::default());
    Ok(PartPlacement { name, kind, root, world_from_root, mimic_follows, root_bounds, joint_bounds })
}

/// Gives a part's model the grippers, handles and surfaces that the file says: those of an SRDF, and those of a scene.
fn documents(file: &PathFile, part: &str, model: &mut Model) -> Result<(), LoadPathError> {
    let local = |name: &str| name.strip_prefix(part)?.strip_prefix('/').map(str::to_owned);
    let on = |place: &str, name: &str, link: &str| {
        local(link)
            .ok_or_else(|| malformed(format!("documents.{place}[\"{}\"].link", quoted(name)), "is of another part"))
    };
    let no_pose = |place: &str, name: &str| malformed(format!("documents.{place}[\"{}\"]", quoted(name)), "is no pose");
    for (name, entry) in &file.documents.grippers {
        let Some(own) = local(name) else { continue };
        let link = on("grippers", name, &entry.link)?;
        let pose = pose_from_array(entry.link_from_gripper).ok_or_else(|| no_pose("grippers", name))?;
        model.grippers.push(GripperModel { name: own, link, link_from_gripper: pose, clearance: 0.0 });
    }
    for (name, entry) in &file.documents.handles {
        let Some(own) = local(name) else { continue };
        let link = on("handles", name, &entry.link)?;
        let pose = pose_from_array(entry.link_from_handle).ok_or_else(|| no_pose("handles", name))?;
        model.handles.push(HandleModel {
            name: own,
            link,
            link_from_handle: pose,
            clearance: 0.0,
            mask: entry.mask,
            mask_complement: entry.mask_complement,
            approaching_direction: DVec3::X,
        });
    }
    for (name, entry) in &file.documents.surfaces {
        let Some(own) = local(name) else { continue };
        let link = on("surfaces", name, &entry.link)?;
        whole(name, entry)?;
        let points = entry.points.iter().map(|&point| DVec3::from_array(point)).collect();
        model.surfaces.push(SurfaceModel { name: own, link, points, polygons: entry.polygons.clone() });
    }
    Ok(())
}

/// Refuses a surface that has points without a place, or polygons without an area.
fn whole(name: &str, entry: &SurfaceEntry) -> Result<(), LoadPathError> {
    let place = |key: &str, number| format!("documents.surfaces[\"{}\"].{key}[{number}]", quoted(name));
    if let Some(number) = entry.points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
        return Err(malformed(place("points", number), "is not finite"));
    }
    let fits = |polygon: &Vec<u32>| polygon.len() > 2 && polygon.iter().all(|&i| (i as usize) < entry.points.len());
    match entry.polygons.iter().position(|polygon| !fits(polygon)) {
        Some(number) => Err(malformed(place("polygons", number), "wants three or more indices of points")),
        None => Ok(()),
    }
}

/// Reads the segments of a file.
struct Reader<'a> {
    robot: &'a Robot,
    columns: &'a [Option<usize>],
    /// Numbers of a knot in the file.
    width: usize,
    interpolation: Interpolation,
}

impl Reader<'_> {
    fn segment(&self, index: usize, entry: &SegmentEntry) -> Result<Segment, LoadPathError> {
        let place = |key: &str| format!("segments[{index}].{key}");
        let knots = self.rows(&entry.knots).ok_or_else(|| malformed(place("knots"), self.wanted()))?;
        let is_unit = |q: &[f64]| (q.iter().map(|x| x * x).sum::<f64>().sqrt() - 1.0).abs() < UNIT;
        let roots = || self.robot.space.factors.iter().filter(|factor| factor.group == Group::FreeFlyer);
        if let Some(knot) = knots.iter().position(|q| !roots().all(|root| is_unit(&q[root.q + 3..root.q + 7]))) {
            return Err(malformed(format!("{}[{knot}]", place("knots")), "has a quaternion that is not of length 1"));
        }
        let velocities = match (&entry.velocities, self.interpolation) {
            (None, Interpolation::Linear) => Some(Vec::new()),
            (None, Interpolation::Hermite) => None,
            (Some(_), Interpolation::Linear) => {
                let message = format!("are not known to `{STRAIGHT}`, whose motions are straight");
                return Err(malformed(place("velocities"), message));
            }
            (Some(rows), Interpolation::Hermite) => {
                Some(self.rows(rows).ok_or_else(|| malformed(place("velocities"), self.wanted()))?)
            }
        };
        let timing = match (&entry.times, velocities) {
            (None, None) => None,
            (None, Some(_)) if self.interpolation == Interpolation::Linear => None,
            (Some(times), Some(velocities)) => Some(SegmentTiming { times: times.clone(), velocities }),
            (Some(_), None) | (None, Some(_)) => {
                return Err(malformed(place("times"), "and velocities are given both or not at all"));
            }
        };
        let attachment = |(number, entry)| self.attachment(&format!("{}[{number}]", place("attachments")), entry);
        let attachments = entry.attachments.iter().enumerate().map(attachment).collect::<Result<Vec<_>, _>>()?;
        // Names are kept beside; numbers of a graph that is not here say nothing.
        let (transition, state) = (TransitionId(index as u32), StateId(index as u32));
        let attachments = attachments.into_iter().flatten().collect();
        Ok(Segment { transition, state, attachments, constraints: Vec::new(), knots, timing })
    }

    fn wanted(&self) -> String {
        format!("rows have {} finite numbers, one for each coordinate", self.width)
    }

    /// Rows of the file in the order of the robot's coordinates.
    fn rows(&self, rows: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
        let fits = |row: &Vec<f64>| row.len() == self.width && row.iter().all(|x| x.is_finite());
        let pick = |row: &Vec<f64>| self.columns.iter().map(|c| c.map_or(0.0, |c| row[c])).collect();
        rows.iter().map(|row| fits(row).then(|| pick(row))).collect()
    }

    /// What an object is attached to; none for what says nothing of a part with a fixed root.
    fn attachment(&self, place: &str, entry: &AttachmentEntry) -> Result<Option<Attachment>, LoadPathError> {
        let robot = self.robot;
        let unknown =
            |key: &str, name: &str| malformed(format!("{place}.{key}"), format!("`{}` is unknown", quoted(name)));
        let owner = entry.object.split('/').next().unwrap_or_default();
        let part = robot.part(owner).ok_or_else(|| unknown("object", &entry.object))?;
        let root = robot.parts[part.at()].root_joint;
        let surface = |key, name: &String| robot.surface(name).ok_or_else(|| unknown(key, name));
        Ok(match (&entry.gripper, &entry.handle, &entry.surface, &entry.support, &entry.on) {
            (Some(gripper), Some(handle), None, None, None) => {
                let gripper = robot.gripper(gripper).ok_or_else(|| unknown("gripper", gripper))?;
                let handle = robot.handle(handle).ok_or_else(|| unknown("handle", handle))?;
                let link = &robot.links[robot.handles[handle.at()].link.at()];
                if link.part != part {
                    return Err(malformed(format!("{place}.handle"), format!("is not on `{}`", quoted(owner))));
                }
                let carrier = entry.carrier;
                root.or(link.joint).map(|object| Attachment::Grasp { object, gripper, handle, carrier })
            }
            (None, None, Some(own), Some(support), None) => {
                let (own, support) = (surface("surface", own)?, surface("support", support)?);
                if robot.links[robot.surfaces[own.at()].link.at()].part != part {
                    return Err(malformed(format!("{place}.surface"), format!("is not on `{}`", quoted(owner))));
                }
                // Which polygons touch is not written.
                root.map(|object| Attachment::Contact { object, surface: (own, 0), support: (support, 0) })
            }
            (None, None, None, None, Some(on)) => {
                let link = robot.link(on).ok_or_else(|| unknown("on", on))?;
                root.map(|object| Attachment::Rest { object, on: Some(link) })
            }
            (None, None, None, None, None) => root.map(|object| Attachment::Rest { object, on: None }),
            _ => {
                let message = "wants `gripper` and `handle`, or `surface` and `support`, or `on`, or none of them";
                return Err(malformed(place, message));
            }
        })
    }
}
