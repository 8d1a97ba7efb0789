//! Scenes from models: `foliate new`.

use crate::calls::errors;
use crate::scene::py_scene::PyScene;
use foliate::prelude::PackagePath;
use foliate::setup::{NewScene, SetupError, WrittenScene, new_scene as written};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// A scene that was made of models, and what is known of it.
#[pyclass(frozen, name = "NewScene", module = "foliate")]
pub struct PyNewScene {
    written: WrittenScene,
    scene: Py<PyScene>,
}

#[pymethods]
impl PyNewScene {
    /// The text of the scene file: plain entries with comments, to be looked at and changed. Names of files in it start at the `folder` that was given.
    #[getter]
    fn text(&self) -> &str {
        &self.written.text
    }

    /// The scene.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<PyScene> {
        self.scene.clone_ref(py)
    }

    /// Whether a search found a path to its goal.
    #[getter]
    fn solved(&self) -> bool {
        self.written.solved.is_some()
    }

    /// The grippers that were found.
    #[getter]
    fn grippers(&self) -> Vec<String> {
        self.written.grippers.iter().map(|gripper| gripper.name.clone()).collect()
    }

    /// By object: its name, how many handles it has, and on how many faces it rests.
    #[getter]
    fn objects(&self) -> Vec<(String, usize, usize)> {
        self.written.objects.clone()
    }

    /// What reading the models has to remark.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.written.warnings.iter().map(ToString::to_string).collect()
    }

    fn __repr__(&self) -> String {
        let objects: Vec<_> = self.written.objects.iter().map(|(name, ..)| name.as_str()).collect();
        let solved = if self.solved() { "solved" } else { "not solved" };
        format!("NewScene(grippers {}; objects {}; {solved})", self.grippers().join(", "), objects.join(", "))
    }
}

/// Makes a scene of a robot and objects: finds grippers, handles, resting faces and links that touch by design, lays the objects on a table within reach, and
/// plans to see that the first one can be moved. It is what the command `foliate new` does.
///
/// `robot` and `srdf` are files or `package://` URLs. An object is `"box X Y Z"`, `"cylinder RADIUS LENGTH"`, `"sphere RADIUS"` (metres), a mesh as
/// `"FILE [SCALE]"`, or a URDF. `table` is `"LENGTH WIDTH HEIGHT"` (metres), and, where its place is not to be found, `"X Y"` or `"X Y YAW"` of its middle, seen
/// from the root of the robot (metres, radians). `drives`: the root of the robot is planar. `grippers` names links of hands, or tool frames as `LINK` or
/// `LINK:AXIS`; without it all hands with two jaws are found. `grasps` is a file with grasps of the first object, lines of `x y z qx qy qz qw [score]`, and
/// `grasp_axes` says which axes of its frames approach and close. Names of files in the text start at `folder`.
///
/// Raises `SceneError` where a model cannot be read, `ModelError` where there is no gripper, or an object cannot be held or reached, `ValueError` for a request
/// that is none.
#[pyfunction]
#[pyo3(signature = (robot, objects, *, table = "1.2 0.8 0.75", srdf = None, drives = false, grippers = Vec::new(), grasps = None, grasp_axes = "xy", seed = 0, folder = PathBuf::from("."), packages = Vec::new()))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn new_scene(
    py: Python<'_>,
    robot: String,
    objects: Vec<String>,
    table: &str,
    srdf: Option<String>,
    drives: bool,
    grippers: Vec<String>,
    grasps: Option<PathBuf>,
    grasp_axes: &str,
    seed: u64,
    folder: PathBuf,
    packages: Vec<PathBuf>,
) -> PyResult<PyNewScene> {
    let refused = |why: SetupError| match why {
        SetupError::Read(why) => errors::of_scene(py, &why),
        SetupError::Request(why) => PyValueError::new_err(why),
        other => errors::of_model(py, &other),
    };
    if objects.is_empty() {
        return Err(PyValueError::new_err("`objects` names at least one object"));
    }
    let request = NewScene {
        robot,
        srdf,
        objects: objects.iter().map(|object| object.parse()).collect::<Result<_, _>>().map_err(refused)?,
        drives,
        table: table.parse().map_err(refused)?,
        grippers,
        grasps,
        grasp_axes: grasp_axes.parse().map_err(refused)?,
        seed,
        place: folder.join("scene.toml"),
        command: String::from("foliate.new_scene(...)"),
    };
    let search = PackagePath::from_environment(&packages);
    let made = py.detach(|| written(&request, &search)).map_err(refused)?;
    let scene = Py::new(py, PyScene::from_text(py, &made.text, folder, "scene", packages)?)?;
    Ok(PyNewScene { written: made, scene })
}
