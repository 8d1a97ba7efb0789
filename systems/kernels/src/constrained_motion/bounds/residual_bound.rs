//! How far the rows can leave zero between two knots.
//!
//! Along the straight motion from one knot to the next (free coordinates linear, rotations of roots geodesic), the value
//! f of a constraint differs from the straight line between its end values by at most ⅛ sup‖f″‖. With steps Δᵢ of the
//! joints between the two frames, read from the reference frame outwards, ‖f″‖ ≤ Σᵢⱼ |Δᵢ||Δⱼ| cᵢⱼ where, for i proximal
//! to j or i = j, cᵢⱼ is
//!
//! * ρⱼ if both turn, ρⱼ an upper bound over the whole interval of the distance from axis j to the point,
//! * 1 if i turns and j slides, 0 if i slides.
//!
//! A root counts as one slide (the length of its translation) and one turn (its geodesic angle). For three rotation rows
//! ½(1 + ‖e‖) takes the place of ρ while ‖e‖ ≤ 0.1; where two rotation rows leave one free, what is bounded is the free
//! axis as a unit vector, with ρ = 1.
//!
//! On a curve |Δᵢ| is the largest speed of joint i in the interval, and each joint j adds its largest acceleration times ρⱼ, times 1
//! for a slide or a free axis, times 1 + ‖e‖ for three rotation rows.

use crate::constrained_motion::bounds::function_bound::FunctionBound;
use crate::constrained_motion::bounds::joint_links::{Link, Pace, links_between, links_of};
use crate::constrained_motion::bounds::point_rates::BoundMemory;
use crate::constrained_motion::rows::blocks::{Block, ContactBlock, Kind as BlockKind, Part};
use crate::kinematics::attachment_tree::AttachmentTree;
use crate::kinematics::forward::Placement;
use foliate_components::Pose;
use foliate_components::constraint::{Frame, Placement as Contact, Row, Rows};
use foliate_components::robot::{JointIndex, Robot};
use glam::DVec3;

/// Above this angle between the ends the bound on three rotation rows is not used.
const LARGEST_TURN: f64 = 0.1;

/// The bound for all implicit rows of a program.
#[derive(Clone, Debug, Default)]
pub struct ResidualBound {
    pairs: Vec<Pair>,
    functions: Vec<FunctionBound>,
}

/// Two frames, and the joints between them from `a` outwards.
#[derive(Clone, Debug)]
struct Pair {
    links: Vec<Link>,
    /// The point whose position is bounded, where there are translation rows.
    point: Option<Placement>,
    turns: Turns,
}

/// Which rotation rows there are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turns {
    None,
    /// All three: the rotation vector is bounded.
    All,
    /// Two: the free axis is bounded as a unit vector.
    Axis,
    /// One, or inequalities: nothing is bounded.
    Unbounded,
}

impl ResidualBound {
    pub(crate) fn new(robot: &Robot, tree: &AttachmentTree, blocks: &[Block], is_free: &[bool]) -> Self {
        let links = |a, b| links_between(robot, tree, a, b, is_free);
        let mut pairs = Vec::new();
        for block in blocks {
            match &block.kind {
                BlockKind::Pose(pose) => {
                    let positions = pose.rows[..3].iter().any(Option::is_some);
                    let point = positions.then_some(pose.b);
                    pairs.push(Pair { links: links(pose.a.joint, pose.b.joint), point, turns: Turns::of(&pose.rows) });
                }
                BlockKind::Contact(contact) => {
                    let turns = turns_of_contact(contact, blocks);
                    pairs.extend(pairs_of_contact(&contact.placement, turns, &links));
                }
                _ => {}
            }
        }
        let function = |block| FunctionBound::new(tree, block, |joint| links_of(robot, joint, is_free));
        Self { pairs, functions: blocks.iter().filter_map(function).collect() }
    }

    /// How far any row can be from the straight line between its values at the two ends of a motion with the velocity
    /// `delta` (metres, radians; all velocity coordinates), or infinity where no bound holds. `start` are the poses of
    /// bodies at the motion's start, in the world. An inequality counts only as far as it can be violated: nowhere along
    /// the motion are residuals larger than at the ends by more than this.
    ///
    /// # Panics
    /// If a slice is too short.
    #[must_use]
    pub fn between(&self, delta: &[f64], start: &[Pose]) -> f64 {
        self.between_with(delta, start, &mut BoundMemory::default())
    }

    /// As [`Self::between`], with the caller's buffers.
    ///
    /// # Panics
    /// If a slice is too short.
    #[must_use]
    pub fn between_with(&self, delta: &[f64], start: &[Pose], memory: &mut BoundMemory) -> f64 {
        self.over(&Pace::even(delta), start, memory)
    }

    /// As [`Self::between`], for a motion whose speeds and accelerations are at most those of `pace`.
    pub(crate) fn over(&self, pace: &Pace<'_>, start: &[Pose], memory: &mut BoundMemory) -> f64 {
        let pairs = self.pairs.iter().map(|pair| pair.bound(pace, start)).fold(0.0, f64::max);
        self.functions.iter().map(|function| function.bound(pace, start, memory)).fold(pairs, f64::max)
    }
}

/// The rotation vector of a complement is small only while the contact itself holds.
fn turns_of_contact(contact: &ContactBlock, blocks: &[Block]) -> Turns {
    let touches = |block: &Block| match &block.kind {
        BlockKind::Contact(other) => other.part == Part::Contact && other.placement.object == contact.placement.object,
        _ => false,
    };
    match contact.part {
        Part::Contact => Turns::Axis,
        Part::Hold(_) => Turns::All,
        Part::Complement(_) if blocks.iter().any(touches) => Turns::All,
        Part::Complement(_) => Turns::Unbounded,
    }
}

/// Any pair of polygons may be the one in contact, so all must stay within the bound.
fn pairs_of_contact(
    contact: &Contact,
    turns: Turns,
    links: &impl Fn(Option<JointIndex>, Option<JointIndex>) -> Vec<Link>,
) -> Vec<Pair> {
    let body = |frame: &Frame| Placement { joint: frame.joint, X_JF: frame.joint_from_frame };
    let mut pairs = Vec::new();
    for support in &contact.supports {
        for object in &contact.object {
            let links = links(support.frame.joint, object.frame.joint);
            pairs.push(Pair { links, point: Some(body(&object.frame)), turns });
        }
    }
    pairs
}

impl Turns {
    fn of(rows: &Rows) -> Self {
        let mut turns = rows[3..].iter().flatten();
        if turns.clone().any(|&row| row == Row::Inequality) {
            return Self::Unbounded;
        }
        match turns.by_ref().count() {
            0 => Self::None,
            1 => Self::Unbounded,
            2 => Self::Axis,
            _ => Self::All,
        }
    }
}

impl Pair {
    fn bound(&self, pace: &Pace<'_>, start: &[Pose]) -> f64 {
        if !self.links.iter().any(|link| link.length(pace) > 0.0) {
            return 0.0;
        }
        let angle: f64 = self.links.iter().filter(|l| matches!(l, Link::Turn { .. })).map(|l| l.length(pace)).sum();
        let bend: f64 = self.links.iter().filter(|l| matches!(l, Link::Turn { .. })).map(|l| l.bend(pace)).sum();
        let turns = match self.turns {
            Turns::None => 0.0,
            Turns::Unbounded => f64::INFINITY,
            Turns::Axis => angle * angle + bend,
            // The rotation leaves its nearer end by at most half of the angle.
            Turns::All if 0.5 * angle > LARGEST_TURN => f64::INFINITY,
            Turns::All => 0.5 * (1.0 + 0.5 * angle) * angle * angle + (1.0 + 0.5 * angle) * bend,
        };
        let points =
            self.point.map_or(0.0, |point| self.second_derivative(point.in_world(start).translation, pace, start));
        0.125 * turns.max(points)
    }

    /// A bound on ‖f″‖ of the point's position, with ρ found from the outermost joint inwards: the distance from an axis
    /// changes at most as fast as the joints beyond it move the point.
    fn second_derivative(&self, point: DVec3, pace: &Pace<'_>, start: &[Pose]) -> f64 {
        let mut turned_before: f64 =
            self.links.iter().filter(|l| matches!(l, Link::Turn { .. })).map(|l| l.length(pace)).sum();
        let (mut sum, mut travel) = (0.0, 0.0);
        for link in self.links.iter().rev() {
            let (step, bend) = (link.length(pace), link.bend(pace));
            match *link {
                Link::Turn { body, axis, .. } => {
                    turned_before -= step;
                    let reach = distance_from(&start[body], axis, point) + travel;
                    sum += reach * step * (step + 2.0 * turned_before) + reach * bend;
                    travel += reach * step;
                }
                Link::Slide { .. } => {
                    sum += 2.0 * step * turned_before + bend;
                    travel += step;
                }
            }
        }
        sum
    }
}

fn distance_from(X_WB: &Pose, axis: Option<DVec3>, point: DVec3) -> f64 {
    let offset = point - X_WB.translation;
    match axis {
        Some(axis) => offset.cross(X_WB.rotation * axis).length(),
        None => offset.length(),
    }
}
