//! What is asked for, and what comes of it.

use crate::scene::SceneError;
use crate::setup::grasps_file::GraspAxes;
use crate::setup::grippers::FoundGripper;
use crate::setup::request::{ObjectRequest, TableRequest};
use std::path::PathBuf;

/// How far the root of a robot that drives moves along x and y, metres.
pub const DRIVES: f64 = 2.0;

/// What a new scene is made of.
#[derive(Clone, Debug)]
pub struct NewScene {
    /// URDF of the robot: a file, or a `package://` URL.
    pub robot: String,
    /// Its SRDF.
    pub srdf: Option<String>,
    /// Objects; the first one is to be moved.
    pub objects: Vec<ObjectRequest>,
    /// Whether the robot drives: its root is planar then, within [`DRIVES`] metres of the origin along x and y.
    pub drives: bool,
    /// The table.
    pub table: TableRequest,
    /// Links of grippers: a tool frame, or any link of a hand. Where there are none, all hands with two jaws are found.
    pub grippers: Vec<String>,
    /// Grasps of the first object, instead of those that are found.
    pub grasps: Option<PathBuf>,
    /// Which axes of these grasps approach and close.
    pub grasp_axes: GraspAxes,
    /// Seed of everything that is sampled.
    pub seed: u64,
    /// Where the scene will be written: files are named from there.
    pub place: PathBuf,
    /// The command that a comment names.
    pub command: String,
}

/// A scene that was written, and what is known of it.
#[derive(Clone, Debug)]
pub struct WrittenScene {
    /// The text of the scene file.
    pub text: String,
    /// The grippers.
    pub grippers: Vec<FoundGripper>,
    /// By object: its name, and how many handles and resting faces it has.
    pub objects: Vec<(String, usize, usize)>,
    /// Pairs of links that are left out, and pairs in all.
    pub pairs: (usize, usize),
    /// Steps of the search that solved it; none where no layout was solved within its limit.
    pub solved: Option<u64>,
    /// Remarks of the models that were read.
    pub warnings: Vec<SceneError>,
}
