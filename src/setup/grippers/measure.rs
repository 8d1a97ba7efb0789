//! The size of a hand with two jaws, from its shapes: which way it approaches and closes, how far it opens, where palm and tips are.
//!
//! All is measured in the frame of the palm's body, on points of the shapes no farther apart than [`SPACING`].
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::bodies::{beyond, coordinate};
use crate::setup::grippers::hand::{FingerRange, FoundGripper, GripperKind};
use crate::setup::grippers::tools::frame;
use crate::setup::solids::surface_points::{on_grid, triangles};
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, JointType, LinkIndex, Robot};
use foliate_kernels::kinematics::Kinematics;
use glam::DVec3;

/// Distance of the points that stand for a surface, metres.
const SPACING: f64 = 0.003;
/// How far behind the tips the inner faces of the jaws are measured, metres.
const PADS: f64 = 0.015;
/// Half of the breadth of the channel between the jaws, metres.
const CHANNEL: f64 = 0.006;
/// Least opening of a hand, metres.
const LEAST_OPENING: f64 = 0.005;
/// An axis of a frame is the exact approach where it is nearer than this, radians.
const NEAR_AXIS: f64 = 0.262;
/// Likewise the closing direction, radians.
const NEAR_CLOSING: f64 = 0.1;

/// Likewise of a single jaw, whose way is an arc, radians.
const NEAR_SINGLE: f64 = 0.2;
/// A single jaw closes along its way from here to shut, as a share of its range.
const ALMOST: f64 = 0.85;
/// A single jaw that turns by more than this opens half way alone, radians.
const WIDE: f64 = 1.2;

/// Joints that may be a hand.
pub(super) struct Jaw<'a> {
    /// The body that carries the fingers.
    pub palm: JointIndex,
    /// The joints at which the fingers begin.
    pub roots: &'a [JointIndex],
    /// Whether one jaw moves against the palm's own shapes.
    pub is_single: bool,
}

/// Points of the bodies of a hand, in the palm.
struct Cloud {
    /// By finger root.
    fingers: Vec<Vec<DVec3>>,
    /// Of the palm's own body.
    palm: Vec<DVec3>,
}

impl Cloud {
    /// With the fingers at `share` of the way from `open` to `closed` of their ranges.
    fn of(robot: &Robot, kinematics: &Kinematics, jaw: &Jaw<'_>, ranges: &[FingerRange], share: f64) -> Self {
        let mut q = robot.space.neutral();
        robot.space.clamp(&mut q);
        for range in ranges {
            if let Some(at) = coordinate(robot, range.joint) {
                q[at] = range.open + share * (range.closed - range.open);
            }
        }
        let X_WJ = kinematics.poses(&q);
        let X_PW = X_WJ[jaw.palm.at()].inverse();
        let of_body = |body: JointIndex| {
            let shapes = robot.shapes.iter().filter(move |shape| robot.links[shape.link.at()].joint == Some(body));
            let X_PB = X_PW * X_WJ[body.at()];
            shapes.flat_map(move |s| on_grid(&triangles(&s.geometry, &(X_PB * s.joint_from_shape)), SPACING))
        };
        let fingers = jaw.roots.iter().map(|&root| beyond(robot, root).into_iter().flat_map(of_body).collect());
        Self { fingers: fingers.collect(), palm: of_body(jaw.palm).collect() }
    }
}

/// The mean of points.
fn mean(points: &[DVec3]) -> DVec3 {
    points.iter().sum::<DVec3>() / points.len().max(1) as f64
}

/// The hand, measured; none where its fingers do not move against each other, or leave no room between them.
pub(super) fn measured(robot: &Robot, jaw: &Jaw<'_>, ranges: &[FingerRange]) -> Option<FoundGripper> {
    let kinematics = Kinematics::new(robot);
    let at = |ranges: &[FingerRange], share: f64| Cloud::of(robot, &kinematics, jaw, ranges, share);
    let (low, high) = (at(ranges, 0.0), at(ranges, 1.0));
    if low.fingers.iter().any(Vec::is_empty) || (jaw.is_single && low.palm.is_empty()) {
        return None;
    }
    let chord = closing_axis(jaw, &low, &high)?;
    let ranges = opened(robot, jaw, ranges, is_open_low(robot, jaw, &low, &high, chord));
    let (open, shut) = (at(&ranges, 0.0), at(&ranges, 1.0));
    // One jaw closes along its way shortly before it is shut; two that turn, along the mean of both.
    let along = if jaw.is_single { closing_axis(jaw, &at(&ranges, ALMOST), &shut)? } else { chord };
    let motion = snapped(robot, jaw, along, if jaw.is_single { NEAR_SINGLE } else { NEAR_CLOSING });
    let (one, other) = sides(jaw, &open, (&open, &shut), motion);
    let approach = approach_axis(robot, jaw, if jaw.is_single { &shut } else { &open }, motion)?;
    let outwards = match jaw.is_single {
        true => mean(&open.fingers[0]) - mean(&shut.fingers[0]),
        false => mean(&one) - mean(&other),
    };
    let closing = if outwards.dot(motion) < 0.0 { -motion } else { motion };
    let closing = closing.reject_from_normalized(approach).try_normalize()?;
    let axes = Axes { approach, closing, across: approach.cross(closing) };
    let wide = Size::of(jaw, &axes, (&one, &other), &open)?;
    // Jaws that turn reach farther while they close: half closed is nearest to how they hold something.
    let half = at(&ranges, 0.5);
    let (one, other) = sides(jaw, &half, (&open, &shut), motion);
    let size = Size::of(jaw, &axes, (&one, &other), &half).or_else(|| {
        let (one, other) = sides(jaw, &open, (&open, &shut), motion);
        Size::of(jaw, &axes, (&one, &other), &open)
    })?;
    let (one, other) = sides(jaw, &shut, (&open, &shut), motion);
    let tip = axes.tip(&one).min(axes.tip(&other));
    let left = axes.between(&one, &other, tip, size.across).map_or(0.0, |(low, high)| (high - low).max(0.0));
    // Both jaws meet in the middle; of a single one the fixed jaw says where the middle is.
    let middle = if jaw.is_single { wide.middle } else { size.middle };
    let origin = axes.approach * size.origin + axes.closing * middle + axes.across * size.across;
    let link = palm_link(robot, jaw);
    let X_PG = Pose::from_parts(origin, frame(axes.approach, axes.closing));
    let name = |joint: &FingerRange| robot.joints[joint.joint.at()].name.as_str();
    let joints: Vec<&str> = ranges.iter().map(name).map(|n| n.split_once('/').map_or(n, |(_, own)| own)).collect();
    let jaws = if jaw.is_single { "one jaw against a fixed one" } else { "jaws" };
    Some(FoundGripper {
        name: String::new(),
        link,
        link_from_gripper: robot.links[link.at()].joint_from_link.inverse() * X_PG,
        kind: GripperKind::Jaws {
            opening: wide.opening,
            shut: left.min(wide.opening),
            depth: size.origin - size.palm,
            tip: size.tip - size.origin,
            one_moves: jaw.is_single,
        },
        fingers: widest(robot, jaw, &ranges),
        reason: format!("{jaws} moved by {}", joints.join(", ")),
        solids: Vec::new(),
    })
}

/// Whether the fingers are farther apart at the lower ends of their ranges.
fn is_open_low(robot: &Robot, jaw: &Jaw<'_>, low: &Cloud, high: &Cloud, motion: DVec3) -> bool {
    if jaw.is_single {
        let from = robot.joints[jaw.roots[0].at()].parent_from_joint.translation;
        let of = |cloud: &Cloud| gap(&tips(&cloud.fingers[0], from), &cloud.palm);
        return of(low) > of(high);
    }
    let apart = |cloud: &Cloud| {
        let (one, other) = sides(jaw, cloud, (low, high), motion);
        (mean(&one) - mean(&other)).dot(motion).abs()
    };
    apart(low) > apart(high)
}

/// The ranges from open to closed. A single jaw that turns far is wide open half way: beyond that it stands across.
fn opened(robot: &Robot, jaw: &Jaw<'_>, ranges: &[FingerRange], is_open_low: bool) -> Vec<FingerRange> {
    let turn = |range: &FingerRange| {
        let (open, closed) = if is_open_low { (range.open, range.closed) } else { (range.closed, range.open) };
        let turns = matches!(robot.joints[range.joint.at()].motion, JointType::Revolute { .. });
        let is_wide = jaw.is_single && turns && (open - closed).abs() > WIDE;
        FingerRange { open: if is_wide { (open + closed) / 2.0 } else { open }, closed, ..*range }
    };
    ranges.iter().map(turn).collect()
}

/// The ranges from wide open to closed. A single jaw is measured half open, where its face looks at the other one; it leaves most room for
/// what lies against that where it is open to the end of its range.
fn widest(robot: &Robot, jaw: &Jaw<'_>, ranges: &[FingerRange]) -> Vec<FingerRange> {
    let to_end = |range: &FingerRange| {
        let record = &robot.joints[range.joint.at()];
        let (low, high) = (record.lower[0], record.upper[0]);
        FingerRange { open: if range.open > range.closed { high } else { low }, ..*range }
    };
    if jaw.is_single { ranges.iter().map(to_end).collect() } else { ranges.to_vec() }
}

/// The link of the palm that carries the first finger.
fn palm_link(robot: &Robot, jaw: &Jaw<'_>) -> LinkIndex {
    let child = robot.links.iter().position(|link| link.joint == jaw.roots.first().copied());
    let parent = child.and_then(|child| robot.links[child].parent);
    let fixed = || robot.links.iter().position(|link| link.joint == Some(jaw.palm)).map(|at| LinkIndex(at as u32));
    parent.filter(|p| robot.links[p.at()].joint == Some(jaw.palm)).or_else(fixed).unwrap_or(LinkIndex(0))
}

/// The direction in which fingers move against each other.
fn closing_axis(jaw: &Jaw<'_>, low: &Cloud, high: &Cloud) -> Option<DVec3> {
    let moved: Vec<DVec3> =
        low.fingers.iter().zip(&high.fingers).map(|(a, b)| mean(b) - mean(a)).filter(|d| d.length() > 1e-4).collect();
    let longest = moved.iter().copied().max_by(|a, b| a.length().total_cmp(&b.length()))?;
    if jaw.is_single {
        // Against what is fixed the chord of the moving jaw counts.
        return longest.try_normalize();
    }
    let (with, against): (Vec<DVec3>, Vec<DVec3>) = moved.iter().partition(|d| d.dot(longest) > 0.0);
    if against.is_empty() {
        return None;
    }
    (mean(&with) - mean(&against)).try_normalize()
}

/// The points that are far from where fingers begin: beyond 0.7 of the way to the farthest one.
fn tips(points: &[DVec3], from: DVec3) -> Vec<DVec3> {
    let farthest = points.iter().map(|p| p.distance(from)).fold(0.0, f64::max);
    points.iter().copied().filter(|p| p.distance(from) > 0.7 * farthest).collect()
}

/// Nearly the least distance of points of one kind from some of another, metres: of many points some are compared.
fn gap(some: &[DVec3], others: &[DVec3]) -> f64 {
    let of =
        |points: &[DVec3], count: usize| points.iter().copied().step_by(1 + points.len() / count).collect::<Vec<_>>();
    let (some, others) = (of(some, 400), of(others, 4000));
    some.iter().flat_map(|p| others.iter().map(|o| p.distance_squared(*o))).fold(f64::INFINITY, f64::min).sqrt()
}

/// The points of both sides of a hand: fingers that move one way, and the other way or the palm.
fn sides(jaw: &Jaw<'_>, cloud: &Cloud, (from, to): (&Cloud, &Cloud), closing: DVec3) -> (Vec<DVec3>, Vec<DVec3>) {
    if jaw.is_single {
        return (cloud.fingers.concat(), cloud.palm.clone());
    }
    let (mut one, mut other) = (Vec::new(), Vec::new());
    for (finger, (a, b)) in cloud.fingers.iter().zip(from.fingers.iter().zip(&to.fingers)) {
        let side = if (mean(b) - mean(a)).dot(closing) > 0.0 { &mut one } else { &mut other };
        side.extend_from_slice(finger);
    }
    (one, other)
}

/// From the joints of the fingers to their ends, across the closing direction.
fn approach_axis(robot: &Robot, jaw: &Jaw<'_>, open: &Cloud, closing: DVec3) -> Option<DVec3> {
    let points = open.fingers.concat();
    let roots: Vec<DVec3> =
        jaw.roots.iter().map(|root| robot.joints[root.at()].parent_from_joint.translation).collect();
    let from = mean(&roots);
    let mut along = (mean(&tips(&points, from)) - from).reject_from_normalized(closing);
    // Where on its axis a joint has its origin says nothing.
    if let Some(axis) = common_axis(robot, jaw) {
        along = along.reject_from_normalized(axis);
    }
    let along = along.try_normalize()?;
    let exact = snapped(robot, jaw, along, NEAR_AXIS);
    exact.reject_from_normalized(closing).try_normalize().map(|a| if a.dot(exact) > 0.999 { exact } else { a })
}

/// The direction of the axes about which all fingers turn; none where they slide, or turn about different ones.
fn common_axis(robot: &Robot, jaw: &Jaw<'_>) -> Option<DVec3> {
    let mut axes = jaw.roots.iter().map(|root| match robot.joints[root.at()].motion {
        JointType::Revolute { axis } => Some(robot.joints[root.at()].parent_from_joint.rotation * axis),
        _ => None,
    });
    let first = axes.next()??;
    axes.all(|axis| axis.is_some_and(|axis| axis.dot(first).abs() > 0.999)).then_some(first)
}

/// The nearest axis of a frame of the palm, of its links or of the joints of the fingers, where it is nearer than a limit in radians: arms
/// with few joints reach exact directions alone.
fn snapped(robot: &Robot, jaw: &Jaw<'_>, along: DVec3, limit: f64) -> DVec3 {
    let links = robot.links.iter().filter(|link| link.joint == Some(jaw.palm));
    let links = links.map(|link| link.joint_from_link.rotation);
    let joints = jaw.roots.iter().map(|root| robot.joints[root.at()].parent_from_joint.rotation);
    let axes = links.chain(joints).flat_map(|frame| DVec3::AXES.map(|axis| frame * axis));
    let axes = axes.chain(DVec3::AXES).flat_map(|axis| [axis, -axis]);
    let nearest = axes.max_by(|a, b| a.dot(along).total_cmp(&b.dot(along))).unwrap_or(along);
    if nearest.angle_between(along) < limit { nearest } else { along }
}

/// Directions of a hand, in the palm.
struct Axes {
    approach: DVec3,
    closing: DVec3,
    across: DVec3,
}

impl Axes {
    /// Where the inner faces of both sides are along the closing direction, near the tips: the lower and the upper one.
    fn between(&self, one: &[DVec3], other: &[DVec3], tip: f64, across: f64) -> Option<(f64, f64)> {
        let near = |p: &&DVec3| {
            let ahead = p.dot(self.approach);
            ahead > tip - PADS && ahead < tip + 1e-6 && (p.dot(self.across) - across).abs() < CHANNEL
        };
        let upper = one.iter().filter(near).map(|p| p.dot(self.closing)).reduce(f64::min)?;
        let lower = other.iter().filter(near).map(|p| p.dot(self.closing)).reduce(f64::max)?;
        Some((lower, upper))
    }

    /// How far ahead points reach.
    fn tip(&self, points: &[DVec3]) -> f64 {
        points.iter().map(|p| p.dot(self.approach)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Places along the axes, metres.
struct Size {
    /// Of the tips along the approach.
    tip: f64,
    /// Of the frame's origin along the approach.
    origin: f64,
    /// Of the palm along the approach.
    palm: f64,
    /// Of the middle between the jaws along the closing direction.
    middle: f64,
    /// Of the middle of the tips across both.
    across: f64,
    /// Between the jaws.
    opening: f64,
}

impl Size {
    fn of(jaw: &Jaw<'_>, axes: &Axes, (one, other): (&[DVec3], &[DVec3]), cloud: &Cloud) -> Option<Self> {
        let tip = axes.tip(one).min(axes.tip(other));
        let ends: Vec<f64> = [one, other]
            .into_iter()
            .flat_map(|side| side.iter().filter(|p| (tip - PADS..=tip + 1e-6).contains(&p.dot(axes.approach))))
            .filter(|p| !jaw.is_single || p.dot(axes.approach) <= tip + 1e-6)
            .map(|p| p.dot(axes.across))
            .collect();
        let low = ends.iter().copied().fold(f64::INFINITY, f64::min);
        let high = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let across = (low + high) / 2.0;
        let (lower, upper) = axes.between(one, other, tip, across)?;
        let opening = upper - lower;
        if opening < LEAST_OPENING {
            return None;
        }
        let middle = (lower + upper) / 2.0;
        // What is in the channel between the jaws, behind the pads. Fingers bend: whether they leave room is tested with each handle.
        let in_channel = |p: &&DVec3| {
            (p.dot(axes.closing) - middle).abs() < opening / 4.0
                && (p.dot(axes.across) - across).abs() < 2.0 * CHANNEL
                && p.dot(axes.approach) < tip - PADS
        };
        let behind = cloud.palm.iter().filter(in_channel).map(|p| p.dot(axes.approach));
        let palm = behind.reduce(f64::max).unwrap_or(tip - 0.05).max(tip - 0.2);
        let origin = tip - (0.35 * (tip - palm)).min(0.012);
        Some(Self { tip, origin, palm, middle, across, opening })
    }
}
