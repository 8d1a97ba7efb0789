//! `portfolio`: several searches of one problem, interleaved by counted work, that exchange what they have reached.

use crate::mrrt::Mrrt;
use crate::portfolio::conclusion;
use crate::portfolio::members::{Member, PortfolioMembers, enter, pass_branches, take_turns};
use crate::sequence::scheduler::Sequence;
use bevy_ecs::prelude::{IntoScheduleConfigs, Schedule, World};
use foliate_systems::schedule::{SearchSet, empty_schedule};
use foliate_systems::search::scheduler::Scheduler;

/// Searches that alternate in worlds of their own ([`crate::portfolio`]). The one that answers may depend on the members, on
/// their order and on the work of a round, never on the clock or the number of threads.
#[derive(Clone)]
pub struct Portfolio {
    /// The searches. The first is alone until the second enters; in a round in which several succeed, the first of them
    /// answers.
    pub members: Vec<Member>,
    /// Work of a member in a round, [`foliate_systems::schedule::StepCounter::work`]. With less work members exchange more often.
    pub quantum: u64,
}

/// Default work of a member in a round: about four steps.
const QUANTUM: u64 = 64;

/// Rounds that the first member has for itself. On one core a second member takes time from it, which pays only where the first is
/// slow.
const ALONE: u64 = 16;

impl Default for Portfolio {
    /// `sequence`, and from the sixteenth round on `mrrt` beside it.
    fn default() -> Self {
        let members = vec![Member::new(Sequence), Member::new(Mrrt).entering(ALONE)];
        Self { members, quantum: QUANTUM }
    }
}

impl Scheduler for Portfolio {
    fn name(&self) -> &'static str {
        "portfolio"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        world.insert_resource(PortfolioMembers::new(self.members.clone(), self.quantum));
        let mut schedule = empty_schedule();
        schedule.add_systems((
            (enter, take_turns).chain().before(SearchSet::Commit),
            pass_branches.in_set(SearchSet::Commit),
            (conclusion::conclude, conclusion::report_progress, conclusion::answer).chain().in_set(SearchSet::Conclude),
        ));
        schedule
    }
}
