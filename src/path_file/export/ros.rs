//! Messages of ROS: what a joint trajectory controller executes, and what is attached to which link when.

use crate::path_file::export::columns::{Column, columns};
use crate::path_file::export::messages::Node;
use crate::path_file::export::options::{ExportError, ExportOptions};
use crate::path_file::export::times::{nanoseconds, split};
use crate::planner::trajectory::curve::{Interpolation, Piece};
use crate::planner::trajectory::events::TrajectoryEvent;
use crate::planner::trajectory::segments::Held;
use crate::planner::trajectory::trajectory::Trajectory;
use foliate_components::path::EventKind;
use foliate_components::robot::{JointIndex, JointType, LinkIndex, Part, PartIndex, PartKind, Robot, Source};
use glam::{DQuat, DVec3};

/// A trajectory as JSON: see [`ros_yaml`].
///
/// # Errors
/// There is no such robot or joint.
pub fn ros_json(trajectory: &Trajectory<'_>, options: &ExportOptions) -> Result<String, ExportError> {
    Ok(document(trajectory, options)?.json())
}

/// A trajectory as YAML.
///
/// `robots` has for each robot its name and a `joint_trajectory` with the fields of trajectory_msgs/JointTrajectory: a point for each
/// knot, with positions and velocities and without accelerations, so that the cubic interpolation of ROS 2's `joint_trajectory_controller`
/// is the path's own curve. Joints are called as in the robot's URDF; those that mimic others are left out. A robot whose root moves
/// also has a `multi_dof_joint_trajectory`. `objects` has the joints of drawers and doors, which hands move. `events` attach and detach objects, with the fields of moveit_msgs/AttachedCollisionObject;
/// `carriers` says what each object follows, from when on. Times are rounded to nanoseconds.
///
/// # Errors
/// There is no such robot or joint.
pub fn ros_yaml(trajectory: &Trajectory<'_>, options: &ExportOptions) -> Result<String, ExportError> {
    Ok(document(trajectory, options)?.yaml())
}

fn document(trajectory: &Trajectory<'_>, options: &ExportOptions) -> Result<Node, ExportError> {
    let (columns, knots) = (columns(trajectory, options)?, knots(trajectory));
    Ok(Node::map([
        ("robots", Node::List(trajectories(trajectory, PartKind::Robot, &columns, &knots))),
        ("objects", Node::List(trajectories(trajectory, PartKind::Object, &columns, &knots))),
        ("events", Node::List(events(trajectory))),
        ("carriers", Node::List(carriers(trajectory))),
    ]))
}

/// An entry for each part of a kind that has something to move.
fn trajectories(trajectory: &Trajectory<'_>, kind: PartKind, columns: &[Column], knots: &[Knot<'_>]) -> Vec<Node> {
    let key = if kind == PartKind::Robot { "robot" } else { "object" };
    let of_part = |(part, entry): (usize, &Part)| {
        let part = PartIndex(part as u32);
        let is_own = |column: &&Column| column.part == part && column.is_joint && column.follows.is_none();
        let joints: Vec<&Column> = columns.iter().filter(is_own).collect();
        let root = moving_root(trajectory, columns, part);
        let mut fields = vec![
            (key.to_owned(), Node::text(&entry.name)),
            ("joint_trajectory".to_owned(), joint_trajectory(&joints, knots)),
        ];
        if let Some(root) = root {
            fields.push(("multi_dof_joint_trajectory".to_owned(), root_trajectory(trajectory.robot(), root, knots)));
        }
        (!joints.is_empty() || root.is_some()).then_some(Node::Map(fields))
    };
    let parts = trajectory.robot().parts.iter().enumerate().filter(|(_, part)| part.kind == kind);
    parts.filter_map(of_part).collect()
}

/// A knot and its time: of knots within a nanosecond the first.
struct Knot<'a> {
    time: u64,
    /// The place at the knot.
    at: Piece<'a>,
}

fn knots<'a>(trajectory: &Trajectory<'a>) -> Vec<Knot<'a>> {
    let mut knots: Vec<Knot<'a>> = Vec::new();
    for segment in &trajectory.path().segments {
        let Some(timing) = &segment.timing else { continue };
        for (number, (&time, knot)) in timing.times.iter().zip(&segment.knots).enumerate() {
            let at = nanoseconds(time - trajectory.start());
            if knots.last().is_none_or(|last| last.time < at) {
                let rates = timing.velocities.get(number).map(|rates| (rates.as_slice(), rates.as_slice()));
                let velocities = rates.filter(|_| trajectory.interpolation() == Interpolation::Hermite);
                // Of a piece that ends here: at its end everything is the knot's own.
                let at_knot = Piece { from: knot, to: knot, velocities, duration: 1.0, u: 1.0 };
                knots.push(Knot { time: at, at: at_knot });
            }
        }
    }
    knots
}

fn header() -> Node {
    let stamp = Node::map([("sec", Node::Whole(0)), ("nanosec", Node::Whole(0))]);
    Node::map([("stamp", stamp), ("frame_id", Node::text("world"))])
}

fn time(nanoseconds: u64) -> Node {
    let (sec, nanosec) = split(nanoseconds);
    Node::map([("sec", Node::Whole(sec)), ("nanosec", Node::Whole(nanosec))])
}

fn joint_trajectory(joints: &[&Column], knots: &[Knot<'_>]) -> Node {
    let point = |knot: &Knot<'_>| {
        let numbers = || joints.iter().map(|column| knot.at.number(column.coordinate));
        let velocities = if knot.at.velocities.is_some() { Node::reals(numbers().map(|x| x[1])) } else { none() };
        Node::map([
            ("positions", Node::reals(numbers().map(|x| x[0]))),
            ("velocities", velocities),
            ("accelerations", none()),
            ("effort", none()),
            ("time_from_start", time(knot.time)),
        ])
    };
    Node::map([
        ("header", header()),
        ("joint_names", Node::texts(joints.iter().map(|column| column.bare()))),
        ("points", Node::List(knots.iter().map(point).collect())),
    ])
}

fn none() -> Node {
    Node::List(Vec::new())
}

/// The root joint of a robot, where the options include it and it moves.
fn moving_root(trajectory: &Trajectory<'_>, columns: &[Column], part: PartIndex) -> Option<JointIndex> {
    let root = trajectory.robot().parts[part.at()].root_joint?;
    let numbers = columns.iter().filter(|column| column.part == part && !column.is_joint);
    let knots = || trajectory.path().segments.iter().flat_map(|segment| &segment.knots);
    let moves = |column: &Column| {
        let mut values = knots().map(|knot| knot[column.coordinate].to_bits());
        let first = values.next();
        values.any(|value| Some(value) != first)
    };
    numbers.into_iter().any(moves).then_some(root)
}

/// A trajectory of the root: poses in the frame of the root joint, which is the world unless the scene places the robot's plane
/// elsewhere; twists in the same axes.
fn root_trajectory(robot: &Robot, root: JointIndex, knots: &[Knot<'_>]) -> Node {
    let joint = &robot.joints[root.at()];
    let name = &robot.parts[joint.part.at()].name;
    let first = match joint.source {
        Source::Coordinates { q, .. } => q,
        Source::Follows { .. } => 0,
    };
    let point = |knot: &Knot<'_>| {
        let number = |i: usize| knot.at.number(first + i);
        let (position, rotation, linear, angular) = match joint.motion {
            JointType::Planar => {
                let ([x, dx, _], [y, dy, _], [turn, turning, _]) = (number(0), number(1), number(2));
                let (position, rotation) = (DVec3::new(x, y, 0.0), DQuat::from_rotation_z(turn));
                (position, rotation, DVec3::new(dx, dy, 0.0), DVec3::Z * turning)
            }
            _ => {
                let (x, y, z) = (number(0), number(1), number(2));
                let quaternion = knot.at.quaternion(first + 3);
                let part = |n: usize| DQuat::from_array(quaternion.map(|numbers| numbers[n]));
                let (rotation, rate) = (part(0), part(1));
                // q̇ = ½ ω q, so ω = 2 q̇ q*.
                let angular = rate * rotation.conjugate();
                let linear = DVec3::new(x[1], y[1], z[1]);
                (DVec3::new(x[0], y[0], z[0]), rotation, linear, DVec3::new(angular.x, angular.y, angular.z) * 2.0)
            }
        };
        let transform = Node::map([("translation", vector(position)), ("rotation", quaternion(rotation))]);
        let twist = Node::map([("linear", vector(linear)), ("angular", vector(angular))]);
        let velocities = if knot.at.velocities.is_some() { Node::List(vec![twist]) } else { none() };
        Node::map([
            ("transforms", Node::List(vec![transform])),
            ("velocities", velocities),
            ("accelerations", none()),
            ("time_from_start", time(knot.time)),
        ])
    };
    Node::map([
        ("header", header()),
        ("joint_names", Node::texts([name.as_str()])),
        ("points", Node::List(knots.iter().map(point).collect())),
    ])
}

fn vector(v: DVec3) -> Node {
    Node::map([("x", Node::Real(v.x)), ("y", Node::Real(v.y)), ("z", Node::Real(v.z))])
}

fn quaternion(q: DQuat) -> Node {
    Node::map([("x", Node::Real(q.x)), ("y", Node::Real(q.y)), ("z", Node::Real(q.z)), ("w", Node::Real(q.w))])
}

/// What is attached at the start, and then every event.
fn events(trajectory: &Trajectory<'_>) -> Vec<Node> {
    let robot = trajectory.robot();
    let first = trajectory.segment_at(f64::NEG_INFINITY);
    let link_of = |gripper: &str| robot.gripper(gripper).map(|gripper| robot.grippers[gripper.at()].link);
    let mut told = Vec::new();
    for &held in &first.held {
        let Some(link) = link_of(held.gripper) else { continue };
        told.push(event(trajectory, EventKind::Grasp, held, link, (trajectory.start(), 0.0), &[]));
    }
    for happened in trajectory.events() {
        let TrajectoryEvent { gripper, object, handle, kind, time, dwell, ref fingers, .. } = happened;
        let Some(link) = link_of(gripper) else { continue };
        told.push(event(trajectory, kind, Held { gripper, object, handle }, link, (time, dwell), fingers));
    }
    told
}

fn event(
    trajectory: &Trajectory<'_>,
    kind: EventKind,
    held: Held<'_>,
    link: LinkIndex,
    (at, dwell): (f64, f64),
    fingers: &[(&str, f64)],
) -> Node {
    let robot = trajectory.robot();
    let (what, operation) = match kind {
        // The constants ADD and REMOVE of moveit_msgs/CollisionObject.
        EventKind::Grasp => ("attach", 0),
        EventKind::Release => ("detach", 1),
    };
    let pose = trajectory.pose(held.object, at).unwrap_or_default();
    let pose = Node::map([("position", vector(pose.translation)), ("orientation", quaternion(pose.rotation))]);
    let object = Node::map([
        ("header", header()),
        ("pose", pose),
        ("id", Node::text(held.object)),
        ("operation", Node::Whole(operation)),
    ]);
    let attached = Node::map([
        ("link_name", Node::text(bare(&robot.links[link.at()].name))),
        ("object", object),
        ("touch_links", Node::texts(hand(robot, link))),
    ]);
    let fingers = Node::map([
        ("name", Node::texts(fingers.iter().map(|(name, _)| bare(name)))),
        ("position", Node::reals(fingers.iter().map(|(_, position)| *position))),
    ]);
    Node::map([
        ("type", Node::text(what)),
        ("time_from_start", time(nanoseconds(at - trajectory.start()))),
        ("dwell", Node::Real(dwell)),
        ("robot", Node::text(&robot.parts[robot.links[link.at()].part.at()].name)),
        ("gripper", Node::text(held.gripper)),
        ("handle", Node::text(held.handle)),
        ("fingers", fingers),
        ("attached_collision_object", attached),
    ])
}

/// The links of a gripper: those of its body, and those beyond it.
fn hand(robot: &Robot, link: LinkIndex) -> Vec<String> {
    let Some(palm) = robot.links[link.at()].joint else { return vec![bare(&robot.links[link.at()].name).to_owned()] };
    let is_beyond = |joint: Option<JointIndex>| {
        std::iter::successors(joint, |joint| robot.joints[joint.at()].parent).any(|joint| joint == palm)
    };
    let links = robot.links.iter().filter(|other| is_beyond(other.joint));
    links.map(|link| bare(&link.name).to_owned()).collect()
}

/// What each object follows, from when on, where that changes. Without a link it stays in the world.
fn carriers(trajectory: &Trajectory<'_>) -> Vec<Node> {
    let mut last: Vec<(&str, Option<&str>)> = Vec::new();
    let mut told = Vec::new();
    for segment in trajectory.segments() {
        let gone = last.iter().filter(|(object, _)| !segment.carried.iter().any(|carry| carry.object == *object));
        // An object that a hand holds loosely moves on its own, which nothing here can say.
        let mut changes: Vec<(&str, Option<&str>)> = gone.map(|(object, _)| (*object, None)).collect();
        changes.extend(segment.carried.iter().map(|carry| (carry.object, carry.link)));
        for (object, link) in changes {
            let known = last.iter_mut().find(|(other, _)| *other == object);
            match known {
                Some((_, before)) if *before == link => continue,
                Some((_, before)) => *before = link,
                None => last.push((object, link)),
            }
            told.push(Node::map([
                ("time_from_start", time(nanoseconds(segment.start - trajectory.start()))),
                ("object", Node::text(object)),
                ("link", Node::text(link.unwrap_or_default())),
            ]));
        }
    }
    told
}

fn bare(name: &str) -> &str {
    name.split_once('/').map_or(name, |(_, bare)| bare)
}
