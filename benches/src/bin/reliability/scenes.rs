//! The scenes that figures go over: those that are shipped and whose models are at hand.

use crate::Result;
use foliate::Planner;
use foliate::batch::Entry;
use foliate::path_file::{PathContext, PathFile, save, write_path};
use foliate::scene::{MeshCache, PackagePath, Scene, shipped_scenes};
use foliate::schedulers;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// A scene, loaded once.
pub(crate) struct Loaded {
    pub name: &'static str,
    pub entry: Entry,
}

/// Where models and meshes are.
pub(crate) fn packages() -> PackagePath {
    PackagePath::from_environment(&[]).with_mesh_cache(MeshCache::of_user())
}

/// All of them, or the first so many.
pub(crate) fn all(most: usize) -> Vec<Loaded> {
    let packages = packages();
    let load = |name: &'static str| match Entry::load(name, &packages) {
        Ok(entry) => Some(Loaded { name, entry }),
        Err(error) => {
            foliate_benches::skipped(name, &error.to_string());
            None
        }
    };
    shipped_scenes().iter().take(most).filter_map(|scene| load(scene.name)).collect()
}

impl Loaded {
    pub(crate) fn planner(&self, seed: u64, limit: Duration) -> Result<Planner> {
        Ok(Planner::from_tables(Arc::clone(self.entry.model().tables()))?.seed(seed).first_path().time_limit(limit))
    }

    fn scene(&self) -> Result<&Scene> {
        self.entry.scene().ok_or_else(|| "every scene here comes from a file".into())
    }

    /// Solves and writes the path; none where it is not solved.
    pub(crate) fn path(&self, seed: u64, limit: Duration, out: &Path) -> Result<Option<PathFile>> {
        let planner = self.planner(seed, limit)?;
        let Ok(solution) = planner.solve_on(1) else { return Ok(None) };
        let models = save::model_names(self.scene()?, out)?;
        let context = PathContext {
            problem: &planner.model().problem,
            graph: &solution.model.graph,
            models: &models,
            seed,
            scheduler: schedulers::DEFAULT,
            simd: "detected",
        };
        let file = write_path(&context, &solution.path);
        save::save(&file, out)?;
        Ok(Some(file))
    }
}

/// A folder below `target/` for paths.
pub(crate) fn folder(name: &str) -> Result<std::path::PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/reliability").join(name);
    std::fs::create_dir_all(&path)?;
    Ok(path)
}

/// Says how far a long figure is.
pub(crate) fn progress(name: &str, done: usize, all: usize) {
    if done > 0 && (done.is_multiple_of((all / 20).max(1)) || done == all) {
        eprintln!("  {name}: {done} of {all}");
    }
}
