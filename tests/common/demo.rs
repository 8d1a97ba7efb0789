//! The demo's files in a folder of their own, and what tests do with scenes beside them.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]
#![allow(dead_code, reason = "each test uses its part")]

use foliate::check::{CheckOptions, CheckReport, check, check_problem};
use foliate::components::problem::Problem;
use foliate::path_file::{PathFile, save};
use foliate::scene::{PackagePath, Scene, SceneError};
use foliate::systems::settings::SearchSettings;
use foliate::{NoSolution, Planner, Solution};
use std::path::PathBuf;
use std::process::Command;

#[path = "written.rs"]
mod written;

/// The scene of the demo: two arms, a table, two boxes.
pub const SCENE: &str = include_str!("../../scenes/demo/scene.toml");

/// A folder with the files of the demo, removed at the end.
pub struct Demo(pub PathBuf);

impl Drop for Demo {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

/// What a command of the program says.
pub struct Said {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl Demo {
    pub fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("foliate-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for (file, text) in [
            ("robot.urdf", include_str!("../../scenes/demo/robot.urdf")),
            ("robot.srdf", include_str!("../../scenes/demo/robot.srdf")),
            ("table.urdf", include_str!("../../scenes/demo/table.urdf")),
            ("table.srdf", include_str!("../../scenes/demo/table.srdf")),
            ("box.urdf", include_str!("../../scenes/demo/box.urdf")),
            ("box.srdf", include_str!("../../scenes/demo/box.srdf")),
        ] {
            std::fs::write(folder.join(file), text).unwrap();
        }
        Self(folder)
    }

    pub fn write(&self, name: &str, text: &str) -> String {
        let file = self.0.join(name);
        std::fs::write(&file, text).unwrap();
        file.display().to_string()
    }

    pub fn try_scene(&self, text: &str) -> Result<Scene, SceneError> {
        Scene::load(&self.write("scene.toml", text), &PackagePath::only(&[]))
    }

    pub fn scene(&self, text: &str) -> Scene {
        self.try_scene(text).unwrap_or_else(|e| panic!("{e}"))
    }

    /// The first path as a file beside the scene.
    pub fn path(&self, scene: &Scene, solution: &Solution) -> PathFile {
        let out = self.0.join("path.json");
        let file = written::written(scene, &solution.model.graph, &solution.path, &out);
        save::save(&file, &out).unwrap();
        file
    }

    pub fn check(&self, file: &PathFile) -> CheckReport {
        check(file, &self.0, &PackagePath::only(&[]), &CheckOptions::default()).unwrap()
    }

    /// The check of a path against another problem than its scene's.
    pub fn against(&self, file: &PathFile, problem: &Problem) -> CheckReport {
        check_problem(file, &self.0, &PackagePath::only(&[]), &CheckOptions::default(), problem).unwrap()
    }

    /// Runs the program in the folder.
    pub fn run(&self, arguments: &[&str]) -> Said {
        let done = Command::new(env!("CARGO_BIN_EXE_foliate")).args(arguments).current_dir(&self.0).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
        Said { code: done.status.code().unwrap_or(-1), out: text(done.stdout), err: text(done.stderr) }
    }
}

/// Solves with a bound on steps.
pub fn solve(problem: &Problem, seed: u64) -> Result<Solution, NoSolution> {
    let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (seed, 2000));
    Planner::new(problem.clone()).unwrap().settings(settings).first_path().solve()
}

/// The first number of an object's root in a configuration.
pub fn first_of(scene: &Scene, name: &str) -> usize {
    let wanted = format!("{name}/x");
    foliate::scene::coordinate_names(&scene.problem.robot).iter().position(|known| *known == wanted).unwrap()
}
