//! A problem of a batch.

use crate::scene::assemble::scene::Scene;
use crate::scene::reading::error::{LoadStop, SceneError};
use crate::scene::sources::package::PackagePath;
use foliate_components::problem::Problem;
use foliate_systems::planning_model::{Model, ModelError, PlanningModel, ProblemTables};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A problem, ready to be searched any number of times.
#[derive(Debug)]
pub struct Entry {
    model: PlanningModel,
    load_time: Duration,
    scene: Option<Scene>,
}

impl Entry {
    /// Loads a scene (a shipped one by its name, or a file) and builds its model, as long as the limits of `packages` allow.
    ///
    /// # Errors
    /// The first thing that is wrong with the scene; that loading was stopped.
    pub fn load(name_or_path: &str, packages: &PackagePath) -> Result<Self, SceneError> {
        let started = Instant::now();
        let scene = Scene::load(name_or_path, packages)?;
        let tables = ProblemTables::new_until(scene.problem.clone(), &packages.limits().stop);
        let Some(tables) = tables else {
            packages.limits().reached(name_or_path)?;
            return Err(SceneError::stopped(name_or_path, LoadStop::Deadline));
        };
        let model = Model::of(Arc::new(tables));
        let model = model.map_err(|error| SceneError::new(name_or_path, "problem", error.to_string()))?;
        Ok(Self { model: PlanningModel(Arc::new(model)), load_time: started.elapsed(), scene: Some(scene) })
    }

    /// A problem that was made in code. No path files are written for it: its models have no names that one could give.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn of_problem(problem: Problem) -> Result<Self, ModelError> {
        let started = Instant::now();
        let model = PlanningModel(Arc::new(Model::new(problem)?));
        Ok(Self { model, load_time: started.elapsed(), scene: None })
    }

    /// The problem's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.model.problem.name
    }

    /// Problem, graph and tables.
    #[must_use]
    pub fn model(&self) -> &PlanningModel {
        &self.model
    }

    /// How long reading and building took.
    #[must_use]
    pub fn load_time(&self) -> Duration {
        self.load_time
    }

    /// The scene, where the problem comes from one.
    #[must_use]
    pub fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    /// The name as part of a file's name: everything but letters, digits, `-`, `_` and `.` becomes `_`.
    #[must_use]
    pub fn file_stem(&self) -> String {
        as_file_name(self.name())
    }
}

/// A name as part of a file's name.
pub(crate) fn as_file_name(name: &str) -> String {
    let keep = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    name.chars().take(100).map(keep).collect()
}
