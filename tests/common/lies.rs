//! Lies that a path file may tell: each changes an honest file so that it says something else than what its scene asks and
//! what was planned.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test that cannot go on says so")]

use serde_json::{Value, json};

/// Files that are lied to, by kind of lie.
pub type Lies = Vec<(&'static str, Value)>;

/// An honest file and what the lies are told with.
pub struct Honest<'h> {
    pub path: &'h Value,
    /// Links with shapes.
    pub links: &'h [String],
    /// By part: the name and SHA-256 of a URDF without collision shapes, and of one that is otherwise changed.
    pub spoiled: &'h [[(String, String); 2]],
}

/// Lies, collected.
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

    fn set(&mut self, kind: &'static str, pointer: &str, value: Value) {
        self.tell(kind, |path| {
            if let Some(place) = path.pointer_mut(pointer) {
                *place = value;
            }
        });
    }

    fn keys(&self, pointer: &str) -> Vec<String> {
        let table = self.honest.pointer(pointer).and_then(Value::as_object);
        table.map(|table| table.keys().cloned().collect()).unwrap_or_default()
    }

    fn count(&self, pointer: &str) -> usize {
        self.honest.pointer(pointer).and_then(Value::as_array).map_or(0, Vec::len)
    }
}

pub fn all(honest: &Honest<'_>) -> Lies {
    let mut told = Told { honest: honest.path, lies: Lies::new() };
    parts(&mut told, honest.spoiled);
    documents(&mut told);
    pairs(&mut told, honest.links);
    limits(&mut told);
    attachments(&mut told);
    constraints(&mut told);
    segments(&mut told);
    knots(&mut told);
    claims(&mut told);
    told.lies
}

fn escaped(key: &str) -> String {
    key.replace('~', "~0").replace('/', "~1")
}

fn list<'v>(path: &'v mut Value, pointer: &str) -> &'v mut Vec<Value> {
    path.pointer_mut(pointer).unwrap().as_array_mut().unwrap()
}

fn parts(told: &mut Told<'_>, spoiled: &[[(String, String); 2]]) {
    for part in 0..told.count("/parts") {
        told.tell("part deleted", |path| drop(list(path, "/parts").remove(part)));
        told.set("SRDF dropped", &format!("/parts/{part}/srdf"), json!(null));
        told.tell("SRDF dropped without a trace", |path| {
            let part = &mut path["parts"][part];
            part["srdf"] = json!(null);
            if let Some(sums) = part["sha256"].as_object_mut() {
                sums.remove("srdf");
            }
        });
        for kind in ["robot", "object", "environment"] {
            told.set("kind changed", &format!("/parts/{part}/kind"), json!(kind));
        }
        for root in ["fixed", "freeflyer", "planar"] {
            told.set("root changed", &format!("/parts/{part}/root"), json!(root));
        }
        told.set("mimic changed", &format!("/parts/{part}/mimic"), json!("free"));
        told.set("up axis changed", &format!("/parts/{part}/mesh_up_axis"), json!("declared"));
        for (axis, by) in [(0, 0.01), (1, -0.3), (2, 1e-4)] {
            let pointer = format!("/parts/{part}/world_from_root/{axis}");
            let pose = told.honest.pointer(&pointer).and_then(Value::as_f64).unwrap();
            told.set("pose of a part moved", &pointer, json!(pose + by));
        }
        told.set("SHA-256 changed", &format!("/parts/{part}/sha256/urdf"), json!("0".repeat(64)));
        for (number, (name, sum)) in spoiled[part].iter().enumerate() {
            let kind = ["URDF without collision shapes", "URDF changed"][number];
            told.set(kind, &format!("/parts/{part}/urdf"), json!(name));
            told.tell(kind, |path| {
                path["parts"][part]["urdf"] = json!(name);
                path["parts"][part]["sha256"]["urdf"] = json!(sum);
            });
        }
    }
}

fn documents(told: &mut Told<'_>) {
    for handle in told.keys("/documents/handles") {
        let base = format!("/documents/handles/{}", escaped(&handle));
        told.set("masks emptied", &format!("{base}/mask"), json!(vec![false; 6]));
        told.set("masks emptied", &format!("{base}/mask_complement"), json!(vec![false; 6]));
        for row in 0..6 {
            told.set("mask row freed", &format!("{base}/mask/{row}"), json!(false));
            told.set("handle moved", &format!("{base}/link_from_handle/{}", row % 3), json!(0.123 + 0.01 * row as f64));
        }
        told.tell("handle renamed", |path| {
            let table = path["documents"]["handles"].as_object_mut().unwrap();
            let entry = table.remove(&handle).unwrap();
            table.insert("unnamed".into(), entry);
        });
        told.tell("document added", |path| {
            let entry = path["documents"]["handles"][&handle].clone();
            path["documents"]["handles"][format!("{handle}_too")] = entry;
        });
    }
    for gripper in told.keys("/documents/grippers") {
        let base = format!("/documents/grippers/{}", escaped(&gripper));
        (0..3).for_each(|axis| told.set("gripper moved", &format!("{base}/link_from_gripper/{axis}"), json!(0.321)));
    }
    for surface in told.keys("/documents/surfaces") {
        told.tell("surface enlarged", |path| {
            let points = &mut path["documents"]["surfaces"][&surface]["points"];
            for point in points.as_array_mut().unwrap() {
                (0..2).for_each(|axis| point[axis] = json!(1.5 * point[axis].as_f64().unwrap()));
            }
        });
        told.tell("surface deleted", |path| {
            path["documents"]["surfaces"].as_object_mut().unwrap().remove(&surface);
        });
    }
}

fn pairs(told: &mut Told<'_>, links: &[String]) {
    for reason in ["scene", "adjacent", "by hand", "srdf", ""] {
        for step in [1, 3, 7] {
            let (first, second) = (&links[step % links.len()], &links[(step * 5 + 2) % links.len()]);
            if first != second {
                told.tell("pair ignored", |path| list(path, "/ignored_pairs").push(json!([first, second, reason])));
            }
        }
    }
    told.tell("margins dropped", |path| list(path, "/margins").clear());
    for margin in 0..told.count("/margins") {
        told.set("margin lowered", &format!("/margins/{margin}/2"), json!(1e-5));
    }
    for margin in [0.0, 5e-4, 0.1, -1.0] {
        told.set("placement_margin changed", "/placement_margin", json!(margin));
    }
}

fn limits(told: &mut Told<'_>) {
    for name in told.keys("/limits") {
        let pointer = format!("/limits/{}", escaped(&name));
        let [low, high] =
            [0, 1].map(|i| told.honest.pointer(&format!("{pointer}/{i}")).and_then(Value::as_f64).unwrap());
        told.set("limits widened", &pointer, json!([low - 0.01, high]));
        told.set("limits widened", &pointer, json!([low, high + 10.0]));
        told.tell("limits deleted", |path| {
            path["limits"].as_object_mut().unwrap().remove(&name);
        });
    }
}

fn attachments(told: &mut Told<'_>) {
    for segment in 0..told.count("/segments") {
        for number in 0..told.count(&format!("/segments/{segment}/attachments")) {
            let base = format!("/segments/{segment}/attachments/{number}");
            told.tell("attachment deleted", |path| {
                drop(list(path, &format!("/segments/{segment}/attachments")).remove(number));
            });
            let carrier = told.honest.pointer(&format!("{base}/carrier")).and_then(Value::as_bool).unwrap();
            told.set("carrier flipped", &format!("{base}/carrier"), json!(!carrier));
            for (key, pool) in [("gripper", "grippers"), ("handle", "handles"), ("support", "surfaces")] {
                for other in told.keys(&format!("/documents/{pool}")).into_iter().take(3) {
                    told.set("attachments swapped", &format!("{base}/{key}"), json!(other));
                }
            }
        }
        let others: Vec<Value> = (0..told.count("/segments"))
            .map(|other| told.honest["segments"][other]["attachments"].clone())
            .filter(|other| *other != told.honest["segments"][segment]["attachments"])
            .take(2)
            .collect();
        for other in others {
            told.set("attachments of another segment", &format!("/segments/{segment}/attachments"), other);
        }
    }
}

fn constraints(told: &mut Told<'_>) {
    for segment in 0..told.count("/segments") {
        told.set("constraints deleted", &format!("/segments/{segment}/constraints"), json!([]));
        for number in 0..told.count(&format!("/segments/{segment}/constraints")) {
            let base = format!("/segments/{segment}/constraints/{number}");
            told.tell("constraint deleted", |path| {
                drop(list(path, &format!("/segments/{segment}/constraints")).remove(number));
            });
            told.set("tolerance raised", &format!("{base}/tolerance"), json!(0.5));
            told.set("constraint about another joint", &format!("{base}/joint"), json!("robot/nothing"));
            told.set("position changed", &format!("{base}/position"), json!(0.0123));
            told.set("length changed", &format!("{base}/length"), json!(7.0));
            told.set("constraint mask emptied", &format!("{base}/mask"), json!(vec![false; 6]));
            told.set("planes deleted", &format!("{base}/planes"), json!([]));
            told.set("value moved", &format!("{base}/value/2"), json!(0.0123));
        }
    }
}

fn segments(told: &mut Told<'_>) {
    let count = told.count("/segments");
    for cut in 1..count {
        told.tell("path cut at its start", |path| drop(list(path, "/segments").drain(..cut)));
        told.tell("path cut at its end", |path| list(path, "/segments").truncate(cut));
        told.tell("segments reordered", |path| list(path, "/segments").swap(cut - 1, cut));
        told.tell("segment duplicated", |path| {
            let twice = path["segments"][cut].clone();
            list(path, "/segments").insert(cut, twice);
        });
        told.tell("segment left out", |path| drop(list(path, "/segments").remove(cut)));
    }
    told.tell("path reversed", |path| {
        list(path, "/segments").reverse();
        for segment in list(path, "/segments") {
            segment["knots"].as_array_mut().unwrap().reverse();
        }
    });
    for (kind, times) in [("times zero", 0.0), ("times backwards", -1.0)] {
        told.tell(kind, |path| {
            let mut now = 0.0;
            for segment in list(path, "/segments") {
                let knots = segment["knots"].as_array().unwrap().len();
                let row: Vec<f64> = (0..knots).map(|knot| now + times * knot as f64).collect();
                now = row[knots - 1];
                segment["times"] = json!(row);
            }
        });
    }
    told.tell("times of one segment", |path| {
        let knots = path["segments"][0]["knots"].as_array().unwrap().len();
        path["segments"][0]["times"] = json!((0..knots).collect::<Vec<_>>());
    });
}

fn knots(told: &mut Told<'_>) {
    let (segments, columns) = (told.count("/segments"), told.count("/coordinates"));
    for column in 0..columns {
        let segment = column % segments;
        let last = told.count(&format!("/segments/{segment}/knots")) - 1;
        for (segment, knot) in
            [(0, 0), (segment, last), (segments - 1, told.count(&format!("/segments/{}/knots", segments - 1)) - 1)]
        {
            let pointer = format!("/segments/{segment}/knots/{knot}/{column}");
            let value = told.honest.pointer(&pointer).and_then(Value::as_f64).unwrap();
            told.set("knot perturbed", &pointer, json!(value + 1e-3));
        }
        // The whole path lies a little beside.
        told.tell("coordinate shifted throughout", |path| {
            for segment in list(path, "/segments") {
                for knot in segment["knots"].as_array_mut().unwrap() {
                    knot[column] = json!(knot[column].as_f64().unwrap() + 0.05);
                }
            }
        });
    }
}

fn claims(told: &mut Told<'_>) {
    for clearance in [0.5, 5.0] {
        told.set("clearance claimed", "/certificate/min_clearance", json!(clearance));
    }
    for tolerance in [0.0, 0.01, -1.0] {
        told.set("path tolerance changed", "/certificate/path_tolerance", json!(tolerance));
    }
    // In the demo grasps turn a little between knots. In the others nothing does, beyond rounding: zero is no lie there.
    if told.honest["scene"] == "demo" {
        told.set("residual claimed", "/certificate/max_residual", json!(0.0));
    }
    told.set("limits not kept", "/certificate/joint_limits", json!("mostly"));
    for count in ["tested", "srdf", "adjacent", "ignored", "same_body", "environment"] {
        let pointer = format!("/certificate/pairs/{count}");
        if let Some(pairs) = told.honest.pointer(&pointer).and_then(Value::as_u64) {
            told.set("pairs claimed", &pointer, json!(pairs + 1));
        }
    }
    told.set("another scene's name", "/scene", json!("elsewhere"));
    told.set("another scene file", "/scene_file/sha256", json!("f".repeat(64)));
    told.set("another format", "/format", json!("foliate.path/9"));
    for pointer in ["", "/certificate", "/documents", "/parts/0", "/segments/0"] {
        told.tell("key misspelt", |path| {
            path.pointer_mut(pointer).unwrap().as_object_mut().unwrap().insert("marginz".into(), json!([]));
        });
    }
}
