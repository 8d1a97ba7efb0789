//! Recordings in the form MCAP, with messages in JSON: joint states, transforms, events.
//!
//! `/NAME/joint_states` has the fields of sensor_msgs/JointState for a robot or an object with joints, called as its URDF has them. `/tf` and
//! `/tf_static` have foxglove.FrameTransforms, as ROS's robot_state_publisher writes them: links called `part/link` in their parents, those
//! of fixed joints and of environments once. `/events` has grasps and releases.

use crate::path_file::export::columns::{Column, columns};
use crate::path_file::export::npz::kind;
use crate::path_file::export::options::{ExportError, ExportOptions, fits};
use crate::path_file::export::times::{nanoseconds, split};
use crate::planner::trajectory::poses::Poses;
use crate::planner::trajectory::trajectory::Trajectory;
use foliate_components::robot::{LinkIndex, PartIndex, PartKind};
use mcap::WriteOptions;
use mcap::records::MessageHeader;
use mcap::write::Writer;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Cursor;

/// A trajectory as a recording that begins at time 0.
///
/// # Errors
/// There is no such robot or joint; the rate is none; there are more than 2²⁶ numbers.
pub fn mcap(trajectory: &Trajectory<'_>, options: &ExportOptions) -> Result<Vec<u8>, ExportError> {
    let mut by_robot: BTreeMap<PartIndex, Vec<Column>> = BTreeMap::new();
    for column in columns(trajectory, options)?.into_iter().filter(|column| column.is_joint) {
        by_robot.entry(column.part).or_default().push(column);
    }
    let mut recording = Recording::new()?;
    let joint_state = recording.schema("sensor_msgs/JointState", &joint_state_schema())?;
    let transforms = recording.schema("foxglove.FrameTransforms", &transforms_schema())?;
    let event = recording.schema("foliate.Event", &event_schema())?;
    let mut robots = Vec::new();
    for (part, columns) in &by_robot {
        let topic = format!("/{}/joint_states", trajectory.robot().parts[part.at()].name);
        robots.push((recording.channel(joint_state, &topic)?, columns));
    }
    let (tf, events) = (recording.channel(transforms, "/tf")?, recording.channel(event, "/events")?);
    let mut told = trajectory.events().into_iter().peekable();
    let mut poses = trajectory.poses();
    let (still, moving) = frames(trajectory);
    if !still.is_empty() {
        let channel = recording.channel(transforms, "/tf_static")?;
        recording.message(channel, 0, &transforms_message(trajectory, &poses, &still, 0))?;
    }
    let times = trajectory.sample_times(options.rate)?;
    fits(times.len(), 7 * moving.len() + 2 * by_robot.values().map(Vec::len).sum::<usize>())?;
    for time in times {
        while let Some(event) = told.next_if(|event| event.time <= time) {
            let at = nanoseconds(event.time - trajectory.start());
            let fingers: BTreeMap<&str, f64> = event.fingers.iter().copied().collect();
            let message = json!({
                "timestamp": stamp(at), "kind": kind(event.kind), "object": event.object, "gripper": event.gripper,
                "handle": event.handle, "dwell": event.dwell, "fingers": fingers,
            });
            recording.message(events, at, &message)?;
        }
        let at = nanoseconds(time - trajectory.start());
        for (channel, columns) in &robots {
            recording.message(*channel, at, &joint_state_message(trajectory, columns, time, at))?;
        }
        poses.place(time);
        recording.message(tf, at, &transforms_message(trajectory, &poses, &moving, at))?;
    }
    recording.finish()
}

/// A link in the frame of another one; in the world without one.
#[derive(Clone, Copy)]
struct Frame {
    link: LinkIndex,
    parent: Option<LinkIndex>,
}

/// All links in their parents: those that stand still there, those of environments among them, and those that joints or hands move.
fn frames(trajectory: &Trajectory<'_>) -> (Vec<Frame>, Vec<Frame>) {
    let robot = trajectory.robot();
    let is_of_environment =
        |link: LinkIndex| robot.parts[robot.links[link.at()].part.at()].kind == PartKind::Environment;
    let all = (0..robot.links.len() as u32).map(LinkIndex).map(|link| {
        let parent = robot.links[link.at()].parent.filter(|_| !is_of_environment(link));
        Frame { link, parent }
    });
    all.partition(|frame| {
        let body = frame.parent.and_then(|parent| robot.links[parent.at()].joint);
        is_of_environment(frame.link) || robot.links[frame.link.at()].joint == body
    })
}

fn stamp(nanoseconds: u64) -> Value {
    let (sec, nsec) = split(nanoseconds);
    json!({ "sec": sec, "nsec": nsec })
}

fn joint_state_message(trajectory: &Trajectory<'_>, columns: &[Column], time: f64, at: u64) -> Value {
    let moment = trajectory.moment(time);
    let numbers: Vec<_> = columns.iter().map(|column| column.at(trajectory, &moment)).collect();
    let (sec, nanosec) = split(at);
    json!({
        "header": { "stamp": { "sec": sec, "nanosec": nanosec }, "frame_id": "world" },
        "name": columns.iter().map(Column::bare).collect::<Vec<_>>(),
        "position": numbers.iter().map(|x| x[0]).collect::<Vec<_>>(),
        "velocity": numbers.iter().map(|x| x[1]).collect::<Vec<_>>(),
        "effort": [],
    })
}

fn transforms_message(trajectory: &Trajectory<'_>, poses: &Poses<'_>, frames: &[Frame], at: u64) -> Value {
    let name = |link: LinkIndex| trajectory.robot().links[link.at()].name.as_str();
    let transform = |frame: &Frame| {
        let in_world = poses.link(frame.link);
        let pose = frame.parent.map_or(in_world, |parent| poses.link(parent).inverse() * in_world);
        let (t, r) = (pose.translation, pose.rotation);
        json!({
            "timestamp": stamp(at), "parent_frame_id": frame.parent.map_or("world", name),
            "child_frame_id": name(frame.link),
            "translation": { "x": t.x, "y": t.y, "z": t.z },
            "rotation": { "x": r.x, "y": r.y, "z": r.z, "w": r.w },
        })
    };
    json!({ "transforms": frames.iter().map(transform).collect::<Vec<_>>() })
}

fn object(properties: Value) -> Value {
    json!({ "type": "object", "properties": properties })
}

fn numbers(names: &[&str]) -> Value {
    object(names.iter().map(|name| ((*name).to_owned(), json!({ "type": "number" }))).collect())
}

fn time_schema(nanoseconds: &str) -> Value {
    let whole = json!({ "type": "integer", "minimum": 0 });
    object([("sec".to_owned(), whole.clone()), (nanoseconds.to_owned(), whole)].into_iter().collect())
}

fn joint_state_schema() -> Value {
    let list = |kind: &str| json!({ "type": "array", "items": { "type": kind } });
    object(json!({
        "header": object(json!({ "stamp": time_schema("nanosec"), "frame_id": { "type": "string" } })),
        "name": list("string"), "position": list("number"), "velocity": list("number"), "effort": list("number"),
    }))
}

fn transforms_schema() -> Value {
    let transform = object(json!({
        "timestamp": time_schema("nsec"), "parent_frame_id": { "type": "string" },
        "child_frame_id": { "type": "string" }, "translation": numbers(&["x", "y", "z"]),
        "rotation": numbers(&["x", "y", "z", "w"]),
    }));
    object(json!({ "transforms": { "type": "array", "items": transform } }))
}

fn event_schema() -> Value {
    let text = json!({ "type": "string" });
    object(json!({
        "timestamp": time_schema("nsec"), "kind": text, "object": text, "gripper": text, "handle": text,
        "dwell": { "type": "number" }, "fingers": { "type": "object", "additionalProperties": { "type": "number" } },
    }))
}

/// A recording that is being written.
struct Recording {
    writer: Writer<Cursor<Vec<u8>>>,
    sequence: BTreeMap<u16, u32>,
}

impl Recording {
    fn new() -> Result<Self, ExportError> {
        // What the crate is called is no part of a recording: the same trajectory gives the same bytes with the next version.
        let options = WriteOptions::new().library("foliate");
        let writer = options.create(Cursor::new(Vec::new())).map_err(failed)?;
        Ok(Self { writer, sequence: BTreeMap::new() })
    }

    fn schema(&mut self, name: &str, schema: &Value) -> Result<u16, ExportError> {
        self.writer.add_schema(name, "jsonschema", schema.to_string().as_bytes()).map_err(failed)
    }

    fn channel(&mut self, schema: u16, topic: &str) -> Result<u16, ExportError> {
        self.writer.add_channel(schema, topic, "json", &BTreeMap::new()).map_err(failed)
    }

    fn message(&mut self, channel_id: u16, time: u64, message: &Value) -> Result<(), ExportError> {
        let next = self.sequence.entry(channel_id).or_default();
        let header = MessageHeader { channel_id, sequence: *next, log_time: time, publish_time: time };
        *next += 1;
        self.writer.write_to_known_channel(&header, message.to_string().as_bytes()).map_err(failed)
    }

    fn finish(mut self) -> Result<Vec<u8>, ExportError> {
        self.writer.finish().map_err(failed)?;
        Ok(self.writer.into_inner().into_inner())
    }
}

fn failed(error: mcap::McapError) -> ExportError {
    ExportError::write("MCAP", error)
}
