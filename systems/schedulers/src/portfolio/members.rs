//! The members of a portfolio, and the systems of a round: enter, work, pass branches on.

use crate::portfolio::roadmap_exchange;
use crate::portfolio::roadmap_exchange::{Branch, Correspondence};
use bevy_ecs::prelude::{Mut, Res, ResMut, Resource, World};
use crossbeam_channel::Receiver;
use foliate_components::outcome::SearchOutcome;
use foliate_systems::events::{EventSink, SolveEvent};
use foliate_systems::planning_model::model::PlanningModel;
use foliate_systems::schedule::StepCounter;
use foliate_systems::search::scheduler::Scheduler;
use foliate_systems::search::session::Search;
use foliate_systems::settings::SearchSettings;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Events of one world that wait until its turn is over; more are dropped, and counted.
const EVENTS_OF_A_TURN: usize = 4096;

/// One of the searches of a portfolio.
#[derive(Clone)]
pub struct Member {
    scheduler: Arc<dyn Scheduler>,
    tune: Arc<dyn Fn(&mut SearchSettings) + Send + Sync>,
    enters: u64,
}

impl Member {
    /// A search that takes part from the first round on, with the portfolio's settings; its random streams are its own, but
    /// for the first member, whose seed is that of the portfolio.
    #[must_use]
    pub fn new(scheduler: impl Scheduler + 'static) -> Self {
        Self { scheduler: Arc::new(scheduler), tune: Arc::new(|_| {}), enters: 0 }
    }

    /// Changes its settings. Budgets are those of all together and end the portfolio, whatever is written here.
    #[must_use]
    pub fn tuned(mut self, tune: impl Fn(&mut SearchSettings) + Send + Sync + 'static) -> Self {
        self.tune = Arc::new(tune);
        self
    }

    /// Lets it enter after so many rounds, but never before the members in front of it.
    #[must_use]
    pub fn entering(mut self, rounds: u64) -> Self {
        self.enters = rounds;
        self
    }
}

/// A world that has entered.
pub(crate) struct Running {
    pub(crate) search: Search,
    /// Work that it has done.
    work: u64,
    /// Work that its rounds so far have given it.
    given: u64,
    /// Its events for the host, where that listens.
    pub(crate) events: Receiver<SolveEvent>,
    /// Its branches for the other members.
    queue: Receiver<Branch>,
    /// Counts when its last round began.
    before: StepCounter,
}

impl Running {
    /// Steps as long as there is work left of what has been given; an idle step counts as one unit.
    fn take_turn(&mut self, quantum: u64, is_needless: impl Fn() -> bool) {
        self.before = self.search.counter();
        self.given += quantum;
        while self.work < self.given && !self.has_ended() && !is_needless() {
            let before = self.search.counter().work();
            self.search.step();
            self.work += (self.search.counter().work() - before).max(1);
        }
        roadmap_exchange::post_reached_leaves(self.search.world_mut());
    }

    pub(crate) fn has_ended(&self) -> bool {
        self.search.ending().is_some()
    }

    fn has_solved(&self) -> bool {
        self.search.ending() == Some(&SearchOutcome::Solved)
    }
}

/// What one member has done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemberCount {
    /// Name of its scheduler.
    pub scheduler: &'static str,
    /// Whether roadmap, statistics and path are its own.
    pub answers: bool,
    /// Its work. Of the members behind the one that answers, up to the last round: how far they came in that one depends on
    /// the number of threads.
    pub counter: StepCounter,
}

/// What all members have done; in the world of the one that answers.
#[derive(Clone, Debug, Default, Resource)]
pub struct MemberCounts(pub Vec<MemberCount>);

/// The members of a portfolio.
#[derive(Resource)]
pub struct PortfolioMembers {
    members: Vec<Member>,
    pub(crate) running: Vec<Running>,
    quantum: u64,
    round: u64,
}

impl PortfolioMembers {
    /// These members, none of which has entered yet. `quantum` is the work of each in a round
    /// ([`StepCounter::work`]).
    #[must_use]
    pub fn new(members: Vec<Member>, quantum: u64) -> Self {
        Self { members, running: Vec::new(), quantum: quantum.max(1), round: 0 }
    }

    /// The searches that have entered, in the order of the members.
    pub fn searches(&self) -> impl Iterator<Item = &Search> {
        self.running.iter().map(|running| &running.search)
    }

    /// The first member that has solved the problem.
    pub(crate) fn winner(&self) -> Option<usize> {
        self.running.iter().position(Running::has_solved)
    }

    /// The member that answers if the portfolio ends now: the first where none has solved the problem.
    pub(crate) fn leader(&self) -> usize {
        self.winner().unwrap_or(0)
    }

    /// The members whose last round does not depend on the number of threads: up to the winner, all where there is none.
    pub(crate) fn deciding(&mut self) -> &mut [Running] {
        let count = self.winner().map_or(self.running.len(), |winner| winner + 1);
        &mut self.running[..count]
    }

    pub(crate) fn counts(&self) -> Vec<MemberCount> {
        let winner = self.winner();
        let count = |(number, running): (usize, &Running)| MemberCount {
            scheduler: self.members[number].scheduler.name(),
            answers: number == self.leader(),
            counter: if winner.is_some_and(|w| w < number) { running.before } else { running.search.counter() },
        };
        self.running.iter().enumerate().map(count).collect()
    }

    /// Lets the next member enter: with the roots of `host`, and with what the others have reached.
    fn enter(&mut self, host: &World) {
        let number = self.running.len();
        let Some(member) = self.members.get(number) else { return };
        let mut settings = host.resource::<SearchSettings>().clone();
        settings.seed = seed_of(settings.seed, number);
        (member.tune)(&mut settings);
        let (sink, events) = match host.resource::<EventSink>().is_open() {
            true => EventSink::bounded(EVENTS_OF_A_TURN),
            false => (EventSink::default(), crossbeam_channel::never()),
        };
        let mut search = Search::beside(host, member.scheduler.as_ref(), settings, sink);
        let queue = Correspondence::open(search.world_mut(), number as u32);
        // The first has heard of all that anybody has reached.
        if let Some(first) = self.running.first_mut().filter(|_| understand_each_other(host.resource())) {
            let branches = roadmap_exchange::all_branches(first.search.world_mut());
            branches.iter().for_each(|branch| roadmap_exchange::adopt(search.world_mut(), branch));
        }
        self.running.push(Running { search, work: 0, given: 0, events, queue, before: StepCounter::default() });
    }
}

/// The first member's seed is the portfolio's: as long as it is alone it searches as it would outside of a portfolio.
fn seed_of(seed: u64, member: usize) -> u64 {
    /// 2⁶⁴ divided by the golden ratio: neighbouring seeds of one member are no seeds of another.
    const APART: u64 = 0x9e37_79b9_7f4a_7c15;
    seed.wrapping_add((member as u64).wrapping_mul(APART))
}

/// Whether ids of states and transitions mean the same in all members: every search lets a lazy graph grow in its own order.
fn understand_each_other(model: &PlanningModel) -> bool {
    !model.graph.lazy
}

/// Lets those members enter whose round has come.
pub fn enter(world: &mut World) {
    world.resource_scope(|world, mut portfolio_members: Mut<'_, PortfolioMembers>| {
        while portfolio_members
            .members
            .get(portfolio_members.running.len())
            .is_some_and(|member| member.enters <= portfolio_members.round)
        {
            portfolio_members.enter(world);
        }
    });
}

/// The work of every member in a round. A member stops early once one in front has solved the problem: that one answers.
pub fn take_turns(mut portfolio_members: ResMut<'_, PortfolioMembers>) {
    let portfolio_members = &mut *portfolio_members;
    let first_solved = AtomicUsize::new(usize::MAX);
    portfolio_members.running.par_iter_mut().enumerate().for_each(|(number, running)| {
        running.take_turn(portfolio_members.quantum, || first_solved.load(Ordering::Relaxed) < number);
        if running.has_solved() {
            first_solved.fetch_min(number, Ordering::Relaxed);
        }
    });
    portfolio_members.round += 1;
}

/// Empties the members' queues, in order, and passes their branches on to all others that continue.
pub fn pass_branches(model: Res<'_, PlanningModel>, mut portfolio_members: ResMut<'_, PortfolioMembers>) {
    let is_over = portfolio_members.winner().is_some();
    for sender in 0..portfolio_members.running.len() {
        let branches: Vec<_> = portfolio_members.running[sender].queue.try_iter().collect();
        if is_over || !understand_each_other(&model) {
            continue;
        }
        let others =
            portfolio_members.running.iter_mut().enumerate().filter(|(number, r)| *number != sender && !r.has_ended());
        for (_, other) in others {
            branches.iter().for_each(|branch| roadmap_exchange::adopt(other.search.world_mut(), branch));
        }
    }
}
