//! The path file of a path, as the program writes it.

#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

use foliate::components::graph::ConstraintGraph;
use foliate::components::path::ManipulationPath;
use foliate::path_file::{PathContext, PathFile, save, write_path};
use foliate::scene::Scene;
use std::path::Path;

/// The file of a path that will be saved at `out`.
pub fn written(scene: &Scene, graph: &ConstraintGraph, path: &ManipulationPath, out: &Path) -> PathFile {
    let models = save::model_names(scene, out).expect("names of the models");
    let problem = &scene.problem;
    let context = PathContext { problem, graph, models: &models, seed: 1, scheduler: "sequence", simd: "any" };
    write_path(&context, path)
}
