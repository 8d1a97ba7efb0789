//! Grasps of somebody else: poses of a gripper in the frame of an object, one a line.

use crate::scene::SceneError;
use crate::scene::reading::input;
use crate::setup::error::SetupError;
use crate::setup::handles::FoundHandle;
use foliate_components::Pose;
use foliate_components::pose::pose_from_array;
use glam::{DMat3, DQuat, DVec3};
use std::path::Path;
use std::str::FromStr;

/// Largest file, bytes.
const CAP: u64 = 16 << 20;
/// Most grasps of a file.
const MOST: usize = 1000;
/// How far before its grasp a hand stands still, metres.
const CLEARANCE: f64 = 0.06;

/// Which axes of a file's frames approach and close.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GraspAxes {
    /// Along which axis the hand approaches: 0, 1 or 2.
    approach: usize,
    /// Along which axis its jaws close.
    closing: usize,
}

impl Default for GraspAxes {
    fn default() -> Self {
        Self { approach: 0, closing: 1 }
    }
}

impl FromStr for GraspAxes {
    type Err = SetupError;

    fn from_str(text: &str) -> Result<Self, SetupError> {
        let axis = |letter: char| "xyz".find(letter);
        let mut letters = text.chars();
        match (letters.next().and_then(axis), letters.next().and_then(axis), letters.next()) {
            (Some(approach), Some(closing), None) if approach != closing => Ok(Self { approach, closing }),
            _ => Err(SetupError::Request(format!(
                "`{}` are no axes; write the one that approaches and the one that closes: xy, zx, zy, …",
                text.escape_debug()
            ))),
        }
    }
}

impl GraspAxes {
    /// The frame of a gripper here, in a frame of the file.
    fn frame(self) -> DQuat {
        let axis = |index: usize| DVec3::AXES[index];
        let (x, y) = (axis(self.approach), axis(self.closing));
        DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize()
    }
}

/// Reads grasps: lines of `x y z qx qy qz qw` and, where there is one, a score (larger is better); blanks or commas between the numbers, `#`
/// before a comment. The best come first.
///
/// # Errors
/// The file cannot be read; a line that is no pose, with its number.
pub fn read_grasps(path: &Path, axes: GraspAxes) -> Result<Vec<FoundHandle>, SetupError> {
    let name = path.display().to_string();
    let text = input::decode(input::bytes(path, CAP)?, &name)?;
    let mut grasps: Vec<(f64, Pose)> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let refused = |message: &str| {
            let hint = "x y z qx qy qz qw, and a score where there is one";
            SceneError::new(&name, "grasp", message).at(number as u32 + 1).hint(hint)
        };
        let words = line.split([',', ' ', '\t']).filter(|word| !word.is_empty());
        let numbers: Option<Vec<f64>> = words.map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite())).collect();
        let numbers = numbers.ok_or_else(|| refused("something is no finite number"))?;
        let score = match numbers.len() {
            7 => 0.0,
            8 => numbers[7],
            n => return Err(refused(&format!("wants 7 or 8 numbers, got {n}")).into()),
        };
        let mut pose = [0.0; 7];
        pose.copy_from_slice(&numbers[..7]);
        let pose = pose_from_array(pose).ok_or_else(|| refused("the quaternion is zero"))?;
        if grasps.len() == MOST {
            return Err(refused(&format!("more than {MOST} grasps are given")).into());
        }
        grasps.push((score, pose));
    }
    grasps.sort_by(|a, b| b.0.total_cmp(&a.0));
    let turn = Pose::from_rotation(axes.frame());
    let handle = |(at, (score, pose)): (usize, (f64, Pose))| FoundHandle {
        name: format!("given_{}", at + 1),
        link_from_handle: pose * turn,
        clearance: CLEARANCE,
        mask: [true; 6],
        reason: format!("given, score {score}"),
    };
    Ok(grasps.into_iter().enumerate().map(handle).collect())
}
