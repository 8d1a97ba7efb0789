//! Promise: objects lie as the scene asks (`rests`): by their centre, stably, or with their whole face. The search finds such places, and
//! the check refuses a path that only says so. Objects that start or goal have a little off their support are moved onto it, and this is
//! said; polygons that are a little bent are made flat; how deep a start collides is said truly.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/written.rs"]
mod written;

use foliate::check::{CheckOptions, CheckReport, Kind, check, check_problem};
use foliate::components::constraint::Rests;
use foliate::components::pose::pose_from_array;
use foliate::components::problem::{GraphOptions, Problem};
use foliate::path_file::document::{CorrectionEntry, RestsEntry, RestsRule};
use foliate::path_file::{PathFile, save};
use foliate::scene::{PackagePath, Scene, SceneError};
use foliate::systems::settings::SearchSettings;
use foliate::{NoSolution, Planner, Solution};
use std::path::PathBuf;
use written::written;

/// A strip of the table, 60 mm wide: boxes of 50 mm fit if they lie along it.
const STRIP: &str = "-0.13 -0.2 0.7   -0.07 -0.2 0.7   -0.07 0.2 0.7   -0.13 0.2 0.7";
const SCENE: &str = include_str!("../scenes/demo/scene.toml");

/// A folder with the files of the demo, removed at the end.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

impl Folder {
    /// The demo with another surface on its table and boxes whose mass is `off_centre` metres along x.
    fn new(name: &str, surface: &str, off_centre: f64) -> Self {
        let folder = std::env::temp_dir().join(format!("foliate-resting-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let own = include_str!("../scenes/demo/table.srdf");
        let points = "-0.30 -0.60 0.70   0.30 -0.60 0.70   0.30 0.60 0.70   -0.30 0.60 0.70";
        let urdf = include_str!("../scenes/demo/box.urdf");
        let origin = format!("<inertial><origin xyz=\"{off_centre} 0 0\"/>");
        for (file, text) in [
            ("robot.urdf", include_str!("../scenes/demo/robot.urdf").to_owned()),
            ("robot.srdf", include_str!("../scenes/demo/robot.srdf").to_owned()),
            ("table.urdf", include_str!("../scenes/demo/table.urdf").to_owned()),
            ("table.srdf", own.replace(points, surface)),
            ("box.urdf", urdf.replace("<inertial>", &origin)),
            ("box.srdf", include_str!("../scenes/demo/box.srdf").to_owned()),
        ] {
            std::fs::write(folder.join(file), text).unwrap();
        }
        Self(folder)
    }

    fn try_to_read(&self, text: &str) -> Result<Scene, SceneError> {
        let file = self.0.join("scene.toml");
        std::fs::write(&file, text).unwrap();
        Scene::load(file.to_str().unwrap(), &PackagePath::only(&[]))
    }

    fn scene(&self, text: &str) -> Scene {
        self.try_to_read(text).unwrap_or_else(|e| panic!("{e}"))
    }

    /// The path as a file beside the scene.
    fn write(&self, scene: &Scene, solution: &Solution) -> PathFile {
        let out = self.0.join("path.json");
        let file = written(scene, &solution.model.graph, &solution.path, &out);
        save::save(&file, &out).unwrap();
        file
    }

    fn check(&self, file: &PathFile) -> CheckReport {
        check(file, &self.0, &PackagePath::only(&[]), &CheckOptions::default()).unwrap()
    }
}

/// The check of a path against another problem than its scene's.
fn against(folder: &Folder, file: &PathFile, problem: &Problem) -> CheckReport {
    check_problem(file, &folder.0, &PackagePath::only(&[]), &CheckOptions::default(), problem).unwrap()
}

/// The demo's scene with a line more in its graph.
fn with(line: &str) -> String {
    let text = SCENE.replace("[graph]\n", &format!("[graph]\n{line}\n"));
    assert!(line.is_empty() || text.contains(line));
    text
}

fn try_to_solve(scene: &Scene, seed: u64) -> Result<Solution, NoSolution> {
    let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (seed, 2000));
    Planner::new(scene.problem.clone()).unwrap().settings(settings).first_path().solve()
}

/// Where a point of a box is over the strip while it lies there, in every segment: largest distance from the strip's middle line
/// across, metres.
fn farthest_across(file: &PathFile, point: [f64; 3]) -> f64 {
    let mut farthest = 0.0_f64;
    for segment in &file.segments {
        for attachment in segment.attachments.iter().filter(|attachment| attachment.surface.is_some()) {
            let first = file.coordinates.iter().position(|name| *name == format!("{}/x", attachment.object)).unwrap();
            let pose = pose_from_array(segment.knots[0][first..first + 7].try_into().unwrap()).unwrap();
            let at = pose.transform_point(point.into());
            farthest = farthest.max((at.x - 0.5).abs());
        }
    }
    farthest
}

/// Of the four corners of a box's bottom the one that is farthest from the middle of the strip.
fn corners_across(file: &PathFile) -> f64 {
    let corners = [(0.025, 0.025), (0.025, -0.025), (-0.025, 0.025), (-0.025, -0.025)];
    corners.iter().map(|&(x, y)| farthest_across(file, [x, y, -0.04])).fold(0.0, f64::max)
}

#[test]
fn nothing_hangs_over_where_the_whole_face_is_to_rest() {
    let folder = Folder::new("whole", STRIP, 0.0);
    let mut overhangs = 0;
    for seed in 1..4 {
        let scene = folder.scene(&with("rests = \"whole-face\""));
        let file = folder.write(&scene, &try_to_solve(&scene, seed).unwrap());
        assert!(corners_across(&file) <= 0.03 + 1e-6, "{}", corners_across(&file));
        let report = folder.check(&file);
        assert!(report.passed(), "{:?}", report.violations);
        // By their centres boxes hang over, and a file that denies it is refused.
        let scene = folder.scene(&with("rests = \"centre\""));
        let mut file = folder.write(&scene, &try_to_solve(&scene, seed).unwrap());
        assert!(folder.check(&file).passed());
        if corners_across(&file) < 0.03 + 1e-3 {
            continue;
        }
        overhangs += 1;
        let whole = folder.scene(&with("rests = \"whole-face\""));
        let refused = against(&folder, &file, &whole.problem);
        assert!(refused.violations.iter().any(|v| v.kind == Kind::Scene && v.subject.contains("rest by")));
        file.rests = Some(RestsEntry { rule: RestsRule::WholeFace, margin: 0.0 });
        let refused = against(&folder, &file, &whole.problem);
        let violations = refused.violations;
        assert!(
            violations.iter().any(|v| v.kind == Kind::Placement && v.subject.contains("hangs over")),
            "{violations:?}"
        );
    }
    assert!(overhangs > 0, "no path shows that the rule makes a difference");
}

#[test]
fn a_margin_keeps_faces_off_the_edge() {
    let folder = Folder::new("margin", STRIP, 0.0);
    let scene = folder.scene(&with("rests = \"whole-face\"\nrests_margin = 0.003"));
    let mut file = folder.write(&scene, &try_to_solve(&scene, 1).unwrap());
    assert!(corners_across(&file) <= 0.027 + 1e-6, "{}", corners_across(&file));
    assert!(folder.check(&file).passed());
    // The file cannot ask for less than the scene.
    file.rests = Some(RestsEntry { rule: RestsRule::WholeFace, margin: 0.0 });
    assert!(folder.check(&file).violations.iter().any(|v| v.kind == Kind::Scene));
}

#[test]
fn objects_that_rest_stably_have_their_mass_over_both_polygons() {
    // The mass is 18 mm beside the middle: 7 mm from the edge of the box.
    let folder = Folder::new("stable", STRIP, 0.018);
    for seed in 1..4 {
        let scene = folder.scene(&with("rests = \"stable\""));
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        let file = folder.write(&scene, &try_to_solve(&scene, seed).unwrap());
        let across = farthest_across(&file, [0.018, 0.0, -0.04]);
        assert!(across <= 0.025 + 1e-6, "{across}");
        let report = folder.check(&file);
        assert!(report.passed(), "{:?}", report.violations);
    }
    // By its centre a box may start so that it tips over: its mass is 16 mm beside the strip.
    let tips = |line: &str| with(line).replace("box1 = { xyz = [0.50, 0.10", "box1 = { xyz = [0.528, 0.10");
    let scene = folder.scene(&tips("rests = \"centre\""));
    let mut file = folder.write(&scene, &try_to_solve(&scene, 1).unwrap());
    assert!(folder.check(&file).passed());
    let stable = folder.scene(&tips("rests = \"stable\""));
    let refused = try_to_solve(&stable, 1).unwrap_err().to_string();
    assert!(refused.contains("mm beside where it may lie"), "{refused}");
    file.rests = Some(RestsEntry { rule: RestsRule::Stable, margin: 0.005 });
    let report = against(&folder, &file, &stable.problem);
    let violations = report.violations;
    assert!(violations.iter().any(|v| v.subject.contains("centre of mass not over")), "{violations:?}");
}

#[test]
fn what_cannot_rest_as_it_must_is_refused() {
    // 22 mm: less than 5 mm from the edge of the box.
    let folder = Folder::new("never", STRIP, 0.022);
    let scene = folder.scene(&with("rests = \"stable\""));
    let refused = Planner::new(scene.problem).unwrap_err().to_string();
    assert!(refused.contains("3.00 mm inside of one, and 5.00 mm are asked"), "{refused}");
    let scene = folder.scene(&with("rests = \"stable\"\nrests_margin = 0.002"));
    assert!(Planner::new(scene.problem).is_ok());
    // A start that hangs over by 3 mm is moved, and one by 7 mm is refused.
    let over = |x: &str| {
        with("rests = \"whole-face\"").replace("box1 = { xyz = [0.50, 0.10", &format!("box1 = {{ xyz = [{x}, 0.10"))
    };
    assert!(try_to_solve(&folder.scene(&over("0.508")), 1).is_ok());
    let refused = try_to_solve(&folder.scene(&over("0.512")), 1).unwrap_err().to_string();
    assert!(
        refused.contains("the start is infeasible") && refused.contains("7.00 mm beside where it may lie"),
        "{refused}"
    );
    // Words and numbers of the scene.
    for (line, words) in [
        ("rests = \"flat\"", "none of centre, stable, whole-face"),
        ("rests = \"centre\"\nrests_margin = 0.001", "no meaning with rests = \"centre\""),
        ("rests = \"stable\"\nrests_margin = -0.001", "rests_margin"),
    ] {
        let refused = folder.try_to_read(&with(line)).unwrap_err().to_string();
        assert!(refused.contains(words), "{refused}");
    }
}

#[test]
fn a_scene_that_does_not_say_means_that_nothing_tips_over() {
    let folder = Folder::new("silent", STRIP, 0.018);
    let silent = folder.scene(SCENE);
    assert_eq!(silent.problem.graph.rests, Rests::Stable { margin: 0.005 });
    assert_eq!(GraphOptions::default().rests, silent.problem.graph.rests);
    let file = folder.write(&silent, &try_to_solve(&silent, 1).unwrap());
    assert_eq!(file.rests, Some(RestsEntry { rule: RestsRule::Stable, margin: 0.005 }));
    assert!(folder.check(&file).passed());
    // The middle of this box is over the strip, its mass is 16 mm beside it.
    let tips = SCENE.replace("box1 = { xyz = [0.50, 0.10", "box1 = { xyz = [0.528, 0.10");
    let refused = try_to_solve(&folder.scene(&tips), 1).unwrap_err().to_string();
    assert!(refused.contains("the start is infeasible") && refused.contains("without tipping over"), "{refused}");
    assert!(refused.contains("rests = \"centre\" asks for less"), "{refused}");
    // Without a `[graph]` as well.
    let none = SCENE[..SCENE.find("[graph]").unwrap()].to_owned() + &SCENE[SCENE.find("[locked]").unwrap()..];
    assert_eq!(folder.scene(&none).problem.graph.rests, Rests::default());
}

#[test]
fn pieces_of_faces_that_documents_cut_carry_as_one() {
    let folder = Folder::new("cut", STRIP, 0.0);
    for file in ["table.srdf", "box.srdf"] {
        let text = std::fs::read_to_string(folder.0.join(file)).unwrap();
        let cut = text.replace("<shape> 4  0 1 2 3 </shape>", "<shape> 3  0 1 2  3  0 2 3 </shape>");
        assert_ne!(cut, text);
        std::fs::write(folder.0.join(file), cut).unwrap();
    }
    let polygons = |scene: &Scene, name: &str| {
        scene.problem.robot.surfaces[scene.problem.robot.surface(name).unwrap().at()].polygons.len()
    };
    // The middle of the box's face is on the cut: 0 mm inside of both triangles.
    let scene = folder.scene(SCENE);
    assert_eq!((polygons(&scene, "table/top"), polygons(&scene, "box1/bottom")), (1, 1));
    let mut file = folder.write(&scene, &try_to_solve(&scene, 1).unwrap());
    let report = folder.check(&file);
    assert!(report.passed(), "{:?}", report.violations);
    // A whole that is larger than its pieces is none.
    let top = file.documents.surfaces.get_mut("table/top").unwrap();
    top.points.iter_mut().filter(|point| point[0] > -0.1).for_each(|point| point[0] += 1e-3);
    let violations = folder.check(&file).violations;
    assert!(violations.iter().any(|v| v.kind == Kind::Document && v.subject.contains("table/top")), "{violations:?}");
    // By the rule of centres documents are taken as they are.
    let scene = folder.scene(&with("rests = \"centre\""));
    assert_eq!((polygons(&scene, "table/top"), polygons(&scene, "box1/bottom")), (2, 2));
    let file = folder.write(&scene, &try_to_solve(&scene, 1).unwrap());
    assert!(folder.check(&file).passed());
}

#[test]
fn of_what_has_no_mass_the_volume_counts_and_this_is_said() {
    let folder = Folder::new("massless", STRIP, 0.0);
    let urdf = include_str!("../scenes/demo/box.urdf").replace("value=\"0.2\"", "value=\"0\"");
    std::fs::write(folder.0.join("box.urdf"), urdf).unwrap();
    let scene = folder.scene(&with("rests = \"stable\""));
    let said: Vec<String> = scene.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(said.iter().filter(|w| w.contains("the centre of the volume of its shapes")).count(), 2, "{said:?}");
    let file = folder.write(&scene, &try_to_solve(&scene, 1).unwrap());
    assert!(folder.check(&file).passed());
}

#[test]
fn objects_a_little_off_their_support_are_moved_onto_it() {
    let folder = Folder::new("snapped", STRIP, 0.0);
    let start = "box1 = { xyz = [0.50, 0.10, 0.741] }\nbox2";
    let lifted = "box1 = { xyz = [0.50, 0.10, 0.7416], rpy = [0.004, 0.0, 0.0] }\nbox2";
    let text = SCENE
        .replace(start, lifted)
        .replace("box2 = { xyz = [0.50, 0.10, 0.741]", "box2 = { xyz = [0.50, 0.10, 0.7401]");
    let scene = folder.scene(&text);
    let solution = try_to_solve(&scene, 1).unwrap();
    let said: Vec<String> = solution.report.snapped.iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 2, "{said:?}");
    let words = "0.60 mm and 0.23 degrees from where it lies on table/top";
    assert!(said[0].starts_with("the start has `box1`") && said[0].contains(words), "{said:?}");
    assert!(said[1].starts_with("goal 0 has `box2` 0.90 mm and 0.00 degrees"), "{said:?}");
    let file = folder.write(&scene, &solution);
    let report = folder.check(&file);
    assert!(report.passed(), "{:?}", report.violations);
    assert!(report.notes.iter().any(|note| note.contains("moved onto its state: box1 by 0.6")), "{:?}", report.notes);
    // What is farther off is refused with the gap.
    let far = SCENE.replace(start, "box1 = { xyz = [0.50, 0.10, 0.7632] }\nbox2");
    let refused = try_to_solve(&folder.scene(&far), 1).unwrap_err().to_string();
    assert!(refused.contains("22.20 mm above where it lies on its support"), "{refused}");
}

#[test]
fn the_check_lets_objects_be_moved_as_far_as_file_and_scene_say() {
    let folder = Folder::new("moved", STRIP, 0.0);
    let scene = folder.scene(SCENE);
    let mut file = folder.write(&scene, &try_to_solve(&scene, 1).unwrap());
    let mut moved = |by: [f64; 3], turn: f64, said: Option<(f64, f64)>| {
        let mut problem = scene.problem.clone();
        let first = file.coordinates.iter().position(|name| name == "box1/x").unwrap();
        (0..3).for_each(|i| problem.start[first + i] += by[i]);
        problem.start[first + 5] = (turn / 2.0).sin();
        problem.start[first + 6] = (turn / 2.0).cos();
        let entry = |(distance, angle)| CorrectionEntry {
            goal: None,
            object: Some("box1".into()),
            joint: None,
            distance,
            angle,
        };
        file.corrections = said.into_iter().map(entry).collect();
        let report = against(&folder, &file, &problem);
        report.violations.iter().all(|violation| violation.kind != Kind::Start)
    };
    assert!(moved([0.0, 0.0, 4.9e-3], 0.0, Some((4.9e-3, 0.0))) && moved([3e-3, 0.0, 0.0], 0.03, Some((3e-3, 0.03))));
    assert!(!moved([0.0, 0.0, 1e-4], 0.0, None), "the file does not say so");
    assert!(!moved([0.0, 0.0, 3e-3], 0.0, Some((2e-3, 0.0))), "by more than is said");
    assert!(!moved([0.0, 0.0, 5.1e-3], 0.0, Some((5.1e-3, 0.0))), "by more than the scene allows");
    assert!(!moved([0.0, 0.0, 0.0], 0.04, Some((0.0, 0.04))), "turned by more than the scene allows");
}

#[test]
fn polygons_that_are_a_little_bent_are_made_flat() {
    let bent =
        |millimetres: f64| STRIP.replacen("0.2 0.7   -0.13", &format!("0.2 {}   -0.13", 0.7 + millimetres * 1e-3), 1);
    let folder = Folder::new("bent", &bent(4.0), 0.0);
    // The plane of the first two sides, through the mean: 1 mm higher at the middle than the table.
    let scene = folder.scene(SCENE);
    let said: Vec<String> = scene.warnings.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|w| w.contains("bent by up to") && w.contains("moved onto a plane")), "{said:?}");
    let surface = scene.problem.robot.surfaces.iter().find(|s| s.name == "table/top").unwrap();
    let corners: Vec<_> = surface.polygons[0].iter().map(|&i| surface.points[i as usize]).collect();
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[1]).normalize();
    assert!(corners.iter().all(|c| (*c - corners[0]).dot(normal).abs() < 1e-12), "{corners:?}");
    // What is bent by less is planned on: the plane is 0.1 mm higher, and objects are moved onto it.
    let folder = Folder::new("bent-less", &bent(0.44), 0.0);
    let scene = folder.scene(SCENE);
    assert!(scene.warnings.iter().any(|w| w.to_string().contains("bent by up to 0.33 mm")), "{:?}", scene.warnings);
    let solution = try_to_solve(&scene, 1).unwrap();
    assert_eq!(solution.report.snapped.len(), 4, "{:?}", solution.report.snapped);
    let report = folder.check(&folder.write(&scene, &solution));
    assert!(report.passed(), "{:?}", report.violations);
    // Bent by more than is a slip.
    let folder = Folder::new("bent-more", &bent(40.0), 0.0);
    let refused = folder.try_to_read(SCENE).unwrap_err().to_string();
    assert!(refused.contains("is not planar: a corner is ") && refused.contains(" mm off the plane"), "{refused}");
}

#[test]
fn how_deep_a_start_collides_is_said_truly() {
    let folder = Folder::new("deep", STRIP, 0.0);
    for millimetres in [2.0, 28.0] {
        let y = 0.10 - 0.05 + millimetres * 1e-3;
        let text =
            SCENE.replace("box2 = { xyz = [0.50, -0.10, 0.741] }", &format!("box2 = {{ xyz = [0.50, {y}, 0.741] }}"));
        let refused = try_to_solve(&folder.scene(&text), 1).unwrap_err().to_string();
        let wanted = format!("box1/box_0 and box2/box_0 collide ({millimetres:.2} mm deep)");
        assert!(refused.contains(&wanted), "{refused}");
    }
}
