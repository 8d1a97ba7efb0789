//! A search as a host embeds it: a world, a schedule, and the loop that steps it.

use crate::events::{EventSink, StopSignal};
use crate::exploration::roadmap_query::roadmap_in;
use crate::exploration::roots::{Ending, GivenRoots, Roots};
use crate::exploration::search_log::note_step;
use crate::exploration::{memory, writer};
use crate::goals::sampler::GoalSampler;
use crate::goals::systems::add_start_and_goals;
use crate::planning_model::model::PlanningModel;
use crate::planning_model::state_classification::Feasible;
use crate::runtime::random::{Purpose, stream};
use crate::runtime::watch::Watch;
use crate::schedule::StepCounter;
use crate::search::excursions::leave_out_excursions;
use crate::search::path_extraction::{extract_path, reached_backwards};
use crate::search::regrasps;
use crate::search::scheduler::Scheduler;
use crate::search::world::{add_roots, empty_world, roots_in};
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Resource, Schedule, World};
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::{GoalStatistics, SearchOutcome, StateStatistics, TransitionStatistics};
use foliate_components::path::ManipulationPath;
use foliate_components::roadmap::Roadmap;
use rand::RngExt;
use std::sync::Arc;

/// Stretches are planned again in so many steps at least, where there are any, and in so many for each of their changes of grasp at
/// most.
const LEAST_STEPS: u64 = 2;
const STEPS_OF_CHANGE: u64 = 4;

/// A stretch is given up when it has grown in none of so many steps. Of those that were planned anew with success 26 of 27 grew at least
/// every third step; where fewer grasps are impossible nothing ever grows.
const PATIENCE: u64 = 3;

/// A search under way. It owns its world; the model is shared, but for a lazy graph, of which every search has its own.
pub struct Search {
    world: World,
    schedule: Schedule,
    ending: Option<SearchOutcome>,
}

impl Search {
    /// Prepares a search: checks start and goals and makes them the roots of trees.
    ///
    /// A start or goal that is out of bounds, in collision or in no state ends the search before it begins
    /// ([`SearchOutcome::InfeasibleStart`], [`SearchOutcome::InfeasibleGoal`]).
    #[must_use]
    pub fn new(
        model: &PlanningModel,
        scheduler: &dyn Scheduler,
        settings: SearchSettings,
        stop: StopSignal,
        events: EventSink,
    ) -> Self {
        let mut world = empty_world(model, settings, stop, events);
        let ending = add_roots(&mut world).err();
        note_step(&mut world);
        let schedule = scheduler.schedule(&mut world);
        Self { world, schedule, ending }
    }

    /// Another search of the problem that is searched in `beside`: the same model and stop signal, the same start and the
    /// goals known there by now, in a world of its own that shares nothing with that one from then on.
    #[must_use]
    pub fn beside(beside: &World, scheduler: &dyn Scheduler, settings: SearchSettings, events: EventSink) -> Self {
        let model = beside.resource::<PlanningModel>();
        let mut world = empty_world(model, settings, beside.resource::<StopSignal>().clone(), events);
        let (start, goals) = roots_in(beside);
        add_start_and_goals(&mut world, start, goals);
        note_step(&mut world);
        world.insert_resource(beside.resource::<GoalSampler>().clone());
        let schedule = scheduler.schedule(&mut world);
        Self { world, schedule, ending: None }
    }

    /// A search from one configuration to others, each with its state and leaf: part of a path that is to be planned again. What
    /// the problem says of start and goals does not count.
    #[must_use]
    pub fn between(
        model: &PlanningModel,
        scheduler: &dyn Scheduler,
        settings: SearchSettings,
        stop: StopSignal,
        (start, goals): (Feasible, Vec<Feasible>),
    ) -> Self {
        let mut world = empty_world(model, settings, stop, EventSink::default());
        add_start_and_goals(&mut world, Some(start), goals);
        let schedule = scheduler.schedule(&mut world);
        Self { world, schedule, ending: None }
    }

    /// How the search has ended, once it has.
    #[must_use]
    pub fn ending(&self) -> Option<&SearchOutcome> {
        self.ending.as_ref()
    }

    /// One step of all candidates. Returns how the search has ended, once it has.
    pub fn step(&mut self) -> Option<&SearchOutcome> {
        if self.ending.is_none() {
            self.schedule.run(&mut self.world);
            self.ending = self.world.resource::<Ending>().0.clone();
            if let Some(AnswerIn(world)) = self.world.remove_resource() {
                self.world = *world;
            }
            note_step(&mut self.world);
            if self.ending == Some(SearchOutcome::Solved) {
                leave_out_excursions(&mut self.world);
                self.leave_out_regrasps();
                self.expand_backwards();
                note_step(&mut self.world);
            }
        }
        self.ending.as_ref()
    }

    /// Steps until the search ends, on the threads of the pool in which it is called.
    ///
    /// Call it inside `rayon::ThreadPool::install` of a pool that the host owns; the answer does not depend on its size. The
    /// pool's other threads do not sleep meanwhile, as far as there are cores for them: a thread that sleeps between two parallel
    /// sections of a step is woken too late.
    pub fn run(&mut self) -> SearchOutcome {
        let watch = Watch::begin();
        loop {
            watch.call();
            if let Some(outcome) = self.step() {
                return outcome.clone();
            }
        }
    }

    /// As [`Self::run`], but at most to the end of a step; `None` where the search goes on.
    pub fn run_to(&mut self, step: u64) -> Option<SearchOutcome> {
        let watch = Watch::begin();
        while self.ending.is_none() && self.counter().step < step {
            watch.call();
            self.step();
        }
        self.ending.clone()
    }

    /// Plans stretches of the path again that seem to need fewer grasps, where the scheduler asks for it, in as many steps as
    /// [`SearchSettings::regrasp_share`] says.
    fn leave_out_regrasps(&mut self) {
        let Some(PlanAgain(scheduler)) = self.world.remove_resource() else { return };
        let settings = self.world.resource::<SearchSettings>().clone();
        let share = settings.regrasp_share * self.counter().step as f64;
        let mut left = if share > 0.0 { (share as u64).max(LEAST_STEPS) } else { 0 };
        let mut tried = Vec::new();
        while left > 0 {
            let stretches = regrasps::stretches(&mut self.world);
            let Some(stretch) = stretches.into_iter().find(|stretch| !tried.contains(stretch)) else { return };
            tried.push(stretch);
            let mut settings = settings.clone();
            settings.seed = stream(settings.seed, Purpose::REGRASP, tried.len() as u64, 0).random();
            settings.max_bytes = settings.max_bytes.saturating_sub(self.bytes()).max(1);
            settings.max_steps = left.min(STEPS_OF_CHANGE * u64::from(stretch.changes));
            settings.log = false;
            let stop = self.world.resource::<StopSignal>().clone();
            let mut world = empty_world(self.model(), settings, stop, EventSink::default());
            regrasps::look_for_fewer(&self.world, stretch, &mut world);
            let schedule = scheduler.schedule(&mut world);
            let mut other = Self { world, schedule, ending: None }.without_planning_again();
            let outcome = other.run_while_it_grows();
            let work = other.counter();
            left = left.saturating_sub(work.step);
            let mut counter = self.world.resource_mut::<StepCounter>();
            *counter = [*counter, work].into_iter().sum();
            if outcome == SearchOutcome::Solved {
                regrasps::adopt(&mut self.world, stretch, other.world());
                leave_out_excursions(&mut self.world);
            }
            self.ending = self.world.resource::<StopSignal>().outcome().or(self.ending.take());
            if self.ending != Some(SearchOutcome::Solved) {
                return;
            }
        }
    }

    /// Steps until the search ends, or has grown in none of [`PATIENCE`] steps.
    fn run_while_it_grows(&mut self) -> SearchOutcome {
        let (mut grown, mut since) = ((0, 0), 0);
        loop {
            if let Some(outcome) = self.step() {
                return outcome.clone();
            }
            let StepCounter { step, connections, .. } = self.counter();
            let leaves = self.world.resource::<LeafIndex>().leaves().len();
            // Motions between trees are tried where a sequence is complete, also in steps that reach no new leaf.
            if (leaves, connections) != grown {
                (grown, since) = ((leaves, connections), step);
            } else if step - since >= PATIENCE {
                return SearchOutcome::StepLimit;
            }
        }
    }

    /// Such that the first path is left as it is found.
    pub(crate) fn without_planning_again(mut self) -> Self {
        self.world.remove_resource::<PlanAgain>();
        self
    }

    /// Makes the transitions come into being that the path travels backwards, so that it can name them.
    fn expand_backwards(&mut self) {
        let (model, roadmap) = (self.world.resource::<PlanningModel>(), self.roadmap());
        let roots = self.world.resource::<Roots>();
        let ends = roots.start.zip(roots.reached_goal(roadmap));
        let Some((start, goal)) = ends.filter(|_| model.graph.lazy) else { return };
        for state in reached_backwards(model, roadmap, start, goal) {
            writer::expand(&mut self.world, state);
        }
    }

    /// The model of this search: ids of transitions and states in paths and statistics are those of its graph. Of a lazy
    /// graph it has what this search has reached.
    #[must_use]
    pub fn model(&self) -> &PlanningModel {
        self.world.resource::<PlanningModel>()
    }

    /// The path, once the search is solved.
    #[must_use]
    pub fn path(&self) -> Option<ManipulationPath> {
        if self.ending != Some(SearchOutcome::Solved) {
            return None;
        }
        let roadmap = roadmap_in(&self.world);
        let roots = self.world.resource::<Roots>();
        let settings = self.world.resource::<SearchSettings>();
        let goal = roots.reached_goal(roadmap)?;
        let leaves = self.world.resource::<LeafIndex>();
        let given = self.world.resource::<GivenRoots>();
        extract_path(self.model(), settings, (roadmap, leaves, given), roots.start?, goal)
    }

    /// Leaves the world behind.
    #[must_use]
    pub fn into_world(self) -> World {
        self.world
    }

    /// The world: roadmap, leaves and statistics, for queries.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The world, for systems of the host's own between steps.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// The roadmap.
    #[must_use]
    pub fn roadmap(&self) -> Roadmap<'_> {
        roadmap_in(&self.world)
    }

    /// About how much memory it takes beyond the model that it was given, see [`crate::exploration::memory`].
    #[must_use]
    pub fn bytes(&self) -> u64 {
        memory::taken_in(&self.world)
    }

    /// Work done so far.
    #[must_use]
    pub fn counter(&self) -> StepCounter {
        *self.world.resource::<StepCounter>()
    }

    /// What became of the candidates, by transition: the funnel.
    #[must_use]
    pub fn statistics(&mut self) -> Vec<(TransitionId, TransitionStatistics)> {
        let mut query = self.world.query::<(&TransitionId, &TransitionStatistics)>();
        let mut all: Vec<_> = query.iter(&self.world).map(|(id, s)| (*id, s.clone())).collect();
        all.sort_by_key(|&(id, _)| id);
        all
    }

    /// What the search has of every state.
    #[must_use]
    pub fn states(&mut self) -> Vec<(StateId, StateStatistics)> {
        let mut query = self.world.query::<(&StateId, &StateStatistics)>();
        let mut all: Vec<_> = query.iter(&self.world).map(|(id, s)| (*id, *s)).collect();
        all.sort_by_key(|&(id, _)| id);
        all
    }

    /// What became of the tries to find configurations for goals that leave something free.
    #[must_use]
    pub fn goal_statistics(&self) -> &GoalStatistics {
        self.world.resource::<GoalSampler>().statistics()
    }
}

/// Another world that has the answer: where a step leaves it in its world, that one takes its place once the search has
/// ended. For schedulers whose systems step searches of their own.
#[derive(Resource)]
pub struct AnswerIn(pub Box<World>);

/// The scheduler by which stretches of the first path are planned again where they seem to need fewer grasps. A scheduler that wants
/// this inserts it when it is asked for its schedule.
#[derive(Clone, Resource)]
pub struct PlanAgain(pub Arc<dyn Scheduler>);
