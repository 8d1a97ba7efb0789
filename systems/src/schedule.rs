//! One step of the search: its sets in their order, the systems in them, and the counter of steps and work.

use crate::runtime::system_sequence::{SystemSequence, Systems};
use bevy_ecs::prelude::{IntoScheduleConfigs, Resource, Schedule, SystemSet, World};
use bevy_ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy_ecs::system::BoxedSystem;
use std::iter::Sum;

/// The sets of a step, in order. The numbers are the papers' steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, SystemSet)]
pub enum SearchSet {
    /// P1 §III-A step 1: shoot a random configuration q_rand, one per candidate.
    Sample,
    /// Steps 2-4: the closest node q_near, its state, and a transition T that leaves it, by weight (P0 Alg. 1, lines 5-6).
    Select,
    /// P1 §III-B, P0 §III-B: for crossed transitions, draw the leaf of another tree to aim at.
    Rendezvous,
    /// Step 5, P1 Alg. 2 lines 2-6: solve f_S(q) = 0, g_T(q) = g_T(q_near) from q_rand, waypoint by waypoint.
    Project,
    /// Alg. 2 lines 7-9: the motion between waypoints, kept on its leaf.
    Steer,
    /// Alg. 2 line 10: certify limits, residual and clearance over the continuum; keep the valid prefix (p3).
    Validate,
    /// Alg. 2 lines 11-12: new nodes and edges, in candidate order; leaves, visits and statistics.
    Commit,
    /// Step 6, Alg. 3: try new nodes against nodes on the same leaf in other trees.
    Connect,
    /// Goal reached, budgets spent, deadline, cancellation; progress to the host.
    Conclude,
}

/// The label of the search's schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ScheduleLabel)]
pub struct SearchStep;

/// Work done so far; budgets are counted in it, never in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Resource)]
pub struct StepCounter {
    /// Steps.
    pub step: u64,
    /// Candidates.
    pub candidates: u64,
    /// Candidates whose waypoints all projected, whether or not these were free.
    pub validated: u64,
    /// Motions between two trees that were proposed.
    pub connections: u64,
}

impl StepCounter {
    /// Counted work, by which portfolio members alternate: candidates, whatever becomes of them, and connections.
    /// Where time goes differs from scene to scene, but hardly between searches of one scene.
    #[must_use]
    pub fn work(&self) -> u64 {
        self.candidates + self.connections
    }
}

impl Sum for StepCounter {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |sum, one| Self {
            step: sum.step + one.step,
            candidates: sum.candidates + one.candidates,
            validated: sum.validated + one.validated,
            connections: sum.connections + one.connections,
        })
    }
}

/// An empty schedule with the sets in order.
///
/// Its executor is single-threaded, set explicitly because a host's crates may flip bevy's default; parallelism lives
/// *inside* the systems (a tick of the multi-threaded executor costs 20-60 µs, one of this 0.3 µs).
#[must_use]
pub fn empty_schedule() -> Schedule {
    let mut schedule = Schedule::new(SearchStep);
    schedule.set_executor(SingleThreadedExecutor::new());
    schedule.configure_sets(
        (
            SearchSet::Sample,
            SearchSet::Select,
            SearchSet::Rendezvous,
            SearchSet::Project,
            SearchSet::Steer,
            SearchSet::Validate,
            SearchSet::Commit,
            SearchSet::Connect,
            SearchSet::Conclude,
        )
            .chain(),
    );
    schedule
}

/// The systems of a step: set by set, each set in the order in which its systems run.
///
/// The schedulers that ship are written as such a list. [`Self::schedule`] makes the schedule of a search of it.
/// [`Self::expanded`] makes the same of single systems, where bevy can see what each of them reads and writes.
#[derive(Default)]
pub struct StepSystems {
    sets: Vec<(SearchSet, Vec<BoxedSystem>)>,
}

/// The place of a system within its set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, SystemSet)]
struct Place(SearchSet, usize);

impl StepSystems {
    /// No systems yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds systems to a set, behind those that are in it already.
    #[must_use]
    pub fn in_set<M>(mut self, set: SearchSet, systems: impl Systems<M>) -> Self {
        self.sets.push((set, systems.boxed()));
        self
    }

    /// A schedule with one node for each call of [`Self::in_set`]: an exclusive system that runs its systems in order. bevy
    /// orders the nodes of a schedule anew in every world, and 9 nodes cost 0.2 ms less than 25. Other systems can be added
    /// before a set, behind it or between two sets.
    #[must_use]
    pub fn schedule(self) -> Schedule {
        let mut schedule = empty_schedule();
        for (set, systems) in self.sets {
            let mut sequence = SystemSequence::new(systems);
            schedule.add_systems((move |world: &mut World| sequence.run(world)).in_set(set));
        }
        schedule
    }

    /// A schedule with one node for each system. It finds the same roadmap. Systems of one set are ordered unless `ordered` is
    /// false: then bevy's detection of ambiguities names the systems whose order matters.
    #[must_use]
    pub fn expanded(self, ordered: bool) -> Schedule {
        let mut schedule = empty_schedule();
        for (set, systems) in self.sets {
            for (number, system) in systems.into_iter().enumerate() {
                let placed = system.in_set(set).in_set(Place(set, number));
                match number.checked_sub(1).filter(|_| ordered) {
                    Some(before) => schedule.add_systems(placed.after(Place(set, before))),
                    None => schedule.add_systems(placed),
                };
            }
        }
        schedule
    }
}
