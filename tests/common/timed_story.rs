//! The story of `story.rs` with times: the same knots, from rest to rest, standing still at both events.
#![allow(clippy::expect_used, clippy::indexing_slicing, reason = "a test that cannot go on says so")]

use serde_json::{Value, json};

/// Seconds between two knots of the story.
pub const STEP: f64 = 1.0;
/// Seconds for which the arm stands still at an event.
pub const DWELL: f64 = 0.2;

/// Makes a path of version 1 one of version 2: all velocities are zero, and segments that begin with an event stand still first.
pub fn with_times(mut path: Value) -> Value {
    path["format"] = json!("foliate.path/2");
    let grasps =
        |segment: &Value| segment["attachments"].as_array().expect("a list").iter().any(|a| a["gripper"].is_string());
    let coordinates = path["coordinates"].as_array().expect("a list").clone();
    let (mut now, mut events, mut was_held) = (0.0, Vec::new(), false);
    for (index, segment) in path["segments"].as_array_mut().expect("a list").iter_mut().enumerate() {
        let is_held = grasps(segment);
        let knots = segment["knots"].as_array_mut().expect("a list");
        let mut times = vec![now];
        if index > 0 && is_held != was_held {
            events
                .push(json!({ "time": now, "dwell": DWELL, "segment": index, "object": "cube", "gripper": "arm/hand",
                                "kind": if is_held { "grasp" } else { "release" }, "handle": "cube/handle" }));
            knots.insert(0, knots[0].clone());
            now += DWELL;
            times.push(now);
        }
        while times.len() < knots.len() {
            now += STEP;
            times.push(now);
        }
        segment["velocities"] = json!(vec![vec![0.0; coordinates.len()]; times.len()]);
        segment["times"] = json!(times);
        was_held = is_held;
    }
    path["events"] = json!(events);
    let limit = json!({ "velocity": 1.0, "acceleration": 4.0 });
    path["rate_limits"] =
        coordinates.iter().map(|name| (name.as_str().expect("a name").to_owned(), limit.clone())).collect();
    path["certificate"]["max_velocity"] = json!(1.0);
    path["certificate"]["max_acceleration"] = json!(1.0);
    path["certificate"]["continuity"] = json!(1);
    path
}
