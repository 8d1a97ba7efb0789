//! Promise: where a scene asks for it an object leaves its support along the normal, and comes back to it so, without turning, as far as it is
//! lifted before it is carried away. The check proves it, and refuses a path that does not.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/demo.rs"]
mod demo;

use demo::{Demo, SCENE, solve};
use foliate::check::{Kind, Violation};
use foliate::components::problem::{Lift, Problem};
use foliate::components::robot::LinkIndex;
use foliate::scene::{PackagePath, Scene};
use foliate::systems::settings::SearchSettings;
use foliate::{Planner, Solution};

/// How far objects are lifted, metres. The farther, the more hands swing.
const HEIGHT: f64 = 0.12;

fn high(scene: &str) -> String {
    scene.replacen("preplacement_distance = 0.05", &format!("preplacement_distance = {HEIGHT}"), 1)
}

fn straight(scene: &str) -> String {
    high(scene).replacen("placement_margin = 0.001", "placement_margin = 0.001\nlift = \"straight\"", 1)
}

/// The demo with fingers that open and close.
fn with_fingers(scene: &str) -> String {
    let (before, rest) = scene.split_once("[locked]").unwrap();
    format!("{before}[start]{}", rest.split_once("[start]").unwrap().1)
}

fn timed(problem: &Problem, seed: u64) -> Solution {
    let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (seed, 4000));
    let planner = Planner::new(problem.clone()).unwrap().settings(settings);
    planner.improve_work(100).solve().unwrap_or_else(|e| panic!("seed {seed}: {e}"))
}

/// How far objects are aside of where they lie, at most, while they are less high over it than they are lifted, metres; how far they are turned
/// against that, radians; and how often they are taken or put down.
fn aside(solution: &Solution) -> (f64, f64, usize) {
    let trajectory = solution.trajectory().expect("times");
    let robot = trajectory.robot();
    let segments = trajectory.segments();
    let object = |handle: &str| robot.handles[robot.handle(handle).unwrap().0 as usize].link;
    let holds = |at: usize, link: LinkIndex| segments[at].held.iter().any(|held| object(held.handle) == link);
    let mut links: Vec<LinkIndex> = segments.iter().flat_map(|s| &s.held).map(|held| object(held.handle)).collect();
    links.sort_unstable();
    links.dedup();
    let (mut shift, mut turn, mut ways) = (0.0_f64, 0.0_f64, 0);
    let mut poses = trajectory.poses();
    for link in links {
        for at in (1..segments.len()).filter(|&at| holds(at, link) != holds(at - 1, link)) {
            // Away from the support: forwards in time after a grasp, backwards before a release.
            let (from, step) = (segments[at].start, if holds(at, link) { 1e-3 } else { -1e-3 });
            poses.place(from);
            let lies = poses.link(link);
            ways += 1;
            for number in 0.. {
                let time = from + f64::from(number) * step;
                if time < trajectory.start() || time > trajectory.end() {
                    break;
                }
                poses.place(time);
                let off = poses.link(link).translation - lies.translation;
                if off.z > HEIGHT - 1e-4 {
                    break;
                }
                shift = shift.max(off.x.hypot(off.y));
                turn = turn.max(poses.link(link).rotation.angle_between(lies.rotation));
            }
        }
    }
    (shift, turn, ways)
}

#[test]
fn objects_leave_their_supports_on_a_line_and_come_back_so() {
    let demo = Demo::new("lift");
    let mut swing = 0.0_f64;
    for make in [|scene: &str| scene.to_owned(), with_fingers] {
        let (free, lined) = (demo.scene(&make(&high(SCENE))), demo.scene(&make(&straight(SCENE))));
        for seed in 1..=4 {
            let unbound = timed(&free.problem, seed);
            swing = swing.max(aside(&unbound).0);
            let solution = timed(&lined.problem, seed);
            let (shift, turn, ways) = aside(&solution);
            println!("seed {seed}: free {:?}, straight {:?}", aside(&unbound), (shift, turn, ways));
            assert!(ways >= 4, "two boxes are taken and put down: {ways}");
            // Twice the path tolerance: a lift is a leaf of its own.
            assert!(shift <= 4e-4 && turn <= 4e-4, "seed {seed}: {shift} {turn}");
            let report = demo.check(&demo.path(&lined, &solution));
            assert!(report.passed(), "seed {seed}: {:?}", report.violations);
            let first = demo.path(&lined, &solve(&lined.problem, seed).unwrap());
            let report = demo.check(&first);
            assert!(report.passed(), "seed {seed}, without times: {:?}", report.violations);
            // A path that knows nothing of it swings.
            let refused = demo.against(&demo.path(&free, &unbound), &lined.problem).violations;
            let told = |v: &&Violation| v.kind == Kind::Demand && v.subject.contains("the straight lift of box");
            assert!(refused.iter().any(|v| told(&v)), "{refused:?}");
        }
    }
    println!("free at most {swing}");
    assert!(swing > 0.01, "objects go straight anyway: {swing}");
}

/// On other objects, in drawers, with what lies on them, and from tables that are tilted.
#[test]
fn supports_may_move_and_be_tilted() {
    let folder = Demo::new("lift-others");
    let proved = |scene: &Scene, problem: &Problem| {
        for seed in 1..=3 {
            let solution = timed(problem, seed);
            let report = folder.against(&folder.path(scene, &solution), problem);
            assert!(report.passed(), "{} seed {seed}: {:?}", problem.name, report.violations);
            let states = solution.path.segments.iter().map(|s| solution.model.graph.state(s.state).name.as_str());
            let lifts = states.filter(|name| name.contains("is lifted straight")).count();
            assert!(lifts >= 2, "{} seed {seed}: {lifts}", problem.name);
        }
    };
    for name in ["stack", "drawer"] {
        let scene = Scene::load(name, &PackagePath::default()).unwrap();
        let mut problem = scene.problem.clone();
        problem.graph.lift = Lift::Straight;
        proved(&scene, &problem);
    }
    // The table and what lies on it turned by 0.1 about x, about the middle of its top.
    let (sine, cosine) = 0.1_f64.sin_cos();
    let tilted = |x: f64, y: f64, z: f64| {
        let (y, z) = (cosine * y - sine * (z - 0.7), sine * y + cosine * (z - 0.7) + 0.7);
        format!("{{ xyz = [{x}, {y}, {z}], rpy = [0.1, 0.0, 0.0] }}")
    };
    let mut text =
        straight(SCENE).replacen("pose = { xyz = [0.60, 0.0, 0.0] }", &format!("pose = {}", tilted(0.6, 0.0, 0.0)), 1);
    for y in [0.1, -0.1] {
        text = text.replace(&format!("{{ xyz = [0.50, {y:.2}, 0.741] }}"), &tilted(0.5, y, 0.741));
    }
    let scene = folder.scene(&text);
    proved(&scene, &scene.problem.clone());
}

#[test]
fn a_lift_that_ends_too_low_is_refused() {
    let demo = Demo::new("lift-low");
    let scene = demo.scene(&straight(SCENE));
    let file = demo.path(&scene, &solve(&scene.problem, 1).unwrap());
    assert!(demo.check(&file).passed());
    let lift = file.segments.iter().position(|s| s.state.contains("is lifted straight")).unwrap();
    let mut low = file.clone();
    let knots = file.segments[lift].knots.clone();
    assert!(knots.len() > 4, "a lift follows its line knot by knot: {}", knots.len());
    let middle = knots.len() / 2;
    low.segments[lift].knots = knots[..=middle].to_vec();
    let mut rest = file.segments[lift].clone();
    rest.knots = knots[middle..].to_vec();
    low.segments.insert(lift + 1, rest);
    let told: Vec<_> = demo.check(&low).violations.iter().map(|v| v.subject.clone()).collect();
    assert!(told.iter().any(|t| t.contains("the straight lift of box") && t.contains("ends too low")), "{told:?}");
}

#[test]
fn supports_that_face_several_ways_have_no_line_unless_the_object_has_one_face() {
    let demo = Demo::new("lift-none");
    let text = straight(SCENE);
    assert!(demo.try_scene(&text.replace("\"straight\"", "\"upwards\"")).unwrap_err().to_string().contains("lift"));
    // A second face of the table, on its side.
    let side = "[[part.surface]]\nname = \"side\"\nlink = \"table\"\npoints = [[-0.3, -0.6, 0.1], [-0.3, 0.6, 0.1], [-0.3, 0.6, 0.6], [-0.3, -0.6, 0.6]]\n\
                polygons = [[0, 1, 2, 3]]\n";
    let pose = "pose = { xyz = [0.60, 0.0, 0.0] }\n";
    let text = text.replacen(pose, &format!("{pose}\n{side}"), 1).replacen(
        "[\"table/top\"]",
        "[\"table/top\", \"table/side\"]",
        1,
    );
    let line = |text: &str| {
        let problem = demo.scene(text).problem;
        problem.graph.lift_line(&problem.robot, 0, None).is_some()
    };
    assert!(line(&text), "the box has one face, whose normal is the line");
    let face = "[[part.surface]]\nname = \"end\"\nlink = \"box\"\npoints = [[0.025, -0.025, -0.04], [0.025, 0.025, -0.04], [0.025, 0.025, 0.04], [0.025, -0.025, 0.04]]\n\
                polygons = [[0, 1, 2, 3]]\n\n[[part]]\nname = \"box2\"";
    assert!(!line(&text.replacen("[[part]]\nname = \"box2\"", face, 1)));
}
