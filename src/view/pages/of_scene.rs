//! The page of a scene before any search.

use crate::inspection::words::ShortNames;
use crate::scene::assemble::scene::Scene;
use crate::scene::reading::error::SceneError;
use crate::scene::visuals::Visuals;
use crate::view::document::finding::WhereEntry;
use crate::view::document::page::PageKind;
use crate::view::document::search::SearchEntry;
use crate::view::graph::grown::grow;
use crate::view::graph::picture::{PictureOptions, picture};
use crate::view::html::page::Page;
use crate::view::pages::base::{ViewOptions, base};
use crate::view::pages::findings::Placed;
use foliate_components::graph::StateId;
use foliate_components::infeasibility::Infeasibility;
use foliate_components::pose::pose_to_array;
use foliate_components::problem::{Goal, PartialGoal, Problem};
use foliate_components::robot::Source;
use foliate_kernels::collision::{CollisionScene, PairRule};
use foliate_systems::planning_model::state_classification::{reach_feasible, reach_start};
use foliate_systems::planning_model::{Model, ModelError, PlanningModel, ProblemTables};
use foliate_systems::settings::SearchSettings;
use std::sync::Arc;

/// The planning model of a scene.
///
/// # Errors
/// The problem has no constraint graph.
pub fn model_of_scene(scene: &Scene) -> Result<PlanningModel, ModelError> {
    let tables = Arc::new(ProblemTables::new(scene.problem.clone()));
    Ok(PlanningModel(Arc::new(Model::of(tables)?)))
}

/// The page of a scene: its parts and documents, start and goal, what keeps them from being so, and the constraint graph. `model` is the
/// problem's, where there is one ([`model_of_scene`]); the error is why there is none.
#[must_use]
pub fn page_of_scene(
    scene: &Scene,
    model: Result<PlanningModel, ModelError>,
    visuals: &Visuals,
    options: &ViewOptions,
) -> Page {
    let problem = &scene.problem;
    let supports = Some(problem.graph.supports.as_slice());
    let mut page = base((&problem.name, PageKind::Scene), &problem.robot, visuals, supports, options);
    scene.warnings.iter().map(SceneError::to_string).for_each(|warning| page.warn(warning));
    if !scene.description.is_empty() {
        page.tell("scene", &scene.description);
    }
    page.document.start = Some(problem.start.clone());
    let goal = problem.goals.first().map(|goal| shown_goal(problem, goal));
    if let (Some(Goal::Partial(_)), Some(_)) = (problem.goals.first(), &goal) {
        page.tell("goal", "says only where some things shall be; the rest is shown as at the start");
    }
    if problem.goals.len() > 1 {
        page.tell("goals", format!("{}; the first is shown", problem.goals.len()));
    }
    page.document.goal = goal;
    match model {
        Ok(model) => add_model(&mut page, model, problem),
        Err(error) => {
            page.warn(format!("there is no constraint graph: {error}"));
            let rule = PairRule { ignored: &problem.ignored_pairs, margins: &problem.margins, locked: &[] };
            let collision = CollisionScene::new(&problem.robot, &rule);
            let placed = Placed::new(&problem.robot, &collision, &problem.start, WhereEntry::Named("start"));
            page.document.collisions = placed.collisions();
        }
    }
    page
}

/// A configuration that shows a goal: itself, or the start with what the goal names.
fn shown_goal(problem: &Problem, goal: &Goal) -> Vec<f64> {
    let goal = match goal {
        Goal::Configuration(q) => return q.clone(),
        Goal::Partial(goal) => goal,
    };
    let PartialGoal { poses, coordinates, .. } = goal;
    let mut q = problem.start.clone();
    for (part, pose) in poses {
        let root = problem.robot.parts[part.at()].root_joint.map(|root| problem.robot.joints[root.at()].source);
        if let Some(Source::Coordinates { q: first, .. }) = root
            && let Some(numbers) = q.get_mut(first..first + 7)
        {
            numbers.copy_from_slice(&pose_to_array(pose));
        }
    }
    for &(index, value) in coordinates {
        if let Some(number) = q.get_mut(index) {
            *number = value;
        }
    }
    q
}

/// Adds what is wrong with start and goals, and the graph.
fn add_model(page: &mut Page, mut model: PlanningModel, problem: &Problem) {
    let settings = SearchSettings::default();
    // An infeasible start may lie in a state all the same: the graph begins there.
    let start = model.reach(&problem.start, settings.classification_tolerance);
    let mut around: Vec<StateId> = start.into_iter().collect();
    let at = |name| WhereEntry::Named(name);
    let infeasible = reach_start(&mut model, &settings, &problem.start).err();
    match &infeasible {
        None => {}
        Some(why) if problem.start.len() == problem.robot.space.size() => {
            let placed = Placed::new(&problem.robot, &model.collision, &problem.start, at("start"));
            placed.tell(why, &mut page.document);
        }
        Some(why) => page.warn(format!("the start is infeasible: {why}")),
    }
    for (number, goal) in problem.goals.iter().enumerate() {
        let Goal::Configuration(q) = goal else { continue };
        match reach_feasible(&mut model, &settings, q) {
            Ok(root) => around.push(root.state),
            Err(why) if q.len() == problem.robot.space.size() => {
                let at = if number == 0 { at("goal") } else { WhereEntry::Numbers(q.clone()) };
                let placed = Placed::new(&problem.robot, &model.collision, q, at);
                placed.tell(&why, &mut page.document);
            }
            Err(why) => page.warn(format!("goal {number} is infeasible: {why}")),
        }
    }
    if let (true, Some(&start)) = (model.graph.lazy, around.first()) {
        grow(&mut model, start);
    }
    if model.graph.lazy && around.is_empty() {
        let why = match infeasible {
            Some(Infeasibility::WrongLength { .. } | Infeasibility::NotFinite { .. }) => "is no configuration",
            _ => "lies in no state",
        };
        page.warn(format!("the constraint graph is large and grows from the start, which {why}: none is shown"));
        return;
    }
    around.sort_unstable();
    around.dedup();
    let options = PictureOptions { around, ..PictureOptions::default() };
    page.document.graph = Some(picture(&model.graph, &ShortNames::of(&problem.robot, &model.graph), &options));
}

impl Page {
    /// Makes it the page of a search: adds what the search did. Its arrays are in the page's blob, and its transitions are those of the
    /// page's graph.
    pub fn add_search(&mut self, search: SearchEntry) {
        self.document.kind = PageKind::Search;
        self.document.search = Some(search);
    }
}
