//! A small valid path that tests spoil: an arm of two links in the plane z = 0.5 closes on a cube, carries it along a table
//! whose top is one millimetre below, and leaves. The same story as in `tests/independent/test_recheck.py`.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

use foliate::check::{CheckError, CheckOptions, CheckReport, check};
use foliate::path_file::save;
use foliate::scene::PackagePath;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

pub type Pose = [f64; 7];
pub const IDENTITY: Pose = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// A link with a box, or with other geometry.
pub fn link(name: &str, geometry: &str, x: f64) -> String {
    let mass = r#"<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    let collision = match geometry {
        "" => String::new(),
        g => format!(r#"<collision><origin xyz="{x} 0 0"/><geometry>{g}</geometry></collision>"#),
    };
    format!(r#"<link name="{name}">{mass}{collision}</link>"#)
}

pub fn cuboid(x: f64, y: f64, z: f64) -> String {
    format!(r#"<box size="{x} {y} {z}"/>"#)
}

/// A joint about z, limited to ±3.
pub fn joint(name: &str, parent: &str, child: &str, at: [f64; 3], extra: &str) -> String {
    let [x, y, z] = at;
    format!(
        r#"<joint name="{name}" type="revolute"><origin xyz="{x} {y} {z}"/><axis xyz="0 0 1"/><parent link="{parent}"/>
        <child link="{child}"/><limit lower="-3" upper="3" effort="1" velocity="1"/>{extra}</joint>"#
    )
}

pub fn robot(elements: &[String]) -> String {
    format!(r#"<robot name="model">{}</robot>"#, elements.concat())
}

/// The arm, with more elements.
pub fn arm(more: &[String]) -> String {
    let mut elements = vec![
        link("base", "", 0.0),
        link("upper", &cuboid(0.4, 0.04, 0.04), 0.25),
        link("lower", &cuboid(0.4, 0.04, 0.04), 0.25),
        joint("shoulder", "base", "upper", [0.0, 0.0, 0.5], ""),
        joint("elbow", "upper", "lower", [0.5, 0.0, 0.0], ""),
    ];
    elements.extend_from_slice(more);
    robot(&elements)
}

pub const ARM_SRDF: &str = r#"<robot name="model"><disable_collisions link1="upper" link2="lower" reason="Adjacent"/>
    <gripper name="hand"><position>0.5 0 0  1 0 0 0</position><link name="lower"/></gripper></robot>"#;

pub fn about_z(x: f64, y: f64, z: f64, yaw: f64) -> Pose {
    [x, y, z, 0.0, 0.0, (yaw / 2.0).sin(), (yaw / 2.0).cos()]
}

/// World pose of the cube whose centre is at the arm's tip.
pub fn in_hand(shoulder: f64, elbow: f64) -> Pose {
    let turn = shoulder + elbow;
    let (x, y) = (0.5 * shoulder.cos() + 0.5 * turn.cos(), 0.5 * shoulder.sin() + 0.5 * turn.sin());
    about_z(x, y, 0.5, turn)
}

pub fn knot(shoulder: f64, elbow: f64, cube: Pose) -> Value {
    let mut row = vec![shoulder, elbow];
    row.extend(cube);
    json!(row)
}

pub fn held_knot(shoulder: f64, elbow: f64) -> Value {
    knot(shoulder, elbow, in_hand(shoulder, elbow))
}

pub fn part(name: &str, kind: &str, root: &str, pose: Pose) -> Value {
    json!({ "name": name, "kind": kind, "urdf": format!("{name}.urdf"), "srdf": null, "mimic": "follow", "root": root,
            "world_from_root": pose })
}

pub fn placed() -> Value {
    json!({ "object": "cube", "surface": "cube/bottom", "support": "table/top", "carrier": true })
}

pub fn held() -> Value {
    json!({ "object": "cube", "gripper": "arm/hand", "handle": "cube/handle", "carrier": true })
}

pub fn segment(attachments: Value, knots: Vec<Value>) -> Value {
    json!({ "transition": "", "state": "", "attachments": attachments, "constraints": [], "knots": knots })
}

/// The valid path.
pub fn story() -> Value {
    let (start, end) = (in_hand(0.0, 0.0), in_hand(0.1, 0.0));
    let mut arm = part("arm", "robot", "fixed", IDENTITY);
    arm["srdf"] = json!("arm.srdf");
    let six = |value: bool| vec![value; 6];
    json!({
        "format": "foliate.path/1", "scene": "story", "seed": 1, "scheduler": "hand", "simd": "none",
        "parts": [arm, part("table", "environment", "fixed", [0.95, 0.0, 0.469, 0.0, 0.0, 0.0, 1.0]),
                  part("cube", "object", "freeflyer", IDENTITY)],
        "coordinates": ["arm/shoulder", "arm/elbow", "cube/x", "cube/y", "cube/z", "cube/qx", "cube/qy", "cube/qz",
                        "cube/qw"],
        "limits": { "arm/shoulder": [-3.0, 3.0], "arm/elbow": [-3.0, 3.0], "cube/x": [0.0, 2.0], "cube/y": [-1.0, 1.0],
                    "cube/z": [0.0, 1.0] },
        "documents": {
            "grippers": { "arm/hand": { "link": "arm/lower", "link_from_gripper": [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0] } },
            "handles": { "cube/handle": { "link": "cube/cube", "link_from_handle": IDENTITY, "mask": six(true),
                                          "mask_complement": six(false) } },
            "surfaces": {
                "cube/bottom": { "link": "cube/cube", "polygons": [[0, 1, 2, 3]],
                    "points": [[-0.02, -0.02, -0.02], [-0.02, 0.02, -0.02], [0.02, 0.02, -0.02], [0.02, -0.02, -0.02]] },
                "table/top": { "link": "table/top", "polygons": [[0, 1, 2, 3]],
                    "points": [[0.2, 0.3, 0.01], [-0.2, 0.3, 0.01], [-0.2, -0.3, 0.01], [0.2, -0.3, 0.01]] },
            },
        },
        "ignored_pairs": [], "margins": [], "placement_margin": 0.001,
        "segments": [
            segment(json!([placed()]), vec![knot(0.0, -0.6, start), knot(0.0, -0.3, start), knot(0.0, 0.0, start)]),
            segment(json!([held()]), vec![held_knot(0.0, 0.0), held_knot(0.05, 0.0), held_knot(0.1, 0.0)]),
            segment(json!([placed()]), vec![knot(0.1, 0.0, end), knot(0.1, -0.6, end)]),
        ],
        "certificate": { "path_tolerance": 2e-4, "max_residual": 2e-4, "min_clearance": 5e-4, "joint_limits": "within" },
    })
}

/// A temporary folder with the story's models; gone when dropped.
pub struct Folder {
    pub path: PathBuf,
}

impl Folder {
    pub fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("foliate-story-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a temporary folder");
        let folder = Self { path };
        folder.write("arm.urdf", &arm(&[]));
        folder.write("arm.srdf", ARM_SRDF);
        folder.write("cube.urdf", &robot(&[link("cube", &cuboid(0.04, 0.04, 0.04), 0.0)]));
        folder.write("table.urdf", &robot(&[link("top", &cuboid(0.4, 0.6, 0.02), 0.0)]));
        folder.write("plate.urdf", &robot(&[link("plate", &cuboid(0.1, 0.001, 0.2), 0.0)]));
        folder
    }

    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path.join(name);
        std::fs::write(&path, text).expect("a file in the temporary folder");
        path
    }

    /// Checks a path; an error as `foliate check` would tell it.
    pub fn check(&self, path: &Value) -> Result<CheckReport, String> {
        self.check_text(&path.to_string())
    }

    pub fn check_text(&self, text: &str) -> Result<CheckReport, String> {
        let file = save::read(&self.write("path.json", text)).map_err(|e| e.to_string())?;
        check(&file, &self.path, &PackagePath::only(&[]), &CheckOptions::default())
            .map_err(|e: CheckError| e.to_string())
    }

    /// Kinds of the violations, sorted.
    pub fn kinds(&self, path: &Value) -> Vec<&'static str> {
        let report = self.check(path).unwrap_or_else(|e| panic!("refused: {e}"));
        let mut kinds: Vec<_> = report.violations.iter().map(|v| v.kind.name()).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    }

    /// What the first violation is about.
    pub fn subject(&self, path: &Value) -> String {
        let report = self.check(path).unwrap_or_else(|e| panic!("refused: {e}"));
        report.violations.first().map(|v| v.subject.clone()).unwrap_or_default()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.path);
    }
}
