//! An improvement as a host embeds it: a world, a schedule of rounds, and the loop that steps it.

use crate::events::StopSignal;
use crate::improvement::changes::limbs::Limbs;
use crate::improvement::cost::{PathCost, path_cost};
use crate::improvement::leaf_motion::LeafMotion;
use crate::improvement::progress::{ImprovementEnding, Progress};
use crate::improvement::proposal::{Incumbent, Proposal};
use crate::improvement::settings::ImprovementSettings;
use crate::improvement::systems::{self, Cost, Replanner};
use crate::planning_model::model::PlanningModel;
use crate::runtime::watch::Watch;
use crate::search::scheduler::Scheduler;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{IntoScheduleConfigs, Schedule, SystemSet, World};
use bevy_ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use foliate_components::path::ManipulationPath;
use std::sync::Arc;

/// The sets of a round, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, SystemSet)]
pub enum ImprovementSet {
    /// Draw changes of the path.
    Propose,
    /// Plan, steer and certify each of them.
    Evaluate,
    /// Those that make the path better become part of it.
    Commit,
    /// Budgets, deadline, cancellation.
    Conclude,
}

/// The label of an improvement's schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ScheduleLabel)]
pub struct ImprovementRound;

/// An improvement under way. The same path, settings and seed give the same rounds on any number of threads.
pub struct Improvement {
    world: World,
    schedule: Schedule,
}

impl Improvement {
    /// Prepares to improve a path of the model's without times. `None` where a constraint of its states does not compile, or the path is
    /// empty.
    #[must_use]
    pub fn new(
        model: &PlanningModel,
        path: &ManipulationPath,
        (scheduler, cost): (Arc<dyn Scheduler>, Arc<dyn PathCost>),
        (search, settings): (SearchSettings, ImprovementSettings),
        stop: StopSignal,
    ) -> Option<Self> {
        let motions = LeafMotion::of_path(model, path).filter(|motions| !motions.is_empty())?;
        let mut world = World::new();
        let incumbent_cost = path_cost(cost.as_ref(), model, &motions);
        world.insert_resource(Limbs::of(model));
        world.insert_resource(Incumbent { motions, cost: incumbent_cost, certificate: path.certificate });
        world.insert_resource(Progress::new(incumbent_cost, settings.first_steps));
        let proposal = |number| Proposal { number, attempt: None, change: None, work: 0, is_solved: false };
        world.spawn_batch((0..settings.proposals.clamp(1, 4096) as u32).map(proposal));
        world.insert_resource(Cost(cost));
        world.insert_resource(Replanner(scheduler));
        world.insert_resource(model.clone());
        world.insert_resource(search.for_problem(&model.problem));
        world.insert_resource(settings);
        world.insert_resource(stop);
        Some(Self { world, schedule: schedule() })
    }

    /// One round of all proposals. Returns how the improvement has ended, once it has.
    pub fn step(&mut self) -> Option<ImprovementEnding> {
        if self.progress().ending.is_none() {
            self.schedule.run(&mut self.world);
        }
        self.progress().ending
    }

    /// Steps until the improvement ends, on the threads of the pool in which it is called. `better` is called after every round
    /// that has made the path better.
    pub fn run(&mut self, mut better: impl FnMut(&Self)) -> ImprovementEnding {
        let watch = Watch::begin();
        loop {
            watch.call();
            let known = self.progress().history.len();
            let ending = self.step();
            if self.progress().history.len() > known {
                better(self);
            }
            if let Some(ending) = ending {
                return ending;
            }
        }
    }

    /// The path so far, without times.
    #[must_use]
    pub fn path(&self) -> ManipulationPath {
        let (model, incumbent) = (self.model(), self.world.resource::<Incumbent>());
        incumbent.path(model, self.world.resource::<SearchSettings>())
    }

    /// The motions of the path so far, from which [`Incumbent::path`] makes it at any later time.
    #[must_use]
    pub fn incumbent(&self) -> &Incumbent {
        self.world.resource::<Incumbent>()
    }

    /// The settings of the searches that plan stretches again.
    #[must_use]
    pub fn search_settings(&self) -> &SearchSettings {
        self.world.resource::<SearchSettings>()
    }

    /// What the path so far costs.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.world.resource::<Incumbent>().cost
    }

    /// How far it has come.
    #[must_use]
    pub fn progress(&self) -> &Progress {
        self.world.resource::<Progress>()
    }

    /// The model of the path's ids: where the graph is lazy it has grown with what was planned again.
    #[must_use]
    pub fn model(&self) -> &PlanningModel {
        self.world.resource::<PlanningModel>()
    }

    /// The world, for systems of the host's own between rounds.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// The schedule, for systems of the host's own in a round.
    pub fn schedule_mut(&mut self) -> &mut Schedule {
        &mut self.schedule
    }
}

/// The systems of a round.
#[must_use]
pub fn schedule() -> Schedule {
    let mut schedule = Schedule::new(ImprovementRound);
    schedule.set_executor(SingleThreadedExecutor::new());
    let sets = (ImprovementSet::Propose, ImprovementSet::Evaluate, ImprovementSet::Commit, ImprovementSet::Conclude);
    schedule.configure_sets(sets.chain());
    schedule.add_systems((
        systems::propose.in_set(ImprovementSet::Propose),
        systems::evaluate.in_set(ImprovementSet::Evaluate),
        systems::commit.in_set(ImprovementSet::Commit),
        systems::conclude.in_set(ImprovementSet::Conclude),
    ));
    schedule
}
