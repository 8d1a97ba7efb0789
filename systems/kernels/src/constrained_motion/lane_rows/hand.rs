//! The one body that a program brings to a place, and the target of that body in one problem.
//!
//! A program has a hand if its only rows are a relative pose between a body of a chain and something that does not move.
//! `SeedTable` (`newton/seeds.rs`) then finds start configurations near the `SeedTarget`. The analysis needs the form for lanes,
//! but neither rows nor iteration.

use crate::constrained_motion::lane_rows::form::{FrameAt, LaneProgram, LaneRows, RowsAt, Target};
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, Robot, Source};
use glam::{DMat3, DQuat, DVec3};

/// Metres for which a radian counts where hands are compared.
const RADIAN: f64 = 0.3;

/// Where a body is to go: what a program's rows say of it, for one problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeedTarget {
    /// The frame's origin in the body.
    pub(crate) point: DVec3,
    /// Where that is to be, in the world.
    pub(crate) place: DVec3,
    /// Takes a distance in the world to the directions that count.
    pub(crate) directions: DMat3,
    /// Whether all directions count, so that it need not.
    pub(crate) everywhere: bool,
    /// Σ over columns of the body's rotation · these is largest where the frames are aligned as far as that counts.
    pub(crate) alignment: DMat3,
}

impl SeedTarget {
    /// More than rotations can agree with it.
    pub(crate) fn most_alignment(&self) -> f32 {
        let columns = [self.alignment.x_axis, self.alignment.y_axis, self.alignment.z_axis];
        (columns.iter().map(|column| column.length()).sum::<f64>() + 1e-5) as f32
    }
}

/// What a program's rows say of the one body that a seed table knows.
#[derive(Clone, Debug)]
pub(crate) struct Hand {
    pub tip: JointIndex,
    /// The frame on the body.
    X_JF: Pose,
    /// Whether it is the first frame that moves, and the second that stands still.
    pub(crate) is_first: bool,
    /// The first frame where it stands still, and the reference seen from it; or the second frame, and the reference itself.
    pub(crate) stands: usize,
    pub(crate) target: Option<usize>,
    pub(crate) fixed: Pose,
    rows: RowsAt,
}

impl LaneProgram {
    /// The hand that a lone relative pose brings to something that does not move, and on whose joints alone it depends.
    pub(crate) fn hand(&self, bodies: &[usize], robot: &Robot) -> Option<Hand> {
        let [LaneRows::Pose(pose)] = self.blocks.as_slice() else { return None };
        let reference = |target: &Target| match target {
            Target::Frame => Some((None, Pose::identity())),
            Target::Fixed(pose) => Some((None, *pose)),
            Target::Given(slot) | Target::Reference(slot) => Some((Some(*slot), Pose::identity())),
        };
        let (target, fixed) = reference(&pose.target)?;
        let (at, X_JF, is_first, stands) = match (pose.a, pose.b) {
            (FrameAt::Given(stands), FrameAt::Body(at, X_JF)) => (at, X_JF, false, stands),
            (FrameAt::Body(at, X_JF), FrameAt::Given(stands)) => (at, X_JF, true, stands),
            _ => return None,
        };
        // A hand may carry what the rows depend on: then it is the table of the body beneath that moves by joints.
        let tip = JointIndex(*bodies.get(at)? as u32);
        let mut chain = std::iter::successors(Some(tip), |&j| robot.joints[j.at()].parent);
        let moves = |joint: JointIndex| match robot.joints[joint.at()].source {
            Source::Coordinates { q, .. } => self.moves.iter().any(|change| change.coordinate == q),
            Source::Follows { .. } => false,
        };
        let all = chain.all(moves);
        (all && !self.turns_roots && self.steps.len() == self.moves.len()).then_some(Hand {
            tip,
            X_JF,
            is_first,
            stands,
            target,
            fixed,
            rows: pose.out,
        })
    }
}

impl Hand {
    /// `axes` are those of the translation rows.
    pub(crate) fn target_at(&self, X_WF: &Pose, axes: DQuat) -> SeedTarget {
        let counts = |row: usize| f64::from(u8::from(self.rows.row[row] != usize::MAX && !self.rows.inequality[row]));
        let directions =
            DMat3::from_diagonal(DVec3::new(counts(0), counts(1), counts(2))) * DMat3::from_quat(axes.conjugate());
        // A free turn about one axis leaves that axis to be compared; two free turns leave nothing that is worth it.
        let turns = [counts(3), counts(4), counts(5)];
        let weights = match turns.iter().sum::<f64>() {
            3.0 => [1.0; 3],
            2.0 => std::array::from_fn(|k| if turns[k] == 0.0 { 2.0 } else { 0.0 }),
            _ => [0.0; 3],
        };
        let (own, wanted) = (DMat3::from_quat(self.X_JF.rotation), DMat3::from_quat(X_WF.rotation));
        // Σ wₖ (R·oₖ)·aₖ over the columns o of the frame in the body and a of where it is to be.
        let mut alignment = DMat3::ZERO;
        for (k, weight) in weights.into_iter().enumerate() {
            let (o, a) = (own.col(k), wanted.col(k) * (weight * RADIAN * RADIAN));
            alignment += DMat3::from_cols(a * o.x, a * o.y, a * o.z);
        }
        SeedTarget {
            point: self.X_JF.translation,
            place: X_WF.translation,
            directions,
            everywhere: (0..3).all(|row| counts(row) == 1.0),
            alignment,
        }
    }
}
