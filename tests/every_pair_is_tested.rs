//! Promise: a certificate counts the pairs that it tested, and every other pair with the reason. By default nothing is free but what
//! one joint joins and touches at every value of it. What locked joints hold together is tested once. Pairs that do not move count
//! too. A certificate over nothing has no clearance.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/written.rs"]
mod written;

use foliate::check::{CheckOptions, CheckReport, check};
use foliate::components::infeasibility::Infeasibility;
use foliate::path_file::{PathFile, save};
use foliate::scene::{PackagePath, Scene};
use foliate::systems::settings::SearchSettings;
use foliate::{NoSolution, NoSolutionReason, Planner, Solution};
use std::path::{Path, PathBuf};
use std::process::Command;
use written::written;

/// A folder with the files of a scene, removed at the end.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let folder = std::env::temp_dir().join(format!("foliate-pairs-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for (file, text) in files {
            std::fs::write(folder.join(file), text).unwrap();
        }
        Self(folder)
    }

    fn scene(&self, text: &str) -> Scene {
        let file = self.0.join("scene.toml");
        std::fs::write(&file, format!("format = \"foliate.scene/1\"\nname = \"test\"\n{text}")).unwrap();
        Scene::load(file.to_str().unwrap(), &PackagePath::only(&[])).unwrap_or_else(|e| panic!("{e}"))
    }

    fn refused(&self, text: &str) -> String {
        let file = self.0.join("scene.toml");
        std::fs::write(&file, format!("format = \"foliate.scene/1\"\nname = \"test\"\n{text}")).unwrap();
        Scene::load(file.to_str().unwrap(), &PackagePath::only(&[])).expect_err("a refusal").to_string()
    }

    /// Writes the path as the program does.
    fn write(&self, scene: &Scene, solution: &Solution) -> PathFile {
        let out = self.0.join("path.json");
        let file = written(scene, &solution.model.graph, &solution.path, &out);
        save::save(&file, &out).unwrap();
        file
    }

    /// Proves a path with its own smallest clearance, against the scene beside it.
    fn check(&self, file: &PathFile) -> CheckReport {
        let options = CheckOptions { clearance: true, ..CheckOptions::default() };
        check(file, &self.0, &PackagePath::only(&[]), &options).unwrap()
    }
}

fn solve(scene: &Scene, seed: u64) -> Solution {
    try_to_solve(scene, seed).unwrap()
}

fn refused(scene: &Scene) -> NoSolutionReason {
    try_to_solve(scene, 1).expect_err("no path").reason
}

fn try_to_solve(scene: &Scene, seed: u64) -> Result<Solution, NoSolution> {
    let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (seed, 300));
    let mut solution = Planner::new(scene.problem.clone()).unwrap().settings(settings).solve()?;
    // What the search itself proves is less, and true.
    let proved = solution.certificate().min_clearance;
    let found = solution.measure_clearance().map(|clearance| clearance.lower);
    assert!(found >= proved && proved.is_none_or(|proved| proved > 0.0), "{proved:?} proved, {found:?} found");
    Ok(solution)
}

fn start_refused(scene: &Scene) -> String {
    match refused(scene) {
        NoSolutionReason::InfeasibleStart(why) => why.to_string(),
        other => panic!("the start is {other:?}"),
    }
}

fn cuboid(name: &str, pose: &str, size: &str) -> String {
    format!(
        "<link name=\"{name}\"><collision><origin xyz=\"{pose}\"/><geometry><box size=\"{size}\"/></geometry></collision></link>"
    )
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, place: &str, limits: (f64, f64), more: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><origin xyz=\"{place}\"/><parent link=\"{parent}\"/><child link=\"{child}\"/>\
         <axis xyz=\"1 0 0\"/><limit lower=\"{}\" upper=\"{}\" effort=\"1\" velocity=\"1\"/>{more}</joint>\n",
        limits.0, limits.1
    )
}

fn robot(parts: &[String]) -> String {
    format!("<robot name=\"r\">\n{}\n</robot>", parts.join("\n"))
}

/// A floor, a wall that is fixed to it, and a carriage on a rail 10 cm over the floor.
fn cell() -> String {
    robot(&[
        cuboid("floor", "0 0 0", "3 1 0.1"),
        joint("mount", "fixed", "floor", "wall", "0.5 0 0.4", (0.0, 0.0), ""),
        cuboid("wall", "0 0 0", "0.1 1 0.7"),
        joint("rail", "prismatic", "floor", "carriage", "0 0 0.3", (-1.2, 1.2), ""),
        cuboid("carriage", "0 0 0", "0.3 0.3 0.2"),
    ])
}

fn cell_scene(goal: f64) -> String {
    format!(
        "[[part]]\nname = \"cell\"\nkind = \"robot\"\nurdf = \"cell.urdf\"\n[start]\n\"cell/rail\" = -0.5\n[[goal]]\n\
         configuration = {{ \"cell/rail\" = {goal} }}\n"
    )
}

/// Three carriages that overlap: one message names all pairs, and what to write where they may touch.
#[test]
fn links_that_overlap_at_the_start_are_told_all_at_once() {
    let carriage = |name: &str, x: f64| {
        let slide = joint(&format!("j{name}"), "prismatic", "base", name, &format!("{x} 0 0"), (-0.1, 0.1), "");
        slide + &cuboid(name, "0 0 0", "0.1 0.1 0.1")
    };
    let base = cuboid("base", "0 0 0", "0.1 0.1 0.1");
    let text = robot(&[base, carriage("a", 1.0), carriage("b", 1.05), carriage("c", 1.08)]);
    let folder = Folder::new("at-once", &[("r.urdf", &text)]);
    let part = "[[part]]\nname = \"r\"\nkind = \"robot\"\nurdf = \"r.urdf\"\n[start]\n[[goal]]\nconfiguration = { \"r/ja\" = 0.01 }\n";
    let told = start_refused(&folder.scene(part));
    for words in
        ["r/a_0 and r/b_0 collide (50.00 mm deep)", "r/a_0 and r/c_0 collide (20.00", "r/b_0 and r/c_0 collide (70.00"]
    {
        assert!(told.contains(words), "`{words}` is not in {told}");
    }
    let written = &told[told.find("ignore = ").expect("what to write")..];
    let _solved = solve(&folder.scene(&format!("{written}\n{part}")), 1);
}

#[test]
fn what_is_fixed_to_a_neighbour_is_in_the_way() {
    let folder = Folder::new("wall", &[("cell.urdf", &cell())]);
    let beyond = refused(&folder.scene(&cell_scene(1.1)));
    assert!(matches!(beyond, NoSolutionReason::StepLimit), "{beyond:?}");
    let scene = folder.scene(&cell_scene(0.2));
    let before = solve(&scene, 1);
    let certificate = before.path.certificate;
    // The wall begins at 0.45, the carriage ends at 0.35.
    assert!(certificate.min_clearance.is_some_and(|c| c > 0.089 && c <= 0.1), "{certificate:?}");
    let pairs = certificate.pairs;
    assert_eq!((pairs.tested, pairs.adjacent, pairs.same_body), (2, 0, 1));
    let clearance = before.clearance().unwrap();
    assert_eq!(Some(clearance.lower), certificate.min_clearance);
    assert!(clearance.nearest.is_some_and(|n| n.clearance >= clearance.lower && n.clearance <= 0.111));
    let file = folder.write(&scene, &before);
    assert_eq!(file.certificate.pairs.as_ref().map(|p| (p.tested, p.same_body)), Some((2, 1)));
    assert!(folder.check(&file).passed());
}

/// A slider with a block on it, and two fingers that overlap by 20 mm where they stand at zero.
fn hand() -> String {
    robot(&[
        "<link name=\"base\"/>".into(),
        joint("slide", "prismatic", "base", "block", "0 0 0", (-1.0, 1.0), ""),
        cuboid("block", "0 1 0", "0.1 0.1 0.1"),
        joint("a", "prismatic", "base", "fa", "0 0 0", (-1.0, 1.0), ""),
        cuboid("fa", "0 0 0", "0.1 0.1 0.1"),
        joint("b", "prismatic", "base", "fb", "0.08 0 0", (-1.0, 1.0), "<mimic joint=\"a\" multiplier=\"1\"/>"),
        cuboid("fb", "0 0 0", "0.1 0.1 0.1"),
    ])
}

const SLIDES: &str = "[[goal]]\nconfiguration = { \"r/slide\" = 0.5 }\n";

#[test]
fn what_locked_joints_hold_together_is_tested_once_at_the_start() {
    let object = robot(&[cuboid("o", "0 0 0", "0.1 0.1 0.1")]);
    let folder = Folder::new("rigid", &[("r.urdf", &hand()), ("o.urdf", &object)]);
    let part = "[[part]]\nname = \"r\"\nkind = \"robot\"\nurdf = \"r.urdf\"\n";
    // Two fingers of which one follows the other; and both locked as joints of their own.
    let why = start_refused(&folder.scene(&format!("{part}[locked]\n\"r/a\" = 0.0\n[start]\n{SLIDES}")));
    assert!(why.contains("r/fa_0 and r/fb_0 collide (20.00 mm deep)"), "{why}");
    assert!(why.contains("ignore = [[\"r/fa\", \"r/fb\"]]"), "{why}");
    let free = format!("{part}mimic = \"free\"\n[locked]\n\"r/a\" = 0.0\n\"r/b\" = 0.0\n[start]\n{SLIDES}");
    assert!(start_refused(&folder.scene(&free)).contains("r/fa_0 and r/fb_0"));
    // Where they keep apart the pair is counted, and its clearance counts.
    let apart = free.replace("\"r/b\" = 0.0", "\"r/b\" = 0.027");
    let scene = folder.scene(&apart);
    let solution = solve(&scene, 1);
    let certificate = solution.path.certificate;
    assert_eq!((certificate.pairs.rigid, certificate.pairs.tested), (1, 2));
    assert!(certificate.min_clearance.is_some_and(|c| c <= 0.007 && c > 0.0062), "{certificate:?}");
    assert!(folder.check(&folder.write(&scene, &solution)).passed());
    // What the scene ignores is not tested.
    let ignored = format!("ignore = [[\"r/fa\", \"r/fb\"]]\n{part}[locked]\n\"r/a\" = 0.0\n[start]\n{SLIDES}");
    let pairs = solve(&folder.scene(&ignored), 1).path.certificate.pairs;
    assert_eq!((pairs.ignored, pairs.rigid), (1, 0));
}

#[test]
fn a_parked_arm_stands_in_no_table_and_no_other_arm() {
    let object = robot(&[cuboid("o", "0 0 0", "0.1 0.1 0.1")]);
    let apart = hand().replace("0.08 0 0", "0.3 0 0");
    let folder = Folder::new("parked", &[("r.urdf", &apart), ("o.urdf", &object)]);
    let part = |name: &str, y: f64| {
        format!(
            "[[part]]\nname = \"{name}\"\nkind = \"robot\"\nurdf = \"r.urdf\"\npose = {{ xyz = [0.0, {y}, 0.0] }}\n"
        )
    };
    let locked = "[locked]\n\"r/a\" = 0.0\n";
    let with = |more: &str, locked: &str| format!("{}{more}{locked}[start]\n{SLIDES}", part("r", 0.0));
    // A table at the locked finger; a finger at its margin.
    let table = |x: f64| {
        let place = format!("pose = {{ xyz = [{x}, 0.0, 0.0] }}");
        format!("[[part]]\nname = \"table\"\nkind = \"environment\"\nurdf = \"o.urdf\"\n{place}\n")
    };
    let why = start_refused(&folder.scene(&with(&table(-0.09), locked)));
    assert!(why.contains("r/fa_0 and table/o_0 collide (10.00 mm deep)"), "{why}");
    let margin = format!("default_margin = 0.02\n{}", with(&table(-0.11), locked));
    let why = start_refused(&folder.scene(&margin));
    assert!(why.contains("10.00 mm apart instead of 20.00 mm"), "{why}");
    let _solved = solve(&folder.scene(&with(&table(-0.11), locked)), 1);
    // Another robot of which every joint is locked; all pairs are named at once.
    let other = "[locked]\n\"r/a\" = 0.0\n\"s/a\" = 0.0\n\"s/slide\" = 0.0\n";
    let why = start_refused(&folder.scene(&with(&part("s", 0.05), other)));
    for pair in ["r/fa_0 and s/fa_0 collide", "r/fb_0 and s/fb_0 collide", "r/block_0 and s/block_0 collide"] {
        assert!(why.contains(pair), "{why}");
    }
    // A robot that could drive and may not: its planar root stands still.
    let root = "[[part]]\nname = \"s\"\nkind = \"robot\"\nurdf = \"r.urdf\"\nroot = \"planar\"\n\
                root_bounds = [[0.0, 0.0], [0.05, 0.05], [0.0, 0.0]]\n";
    let start = "[start]\ns = [0.0, 0.05, 0.0]\n";
    let still = format!("{}{root}{other}{start}{SLIDES}", part("r", 0.0));
    let why = start_refused(&folder.scene(&still));
    assert!(why.contains("r/fa_0 and s/fa_0 collide"), "{why}");
}

/// A ball that moves in two directions before a wall.
fn gantry() -> String {
    robot(&[
        "<link name=\"base\"/><link name=\"lx\"/>".into(),
        joint("jx", "prismatic", "base", "lx", "0 0 0", (-1.0, 1.0), ""),
        joint("jy", "prismatic", "lx", "ball", "0 0 0", (-1.0, 1.0), "").replace("1 0 0\"/><limit", "0 1 0\"/><limit"),
        "<link name=\"ball\"><collision><geometry><sphere radius=\"0.02\"/></geometry></collision></link>".into(),
    ])
}

#[test]
fn claims_hold_beyond_the_margins_and_for_what_does_not_move() {
    let wall = robot(&[cuboid("wall", "0 -0.5 0", "0.1 1.2 1")]);
    let (object, plate) = (robot(&[cuboid("o", "0 0 0", "0.1 0.1 0.1")]), robot(&[cuboid("p", "0 0 0", "0.02 1 1")]));
    let files = [("g.urdf", gantry()), ("w.urdf", wall), ("o.urdf", object), ("p.urdf", plate)];
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let folder = Folder::new("claims", &files);
    // A box that no gripper can move stands 0.3 mm from a plate, far from everything else.
    let beside = "[[part]]\nname = \"o\"\nkind = \"object\"\nurdf = \"o.urdf\"\n\
                  root_bounds = [[4.0, 6.0], [-1.0, 1.0], [-1.0, 1.0]]\n\
                  [[part]]\nname = \"p\"\nkind = \"environment\"\nurdf = \"p.urdf\"\npose = { xyz = [5.0603, 0.0, 0.0] }\n";
    let parts = "[[part]]\nname = \"g\"\nkind = \"robot\"\nurdf = \"g.urdf\"\n\
                 [[part]]\nname = \"w\"\nkind = \"environment\"\nurdf = \"w.urdf\"\n";
    let ends = "[start]\n\"g/jx\" = -0.5\n";
    let goal = "[[goal]]\nconfiguration = { \"g/jx\" = 0.5 }\n";
    let still = format!("{parts}{beside}{ends}o = {{ xyz = [5.0, 0.0, 0.0] }}\n{goal}");
    for (text, least) in [(format!("default_margin = 0.05\n{parts}{ends}{goal}"), None), (still, Some(3e-4))] {
        let scene = folder.scene(&text);
        for seed in 1..=20 {
            let solution = solve(&scene, seed);
            let claim = solution.path.certificate.min_clearance.unwrap();
            let report = folder.check(&folder.write(&scene, &solution));
            assert!(report.passed(), "seed {seed}: {report:?}");
            let measured = report.min_clearance.unwrap().value;
            assert!(claim <= measured + 1e-9, "seed {seed}: {claim} claimed, {measured} measured");
            assert!(claim >= (0.9 * measured).min(measured - 1e-4) - 1e-9, "seed {seed}: {claim}, {measured}");
            // The path may come closer to the wall than the pair that stands still.
            assert!(least.is_none_or(|least| measured < least + 1e-6), "{measured}");
        }
    }
}

fn foliate(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_foliate")).args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_certificate_over_nothing_is_no_number_and_is_said_loudly() {
    let bare = gantry().replace("<collision><geometry><sphere radius=\"0.02\"/></geometry></collision>", "");
    let wall = robot(&[cuboid("wall", "0 0 0", "0.1 1 1")]);
    let folder = Folder::new("bare", &[("g.urdf", &bare), ("w.urdf", &wall)]);
    let text = "[[part]]\nname = \"g\"\nkind = \"robot\"\nurdf = \"g.urdf\"\n\
                [[part]]\nname = \"w\"\nkind = \"environment\"\nurdf = \"w.urdf\"\n\
                [start]\n\"g/jx\" = -0.5\n[[goal]]\nconfiguration = { \"g/jx\" = 0.5 }\n";
    let scene = folder.scene(text);
    let solution = solve(&scene, 1);
    let certificate = solution.path.certificate;
    assert_eq!((certificate.min_clearance, certificate.pairs.looked_at()), (None, 0));
    assert!(solution.clearance().is_none());
    assert_eq!(folder.write(&scene, &solution).certificate.min_clearance, None);
    let (code, out, err) = foliate(&folder.0, &["solve", "scene.toml", "--clearance"]);
    assert_eq!(code, Some(0), "{err}");
    assert!(out.contains("no pair of shapes was tested"), "{out}");
    assert!(err.matches("has no collision shapes").count() == 1, "{err}");
    let (_, out, _) = foliate(&folder.0, &["inspect", "g.urdf"]);
    assert!(out.matches("has no collision shapes").count() == 1, "{out}");
}

#[test]
fn what_is_left_out_is_told_by_name() {
    let folder = Folder::new("names", &[("cell.urdf", &cell())]);
    folder.scene(&format!("ignore = [[\"cell/wall\", \"cell/carriage\"]]\n{}", cell_scene(1.1)));
    let (code, out, err) = foliate(&folder.0, &["solve", "scene.toml", "--pairs", "--clearance"]);
    assert_eq!(code, Some(0), "{err}");
    assert!(err.contains("1 pairs of shapes are left out although they do not touch at the start"), "{err}");
    for line in [
        "pairs of shapes: 1 tested; not tested: 1 ignored by the scene, 1 one rigid body",
        "cell/wall_0 and cell/carriage_0: ignored by the scene, and does not touch there",
        "cell/floor_0 and cell/wall_0: one rigid body",
        "closest: cell/floor_0 and cell/carriage_0, 150.00 mm beyond their margin",
    ] {
        assert!(out.contains(line), "`{line}` is not in:\n{out}");
    }
    let (_, out, _) = foliate(&folder.0, &["solve", "scene.toml", "--pairs", "--clearance", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["certificate"]["pairs"]["ignored"], 1);
    assert_eq!(json["pairs_left_out"].as_array().unwrap().len(), 2);
    assert_eq!(json["clearance"]["first"], "cell/floor_0");
    let (_, out, _) = foliate(&folder.0, &["inspect", "cell.urdf", "--pairs"]);
    for line in ["Pairs of shapes: 2 tested; not tested: 1 one rigid body", "floor_0 and wall_0: one rigid body"] {
        assert!(out.contains(line), "`{line}` is not in:\n{out}");
    }
}

/// A leader that moves in [0, 0.04], and who follows it.
fn leader(followers: &[(f64, f64, f64)]) -> String {
    let mut parts = vec![
        "<link name=\"base\"/>".into(),
        joint("lead", "prismatic", "base", "l", "0 0 0", (0.0, 0.04), ""),
        cuboid("l", "0 0 0", "0.1 0.1 0.1"),
    ];
    for (number, (multiplier, low, high)) in followers.iter().enumerate() {
        let (name, mimic) =
            (format!("f{number}"), format!("<mimic joint=\"lead\" multiplier=\"{multiplier}\" offset=\"0\"/>"));
        parts.push(joint(&format!("j{number}"), "prismatic", "base", &name, "0 1 0", (*low, *high), &mimic));
        parts.push(format!("<link name=\"{name}\"/>"));
    }
    robot(&parts)
}

#[test]
fn a_leader_keeps_to_where_its_followers_keep_their_limits() {
    let text = |to: f64| {
        format!(
            "[[part]]\nname = \"r\"\nkind = \"robot\"\nurdf = \"r.urdf\"\n[start]\n[[goal]]\n\
             configuration = {{ \"r/lead\" = {to} }}\n"
        )
    };
    let half = Folder::new("half", &[("r.urdf", &leader(&[(2.0, 0.0, 0.05)]))]);
    let scene = half.scene(&text(0.03));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let reason = refused(&scene);
    let NoSolutionReason::InfeasibleGoal(Infeasibility::OutOfBounds { bounds, narrowed: Some(narrowed), .. }) = &reason
    else {
        panic!("{reason:?}");
    };
    assert_eq!((*bounds, narrowed.followers.as_slice()), ((0.0, 0.025), ["r/j0".to_owned()].as_slice()));
    assert!(reason.to_string().contains("outside [0, 0.025]"), "{reason}");
    let scene = half.scene(&text(0.025));
    let solution = solve(&scene, 1);
    let file = half.write(&scene, &solution);
    assert_eq!(file.limits["r/lead"], [0.0, 0.025]);
    assert!(half.check(&file).passed());
    // One value: a warning with the line of the leader, and both ranges.
    let one = Folder::new("one", &[("r.urdf", &leader(&[(-1.0, 0.0, 0.04)]))]);
    let warning = one.scene(&text(0.0)).warnings[0].to_string();
    for words in ["r.urdf:3: <joint name=\"lead\">", "[0, 0.04]", "only at 0", "`j0`"] {
        assert!(warning.contains(words), "`{words}` is not in {warning}");
    }
    assert!(one.refused(&text(0.02)).contains("keep theirs nowhere else"));
    let (_, out, _) = foliate(&one.0, &["inspect", "r.urdf"]);
    assert!(out.contains("r.urdf:3: <joint name=\"lead\">"), "{out}");
    // None: an error with the line of the follower.
    let none = Folder::new("none", &[("r.urdf", &leader(&[(1.0, 0.0, 0.04), (1.0, 0.05, 0.06)]))]);
    let error = none.refused(&text(0.0));
    for words in ["r.urdf:9: <joint name=\"j1\">", "[0, 0.04]", "[0.05, 0.06]"] {
        assert!(error.contains(words), "`{words}` is not in {error}");
    }
    let (code, _, err) = foliate(&none.0, &["inspect", "r.urdf"]);
    assert!(code == Some(2) && err.contains("r.urdf:9"), "{err}");
    // Who does not follow has limits of its own.
    let free = none.scene(
        &text(0.03)
            .replace("[start]", "mimic = \"free\"\n[start]\n\"r/j1\" = 0.055")
            .replace("0.03 }", "0.03, \"r/j1\" = 0.055 }"),
    );
    let _solved = solve(&free, 1);
}
