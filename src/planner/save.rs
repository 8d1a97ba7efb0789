//! Writes what a solve answers as a path file.

use crate::path_file::error::PathFileError;
use crate::path_file::save;
use crate::path_file::write::{PathContext, write_path};
use crate::planner::answer::Solution;
use crate::scene::assemble::scene::Scene;
use foliate_kernels::lanes::Level;
use std::path::Path;

impl Solution {
    /// Writes the path file. `scene` is what was planned for; models that live only in the program are written beside the file. Seed,
    /// scheduler and level of arithmetic are said in it: what the search was asked with.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn save(
        &self,
        scene: &Scene,
        (seed, scheduler, level): (u64, &str, Level),
        out: &Path,
    ) -> Result<(), PathFileError> {
        let models = save::model_names(scene, out)?;
        let (problem, graph) = (&self.model.problem, &self.model.graph);
        let context = PathContext { problem, graph, models: &models, seed, scheduler, simd: level.name() };
        save::save(&write_path(&context, &self.path), out)
    }
}
