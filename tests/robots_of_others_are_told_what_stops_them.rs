//! Promise: with robots that others publish a person is told what stops a plan: all links that collide, at once; the joint whose limit is in the
//! way, and by how much; and paths have few needless grasps. The models are fetched from PyPI.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

#[path = "common/skip.rs"]
mod skip;

use foliate::components::infeasibility::Infeasibility;
use foliate::components::path::Attachment;
use foliate::scene::{PackagePath, Scene};
use foliate::systems::goals::impossible::hindrance::{Hindrance, Shortfall};
use foliate::systems::settings::SearchSettings;
use foliate::{NoSolution, NoSolutionReason, Planner};
use std::path::{Path, PathBuf};

/// A scene in a folder of its own, with a package as `models` beside it.
fn load(name: &str, package: &Path, text: &str) -> Scene {
    let folder = std::env::temp_dir().join(format!("foliate-others-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let text = text.replace("MODELS", &package.display().to_string());
    let file = folder.join("scene.toml");
    std::fs::write(&file, text).unwrap();
    let given: Vec<PathBuf> = vec![package.to_owned()];
    let scene = Scene::load(&file.display().to_string(), &PackagePath::only(&given)).unwrap_or_else(|e| panic!("{e}"));
    std::fs::remove_dir_all(folder).unwrap();
    scene
}

/// A mobile manipulator that drives, a table 63 cm high, and a block on it that shall be moved along it by 0.9 m.
fn stretch(package: &Path, ignored: &str) -> Scene {
    let urdf = "MODELS/stretch_urdf/SE3/stretch_description_SE3_eoa_wrist_dw3_tool_sg3.urdf";
    let text = format!(
        "format = \"foliate.scene/1\"\nname = \"block\"\n\
         [[part]]\nname = \"stretch\"\nkind = \"robot\"\nurdf = \"{urdf}\"\nroot = \"planar\"\n{ignored}\n\
         root_bounds = [[-2.0, 2.0], [-1.0, 1.0], [-1.5, 1.5]]\n\
         [[part.gripper]]\nname = \"hand\"\nlink = \"link_grasp_center\"\nclearance = 0.05\n\
         [[part]]\nname = \"table\"\nkind = \"environment\"\nshape = {{ box = [1.5, 1.0, 0.05] }}\npose = {{ xyz = [0.0, -1.0, 0.6] }}\nsurfaces = \"auto\"\n\
         [[part]]\nname = \"block\"\nkind = \"object\"\nshape = {{ box = [0.1, 0.018, 0.018], mass = 0.1 }}\nsurfaces = \"auto\"\n\
         root_bounds = [[-2.0, 2.0], [-2.0, 2.0], [0.0, 1.5]]\n\
         [[part.handle]]\nname = \"top\"\nlink = \"body\"\npose = {{ rpy = [0.0, 1.5707963267948966, 0.0] }}\nclearance = 0.05\n\
         [start]\nstretch = [0.0, 0.0, 0.0]\n\"stretch/joint_lift\" = 0.9\nblock = {{ xyz = [-0.4, -0.7, 0.635] }}\n\
         [[goal]]\nobjects = {{ block = {{ xyz = [0.5, -0.7, 0.635] }} }}\n"
    );
    load("stretch", package, &text)
}

fn refused(scene: &Scene, steps: u64) -> NoSolution {
    let settings = SearchSettings::default().with(|s| s.max_steps = steps);
    let planner = Planner::new(scene.problem.clone()).unwrap().settings(settings);
    planner.first_path().solve_on(1).map(|_| ()).expect_err("there is no path")
}

/// The links that collide at the start, in the words of `ignore`.
fn colliding(scene: &Scene) -> Option<String> {
    match refused(scene, 1).reason {
        NoSolutionReason::InfeasibleStart(Infeasibility::Collision(pairs)) => {
            let local = |link: &str| link.split_once('/').unwrap().1.to_owned();
            let pair = |pair: &foliate::components::infeasibility::CollidingPair| {
                format!("[\"{}\", \"{}\"]", local(&pair.links.0), local(&pair.links.1))
            };
            Some(pairs.iter().map(pair).collect::<Vec<_>>().join(", "))
        }
        _ => None,
    }
}

#[test]
fn links_that_collide_where_a_robot_starts_are_all_told_at_once() {
    let Some(package) = skip::unpacked("hello-robot-stretch-urdf", "links_that_collide_where_a_robot_starts") else {
        return;
    };
    let told = colliding(&stretch(&package, "")).expect("its links overlap where its documents say nothing of it");
    assert!(told.matches("], [").count() >= 10, "{told}");
    let ignored = format!("ignore = [\"adjacent\", {told}]");
    assert_eq!(colliding(&stretch(&package, &ignored)), None, "one message is enough");
}

/// The wrist would have to pitch by a right angle, and its limit is 0.8 mrad less. It could drive anywhere.
#[test]
fn a_limit_that_is_missed_by_a_milliradian_is_named_with_its_joint() {
    let Some(package) = skip::unpacked("hello-robot-stretch-urdf", "a_limit_that_is_missed_by_a_milliradian") else {
        return;
    };
    let told = colliding(&stretch(&package, "")).unwrap();
    let scene = stretch(&package, &format!("ignore = [\"adjacent\", {told}]"));
    let report = refused(&scene, 60).report;
    let [row] = &report.objects[..] else { panic!("one block has to be moved") };
    for hindrance in [&row.start_hindrance, &row.goal_hindrance] {
        let Some(Hindrance::OutOfReach(reach)) = hindrance else { panic!("{hindrance:?}") };
        let Shortfall::Limit { joint, needed, limit } = &reach.shortfall else { panic!("{reach}") };
        assert_eq!(joint, "stretch/joint_wrist_pitch", "{reach}");
        assert!((needed + std::f64::consts::FRAC_PI_2).abs() < 1e-3 && (limit + 1.57).abs() < 1e-9, "{reach}");
    }
}

/// A humanoid moves a brick from one side to the other, which no arm reaches alone.
#[test]
fn a_humanoid_changes_hands_seldom() {
    let Some(package) = skip::unpacked("dexmate-urdf", "a_humanoid_changes_hands_seldom") else { return };
    let gripper = |side: &str, letter: &str| {
        format!(
            "[[part.gripper]]\nname = \"{side}\"\nlink = \"{letter}_gripper_base\"\nclearance = 0.05\n\
             pose = {{ xyz = [0.0, 0.0, 0.16], quaternion = [-0.5, -0.5, -0.5, 0.5] }}\n"
        )
    };
    let handle = |name: &str, x: f64| {
        format!(
            "[[part.handle]]\nname = \"{name}\"\nlink = \"body\"\nclearance = 0.05\nmask = [1, 1, 1, 1, 0, 1]\n\
             pose = {{ xyz = [{x}, 0.0, 0.0], rpy = [0.0, 1.5707963267948966, 3.141592653589793] }}\n"
        )
    };
    let still = [
        "B_wheel_j1",
        "B_wheel_j2",
        "L_wheel_j1",
        "L_wheel_j2",
        "R_wheel_j1",
        "R_wheel_j2",
        "head_j1",
        "head_j2",
        "head_j3",
    ];
    let still: String = still.map(|joint| format!("\"vega/{joint}\" = 0.0\n")).concat();
    let model = "MODELS/dexmate_urdf/robots/humanoid/vega_1/vega_1_gripper";
    let text = format!(
        "format = \"foliate.scene/1\"\nname = \"brick\"\n\
         [[part]]\nname = \"vega\"\nkind = \"robot\"\nurdf = \"{model}.urdf\"\nsrdf = \"{model}.srdf\"\n{}{}\
         [[part]]\nname = \"table\"\nkind = \"environment\"\nshape = {{ box = [1.0, 1.5, 0.05] }}\npose = {{ xyz = [0.95, 0.0, 0.6] }}\nsurfaces = \"auto\"\n\
         [[part]]\nname = \"brick\"\nkind = \"object\"\nshape = {{ box = [0.15, 0.05, 0.03], mass = 0.1 }}\nsurfaces = \"auto\"\n\
         root_bounds = [[0.0, 1.5], [-1.2, 1.2], [0.0, 2.0]]\n{}{}\
         [locked]\n\"vega/L_gripper_j1\" = 0.4\n\"vega/R_gripper_j1\" = 0.4\n{still}\
         [start]\n\"vega/torso_j1\" = 0.6\n\"vega/torso_j2\" = 1.2\n\"vega/torso_j3\" = -0.6\n\"vega/L_arm_j4\" = -2.5\n\"vega/R_arm_j4\" = -2.5\n\
         brick = {{ xyz = [0.7, 0.55, 0.641] }}\n[[goal]]\nconfiguration = {{ brick = {{ xyz = [0.7, -0.55, 0.641] }} }}\n",
        gripper("left", "L"),
        gripper("right", "R"),
        handle("end_a", 0.05),
        handle("end_b", -0.05)
    );
    let scene = load("vega", &package, &text);
    let mut counts = Vec::new();
    for seed in 1..=5 {
        let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (seed, 4000));
        let planner = Planner::new(scene.problem.clone()).unwrap().settings(settings);
        let path = planner.first_path().solve_on(1).unwrap_or_else(|e| panic!("seed {seed}: {e}")).path;
        let held = |at: usize| {
            let attachments = path.segments[at].attachments.iter();
            attachments.filter(|held| matches!(held, Attachment::Grasp { .. })).collect::<Vec<_>>()
        };
        let changes = |at: usize| held(at).iter().filter(|grasp| !held(at - 1).contains(grasp)).count();
        counts.push((1..path.segments.len()).map(changes).sum::<usize>());
    }
    println!("grasps by seed: {counts:?}");
    counts.sort_unstable();
    // Two are needed. Searches that put the brick down and take it again on the way once had nine for one of three seeds.
    assert!(counts[0] == 2 && counts[4] <= 5, "{counts:?}");
}
