//! Paths: what a robot program or a notebook asks of them, as numpy arrays.

use crate::arrays::{Array, Numbers, blocks, matrix, row};
use crate::calls::errors;
use crate::path::event::PyEvent;
use crate::path::segment::PySegment;
use crate::scene::py_scene::PyScene;
use crate::{names, page};
use foliate::Solution;
use foliate::components::path::{Attachment, ManipulationPath, Segment};
use foliate::components::pose::pose_to_array;
use foliate::components::robot::{PartKind, Robot};
use foliate::kernels::collision::{CollisionScene, PairRule};
use foliate::kernels::lanes::Level;
use foliate::path_file::{LoadedPath, save};
use foliate::prelude::{PackagePath, Trajectory, TrajectoryError};
use foliate::scene::{SceneError, coordinate_names};
use foliate::trajectory::{Interpolation, TimedMotion};
use foliate::view::{Page, ViewOptions, Visuals, page_of_path, page_of_solution};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// Where a path comes from.
pub(crate) enum Source {
    /// A solve.
    Solved { solution: Arc<Solution>, scene: Py<PyScene>, seed: u64, scheduler: String },
    /// A file.
    Loaded { path: Arc<LoadedPath>, file: PathBuf },
}

/// A certified path: segments, each on one leaf, and, where it has times, a curve over time.
///
/// Configurations are rows of numbers: metres, radians, and quaternions x, y, z, w; the numbers of parts one after the other, joints depth first as
/// pinocchio has them, a free part as x, y, z and its quaternion. Poses are x, y, z and the quaternion, in the world.
#[pyclass(frozen, name = "Path", module = "foliate")]
pub struct PyPath {
    pub(crate) source: Source,
}

impl PyPath {
    fn path(&self) -> &ManipulationPath {
        match &self.source {
            Source::Solved { solution, .. } => &solution.path,
            Source::Loaded { path, .. } => &path.path,
        }
    }

    fn robot(&self) -> &Robot {
        match &self.source {
            Source::Solved { solution, .. } => &solution.model.problem.robot,
            Source::Loaded { path, .. } => &path.robot,
        }
    }

    fn trajectory(&self, py: Python<'_>) -> PyResult<Trajectory<'_>> {
        let made = match &self.source {
            Source::Solved { solution, .. } => solution.trajectory(),
            Source::Loaded { path, .. } => path.trajectory(),
        };
        made.map_err(|why| errors::of_path(py, &why))
    }

    fn page(&self, py: Python<'_>) -> PyResult<Page> {
        let scene_error = |why: SceneError| errors::of_scene(py, &why);
        let path_error = |why: TrajectoryError| errors::of_path(py, &why);
        let options = ViewOptions::default();
        match &self.source {
            Source::Solved { solution, scene, .. } => {
                let scene = scene.get();
                let packages = scene.packages.clone().with_placeholders();
                let visuals = Visuals::of_scene(&scene.scene, &packages).map_err(scene_error)?;
                page_of_solution(solution, &visuals, &options).map_err(path_error)
            }
            Source::Loaded { path, file } => {
                let read = save::read(file).map_err(|why| errors::of_path(py, &why))?;
                let visuals = Visuals::of_shapes(&path.robot);
                page_of_path((&read, path), None, None, &visuals, &options).map_err(path_error)
            }
        }
    }

    pub(crate) fn framed(&self, py: Python<'_>) -> PyResult<String> {
        page::framed(&self.page(py)?)
    }
}

#[pymethods]
impl PyPath {
    /// The segments in the direction of travel.
    #[getter]
    fn segments(&self) -> Vec<PySegment> {
        let name = |index: usize, segment: &Segment| match &self.source {
            Source::Solved { solution, .. } => {
                let graph = &solution.model.graph;
                (graph.state(segment.state).name.clone(), graph.transition(segment.transition).name.clone())
            }
            Source::Loaded { path, .. } => (path.states()[index].clone(), path.transitions()[index].clone()),
        };
        let robot = self.robot();
        let made = |(index, segment): (usize, &Segment)| {
            let (state, transition) = name(index, segment);
            let holding = segment.attachments.iter().filter_map(|attachment| match attachment {
                Attachment::Grasp { gripper, handle, .. } => {
                    Some((robot.grippers[gripper.at()].name.clone(), robot.handles[handle.at()].name.clone()))
                }
                Attachment::Contact { .. } | Attachment::Rest { .. } => None,
            });
            PySegment { segment: segment.clone(), state, transition, holding: holding.collect() }
        };
        self.path().segments.iter().enumerate().map(made).collect()
    }

    /// Names of all grippers, `part/gripper`.
    #[getter]
    fn grippers(&self) -> Vec<String> {
        self.robot().grippers.iter().map(|gripper| gripper.name.clone()).collect()
    }

    /// Names of the numbers of a configuration: `part/joint`, `part/x` to `part/qw` of a free part, `part/x`, `part/y` and `part/theta` of a planar one.
    #[getter]
    fn coordinates(&self) -> Vec<String> {
        coordinate_names(self.robot())
    }

    /// All knots in the direction of travel: an array of shape (knots, numbers of a configuration). The last knot of a segment is the first of the next
    /// one, and is there once.
    #[getter]
    fn knots<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let mut rows: Vec<f64> = Vec::new();
        let mut columns = 0;
        for segment in &self.path().segments {
            columns = segment.knots.first().map_or(0, Vec::len);
            let skipped = usize::from(!rows.is_empty());
            segment.knots.iter().skip(skipped).for_each(|knot| rows.extend_from_slice(knot));
        }
        matrix(py, rows, columns)
    }

    /// How long it takes, seconds; `None` in a path without times.
    #[getter]
    fn duration(&self) -> Option<f64> {
        self.path().duration()
    }

    /// Proven lower bound of the distance of all tested pairs beyond their margins, metres; `None` where no pair is tested.
    #[getter]
    fn min_clearance(&self) -> Option<f64> {
        self.path().certificate.min_clearance
    }

    /// Names of the robots.
    #[getter]
    fn robots(&self) -> Vec<String> {
        names::of_parts(self.robot(), PartKind::Robot)
    }

    /// Names of the objects.
    #[getter]
    fn objects(&self) -> Vec<String> {
        names::of_parts(self.robot(), PartKind::Object)
    }

    /// Names of a robot's joints of one coordinate, `part/joint`, those that follow others included, depth first (pinocchio's order).
    fn joint_names(&self, py: Python<'_>, robot: &str) -> PyResult<Vec<String>> {
        names::of_joints(py, self.robot(), robot, |_| true)
    }

    /// Times at a rate (per second), the last one exactly at the end: an array of shape (times,), seconds.
    fn times<'py>(&self, py: Python<'py>, rate: f64) -> PyResult<Array<'py>> {
        let trajectory = self.trajectory(py)?;
        let times: Vec<f64> = trajectory.sample_times(rate).map_err(|why| errors::of_path(py, &why))?.collect();
        Ok(row(py, times))
    }

    /// Whole configurations at times (seconds; clamped to the path): an array of shape (times, numbers of a configuration). Objects are where they are
    /// carried.
    fn configurations<'py>(&self, py: Python<'py>, times: Numbers) -> PyResult<Array<'py>> {
        let trajectory = self.trajectory(py)?;
        let (rows, columns) = py.detach(|| {
            let mut poses = trajectory.poses();
            let mut rows = Vec::with_capacity(times.0.len() * poses.configuration().len());
            for &time in &times.0 {
                poses.place(time);
                rows.extend_from_slice(poses.configuration());
            }
            (rows, poses.configuration().len())
        });
        matrix(py, rows, columns)
    }

    /// What joints do at times: positions, velocities and accelerations, three arrays of shape (times, joints) in rad, rad/s, rad/s² or metres. `joints` is
    /// the name of a robot, or names of joints.
    fn joints<'py>(
        &self,
        py: Python<'py>,
        joints: Names,
        times: Numbers,
    ) -> PyResult<(Array<'py>, Array<'py>, Array<'py>)> {
        let trajectory = self.trajectory(py)?;
        let selected = match &joints {
            Names::One(robot) => trajectory.joints_of(robot),
            Names::Several(names) => trajectory.joints(&names.iter().map(String::as_str).collect::<Vec<_>>()),
        };
        let selected = selected.map_err(|why| errors::of_path(py, &why))?;
        let columns = selected.names().len();
        let [positions, velocities, accelerations] = py.detach(|| {
            let mut rows = [(); 3].map(|()| Vec::with_capacity(times.0.len() * columns));
            let mut sample = Default::default();
            for &time in &times.0 {
                selected.sample_into(time, &mut sample);
                rows[0].extend_from_slice(&sample.positions);
                rows[1].extend_from_slice(&sample.velocities);
                rows[2].extend_from_slice(&sample.accelerations);
            }
            rows
        });
        Ok((matrix(py, positions, columns)?, matrix(py, velocities, columns)?, matrix(py, accelerations, columns)?))
    }

    /// Poses in the world of links (`part/link`) or parts (`part`: its root link) at times: an array of shape (times, names, 7), x, y, z in metres and the
    /// quaternion x, y, z, w.
    fn poses<'py>(&self, py: Python<'py>, names: Vec<String>, times: Numbers) -> PyResult<Array<'py>> {
        let trajectory = self.trajectory(py)?;
        let links = names.iter().map(|name| trajectory.link(name)).collect::<Result<Vec<_>, _>>();
        let links = links.map_err(|why| errors::of_path(py, &why))?;
        let numbers = py.detach(|| {
            let mut poses = trajectory.poses();
            let mut numbers = Vec::with_capacity(times.0.len() * links.len() * 7);
            for &time in &times.0 {
                poses.place(time);
                links.iter().for_each(|&link| numbers.extend_from_slice(&pose_to_array(&poses.link(link))));
            }
            numbers
        });
        blocks(py, numbers, [times.0.len(), names.len(), 7])
    }

    /// How close any two tested shapes that move against each other are at times (seconds; clamped to the path), without `times` at the knots: an array of
    /// shape (times,), metres, 0 where they meet. In a path without times a unit of length takes a second. Measured there; `min_clearance` is proved for what lies between too.
    #[pyo3(signature = (times = None))]
    fn clearances<'py>(&self, py: Python<'py>, times: Option<Numbers>) -> PyResult<Array<'py>> {
        let (robot, path) = (self.robot(), self.path());
        let measured = py.detach(|| {
            let interpolation = match &self.source {
                Source::Solved { .. } => Interpolation::Hermite,
                Source::Loaded { path, .. } => path.interpolation(),
            };
            let timed = TimedMotion::new(robot, path, interpolation);
            let names = vec![""; path.segments.len()];
            let trajectory = Trajectory::new(robot, &timed.path, names, timed.interpolation)?;
            let times = times.map_or_else(|| knot_times(&timed.path), |times| times.0);
            let own;
            let scene = match &self.source {
                Source::Solved { solution, .. } => &solution.model.collision,
                Source::Loaded { path, .. } => {
                    own = CollisionScene::new(robot, &PairRule { ignored: &path.ignored_pairs, ..PairRule::default() });
                    &own
                }
            };
            let mut nearest = trajectory.nearest_pairs(scene);
            let distance = |&time: &f64| nearest.at(time).map_or(f64::INFINITY, |nearest| nearest.distance);
            Ok(times.iter().map(distance).collect::<Vec<_>>())
        });
        measured.map(|measured| row(py, measured)).map_err(|why: TrajectoryError| errors::of_path(py, &why))
    }

    /// When hands take and let go, in the order of time.
    #[getter]
    fn events(&self, py: Python<'_>) -> PyResult<Vec<PyEvent>> {
        Ok(self.trajectory(py)?.events().into_iter().map(PyEvent::of).collect())
    }

    /// Writes the path file (`foliate.path/2`), which `check` and the command `foliate` read.
    fn save(&self, py: Python<'_>, out: PathBuf) -> PyResult<()> {
        let error = |why: foliate::path_file::PathFileError| errors::of_path(py, &why);
        match &self.source {
            Source::Solved { solution, scene, seed, scheduler } => {
                let search = (*seed, scheduler.as_str(), Level::default());
                solution.save(&scene.get().scene, search, &out).map_err(error)
            }
            Source::Loaded { file, .. } => save::save(&save::read(file).map_err(error)?, &out).map_err(error),
        }
    }

    /// A page that plays the path: its text, or, with `out`, the name of the file into which it is written.
    #[pyo3(signature = (out = None))]
    fn view(&self, py: Python<'_>, out: Option<PathBuf>) -> PyResult<String> {
        page::shown(py, &self.page(py)?, out)
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        self.framed(py)
    }

    fn __len__(&self) -> usize {
        self.path().segments.len()
    }

    fn __repr__(&self) -> String {
        let path = self.path();
        let knots: usize = path.segments.iter().map(|segment| segment.knots.len()).sum();
        let duration = path.duration().map_or(String::new(), |seconds| format!(", {seconds:.2} s"));
        format!("Path({} segments, {knots} knots{duration})", path.segments.len())
    }
}

/// When the knots are passed. The last knot of a segment is the first of the next one, and is there once.
fn knot_times(path: &ManipulationPath) -> Vec<f64> {
    let of_segment = |(number, segment): (usize, &Segment)| {
        let times = segment.timing.as_ref().map_or(&[][..], |timing| &timing.times);
        times[usize::from(number > 0).min(times.len())..].to_vec()
    };
    path.segments.iter().enumerate().flat_map(of_segment).collect()
}

/// One name, or several.
#[derive(FromPyObject)]
enum Names {
    One(String),
    Several(Vec<String>),
}

/// Reads a path file, of any version of Foliate that wrote one.
#[pyfunction]
#[pyo3(signature = (file, *, packages = Vec::new()))]
pub fn load_path(py: Python<'_>, file: PathBuf, packages: Vec<PathBuf>) -> PyResult<PyPath> {
    let packages = PackagePath::from_environment(&packages);
    let path = py.detach(|| LoadedPath::read(&file, &packages)).map_err(|why| errors::of_path(py, &why))?;
    Ok(PyPath { source: Source::Loaded { path: Arc::new(path), file } })
}
