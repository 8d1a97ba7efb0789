//! From a planned path to its file.

use super::constraint::entries;
use crate::path_file::constraint::PoseRow;
use crate::path_file::document::{
    AttachmentEntry, CertificateEntry, CorrectionEntry, Documents, FORMAT, GripperEntry, HandleEntry, PairsEntry,
    PartEntry, PathFile, RestsEntry, RestsRule, SceneFileEntry, SegmentEntry, SurfaceEntry,
};
use crate::path_file::names::held;
use crate::path_file::timing;
use crate::scene::assemble::names::configuration::coordinate_names;
use crate::scene::mesh::formats::triangles::UpAxis;
use foliate_components::Pose;
use foliate_components::constraint::Rests;
use foliate_components::coverage::PairCounts;
use foliate_components::graph::ConstraintGraph;
use foliate_components::path::{Attachment, ManipulationPath, Segment};
use foliate_components::pose::pose_to_array;
use foliate_components::problem::{Correction, Moved, Problem};
use foliate_components::robot::{JointIndex, LinkIndex, Part, PartKind, Robot, RootJoint};
use std::collections::BTreeMap;

/// What a path file says besides the path: the problem, where its models are, and how it was searched.
#[derive(Clone, Copy, Debug)]
pub struct PathContext<'a> {
    /// The problem.
    pub problem: &'a Problem,
    /// Its constraint graph, for names.
    pub graph: &'a ConstraintGraph,
    /// The scene file and the parts' files, as the path file is to name them.
    pub models: &'a FileNames,
    /// Seed.
    pub seed: u64,
    /// Scheduler.
    pub scheduler: &'a str,
    /// SIMD level.
    pub simd: &'a str,
}

/// How a path file names the files that its problem was read from, and what decides how they are read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileNames {
    /// The scene file, where there is one.
    pub scene_file: Option<SceneFileEntry>,
    /// The file that says where the scene starts, where there is one.
    pub start_file: Option<SceneFileEntry>,
    /// By part.
    pub parts: Vec<PartFiles>,
}

/// The files of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct PartFiles {
    /// Its URDF.
    pub urdf: String,
    /// Its SRDF.
    pub srdf: Option<String>,
    /// What is done with the up axis of COLLADA meshes.
    pub mesh_up_axis: UpAxis,
    /// SHA-256 by `urdf`, `srdf` and meshes' names.
    pub sha256: BTreeMap<String, String>,
    /// Where joints of an environment stand that do not stand at zero, by name within the part.
    pub joint_values: Vec<(String, f64)>,
}

/// The file of a path.
#[must_use]
pub fn write_path(context: &PathContext<'_>, path: &ManipulationPath) -> PathFile {
    let problem = context.problem;
    let robot = &problem.robot;
    let link = |l: LinkIndex| robot.links[l.at()].name.clone();
    let tolerance = path.certificate.path_tolerance;
    // An environment's joints are no coordinates of the problem: they stand where the scene has them, in every knot.
    let files = &context.models.parts;
    let still = || files.iter().flat_map(|part| &part.joint_values);
    let still_values: Vec<f64> = still().map(|(_, value)| *value).collect();
    let still_names = robot
        .parts
        .iter()
        .zip(files)
        .flat_map(|(part, files)| files.joint_values.iter().map(|(joint, _)| format!("{}/{joint}", part.name)));
    let shares = timing::shares(problem, path);
    PathFile {
        format: FORMAT.into(),
        scene: problem.name.clone(),
        scene_file: context.models.scene_file.clone(),
        start_file: context.models.start_file.clone(),
        seed: context.seed,
        scheduler: context.scheduler.into(),
        simd: context.simd.into(),
        parts: robot.parts.iter().zip(files).map(|(part, files)| part_entry(part, files)).collect(),
        coordinates: coordinate_names(robot).into_iter().chain(still_names).collect(),
        limits: limits(robot),
        rate_limits: timing::rate_limits(problem, path),
        documents: documents(robot),
        ignored_pairs: problem
            .ignored_pairs
            .iter()
            .map(|p| [link(p.first), link(p.second), p.reason.clone()])
            .collect(),
        margins: problem.margins.iter().map(|m| (link(m.first), link(m.second), m.distance)).collect(),
        placement_margin: problem.graph.placement_margin,
        rests: rests(problem.graph.rests),
        corrections: path.corrections.iter().map(correction).collect(),
        segments: path
            .segments
            .iter()
            .map(|segment| segment_entry(context, segment, tolerance, &still_values))
            .collect(),
        events: Some(timing::events(robot, path)),
        certificate: CertificateEntry {
            path_tolerance: path.certificate.path_tolerance,
            max_residual: path.certificate.max_residual,
            min_clearance: path.certificate.min_clearance,
            joint_limits: "within".into(),
            pairs: Some(pairs(&path.certificate.pairs)),
            max_velocity: shares.map(|shares| shares.velocity),
            max_acceleration: shares.map(|shares| shares.acceleration),
            continuity: shares.map(|shares| shares.continuity),
        },
    }
}

/// A segment; `still` are the numbers of joints that stand still throughout.
fn segment_entry(context: &PathContext<'_>, segment: &Segment, tolerance: f64, still: &[f64]) -> SegmentEntry {
    let robot = &context.problem.robot;
    let at_rest = vec![0.0; still.len()];
    let rows = |rows: &[Vec<f64>], more: &[f64]| rows.iter().map(|row| [row.as_slice(), more].concat()).collect();
    SegmentEntry {
        transition: context.graph.transition(segment.transition).name.clone(),
        state: context.graph.state(segment.state).name.clone(),
        attachments: segment.attachments.iter().filter_map(|a| attachment_entry(robot, a)).collect(),
        constraints: segment.constraints.iter().flat_map(|c| entries(robot, c, tolerance)).collect(),
        knots: rows(&segment.knots, still),
        times: segment.timing.as_ref().map(|timing| timing.times.clone()),
        velocities: segment.timing.as_ref().map(|timing| rows(&timing.velocities, &at_rest)),
    }
}

fn correction(correction: &Correction) -> CorrectionEntry {
    let name =
        |is_object: bool| (matches!(correction.moved, Moved::Object(..)) == is_object).then(|| correction.name.clone());
    let Correction { goal, distance, angle, .. } = *correction;
    CorrectionEntry { goal, object: name(true), joint: name(false), distance, angle }
}

fn pairs(counts: &PairCounts) -> PairsEntry {
    let &PairCounts { tested, rigid, same_body, environment, srdf, adjacent, ignored, grasped, placed } = counts;
    PairsEntry { tested, rigid, same_body, environment, srdf, adjacent, ignored, grasped, placed }
}

fn limits(robot: &Robot) -> BTreeMap<String, [f64; 2]> {
    let bounds = robot.space.lower.iter().zip(&robot.space.upper);
    let finite = |&(_, (low, high)): &(String, (&f64, &f64))| low.is_finite() && high.is_finite();
    coordinate_names(robot).into_iter().zip(bounds).filter(finite).map(|(n, (&l, &h))| (n, [l, h])).collect()
}

fn part_entry(part: &Part, files: &PartFiles) -> PartEntry {
    PartEntry {
        name: part.name.clone(),
        kind: match part.kind {
            PartKind::Robot => "robot",
            PartKind::Object => "object",
            PartKind::Environment => "environment",
        }
        .into(),
        urdf: files.urdf.clone(),
        srdf: files.srdf.clone(),
        mimic: if part.mimic_follows { "follow" } else { "free" }.into(),
        root: match part.root {
            RootJoint::Fixed => "fixed",
            RootJoint::FreeFlyer => "freeflyer",
            RootJoint::Planar => "planar",
        }
        .into(),
        world_from_root: row(&part.world_from_root),
        mesh_up_axis: Some(files.mesh_up_axis.word().into()),
        sha256: files.sha256.clone(),
    }
}

/// None by the rule of centres, which files without an entry mean.
fn rests(rests: Rests) -> Option<RestsEntry> {
    let rule = match rests {
        Rests::Centre => return None,
        Rests::Stable { .. } => RestsRule::Stable,
        Rests::WholeFace { .. } => RestsRule::WholeFace,
    };
    Some(RestsEntry { rule, margin: rests.margin() })
}

fn documents(robot: &Robot) -> Documents {
    let link = |l: LinkIndex| robot.links[l.at()].name.clone();
    let grippers = robot
        .grippers
        .iter()
        .map(|g| (g.name.clone(), GripperEntry { link: link(g.link), link_from_gripper: row(&g.link_from_gripper) }));
    let handles = robot.handles.iter().map(|h| {
        let entry = HandleEntry {
            link: link(h.link),
            link_from_handle: row(&h.link_from_handle),
            mask: h.mask,
            mask_complement: h.mask_complement,
        };
        (h.name.clone(), entry)
    });
    let surfaces = robot.surfaces.iter().map(|s| {
        let points = s.points.iter().map(|p| p.to_array()).collect();
        (s.name.clone(), SurfaceEntry { link: link(s.link), points, polygons: s.polygons.clone() })
    });
    Documents { grippers: grippers.collect(), handles: handles.collect(), surfaces: surfaces.collect() }
}

/// What a segment says an object is attached to; nothing for one that stays where it is without touching a documented surface.
fn attachment_entry(robot: &Robot, attachment: &Attachment) -> Option<AttachmentEntry> {
    let part = |object: JointIndex| robot.parts[robot.joints[object.at()].part.at()].name.clone();
    match *attachment {
        Attachment::Grasp { gripper, handle, carrier, .. } => Some(AttachmentEntry {
            object: held(robot, handle),
            gripper: Some(robot.grippers[gripper.at()].name.clone()),
            handle: Some(robot.handles[handle.at()].name.clone()),
            carrier,
            ..AttachmentEntry::default()
        }),
        Attachment::Contact { object, surface, support } => Some(AttachmentEntry {
            object: part(object),
            surface: Some(robot.surfaces[surface.0.at()].name.clone()),
            support: Some(robot.surfaces[support.0.at()].name.clone()),
            carrier: true,
            ..AttachmentEntry::default()
        }),
        Attachment::Rest { on: None, .. } => None,
        Attachment::Rest { object, on: Some(on) } => Some(AttachmentEntry {
            object: part(object),
            on: Some(robot.links[on.at()].name.clone()),
            carrier: true,
            ..AttachmentEntry::default()
        }),
    }
}

fn row(pose: &Pose) -> PoseRow {
    pose_to_array(pose)
}
