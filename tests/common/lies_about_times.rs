//! Lies that a path file may tell about times, velocities, limits of rates and events. The honest file goes from rest to rest between
//! any two knots, as fast as its limits allow.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test that cannot go on says so")]

use crate::lies::Lies;
use serde_json::{Value, json};

struct Told<'h> {
    honest: &'h Value,
    lies: Lies,
}

impl Told<'_> {
    /// One more, unless it changes nothing.
    fn tell(&mut self, kind: &'static str, change: impl FnOnce(&mut Value)) {
        let mut path = self.honest.clone();
        change(&mut path);
        if path != *self.honest {
            self.lies.push((kind, path));
        }
    }

    fn segments(&self) -> usize {
        self.honest["segments"].as_array().unwrap().len()
    }

    fn knots(&self, segment: usize) -> usize {
        self.honest["segments"][segment]["knots"].as_array().unwrap().len()
    }

    fn columns(&self) -> usize {
        self.honest["coordinates"].as_array().unwrap().len()
    }

    fn events(&self) -> usize {
        self.honest["events"].as_array().unwrap().len()
    }

    /// A column that moves from a knot to the next, if any does: a robot's.
    fn moving(&self, segment: usize, knot: usize) -> Option<usize> {
        let row = |knot: usize| self.honest["segments"][segment]["knots"][knot].as_array().unwrap();
        let is_joint = |column: &usize| {
            let name = self.honest["coordinates"][column].as_str().unwrap();
            let owner = name.split('/').next().unwrap();
            let parts = self.honest["parts"].as_array().unwrap();
            parts.iter().any(|part| part["name"] == owner && part["kind"] == "robot")
        };
        (0..self.columns()).filter(is_joint).find(|&column| row(knot)[column] != row(knot + 1)[column])
    }
}

/// All of them.
pub fn all(honest: &Value) -> Lies {
    let mut told = Told { honest, lies: Lies::new() };
    times(&mut told);
    velocities(&mut told);
    limits(&mut told);
    events(&mut told);
    claims(&mut told);
    told.lies
}

fn numbers(list: &mut Value, change: impl Fn(usize, f64) -> f64) {
    for (index, value) in list.as_array_mut().unwrap().iter_mut().enumerate() {
        *value = json!(change(index, value.as_f64().unwrap()));
    }
}

/// Changes all times of segments and events.
fn all_times(path: &mut Value, change: impl Fn(f64) -> f64) {
    path["segments"].as_array_mut().unwrap().iter_mut().for_each(|s| numbers(&mut s["times"], |_, t| change(t)));
    for event in path["events"].as_array_mut().unwrap() {
        event["time"] = json!(change(event["time"].as_f64().unwrap()));
    }
}

fn times(told: &mut Told<'_>) {
    for factor in [0.5, 0.9, 0.999, 0.999_999] {
        told.tell("all times shortened", |path| all_times(path, |t| factor * t));
    }
    told.tell("all times negative", |path| all_times(path, |t| -t));
    for shift in [-1.0, 1e-6, 5.0] {
        told.tell("path does not start at 0", |path| all_times(path, |t| t + shift));
    }
    told.tell("all times 0", |path| all_times(path, |_| 0.0));
    told.tell("times as in version 1", |path| path["format"] = json!("foliate.path/1"));
    for segment in 0..told.segments() {
        for shift in [0.1, -0.1, 1e-9] {
            told.tell("segment shifted in time", |path| {
                if segment > 0 {
                    numbers(&mut path["segments"][segment]["times"], |_, t| t + shift);
                }
            });
        }
        told.tell("times of a segment deleted", |path| drop(table(path, segment).remove("times")));
        told.tell("velocities of a segment deleted", |path| drop(table(path, segment).remove("velocities")));
        told.tell("a time too many", |path| {
            path["segments"][segment]["times"].as_array_mut().unwrap().push(json!(1e5));
        });
        let knots = told.knots(segment);
        for knot in (1..knots).step_by(3) {
            if told.moving(segment, knot - 1).is_some() {
                told.tell("knot passed earlier", |path| {
                    let times = &mut path["segments"][segment]["times"];
                    let (before, here) = (times[knot - 1].as_f64().unwrap(), times[knot].as_f64().unwrap());
                    times[knot] = json!(before + 0.05 * (here - before));
                });
                told.tell("two knots at one time", |path| {
                    let times = &mut path["segments"][segment]["times"];
                    times[knot] = times[knot - 1].clone();
                });
                told.tell("time backwards", |path| {
                    let times = &mut path["segments"][segment]["times"];
                    times[knot] = json!(times[knot - 1].as_f64().unwrap() - 0.5);
                });
            }
        }
    }
    told.tell("all times deleted", |path| {
        (0..path["segments"].as_array().unwrap().len()).for_each(|segment| drop(table(path, segment).remove("times")));
    });
    told.tell("all velocities deleted", |path| {
        (0..path["segments"].as_array().unwrap().len())
            .for_each(|segment| drop(table(path, segment).remove("velocities")));
    });
}

fn table(path: &mut Value, segment: usize) -> &mut serde_json::Map<String, Value> {
    path["segments"][segment].as_object_mut().unwrap()
}

fn velocities(told: &mut Told<'_>) {
    let (segments, columns) = (told.segments(), told.columns());
    let set = |path: &mut Value, (segment, knot, column): (usize, usize, usize), value: f64| {
        path["segments"][segment]["velocities"][knot][column] = json!(value);
    };
    for column in (0..columns).step_by(3) {
        let segment = column % segments;
        let last = told.knots(segment) - 1;
        told.tell("velocity at the start", |path| set(path, (0, 0, column), 1e-3));
        let end = (segments - 1, told.knots(segments - 1) - 1, column);
        told.tell("velocity at the end", |path| set(path, end, -1e-3));
        for velocity in [1e-9, -0.3] {
            told.tell("velocity at one side of a joint knot", |path| set(path, (segment, last, column), velocity));
        }
        told.tell("velocity far beyond its limit", |path| set(path, (segment, last / 2 + 1, column), 50.0));
        told.tell("velocity at an event", |path| {
            let Some(event) = path["events"].as_array().unwrap().first().cloned() else { return };
            let index = event["segment"].as_u64().unwrap() as usize;
            let before = path["segments"][index - 1]["velocities"].as_array().unwrap().len() - 1;
            set(path, (index, 0, column), 0.01);
            set(path, (index - 1, before, column), 0.01);
        });
        told.tell("everything drifts", |path| {
            for segment in path["segments"].as_array_mut().unwrap() {
                for row in segment["velocities"].as_array_mut().unwrap() {
                    row[column] = json!(0.01);
                }
            }
        });
    }
    for segment in 0..segments {
        told.tell("rows of velocities too few", |path| {
            drop(path["segments"][segment]["velocities"].as_array_mut().unwrap().pop());
        });
        told.tell("row of velocities too short", |path| {
            drop(path["segments"][segment]["velocities"][0].as_array_mut().unwrap().pop());
        });
        told.tell("velocities that overflow", |path| set(path, (segment, 0, 0), 1e300));
    }
}

fn limits(told: &mut Told<'_>) {
    let names: Vec<String> = told.honest["rate_limits"].as_object().unwrap().keys().cloned().collect();
    for name in names.into_iter().step_by(4) {
        for key in ["velocity", "acceleration"] {
            let limit = told.honest["rate_limits"][&name][key].as_f64().unwrap();
            for factor in [1.000_01, 100.0] {
                told.tell("rate limit raised", |path| path["rate_limits"][&name][key] = json!(factor * limit));
            }
            for value in [0.0, -1.0] {
                told.tell("rate limit that is none", |path| path["rate_limits"][&name][key] = json!(value));
            }
            told.tell("rate limit left out", |path| {
                drop(path["rate_limits"][&name].as_object_mut().unwrap().remove(key));
            });
        }
        told.tell("rate limits of a coordinate deleted", |path| {
            drop(path["rate_limits"].as_object_mut().unwrap().remove(&name));
        });
    }
    told.tell("rate limits of nothing", |path| path["rate_limits"]["nothing/at_all"] = json!({ "velocity": 1.0 }));
    told.tell("rate limits emptied", |path| path["rate_limits"] = json!({}));
    told.tell("rate limits deleted", |path| drop(path.as_object_mut().unwrap().remove("rate_limits")));
}

fn events(told: &mut Told<'_>) {
    told.tell("events deleted", |path| drop(path.as_object_mut().unwrap().remove("events")));
    told.tell("events emptied", |path| path["events"] = json!([]));
    told.tell("events reversed", |path| path["events"].as_array_mut().unwrap().reverse());
    let grippers: Vec<String> = told.honest["documents"]["grippers"].as_object().unwrap().keys().cloned().collect();
    for number in 0..told.events() {
        let event = told.honest["events"][number].clone();
        let mut changes: Vec<(&'static str, &str, Value)> = Vec::new();
        let mut set = |kind: &'static str, key: &'static str, value: Value| changes.push((kind, key, value));
        let time = event["time"].as_f64().unwrap();
        set("event earlier", "time", json!(time - 1e-3));
        set("event later", "time", json!(time + 1e-6));
        set("time of an event is null", "time", json!(null));
        set("dwell longer than the stand still", "dwell", json!(event["dwell"].as_f64().unwrap() + 0.01));
        set("dwell shorter than the scene's", "dwell", json!(0.5 * event["dwell"].as_f64().unwrap()));
        set("dwell negative", "dwell", json!(-0.2));
        let other = if event["kind"] == "grasp" { "release" } else { "grasp" };
        set("grasp called a release", "kind", json!(other));
        set("event of no kind", "kind", json!("touch"));
        set("event of another handle", "handle", json!("elsewhere/handle"));
        set("event of another object", "object", json!("elsewhere"));
        set("event of another segment", "segment", json!(event["segment"].as_u64().unwrap() + 1));
        set("event of no segment", "segment", json!(0));
        set("finger invented", "fingers", json!({ "robot/finger": 0.1 }));
        for (kind, key, value) in changes {
            told.tell(kind, |path| path["events"][number][key] = value);
        }
        for gripper in &grippers {
            told.tell("event of another gripper", |path| path["events"][number]["gripper"] = json!(gripper));
        }
        told.tell("event deleted", |path| drop(path["events"].as_array_mut().unwrap().remove(number)));
        told.tell("event twice", |path| path["events"].as_array_mut().unwrap().insert(number, event.clone()));
        // The knot at which everything stood still is left out, and with it the time; later times move up.
        let index = event["segment"].as_u64().unwrap() as usize;
        let dwell = event["dwell"].as_f64().unwrap();
        told.tell("stand still left out", |path| {
            for key in ["knots", "velocities", "times"] {
                drop(path["segments"][index][key].as_array_mut().unwrap().remove(1));
            }
            path["segments"][index]["times"][0] = json!(time + dwell);
            let before = path["segments"][index - 1]["times"].as_array_mut().unwrap();
            *before.last_mut().unwrap() = json!(time + dwell);
            for event in path["events"].as_array_mut().unwrap() {
                if event["segment"] == index {
                    (event["time"], event["dwell"]) = (json!(time + dwell), json!(0.0));
                }
            }
        });
        told.tell("moves while it should stand still", |path| {
            let column = 0;
            let value = path["segments"][index]["knots"][1][column].as_f64().unwrap();
            path["segments"][index]["knots"][1][column] = json!(value + 1e-4);
        });
    }
}

fn claims(told: &mut Told<'_>) {
    for key in ["max_velocity", "max_acceleration"] {
        let share = told.honest["certificate"][key].as_f64().unwrap();
        for value in [0.0, 0.9 * share, share - 1e-4, 1.5, -1.0] {
            told.tell("share of a limit claimed", |path| path["certificate"][key] = json!(value));
        }
    }
    for value in [0, 2, 3] {
        told.tell("continuity claimed", |path| path["certificate"]["continuity"] = json!(value));
    }
}
