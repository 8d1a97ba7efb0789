//! Solves one problem: scene, tables, search, and what the independent checker says.

use crate::motionbenchmaker::scene::WrittenScene;
use foliate::check::{CheckOptions, SceneChoice, Verdict, check};
use foliate::path_file::{PathContext, save, write_path};
use foliate::scene::{PackagePath, Scene};
use foliate::{NoSolutionReason, Planner, Solution};
use foliate_kernels::lanes::Level;
use foliate_systems::planning_model::{Model, PlanningModel, ProblemTables};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What is asked of every problem.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Of a search, wall time.
    pub time_limit: Duration,
    /// Where path files go, if they are wanted.
    pub paths: Option<PathBuf>,
    /// Whether each path is proved again by the independent checker.
    pub check: bool,
}

/// A solve.
#[derive(Clone, Debug)]
pub struct Row {
    /// The set of the problem.
    pub set: String,
    /// The number of the problem in its set.
    pub index: u64,
    /// Seed of the search.
    pub seed: u64,
    /// `solved`, or the name of the reason.
    pub outcome: &'static str,
    /// Why start or goal are infeasible.
    pub detail: String,
    /// From the scene file to the problem, its robot's meshes included.
    pub load: Duration,
    /// From the problem to the model: tables of pairs of shapes, constraint graph.
    pub prepare: Duration,
    /// From the model to the answer, which is certified.
    pub solve: Duration,
    /// Candidates of the search.
    pub candidates: u64,
    /// Of the path's certificate: whether its residual is within the tolerance, and no tested pair touches.
    pub is_certified: bool,
    /// What the independent checker says, where it was asked.
    pub verdict: Option<&'static str>,
}

impl Row {
    /// Whether a path was found.
    #[must_use]
    pub fn is_solved(&self) -> bool {
        self.outcome == "solved"
    }

    /// Whether start or goal cannot be planned from.
    #[must_use]
    pub fn is_infeasible(&self) -> bool {
        self.outcome.starts_with("infeasible")
    }
}

/// A problem, ready to be solved.
pub struct Ready {
    scene: Scene,
    model: PlanningModel,
    path: PathBuf,
    load: Duration,
    prepare: Duration,
}

impl Ready {
    /// Loads the scene of a problem and builds its model.
    ///
    /// # Errors
    /// The scene cannot be read, or it makes no model.
    pub fn new(written: &WrittenScene, packages: &PackagePath) -> Result<Self, String> {
        let started = Instant::now();
        let scene = Scene::from_file(&written.path, packages).map_err(|error| error.to_string())?;
        let (load, started) = (started.elapsed(), Instant::now());
        let tables = Arc::new(ProblemTables::new(scene.problem.clone()));
        let model = Model::of(tables).map_err(|error| format!("{}: {error}", written.path.display()))?;
        let model = PlanningModel(Arc::new(model));
        Ok(Self { scene, model, path: written.path.clone(), load, prepare: started.elapsed() })
    }

    /// Solves on the caller's pool of threads.
    ///
    /// # Errors
    /// A path cannot be written or checked.
    pub fn solve(
        &self,
        (set, index, seed): (&str, u64, u64),
        settings: &Settings,
        packages: &PackagePath,
    ) -> Result<Row, String> {
        let planner = Planner::from_model(self.model.clone()).seed(seed).first_path().time_limit(settings.time_limit);
        let started = Instant::now();
        let answer = planner.solve();
        let solve = started.elapsed();
        let mut row = Row {
            set: set.into(),
            index,
            seed,
            outcome: "solved",
            detail: String::new(),
            load: self.load,
            prepare: self.prepare,
            solve,
            candidates: 0,
            is_certified: false,
            verdict: None,
        };
        match answer {
            Ok(solution) => {
                let certificate = solution.certificate();
                row.is_certified = certificate.max_residual <= certificate.path_tolerance
                    && certificate.min_clearance.is_none_or(|clearance| clearance >= 0.0);
                row.candidates = solution.report.candidates;
                row.verdict = self.kept(&solution, seed, settings, packages)?;
            }
            Err(no) => {
                row.outcome = no.reason.name();
                row.candidates = no.report.candidates;
                row.detail = no.reason.detail().unwrap_or_default();
                if let NoSolutionReason::Crashed(why) = &no.reason {
                    return Err(format!("{}: the search crashed: {}", self.path.display(), why.escape_debug()));
                }
            }
        }
        Ok(row)
    }

    /// Writes and checks the path, as far as that is asked for.
    fn kept(
        &self,
        solution: &Solution,
        seed: u64,
        settings: &Settings,
        packages: &PackagePath,
    ) -> Result<Option<&'static str>, String> {
        if settings.paths.is_none() && !settings.check {
            return Ok(None);
        }
        let folder = settings.paths.as_deref().or(self.path.parent()).unwrap_or(Path::new("."));
        let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
        let out = folder.join(format!("{stem}-{seed}.json"));
        let of_file = |error: String| format!("{}: {error}", out.display());
        let models = save::model_names(&self.scene, &out).map_err(|error| of_file(error.to_string()))?;
        let context = PathContext {
            problem: &solution.model.problem,
            graph: &solution.model.graph,
            models: &models,
            seed,
            scheduler: foliate::schedulers::DEFAULT,
            simd: Level::detected().name(),
        };
        let file = write_path(&context, &solution.path);
        save::save(&file, &out).map_err(|error| of_file(error.to_string()))?;
        if !settings.check {
            return Ok(None);
        }
        let scene = SceneChoice::Given(self.path.to_string_lossy().into_owned());
        let options = CheckOptions { scene, time_limit: Some(Duration::from_secs(60)), ..CheckOptions::default() };
        let report = check(&file, folder, packages, &options).map_err(|error| of_file(error.to_string()))?;
        if settings.paths.is_none() {
            std::fs::remove_file(&out).map_err(|error| of_file(error.to_string()))?;
        }
        Ok(Some(match report.verdict() {
            Verdict::Proved => "proved",
            Verdict::Undecided => "undecided",
            Verdict::Refused => "refused",
            Verdict::Relative(_) => "relative",
        }))
    }
}
