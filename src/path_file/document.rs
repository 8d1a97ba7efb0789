//! The form of a path file, as `serde` reads and writes it.

use crate::path_file::constraint::{ConstraintEntry, PoseRow};
use crate::path_file::place;
use crate::scene::reading::input;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The value of `format` in files that are written.
pub const FORMAT: &str = "foliate.path/2";
/// The value of `format` in files of version 1, which are still read. They have no velocities, no limits of rates and no events.
pub const FORMAT_1: &str = "foliate.path/1";

/// The format that every scene file says.
const SCENE: &[u8] = b"foliate.scene/1";

/// A path file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathFile {
    /// [`FORMAT`] or [`FORMAT_1`].
    pub format: String,
    /// Name of the scene.
    pub scene: String,
    /// The scene file that the path answers; a file without one can only be proved relative to what it says itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene_file: Option<SceneFileEntry>,
    /// The file that says where the path starts instead of where the scene says, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_file: Option<SceneFileEntry>,
    /// Seed of the search.
    pub seed: u64,
    /// Scheduler of the search.
    pub scheduler: String,
    /// SIMD level of the search; results are equal bit for bit only at one level.
    pub simd: String,
    /// Robots, objects and environment.
    pub parts: Vec<PartEntry>,
    /// Names of the numbers of a knot.
    pub coordinates: Vec<String>,
    /// Bounds of those that have any, by coordinate.
    #[serde(deserialize_with = "place::unique")]
    pub limits: BTreeMap<String, [f64; 2]>,
    /// Limits of velocity, acceleration and jerk, by coordinate; none in a path without times.
    #[serde(default, deserialize_with = "place::unique_if_any", skip_serializing_if = "Option::is_none")]
    pub rate_limits: Option<BTreeMap<String, RateLimitEntry>>,
    /// Grippers, handles and surfaces.
    pub documents: Documents,
    /// Link, link, reason: pairs that are not tested besides the SRDFs' own.
    pub ignored_pairs: Vec<[String; 3]>,
    /// Link, link, metres: minimum distances.
    pub margins: Vec<(String, String, f64)>,
    /// Gap between an object's surface and its support, metres.
    pub placement_margin: f64,
    /// How objects lie on their supports; none in files that know the rule of centres alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rests: Option<RestsEntry>,
    /// What of the scene's start and goals was moved onto a state; the path begins and ends with what was moved.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub corrections: Vec<CorrectionEntry>,
    /// The path, in the direction of travel.
    pub segments: Vec<SegmentEntry>,
    /// Where hands take and let go of objects, in the order of travel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub events: Option<Vec<EventEntry>>,
    /// What was proven.
    pub certificate: CertificateEntry,
}

impl PathFile {
    /// The folder that the file lies in and that of its scene: below them its models may name meshes. A path file cannot choose any
    /// folder: what it calls its scene has to be one.
    pub(crate) fn directories(&self, folder: &Path) -> Vec<PathBuf> {
        let scene = self.scene_file.as_ref().map(|scene| folder.join(&scene.file));
        let is_scene = |path: &PathBuf| {
            let content = input::bytes(path, input::SCENE_CAP);
            content.is_ok_and(|content| content.windows(SCENE.len()).any(|words| words == SCENE))
        };
        let of_scene = scene.filter(is_scene).and_then(|scene| Some(scene.parent()?.to_owned()));
        [Some(folder.to_owned()), of_scene].into_iter().flatten().collect()
    }
}

/// Where the file of a scene or of a start is, and which one it was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFileEntry {
    /// The name of a shipped scene, or the file's path relative to the path file.
    pub file: String,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
}

/// A part and where its models are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartEntry {
    /// Name.
    pub name: String,
    /// `robot`, `object` or `environment`.
    pub kind: String,
    /// `package://` URL, or a path relative to the path file.
    pub urdf: String,
    /// As `urdf`.
    pub srdf: Option<String>,
    /// `follow` or `free`.
    pub mimic: String,
    /// `fixed`, `freeflyer` or `planar`.
    pub root: String,
    /// Pose of what does not move freely.
    pub world_from_root: PoseRow,
    /// What is done with the up axis of COLLADA meshes: `as-written` (also where it is left out) or `declared`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_up_axis: Option<String>,
    /// SHA-256 (hexadecimal) of every file that the part was read from: by `urdf`, `srdf`, and each mesh as the URDF writes
    /// its name. Empty in files that do not say.
    #[serde(default, deserialize_with = "place::unique", skip_serializing_if = "BTreeMap::is_empty")]
    pub sha256: BTreeMap<String, String>,
}

/// Grippers, handles and surfaces, by name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Documents {
    /// Grippers.
    #[serde(deserialize_with = "place::unique")]
    pub grippers: BTreeMap<String, GripperEntry>,
    /// Handles.
    #[serde(deserialize_with = "place::unique")]
    pub handles: BTreeMap<String, HandleEntry>,
    /// Contact surfaces.
    #[serde(deserialize_with = "place::unique")]
    pub surfaces: BTreeMap<String, SurfaceEntry>,
}

/// A gripper in its link.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GripperEntry {
    /// `part/link`.
    pub link: String,
    /// Its frame.
    pub link_from_gripper: PoseRow,
}

/// A handle in its link.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandleEntry {
    /// `part/link`.
    pub link: String,
    /// Its frame.
    pub link_from_handle: PoseRow,
    /// Rows of the handle's pose in the gripper that a grasp makes zero: tx ty tz rx ry rz.
    pub mask: [bool; 6],
    /// Rows that stay constant while held.
    pub mask_complement: [bool; 6],
}

/// Contact polygons on a link.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceEntry {
    /// `part/link`.
    pub link: String,
    /// Vertices in the link frame, metres.
    pub points: Vec<[f64; 3]>,
    /// Indices into `points`, counter-clockwise seen from outside.
    pub polygons: Vec<Vec<u32>>,
}

/// How objects lie on their supports, by another rule than that of centres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RestsEntry {
    /// The rule.
    pub rule: RestsRule,
    /// How far inside, metres.
    pub margin: f64,
}

/// A rule of [`RestsEntry`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RestsRule {
    /// The centre of mass is over the support and over the object's polygon.
    Stable,
    /// The object's whole polygon is over the support.
    WholeFace,
}

/// An object or a joint that the scene has a little off a state, and the path on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CorrectionEntry {
    /// Number of the goal; none for the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<usize>,
    /// The object, a part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// The joint; either this or `object`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// How far it was moved, metres: of an object the origin of its root link.
    pub distance: f64,
    /// By which angle it was turned, radians.
    pub angle: f64,
}

/// A motion on one leaf.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SegmentEntry {
    /// Transition, in the direction of travel.
    pub transition: String,
    /// State in which the motion lies.
    pub state: String,
    /// What each object is attached to.
    pub attachments: Vec<AttachmentEntry>,
    /// Further constraints that hold along the segment.
    pub constraints: Vec<ConstraintEntry>,
    /// Configurations.
    pub knots: Vec<Vec<f64>>,
    /// Seconds from the start of the path, one per knot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub times: Option<Vec<f64>>,
    /// Derivatives of the coordinates by time, one row per knot. With them the coordinates follow cubic Hermite polynomials.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocities: Option<Vec<Vec<f64>>>,
}

/// Limits of the rates of a coordinate; what is left out has no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RateLimitEntry {
    /// rad/s or m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<f64>,
    /// rad/s² or m/s².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration: Option<f64>,
    /// rad/s³ or m/s³.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jerk: Option<f64>,
}

/// A gripper takes or lets go of a handle, at the first knot of a segment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EventEntry {
    /// Seconds from the start of the path; none in a path without times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// How long everything stands still from then on, seconds.
    pub dwell: f64,
    /// The segment that begins with it, counted from 0.
    pub segment: usize,
    /// `grasp` or `release`.
    pub kind: String,
    /// The part, or `part/link` of an articulated one.
    pub object: String,
    /// Which gripper.
    pub gripper: String,
    /// Which handle.
    pub handle: String,
    /// Positions of the gripper's fingers, by `part/joint`, radians or metres.
    #[serde(default, deserialize_with = "place::unique", skip_serializing_if = "BTreeMap::is_empty")]
    pub fingers: BTreeMap<String, f64>,
}

/// What an object is attached to: a gripper by a handle, a support by a surface, a link that it rests on, or nothing but its place.
///
/// An object follows its carrier. One that is held but has no carrier (its handle leaves rotations free) moves as written,
/// like a robot's root; one without any attachment stays where it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AttachmentEntry {
    /// The part, or `part/link` of an articulated one.
    pub object: String,
    /// Who holds it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gripper: Option<String>,
    /// By which handle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub handle: Option<String>,
    /// The object's surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<String>,
    /// The surface that carries it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub support: Option<String>,
    /// `part/link` that it rests on without polygons; how it rests is one of the segment's constraints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
    /// Whether the object follows this attachment rigidly.
    pub carrier: bool,
}

/// What was proven over the continuum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertificateEntry {
    /// Bound that residuals keep.
    pub path_tolerance: f64,
    /// The largest residual, bounded.
    pub max_residual: f64,
    /// The smallest clearance beyond the margins, bounded from below, metres; none where no pair was tested.
    pub min_clearance: Option<f64>,
    /// `within`.
    pub joint_limits: String,
    /// Which pairs of collision shapes were tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pairs: Option<PairsEntry>,
    /// The largest share of a velocity limit that is used, at most 1; only in a path with times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_velocity: Option<f64>,
    /// The largest share of an acceleration limit that is used, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_acceleration: Option<f64>,
    /// 1 where velocities are continuous, 2 where accelerations are too; only in a path with times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continuity: Option<u8>,
}

/// How many pairs of collision shapes were tested, and how many were left out, by reason.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairsEntry {
    /// Tested along the motion.
    pub tested: u64,
    /// Rigid to one another through fixed or locked joints of the problem: tested once, at the start.
    pub rigid: u64,
    /// Not tested: on one link, or on links that fixed joints of the model make one body.
    pub same_body: u64,
    /// Not tested: both belong to the environment.
    pub environment: u64,
    /// Not tested: an SRDF disables them.
    pub srdf: u64,
    /// Not tested: two links that one joint joins, which touch where that joint is.
    pub adjacent: u64,
    /// Not tested: the scene ignores them.
    pub ignored: u64,
    /// Tested without their margin while one grasps the other.
    pub grasped: u64,
    /// Tested without their margin while one is placed on the other.
    pub placed: u64,
}
