//! Scenes: what is planned for.

use crate::arrays::{Array, matrix};
use crate::calls::errors;
use crate::scene::document::{self, Document};
use crate::scene::solid::PySolid;
use crate::{names, page};
use foliate::components::pose::pose_to_array;
use foliate::components::robot::{Joint, PartKind, Source};
use foliate::kernels::kinematics::{Kinematics, Placement};
use foliate::prelude::{CoordinateValue, Goal, PackagePath, Problem};
use foliate::scene::{Scene, coordinate_names, shipped_scenes};
use foliate::systems::planning_model::{Model, ModelError, PlanningModel, ProblemTables};
use foliate::view::{ViewOptions, Visuals, model_of_scene, page_of_scene};
use pyo3::exceptions::PyValueError;
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use pyo3::{type_hint_identifier, type_hint_subscript};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// What is planned for: robots, objects, who may hold what and where things may lie, a start and goals.
///
/// `Scene("demo")` is a scene that is shipped (`scenes()` lists them), `Scene("my.toml")` reads a file, `Scene.from_text` a text. A scene does not
/// change: `with_start` and `with_goal` give others. It may be used by any number of threads.
///
/// `packages` are folders in which `package://` names are looked up, beside those of the environment (`FOLIATE_PACKAGE_PATH`, `ROS_PACKAGE_PATH`).
///
/// Raises `SceneError` with file, line and hint where something cannot be read.
#[pyclass(frozen, name = "Scene", module = "foliate")]
pub struct PyScene {
    pub(crate) scene: Scene,
    pub(crate) packages: PackagePath,
    model: OnceLock<PlanningModel>,
    /// Tables of a scene that differs in its goals and in where objects start at most: what takes long is shared.
    tables: Arc<OnceLock<Arc<ProblemTables>>>,
}

/// A number, three (x, y, angle) or seven (x, y, z, and the quaternion x, y, z, w).
#[derive(FromPyObject)]
pub(crate) enum Value {
    Number(f64),
    Numbers(Vec<f64>),
}

/// Values by names.
pub(crate) struct Values(Vec<(String, Value)>);

impl<'a, 'py> FromPyObject<'a, 'py> for Values {
    type Error = PyErr;

    const INPUT_TYPE: PyStaticExpr = type_hint_subscript!(
        type_hint_identifier!("collections.abc", "Mapping"),
        type_hint_identifier!("builtins", "str"),
        type_hint_identifier!("numpy.typing", "ArrayLike")
    );

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let items = given.cast::<PyMapping>()?.items()?;
        items.iter().map(|item| item.extract()).collect::<PyResult<_>>().map(Self)
    }
}

impl PyScene {
    fn of(scene: Scene, packages: PackagePath) -> Self {
        Self { scene, packages, model: OnceLock::new(), tables: Arc::default() }
    }

    /// One whose tables are there already.
    pub(crate) fn on_tables(
        scene: Scene,
        packages: PackagePath,
        tables: Arc<ProblemTables>,
    ) -> Result<Self, ModelError> {
        let model = PlanningModel(Arc::new(Model::of(tables)?));
        Ok(Self { model: OnceLock::from(model), ..Self::of(scene, packages) })
    }

    /// The constraint graph and the tables, made once.
    pub(crate) fn model(&self) -> Result<PlanningModel, ModelError> {
        match self.model.get() {
            Some(model) => Ok(model.clone()),
            None => {
                let problem = &self.scene.problem;
                let mut is_own = false;
                let tables = self.tables.get_or_init(|| {
                    is_own = true;
                    Arc::new(ProblemTables::new(problem.clone()))
                });
                let tables = match is_own {
                    true => Arc::clone(tables),
                    false => Arc::new(tables.with_ends(problem.start.clone(), problem.goals.clone())),
                };
                let made = PlanningModel(Arc::new(Model::of(tables)?));
                Ok(self.model.get_or_init(|| made).clone())
            }
        }
    }

    /// The same with another problem. No file says what it is now.
    fn changed(&self, change: impl FnOnce(&mut Problem) -> PyResult<()>) -> PyResult<Self> {
        let mut scene = self.scene.clone();
        change(&mut scene.problem)?;
        (scene.file, scene.start) = (None, None);
        let made = Self::of(scene, self.packages.clone());
        // Hands take some of their numbers from where the robot starts.
        let robot = |scene: &Scene| {
            let robot = &scene.problem.robot;
            let names = coordinate_names(robot).into_iter().zip(&scene.problem.start);
            let of_robots = names.filter(|(name, _)| {
                let part = name.split('/').next().unwrap_or_default();
                robot.parts.iter().any(|other| other.name == part && other.kind != PartKind::Object)
            });
            of_robots.map(|(_, number)| *number).collect::<Vec<_>>()
        };
        match robot(&made.scene) == robot(&self.scene) {
            true => Ok(Self { tables: Arc::clone(&self.tables), ..made }),
            false => Ok(made),
        }
    }
}

#[pymethods]
impl PyScene {
    #[new]
    #[pyo3(signature = (name, *, packages = Vec::new()))]
    fn new(py: Python<'_>, name: &str, packages: Vec<PathBuf>) -> PyResult<Self> {
        let packages = PackagePath::from_environment(&packages);
        let scene = py.detach(|| Scene::load(name, &packages)).map_err(|why| errors::of_scene(py, &why))?;
        Ok(Self::of(scene, packages))
    }

    /// Reads a scene from a text in the form of a scene file (TOML). Names of files in it start at `folder`.
    #[staticmethod]
    #[pyo3(signature = (text, *, folder = PathBuf::from("."), name = "scene", packages = Vec::new()))]
    pub(crate) fn from_text(
        py: Python<'_>,
        text: &str,
        folder: PathBuf,
        name: &str,
        packages: Vec<PathBuf>,
    ) -> PyResult<Self> {
        let packages = PackagePath::from_environment(&packages);
        let scene = py.detach(|| Scene::from_text(name, text, &folder, &packages));
        Ok(Self::of(scene.map_err(|why| errors::of_scene(py, &why))?, packages))
    }

    /// Reads a scene from a dictionary that has the keys of a scene file. Names of files in it start at `folder`.
    ///
    /// Raises `ValueError` where a value has no form in a scene file.
    #[staticmethod]
    #[pyo3(signature = (document, *, folder = PathBuf::from("."), packages = Vec::new()))]
    fn from_dict(py: Python<'_>, document: Document<'_>, folder: PathBuf, packages: Vec<PathBuf>) -> PyResult<Self> {
        let text = document::text_of(&document)?;
        Self::from_text(py, &text, folder, "scene", packages)
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.scene.problem.name
    }

    /// What it says of itself.
    #[getter]
    fn description(&self) -> &str {
        &self.scene.description
    }

    /// Names of the robots.
    #[getter]
    fn robots(&self) -> Vec<String> {
        names::of_parts(&self.scene.problem.robot, PartKind::Robot)
    }

    /// Names of the objects.
    #[getter]
    fn objects(&self) -> Vec<String> {
        names::of_parts(&self.scene.problem.robot, PartKind::Object)
    }

    /// Names of a robot's joints of one coordinate, `part/joint`, depth first (pinocchio's order), without those that follow others.
    fn joint_names(&self, py: Python<'_>, robot: &str) -> PyResult<Vec<String>> {
        let own = |joint: &Joint| matches!(joint.source, Source::Coordinates { .. });
        names::of_joints(py, &self.scene.problem.robot, robot, own)
    }

    /// Names of what never moves.
    #[getter]
    fn environments(&self) -> Vec<String> {
        names::of_parts(&self.scene.problem.robot, PartKind::Environment)
    }

    /// What reading it has to remark.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.scene.warnings.iter().map(ToString::to_string).collect()
    }

    /// The solids of its links: those that collide, or, with `visual`, what is seen (of a link without visual elements what collides).
    #[pyo3(signature = (*, visual = false))]
    fn solids(&self, py: Python<'_>, visual: bool) -> PyResult<Vec<PySolid>> {
        let robot = &self.scene.problem.robot;
        let mut solids = Visuals::of_shapes(robot);
        if visual {
            let packages = self.packages.clone().with_placeholders();
            let seen = py.detach(|| Visuals::of_scene(&self.scene, &packages));
            let seen = seen.map_err(|why| errors::of_scene(py, &why))?.links;
            for (own, seen) in solids.links.iter_mut().zip(seen).filter(|(_, seen)| !seen.is_empty()) {
                *own = seen;
            }
        }
        let links = robot.links.iter().zip(&solids.links);
        Ok(links.flat_map(|(link, solids)| solids.iter().map(|solid| PySolid::of(&link.name, solid))).collect())
    }

    /// What a joint (`part/joint`) or part has at the start: a number, three (x, y, angle) or seven (x, y, z, and the quaternion x, y, z, w); metres and
    /// radians.
    fn start(&self, py: Python<'_>, name: &str) -> PyResult<Vec<f64>> {
        let problem = &self.scene.problem;
        let value = problem.robot.get(&problem.start, name).map_err(|why| errors::of_model(py, &why))?;
        Ok(value.numbers())
    }

    /// Poses in the world of links (`part/link`) or parts (`part`: its root link) at the start: an array of shape (names, 7), x, y, z in metres and the
    /// quaternion x, y, z, w.
    fn poses<'py>(&self, py: Python<'py>, names: Vec<String>) -> PyResult<Array<'py>> {
        let problem = &self.scene.problem;
        let robot = &problem.robot;
        let at_start = Kinematics::new(robot).poses(&problem.start);
        let mut numbers = Vec::with_capacity(7 * names.len());
        for name in &names {
            let part = || robot.part(name).map(|part| robot.parts[part.at()].root_link);
            let link = robot.link(name).or_else(part);
            let link = &robot.links[link.ok_or_else(|| errors::unknown(py, "part or link", name))?.at()];
            let placement = Placement { joint: link.joint, X_JF: link.joint_from_link };
            numbers.extend_from_slice(&pose_to_array(&placement.in_world(&at_start)));
        }
        matrix(py, numbers, 7)
    }

    /// The scene with another start: joints (`part/joint`, radians or metres) and parts (poses in the world: x, y, z in metres and the quaternion x, y, z,
    /// w). What is not named starts as before.
    fn with_start(&self, py: Python<'_>, values: Values) -> PyResult<Self> {
        self.changed(|problem| {
            for (name, value) in &values.0 {
                problem.set_start(name, value.read(name)?).map_err(|why| errors::of_model(py, &why))?;
            }
            Ok(())
        })
    }

    /// The scene with another goal: joints and parts as in `with_start` that have these values in the end. What is not named is free, but nothing stays in
    /// a hand.
    fn with_goal(&self, py: Python<'_>, values: Values) -> PyResult<Self> {
        self.changed(|problem| {
            let read = |(name, value): &(String, Value)| Ok((name.clone(), value.read(name)?));
            let read: Vec<(String, CoordinateValue)> = values.0.iter().map(read).collect::<PyResult<_>>()?;
            let named = read.iter().map(|(name, value)| (name.as_str(), *value));
            let goal: Goal = problem.partial_goal(named).map_err(|why| errors::of_model(py, &why))?;
            problem.goals = vec![goal];
            Ok(())
        })
    }

    /// A page that shows the scene: its text, or, with `out`, the name of the file into which it is written.
    #[pyo3(signature = (out = None))]
    fn view(&self, py: Python<'_>, out: Option<PathBuf>) -> PyResult<String> {
        page::shown(py, &self.page(py)?, out)
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        page::framed(&self.page(py)?)
    }

    fn __repr__(&self) -> String {
        let (robots, objects) = (self.robots().join(", "), self.objects().join(", "));
        format!("Scene({:?}: robots {robots}; objects {objects})", self.name())
    }
}

impl PyScene {
    fn page(&self, py: Python<'_>) -> PyResult<foliate::view::Page> {
        let made = py.detach(|| {
            let visuals = Visuals::of_scene(&self.scene, &self.packages.clone().with_placeholders())?;
            Ok(page_of_scene(&self.scene, model_of_scene(&self.scene), &visuals, &ViewOptions::default()))
        });
        made.map_err(|why| errors::of_scene(py, &why))
    }
}

impl Value {
    fn read(&self, name: &str) -> PyResult<CoordinateValue> {
        let numbers = match self {
            Self::Number(number) => std::slice::from_ref(number),
            Self::Numbers(numbers) => numbers.as_slice(),
        };
        CoordinateValue::from_numbers(numbers).ok_or_else(|| {
            PyValueError::new_err(format!(
                "`{name}` has {} numbers; a joint has one, a base on the floor three (x, y, angle), a part seven (x, y, z, and the quaternion x, y, z, w)",
                numbers.len()
            ))
        })
    }
}

/// The scenes that are shipped: name, what it is, and whether it needs published robot models (`foliate models --install`).
#[pyfunction]
pub fn scenes() -> Vec<(&'static str, &'static str, bool)> {
    shipped_scenes().iter().map(|scene| (scene.name, scene.summary, scene.needs_models)).collect()
}
