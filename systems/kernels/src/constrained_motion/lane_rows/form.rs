//! A program in the form in which lanes solve it: everything that does not change during a solve is found once per problem,
//! in scalar code, and given to its lane as poses.
//!
//! Known here are relative poses, placements on one body and the two kinds of balance, over joints with one coordinate each
//! (and planar roots), with eliminated objects and roots that a foot puts in their place. Programs with anything else
//! (distances, functions of a host, roots that turn freely) have no such form and are solved one candidate after another.

use crate::constrained_motion::rows::blocks::Decoded;
use crate::constraints::rows_out::reference_of;
use crate::kinematics::forward::{Placement as BodyFrame, RigidAttachment};
use crate::kinematics::lane_jacobian::LaneColumn;
use crate::kinematics::lane_steps::LaneStep;
use foliate_components::Pose;
use foliate_components::constraint::{PlaneRow, Reference, Row};
use glam::{DVec2, DVec3};

/// More rows than these gain nothing from lanes: what one step works in leaves the fastest memory.
pub(crate) const MOST_ROWS: usize = 32;

/// A program for lanes.
#[derive(Clone, Debug)]
pub(crate) struct LaneProgram {
    /// Bodies that move, inner ones first.
    pub steps: Vec<LaneStep>,
    /// Poses that a problem is given once.
    pub givens: Vec<Given>,
    pub blocks: Vec<LaneRows>,
    /// For each variable its coordinate and bounds; none where roots turn.
    pub moves: Vec<LaneMove>,
    /// Whether a variable turns a root: rows are then evaluated in lanes, but not solved.
    pub turns_roots: bool,
    /// Coordinates that a problem is read from: those of `moves`, and what else moves the bodies.
    pub reads: Vec<usize>,
    pub rows: usize,
    /// Vectors that one block works with, at most: moments of masses, and gradients of rows.
    pub vectors: usize,
    /// Whether each number of the Jacobian is written exactly once: then it need not be zero before.
    pub is_dense: bool,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneMove {
    pub coordinate: usize,
    pub lower: f64,
    pub upper: f64,
}

/// A pose that does not change during a solve.
#[derive(Clone, Debug)]
pub(crate) enum Given {
    Body(usize),
    Frame(BodyFrame),
    /// The reference as seen from a frame that does not move.
    Target(BodyFrame, Reference),
    Reference(Reference),
    Carried(usize),
    /// The polygon among these that a placement's parameter names.
    Support(Vec<BodyFrame>, usize),
    /// Where that parameter wants the object's polygon.
    Place(Vec<BodyFrame>, usize),
}

/// Where a frame is found.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FrameAt {
    Given(usize),
    /// On a body of the table.
    Body(usize, Pose),
}

/// What a frame is compared with.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Target {
    /// The first frame itself.
    Frame,
    /// A pose in the world.
    Given(usize),
    /// A pose in the first frame.
    Fixed(Pose),
    /// A pose in the first frame that every problem is given.
    Reference(usize),
}

/// Six rows of a relative pose, some of them left out.
#[derive(Clone, Debug)]
pub(crate) struct LanePose {
    pub a: FrameAt,
    pub target: Target,
    pub b: FrameAt,
    pub out: RowsAt,
    pub columns: Vec<LaneColumn>,
}

/// Where six rows go.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowsAt {
    /// For each of the six its row, or `usize::MAX`.
    pub row: [usize; 6],
    /// Which of them are inequalities.
    pub inequality: [bool; 6],
}

/// Five rows of contact.
#[derive(Clone, Debug)]
pub(crate) struct LaneContact {
    pub supports: Vec<LaneSupport>,
    pub objects: Vec<FrameAt>,
    pub margin: f64,
    pub first: usize,
    pub columns: Vec<LaneColumn>,
}

/// A polygon of a support in its frame's (y, z) plane.
#[derive(Clone, Debug)]
pub(crate) struct LaneSupport {
    pub frame: FrameAt,
    pub edges: Vec<Edge>,
}

/// One edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub start: DVec2,
    pub along: DVec2,
    /// 1 / |along|².
    pub per_length: f64,
    pub normal: DVec2,
}

/// Weighted points on bodies, seen from one of them: how joints move their sum (see
/// [`weighted_points`](crate::kinematics::weighted_points::PointTree)).
#[derive(Clone, Debug)]
pub(crate) struct LaneMasses {
    /// For each node the one before it; inner ones first.
    pub nodes: Vec<Option<usize>>,
    pub points: Vec<LanePoint>,
    pub columns: Vec<LaneMoment>,
    /// The sum of those points that nothing moves.
    pub still: DVec3,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct LanePoint {
    /// The node that moves it, if one does.
    pub node: Option<usize>,
    /// Its body.
    pub body: FrameAt,
    pub weight: f64,
    /// On the body, times the weight.
    pub weighted: DVec3,
}

/// One velocity coordinate, with the node whose points it moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneMoment {
    pub node: usize,
    pub weight: f64,
    pub column: LaneColumn,
}

/// A centre of mass in a frame.
#[derive(Clone, Debug)]
pub(crate) struct LaneBalance {
    pub frame: FrameAt,
    /// From whose translation parameter rows are measured.
    pub reference: Option<usize>,
    pub planes: Vec<PlaneRow>,
    pub first: usize,
    pub masses: LaneMasses,
}

/// A centre of mass between two feet.
#[derive(Clone, Debug)]
pub(crate) struct LaneStance {
    pub feet: [FrameAt; 2],
    /// How variables move the feet.
    pub columns: [Vec<LaneColumn>; 2],
    pub height: Option<f64>,
    pub first: usize,
    pub masses: LaneMasses,
}

#[derive(Clone, Debug)]
pub(crate) enum LaneRows {
    Pose(LanePose),
    Contact(LaneContact),
    Balance(LaneBalance),
    Stance(Box<LaneStance>),
}

impl RowsAt {
    pub(crate) fn turns(&self) -> bool {
        self.row[3..].iter().any(|&row| row != usize::MAX)
    }

    pub(crate) fn slides(&self) -> bool {
        self.row[..3].iter().any(|&row| row != usize::MAX)
    }

    pub(crate) fn new(rows: &[Option<Row>; 6], first: usize) -> Self {
        let (mut row, mut inequality, mut next) = ([usize::MAX; 6], [false; 6], first);
        for (k, kind) in rows.iter().enumerate() {
            let Some(kind) = kind else { continue };
            row[k] = next;
            inequality[k] = *kind == Row::Inequality;
            next += 1;
        }
        Self { row, inequality }
    }
}

impl Given {
    /// The pose; `X_WJ` holds the bodies that no variable moves.
    pub(crate) fn pose(
        &self,
        arguments: &[Pose],
        rigid_attachments: &[RigidAttachment],
        decoded: &[Decoded],
        X_WJ: &[Pose],
    ) -> Pose {
        match self {
            Self::Body(body) => X_WJ[*body],
            Self::Frame(frame) => frame.in_world(X_WJ),
            Self::Target(frame, reference) => frame.in_world(X_WJ) * reference_of(*reference, arguments),
            Self::Reference(reference) => reference_of(*reference, arguments),
            Self::Carried(rigid_attachment) => rigid_attachments[*rigid_attachment].X_CO,
            Self::Support(supports, index) => supports[decoded[*index].0.support].in_world(X_WJ),
            Self::Place(supports, index) => {
                let (contact, X_SO) = &decoded[*index];
                supports[contact.support].in_world(X_WJ) * *X_SO
            }
        }
    }
}
