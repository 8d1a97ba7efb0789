//! The page of a path.

use crate::check::{CheckError, CheckReport};
use crate::inspection::words::ShortNames;
use crate::path_file::document::PathFile;
use crate::path_file::loaded_path::LoadedPath;
use crate::planner::answer::Solution;
use crate::planner::trajectory::curve::Interpolation;
use crate::planner::trajectory::error::TrajectoryError;
use crate::planner::trajectory::own_times::TimedMotion;
use crate::planner::trajectory::trajectory::Trajectory;
use crate::scene::assemble::scene::Scene;
use crate::scene::reading::error::SceneError;
use crate::scene::visuals::Visuals;
use crate::view::document::page::PageKind;
use crate::view::document::path::PathEntry;
use crate::view::geometry::blob::Blob;
use crate::view::graph::grown::{grown_graph, passed};
use crate::view::graph::picture::{PictureOptions, picture};
use crate::view::html::page::Page;
use crate::view::motion::clearance::{clearance, leaves_out};
use crate::view::motion::refusals::refusals;
use crate::view::motion::sampling::samples;
use crate::view::motion::segments::{GraphPlaces, events, segments};
use crate::view::pages::base::{ViewOptions, approach_as_in, base};
use foliate_components::graph::{ConstraintGraph, StateId};
use foliate_components::path::ManipulationPath;
use foliate_components::robot::Robot;
use foliate_kernels::collision::{CollisionScene, PairRule};
use std::collections::HashSet;

/// A path with the names of its segments' states and transitions.
pub(crate) struct Told<'a> {
    robot: &'a Robot,
    path: &'a ManipulationPath,
    interpolation: Interpolation,
    states: Vec<&'a str>,
    transitions: Vec<String>,
}

impl<'a> Told<'a> {
    pub fn of_loaded(path: &'a LoadedPath) -> Self {
        Self {
            robot: &path.robot,
            path: &path.path,
            interpolation: path.interpolation(),
            states: path.states().iter().map(String::as_str).collect(),
            transitions: path.transitions().to_vec(),
        }
    }
}

/// The page of a path file.
///
/// `scene` is the scene that it answers, where that can be read: it gives the constraint graph; without it the graph has only what the path
/// passes. `report` is what a check says, where it was asked.
///
/// # Errors
/// The path makes no trajectory.
pub fn page_of_path(
    (file, path): (&PathFile, &LoadedPath),
    scene: Option<&Scene>,
    report: Option<&Result<CheckReport, CheckError>>,
    visuals: &Visuals,
    options: &ViewOptions,
) -> Result<Page, TrajectoryError> {
    let robot = &path.robot;
    let mut page = base((&file.scene, PageKind::Path), robot, visuals, None, options);
    approach_as_in(&mut page, scene.map(|scene| &scene.problem.robot));
    path.warnings.iter().map(SceneError::to_string).for_each(|warning| page.warn(warning));
    page.tell("scheduler", &file.scheduler);
    page.tell("seed", file.seed.to_string());
    let whole = scene.and_then(|scene| grown_graph(&scene.problem).ok());
    let whole = whole.filter(|graph| {
        let known: HashSet<&str> = graph.transitions.iter().map(|transition| transition.name.as_str()).collect();
        path.transitions().iter().all(|name| known.contains(name.as_str()))
    });
    if whole.is_none() {
        page.warn("the constraint graph has only the states and transitions that the path passes");
    }
    let graph = whole.unwrap_or_else(|| passed(path));
    let told = Told::of_loaded(path);
    let collision = CollisionScene::new(robot, &PairRule { ignored: &path.ignored_pairs, ..PairRule::default() });
    add_motion(&mut page, &told, &graph, &collision)?;
    if let Some(checked) = report {
        add_verdict(&mut page, checked, &told)?;
    }
    Ok(page)
}

/// The page of an answer.
///
/// # Errors
/// The path makes no trajectory.
pub fn page_of_solution(
    solution: &Solution,
    visuals: &Visuals,
    options: &ViewOptions,
) -> Result<Page, TrajectoryError> {
    let (model, path) = (&solution.model, &solution.path);
    let problem = &model.problem;
    let supports = Some(problem.graph.supports.as_slice());
    let mut page = base((&problem.name, PageKind::Path), &problem.robot, visuals, supports, options);
    let graph = &model.graph;
    let transition = |segment: &foliate_components::path::Segment| graph.transition(segment.transition).name.clone();
    let told = Told {
        robot: &problem.robot,
        path,
        interpolation: Interpolation::Hermite,
        states: path.segments.iter().map(|segment| graph.state(segment.state).name.as_str()).collect(),
        transitions: path.segments.iter().map(transition).collect(),
    };
    add_motion(&mut page, &told, graph, &model.collision)?;
    page.count_tries(&solution.report.funnel);
    Ok(page)
}

/// Adds the motion, its ends as ghosts, and the graph that it passes through.
pub(crate) fn add_motion(
    page: &mut Page,
    told: &Told<'_>,
    graph: &ConstraintGraph,
    collision: &CollisionScene,
) -> Result<(), TrajectoryError> {
    fits(told.path)?;
    let short = ShortNames::of(told.robot, graph);
    let around = path_states(graph, told);
    let picture = picture(graph, &short, &PictureOptions { around, ..PictureOptions::default() });
    let mut places = GraphPlaces::default();
    places.states.extend(picture.states.iter().enumerate().map(|(place, state)| (state.name.clone(), place)));
    let transitions = picture.transitions.iter().enumerate();
    places.transitions.extend(transitions.map(|(place, transition)| (transition.name.clone(), place)));
    places.waypoints.extend(picture.transitions.iter().map(|transition| transition.waypoints.clone()));
    let timed = TimedMotion::new(told.robot, told.path, told.interpolation);
    let trajectory = Trajectory::new(told.robot, &timed.path, told.states.clone(), timed.interpolation)?;
    if !is_f32(trajectory.duration()) {
        return Err(TrajectoryError::Malformed { segment: told.path.segments.len() - 1, message: TOO_LARGE });
    }
    let samples = samples(&trajectory)?;
    if let Some(number) = samples.configurations.iter().position(|q| !q.iter().copied().all(is_f32)) {
        let segment = trajectory.moment(trajectory.start() + samples.times[number]).segment;
        return Err(TrajectoryError::Malformed { segment, message: TOO_LARGE });
    }
    let document = &mut page.document;
    document.start = samples.configurations.first().cloned();
    document.goal = samples.configurations.last().cloned();
    document.graph = Some(picture);
    let blob: &mut Blob = &mut page.blob;
    document.path = Some(PathEntry {
        timed: timed.is_own,
        duration: trajectory.duration(),
        times: blob.floats(samples.times.iter().map(|&time| time as f32)),
        configurations: blob.floats(samples.configurations.iter().flatten().map(|&x| x as f32)),
        samples: samples.times.len(),
        deviation: samples.deviation,
        velocities: timed.is_own.then(|| {
            let mut rates = vec![0.0; told.robot.space.dimension()];
            let start = trajectory.start();
            blob.floats(samples.times.iter().flat_map(|time| {
                trajectory.velocity(start + time, &mut rates);
                rates.iter().map(|&x| x as f32).collect::<Vec<_>>()
            }))
        }),
        segments: segments(&trajectory, &told.transitions, &places, &short),
        events: events(&trajectory, &short),
        clearance: clearance(&trajectory, collision, blob),
        verdict: None,
        refused: Vec::new(),
    });
    if leaves_out(told.robot, collision) {
        page.warn("the clearance leaves out the boxes that stand for meshes that cannot be read");
    }
    Ok(())
}

const TOO_LARGE: &str =
    "its times, or numbers of its motion, are too large for a page: they are written in single precision";

fn is_f32(x: f64) -> bool {
    (x as f32).is_finite()
}

/// Refuses numbers that a page cannot hold.
fn fits(path: &ManipulationPath) -> Result<(), TrajectoryError> {
    let is_fit = |segment: &foliate_components::path::Segment| {
        let rates = segment.timing.iter().flat_map(|timing| timing.velocities.iter());
        segment.knots.iter().chain(rates).flatten().copied().all(is_f32)
    };
    match path.segments.iter().position(|segment| !is_fit(segment)) {
        Some(segment) => Err(TrajectoryError::Malformed { segment, message: TOO_LARGE }),
        None => Ok(()),
    }
}

/// The states of the graph that a path is in, and those that its transitions join.
fn path_states(graph: &ConstraintGraph, told: &Told<'_>) -> Vec<StateId> {
    let transitions: HashSet<&str> = told.transitions.iter().map(String::as_str).collect();
    let of = |transition: &foliate_components::graph::Transition| [transition.from, transition.to];
    let mut states: Vec<StateId> =
        graph.transitions.iter().filter(|t| transitions.contains(t.name.as_str())).flat_map(of).collect();
    states.sort_unstable();
    states.dedup();
    states
}

/// Adds what a check says.
fn add_verdict(
    page: &mut Page,
    checked: &Result<CheckReport, CheckError>,
    told: &Told<'_>,
) -> Result<(), TrajectoryError> {
    let Some(entry) = &mut page.document.path else { return Ok(()) };
    match checked {
        Ok(report) => {
            let timed = TimedMotion::new(told.robot, told.path, told.interpolation);
            let trajectory = Trajectory::new(told.robot, &timed.path, told.states.clone(), timed.interpolation)?;
            entry.verdict = Some(report.verdict().name().to_owned());
            entry.refused = refusals(report, &trajectory);
            let weaker = report.weaker.clone();
            weaker.into_iter().for_each(|why| page.warn(why));
        }
        Err(error) => page.warn(format!("the path is not checked: {error}")),
    }
    Ok(())
}
