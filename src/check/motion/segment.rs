//! Where everything is along a segment, as the path contract says.
//!
//! A place is a knot and the fraction of the way (with velocities: of the time) to the next. Joints and root positions are
//! linear in it and roots turn on the quaternion geodesic; with velocities all numbers follow cubic polynomials and
//! quaternions are scaled to length 1. An object keeps the pose in its carrier that the segment's first knot writes.

use crate::check::motion::curve::{Cubic, Timed, Turning, timed};
use crate::check::report::check_report::shown;
use crate::check::report::error::CheckError;
use crate::check::world::attachments::Attachment;
use crate::check::world::models::{Body, Frame, Value, World};
use crate::path_file::document::SegmentEntry;
use foliate_components::Pose;
use foliate_components::robot::JointType;
use glam::{DQuat, DVec3};

/// A place along a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct At {
    pub knot: usize,
    /// In [0, 1]; towards the next knot.
    pub fraction: f64,
}

impl At {
    pub(crate) fn knot(knot: usize) -> Self {
        Self { knot, fraction: 0.0 }
    }

    /// The parameter in knots, for people.
    pub(crate) fn t(self) -> f64 {
        self.knot as f64 + self.fraction
    }
}

/// How a body is attached to another one in the segment's attachment tree.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Via {
    /// Rigidly; the body's pose in its parent.
    Rigid(Pose),
    /// By the joint of this number, from its parent body outwards.
    Joint(usize),
    /// By the joint of this number, read backwards: an articulated object held beyond that joint.
    Back(usize),
}

/// A body's parent in the attachment tree, none for the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub parent: Option<usize>,
    pub via: Via,
}

/// A floating object's attachment in a segment.
pub(crate) struct Carry {
    pub part: usize,
    /// Index into the segment's attachments; none where the object has no attachment.
    pub attachment: Option<usize>,
}

/// The motion of all bodies along a segment.
pub(crate) struct SegmentMotion<'a> {
    pub world: &'a World,
    pub index: usize,
    pub knots: &'a [Vec<f64>],
    /// Makes the knots a curve over time.
    pub timed: Option<Timed<'a>>,
    pub edges: Vec<Edge>,
    pub carries: Vec<Carry>,
    pub attachments: &'a [Attachment],
}

impl<'a> SegmentMotion<'a> {
    pub(crate) fn new(
        world: &'a World,
        segment: &'a SegmentEntry,
        index: usize,
        attachments: &'a [Attachment],
    ) -> Result<Self, CheckError> {
        let natural = |body: usize| Edge { parent: world.bodies[body].parent, via: Via::Joint(body) };
        let edges = (0..world.bodies.len()).map(natural).collect();
        let (knots, timed) = (&segment.knots, timed(segment));
        let mut motion = Self { world, index, knots, timed, edges, carries: Vec::new(), attachments };
        // Attachments are read from the written poses, so all of them before the tree changes.
        let attachments: Vec<_> = (0..world.parts.len()).filter_map(|p| motion.attachment_of(p)).collect();
        for (carry, body, edge) in attachments {
            motion.attach(body, edge);
            motion.carries.push(carry);
        }
        motion.refuse_circles()?;
        Ok(motion)
    }

    pub(crate) fn last(&self) -> usize {
        self.knots.len() - 1
    }

    /// What a floating object is attached to: the body that is held, and its new edge. None for one that is held without a
    /// carrier: it moves as written, and its grasps are proved like any relation.
    fn attachment_of(&self, part: usize) -> Option<(Carry, usize, Edge)> {
        let root = self.world.parts[part].root.filter(|_| self.world.parts[part].floats)?;
        let attachment = self.attachments.iter().position(|a| a.carrier && a.part == part && a.held.is_some());
        if attachment.is_none() && self.attachments.iter().any(|a| a.part == part && a.is_grasp()) {
            return None;
        }
        let carry = Carry { part, attachment };
        let still = |body: usize| Edge { parent: None, via: Via::Rigid(self.written(Some(body), 0)) };
        let Some((holder, held, _)) = attachment.and_then(|a| self.attachments[a].held.as_ref()) else {
            return Some((carry, root, still(root)));
        };
        let (carrier, held) = (holder.frame.body, held.frame.body.unwrap_or(root));
        let carrier_from_held = self.written(carrier, 0).inverse() * self.written(Some(held), 0);
        Some((carry, held, Edge { parent: carrier, via: Via::Rigid(carrier_from_held) }))
    }

    /// Gives a body a new parent; the bodies between it and its part's root are then attached to it.
    fn attach(&mut self, body: usize, edge: Edge) {
        let mut below = body;
        while let Some(parent) = self.world.bodies[below].parent {
            self.edges[parent] = Edge { parent: Some(below), via: Via::Back(below) };
            below = parent;
        }
        self.edges[body] = edge;
    }

    fn refuse_circles(&self) -> Result<(), CheckError> {
        // 0: not seen, 1: on the way up from here, 2: known to reach the world.
        let mut state = vec![0_u8; self.edges.len()];
        for start in 0..self.edges.len() {
            let mut trail = Vec::new();
            let mut at = Some(start);
            while let Some(body) = at.filter(|&b| state[b] != 2) {
                if std::mem::replace(&mut state[body], 1) == 1 {
                    let name = &self.world.parts[self.world.bodies[body].part].name;
                    let message = format!("`{}` and what carries it carry each other", shown(name));
                    return Err(CheckError::malformed(format!("segments[{}].attachments", self.index), message));
                }
                trail.push(body);
                at = self.edges[body].parent;
            }
            trail.into_iter().for_each(|b| state[b] = 2);
        }
        Ok(())
    }

    /// Pose of a body in the world, objects on their carriers.
    pub(crate) fn pose(&self, body: Option<usize>, at: At) -> Pose {
        let mut pose = Pose::identity();
        let mut next = body;
        while let Some(body) = next {
            let edge = &self.edges[body];
            pose = match edge.via {
                Via::Rigid(parent_from_body) => parent_from_body * pose,
                Via::Joint(joint) => self.parent_from_body(joint, at) * pose,
                Via::Back(joint) => self.parent_from_body(joint, at).inverse() * pose,
            };
            next = edge.parent;
        }
        pose
    }

    /// Pose of a body in the world at a knot, objects where the file writes them.
    pub(crate) fn written(&self, body: Option<usize>, knot: usize) -> Pose {
        let mut pose = Pose::identity();
        let mut next = body;
        while let Some(body) = next {
            pose = self.parent_from_body(body, At::knot(knot)) * pose;
            next = self.world.bodies[body].parent;
        }
        pose
    }

    pub(crate) fn frame(&self, frame: &Frame, at: At) -> Pose {
        self.pose(frame.body, at) * frame.body_from_frame
    }

    /// Pose of a body in its joint's parent.
    fn parent_from_body(&self, index: usize, at: At) -> Pose {
        let body = &self.world.bodies[index];
        body.parent_from_joint * self.moved(body, index, at)
    }

    fn moved(&self, body: &Body, index: usize, at: At) -> Pose {
        match body.motion {
            JointType::Revolute { axis } => Pose::from_rotation(DQuat::from_axis_angle(axis, self.scalar(index, at))),
            JointType::Prismatic { axis } => Pose::from_translation(axis * self.scalar(index, at)),
            JointType::Planar => {
                let [x, y, theta] = self.numbers(body, at);
                Pose::from_parts(DVec3::new(x, y, 0.0), DQuat::from_rotation_z(theta))
            }
            JointType::FreeFlyer => {
                let [x, y, z] = self.numbers(body, at);
                Pose::from_parts(DVec3::new(x, y, z), self.turn(body, at))
            }
        }
    }

    /// Value of a joint of one coordinate, through any chain of leaders.
    pub(crate) fn scalar(&self, index: usize, at: At) -> f64 {
        self.world.scalar(index, |column| self.number(column, at))
    }

    /// The first numbers of a joint; zeros for one that stands still.
    fn numbers<const N: usize>(&self, body: &Body, at: At) -> [f64; N] {
        match &body.value {
            Value::Columns(columns) => std::array::from_fn(|i| columns.get(i).map_or(0.0, |&c| self.number(c, at))),
            _ => [0.0; N],
        }
    }

    /// Its least and greatest value from a knot to the next.
    pub(crate) fn scalar_range(&self, index: usize, knot: usize) -> (f64, f64) {
        let led = self.world.led(index);
        let Some(column) = led.column else { return (led.offset, led.offset) };
        let (low, high) = self.cubic(column, knot).range();
        let (a, b) = (led.factor * low + led.offset, led.factor * high + led.offset);
        (a.min(b), a.max(b))
    }

    /// How far its value gets from another one at most, by interval between knots; of a single knot, there.
    pub(crate) fn farthest_from(&self, index: usize, value: f64) -> impl Iterator<Item = f64> {
        let off = move |(low, high): (f64, f64)| {
            let (below, above) = ((value - low).abs(), (high - value).abs());
            // Written so that NaN stays one.
            if below > above { below } else { above + 0.0 * below }
        };
        (0..self.last().max(1)).map(move |knot| off(self.scalar_range(index, knot)))
    }

    /// What a number does from a knot to the next.
    pub(crate) fn cubic(&self, column: usize, knot: usize) -> Cubic {
        Cubic::between(self.knots, self.timed, column, knot)
    }

    /// By column, whether it moves as the knots say: all but those of roots of objects that follow a carrier or rest.
    pub(crate) fn moves_as_written(&self) -> Vec<bool> {
        let mut counts = vec![true; self.knots[0].len()];
        for root in self.carries.iter().filter_map(|carry| self.world.parts[carry.part].root) {
            if let Value::Columns(columns) = &self.world.bodies[root].value {
                columns.iter().for_each(|&column| counts[column] = false);
            }
        }
        counts
    }

    fn number(&self, column: usize, at: At) -> f64 {
        let start = self.knots[at.knot][column];
        if at.fraction == 0.0 {
            return start;
        }
        if self.timed.is_some() {
            return self.cubic(column, at.knot).at(at.fraction);
        }
        let end = self.knots[(at.knot + 1).min(self.last())][column];
        start + at.fraction * (end - start)
    }

    /// The written quaternion of a free-flyer at a knot, scaled to one.
    pub(crate) fn quaternion(&self, columns: &[usize], knot: usize) -> DQuat {
        let row = &self.knots[knot.min(self.last())];
        DQuat::from_xyzw(row[columns[3]], row[columns[4]], row[columns[5]], row[columns[6]]).normalize()
    }

    fn turn(&self, body: &Body, at: At) -> DQuat {
        let Value::Columns(columns) = &body.value else { return DQuat::IDENTITY };
        let start = self.quaternion(columns, at.knot);
        if at.fraction == 0.0 {
            return start;
        }
        match self.timed {
            Some(_) => self.turning(columns, at.knot).at(at.fraction),
            None => geodesic(start, self.quaternion(columns, at.knot + 1), at.fraction),
        }
    }

    /// The curve of a free-flyer's quaternion from a knot to the next, where there are velocities.
    pub(crate) fn turning(&self, columns: &[usize], knot: usize) -> Turning {
        Turning(std::array::from_fn(|i| self.cubic(columns[3 + i], knot)))
    }
}

/// Half the angle that takes one unit quaternion to another without flipping signs, in [0, π].
pub(crate) fn half_angle(a: DQuat, b: DQuat) -> f64 {
    2.0 * (a - b).length().atan2((a + b).length())
}

/// The geodesic from `a` (0) to `b` (1) at constant speed, signs as they are.
fn geodesic(a: DQuat, b: DQuat, fraction: f64) -> DQuat {
    let angle = half_angle(a, b);
    let sine = angle.sin();
    if sine < 1e-9 {
        return (a * (1.0 - fraction) + b * fraction).normalize();
    }
    let (from, to) = (((1.0 - fraction) * angle).sin() / sine, (fraction * angle).sin() / sine);
    (a * from + b * to).normalize()
}

/// The part's name of a carry, for people.
impl SegmentMotion<'_> {
    pub(crate) fn name_of(&self, carry: &Carry) -> String {
        let object = &self.world.parts[carry.part].name;
        let by = carry.attachment.map_or("no carrier", |a| self.attachments[a].name.as_str());
        format!("{object} ({by})")
    }
}
