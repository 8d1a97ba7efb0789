//! Promise: a page says what the program knows: where links are, what happens when, what collides and how deep; it is small, and the same
//! input gives the same bytes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]
#![allow(non_snake_case, reason = "pose names carry their frames")]

mod common;

#[path = "common/pages/mod.rs"]
mod pages;
#[path = "common/written.rs"]
mod written;

use common::published_models;
use foliate::check::{CheckOptions, check};
use foliate::components::Pose;
use foliate::kernels::kinematics::Kinematics;
use foliate::path_file::{LoadedPath, save};
use foliate::scene::{PackagePath, Scene, UpAxis, read_model};
use foliate::view::{
    Page, ViewOptions, Visuals, model_of_scene, page_of_model, page_of_path, page_of_scene, page_of_solution,
};
use foliate::{Planner, Solution};
use pages::{Placement, document, floats, links, numbers, shorts};
use serde_json::Value;
use std::path::{Path, PathBuf};
use written::written;

fn scene(name: &str, packages: &PackagePath) -> Scene {
    Scene::load(name, packages).unwrap_or_else(|e| panic!("{e}"))
}

fn solved(scene: &Scene, first: bool) -> Solution {
    let planner = Planner::new(scene.problem.clone()).unwrap().seed(1);
    let planner = if first { planner.first_path() } else { planner.improve_work(20_000) };
    planner.solve().unwrap_or_else(|e| panic!("{}: {e}", scene.problem.name))
}

fn page_of(scene: &Scene, solution: &Solution, packages: &PackagePath) -> Page {
    let visuals = Visuals::of_scene(scene, packages).unwrap();
    page_of_solution(solution, &visuals, &ViewOptions::default()).unwrap()
}

fn scene_page(scene: &Scene, packages: &PackagePath) -> Page {
    let visuals = Visuals::of_scene(scene, packages).unwrap();
    page_of_scene(scene, model_of_scene(scene), &visuals, &ViewOptions::default())
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("foliate-pages-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// How far a placement is from a pose: metres, and the largest difference of what the axes are turned to.
fn off(placement: &Placement, pose: &Pose) -> f64 {
    let at = pose.translation.to_array();
    let moved = (0..3).map(|i| (placement.at[i] - at[i]).abs());
    let axes = [glam::DVec3::X, glam::DVec3::Y, glam::DVec3::Z].map(|axis| (pose.rotation * axis).to_array());
    let turned = (0..9).map(|n| (placement.rows[n / 3][n % 3] - axes[n % 3][n / 3]).abs());
    moved.chain(turned).fold(0.0, f64::max)
}

use foliate::glam;

/// Every link at every sample, and between samples, against the program's own kinematics.
fn links_are_where_they_are(scene: &Scene, solution: &Solution, page: &Page) {
    let document = document(page);
    let path = &document["path"];
    let (count, size) = (path["samples"].as_u64().unwrap() as usize, document["coordinates"].as_array().unwrap().len());
    let times = floats(page, &path["times"], count);
    let all = floats(page, &path["configurations"], count * size);
    assert!(times.windows(2).all(|t| t[0] < t[1]) && times[0] == 0.0, "{times:?}");
    let robot = &scene.problem.robot;
    let kinematics = Kinematics::new(robot);
    let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
    for q in all.chunks_exact(size) {
        kinematics.forward(q, &mut X_WJ);
        for (link, placement) in robot.links.iter().zip(links(&document, q)) {
            let pose = link.joint.map_or(link.joint_from_link, |j| X_WJ[j.at()] * link.joint_from_link);
            assert!(off(&placement, &pose) < 1e-6, "{}", link.name);
        }
    }
    // Numbers between samples are straight; the document says by how much that is off.
    let Ok(trajectory) = solution.trajectory() else { return };
    assert_eq!(path["timed"], true);
    let promised = path["deviation"].as_f64().unwrap();
    assert!(promised < 1e-3, "{promised}");
    let mut poses = trajectory.poses();
    for sample in 0..count - 1 {
        let middle = 0.5 * (times[sample] + times[sample + 1]);
        poses.place(trajectory.start() + middle);
        let exact = poses.configuration();
        for joint in document["joints"].as_array().unwrap() {
            if !matches!(joint["type"].as_str().unwrap(), "revolute" | "prismatic") {
                continue;
            }
            let Some(i) = joint["q"].as_u64().map(|i| i as usize) else { continue };
            let straight = 0.5 * (all[sample * size + i] + all[(sample + 1) * size + i]);
            assert!(
                (straight - exact[i]).abs() < promised + 1e-5,
                "{} at {middle}: {straight} {}",
                joint["name"],
                exact[i]
            );
        }
    }
}

#[test]
fn links_are_where_the_program_has_them() {
    let packages = PackagePath::default();
    for (name, first) in [("demo", false), ("drawer", false), ("stack", true)] {
        let scene = scene(name, &packages);
        let solution = solved(&scene, first);
        let page = page_of(&scene, &solution, &packages);
        links_are_where_they_are(&scene, &solution, &page);
        segments_cover_the_path(&solution, &page);
        clearance_is_that_of_the_shapes(&page);
        assert_eq!(page.html().unwrap(), page_of(&scene, &solution, &packages).html().unwrap(), "{name}");
    }
}

fn segments_cover_the_path(solution: &Solution, page: &Page) {
    let path = page.document.path.as_ref().unwrap();
    let segments = &path.segments;
    assert_eq!(segments.len(), solution.path.segments.len());
    assert_eq!(segments[0].from, 0.0);
    assert!((segments[segments.len() - 1].to - path.duration).abs() < 1e-9);
    assert!(segments.windows(2).all(|pair| pair[0].to == pair[1].from && pair[0].from <= pair[0].to));
    let graph = page.document.graph.as_ref().unwrap();
    let model = &solution.model.graph;
    for (entry, segment) in segments.iter().zip(&solution.path.segments) {
        assert!(!entry.words.is_empty());
        let transition = &graph.transitions[entry.transition.expect("its transition is shown")];
        assert_eq!(transition.name, model.transition(segment.transition).name);
        let state = model.state(segment.state);
        match entry.state {
            Some(place) => assert_eq!(graph.states[place].name, state.name),
            None => assert!(state.is_passed_through(), "{}", state.name),
        }
    }
    let events = foliate::components::path::events(&solution.path);
    assert_eq!(path.events.len(), events.len());
    assert!(path.events.iter().all(|event| (0.0..=path.duration).contains(&event.time)));
    // In words that a person reads.
    let words: Vec<&str> = segments.iter().map(|segment| segment.words.as_str()).collect();
    assert!(words.iter().any(|words| words.contains("reaches for")), "{words:?}");
}

fn clearance_is_that_of_the_shapes(page: &Page) {
    let document = document(page);
    let clearance = &document["path"]["clearance"];
    let count = clearance["samples"].as_u64().unwrap() as usize;
    let values = floats(page, &clearance["values"], count);
    let points = floats(page, &clearance["points"], 6 * count);
    let pairs = clearance["pairs"].as_array().unwrap();
    let numbers = shorts(page, &clearance["pair"], count);
    assert!(numbers.iter().all(|&pair| usize::from(pair) < pairs.len()));
    for (value, points) in values.iter().zip(points.chunks_exact(6)) {
        assert!(*value > 0.0, "a certified path touches nothing");
        let between = (0..3).map(|i| (points[i] - points[i + 3]).powi(2)).sum::<f64>().sqrt();
        assert!((between - value).abs() < 2e-5, "{between} {value}");
    }
}

#[test]
fn a_path_file_makes_a_page_with_the_verdict() {
    let (packages, folder) = (PackagePath::default(), folder("verdict"));
    let scene = scene("demo", &packages);
    let solution = solved(&scene, true);
    let place = folder.join("path.json");
    let mut file = written(&scene, &solution.model.graph, &solution.path, &place);
    save::save(&file, &place).unwrap();
    let page = |file: &foliate::path_file::PathFile| {
        let path = LoadedPath::of_file(file, &folder, &packages).unwrap();
        let report = check(file, &folder, &packages, &CheckOptions::default());
        let visuals = Visuals::of_path(&path, &packages).unwrap();
        page_of_path((file, &path), Some(&scene), Some(&report), &visuals, &ViewOptions::default()).unwrap()
    };
    let good = page(&file);
    // Path files do not carry the directions of approach: those of the page are the scene's.
    for handle in &good.document.documents.handles {
        let known = scene.problem.robot.handle(&handle.name).map(|index| &scene.problem.robot.handles[index.at()]);
        assert_eq!(handle.approach, known.map(|known| known.approaching_direction.to_array()), "{}", handle.name);
    }
    let path = LoadedPath::of_file(&file, &folder, &packages).unwrap();
    let visuals = Visuals::of_path(&path, &packages).unwrap();
    let alone = page_of_path((&file, &path), None, None, &visuals, &ViewOptions::default()).unwrap();
    assert!(alone.document.documents.handles.iter().all(|handle| handle.approach.is_none()));
    let path = good.document.path.as_ref().unwrap();
    assert_eq!((path.verdict.as_deref(), path.refused.len()), (Some("proved"), 0));
    assert!(!path.timed && path.velocities.is_none());
    let graph = good.document.graph.as_ref().unwrap();
    assert_eq!(graph.states.len(), solution.model.graph.states_of_nodes().count());
    // A knot in the middle of the third segment, far away.
    let knots = &mut file.segments[2].knots;
    let middle = knots[0].clone();
    knots.insert(1, middle);
    knots[1].iter_mut().take(2).for_each(|x| *x += 0.4);
    let bad = page(&file);
    let path = bad.document.path.as_ref().unwrap();
    assert_eq!(path.verdict.as_deref(), Some("refused"));
    let segment = &path.segments[2];
    let inside = path.refused.iter().filter_map(|refused| refused.time);
    assert!(inside.clone().count() > 0, "{:?}", path.refused);
    assert!(inside.clone().any(|time| (segment.from..=segment.to).contains(&time)), "{:?}", path.refused);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn an_infeasible_start_says_which_pair_and_how_deep() {
    let packages = PackagePath::default();
    let mut scene = scene("demo", &packages);
    let names = foliate::scene::coordinate_names(&scene.problem.robot);
    let [first, second] = ["box1", "box2"].map(|part| {
        let x = names.iter().position(|name| name.starts_with(&format!("{part}/")) && name.ends_with("/x"));
        x.unwrap_or_else(|| panic!("{part} is in {names:?}"))
    });
    // One box 1 cm beside the other, both on the table.
    let place: Vec<f64> = scene.problem.start[first..first + 7].to_vec();
    scene.problem.start[second..second + 7].copy_from_slice(&place);
    scene.problem.start[second] += 0.01;
    let page = scene_page(&scene, &packages);
    let links = &page.document.links;
    let found = page.document.collisions.iter().find(|collision| {
        let [a, b] = collision.links.map(|link| links[link].name.as_str());
        a.starts_with("box") && b.starts_with("box")
    });
    let found = found.unwrap_or_else(|| panic!("{:?}", page.document.collisions));
    let document = document(&page);
    assert_eq!(document["collisions"][0]["configuration"], "start");
    assert!(found.words.contains("mm deep"), "{}", found.words);
    // To set them apart one has to go aside by its width less a centimetre, or up by its height.
    let depth = found.depth.expect("a depth");
    assert!(depth > 0.02 && depth < 0.2, "{depth}");
    assert!(found.point.is_some());
}

#[test]
fn a_start_out_of_bounds_is_told_with_its_numbers() {
    let packages = PackagePath::default();
    let mut scene = scene("demo", &packages);
    let upper = scene.problem.robot.space.upper[0];
    scene.problem.start[0] = upper + 0.5;
    let page = scene_page(&scene, &packages);
    let violation = page.document.violations.first().expect("a violation");
    assert_eq!((violation.value, violation.limit), (Some(upper + 0.5), Some(upper)));
    assert!(violation.words.starts_with("the start is infeasible") && violation.joint.is_some());
}

#[test]
fn a_model_has_sliders_and_what_collides() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/demo");
    let urdf = root.join("robot.urdf").to_string_lossy().into_owned();
    let packages = PackagePath::default();
    let mut model = read_model(&urdf, None, UpAxis::AsWritten, &packages).unwrap();
    let page = page_of_model(&mut model, UpAxis::AsWritten, &packages, &ViewOptions::default()).unwrap();
    let document = document(&page);
    assert_eq!(document["kind"], "model");
    let start = numbers(&document["start"]);
    assert_eq!(start.len(), document["coordinates"].as_array().unwrap().len());
    for joint in document["joints"].as_array().unwrap() {
        let Some(q) = joint["q"].as_u64() else { continue };
        let (low, high) = (joint["lower"][0].as_f64(), joint["upper"][0].as_f64());
        assert!(low.is_none_or(|low| start[q as usize] >= low) && high.is_none_or(|high| start[q as usize] <= high));
    }
    assert!(page.document.pairs.as_ref().is_some_and(|pairs| !pairs.is_empty()));
}

#[test]
fn a_model_without_its_meshes_is_shown_with_placeholders() {
    let folder = folder("missing");
    let urdf = folder.join("arm.urdf");
    std::fs::write(
        &urdf,
        r#"<robot name="arm"><link name="base">
             <visual><geometry><mesh filename="shown.dae"/></geometry></visual>
             <collision><geometry><mesh filename="package://nowhere/solid.stl"/></geometry></collision>
           </link></robot>"#,
    )
    .unwrap();
    let name = urdf.to_string_lossy().into_owned();
    let packages = PackagePath::only(&[]);
    // Nothing is planned or proved with placeholders.
    assert!(read_model(&name, None, UpAxis::AsWritten, &packages).is_err());
    let packages = packages.with_placeholders();
    let mut model = read_model(&name, None, UpAxis::AsWritten, &packages).unwrap();
    let page = page_of_model(&mut model, UpAxis::AsWritten, &packages, &ViewOptions::default()).unwrap();
    let link = &page.document.links[0];
    assert_eq!(link.visual[0].missing.as_deref(), Some("shown.dae"));
    assert_eq!(link.collision[0].missing.as_deref(), Some("package://nowhere/solid.stl"));
    let warnings = page.document.warnings.join("\n");
    assert!(warnings.contains("shown.dae") && warnings.contains("solid.stl"), "{warnings}");
    assert!(page.html().unwrap().len() > 1000);
    std::fs::remove_dir_all(folder).unwrap();
}

/// Colours of the URDF and of COLLADA files.
#[test]
fn meshes_have_the_colours_of_their_files() {
    let folder = folder("colours");
    let dae = r##"<?xml version="1.0"?><COLLADA version="1.4.1" xmlns="http://www.collada.org/2005/11/COLLADASchema">
      <library_effects>
        <effect id="red-e"><profile_COMMON><technique sid="c"><lambert><diffuse><color>0.9 0.1 0.2 1</color></diffuse></lambert></technique></profile_COMMON></effect>
        <effect id="blue-e"><profile_COMMON><technique sid="c"><phong><diffuse><color>0 0.2 0.8 1</color></diffuse></phong></technique></profile_COMMON></effect>
      </library_effects>
      <library_materials>
        <material id="red-m"><instance_effect url="#red-e"/></material><material id="blue-m"><instance_effect url="#blue-e"/></material>
      </library_materials>
      <library_geometries><geometry id="g"><mesh>
        <source id="p"><float_array id="p-a" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array></source>
        <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
        <triangles material="r" count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1</p></triangles>
        <triangles material="b" count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 3 1 2 3</p></triangles>
      </mesh></geometry></library_geometries>
      <library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"><bind_material><technique_common>
        <instance_material symbol="r" target="#red-m"/><instance_material symbol="b" target="#blue-m"/>
      </technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
      <scene><instance_visual_scene url="#s"/></scene></COLLADA>"##;
    std::fs::write(folder.join("two.dae"), dae).unwrap();
    let urdf = folder.join("arm.urdf");
    let link = |name: &str, material: &str| {
        format!(
            r#"<link name="{name}"><visual><geometry><mesh filename="two.dae"/></geometry>{material}</visual></link>"#
        )
    };
    let green = r#"<material name="green"><color rgba="0 1 0 0.5"/></material>"#;
    let joint = r#"<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>"#;
    std::fs::write(&urdf, format!(r#"<robot name="arm">{}{}{joint}</robot>"#, link("a", ""), link("b", green)))
        .unwrap();
    let packages = PackagePath::only(&[]);
    let name = urdf.to_string_lossy().into_owned();
    let mut model = read_model(&name, None, UpAxis::AsWritten, &packages).unwrap();
    let page = page_of_model(&mut model, UpAxis::AsWritten, &packages, &ViewOptions::default()).unwrap();
    let colors = |link: usize| page.document.links[link].visual.iter().map(|v| v.color).collect::<Vec<_>>();
    assert_eq!(colors(0), [Some([0.9, 0.1, 0.2, 1.0]), Some([0.0, 0.2, 0.8, 1.0])]);
    assert_eq!(colors(1), [Some([0.0, 1.0, 0.0, 0.5]); 2]);
    let counts: Vec<usize> = page.document.meshes.iter().map(|mesh| mesh.triangles).collect();
    assert_eq!(counts, [1, 2], "shared by both links");
    std::fs::remove_dir_all(folder).unwrap();
}

/// Bounds of sizes and deviations on published robots; the JSON of every shipped scene's page is whole, and boxes of states lie apart.
#[test]
fn pages_of_all_shipped_scenes_are_small_and_readable() {
    let Some(packages) = published_models("pages_of_all_shipped_scenes_are_small_and_readable") else { return };
    for shipped in foliate::scene::shipped_scenes() {
        let scene = scene(shipped.name, &packages);
        let page = scene_page(&scene, &packages);
        let html = page.html().unwrap();
        let most = if shipped.name.starts_with("romeo") { 6.0 } else { 3.0 };
        println!(
            "{}: {:.2} MB, {} of {} triangles, deviation {:.2} mm",
            shipped.name,
            html.len() as f64 / 1e6,
            page.document.triangles[1],
            page.document.triangles[0],
            page.document.deviation * 1e3
        );
        assert!(html.len() as f64 / 1e6 < most, "{}: {} bytes", shipped.name, html.len());
        assert!(page.document.deviation < 5e-3, "{}: {} m", shipped.name, page.document.deviation);
        assert_eq!(page.document.collisions.len() + page.document.violations.len(), 0, "{}", shipped.name);
        let document = document(&page);
        assert!(
            page.document.warnings.iter().all(|warning| !warning.contains("no such file")),
            "{:?}",
            page.document.warnings
        );
        boxes_lie_apart(&document["graph"], shipped.name);
    }
}

fn boxes_lie_apart(graph: &Value, name: &str) {
    let side = |state: &Value, key: &str| state[key].as_f64().unwrap();
    let states = graph["states"].as_array().unwrap_or_else(|| panic!("{name} has no graph"));
    assert!(!states.is_empty(), "{name}");
    let (width, height) = (side(graph, "width"), side(graph, "height"));
    for (number, a) in states.iter().enumerate() {
        let [x, y, w, h] = ["x", "y", "w", "h"].map(|key| side(a, key));
        assert!(x >= 0.0 && y >= 0.0 && x + w <= width && y + h <= height, "{name}: {a}");
        for b in &states[number + 1..] {
            let [u, v, s, t] = ["x", "y", "w", "h"].map(|key| side(b, key));
            assert!(x + w <= u || u + s <= x || y + h <= v || v + t <= y, "{name}: {a} {b}");
        }
    }
    for transition in graph["transitions"].as_array().unwrap() {
        let points = transition["points"].as_array().unwrap();
        assert!(points.len() >= 2, "{name}: {transition}");
    }
}

#[test]
fn the_graph_of_an_answer_says_how_often_transitions_were_tried_and_reached() {
    let packages = PackagePath::default();
    let scene = scene("demo", &packages);
    let solution = solved(&scene, true);
    let graph = page_of(&scene, &solution, &packages).document.graph.expect("a graph");
    let mut known = 0;
    for row in &solution.report.funnel {
        let shown = graph.transitions.iter().find(|transition| transition.name == row.transition).expect("shown");
        assert_eq!((shown.tried, shown.succeeded), (Some(row.statistics.attempts), Some(row.statistics.reached)));
        known += 1;
    }
    assert!(known > 0 && graph.transitions.iter().filter(|t| t.tried.is_some()).count() == known);
}
