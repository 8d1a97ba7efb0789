//! Goals that leave something free: configurations for them are drawn, at the start and again during the search.
//!
//! For every state of the graph one program says what holds in a goal of that state: what the state demands, what the goal
//! demands, and that objects which neither moves stay where the start has them. Nobody follows anybody by decree: a held
//! object whose pose the goal leaves free is eliminated and follows the hand, one whose pose the goal names makes the hand
//! follow. A state whose program contradicts itself whatever the free joints do (it wants the object on the table, the
//! goal wants it in the air) is never tried again. The others are tried in turn, from random configurations. In a lazy graph
//! these are the start's state, then its neighbours, then theirs, breadth first, as long as nothing is found.

pub(crate) mod programs;

use crate::commit;
use crate::conclusion::Roots;
use crate::events::StopSignal;
use crate::goals::programs::{GoalProgram, validate};
use crate::membership::{self, Feasible};
use crate::model::{Model, PlanningModel};
use crate::random::{Purpose, stream};
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Mut, Resource, World};
use foliate_components::Pose;
use foliate_components::graph::StateId;
use foliate_components::graph::leaf::{Leaf, LeafIndex};
use foliate_components::outcome::GoalStatistics;
use foliate_components::problem::{Goal, PartialGoal};
use foliate_components::roadmap::{NodeId, Roadmap};
use foliate_components::robot::ShapeIndex;
use foliate_kernels::collision::CollisionScratch;
use foliate_kernels::constrained_motion::{Scratch, Settings, project};
use rand::RngExt;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Tries before the first step, and at most as many as the settings allow in all.
const FIRST_TRIES: u32 = 512;

/// Tries in a later step.
const LATER_TRIES: u32 = 128;

/// Tries that run side by side; part of the answer, so never derived from the number of threads.
const BATCH: usize = 16;

/// Every how many tries in a state objects on supports may stand elsewhere than in the start.
const MOVED_EVERY: u32 = 4;

/// Tries in a state of a lazy graph, all in vain, before its neighbours are tried too.
const PATIENCE: u32 = 8;

/// States of a lazy graph in which a goal is looked for at most.
const MOST_SITES: usize = 1024;

/// Contradictions that a message lists.
const MOST_TOLD: usize = 3;

/// The goals of a search that leave something free, and how far each has been looked into.
#[derive(Clone, Debug, Default, Resource)]
pub struct GoalSampler {
    /// The start, from which what is not asked for is kept.
    start: Vec<f64>,
    regions: Vec<Region>,
    statistics: GoalStatistics,
    /// The step at which more configurations are drawn.
    next: u64,
}

/// One such goal.
#[derive(Clone, Debug)]
struct Region {
    /// Its number in the problem.
    number: usize,
    goal: PartialGoal,
    /// Why it cannot be sampled at all.
    malformed: Option<String>,
    sites: Vec<Site>,
    /// Sites from the front whose neighbours are sites too; all of them, where the graph is whole.
    widened: usize,
    /// The site whose turn it is.
    turn: usize,
    /// Tries so far, those in states that turned out to contradict the goal not counted.
    tries: u32,
    /// Numbers given to tries; each has a random stream of its own.
    numbered: u32,
    /// What has been found already.
    known: Vec<Vec<f64>>,
}

/// A state in which a goal may lie.
#[derive(Clone, Debug)]
struct Site {
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

impl GoalSampler {
    /// The partial goals of a problem, for a search that starts at `start`.
    #[must_use]
    pub fn new(model: &Model, settings: &SearchSettings, start: &[f64]) -> Self {
        let regions = model.problem.goals.iter().enumerate().filter_map(|(number, goal)| match goal {
            Goal::Configuration(_) => None,
            Goal::Partial(goal) => Some(Region::new(model, number, goal)),
        });
        Self {
            start: start.to_vec(),
            regions: regions.collect(),
            statistics: GoalStatistics::default(),
            next: settings.goal_interval,
        }
    }

    /// Whether the problem has no goal that leaves something free.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.regions.is_empty()
    }

    /// What became of the tries so far.
    #[must_use]
    pub fn statistics(&self) -> &GoalStatistics {
        &self.statistics
    }

    /// Why no partial goal will be sampled any more: all of them contradict themselves or have had their tries. `None`
    /// while one is open, and where the problem has no such goal.
    #[must_use]
    pub fn given_up(&self, model: &Model, settings: &SearchSettings) -> Option<String> {
        let is_open = |region: &Region| region.is_possible() && region.tries < settings.goal_tries;
        if self.regions.is_empty() || self.regions.iter().any(is_open) {
            return None;
        }
        let reasons: Vec<_> = self.regions.iter().map(|region| self.why(model, region)).collect();
        Some(reasons.join("; "))
    }

    /// The first tries, before the first step.
    pub fn draw_first(
        &mut self,
        model: &mut PlanningModel,
        settings: &SearchSettings,
        stop: &StopSignal,
    ) -> Vec<Feasible> {
        self.draw(model, settings, stop, FIRST_TRIES)
    }

    /// At most [`SearchSettings::goal_samples`] configurations of every goal, found in at most `tries` tries.
    fn draw(
        &mut self,
        model: &mut PlanningModel,
        settings: &SearchSettings,
        stop: &StopSignal,
        tries: u32,
    ) -> Vec<Feasible> {
        let mut found = Vec::new();
        let Self { start, regions, statistics, .. } = self;
        for region in regions {
            found.extend(region.draw(model, settings, stop, start, tries, statistics));
        }
        found
    }

    /// Whether this step draws, and when the next one does: twice as late each time, since every goal is a tree that
    /// shares the search's effort.
    fn is_due(&mut self, settings: &SearchSettings, step: u64, goals: usize) -> bool {
        if goals == 0 {
            return true;
        }
        let due = settings.goal_interval > 0 && step >= self.next;
        if due {
            self.next = step.saturating_mul(2);
        }
        due
    }

    fn why(&self, model: &Model, region: &Region) -> String {
        let name = format!("goal {}", region.number + 1);
        if let Some(malformed) = &region.malformed {
            return format!("{name}: {malformed}");
        }
        let contradictions: Vec<&str> =
            region.sites.iter().filter_map(Site::contradiction).map(String::as_str).collect();
        let mut words = match region.is_possible() {
            true => format!("{name}: no configuration in {} tries", region.tries),
            false if model.graph.lazy => format!("{name} contradicts every state near the start"),
            false => format!("{name} contradicts every state"),
        };
        if !contradictions.is_empty() {
            let told = contradictions[..contradictions.len().min(MOST_TOLD)].join("; ");
            words += &format!(" ({} of {} contradict it: {told})", contradictions.len(), region.sites.len());
        }
        let s = &self.statistics;
        if s.tries > 0 {
            words += &format!(
                ", projection failed {} times, {} were out of bounds or in no state",
                s.projection_failed, s.refused
            );
        }
        let shapes = &model.problem.robot.shapes;
        let worst = s.blocked_by.iter().max_by(|a, b| a.1.cmp(b.1).then(b.0.cmp(a.0)));
        if let Some((&(a, b), count)) = worst {
            let collided: u64 = s.blocked_by.values().sum();
            let (a, b) = (&shapes[a.at()].name, &shapes[b.at()].name);
            words += &format!(", {collided} were in collision ({a} and {b} {count} times)");
        }
        words
    }
}

impl Region {
    fn new(model: &Model, number: usize, goal: &PartialGoal) -> Self {
        let malformed = validate(model, goal).err();
        let sites: Vec<_> = (0..model.graph.states.len() as u32).map(|state| Site::new(StateId(state))).collect();
        let widened = if model.graph.lazy { 0 } else { sites.len() };
        Self {
            number,
            goal: goal.clone(),
            malformed,
            sites,
            widened,
            turn: 0,
            tries: 0,
            numbered: 0,
            known: Vec::new(),
        }
    }

    fn is_possible(&self) -> bool {
        self.malformed.is_none() && (self.can_be_widened() || self.sites.iter().any(Site::is_possible))
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

    fn draw(
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
                        model.reach(&q, settings.membership_tolerance);
                        judge(model, settings, &q, &mut TryScratch::default())
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
            let mut rng = stream(settings.seed, Purpose::Goal, goal as u64, number);
            model.problem.robot.space.random(&mut rng, &mut q);
            model.lock(&mut q);
            if rng.random::<f64>() < settings.still_probability {
                program.idle.iter().for_each(|&index| q[index] = start[index]);
            }
        }
        let solve = Settings {
            tolerance: settings.projection_tolerance,
            iterations: settings.projection_iterations,
            ..Settings::default()
        };
        if !project(&program.program, &mut q, &[], &solve, &mut scratch.newton).is_converged() {
            return Try::ProjectionFailed;
        }
        if membership::is_unreached(model, &q, settings.membership_tolerance) {
            return Try::Unreached(q);
        }
        judge(model, settings, &q, scratch)
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

    fn contradiction(&self) -> Option<&String> {
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
fn judge(model: &PlanningModel, settings: &SearchSettings, q: &[f64], scratch: &mut TryScratch) -> Try {
    match membership::feasible(model, settings, q) {
        Ok(goal) => Try::Found(goal),
        Err(_) => what_collides(model, settings, q, scratch),
    }
}

/// The pair that collides in a configuration that may be no goal, or that it is refused for another reason.
fn what_collides(model: &Model, settings: &SearchSettings, q: &[f64], scratch: &mut TryScratch) -> Try {
    if model.problem.robot.space.first_out_of_bounds(q, 1e-9).is_some() {
        return Try::Refused;
    }
    scratch.X_WJ.resize(model.kinematics.bodies(), Pose::identity());
    model.kinematics.forward(q, &mut scratch.X_WJ);
    let Some(state) = membership::state_of(model, q, &scratch.X_WJ, settings.membership_tolerance) else {
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

/// Makes a start or a goal the root of a tree.
pub(crate) fn plant(world: &mut World, root: Feasible) -> NodeId {
    commit::spawn_graph(world);
    let tolerance = world.resource::<SearchSettings>().projection_tolerance;
    let mut index = world.resource_mut::<LeafIndex>();
    let parameters = root.parameters.into_iter().map(|p| index.intern_parameter(p, tolerance)).collect();
    commit::add_root(world, &root.q, Leaf { state: root.state, parameters })
}

/// Set Commit, after the extensions: draws more configurations of goals that leave something free. Every step while there
/// is none yet; else after [`SearchSettings::goal_interval`] steps, and each time after twice as many.
pub fn draw_more_goals(world: &mut World) {
    world.resource_scope(|world, mut sampler: Mut<'_, GoalSampler>| {
        let step = world.resource::<StepCounter>().step;
        let goals = world.resource::<Roots>().goals.len();
        let settings = world.resource::<SearchSettings>().clone();
        if sampler.regions.is_empty() || !sampler.is_due(&settings, step, goals) {
            return;
        }
        let found = world.resource_scope(|world, mut model: Mut<'_, PlanningModel>| {
            sampler.draw(&mut model, &settings, world.resource::<StopSignal>(), LATER_TRIES)
        });
        commit::spawn_graph(world);
        for goal in found {
            plant_goal(world, goal);
        }
    });
}

fn plant_goal(world: &mut World, goal: Feasible) {
    let (roadmap, roots) = (world.resource::<Roadmap>(), world.resource::<Roots>());
    if roots.goals.iter().any(|&root| roadmap.configuration(root) == goal.q) {
        return;
    }
    let root = plant(world, goal);
    world.resource_mut::<Roots>().goals.push(root);
}
