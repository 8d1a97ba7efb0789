//! Scenes that vary: places of objects, obstacles, sizes, by number.

use crate::calls::errors;
use crate::scene::document::{self, Document};
use crate::scene::py_scene::PyScene;
use foliate::batch::vary::{Instance, NoInstance, Variations};
use foliate::batch::{Entry, Suite};
use foliate::prelude::{PackagePath, SceneError};
use foliate::systems::planning_model::ModelError;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};

/// Instances of a scene that differ in what `vary` says: random starts and goals of objects on their supports, object counts, poses of parts, sizes, obstacles.
///
/// `Variations("demo", {"seed": 7, "starts": True, "goals": ["box1"]})`; `vary` has the keys of `[vary]` in a suite file (docs/batches.md). An instance follows from the scene, `vary` and its number
/// alone. All start and goal in states of the constraint graph and without collision; that there is a path is not known.
///
/// Raises `SceneError` where the scene cannot be read, or cannot vary so.
#[pyclass(frozen, name = "Variations", module = "foliate")]
pub struct PyVariations {
    variations: Variations,
    packages: PackagePath,
}

#[pymethods]
impl PyVariations {
    #[new]
    #[pyo3(signature = (scene, vary, *, packages = Vec::new()))]
    fn new(py: Python<'_>, scene: &str, vary: Document<'_>, packages: Vec<PathBuf>) -> PyResult<Self> {
        let mut table: toml::Table = document::table_of(&vary)?;
        table.entry("instances").or_insert(toml::Value::Integer(1));
        let suite = toml::Table::from_iter([
            ("format".to_owned(), "foliate.suite/1".into()),
            ("name".to_owned(), "vary".into()),
            ("scenes".to_owned(), vec![toml::Value::from(scene)].into()),
            ("vary".to_owned(), table.into()),
        ]);
        let text = toml::to_string(&suite).map_err(|why| PyValueError::new_err(why.to_string()))?;
        let packages = PackagePath::from_environment(&packages);
        let made = py.detach(|| Self::of_suite(&Suite::from_text("vary", &text, Path::new("."))?, &packages));
        let mut made = made.map_err(|why| errors::of_scene(py, &why))?;
        made.pop().ok_or_else(|| PyValueError::new_err("`vary` says nothing"))
    }

    /// Those of a suite file, one for each of its scenes, with how many instances it wants; of a suite without `[vary]` none.
    #[staticmethod]
    #[pyo3(signature = (file, *, packages = Vec::new()))]
    fn from_suite(py: Python<'_>, file: PathBuf, packages: Vec<PathBuf>) -> PyResult<Vec<(Self, u64)>> {
        let packages = PackagePath::from_environment(&packages);
        let made = py.detach(|| Self::of_suite(&Suite::read(&file)?, &packages));
        let made = made.map_err(|why| errors::of_scene(py, &why))?;
        Ok(made
            .into_iter()
            .map(|made| {
                let count = made.variations.vary().instances;
                (made, count)
            })
            .collect())
    }

    /// The instance of a number.
    ///
    /// Raises `NoInstance` where no draw has a start and goals that could be planned for; it says what was wrong with them.
    fn instance(&self, py: Python<'_>, number: u64) -> PyResult<PyScene> {
        py.detach(|| self.draw(number)).map_err(|not_drawn| not_drawn.told(py))
    }
}

impl PyVariations {
    /// The instance of a number.
    pub(crate) fn draw(&self, number: u64) -> Result<PyScene, NotDrawn> {
        let Instance { scene, tables, .. } = self.variations.instance(number).map_err(NotDrawn::Instance)?;
        let scene = scene.ok_or(NotDrawn::Scene)?;
        PyScene::on_tables(scene, self.packages.clone(), tables).map_err(NotDrawn::Model)
    }

    fn of_suite(suite: &Suite, packages: &PackagePath) -> Result<Vec<Self>, SceneError> {
        let Some(vary) = &suite.vary else { return Ok(Vec::new()) };
        let of = |scene: &String| {
            let entry = Entry::load(scene, packages)?;
            Ok(Self { variations: Variations::new(&entry, vary.clone(), packages)?, packages: packages.clone() })
        };
        suite.scenes.iter().map(of).collect()
    }
}

/// What there is not, so that there is no scene of an instance.
pub(crate) enum NotDrawn {
    Instance(NoInstance),
    Model(ModelError),
    Scene,
}

impl NotDrawn {
    /// As an exception.
    pub(crate) fn told(&self, py: Python<'_>) -> PyErr {
        match self {
            Self::Instance(none) => errors::raised(py, "NoInstance", (none.to_string(), none.number)),
            Self::Model(why) => errors::of_model(py, why),
            Self::Scene => PyValueError::new_err("the scene has no text"),
        }
    }
}
