//! A search as a host embeds it: a world, a schedule, and the loop that steps it.

use crate::commit::{self, NewNodes};
use crate::conclusion::{Ending, Roots};
use crate::connection::Connections;
use crate::errands::{Errands, Watch};
use crate::events::{EventSink, StopSignal};
use crate::foreseen::Foreseen;
use crate::goals::{GoalSampler, plant};
use crate::membership::{self, Feasible};
use crate::memory::{self, Compiled};
use crate::model::PlanningModel;
use crate::neighbours::Neighbours;
use crate::passages::Passages;
use crate::path_extraction::{extract_path, reached_backwards};
use crate::reached_leaves::ReachedLeaves;
use crate::schedule::StepCounter;
use crate::schedulers::Scheduler;
use crate::selection::{Families, TransitionWeights};
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Mut, Resource, Schedule, World};
use foliate_components::candidate::CandidateArena;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::{GoalStatistics, SearchOutcome, StateStatistics, TransitionStatistics};
use foliate_components::path::ManipulationPath;
use foliate_components::problem::Goal;
use foliate_components::roadmap::Roadmap;

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
        let ending = plant_roots(&mut world).err();
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
        let start = start.map(|root| plant(&mut world, root));
        let goals = goals.into_iter().map(|root| plant(&mut world, root)).collect();
        world.insert_resource(Roots { start, goals });
        world.insert_resource(beside.resource::<GoalSampler>().clone());
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
            if self.ending == Some(SearchOutcome::Solved) {
                self.expand_backwards();
            }
        }
        self.ending.as_ref()
    }

    /// Steps until the search ends, on the threads of the pool in which it is called.
    ///
    /// Call it inside `rayon::ThreadPool::install` of a pool that the host owns; the answer does not depend on its size. The
    /// pool's other threads do not sleep meanwhile, as far as there are cores for them: see [`crate::errands`].
    pub fn run(&mut self) -> SearchOutcome {
        let watch = Watch::begin(self.world.resource::<Errands>());
        loop {
            watch.call();
            if let Some(outcome) = self.step() {
                return outcome.clone();
            }
        }
    }

    /// Makes the transitions come into being that the path travels backwards, so that it can name them.
    fn expand_backwards(&mut self) {
        let (model, roadmap) = (self.world.resource::<PlanningModel>(), self.roadmap());
        let roots = self.world.resource::<Roots>();
        let ends = roots.start.zip(roots.reached_goal(roadmap));
        let Some((start, goal)) = ends.filter(|_| model.graph.lazy) else { return };
        for state in reached_backwards(model, roadmap, start, goal) {
            commit::expand(&mut self.world, state);
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
        let roadmap = self.world.resource::<Roadmap>();
        let roots = self.world.resource::<Roots>();
        let settings = self.world.resource::<SearchSettings>();
        let goal = roots.reached_goal(roadmap)?;
        let leaves = self.world.resource::<LeafIndex>();
        extract_path(self.model(), settings, roadmap, leaves, roots.start?, goal)
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
    pub fn roadmap(&self) -> &Roadmap {
        self.world.resource::<Roadmap>()
    }

    /// About how much memory it takes beyond the model that it was given, see [`crate::memory`].
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

/// A world with all resources in place, and no roots.
fn empty_world(model: &PlanningModel, settings: SearchSettings, stop: StopSignal, events: EventSink) -> World {
    let mut world = World::new();
    let size = model.problem.robot.space.size();
    let candidates = settings.candidates.clamp(1, 4096);
    world.insert_resource(model.clone());
    commit::spawn_graph_and_candidates(&mut world, candidates);
    world.insert_resource(CandidateArena::new(candidates, size));
    world.insert_resource(Roadmap::new(size));
    world.init_resource::<LeafIndex>();
    world.init_resource::<NewNodes>();
    world.init_resource::<Connections>();
    world.init_resource::<Passages>();
    world.init_resource::<Compiled>();
    world.init_resource::<Errands>();
    world.init_resource::<Foreseen>();
    world.init_resource::<ReachedLeaves>();
    world.init_resource::<Families>();
    world.init_resource::<crate::guidance::aiming::Aims>();
    world.init_resource::<TransitionWeights>();
    world.init_resource::<StepCounter>();
    world.init_resource::<Roots>();
    world.init_resource::<Ending>();
    world.init_resource::<GoalSampler>();
    world.insert_resource(Neighbours::new(model, &settings));
    world.insert_resource(settings);
    world.insert_resource(stop);
    world.insert_resource(events);
    world
}

/// Start and goals as they stand in a world.
fn roots_in(world: &World) -> (Option<Feasible>, Vec<Feasible>) {
    let (roadmap, leaves, roots) =
        (world.resource::<Roadmap>(), world.resource::<LeafIndex>(), world.resource::<Roots>());
    let root = |node| {
        let row = roadmap.node(node);
        let parameters = leaves.leaf(row.leaf).parameters.iter().map(|&id| *leaves.parameter(id)).collect();
        Feasible { q: roadmap.configuration(node).to_vec(), state: row.state, parameters }
    };
    (roots.start.map(root), roots.goals.iter().copied().map(root).collect())
}

/// Makes start and goals the roots of trees. A goal that leaves something free and of which no configuration was found yet
/// is looked for again during the search.
fn plant_roots(world: &mut World) -> Result<(), SearchOutcome> {
    let settings = world.resource::<SearchSettings>().clone();
    let found = world.resource_scope(|world, mut model: Mut<'_, PlanningModel>| {
        find_roots(&mut model, &settings, world.resource::<StopSignal>())
    })?;
    world.insert_resource(found.sampler);
    if let Some(why) = found.hopeless {
        return Err(SearchOutcome::InfeasibleGoal(why));
    }
    let start = plant(world, found.start);
    let goals = found.goals.into_iter().map(|goal| plant(world, goal)).collect();
    world.insert_resource(Roots { start: Some(start), goals });
    Ok(())
}

/// Where trees begin.
struct FoundRoots {
    start: Feasible,
    goals: Vec<Feasible>,
    sampler: GoalSampler,
    /// Why there is no goal and will be none.
    hopeless: Option<String>,
}

fn find_roots(
    model: &mut PlanningModel,
    settings: &SearchSettings,
    stop: &StopSignal,
) -> Result<FoundRoots, SearchOutcome> {
    let q = model.problem.start.clone();
    let start = membership::reach_start(model, settings, &q).map_err(SearchOutcome::InfeasibleStart)?;
    let mut sampler = GoalSampler::new(model, settings, &start.q);
    let mut goals = Vec::new();
    let mut complaint = String::from("the problem names no goal");
    for goal in model.problem.goals.clone() {
        if let Goal::Configuration(q) = goal {
            match membership::reach_feasible(model, settings, &q) {
                Ok(goal) => goals.push(goal),
                Err(why) => complaint = why,
            }
        }
    }
    goals.extend(sampler.draw_first(model, settings, stop));
    let given_up = sampler.given_up(model, settings);
    let hopeless = goals.is_empty() && (sampler.is_empty() || given_up.is_some());
    let hopeless = hopeless.then(|| given_up.unwrap_or(complaint));
    Ok(FoundRoots { start, goals, sampler, hopeless })
}
