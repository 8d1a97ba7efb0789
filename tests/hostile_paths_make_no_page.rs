//! Promise: a path file that a stranger wrote makes a page that is true, or an error; never a panic, and no more memory than a page may take.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/pages/mod.rs"]
mod pages;

use foliate::path_file::{LoadedPath, PathFile};
use foliate::scene::PackagePath;
use foliate::view::{Page, ViewOptions, Visuals, page_of_path};
use pages::{document, floats};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const WHEEL: &str = r#"<robot name="wheel"><link name="base"/><link name="rim"><collision><origin xyz="0.2 0 0"/>
    <geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="turn" type="continuous"><parent link="base"/><child link="rim"/><axis xyz="0 0 1"/></joint></robot>"#;
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\nf 1 3 2\nf 1 4 3\nf 5 6 7\n\
    f 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("foliate-hostile-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("wheel.urdf"), WHEEL).unwrap();
    std::fs::write(folder.join("cube.obj"), CUBE).unwrap();
    for (name, mesh) in [("room", "cube.obj"), ("lost", "nowhere.obj")] {
        let text = format!(
            r#"<robot name="{name}"><link name="base"><collision><geometry><mesh filename="{mesh}"/></geometry></collision></link></robot>"#
        );
        std::fs::write(folder.join(format!("{name}.urdf")), text).unwrap();
    }
    folder
}

fn part(name: &str, kind: &str) -> Value {
    json!({"name": name, "kind": kind, "urdf": format!("{name}.urdf"), "srdf": null, "mimic": "follow", "root": "fixed",
        "world_from_root": [0, 0, 0, 0, 0, 0, 1]})
}

/// A wheel that turns through these angles without times.
fn turns(angles: &[f64], around: &[&str]) -> Value {
    let knots: Vec<[f64; 1]> = angles.iter().map(|&angle| [angle]).collect();
    let around = around.iter().map(|name| part(name, "environment"));
    json!({"format": "foliate.path/1", "scene": "s", "seed": 1, "scheduler": "serial", "simd": "none",
        "parts": std::iter::once(part("wheel", "robot")).chain(around).collect::<Vec<_>>(),
        "coordinates": ["wheel/turn"], "limits": {}, "documents": {"grippers": {}, "handles": {}, "surfaces": {}},
        "ignored_pairs": [], "margins": [], "placement_margin": 0.001,
        "segments": [{"transition": "t", "state": "s", "attachments": [], "constraints": [], "knots": knots}],
        "certificate": {"path_tolerance": 1e-4, "max_residual": 0.0, "min_clearance": null, "joint_limits": "within"}})
}

fn made(file: &Value, folder: &Path) -> Result<Page, String> {
    let packages = PackagePath::default().with_placeholders();
    let file: PathFile = serde_json::from_value(file.clone()).unwrap();
    let path = LoadedPath::of_file(&file, folder, &packages).map_err(|e| e.to_string())?;
    let visuals = Visuals::of_path(&path, &packages).unwrap();
    page_of_path((&file, &path), None, None, &visuals, &ViewOptions::default()).map_err(|e| e.to_string())
}

fn refused(file: &Value, folder: &Path) -> String {
    made(file, folder).map(|_page| ()).expect_err("is refused")
}

#[test]
fn surfaces_without_their_points_are_refused() {
    let folder = folder("surfaces");
    for polygon in [json!([0, 1, 7]), json!([0, 1])] {
        let mut file = turns(&[0.0, 1.0], &[]);
        file["documents"]["surfaces"]["wheel/face"] =
            json!({"link": "wheel/rim", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "polygons": [polygon]});
        let error = refused(&file, &folder);
        assert!(error.contains("surfaces[\"wheel/face\"].polygons[0]"), "{error}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn numbers_too_large_for_a_page_are_refused() {
    let folder = folder("numbers");
    for angle in [1e39, 1e300] {
        let error = refused(&turns(&[0.0, angle], &[]), &folder);
        assert!(error.contains("too large for a page"), "{error}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_turn_takes_time_and_many_long_segments_make_a_page_of_bounded_size() {
    let folder = folder("turns");
    let page = made(&turns(&[0.0, std::f64::consts::TAU], &[]), &folder).unwrap();
    let duration = page.document.path.unwrap().duration;
    assert!((duration - std::f64::consts::TAU).abs() < 1e-9, "{duration}");
    let mut file = turns(&[0.0, 1e6], &[]);
    let far = json!([[1e6], [0.0]]);
    file["segments"] = (0..1000).map(|_| file["segments"][0].clone()).collect();
    (1..1000).step_by(2).for_each(|index| file["segments"][index]["knots"] = far.clone());
    let path = made(&file, &folder).unwrap().document.path.unwrap();
    assert!(path.samples <= 1 << 21, "{}", path.samples);
    assert_eq!(path.segments.len(), 1000);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_is_inside_a_mesh_has_no_clearance_and_boxes_for_lost_meshes_are_not_measured() {
    let folder = folder("inside");
    let page = made(&turns(&[0.0, 1.0], &["room"]), &folder).unwrap();
    let document = document(&page);
    let clearance = &document["path"]["clearance"];
    let values = floats(&page, &clearance["values"], clearance["samples"].as_u64().unwrap() as usize);
    assert!(values.len() > 20 && values.iter().all(|&value| value == 0.0), "{values:?}");
    let page = made(&turns(&[0.0, 1.0], &["lost"]), &folder).unwrap();
    assert!(page.document.path.as_ref().unwrap().clearance.is_none());
    assert!(page.document.warnings.iter().any(|w| w.contains("clearance leaves out")), "{:?}", page.document.warnings);
    std::fs::remove_dir_all(folder).unwrap();
}
