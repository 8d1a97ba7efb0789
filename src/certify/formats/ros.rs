//! JSON of ROS messages: `trajectory_msgs/JointTrajectory`, MoveIt's `RobotTrajectory`, and what wraps these (`DisplayTrajectory`,
//! answers of planning services).
//!
//! Times are `{sec, nanosec}`, `{secs, nsecs}` or a number of seconds. Roots of mobile bases stand in `multi_dof_joint_trajectory`; they
//! go straight from point to point, whatever the joints do. Trajectories in a row are joined, the next from where the last ends; `robots`
//! of our own export move side by side.

use crate::certify::formats::ros_time::Seconds;
use crate::certify::formats::table::Table;
use crate::certify::motion::piecewise::{Attachment, POINTS, Point};
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use foliate_components::robot::{JointType as JointMotion, Part, Robot};
use glam::{DQuat, EulerRot};
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer};

/// Any of the messages: what is not there stays empty.
#[derive(Deserialize, Default)]
#[serde(default)]
struct Message {
    joint_names: Option<Vec<String>>,
    points: Option<Vec<JointPoint>>,
    joint_trajectory: Option<Joints>,
    multi_dof_joint_trajectory: Option<Roots>,
    trajectory_start: Option<State>,
    #[serde(
        alias = "robot_trajectory",
        alias = "planned_trajectory",
        alias = "solution",
        alias = "motion_plan_response"
    )]
    trajectory: Option<Messages>,
    /// Of our own export: robots, and objects with joints, that move at the same time; what carries each object from when on.
    robots: Option<Vec<RobotMotion>>,
    objects: Option<Vec<RobotMotion>>,
    carriers: Option<Vec<Carrier>>,
}

#[derive(Deserialize)]
struct RobotMotion {
    #[serde(alias = "object")]
    robot: String,
    joint_trajectory: Joints,
    #[serde(default)]
    multi_dof_joint_trajectory: Roots,
}

#[derive(Deserialize)]
struct Carrier {
    time_from_start: Seconds,
    object: String,
    link: String,
}

struct Messages(Vec<Message>);

#[derive(Deserialize, Default)]
#[serde(default)]
struct Joints {
    joint_names: Vec<String>,
    points: Vec<JointPoint>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct JointPoint {
    positions: Vec<f64>,
    velocities: Vec<f64>,
    accelerations: Vec<f64>,
    time_from_start: Option<Seconds>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Roots {
    joint_names: Vec<String>,
    points: Vec<RootPoint>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct RootPoint {
    transforms: Vec<Transform>,
    time_from_start: Option<Seconds>,
}

#[derive(Deserialize, Clone, Copy)]
struct Transform {
    translation: Vector,
    rotation: Quaternion,
}

#[derive(Deserialize, Clone, Copy)]
struct Vector {
    x: f64,
    y: f64,
    #[serde(default)]
    z: f64,
}

#[derive(Deserialize, Clone, Copy)]
struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct State {
    joint_state: JointState,
    attached_collision_objects: Vec<serde::de::IgnoredAny>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct JointState {
    name: Vec<String>,
    position: Vec<f64>,
}

impl<'de> Deserialize<'de> for Messages {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMany;
        impl<'de> Visitor<'de> for OneOrMany {
            type Value = Messages;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a trajectory or a list of them")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Messages, A::Error> {
                Ok(Messages(vec![Message::deserialize(MapAccessDeserializer::new(map))?]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Messages, A::Error> {
                let mut messages = Vec::new();
                while let Some(message) = list.next_element()? {
                    messages.push(message);
                }
                Ok(Messages(messages))
            }
        }
        deserializer.deserialize_any(OneOrMany)
    }
}

pub(super) fn read(file: &str, text: &str, robot: &Robot) -> Result<Table, SceneError> {
    let message: Message = serde_json::from_str(text)
        .map_err(|e| SceneError::new(file, "JSON", e.to_string()).at(u32::try_from(e.line()).ok()).because(e))?;
    let mut reader = Reader { file, robot, table: Table { element: "points", ..Table::default() } };
    reader.message(message)?;
    if reader.table.points.is_empty() {
        let hint = "JointTrajectory has joint_names and points, RobotTrajectory a joint_trajectory";
        return Err(SceneError::new(file, "JSON", "holds no trajectory with points").hint(hint));
    }
    Ok(reader.table)
}

struct Reader<'a> {
    file: &'a str,
    robot: &'a Robot,
    table: Table,
}

impl Reader<'_> {
    fn fail(&self, element: impl Into<String>, message: impl Into<String>) -> SceneError {
        SceneError::new(self.file, element, message)
    }

    fn message(&mut self, message: Message) -> Result<(), SceneError> {
        if let Some(state) = message.trajectory_start {
            let JointState { name, position } = state.joint_state;
            self.table.start.extend(name.into_iter().zip(position));
            if !state.attached_collision_objects.is_empty() {
                self.table
                    .notes
                    .push(String::from("attached objects of the file are not read: name them with --attach"));
            }
        }
        let joints = match (message.joint_names, message.points) {
            (Some(joint_names), Some(points)) => Some(Joints { joint_names, points }),
            _ => message.joint_trajectory,
        };
        let roots = message.multi_dof_joint_trajectory.filter(|roots| !roots.points.is_empty());
        match (joints.filter(|joints| !joints.points.is_empty()), roots) {
            (None, None) => {}
            (joints, roots) => self.trajectory(joints.unwrap_or_default(), roots.unwrap_or_default())?,
        }
        if let Some(robots) = message.robots {
            let all = robots.into_iter().chain(message.objects.into_iter().flatten());
            let (joints, roots) = self.side_by_side(all)?;
            self.trajectory(joints, roots)?;
        }
        self.table.attachments.extend(message.carriers.into_iter().flatten().map(|carrier| {
            let link = Some(carrier.link).filter(|link| !link.is_empty());
            Attachment { object: carrier.object, link, time: carrier.time_from_start.0 }
        }));
        for inner in message.trajectory.into_iter().flat_map(|messages| messages.0) {
            self.message(inner)?;
        }
        Ok(())
    }

    /// The joints of all robots as if they were one's; their points are at the same times.
    fn side_by_side(&self, robots: impl Iterator<Item = RobotMotion>) -> Result<(Joints, Roots), SceneError> {
        let (mut joints, mut roots) = (Joints::default(), Roots::default());
        for RobotMotion { robot, joint_trajectory: own, multi_dof_joint_trajectory: root } in robots {
            joints.joint_names.extend(own.joint_names.iter().map(|joint| format!("{robot}/{joint}")));
            roots.joint_names.extend(root.joint_names);
            for (all, more) in [(joints.points.len(), own.points.len()), (roots.points.len(), root.points.len())] {
                if all != more && all != 0 && more != 0 {
                    let message = format!("has {more} points, the robots before have {all}");
                    return Err(self.fail(format!("robots, `{}`", quoted(&robot)), message));
                }
            }
            joints.points.resize_with(joints.points.len().max(own.points.len()), JointPoint::default);
            for (all, own) in joints.points.iter_mut().zip(own.points) {
                if all.time_from_start.is_some_and(|t| Some(t.0) != own.time_from_start.map(|t| t.0)) {
                    let message = "has its points at other times than the robots before";
                    return Err(self.fail(format!("robots, `{}`", quoted(&robot)), message));
                }
                all.time_from_start = own.time_from_start;
                all.positions.extend(own.positions);
                all.velocities.extend(own.velocities);
                all.accelerations.extend(own.accelerations);
            }
            roots.points.resize_with(roots.points.len().max(root.points.len()), RootPoint::default);
            for (all, own) in roots.points.iter_mut().zip(root.points) {
                all.transforms.extend(own.transforms);
                all.time_from_start = own.time_from_start;
            }
        }
        Ok((joints, roots))
    }

    fn trajectory(&mut self, joints: Joints, roots: Roots) -> Result<(), SceneError> {
        let (count, other) = (joints.points.len(), roots.points.len());
        if count != 0 && other != 0 && count != other {
            let message = format!("has {other} points, joint_trajectory has {count}");
            return Err(self.fail("multi_dof_joint_trajectory", message));
        }
        if self.table.points.len() + count.max(other) > POINTS {
            return Err(self.fail("points", format!("more than {POINTS}")));
        }
        let mut names = joints.joint_names;
        let width = names.len();
        let parts = roots.joint_names.iter().map(|name| self.root(name)).collect::<Result<Vec<_>, _>>()?;
        for (_, part) in &parts {
            let planar = self.is_planar(part);
            let axes: &[&str] = if planar { &["x", "y", "theta"] } else { &["x", "y", "z", "qx", "qy", "qz", "qw"] };
            names.extend(axes.iter().map(|axis| format!("{}/{axis}", part.name)));
        }
        self.table.straight = (width..names.len()).collect();
        if self.table.joints.as_ref().is_some_and(|known| *known != names) {
            return Err(self.fail("joint_names", "differ from those of the trajectory before"));
        }
        self.table.joints = Some(names);
        let planar: Vec<bool> = parts.iter().map(|(_, part)| self.is_planar(part)).collect();
        let begin = self.table.points.last().and_then(|p| p.time);
        let mut yaws = vec![0.0; planar.len()];
        let mut made = Vec::with_capacity(count.max(other));
        let mut joint_points = joints.points.into_iter();
        let mut root_points = roots.points.into_iter();
        for index in 0..count.max(other) {
            let joint = joint_points.next().unwrap_or_default();
            let root = root_points.next().unwrap_or_default();
            let point = self.point(index, width, (joint, root), &planar, &mut yaws)?;
            made.push(point);
        }
        self.join(made, begin);
        Ok(())
    }

    /// Behind what there is; a first point that repeats the last is left out.
    fn join(&mut self, mut made: Vec<Point>, begin: Option<f64>) {
        let Some(last) = self.table.points.last() else {
            self.table.points = made;
            return;
        };
        if let Some(begin) = begin {
            made.iter_mut().for_each(|p| p.time = p.time.map(|t| t + begin));
        }
        let repeats = made.first().is_some_and(|first| first.positions == last.positions && first.time == last.time);
        self.table.points.extend(made.into_iter().skip(usize::from(repeats)));
    }

    fn point(
        &self,
        index: usize,
        width: usize,
        (joint, root): (JointPoint, RootPoint),
        planar: &[bool],
        yaws: &mut [f64],
    ) -> Result<Point, SceneError> {
        let element = || format!("points[{index}]");
        for (row, what) in [(&joint.positions, "positions"), (&joint.velocities, "velocities")]
            .into_iter()
            .chain([(&joint.accelerations, "accelerations")])
        {
            if row.len() != width && (what == "positions" || !row.is_empty()) {
                return Err(self.fail(element(), format!("has {} {what}, and {width} joints are named", row.len())));
            }
        }
        if root.transforms.len() != planar.len() {
            let message = format!("has {} transforms, and {} joints are named", root.transforms.len(), planar.len());
            return Err(self.fail(format!("multi_dof_joint_trajectory.points[{index}]"), message));
        }
        let time = joint.time_from_start.or(root.time_from_start).map(|t| t.0);
        let mut positions = joint.positions;
        for ((transform, &planar), yaw) in root.transforms.iter().zip(planar).zip(yaws) {
            let (t, r) = (transform.translation, transform.rotation);
            let length = (r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w).sqrt();
            // Compared so that NaN is refused.
            let is_one = (length - 1.0).abs() < 1e-3;
            if !is_one {
                return Err(self
                    .fail(element(), format!("a rotation has length {length}"))
                    .hint("quaternions have length 1"));
            }
            let turned = DQuat::from_xyzw(r.x, r.y, r.z, r.w).normalize();
            if planar {
                let (now, tilt, roll) = turned.to_euler(EulerRot::ZYX);
                if tilt.abs() + roll.abs() > 1e-6 {
                    return Err(self.fail(element(), "a base that moves in a plane is tilted"));
                }
                let tau = std::f64::consts::TAU;
                *yaw = if index == 0 { now } else { now - tau * ((now - *yaw) / tau).round() };
                positions.extend([t.x, t.y, *yaw]);
            } else {
                positions.extend([t.x, t.y, t.z, turned.x, turned.y, turned.z, turned.w]);
            }
        }
        // Roots have no derivatives here: they go straight.
        let padded = |mut row: Vec<f64>| {
            let given = !row.is_empty();
            row.resize(positions.len(), 0.0);
            given.then_some(row)
        };
        let (velocities, accelerations) = (padded(joint.velocities), padded(joint.accelerations));
        Ok(Point { time, positions, velocities, accelerations })
    }

    /// The part whose root a multi-dof joint is: by its name, that of its root joint, or as the only one that has a root.
    fn root(&mut self, name: &str) -> Result<(String, Part), SceneError> {
        let robot = self.robot;
        let moving: Vec<&Part> = robot.parts.iter().filter(|p| p.root_joint.is_some()).collect();
        let joint = |p: &Part| p.root_joint.map(|j| robot.joints[j.at()].name.clone()).unwrap_or_default();
        if let Some(part) = moving.iter().find(|p| p.name == name || joint(p) == name) {
            return Ok((name.to_owned(), (*part).clone()));
        }
        let robots: Vec<&&Part> =
            moving.iter().filter(|p| p.kind == foliate_components::robot::PartKind::Robot).collect();
        if let [only] = robots.as_slice() {
            self.table.notes.push(format!("`{}` is taken for the root of `{}`", quoted(name), only.name));
            return Ok((name.to_owned(), (**only).clone()));
        }
        let hint = did_you_mean(name, moving.iter().map(|p| p.name.as_str()));
        Err(self
            .fail("multi_dof_joint_trajectory.joint_names", format!("no part has a root `{}`", quoted(name)))
            .hint(hint))
    }

    fn is_planar(&self, part: &Part) -> bool {
        part.root_joint.is_some_and(|j| self.robot.joints[j.at()].motion == JointMotion::Planar)
    }
}
