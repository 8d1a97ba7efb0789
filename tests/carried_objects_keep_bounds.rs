//! Promise: what a scene demands of an object while a hand holds it holds along the whole path: it tilts no farther than it may, and
//! stays within its bounds. The check proves it by its own code, and refuses a path that says less than the scene.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/demo.rs"]
mod demo;

use demo::{Demo, SCENE, solve};
use foliate::check::Kind;
use foliate::path_file::{ConstraintEntry, PathFile};
use foliate::scene::Scene;
use foliate::systems::settings::SearchSettings;
use foliate::{Planner, Solution};
use glam::DVec3;

/// The largest tilt of a box that is carried, radians, and its largest height, metres.
const TILT: f64 = 0.2;
const HEIGHT: f64 = 0.9;

/// The demo, whose first box keeps a tilt and a height while it is held.
fn bounded() -> String {
    let held = "placement_margin = 0.001\nwhile_held = { box1 = [\"upright\", \"low\"] }";
    let text = SCENE.replacen("placement_margin = 0.001", held, 1);
    let constraints = format!(
        "[[constraint]]\nname = \"upright\"\nkind = \"tilt\"\nframe = \"box1/box\"\nwithin = {TILT}\n\
         [[constraint]]\nname = \"low\"\nkind = \"region\"\nframe = \"box1/box\"\nz = [0.0, {HEIGHT}]\n[start]"
    );
    text.replacen("[start]", &constraints, 1)
}

/// A path with times, a little improved.
fn timed(scene: &Scene, seed: u64) -> Solution {
    let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (seed, 2000));
    let planner = Planner::new(scene.problem.clone()).unwrap().settings(settings);
    planner.improve_work(100).solve().unwrap_or_else(|e| panic!("seed {seed}: {e}"))
}

/// The largest tilt and height of the first box while it is held, all along.
fn extremes(solution: &Solution) -> (f64, f64) {
    let trajectory = solution.trajectory().expect("times");
    let link = trajectory.link("box1").unwrap();
    let mut poses = trajectory.poses();
    let (mut tilt, mut height) = (0.0_f64, 0.0_f64);
    for segment in trajectory.segments() {
        if !segment.held.iter().any(|held| held.object == "box1") {
            continue;
        }
        for part in 0..=200 {
            // The later of two segments answers where they meet.
            let share = f64::from(part) / 200.0 * (1.0 - 1e-9);
            poses.place(segment.start + share * (segment.end - segment.start));
            let pose = poses.link(link);
            tilt = tilt.max((pose.rotation * DVec3::Z).z.clamp(-1.0, 1.0).acos());
            height = height.max(pose.translation.z);
        }
    }
    (tilt, height)
}

fn refusals(demo: &Demo, file: &PathFile) -> Vec<String> {
    demo.check(file).violations.iter().filter(|v| v.kind == Kind::Demand).map(|v| v.subject.clone()).collect()
}

#[test]
fn a_box_stays_upright_and_low_while_it_is_held() {
    let demo = Demo::new("carried");
    let (free, scene) = (demo.scene(SCENE), demo.scene(&bounded()));
    let (mut freely, mut widest) = ((0.0_f64, 0.0_f64), 0.0_f64);
    for seed in 1..=4 {
        let (tilt, height) = extremes(&timed(&free, seed));
        freely = (freely.0.max(tilt), freely.1.max(height));
        let solution = timed(&scene, seed);
        let (tilt, height) = extremes(&solution);
        // The path tolerance is 2e-4.
        assert!(tilt <= TILT + 2e-4 && height <= HEIGHT + 2e-4, "seed {seed}: {tilt} {height}");
        widest = widest.max(tilt);
        let report = demo.check(&demo.path(&scene, &solution));
        assert!(report.passed(), "seed {seed}: {:?}", report.violations);
        let first = solve(&scene.problem, seed).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        let report = demo.check(&demo.path(&scene, &first));
        assert!(report.passed(), "seed {seed}, without times: {:?}", report.violations);
    }
    println!("free {freely:?}, at most {widest}");
    assert!(widest > 0.05, "a band, not an equality: {widest}");
    assert!(freely.0 > TILT + 0.05 && freely.1 > HEIGHT, "the scene demands what holds anyway: {freely:?}");
}

#[test]
fn a_path_that_says_less_than_the_scene_is_refused() {
    let demo = Demo::new("carried-refused");
    let free = demo.scene(SCENE);
    let unbound = demo.path(&free, &solve(&free.problem, 1).unwrap());
    let scene = demo.scene(&bounded());
    let told: Vec<_> = demo.against(&unbound, &scene.problem).violations.iter().map(|v| v.subject.clone()).collect();
    assert!(told.iter().any(|t| t.contains("`upright` of the scene is not among")), "{told:?}");
    assert!(told.iter().any(|t| t.contains("`low` of the scene is not among")), "{told:?}");
    let file = demo.path(&scene, &solve(&scene.problem, 1).unwrap());
    assert!(refusals(&demo, &file).is_empty());
    let spoiled = |spoil: &dyn Fn(&mut ConstraintEntry)| {
        let mut file = file.clone();
        file.segments.iter_mut().flat_map(|segment| &mut segment.constraints).for_each(spoil);
        refusals(&demo, &file)
    };
    // A wider angle, a higher ceiling, no ceiling.
    let wider = spoiled(&|entry| entry.within = entry.within.map(|within| within + 0.01));
    assert!(wider.iter().any(|t| t.contains("`upright`")), "{wider:?}");
    let higher = spoiled(&|entry| entry.planes.iter_mut().for_each(|plane| plane.offset -= 0.01));
    assert!(higher.iter().any(|t| t.contains("`low`")), "{higher:?}");
    let open = spoiled(&|entry| entry.planes.truncate(1));
    assert!(open.iter().any(|t| t.contains("`low`")), "{open:?}");
    // A path that breaks what it says.
    let mut narrower = file.clone();
    narrower.segments.iter_mut().flat_map(|segment| &mut segment.constraints).for_each(|entry| {
        entry.within = entry.within.map(|_| 0.01);
    });
    let report = demo.check(&narrower);
    let broken = report.violations.iter().find(|v| v.kind == Kind::Constraint).expect("a tilt");
    assert!(broken.subject.contains("tilted too far") && broken.value > broken.limit, "{broken:?}");
}

#[test]
fn what_cannot_be_demanded_is_refused_with_a_hint() {
    let demo = Demo::new("carried-wrong");
    let wrong = |before: &str, after: &str, words: &str| {
        let text = bounded();
        assert!(text.contains(before), "{before}");
        let error = demo.try_scene(&text.replacen(before, after, 1)).map(|_| ()).expect_err(after).to_string();
        assert!(error.contains(words), "{error}");
    };
    wrong("within = 0.2", "within = 0.001", "a `pose` with mask 0 0 0 1 1 0");
    wrong("within = 0.2", "within = 1.6", "is not between 0.01 radians and a right angle");
    wrong("z = [0.0, 0.9]", "", "bounds nothing");
    wrong("z = [0.0, 0.9]", "z = [1.0, 0.9]", "is above the upper bound");
    wrong("box1 = [\"upright\"", "box = [\"upright\"", "did you mean `box1`?");
    wrong("\"upright\", \"low\"", "\"uprigth\"", "did you mean `upright`?");
    // What is up on the box is a matter of its frame.
    assert!(demo.scene(&bounded()).warnings.iter().all(|w| !w.element.contains("while_held")));
    let aside = "kind = \"tilt\"\nframe = { link = \"box1/box\", pose = { rpy = [1.57, 0.0, 0.0] } }";
    let text = bounded().replacen("kind = \"tilt\"\nframe = \"box1/box\"", aside, 1);
    let warned = demo.scene(&text).warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    assert!(
        warned.contains("`upright` does not hold where the start has `box1`: it cannot be taken there"),
        "{warned}"
    );
    let free = "kind = \"pose\"\nframe = \"box1/box\"\nparameter = [0, 0, 1, 0, 0, 0]";
    wrong("kind = \"region\"\nframe = \"box1/box\"\nz = [0.0, 0.9]", free, "`low` has parameters");
}

/// A region in the air between the two places of the first box, which the hands may pass through.
#[test]
fn only_what_is_named_keeps_out_of_a_region() {
    let demo = Demo::new("carried-region");
    let region = |avoided_by: &str| {
        let part = format!(
            "[[part]]\nname = \"no_go\"\nkind = \"environment\"\nshape = {{ box = [0.3, 0.04, 0.3] }}\n\
             pose = {{ xyz = [0.5, 0.0, 0.95] }}\n{avoided_by}\n[graph]"
        );
        SCENE.replacen("[graph]", &part, 1)
    };
    let all = demo.scene(&region(""));
    let scene = demo.scene(&region("avoided_by = [\"box1\"]"));
    let ignored = |scene: &Scene| scene.problem.ignored_pairs.iter().filter(|pair| pair.reason == "region").count();
    // The links of the robot with shapes, and the other box.
    assert_eq!(ignored(&all), 0);
    let robot = &scene.problem.robot;
    let moves =
        |link: usize| robot.links[link].joint.is_some() && robot.shapes.iter().any(|s| s.link.0 as usize == link);
    let links = (0..robot.links.len()).filter(|&link| moves(link) && !robot.links[link].name.starts_with("box1/"));
    assert_eq!(ignored(&scene), links.count());
    let mut passed_through = false;
    for seed in 1..=4 {
        let solution = solve(&scene.problem, seed).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        let file = demo.path(&scene, &solution);
        let report = demo.check(&file);
        assert!(report.passed(), "seed {seed}: {:?}", report.violations);
        let mut strict = file.clone();
        strict.ignored_pairs.retain(|pair| pair[2] != "region");
        passed_through |= demo.against(&strict, &all.problem).violations.iter().any(|v| v.kind == Kind::Collision);
        // The box itself avoids it: it may not be left out.
        let mut lying = file.clone();
        lying
            .ignored_pairs
            .iter_mut()
            .filter(|pair| pair[1] == "box2/box")
            .for_each(|pair| pair[1] = "box1/box".into());
        assert!(!demo.check(&lying).passed(), "seed {seed}");
    }
    assert!(passed_through, "nothing but the box may pass through, and nothing does");
    let refused = |text: &str| demo.try_scene(text).map(|_| ()).expect_err(text).to_string();
    assert!(refused(&region("avoided_by = [\"box3\"]")).contains("did you mean"), "a name");
    let robot = SCENE.replacen("kind = \"robot\"", "kind = \"robot\"\navoided_by = []", 1);
    assert!(refused(&robot).contains("only an environment says who avoids it"));
}

/// Metres a second.
const SPEED: f64 = 0.15;

fn with_speed(limit: f64) -> String {
    format!("{SCENE}\n[timing]\nobject_speed = {{ box1 = {limit} }}\n")
}

/// The largest speed of the first box while it is held, by differences over a tenth of a millisecond.
fn fastest(solution: &Solution) -> f64 {
    let trajectory = solution.trajectory().expect("times");
    let link = trajectory.link("box1").unwrap();
    let mut poses = trajectory.poses();
    let mut at = |time: f64| {
        poses.place(time);
        poses.link(link).translation
    };
    let mut fastest = 0.0_f64;
    for segment in trajectory.segments() {
        if segment.held.iter().any(|held| held.object == "box1") {
            let duration = segment.end - segment.start - 1e-4;
            for part in 0..=400 {
                let time = segment.start + duration.max(0.0) * f64::from(part) / 400.0;
                fastest = fastest.max(at(time).distance(at(time + 0.999e-4)) / 0.999e-4);
            }
        }
    }
    fastest
}

#[test]
fn a_box_is_no_faster_than_it_may_be() {
    let demo = Demo::new("carried-speed");
    let (free, scene) = (demo.scene(SCENE), demo.scene(&with_speed(SPEED)));
    for seed in 1..=3 {
        let unbound = timed(&free, seed);
        assert!(fastest(&unbound) > 2.0 * SPEED, "{}", fastest(&unbound));
        let solution = timed(&scene, seed);
        let found = fastest(&solution);
        assert!(found <= SPEED * (1.0 + 1e-6) && found > 0.97 * SPEED, "seed {seed}: {found}");
        let path = demo.path(&scene, &solution);
        let report = demo.check(&path);
        assert!(report.passed(), "seed {seed}: {:?}", report.violations);
        // Against a lower limit, and the path that knows of none.
        for (file, limit) in [(&path, 0.99 * found), (&demo.path(&free, &unbound), SPEED)] {
            let strict = demo.scene(&with_speed(limit));
            let refused = demo.against(file, &strict.problem).violations;
            let broken = refused.iter().find(|v| v.kind == Kind::Demand).expect("it is too fast");
            assert!(broken.subject.contains("box1 is faster than it may be while it is held"), "{broken:?}");
            assert!(broken.value > broken.limit && broken.limit == Some(limit), "{broken:?}");
        }
    }
    let refused = |text: &str| demo.try_scene(text).map(|_| ()).expect_err(text).to_string();
    assert!(refused(&with_speed(0.0)).contains("is not above 0"));
    let unknown = with_speed(SPEED).replace("box1 = 0.15 }", "robot = 0.15 }");
    assert!(refused(&unknown).contains("there is no object of this name"));
}
