//! From the compiled blocks of a program to its form for lanes.
//!
//! The builder numbers the bodies that move, and replaces every pose that does not change during a solve by a given slot. It
//! returns `None` where a block, a joint or the number of rows has no form for lanes. It is apart from `form`, so that the
//! kernels do not depend on the compilation.

use crate::constrained_motion::lane_rows::form::{
    Edge, FrameAt, Given, LaneBalance, LaneContact, LaneMasses, LaneMoment, LaneMove, LanePoint, LanePose, LaneProgram,
    LaneRows, LaneStance, LaneSupport, MOST_ROWS, RowsAt, Target,
};
use crate::constrained_motion::rows::blocks::{Block, ContactBlock, Kind, Part, PoseBlock};
use crate::constrained_motion::rows::bodies::{Bodies, Found};
use crate::constrained_motion::rows::coordinates::Move;
use crate::constraints::centre_of_mass::MassColumns;
use crate::constraints::rows_out::placement_of;
use crate::kinematics::forward::Placement as BodyFrame;
use crate::kinematics::jacobian::Column;
use crate::kinematics::lane_jacobian::{At, LaneColumn};
use crate::kinematics::lane_steps::{LaneStep, Parent};
use crate::kinematics::weighted_points::{MomentColumn, WeightedPoint};
use foliate_components::Pose;
use foliate_components::constraint::{Reference, Rests, Row};
use foliate_components::robot::{JointIndex, Robot};
use glam::DVec3;

impl LaneProgram {
    /// `None` where some part of the program has no form for lanes.
    pub(crate) fn new(robot: &Robot, bodies: &Bodies, blocks: &[Block], moves: &[Move], width: usize) -> Option<Self> {
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
                Found::Carried(rigid_attachment) => {
                    LaneStep::placed(parent, builder.given(Given::Carried(rigid_attachment)))
                }
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

    /// A body that does not move; the same for every row.
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
            // Lanes know the rule of centres alone.
            Kind::Contact(contact) if contact.part == Part::Contact && contact.placement.rests != Rests::Centre => None,
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
