//! Promise: a page says what it does not show or know: boxes in the place of missing meshes decide nothing, a start that is infeasible has its
//! state all the same, more triangles than were asked for are told.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

use foliate::components::problem::Problem;
use foliate::components::robot::shape::{Geometry, Mesh};
use foliate::components::samples;
use foliate::scene::{PackagePath, Scene, UpAxis, coordinate_names, read_model};
use foliate::view::{Page, ViewOptions, Visuals, model_of_scene, page_of_model, page_of_scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn demo() -> Scene {
    Scene::load("demo", &PackagePath::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn page(scene: &Scene) -> Page {
    page_of_scene(scene, model_of_scene(scene), &Visuals::of_shapes(&scene.problem.robot), &ViewOptions::default())
}

fn first_number(problem: &Problem, part: &str) -> usize {
    let is_x = |name: &String| name.starts_with(&format!("{part}/")) && name.ends_with("/x");
    coordinate_names(&problem.robot).iter().position(is_x).expect("a free-flyer")
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("foliate-left-out-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn a_start_where_only_placeholders_collide_is_not_decided() {
    let mut scene = demo();
    let [first, second] = ["box1", "box2"].map(|part| first_number(&scene.problem, part));
    let place: Vec<f64> = scene.problem.start[first..first + 7].to_vec();
    scene.problem.start[second..second + 7].copy_from_slice(&place);
    scene.problem.start[second] += 0.01;
    assert!(!page(&scene).document.collisions.is_empty());
    // The same, and the meshes of one box could not be read.
    for shape in scene.problem.robot.shapes.iter_mut().filter(|shape| shape.name.starts_with("box2/")) {
        shape.geometry = Geometry::Mesh(Arc::new(Mesh::placeholder("lost.stl".into())));
    }
    let page = page(&scene);
    assert!(page.document.collisions.is_empty(), "{:?}", page.document.collisions);
    let warnings = page.document.warnings.join("\n");
    assert!(warnings.contains("whether the start is feasible is not decided: a mesh is missing"), "{warnings}");
}

/// An arm beyond its bound does not move the boxes: the state is that of the start.
#[test]
fn a_large_graph_begins_at_the_state_of_an_infeasible_start() {
    let problem = samples::eight_arms_and_ten_boxes().unwrap();
    let mut scene = Scene { problem, parts: Vec::new(), ..demo() };
    let states = |page: &Page| {
        let graph = page.document.graph.as_ref().expect("a graph");
        graph.states.iter().map(|state| state.name.clone()).collect::<Vec<_>>()
    };
    scene.problem.goals.clear();
    let feasible = page(&scene);
    assert!(feasible.document.violations.is_empty() && feasible.document.collisions.is_empty());
    scene.problem.start[0] = scene.problem.robot.space.upper[0] + 0.5;
    let infeasible = page(&scene);
    assert!(!infeasible.document.violations.is_empty());
    assert_eq!(states(&infeasible), states(&feasible));
    assert!(!infeasible.document.warnings.iter().any(|warning| warning.contains("no state")));
    // A box in the air is in no state, with nothing else wrong.
    let mut lost = scene.clone();
    lost.problem.start = samples::eight_arms_and_ten_boxes().unwrap().start;
    let size = lost.problem.robot.space.size();
    lost.problem.start[size - 7 + 2] += 0.3;
    let lost = page(&lost);
    assert!(lost.document.graph.is_none());
    let warnings = lost.document.warnings.join("\n");
    assert!(warnings.contains("which lies in no state"), "{warnings}");
}

#[test]
fn boxes_in_the_place_of_missing_meshes_collide_with_nothing() {
    let folder = folder("pairs");
    let urdf = folder.join("arm.urdf");
    let collision = |shape: &str| format!("<collision><geometry>{shape}</geometry></collision>");
    let [solid, lost] = [r#"<box size="1 1 1"/>"#, r#"<mesh filename="lost.stl"/>"#].map(collision);
    // Links that one joint joins are not tested.
    let joint = |[a, b]: [&str; 2]| {
        let limit = r#"<limit lower="-1" upper="1" velocity="1" effort="1"/>"#;
        format!(
            r#"<joint name="{a}{b}" type="revolute"><parent link="{a}"/><child link="{b}"/><axis xyz="0 0 1"/>{limit}</joint>"#
        )
    };
    let joints: String = [["a", "b"], ["b", "c"], ["c", "d"], ["d", "e"]].map(joint).concat();
    let links = format!(
        r#"<link name="a">{solid}</link><link name="b"/><link name="c">{lost}</link><link name="d"/><link name="e">{solid}</link>"#
    );
    std::fs::write(&urdf, format!(r#"<robot name="arm">{links}{joints}</robot>"#)).unwrap();
    let packages = PackagePath::only(&[]).with_placeholders();
    let mut model = read_model(&urdf.to_string_lossy(), None, UpAxis::AsWritten, &packages).unwrap();
    let page = page_of_model(&mut model, UpAxis::AsWritten, &packages, &ViewOptions::default()).unwrap();
    let named = |pair: &[usize; 2]| pair.map(|link| page.document.links[link].name.clone());
    let pairs: Vec<[String; 2]> = page.document.pairs.as_ref().unwrap().iter().map(named).collect();
    assert_eq!(pairs, [["arm/a".to_owned(), "arm/e".to_owned()]]);
    let always: Vec<&String> = page.document.warnings.iter().filter(|warning| warning.contains("wherever")).collect();
    assert_eq!(always.len(), 1, "{always:?}");
    std::fs::remove_dir_all(folder).unwrap();
}

fn sheet(side: usize) -> String {
    let mut text = String::from("o sheet\n");
    let numbers = |n: usize| (n / (side + 1), n % (side + 1));
    for (y, x) in (0..(side + 1) * (side + 1)).map(numbers) {
        text += &format!("v {} {} 0\n", x as f64 * 0.01, y as f64 * 0.01);
    }
    for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (y, x))) {
        let at = |y: usize, x: usize| y * (side + 1) + x + 1;
        text += &format!(
            "f {} {} {}\nf {} {} {}\n",
            at(y, x),
            at(y, x + 1),
            at(y + 1, x),
            at(y, x + 1),
            at(y + 1, x + 1),
            at(y + 1, x)
        );
    }
    text
}

/// A model of one visual mesh; without a collision shape it would have a warning.
fn model_of_mesh(folder: &Path, mesh: &str) -> String {
    std::fs::write(folder.join("sheet.obj"), mesh).unwrap();
    let urdf = folder.join("sheet.urdf");
    let text = r#"<robot name="r"><link name="l"><visual><geometry><mesh filename="sheet.obj"/></geometry></visual>
      <collision><geometry><sphere radius="1"/></geometry></collision></link></robot>"#;
    std::fs::write(&urdf, text).unwrap();
    urdf.to_string_lossy().into_owned()
}

#[test]
fn more_triangles_than_asked_for_are_told() {
    let folder = folder("triangles");
    let urdf = model_of_mesh(&folder, &sheet(9));
    let packages = PackagePath::only(&[]);
    let mut warnings = [10, 1000].map(|triangles| {
        let mut model = read_model(&urdf, None, UpAxis::AsWritten, &packages).unwrap();
        let page = page_of_model(&mut model, UpAxis::AsWritten, &packages, &ViewOptions { triangles }).unwrap();
        assert_eq!(page.document.triangles, [162, 162]);
        page.document.warnings
    });
    assert!(std::mem::take(&mut warnings[1]).is_empty());
    assert!(warnings[0].join("\n").starts_with("162 triangles are shown, more than the 10 asked for"), "{warnings:?}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_file_that_has_changed_since_it_was_read_is_told() {
    let folder = folder("changed");
    let urdf = model_of_mesh(&folder, &sheet(2));
    let packages = PackagePath::only(&[]);
    let warnings = |change: bool| {
        let mut model = read_model(&urdf, None, UpAxis::AsWritten, &packages).unwrap();
        if change {
            let text = std::fs::read_to_string(&urdf).unwrap();
            std::fs::write(&urdf, text + "\n").unwrap();
        }
        let page = page_of_model(&mut model, UpAxis::AsWritten, &packages, &ViewOptions::default()).unwrap();
        page.document.warnings.join("\n")
    };
    assert_eq!(warnings(false), "");
    let changed = warnings(true);
    assert!(changed.contains("sheet.urdf") && changed.contains("has changed since it was read"), "{changed}");
    std::fs::remove_dir_all(folder).unwrap();
}
