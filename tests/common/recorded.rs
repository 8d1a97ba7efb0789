//! Recordings of the embedded scene.

#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]
#![allow(dead_code, reason = "each test uses its part")]

use foliate::components::problem::Problem;
use foliate::path_file::{PathContext, save};
use foliate::recording::Recording;
use foliate::scene::{PackagePath, Scene};
use foliate::{NoSolution, Planner, Solution};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A fresh folder that goes when the test ends.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-recorded-{name}-{}", std::process::id()));
        let _fresh = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

/// The embedded scene.
pub fn demo() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| Scene::load("demo", &PackagePath::default()).expect("it ships"))
}

/// A planner of it that ends with the first path.
pub fn planner(scheduler: &str) -> Planner {
    let planner = Planner::new(demo().problem.clone()).expect("a model").first_path();
    planner.scheduler_named(scheduler).expect("it ships")
}

/// The recording of an answer for it.
pub fn recorded(answer: &Result<Solution, NoSolution>, scheduler: &str, seed: u64) -> Recording {
    recorded_of(&demo().problem, answer, scheduler, seed)
}

/// The same for a problem with the parts of the embedded scene.
pub fn recorded_of(problem: &Problem, answer: &Result<Solution, NoSolution>, scheduler: &str, seed: u64) -> Recording {
    let graph = match answer {
        Ok(solution) => &solution.model.graph,
        Err(none) => &none.model.graph,
    };
    // No models are written beside a device.
    let models = save::model_names(demo(), Path::new("/dev/null")).expect("names");
    let context = PathContext { problem, graph, models: &models, seed, scheduler, simd: "any" };
    Recording::of(&context, answer)
}
