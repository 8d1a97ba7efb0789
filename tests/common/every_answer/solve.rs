//! From a scene file to a path file, as `foliate solve` does it, but with a budget of steps instead of seconds.

use foliate::components::path::ManipulationPath;
use foliate::path_file::{PathContext, PathFile, save, write_path};
use foliate::scene::{PackagePath, Scene};
use foliate::systems::planning_model::PlanningModel;
use foliate::systems::settings::SearchSettings;
use foliate::{NoSolutionReason, Planner};
use std::path::{Path, PathBuf};

/// Steps of sixteen candidates after which a problem counts as too hard.
const STEPS: u64 = 120;
/// Tries for a goal that leaves something free.
const GOAL_TRIES: u32 = 256;

/// A path as it was written, and what it was planned on.
pub struct Answer {
    pub out: PathBuf,
    pub bytes: Vec<u8>,
    pub path: ManipulationPath,
    pub file: PathFile,
    pub model: PlanningModel,
}

/// How a solve ended.
pub enum Ended {
    Refused(String),
    Infeasible(String),
    Unsolved,
    Solved(Box<Answer>),
}

/// Which path is wanted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// The first one, without times.
    First,
    /// An improved one with times.
    Timed,
}

/// Loads, solves and writes. An error is something that a solve must never do.
pub fn solve(
    scene_file: &Path,
    wanted: Wanted,
    (scheduler, seed): (&str, u64),
    threads: usize,
    out: &Path,
) -> Result<Ended, String> {
    let scene = match Scene::load(&scene_file.to_string_lossy(), &PackagePath::only(&[])) {
        Ok(scene) => scene,
        Err(error) => return Ok(Ended::Refused(error.to_string())),
    };
    let planner = match Planner::new(scene.problem.clone()) {
        Ok(planner) => planner,
        Err(error) => return Ok(Ended::Refused(error.to_string())),
    };
    let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps, s.goal_tries) = (seed, STEPS, GOAL_TRIES));
    let planner = planner.settings(settings).scheduler_named(scheduler).expect("a shipped scheduler");
    let planner = match wanted {
        Wanted::First => planner.first_path(),
        Wanted::Timed => planner.improve_work(1000),
    };
    match planner.solve_on(threads).map_err(|none| none.reason) {
        Ok(solution) => write(&scene, solution.model, scheduler, seed, solution.path, out),
        Err(NoSolutionReason::InfeasibleStart(why)) => Ok(Ended::Infeasible(format!("start: {why}"))),
        Err(NoSolutionReason::InfeasibleGoal(why)) => Ok(Ended::Infeasible(format!("goal: {why}"))),
        Err(reason @ (NoSolutionReason::NoPath | NoSolutionReason::Threads { .. })) => {
            Err(format!("outcome: {reason}"))
        }
        Err(_) => Ok(Ended::Unsolved),
    }
}

fn write(
    scene: &Scene,
    model: PlanningModel,
    scheduler: &str,
    seed: u64,
    path: ManipulationPath,
    out: &Path,
) -> Result<Ended, String> {
    let models = save::model_names(scene, out).map_err(|e| format!("write: {e}"))?;
    let context = PathContext {
        problem: &model.problem,
        graph: &model.graph,
        models: &models,
        seed,
        scheduler,
        simd: foliate::kernels::lanes::Level::detected().name(),
    };
    let file = write_path(&context, &path);
    save::save(&file, out).map_err(|e| format!("write: {e}"))?;
    let bytes = std::fs::read(out).map_err(|e| format!("write: {e}"))?;
    Ok(Ended::Solved(Box::new(Answer { out: out.to_owned(), bytes, path, file, model })))
}
