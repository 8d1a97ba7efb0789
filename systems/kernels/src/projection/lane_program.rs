//! A program in the form in which lanes solve it: everything that does not change during a solve is found once per problem,
//! in scalar code, and given to its lane as poses.
//!
//! Known here are relative poses, placements on one body and the two kinds of balance, over joints with one coordinate each
//! (and planar roots), with eliminated objects and roots that a foot puts in their place. Programs with anything else
//! (distances, functions of a host, roots that turn freely) have no such form and are solved one candidate after another.

use super::blocks::{Block, ContactBlock, Kind, Part, PoseBlock};
use super::bodies::{Bodies, Found};
use super::program::Move;
use super::scratch::Decoded;
use crate::constraints::centre_of_mass::MassColumns;
use crate::constraints::{placement_of, reference_of};
use crate::kinematics::{
    At, Carriage, Column, LaneColumn, LaneStep, MomentColumn, Parent, Placement as BodyFrame, WeightedPoint,
};
use foliate_components::Pose;
use foliate_components::constraint::{PlaneRow, Reference, Row};
use foliate_components::robot::{JointIndex, Robot};
use glam::{DVec2, DVec3};

/// More rows than these gain nothing from lanes: what one step works in leaves the fastest memory.
pub(super) const MOST_ROWS: usize = 32;

/// A program for lanes.
#[derive(Clone, Debug)]
pub(super) struct LaneProgram {
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
pub(super) struct LaneMove {
    pub coordinate: usize,
    pub lower: f64,
    pub upper: f64,
}

/// A pose that does not change during a solve.
#[derive(Clone, Debug)]
pub(super) enum Given {
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
pub(super) enum FrameAt {
    Given(usize),
    /// On a body of the table.
    Body(usize, Pose),
}

/// What a frame is compared with.
#[derive(Clone, Copy, Debug)]
pub(super) enum Target {
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
pub(super) struct LanePose {
    pub a: FrameAt,
    pub target: Target,
    pub b: FrameAt,
    pub out: RowsAt,
    pub columns: Vec<LaneColumn>,
}

/// Where six rows go.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowsAt {
    /// For each of the six its row, or `usize::MAX`.
    pub row: [usize; 6],
    /// Which of them are inequalities.
    pub inequality: [bool; 6],
}

/// Five rows of contact.
#[derive(Clone, Debug)]
pub(super) struct LaneContact {
    pub supports: Vec<LaneSupport>,
    pub objects: Vec<FrameAt>,
    pub margin: f64,
    pub first: usize,
    pub columns: Vec<LaneColumn>,
}

/// A polygon of a support in its frame's (y, z) plane.
#[derive(Clone, Debug)]
pub(super) struct LaneSupport {
    pub frame: FrameAt,
    pub edges: Vec<Edge>,
}

/// One edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub start: DVec2,
    pub along: DVec2,
    /// 1 / |along|².
    pub per_length: f64,
    pub normal: DVec2,
}

/// Weighted points on bodies, seen from one of them: how joints move their sum (see
/// [`weighted_points`](crate::kinematics::PointTree)).
#[derive(Clone, Debug)]
pub(super) struct LaneMasses {
    /// For each node the one before it; inner ones first.
    pub nodes: Vec<Option<usize>>,
    pub points: Vec<LanePoint>,
    pub columns: Vec<LaneMoment>,
    /// The sum of those points that nothing moves.
    pub still: DVec3,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct LanePoint {
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
pub(super) struct LaneMoment {
    pub node: usize,
    pub weight: f64,
    pub column: LaneColumn,
}

/// A centre of mass in a frame.
#[derive(Clone, Debug)]
pub(super) struct LaneBalance {
    pub frame: FrameAt,
    /// From whose translation parameter rows are measured.
    pub reference: Option<usize>,
    pub planes: Vec<PlaneRow>,
    pub first: usize,
    pub masses: LaneMasses,
}

/// A centre of mass between two feet.
#[derive(Clone, Debug)]
pub(super) struct LaneStance {
    pub feet: [FrameAt; 2],
    /// How variables move the feet.
    pub columns: [Vec<LaneColumn>; 2],
    pub height: Option<f64>,
    pub first: usize,
    pub masses: LaneMasses,
}

#[derive(Clone, Debug)]
pub(super) enum LaneRows {
    Pose(LanePose),
    Contact(LaneContact),
    Balance(LaneBalance),
    Stance(Box<LaneStance>),
}

impl RowsAt {
    pub(super) fn turns(&self) -> bool {
        self.row[3..].iter().any(|&row| row != usize::MAX)
    }

    pub(super) fn slides(&self) -> bool {
        self.row[..3].iter().any(|&row| row != usize::MAX)
    }

    fn new(rows: &[Option<Row>; 6], first: usize) -> Self {
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

impl LaneProgram {
    /// `None` where some part of the program has no form for lanes.
    pub(super) fn new(robot: &Robot, bodies: &Bodies, blocks: &[Block], moves: &[Move], width: usize) -> Option<Self> {
        let mut builder = Builder { moving: bodies.moving_bodies(), givens: Vec::new() };
        let mut steps = Vec::new();
        for (index, body) in bodies.moving_tree().enumerate() {
            let parent = match body.from {
                None => Parent::World,
                Some(parent) => match builder.moving.iter().position(|&b| b == parent) {
                    Some(at) if at + 1 == index => Parent::Previous,
                    Some(at) => Parent::Body(at),
                    None => Parent::Given(builder.given(Given::Body(parent))),
                },
            };
            steps.push(match body.by {
                Found::Carried(carriage) => LaneStep::placed(parent, builder.given(Given::Carried(carriage))),
                Found::ByJoint(joint) => LaneStep::of_joint(robot, &robot.joints[joint], parent),
                Found::BackOver(joint) => LaneStep::back_over(robot, &robot.joints[joint], parent)?,
            });
        }
        let rows: Option<Vec<_>> = blocks.iter().map(|block| builder.rows(block)).collect();
        let (block_rows, moves) = (rows?, scalars(moves, width));
        let rows: usize = blocks.iter().map(|block| block.rows).sum();
        if rows == 0 || rows > MOST_ROWS {
            return None;
        }
        let turns_roots = moves.is_none();
        let moves = moves.unwrap_or_default();
        let mut reads: Vec<usize> = moves.iter().map(|m| m.coordinate).collect();
        steps.iter().for_each(|step| reads.extend(step.coordinates()));
        reads.sort_unstable();
        reads.dedup();
        Some(Self {
            is_dense: block_rows.iter().all(|rows| is_dense(rows, width)),
            vectors: blocks.iter().map(|block| block.moments() + block.rows).max().unwrap_or(0),
            turns_roots,
            steps,
            givens: builder.givens,
            blocks: block_rows,
            moves,
            reads,
            rows,
        })
    }
}

/// Each variable's coordinate and bounds; `None` where one of them turns a root.
fn scalars(moves: &[Move], width: usize) -> Option<Vec<LaneMove>> {
    let mut found = vec![None; width];
    for change in moves {
        let Move::Scalar { variable, coordinate, lower, upper } = *change else { return None };
        *found.get_mut(variable)? = Some(LaneMove { coordinate, lower, upper });
    }
    found.into_iter().collect()
}

/// Whether each variable has one column in each row.
fn is_dense(rows: &LaneRows, width: usize) -> bool {
    let (LaneRows::Pose(LanePose { columns, .. }) | LaneRows::Contact(LaneContact { columns, .. })) = rows else {
        return false; // a variable may move masses on both of its sides
    };
    let mut seen = vec![0; width];
    columns.iter().for_each(|column| seen[column.variable] += 1);
    seen.iter().all(|&count| count == 1)
}

struct Builder {
    /// Bodies of the table.
    moving: Vec<usize>,
    givens: Vec<Given>,
}

impl Builder {
    fn given(&mut self, given: Given) -> usize {
        self.givens.push(given);
        self.givens.len() - 1
    }

    /// A body that does not move; given once, whoever asks.
    fn still(&mut self, body: JointIndex) -> usize {
        let same = |given: &Given| matches!(given, Given::Body(known) if *known == body.at());
        self.givens.iter().position(same).unwrap_or_else(|| self.given(Given::Body(body.at())))
    }

    fn position(&self, joint: Option<JointIndex>) -> Option<usize> {
        joint.and_then(|joint| self.moving.iter().position(|&b| b == joint.at()))
    }

    fn frame(&mut self, frame: &BodyFrame) -> FrameAt {
        match self.position(frame.joint) {
            Some(at) => FrameAt::Body(at, frame.X_JF),
            None => FrameAt::Given(self.given(Given::Frame(*frame))),
        }
    }

    fn columns(&mut self, columns: &[Column]) -> Option<Vec<LaneColumn>> {
        columns.iter().map(|column| self.column(column)).collect()
    }

    fn column(&mut self, column: &Column) -> Option<LaneColumn> {
        let body = match *column {
            Column::Turn { body, .. } => Some(body),
            Column::Slide { frame, .. } => frame,
        };
        let at = match (body, self.position(body)) {
            (None, _) => At::World,
            (Some(_), Some(at)) => At::Body(at),
            (Some(body), None) => At::Given(self.still(body)),
        };
        LaneColumn::new(column, |_| Some(at))
    }

    fn rows(&mut self, block: &Block) -> Option<LaneRows> {
        match &block.kind {
            Kind::Pose(pose) => self.pose(pose, block.first).map(LaneRows::Pose),
            Kind::Contact(contact) if contact.part == Part::Contact => {
                self.contact(contact, block.first).map(LaneRows::Contact)
            }
            Kind::Contact(contact) => self.placed(contact, block.first).map(LaneRows::Pose),
            Kind::Balance { balance, masses } => Some(LaneRows::Balance(LaneBalance {
                frame: self.frame(&placement_of(&balance.frame)),
                reference: match balance.reference {
                    Reference::Identity => None,
                    reference => Some(self.given(Given::Reference(reference))),
                },
                planes: balance.rows.clone(),
                first: block.first,
                masses: self.masses(masses)?,
            })),
            Kind::BalanceBetween { balance, columns } => {
                let [near, far] = &columns.feet;
                Some(LaneRows::Stance(Box::new(LaneStance {
                    feet: [&balance.first, &balance.second].map(|foot| self.frame(&placement_of(foot))),
                    columns: [self.columns(near)?, self.columns(far)?],
                    height: balance.height,
                    first: block.first,
                    masses: self.masses(&columns.masses)?,
                })))
            }
            Kind::Distance { .. } | Kind::Custom(_) | Kind::Locked { .. } => None,
        }
    }

    fn masses(&mut self, masses: &MassColumns) -> Option<LaneMasses> {
        let mut still = DVec3::ZERO;
        let mut points = Vec::new();
        for &(node, WeightedPoint { body, weight, point }) in masses.tree.points() {
            let weighted = weight * point;
            let Some(joint) = body else {
                // Seen from a foot, joints may move masses of the world.
                if node.is_some() {
                    return None;
                }
                still += weighted;
                continue;
            };
            let body = match self.position(body) {
                Some(at) => FrameAt::Body(at, Pose::identity()),
                None => FrameAt::Given(self.still(joint)),
            };
            points.push(LanePoint { node, body, weight, weighted });
        }
        let moment = |moment: &MomentColumn| {
            Some(LaneMoment { node: moment.node, weight: moment.weight, column: self.column(&moment.column)? })
        };
        Some(LaneMasses {
            nodes: masses.tree.nodes().iter().map(|node| node.parent).collect(),
            columns: masses.columns.iter().map(moment).collect::<Option<_>>()?,
            points,
            still,
        })
    }

    fn pose(&mut self, pose: &PoseBlock, first: usize) -> Option<LanePose> {
        let moves = self.position(pose.a.joint).is_some();
        let target = match pose.reference {
            Reference::Identity => Target::Frame,
            _ if !moves => Target::Given(self.given(Given::Target(pose.a, pose.reference))),
            Reference::Fixed(reference) => Target::Fixed(reference),
            Reference::Argument(_) => Target::Reference(self.given(Given::Reference(pose.reference))),
        };
        Some(LanePose {
            a: self.frame(&pose.a),
            target,
            b: self.frame(&pose.b),
            out: RowsAt::new(&pose.rows, first),
            columns: self.columns(&pose.columns)?,
        })
    }

    /// Columns, where they are the same whichever support is touched.
    fn contact_columns(&mut self, contact: &ContactBlock) -> Option<Vec<LaneColumn>> {
        let first = contact.columns.first()?;
        let same = contact.columns.iter().all(|columns| columns == first);
        if same { self.columns(first) } else { None }
    }

    fn contact(&mut self, contact: &ContactBlock, first: usize) -> Option<LaneContact> {
        let placement = &contact.placement;
        let columns = self.contact_columns(contact)?;
        let supports = placement.supports.iter().map(|polygon| {
            let count = polygon.vertices.len();
            let edge = |k: usize| {
                let (start, along) = (polygon.vertices[k], polygon.vertices[(k + 1) % count] - polygon.vertices[k]);
                Edge { start, along, per_length: 1.0 / along.length_squared(), normal: polygon.normals[k] }
            };
            let edges = (0..count).map(edge).collect();
            LaneSupport { frame: self.frame(&placement_of(&polygon.frame)), edges }
        });
        let supports = supports.collect();
        let objects = placement.object.iter().map(|polygon| self.frame(&placement_of(&polygon.frame))).collect();
        Some(LaneContact { supports, objects, margin: placement.margin, first, columns })
    }

    /// Complement and hold: the parameter names the polygons, so that a support which does not move is a pose to be given.
    fn placed(&mut self, contact: &ContactBlock, first: usize) -> Option<LanePose> {
        let placement = &contact.placement;
        let [object] = placement.object.as_slice() else { return None };
        let supports: Vec<_> = placement.supports.iter().map(|polygon| placement_of(&polygon.frame)).collect();
        if supports.iter().any(|support| self.position(support.joint).is_some()) {
            return None;
        }
        let parameter = Some(Row::Parameter);
        let rows = match contact.part {
            Part::Complement(_) => [None, parameter, parameter, parameter, None, None],
            Part::Hold(_) => [parameter; 6],
            Part::Contact => return None,
        };
        Some(LanePose {
            a: FrameAt::Given(self.given(Given::Support(supports.clone(), contact.decoded))),
            target: Target::Given(self.given(Given::Place(supports, contact.decoded))),
            b: self.frame(&placement_of(&object.frame)),
            out: RowsAt::new(&rows, first),
            columns: self.contact_columns(contact)?,
        })
    }
}

impl Given {
    /// The pose; `X_WJ` holds the bodies that no variable moves.
    pub(super) fn pose(&self, arguments: &[Pose], carriages: &[Carriage], decoded: &[Decoded], X_WJ: &[Pose]) -> Pose {
        match self {
            Self::Body(body) => X_WJ[*body],
            Self::Frame(frame) => frame.in_world(X_WJ),
            Self::Target(frame, reference) => frame.in_world(X_WJ) * reference_of(*reference, arguments),
            Self::Reference(reference) => reference_of(*reference, arguments),
            Self::Carried(carriage) => carriages[*carriage].X_CO,
            Self::Support(supports, index) => supports[decoded[*index].0.support].in_world(X_WJ),
            Self::Place(supports, index) => {
                let (contact, X_SO) = &decoded[*index];
                supports[contact.support].in_world(X_WJ) * *X_SO
            }
        }
    }
}
