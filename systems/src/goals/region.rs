//! One goal that leaves something free: the states in which it may lie, and the draws of configurations in them.
//!
//! Tries run in batches of a fixed size, each with a random stream of its own, so that what is found does not depend on the
//! number of threads.

use crate::events::StopSignal;
use crate::goals::demands;
use crate::goals::overlaps::overlapping;
use crate::goals::programs::{GoalProgram, put_fingers, put_near, validate};
use crate::planning_model::model::{Model, PlanningModel};
use crate::planning_model::state_classification;
use crate::planning_model::state_classification::Feasible;
use crate::runtime::random::{Purpose, stream};
use crate::settings::SearchSettings;
use foliate_components::Pose;
use foliate_components::graph::StateId;
use foliate_components::outcome::GoalStatistics;
use foliate_components::problem::PartialGoal;
use foliate_components::robot::ShapeIndex;
use foliate_kernels::collision::CollisionScratch;
use foliate_kernels::constrained_motion::{Scratch, Settings, project};
use rand::RngExt;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Tries that run side by side; part of the answer, so never derived from the number of threads.
const BATCH: usize = 16;

/// Every how many tries in a state objects on supports may stand elsewhere than in the start.
const MOVED_EVERY: u32 = 4;

/// Failed tries in a state of a lazy graph before its neighbours are tried too.
const PATIENCE: u32 = 8;

/// States of a lazy graph in which a goal is looked for at most.
const MOST_SITES: usize = 1024;

/// Failed tries after which the objects are compared that a goal gives poses.
const FRUITLESS: u32 = 64;

/// Contradictions that a message lists.
pub(crate) const MOST_TOLD: usize = 3;

/// One such goal.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    /// Its number in the problem.
    pub(crate) number: usize,
    goal: PartialGoal,
    /// Why it cannot be sampled at all.
    pub(crate) malformed: Option<String>,
    /// Objects that are in each other where the goal has them, in words; found when the first tries have failed.
    pub(crate) overlap: Option<String>,
    pub(crate) sites: Vec<Site>,
    /// States that no transitions join to the start's.
    pub(crate) leaves_out: usize,
    /// Sites from the front whose neighbours are sites too; all of them, where the graph is whole.
    widened: usize,
    /// The site of the next try.
    turn: usize,
    /// Tries so far, those in states that turned out to contradict the goal not counted.
    pub(crate) tries: u32,
    /// Numbers given to tries; each has a random stream of its own.
    numbered: u32,
    /// Whether the objects have been compared that the goal gives poses.
    compared: bool,
    /// What has been found already.
    known: Vec<Vec<f64>>,
}

/// A state in which a goal may lie.
#[derive(Clone, Debug)]
pub(crate) struct Site {
    state: StateId,
    tries: u32,
    /// Programs with objects where the start has them, as far as that is possible, and with those on supports anywhere.
    standing: OnceLock<Result<GoalProgram, String>>,
    moved: OnceLock<Result<GoalProgram, String>>,
}

/// How a try ended.
enum Try {
    Found(Feasible),
    /// In a state of a lazy graph that has not come into being.
    Unreached(Vec<f64>),
    ProjectionFailed,
    Collides(ShapeIndex, ShapeIndex),
    Refused,
    Contradicted,
    Stopped,
}

impl Region {
    pub(crate) fn new(model: &Model, number: usize, goal: &PartialGoal, may_reach: &impl Fn(StateId) -> bool) -> Self {
        let malformed = validate(model, goal).err();
        let states = || model.graph.states_of_nodes().map(|(state, _)| state);
        let sites: Vec<_> = states().filter(|&state| may_reach(state)).map(Site::new).collect();
        let leaves_out = states().count() - sites.len();
        let widened = if model.graph.lazy { 0 } else { sites.len() };
        Self {
            number,
            goal: goal.clone(),
            malformed,
            overlap: None,
            sites,
            leaves_out,
            widened,
            turn: 0,
            tries: 0,
            numbered: 0,
            compared: false,
            known: Vec::new(),
        }
    }

    pub(crate) fn is_possible(&self) -> bool {
        self.malformed.is_none()
            && self.overlap.is_none()
            && (self.can_be_widened() || self.sites.iter().any(Site::is_possible))
    }

    fn can_be_widened(&self) -> bool {
        self.widened < self.sites.len() && self.sites.len() < MOST_SITES
    }

    /// Adds the neighbours of the next state to the sites.
    fn widen(&mut self, model: &mut PlanningModel) {
        let state = self.sites[self.widened].state;
        self.widened += 1;
        model.expand(state);
        for (_, transition) in model.graph.leaving(state) {
            if self.sites.len() < MOST_SITES && self.sites.iter().all(|site| site.state != transition.to) {
                self.sites.push(Site::new(transition.to));
            }
        }
    }

    pub(crate) fn draw(
        &mut self,
        model: &mut PlanningModel,
        settings: &SearchSettings,
        stop: &StopSignal,
        start: &[f64],
        tries: u32,
        statistics: &mut GoalStatistics,
    ) -> Vec<Feasible> {
        let last = self.tries.saturating_add(tries).min(settings.goal_tries);
        let mut found: Vec<Feasible> = Vec::new();
        while found.len() < settings.goal_samples && self.tries < last && self.is_possible() && !stop.is_raised() {
            let patient = |site: &Site| site.is_possible() && site.tries < PATIENCE;
            if found.is_empty() && self.can_be_widened() && !self.sites.iter().any(patient) {
                self.widen(model);
                continue;
            }
            if !self.sites.iter().any(Site::is_possible) {
                break;
            }
            if self.known.is_empty() && self.tries >= FRUITLESS && !std::mem::replace(&mut self.compared, true) {
                self.overlap = overlapping(model, settings, &self.goal, start);
                continue;
            }
            let batch = self.next_batch(BATCH.min((last - self.tries) as usize));
            let here = &*model;
            let ends: Vec<Try> = batch
                .par_iter()
                .map_init(TryScratch::default, |scratch, &(site, round, number)| {
                    let stream = (self.number, number);
                    self.attempt(here, settings, stop, start, (&self.sites[site], round), stream, scratch)
                })
                .collect();
            for end in ends {
                let end = match end {
                    Try::Unreached(q) => {
                        model.reach(&q, settings.classification_tolerance);
                        judge(model, settings, &self.goal, &q, &mut TryScratch::default())
                    }
                    end => end,
                };
                if !matches!(end, Try::Contradicted | Try::Stopped) {
                    self.tries += 1;
                    statistics.tries += 1;
                }
                match end {
                    Try::Found(goal) if found.len() < settings.goal_samples && !self.known.contains(&goal.q) => {
                        statistics.found += 1;
                        self.known.push(goal.q.clone());
                        found.push(goal);
                    }
                    Try::ProjectionFailed => statistics.projection_failed += 1,
                    Try::Collides(a, b) => *statistics.blocked_by.entry((a, b)).or_default() += 1,
                    Try::Refused | Try::Unreached(_) => statistics.refused += 1,
                    Try::Found(_) | Try::Contradicted | Try::Stopped => {}
                }
            }
        }
        found
    }

    /// The sites of the next tries in turn, the round of each, and the number of the try.
    fn next_batch(&mut self, size: usize) -> Vec<(usize, u32, u32)> {
        let mut batch = Vec::with_capacity(size);
        while batch.len() < size {
            let site = self.turn;
            self.turn = (self.turn + 1) % self.sites.len();
            if self.sites[site].is_possible() {
                batch.push((site, self.sites[site].tries, self.numbered));
                self.sites[site].tries += 1;
                self.numbered = self.numbered.wrapping_add(1);
            }
        }
        batch
    }

    #[allow(clippy::too_many_arguments, reason = "what a try reads, and nothing else")]
    fn attempt(
        &self,
        model: &PlanningModel,
        settings: &SearchSettings,
        stop: &StopSignal,
        start: &[f64],
        (site, round): (&Site, u32),
        (goal, number): (usize, u32),
        scratch: &mut TryScratch,
    ) -> Try {
        if stop.is_raised() {
            return Try::Stopped;
        }
        let compile = |supported_too| GoalProgram::new(model, settings, &self.goal, start, site.state, supported_too);
        let standing = site.standing.get_or_init(|| compile(true));
        let moved = || site.moved.get_or_init(|| compile(false)).as_ref().ok();
        let Ok(program) = standing else { return Try::Contradicted };
        let program = match round % MOVED_EVERY == MOVED_EVERY - 1 {
            true => moved().unwrap_or(program),
            false => program,
        };
        let mut q = start.to_vec();
        // The first try in a state changes no more than it has to.
        if round > 0 {
            let mut rng = stream(settings.seed, Purpose::GOAL, goal as u64, number);
            model.problem.robot.space.random(&mut rng, &mut q);
            model.lock(&mut q);
            if rng.random::<f64>() < settings.still_probability {
                program.idle.iter().for_each(|&index| q[index] = start[index]);
            }
            put_near(model, &self.goal, &mut q, || Some(rng.random::<f64>()));
        } else {
            put_near(model, &self.goal, &mut q, || None);
        }
        let solve = Settings {
            tolerance: settings.projection_tolerance,
            iterations: settings.projection_iterations,
            ..Settings::default()
        };
        if !project(&program.program, &mut q, &[], &solve, &mut scratch.newton).is_converged() {
            return Try::ProjectionFailed;
        }
        put_fingers(model, &self.goal, &mut q);
        if state_classification::is_unreached(model, &q, settings.classification_tolerance) {
            return Try::Unreached(q);
        }
        judge(model, settings, &self.goal, &q, scratch)
    }
}

impl Site {
    fn new(state: StateId) -> Self {
        Self { state, tries: 0, standing: OnceLock::new(), moved: OnceLock::new() }
    }

    /// Whether it is not known to contradict the goal.
    fn is_possible(&self) -> bool {
        self.contradiction().is_none()
    }

    pub(crate) fn contradiction(&self) -> Option<&String> {
        self.standing.get().and_then(|program| program.as_ref().err())
    }
}

/// Buffers of a try.
#[derive(Default)]
struct TryScratch {
    newton: Scratch,
    collision: Option<CollisionScratch>,
    X_WJ: Vec<Pose>,
}

/// Whether a configuration may be a goal.
fn judge(
    model: &PlanningModel,
    settings: &SearchSettings,
    goal: &PartialGoal,
    q: &[f64],
    scratch: &mut TryScratch,
) -> Try {
    match state_classification::feasible(model, settings, q) {
        Ok(found) if is_met(model, goal, &found) => Try::Found(found),
        Ok(_) => Try::Refused,
        Err(_) => what_collides(model, settings, q, scratch),
    }
}

/// Whether a configuration is a goal also by what is no row of a constraint: its state need not be that of the try.
fn is_met(model: &PlanningModel, goal: &PartialGoal, found: &Feasible) -> bool {
    demands::fit(model, goal, found.state).is_ok()
        && demands::are_met(model, goal, found.state, found.given.as_ref().unwrap_or(&found.q))
}

/// The pair that collides in a configuration that may be no goal, or that it is refused for another reason.
fn what_collides(model: &Model, settings: &SearchSettings, q: &[f64], scratch: &mut TryScratch) -> Try {
    if model.problem.robot.space.first_out_of_bounds(q, 1e-9).is_some() {
        return Try::Refused;
    }
    scratch.X_WJ.resize(model.kinematics.bodies(), Pose::identity());
    model.kinematics.forward(q, &mut scratch.X_WJ);
    let Some(state) = state_classification::state_of(model, q, &scratch.X_WJ, settings.classification_tolerance) else {
        return Try::Refused;
    };
    let collision = scratch.collision.get_or_insert_with(|| CollisionScratch::at_level(settings.level));
    match model.first_collision(state, &scratch.X_WJ, settings.clearance_guard, collision) {
        Some(contact) => {
            let (a, b) = model.pair_shapes(contact.pair);
            Try::Collides(a, b)
        }
        None => Try::Refused,
    }
}
